/* Additive noise: variance, correlation and spectrum are within 3 standard errors of the parameters, and a path doesn't depend
 * on how it is computed. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "sensor/noise/td_noise_bridge.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t SEED = 99173;
static const double pi = 3.14159265358979323846, rms = 0.15, cutoff_hz = 200;
enum { PIXELS = 120000 };

static td_additive_noise make(uint64_t seed) {
    tides_sensor sensor;
    td_additive_noise noise;
    tides_error error;
    tides_sensor_defaults(&sensor);
    sensor.seed = seed;
    sensor.noise_rms = rms;
    sensor.noise_cutoff_hz = cutoff_hz;
    scene_expect_ok(td_additive_noise_make(&sensor, 0, &noise, &error), &error);
    return noise;
}

/* The mean of `count` values is `wanted` within 3 of its standard errors. */
static void expect_mean(const double *value, size_t count, double wanted, const char *what) {
    double mean = 0, spread = 0;
    for (size_t i = 0; i < count; i++) mean += value[i] / (double)count;
    for (size_t i = 0; i < count; i++) spread += (value[i] - mean) * (value[i] - mean) / (double)count;
    double error = sqrt(spread / (double)count);
    print_message("%s: %.6g, wanted %.6g, %.2f standard errors\n", what, mean, wanted, (mean - wanted) / error);
    assert_true(fabs(mean - wanted) < 3 * error);
}

static td_noise_segment first_line(const td_additive_noise *noise, uint32_t pixel) {
    return td_additive_noise_resume(noise, pixel, 0, td_additive_noise_first(noise, pixel, 0), 0);
}

static double noise_at(const td_additive_noise *noise, uint32_t pixel, double time_ns) {
    td_noise_segment line = first_line(noise, pixel);
    td_additive_noise_seek(noise, pixel, time_ns, &line);
    assert_true(line.from_ns <= time_ns && time_ns <= line.to_ns);
    return td_noise_value(noise, pixel, &line, time_ns);
}

/* -- statistics ------------------------------------------------------------------------------------------------------------ */

/* At grid points: stationary from the first, correlated by e^(-lag / tau). */
static void test_points(void **state) {
    enum { POINTS = 9 };
    td_additive_noise noise = make(SEED);
    double *value = calloc((size_t)PIXELS * (POINTS + 1), sizeof *value), tau_ns = 1e9 / (2 * pi * cutoff_hz);
    (void)state;
    assert_non_null(value);
    double *product = value + (size_t)PIXELS * POINTS;
    for (uint32_t p = 0; p < PIXELS; p++) {
        td_noise_segment line = first_line(&noise, p);
        for (int k = 0; k < POINTS; k++) {
            value[(size_t)k * PIXELS + p] = line.begin;
            td_additive_noise_next(&noise, p, 0, &line);
        }
    }
    for (int k = 0; k < POINTS; k += 4) {
        expect_mean(value + (size_t)k * PIXELS, PIXELS, 0, "mean at a point");
        for (int lag = 0; k + lag < POINTS; lag += 4) {
            char what[80];
            for (size_t i = 0; i < PIXELS; i++)
                product[i] = value[(size_t)k * PIXELS + i] * value[(size_t)(k + lag) * PIXELS + i];
            snprintf(what, sizeof what, "covariance of points %d and %d", k, k + lag);
            expect_mean(product, PIXELS, noise.sigma * noise.sigma * exp(-lag * noise.spacing_ns / tau_ns), what);
        }
    }
    free(value);
}

/* At any time, points of the grid or not: the process's variance and covariance, but for what straight segments between the
 * extremes of a part have too much, which is no more correlated than parts are. */
