/* IEBCS's noise from measured histograms: tables in the original's layout, (rows, columns, 72) counts of pixels per rate, give
 * the rates of their bins, each polarity from its own file; tables of any other shape or content are refused. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/archive_make.h"
#include "tests/support/scene_folder.h"
#include "tides/baselines.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The original's table is 50 x 50 pixels of 72 bins: 1 to 9 times 10^-3 to 10^4 Hz. */
enum { ROWS = 50, BINS = 72, TABLE = ROWS * ROWS * BINS, HZ_20 = 4 * 9 + 1, HZ_40 = 4 * 9 + 3, WIDTH = 48, HEIGHT = 32 };

typedef struct counts {
    int on[WIDTH * HEIGHT], off[WIDTH * HEIGHT];
} counts;

static int take(void *user, const tides_event *events, size_t count) {
    counts *c = user;
    for (size_t i = 0; i < count; i++) {
        int pixel = events[i].y * WIDTH + events[i].x;
        assert_int_equal(events[i].cause, TIDES_CAUSE_SHOT);
        if (events[i].polarity > 0)
            c->on[pixel]++;
        else
            c->off[pixel]++;
    }
    return 0;
}

static tides_baseline_params params_of(const char *noise_pos, const char *noise_neg) {
    tides_baseline_params params;
    tides_baseline_params_defaults(&params);
    params.method = TIDES_METHOD_IEBCS;
    params.iebcs.bgnp = params.iebcs.bgnn = 0;
    params.iebcs.noise_pos = noise_pos;
    params.iebcs.noise_neg = noise_neg;
    return params;
}

/* Events per pixel in `seconds` of constant light. */
static void simulate(const char *noise_pos, const char *noise_neg, double seconds, counts *c) {
    tides_baseline *baseline = NULL;
    tides_error error = {TIDES_OK, ""};
    tides_baseline_params params = params_of(noise_pos, noise_neg);
    double Y[WIDTH * HEIGHT];
    for (int i = 0; i < WIDTH * HEIGHT; i++) Y[i] = 0.5;
    memset(c, 0, sizeof *c);
    scene_expect_ok(tides_baseline_create(&params, WIDTH, HEIGHT, &baseline, &error), &error);
    for (int k = 0; k <= 1000; k++) /* one noise event of a polarity per frame at most */
        scene_expect_ok(tides_baseline_push(baseline, 1e-3 * seconds * k, Y, take, c, &error), &error);
    scene_expect_ok(tides_baseline_finish(baseline, take, c, &error), &error);
    tides_baseline_destroy(baseline);
}

/* `dtype` as a header has it, with its quotes. */
static void put_table(const char *path, const char *dtype, const char *shape, const void *data, size_t size) {
    char header[160];
    scene_bytes npy = {0};
    snprintf(header, sizeof header, "{'descr': %s, 'fortran_order': False, 'shape': %s, }", dtype, shape);
    archive_npy(&npy, 1, header, data, size);
    scene_file_write(path, npy.data, npy.size);
    free(npy.data);
}

/* Counts from a rule, as doubles or as 32-bit integers. */
static void put_counts(const char *path, int real, int (*rule)(int row, int bin)) {
    double *reals = calloc(TABLE, sizeof *reals);
    int32_t *integers = calloc(TABLE, sizeof *integers);
    assert_true(reals && integers);
    for (int i = 0; i < TABLE; i++) reals[i] = integers[i] = rule(i / BINS, i % BINS);
    if (real)
        put_table(path, "'<f8'", "(50, 50, 72)", reals, TABLE * sizeof *reals);
    else
        put_table(path, "'<i4'", "(50, 50, 72)", integers, TABLE * sizeof *integers);
    free(reals);
    free(integers);
}

static int only_20(int row, int bin) { return row >= 0 && bin == HZ_20 ? 7 : 0; }
static int every_fourth(int row, int bin) { return row % 4 == 0 && bin == HZ_20; }
static int two_rates(int row, int bin) { return row >= 0 && bin == HZ_20 ? 3 : bin == HZ_40 ? 1 : 0; }

