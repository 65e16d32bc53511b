/* Any bytes as a .spz scene; gzip shrinks at most 1032 times, zstd 32768 times. */
#include "tests/fuzz/splats.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_splats(td_spz_parse, data, size, 32768);
    return 0;
}
