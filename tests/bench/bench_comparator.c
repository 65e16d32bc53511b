/* Time of the comparator per quiet pixel, per busy pixel and per event, and of the sort per event. Prints a line for each; not
 * part of `make check`. */
#include "sensor/td_sensor.h"
#include "signal/td_event_sort.h"
#include "td_base.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 16, PIXELS = WIDTH * WIDTH, TILES = 16, SORTED = 1000000 };

static const char *const MODELS[] = {"linear", "quadratic", "hermite", "secant"};

static double S0[PIXELS], S0_dot[PIXELS], S1[PIXELS], S1_dot[PIXELS];

/* xorshift64*: Vigna 2016. */
static double uniform(uint64_t *state) {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return (double)(*state * 2685821657736338717ULL >> 11) * 0x1p-53;
}

/* A tile whose signals rise by up to `rise` within a 1 ms step. */
static void make_tile(double rise) {
    uint64_t random = 1;
    for (int i = 0; i < PIXELS; i++) {
        double change = rise * (2.0 * uniform(&random) - 1.0);
        S0[i] = -3.0 * uniform(&random);
        S1[i] = S0[i] + change;
        S0_dot[i] = 1e3 * change * (0.5 + uniform(&random));
        S1_dot[i] = 1e3 * change * (0.5 + uniform(&random));
    }
}

static void bench_tiles(int32_t model, double rise) {
    tides_sensor ideal;
    td_sensor sensor;
    td_tile tile = {0, 0, WIDTH, PIXELS};
    td_signals signals = {S0, S0_dot, S1, S1_dot};
    td_work work = {.events = {0}};
    td_step step;
    tides_error error;
    tides_sensor_defaults(&ideal);
    if (td_step_between(0.0, 1e-3, &step, &error) != TIDES_OK ||
        td_sensor_create(&ideal, model, 1e-3, 0, &(const td_sensor_tiles){&tile, 1, WIDTH}, &sensor, &error) != TIDES_OK) {
        fprintf(stderr, "%s\n", error.text);
        exit(1);
    }
    make_tile(rise);
    double spent = 0.0, least = INFINITY; /* the fastest round: the others shared the machine */
    size_t compared = 0;
    td_sensor_begin(&sensor, S0, NULL);
    while (spent < 0.3) {
        double lasted = 0;
        for (int repeat = 0; repeat < TILES; repeat++) {
            work.events.count = 0;
            if (rise > 0.2) td_sensor_begin(&sensor, S0, NULL);
            double before = td_now();
            if (td_sensor_step(&sensor, &step, &tile, 0, &(td_seen){.signals = &signals}, &work, &error) != TIDES_OK) {
                fprintf(stderr, "%s\n", error.text);
                exit(1);
            }
            lasted += td_now() - before;
        }
        if (lasted < least) least = lasted;
        spent += lasted;
        compared += (size_t)TILES * PIXELS;
    }
    const td_sensor_counts counts = work.counts;
    spent = least / TILES / PIXELS * (double)compared;
    uint64_t events = counts.events_on + counts.events_off;
    printf("%-9s  rise %5.2f  %6.2f ns/pixel  solved %5.1f %%", MODELS[model], rise, 1e9 * spent / (double)compared,
           100.0 * (double)counts.solved / (double)compared);
    if (events) printf("  %6.1f ns/event  %4.1f events/pixel", 1e9 * spent / (double)events, (double)events / (double)compared);
    printf("\n");
    td_work_release(&work);
    td_sensor_release(&sensor);
}

/* A packet of 1 ms of a 346x260 sensor, tile by tile as the comparator leaves it. */
static void bench_sort(void) {
    tides_event *events = calloc(SORTED, sizeof *events), *scratch = calloc(SORTED, sizeof *scratch);
    if (!events || !scratch) exit(1);
    uint64_t random = 2;
    double spent = 0.0;
    int rounds = 0;
    for (; spent < 0.3; rounds++) {
        for (int i = 0; i < SORTED; i++) {
            events[i].t = 5000000000 + (int64_t)(1e6 * uniform(&random));
            events[i].x = (uint16_t)(346.0 * uniform(&random));
            events[i].y = (uint16_t)(260.0 * uniform(&random));
            events[i].polarity = uniform(&random) < 0.5 ? -1 : 1;
        }
        double before = td_now();
        td_event_sort(events, scratch, SORTED);
        spent += td_now() - before;
    }
    printf("sort       %.1f ns/event  %.1f M events/s\n", 1e9 * spent / rounds / SORTED, 1e-6 * SORTED * rounds / spent);
    free(events);
    free(scratch);
}

int main(void) {
    for (int32_t model = TIDES_MODEL_LINEAR; model <= TIDES_MODEL_SECANT; model++) {
        bench_tiles(model, 0.05); /* all quiet */
        bench_tiles(model, 0.4);  /* about half cross once */
        bench_tiles(model, 8.0);  /* 20 events a pixel */
    }
    bench_sort();
    return 0;
}
