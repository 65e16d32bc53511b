/* The fuzz target of runs (tests/fuzz/fuzz_runs.c) on random inputs, with the processor's OpenCL device if there is one: whole
 * runs, runs that are cut and continued from checkpoints, and the device's give equal events to the bit. It aborts if they
 * don't; the seed printed last is the input's. TIDES_TINY_RUNS: number of runs (60). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "td_base.h"
#include "td_random.h"
/* NOLINTNEXTLINE(bugprone-suspicious-include): the target itself */
#include "tests/fuzz/fuzz_runs.c"
#include "tests/support/opencl.h"

enum { INPUT_BYTES = 700, RUNS = 60 };

static uint64_t next(uint64_t *seed) {
    uint64_t x = *seed += UINT64_C(0x9e3779b97f4a7c15); /* splitmix64 (Steele, Lea, Flood 2014) */
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return x ^ x >> 31;
}

static void test_tiny_runs(void **state) {
    const char *asked = getenv("TIDES_TINY_RUNS");
    const long runs = asked ? strtol(asked, NULL, 10) : RUNS;
    uint8_t input[INPUT_BYTES];
    (void)state;
    for (long run = 0; run < runs; run++) {
        uint64_t seed = (uint64_t)run;
        for (size_t i = 0; i < INPUT_BYTES; i++) input[i] = (uint8_t)(next(&seed) >> 56);
        print_message("seed %ld\n", run);
        LLVMFuzzerTestOneInput(input, sizeof input);
    }
    skip_without_opencl();
}

/* What the fuzzer found. */
static void test_found(void **state) {
    static const uint8_t no_splat_on_a_path[] = {0x2c, 0xbf, 0x3a, 0x97, 0xcd, 0xc4, 0x85, 0x74, 0x7c, 0x82,
                                                 0x00, 0x71, 0xe1, 0x16, 0x7f, 0x0e, 0xe0, 0xb6, 0x48, 0xa7,
                                                 0xa5, 0x4e, 0x50, 0xfb, 0x67, 0xb5, 0x57, 0x67};
    (void)state;
    LLVMFuzzerTestOneInput(no_splat_on_a_path, sizeof no_splat_on_a_path); /* a list of nobody began at NULL */
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_tiny_runs), cmocka_unit_test(test_found)};
    tides_device *device = NULL;
    if (tides_device_open("cpu", &device, NULL) == TIDES_OK) setenv("TIDES_FUZZ_DEVICE", "cpu", 1);
    tides_device_close(device);
    return cmocka_run_group_tests_name("tiny runs", tests, NULL, NULL);
}