static void test_times(void **state) {
    static const double lags[] = {0.03, 0.1, 0.4, 1, 2, 5}; /* of the grid's spacing */
    td_additive_noise noise = make(SEED + 1);
    const double excess = 0.0054; /* of the variance: td_noise_bridge.h */
    double *product = calloc(PIXELS, sizeof *product), at = 5.1e5;
    (void)state;
    assert_non_null(product);
    for (uint32_t p = 0; p < PIXELS; p++) product[p] = pow(noise_at(&noise, p, at), 2);
    expect_mean(product, PIXELS, rms * rms * (1 + excess), "variance at a time");
    for (size_t k = 0; k < sizeof lags / sizeof *lags; k++) {
        double lag = lags[k] * noise.spacing_ns;
        for (uint32_t p = 0; p < PIXELS; p++) product[p] = noise_at(&noise, p, at) * noise_at(&noise, p, at + lag);
        expect_mean(product, PIXELS, rms * rms * exp(-lags[k] / 2), "covariance at a lag");
    }
    for (size_t k = 2; k < sizeof lags / sizeof *lags; k++) { /* see td_noise_bridge.h for shorter ones */
        double lag = lags[k] * noise.spacing_ns;
        for (uint32_t p = 0; p < PIXELS; p++) product[p] = pow(noise_at(&noise, p, at + lag) - noise_at(&noise, p, at), 2);
        expect_mean(product, PIXELS, 2 * rms * rms * (1 + excess - exp(-lags[k] / 2)), "variance of a change");
    }
    for (uint32_t p = 0; p < PIXELS; p++) product[p] = noise_at(&noise, p, at) * noise_at(&noise, p + 1, at);
    expect_mean(product, PIXELS, 0, "covariance of neighbours");
    free(product);
}

/* The spectrum of samples, at three frequencies: Hann-windowed periodograms of many pixels, against that of the process sampled
 * likewise. The window's own width of a few per cent of the cutoff changes a smooth spectrum by less than standard errors. */
static void test_spectrum(void **state) {
    enum { SAMPLES = 4096, SERIES = 600 };
    static const double share[] = {0.5, 2, 12}; /* of the cutoff */
    td_additive_noise noise = make(SEED + 2);
    double *power = calloc(3 * (size_t)SERIES, sizeof *power), window[SAMPLES], step_ns = noise.spacing_ns / 3.3, weight = 0;
    (void)state;
    assert_non_null(power);
    for (int i = 0; i < SAMPLES; i++) {
        window[i] = 1 - cos(2 * pi * i / SAMPLES);
        weight += window[i] * window[i];
    }
    for (uint32_t p = 0; p < SERIES; p++) {
        td_noise_segment line = first_line(&noise, p);
        double re[3] = {0}, im[3] = {0};
        for (int i = 0; i < SAMPLES; i++) {
            td_additive_noise_seek(&noise, p, i * step_ns, &line);
            double x = window[i] * td_noise_value(&noise, p, &line, i * step_ns);
            for (int k = 0; k < 3; k++) {
                re[k] += x * cos(2 * pi * share[k] * cutoff_hz * i * step_ns * 1e-9);
                im[k] += x * sin(2 * pi * share[k] * cutoff_hz * i * step_ns * 1e-9);
            }
        }
        for (int k = 0; k < 3; k++) power[k * SERIES + p] = (re[k] * re[k] + im[k] * im[k]) / weight * step_ns * 1e-9;
    }
    for (int k = 0; k < 3; k++) {
        double rho = exp(-step_ns * 1e-9 * 2 * pi * cutoff_hz), turn = 2 * pi * share[k] * cutoff_hz * step_ns * 1e-9;
        double wanted = rms * rms * step_ns * 1e-9 * (1 - rho * rho) / (1 + rho * rho - 2 * rho * cos(turn));
        double lorentzian = 2 * rms * rms / (2 * pi * cutoff_hz) / (1 + share[k] * share[k]);
        print_message("at %g cutoffs %.3f of the Lorentzian\n", share[k], wanted / lorentzian);
        if (share[k] <= 3) assert_true(fabs(wanted / lorentzian - 1) < 0.02);
        expect_mean(power + k * SERIES, SERIES, wanted, "spectrum");
    }
    free(power);
}

/* -- lines ----------------------------------------------------------------------------------------------------------------- */

/* Continuous; the same from a checkpoint's numbers, and in one jump or many. */
static void test_lines(void **state) {
    td_additive_noise noise = make(SEED + 3), other = make(SEED + 4);
    (void)state;
    for (uint32_t p = 0; p < 300; p++) {
        td_noise_segment line = first_line(&noise, p), jumped = line;
        assert_true(line.from_ns <= 0 && line.to_ns > 0 && line.k == 0);
        assert_true(line.begin != td_additive_noise_first(&other, p, 0));
        for (int n = 0; n < 50; n++) {
            td_noise_segment next = line;
            td_additive_noise_next(&noise, p, 0, &next);
            assert_true(next.from_ns == line.to_ns && next.begin == line.end && next.k == line.k + 1);
            line = next;
        }
        td_noise_segment again = td_additive_noise_resume(&noise, p, line.k, line.begin, 0);
        assert_memory_equal(&again, &line, sizeof line);
        td_additive_noise_seek(&noise, p, 0.5 * (line.from_ns + line.to_ns), &jumped);
        assert_memory_equal(&jumped, &line, sizeof line);
    }
}

