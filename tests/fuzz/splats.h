/* Shared by the fuzz targets of splat formats. A parser must return a plausible number of Gaussians, or fail with a one-line
 * error and leave its output untouched. td_gaussians_check must accept the Gaussians, or refuse them with a one-line error. All
 * else aborts. */
#ifndef TESTS_FUZZ_SPLATS_H
#define TESTS_FUZZ_SPLATS_H

#include "fuzz.h"

#include "scene/td_splat.h"

typedef tides_status fuzz_parser(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error);

/* Checks one input of `size` bytes. A parser that accepts it must return 1 to size * most Gaussians: `most` is the largest
 * number that one byte of the format can hold if it is compressed. */
static inline void fuzz_splats(fuzz_parser *parse, const uint8_t *data, size_t size, uint64_t most) {
    float untouched = 0;
    td_gaussians gaussians = {.count = -1, .sh_degree = -1, .mean = &untouched, .sh = &untouched};
    tides_error error = {0, ""};
    tides_status status = parse("fuzz", data, size, &gaussians, &error);
    if (status != TIDES_OK) {
        fuzz_refusal(status, &error);
        if (gaussians.count != -1 || gaussians.mean != &untouched || gaussians.sh != &untouched) abort();
        return;
    }
    if (gaussians.count < 1 || (uint64_t)gaussians.count > size * most) abort();
    status = td_gaussians_check(&gaussians, 1, TIDES_BAD_FILE, &error);
    if (status != TIDES_OK) fuzz_refusal(status, &error);
    td_gaussians_free(&gaussians);
}

#endif
