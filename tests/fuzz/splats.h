/* Shared by the fuzz targets of packed splat formats: parses Gaussians, which must be valid, or they are refused in one line
 * with the output untouched. */
#ifndef TESTS_FUZZ_SPLATS_H
#define TESTS_FUZZ_SPLATS_H

#include "fuzz.h"

#include "scene/td_splat.h"

typedef tides_status fuzz_parser(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error);

/* `most`: Gaussians that a byte of the file can stand for, at most. */
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
