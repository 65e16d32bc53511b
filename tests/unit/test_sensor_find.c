/* Which ideal pixels may do something in a step, and which have a level within reach, for blocks against single pixels. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "sensor/td_sensor.h"
#include "sensor/td_single.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <string.h>

static const uint64_t SEED = 2718;
static const double C = 0.2; /* [log units] */

enum { PIXELS = 256 };

/* A tile's pixels. */
typedef struct pixels {
    double S0[PIXELS], S0_dot[PIXELS], S1[PIXELS], S1_dot[PIXELS], reference[PIXELS], widen[PIXELS];
} pixels;

static const td_step step = {0, 10000000, 0, 1e7, 0.01};

static void draw(pixels *p, uint64_t *seed) {
    for (int i = 0; i < PIXELS; i++) {
        p->S0[i] = scene_between(seed, -1, 1);
        p->S1[i] = p->S0[i] + scene_between(seed, -0.1, 0.1);
        p->S0_dot[i] = scene_between(seed, -30, 30);
        p->S1_dot[i] = scene_between(seed, -30, 30);
        p->reference[i] = p->S0[i] + scene_between(seed, -C, C);
        p->widen[i] = scene_between(seed, 0, 0.05);
        if (i % 17 == 5) p->S0_dot[i] = p->S1_dot[i] = p->widen[i] = 0, p->S1[i] = p->S0[i] = p->reference[i]; /* at rest */
        if (i % 31 == 7) p->S0[i] = NAN;
        if (i % 31 == 8) p->S1[i] = NAN;
        if (i % 31 == 9) p->widen[i] = INFINITY;
        if (i % 31 == 10) p->reference[i] = 1e12;
    }
}

/* The control values' range, widened; an end that isn't a number makes it none. */
static void range_of(const pixels *p, int i, double *low, double *high) {
    const double h = step.length_s,
                 b[4] = {p->S0[i], p->S0[i] + h / 3 * p->S0_dot[i], p->S1[i] - h / 3 * p->S1_dot[i], p->S1[i]};
    *low = INFINITY, *high = -INFINITY;
    for (int k = 0; k < 4; k++) {
        if (isnan(b[k])) *low = *high = NAN;
        if (isnan(b[k])) return;
        *low = fmin(*low, b[k] - p->widen[i]);
        *high = fmax(*high, b[k] + p->widen[i]);
    }
}

static void test_find(void **state) {
    (void)state;
    static const int counts[] = {1, 7, 16, 63, 64, 65, 130, 256};
    td_sensor sensor = {.model = TIDES_MODEL_HERMITE};
    uint64_t seed = SEED;
    pixels p;
    int stay = 0, out_of_reach = 0;
    sensor.sensor.threshold_on = sensor.sensor.threshold_off = C;
    sensor.pixels.reference = p.reference;
    for (size_t n = 0; n < sizeof counts / sizeof *counts; n++) {
        const td_tile tile = {0, 0, 16, counts[n]};
        const td_signals signals = {p.S0, p.S0_dot, p.S1, p.S1_dot};
        uint8_t active[PIXELS], reaches[PIXELS];
        draw(&p, &seed);
        memset(active, 0, sizeof active);
        memset(reaches, 7, sizeof reaches);
        active[0] = 1; /* stays so */
        td_sensor_find(&sensor, &step, &tile, 0, &signals, p.widen, active);
        td_sensor_reaches(&sensor, &step, &tile, 0, &signals, p.widen, reaches);
        for (int i = 0; i < tile.count; i++) {
            double low, high;
            range_of(&p, i, &low, &high);
            const int within = low > p.reference[i] - C && high < p.reference[i] + C;
            const double from = floor((low - p.reference[i]) / C - 1e-5), to = floor((high - p.reference[i]) / C + 1e-5);
            if (active[i] != (i == 0 || !within)) fail_msg("pixel %d of %d: active %d", i, tile.count, active[i]);
            if (!isnan(low) && reaches[i] != !(from == to && fabs(from) < 1e6))
                fail_msg("pixel %d of %d: reaches %d", i, tile.count, reaches[i]);
            stay += within;
            out_of_reach += !reaches[i];
        }
        for (int i = tile.count; i < PIXELS; i++) assert_true(active[i] == 0 && reaches[i] == 7);
    }
    assert_true(stay > 50 && out_of_reach > 50);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_find)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