static void expect_same(const td_noise_segment *a, const td_noise_segment *b) {
    assert_true(a->k == b->k && a->begin == b->begin && a->end == b->end && a->reach == b->reach);
    assert_true(a->from_ns == b->from_ns && a->to_ns == b->to_ns && a->origin_ns == b->origin_ns);
}

/* Of many pixels side by side, over steps of any length: the lines that each comes to by itself, and its bounds on the way. The
 * paths that a sweep leaves have the same lines, and those that are longer than there is room for go on behind it. */
static void test_sweep(void **state) {
    enum { COUNT = TD_RANDOM_LANES + 5, SWEEPS = 60 };
    td_additive_noise noise = make(SEED + 5);
    td_noise_segment line[COUNT];
    uint32_t pixel[COUNT];
    double k[COUNT], value[COUNT], low[COUNT], high[COUNT], origin[COUNT], now = 0, path[2 * TD_RANDOM_LANES * TD_NOISE_PATH];
    td_noise_path paths[COUNT];
    int along = 0, behind = 0;
    (void)state;
    for (int i = 0; i < COUNT; i++) {
        pixel[i] = (uint32_t)(7 * i);
        line[i] = first_line(&noise, pixel[i]);
        k[i] = 0;
        value[i] = line[i].begin;
        origin[i] = td_additive_noise_origin(&noise, pixel[i]);
    }
    for (int n = 0; n < SWEEPS; n++) {
        double length = noise.spacing_ns * (n % 3 == 0 ? 0.01 : n % 3 == 1 ? 1.7 : 40.0 + n);
        const td_noise_sweep sweep = {k, value, low, high, NULL, NULL, path, paths, origin};
        td_additive_noise_sweep(&noise, now, length, pixel, COUNT, &sweep);
        for (int i = 0; i < COUNT; i++) {
            double least = fmin(line[i].begin, line[i].end), most = fmax(line[i].begin, line[i].end);
            td_noise_segment at = td_additive_noise_along(&noise, pixel[i], line[i].k, line[i].begin, 0, &paths[i]);
            expect_same(&at, &line[i]);
            while (td_place_of(line[i].to_ns, now, length) < 1) {
                td_additive_noise_next(&noise, pixel[i], 0, &line[i]);
                td_additive_noise_next_along(&noise, pixel[i], 0, &paths[i], &at);
                expect_same(&at, &line[i]);
                along += paths[i].x != NULL;
                behind += paths[i].x == NULL;
                least = fmin(least, line[i].end);
                most = fmax(most, line[i].end);
            }
            assert_true(k[i] == (double)line[i].k && value[i] == line[i].begin);
            assert_true(low[i] == least && high[i] == most);
        }
        now += length;
    }
    assert_true(along > 10000 && behind > 1000);
}

static void test_refused(void **state) {
    static const double bad[][2] = {{-1, 100}, {NAN, 100}, {INFINITY, 100}, {1, 0}, {1, -3}, {1, NAN}, {1, 1e9}};
    (void)state;
    tides_sensor sensor;
    td_additive_noise noise;
    tides_error error;
    tides_sensor_defaults(&sensor);
    assert_int_equal(td_additive_noise_make(&sensor, 0, &noise, &error), TIDES_OK);
    assert_int_equal(noise.on, 0);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sensor.noise_rms = bad[i][0];
        sensor.noise_cutoff_hz = bad[i][1];
        assert_int_equal(td_additive_noise_make(&sensor, 0, &noise, &error), TIDES_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, i < 3 ? "noise_rms" : "noise_cutoff_hz"));
    }
}

int main(void) {
    print_message("seed %d\n", (int)SEED);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_points), cmocka_unit_test(test_times), cmocka_unit_test(test_spectrum),
        cmocka_unit_test(test_lines),  cmocka_unit_test(test_sweep), cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
