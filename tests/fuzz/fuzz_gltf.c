/* Any bytes as a .glb or .gltf of splats. */
#include "tests/fuzz/splats.h"

/* A buffer beside it, which isn't there, is a refusal like others. */
static tides_status parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error) {
    tides_status status = td_gltf_parse(path, data, size, NULL, 0, gaussians, error);
    if (status == TIDES_FILE_NOT_FOUND) status = error->status = TIDES_BAD_FILE;
    return status;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_splats(parse, data, size, 1024 * 32768); /* places times what .spz can hold */
    return 0;
}
