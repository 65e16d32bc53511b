/* Time of the photoreceptor's filters per pixel and step: the update, and update plus crossings; first-order filters one by one
 * and in a vector. Prints a line for each; not part of `make check`. */
#include "sensor/response/td_frontend.h"
#include "td_base.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { PIXELS = 4096 };
static const double H = 1e-3, LOG_EPS = 0.001;

static double control[4][PIXELS], state[PIXELS][TD_FRONTEND_STATE], S[PIXELS], after[PIXELS], low[PIXELS], high[PIXELS];

/* xorshift64*: Vigna 2016. */
static double uniform(uint64_t *seed) {
    *seed ^= *seed >> 12;
    *seed ^= *seed << 25;
    *seed ^= *seed >> 27;
    return (double)(*seed * 2685821657736338717ULL >> 11) * 0x1p-53;
}

/* Pixels that change by up to `rise` within the step, as curved as step control lets them be, and have moved so before. */
static void make_pixels(const td_frontend *frontend, double rise) {
    uint64_t seed = 1;
    for (int i = 0; i < PIXELS; i++) {
        double L = -3 * uniform(&seed), change = rise * (2 * uniform(&seed) - 1);
        double bend = 0.01 * (2 * uniform(&seed) - 1), first = change / 3 + bend * rise, last = change / 3 - bend * rise;
        td_model before = {{L - change, L - change + last, L - first, L}},
                 now = {{L, L + first, L + change - last, L + change}};
        td_response response;
        td_frontend_rest(frontend, L - change, LOG_EPS, state[i]);
        td_frontend_step(frontend, H, &before, LOG_EPS, state[i], &response, NULL);
        S[i] = state[i][0];
        for (int k = 0; k < 4; k++) control[k][i] = now.control[k];
    }
}

static void bench(const char *name, const td_frontend *frontend, double rise, int cross) {
    make_pixels(frontend, rise);
    double spent = 0;
    long pixels = 0, events = 0, substeps = 0;
    for (; spent < 0.3; pixels += PIXELS) {
        double begun = td_now();
        for (int i = 0; i < PIXELS; i++) {
            td_model input = {{control[0][i], control[1][i], control[2][i], control[3][i]}};
            double memory[TD_FRONTEND_STATE] = {state[i][0], state[i][1], state[i][2], state[i][3]}, from = 0;
            double reference = memory[0];
            td_response response;
            td_frontend_step(frontend, H, &input, LOG_EPS, memory, &response, NULL);
            substeps += response.source.frontend != NULL;
            for (int polarity; cross && (polarity = td_response_crossing(&response, reference, 0.2, 0.2, from, 1, &from)) != 0;
                 events++)
                reference += 0.2 * polarity;
        }
        spent += td_now() - begun;
    }
    printf("%-22s rise %4.2f  %-8s %8.1f ns/pixel  %4.2f events/pixel  in substeps %3.0f %%\n", name, rise,
           cross ? "crossed" : "update", 1e9 * spent / (double)pixels, (double)events / (double)pixels,
           100.0 * (double)substeps / (double)pixels);
}

static void bench_many(const td_frontend *frontend, double rise) {
    const td_filter_block block = {PIXELS, {control[0], control[1], control[2], control[3]}, {S}, {after}, low, high};
    make_pixels(frontend, rise);
    double spent = 0;
    long pixels = 0;
    for (; spent < 0.3; pixels += PIXELS) {
        double begun = td_now();
        td_frontend_step_many(frontend, H, &block);
        spent += td_now() - begun;
    }
    printf("%-22s rise %4.2f  %-8s %8.1f ns/pixel\n", "first order, many", rise, "update", 1e9 * spent / (double)pixels);
}

int main(void) {
    static const char *const name[] = {"off", "first order", "first order, by light", "circuit"};
    for (int kind = TD_FRONTEND_OFF; kind <= TD_FRONTEND_CIRCUIT; kind++) {
        tides_sensor sensor;
        tides_sensor_defaults(&sensor);
        sensor.photoreceptor_cutoff_hz = kind == TD_FRONTEND_OFF ? 0 : 300;
        sensor.photoreceptor_law = kind == TD_FRONTEND_INTENSITY;
        sensor.bandwidth = kind == TD_FRONTEND_CIRCUIT;
        td_frontend frontend;
        tides_error error;
        if (td_frontend_make(&sensor, &frontend, &error) != TIDES_OK) {
            fprintf(stderr, "%s\n", error.text);
            return 1;
        }
        for (int cross = 0; cross < 2; cross++) {
            bench(name[kind], &frontend, 0, cross);
            bench(name[kind], &frontend, 0.05, cross);
            bench(name[kind], &frontend, 1, cross);
        }
        if (kind == TD_FRONTEND_CONSTANT) bench_many(&frontend, 0.05);
    }
    return 0;
}
