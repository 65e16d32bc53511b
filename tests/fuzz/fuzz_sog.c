/* Any bytes as a .sog scene. A WebP picture of one colour is only a few bytes long, so that the input needn't be large. */
#include "tests/fuzz/splats.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_splats(td_sog_parse, data, size, 16383 * 16383);
    return 0;
}
