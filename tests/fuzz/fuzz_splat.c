/* Any bytes as a .splat scene. */
#include "tests/fuzz/splats.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_splats(td_splat_parse, data, size, 1);
    return 0;
}
