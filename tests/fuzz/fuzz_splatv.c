/* Any bytes as a .splatv scene, with its motion. */
#include "tests/fuzz/splats.h"

static tides_status parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error) {
    tides_motion *motion = NULL;
    tides_status status = td_splatv_parse(path, data, size, gaussians, &motion, error);
    if ((status == TIDES_OK) != (motion != NULL)) abort();
    tides_motion_destroy(motion);
    return status;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_splats(parse, data, size, 1);
    return 0;
}