/* All pixels in one bin: strictly periodic, each polarity from its own file, whatever the counts are stored as. */
static void one_rate(void **state) {
    static counts c;
    const char *path = scene_in_folder(*state, "noise.npy");
    for (int real = 0; real < 2; real++) {
        put_counts(path, real, only_20);
        simulate(path, NULL, 1, &c);
        for (int i = 0; i < WIDTH * HEIGHT; i++) assert_true(c.on[i] == 20 && c.off[i] == 0);
        simulate(NULL, path, 1, &c);
        for (int i = 0; i < WIDTH * HEIGHT; i++) assert_true(c.on[i] == 0 && c.off[i] == 20);
    }
}

/* A pixel of the table without counts is one without noise; every pixel here is one of the table's, drawn once. */
static void silent_pixels(void **state) {
    static counts c;
    const char *path = scene_in_folder(*state, "noise.npy");
    put_counts(path, 1, every_fourth);
    simulate(path, NULL, 1, &c);
    int noisy = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        assert_true(c.on[i] == 0 || c.on[i] == 20);
        noisy += c.on[i] > 0;
    }
    double mean = WIDTH * HEIGHT / 4.0;
    print_message("noisy pixels: %d, expected %.0f\n", noisy, mean);
    assert_true(fabs(noisy - mean) < 5 * sqrt(0.75 * mean)); /* binomial */
}

/* A rate is drawn for each period: 3/4 of 50 ms and 1/4 of 25 ms are 43.75 ms on average. */
static void drawn_rates(void **state) {
    static counts c;
    const char *path = scene_in_folder(*state, "noise.npy");
    put_counts(path, 0, two_rates);
    simulate(path, NULL, 4, &c);
    double sum = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) sum += c.on[i];
    double rate = sum / (4.0 * WIDTH * HEIGHT);
    print_message("rate: %.3f Hz, expected %.3f\n", rate, 1 / 0.04375);
    assert_true(fabs(rate * 0.04375 - 1) < 0.01);
}

static void expect_refused(const char *path, tides_status wanted, const char *words) {
    tides_baseline *baseline = NULL;
    tides_error error = {TIDES_OK, ""};
    tides_baseline_params params = params_of(NULL, path);
    scene_expect_error(tides_baseline_create(&params, WIDTH, HEIGHT, &baseline, &error), wanted, &error, words);
    assert_null(baseline);
}

static void wrong_tables(void **state) {
    const char *path = scene_in_folder(*state, "noise.npy");
    static const char *const shapes[] = {"(50, 72)", "(50, 50, 71)", "(72, 50, 50)", "(0, 50, 72)", "(1, 1, 1, 72)", "(72,)"};
    static const size_t values[] = {50 * 72, 50 * 50 * 71, TABLE, 0, 72, 72};
    double *zeros = calloc(TABLE, sizeof *zeros);
    assert_non_null(zeros);
    for (int i = 0; i < 6; i++) {
        put_table(path, "'<f8'", shapes[i], zeros, values[i] * sizeof *zeros);
        expect_refused(path, TIDES_BAD_FILE, "noise.npy|(rows, columns, 72)");
    }
    const double bad[] = {-1, NAN, INFINITY};
    for (int i = 0; i < 3; i++) {
        zeros[3 * BINS + 5] = bad[i];
        put_table(path, "'<f8'", "(2, 2, 72)", zeros, 4 * BINS * sizeof *zeros);
        expect_refused(path, TIDES_BAD_FILE, "noise.npy|row 3, bin 5 isn't a count");
    }
    put_table(path, "'<U1'", "(1, 1, 72)", zeros, 4 * BINS);
    expect_refused(path, TIDES_BAD_FILE, "noise.npy|isn't a count");
    put_table(path, "[('a', '<f4'), ('b', '<f4')]", "(1, 1, 72)", zeros, 8 * BINS); /* no plain numbers */
    expect_refused(path, TIDES_BAD_FILE, "noise.npy|isn't a count");
    put_table(path, "'<f8'", "(50, 50, 72)", zeros, 1000); /* cut off */
    expect_refused(path, TIDES_BAD_FILE, "noise.npy");
    scene_file_write(path, "72 numbers", 10);
    expect_refused(path, TIDES_BAD_FILE, "noise.npy");
    expect_refused(scene_in_folder(*state, "absent.npy"), TIDES_FILE_NOT_FOUND, "absent.npy");
    free(zeros);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(one_rate, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(silent_pixels, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(drawn_rates, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(wrong_tables, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
