/* Cost of each block of the sensor per pixel and step, with few events, beside ideal pixels. Runs alternate, so that other load
 * affects all alike. Prints a line for each; not part of `make check`. */
#include "sensor/td_sensor.h"
#include "td_base.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 16, PIXELS = WIDTH * WIDTH, STEPS = 200, ROUNDS = 5, BLOCKS = 13 };

static double S[PIXELS], rate[PIXELS], coverage[PIXELS];

/* Block number k alone; 0: the sensor with nothing that acts; the last: ideal pixels. */
static tides_sensor block(int k, const char **name) {
    static const char *const names[BLOCKS] = {"nothing", "mismatch",   "leak",     "refractory",
                                              "b_min",   "shot noise", "hot",      "low-pass",
                                              "circuit", "v2e's pole", "additive", "the same behind a low-pass",
                                              "ideal"};
    tides_sensor s;
    tides_sensor_defaults(&s);
    *name = names[k];
    if (k == 0) s.dead_pixel_fraction = 1e-12;
    if (k == 1) s.threshold_sigma = 0.02;
    if (k == 2) s.leak_rate_hz = 0.1;
    if (k == 3) s.refractory_s = 1e-3;
    if (k == 4) s.b_min = 0.1;
    if (k == 5) s.shot_noise_hz = 5;
    if (k == 6) s.hot_pixel_fraction = 1e-3;
    if (k == 7) s.photoreceptor_cutoff_hz = 300;
    if (k == 8) s.bandwidth = TIDES_BANDWIDTH_CIRCUIT;
    if (k == 9) s.photoreceptor_cutoff_hz = 300;
    if (k == 9) s.photoreceptor_law = TIDES_PHOTORECEPTOR_INTENSITY;
    if (k == 10 || k == 11) s.noise_rms = 0.02;
    if (k == 11) s.photoreceptor_cutoff_hz = 300;
    return s;
}

/* [ns] per pixel and step of 1 ms. */
static double run(td_sensor *sensor) {
    const td_tile tile = {0, 0, WIDTH, PIXELS};
    const td_signals signals = {S, rate, S, rate};
    const td_coverage cover = {coverage, coverage};
    td_work work = {.events = {0}};
    tides_error error = {TIDES_OK, ""};
    td_sensor_begin(sensor, S, NULL);
    double begun = td_now();
    for (int k = 0; k < STEPS; k++) {
        td_step step;
        tides_status status = td_step_between(k * 1e-3, (k + 1) * 1e-3, &step, &error);
        step.stop_ns--;
        if (status == TIDES_OK)
            status = td_sensor_step(sensor, &step, &tile, 0, &(td_seen){.signals = &signals, .coverage = cover}, &work, &error);
        if (status != TIDES_OK) {
            fprintf(stderr, "%s\n", error.text);
            exit(1);
        }
        work.events.count = 0;
    }
    free(work.events.events);
    return 1e9 * (td_now() - begun) / ((double)STEPS * PIXELS);
}

static double best(double a, double b) { return a < b ? a : b; }

int main(void) {
    double took[BLOCKS];
    const td_tile tile = {0, 0, WIDTH, PIXELS};
    for (int i = 0; i < PIXELS; i++) {
        S[i] = -3.0 * i / PIXELS;
        rate[i] = i % 2 ? 1 : -1; /* a wobble of 2e-4 in each step */
        coverage[i] = 1;
    }
    for (int k = 0; k < BLOCKS; k++) took[k] = INFINITY;
    const char *name;
    for (int round = 0; round < ROUNDS; round++) {
        for (int k = 0; k < BLOCKS; k++) {
            tides_sensor params = block(k, &name);
            td_sensor sensor;
            if (td_sensor_create(&params, TIDES_MODEL_HERMITE, 1e-3, 0, &(const td_sensor_tiles){&tile, 1, WIDTH}, &sensor,
                                 NULL) != TIDES_OK)
                return 1;
            took[k] = best(took[k], run(&sensor));
            td_sensor_release(&sensor);
        }
    }
    for (int k = 0; k < BLOCKS; k++) {
        block(k, &name);
        printf("%-26s %7.2f ns/pixel\n", name, took[k]);
    }
    return 0;
}
