/* Events per second through the readout arbiter on one core: with no event waiting, some waiting, saturated, with drops, and
 * with jitter. */
#include "tides/readout.h"

#include "td_random.h"
#include "td_base.h"

#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 346, HEIGHT = 260, EVENTS = 4000000, PACKET = 65536, TRIES = 3 };

static int count_events(void *user, const tides_event *events, const int64_t *fired, size_t count) {
    (void)events, (void)fired;
    *(size_t *)user += count;
    return 0;
}

/* Seconds that all events take, the best of a few tries; below 0 where something fails. */
static double measure(const tides_readout *readout, const tides_event *events) {
    double best = 1e9;
    for (int i = 0; i < TRIES; i++) {
        tides_error error = {0};
        tides_arbiter *arbiter = NULL;
        size_t out = 0;
        tides_status status = tides_arbiter_create(readout, WIDTH, HEIGHT, 1, &arbiter, &error);
        double begun = td_now();
        for (size_t at = 0; at < EVENTS && status == TIDES_OK; at += PACKET) {
            size_t count = EVENTS - at < PACKET ? EVENTS - at : PACKET;
            status = tides_arbiter_push(arbiter, events + at, count, count_events, &out, &error);
        }
        if (status == TIDES_OK) status = tides_arbiter_finish(arbiter, count_events, &out, &error);
        double seconds = td_now() - begun;
        tides_arbiter_destroy(arbiter);
        if (status != TIDES_OK) {
            fprintf(stderr, "bench_arbiter: %s\n", error.text);
            return -1;
        }
        best = seconds < best ? seconds : best;
    }
    return best;
}

/* How the events of a microsecond, the scanner's tick, lie on the sensor, 20 at a time as an edge of 16 rows goes along. */
typedef enum event_pattern {
    ONE_TILE,  /* all in one tile: 20 are fewer than it may release, so none waits */
    TWO_TILES, /* in two neighbours: the scanner goes to both, so the edge's tiles have queues, as long as it passes them */
    SPREAD     /* anywhere: each in a queue of its own, which waits for the scanner to come round */
} event_pattern;

static void make_events(event_pattern pattern, tides_event *events) {
    for (size_t i = 0; i < EVENTS; i++) {
        td_random_bits bits = td_random(1, 0, i, TD_RANDOM_NOISE);
        const uint32_t x = bits.word[0], y = bits.word[1], step = (uint32_t)(i / 20);
        events[i] = (tides_event){.t = (int64_t)i * 50, .polarity = (int8_t)(bits.word[2] & 1 ? 1 : -1)};
        events[i].x =
            (uint16_t)(pattern == SPREAD ? x % WIDTH : (step / 1000 * 16 + x % (pattern == TWO_TILES ? 32 : 16)) % 320);
        events[i].y = (uint16_t)(pattern == SPREAD ? y % HEIGHT : step % 16 * 16 + y % 16);
    }
}

int main(void) {
    tides_event *events = calloc(EVENTS, sizeof *events);
    if (!events) return 1;
    tides_readout quiet;
    tides_readout_defaults(&quiet);
    quiet.eta = quiet.gamma_sigma_s = 0;
    struct {
        const char *name;
        event_pattern pattern;
        tides_readout readout;
    } cases[] = {{"infinite rate", ONE_TILE, quiet},
                 {"bottleneck, none waits", ONE_TILE, quiet},
                 {"tiles, none waits", ONE_TILE, quiet},
                 {"tiles, two at a time", TWO_TILES, quiet},
                 {"tiles, all over", SPREAD, quiet},
                 {"tiles, saturated", TWO_TILES, quiet},
                 {"rows", TWO_TILES, quiet},
                 {"drops", ONE_TILE, quiet},
                 {"jitter", ONE_TILE, quiet}};
    cases[0].readout.tick_s = 0;
    cases[1].readout.kind = TIDES_READOUT_BOTTLENECK;
    cases[5].readout.k0 = 8;
    cases[6].readout.kind = TIDES_READOUT_ROWS;
    cases[7].readout.p0 = 0.1;
    cases[8].readout.sigma0_s = 1e-6;
    printf("%-24s %12s\n", "readout", "Mevents/s");
    int failed = 0;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        make_events(cases[i].pattern, events);
        double seconds = measure(&cases[i].readout, events);
        failed |= seconds < 0;
        printf("%-24s %12.1f\n", cases[i].name, EVENTS / seconds * 1e-6);
    }
    free(events);
    return failed;
}
