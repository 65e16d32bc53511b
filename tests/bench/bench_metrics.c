/* How long tides_metrics_compare takes and what memory it needs: two generated streams, one family of metrics at a time, then
 * all of the default ones. usage: bench_metrics [EVENTS [PX_PER_S]]   default 10 million in each stream, 500 px/s
 *
 * The image is edges that move to the right over a 346x260 sensor, every pixel with its own delay; the simulated stream is the
 * same with jitter, a few events too many and a few too few. */
#include "signal/td_event_sort.h"
#include "td_base.h"
#include "tides/metrics.h"

#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 346, HEIGHT = 260, EDGE_PX = 40 };

/* xorshift64*: Vigna 2016. */
static double uniform(uint64_t *state) {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return (double)(*state * 2685821657736338717ULL >> 11) * 0x1p-53;
}

/* Edge after edge crosses pixel after pixel: `count` events in order of time, times floored to microseconds. */
static void make_stream(tides_event *events, tides_event *scratch, size_t count, double speed, uint64_t seed, double jitter_s) {
    const double edges_per_s = speed / EDGE_PX, rate = edges_per_s * WIDTH * HEIGHT;
    uint64_t random = seed;
    for (size_t i = 0; i < count; i++) {
        const int x = (int)(WIDTH * uniform(&random)), y = (int)(HEIGHT * uniform(&random));
        const double edge = (double)(int64_t)((double)count / rate * edges_per_s * uniform(&random));
        const double time = 1.0 + edge / edges_per_s + x / speed + 1e-3 * ((x * 7 + y * 13) % 16) + jitter_s * uniform(&random);
        events[i] = (tides_event){.t = (int64_t)(1e6 * time) * 1000,
                                  .x = (uint16_t)x,
                                  .y = (uint16_t)y,
                                  .polarity = (int64_t)edge % 2 ? 1 : -1};
    }
    td_event_sort(events, scratch, count);
}

static double measure(const tides_event *a, size_t count_a, const tides_event *b, size_t count_b, uint32_t wanted,
                      tides_metrics *metrics) {
    tides_metrics_options options;
    tides_error error;
    tides_metrics_options_defaults(&options);
    options.wanted = wanted;
    options.width = WIDTH;
    options.height = HEIGHT;
    const double before = td_now();
    if (tides_metrics_compare(a, count_a, b, count_b, &options, NULL, NULL, metrics, &error) != TIDES_OK) {
        fprintf(stderr, "%s\n", error.text);
        exit(1);
    }
    return td_now() - before;
}

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        uint32_t wanted;
    } families[] = {{"counts", TIDES_METRIC_COUNTS},         {"intervals", TIDES_METRIC_ISI},
                    {"Same-ts", TIDES_METRIC_SAME_TIME},     {"Fano", TIDES_METRIC_FANO},
                    {"Chamfer", TIDES_METRIC_CHAMFER},       {"Victor-Purpura", TIDES_METRIC_VICTOR_PURPURA},
                    {"van Rossum", TIDES_METRIC_VAN_ROSSUM}, {"time difference", TIDES_METRIC_TIME_DIFFERENCE},
                    {"default", TIDES_METRICS_DEFAULT},      {"match", TIDES_METRIC_MATCH}};
    const size_t count = argc > 1 ? strtoul(argv[1], NULL, 10) : 10000000, fewer = count - count / 50;
    const double speed = argc > 2 ? strtod(argv[2], NULL) : 500.0;
    tides_event *a = calloc(count + 1, sizeof *a), *b = calloc(count + 1, sizeof *b);
    tides_event *scratch = calloc(count + 1, sizeof *scratch);
    tides_metrics metrics;
    if (!a || !b || !scratch || !(speed > 0)) exit(1);
    make_stream(a, scratch, count, speed, 1, 1e-3);
    make_stream(b, scratch, fewer, speed, 2, 2e-3);
    free(scratch);
    printf("%zu against %zu events over %.2f s, %dx%d px\n", count, fewer, 1e-9 * (double)(a[count - 1].t - a[0].t), WIDTH,
           HEIGHT);
    for (size_t i = 0; i < sizeof families / sizeof families[0]; i++) {
        const double spent = measure(a, count, b, fewer, families[i].wanted, &metrics);
        printf("%-16s %7.2f s  peak memory %.2f GB\n", families[i].name, spent, 1e-9 * (double)td_peak_memory());
    }
    free(a);
    free(b);
    return 0;
}
