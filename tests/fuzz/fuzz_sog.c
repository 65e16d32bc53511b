/* Any bytes as a .sog scene; a WebP picture of one colour has next to no bytes. */
#include "tests/fuzz/splats.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_splats(td_sog_parse, data, size, 16383 * 16383);
    return 0;
}
