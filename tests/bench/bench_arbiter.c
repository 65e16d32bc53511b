/* Events per second through the readout arbiter on one core: scanner at ease, saturated, with drops and jitter. */
#include "tides/readout.h"

#include "sensor/td_random.h"
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

int main(void) {
    tides_event *events = calloc(EVENTS, sizeof *events);
    if (!events) return 1;
    for (size_t i = 0; i < EVENTS; i++) { /* 20 a microsecond, an edge that crosses tile after tile */
        td_random_bits bits = td_random(1, 0, i, TD_RANDOM_NOISE);
        events[i].t = (int64_t)i * 50;
        events[i].x = (uint16_t)((i / 20000 + bits.word[0] % 4) % WIDTH);
        events[i].y = (uint16_t)(i / 20 % 16 * 16 + bits.word[1] % 16);
        events[i].polarity = (int8_t)(bits.word[2] & 1 ? 1 : -1);
    }
    tides_readout quiet;
    tides_readout_defaults(&quiet);
    quiet.eta = quiet.gamma_sigma_s = 0;
    struct {
        const char *name;
        tides_readout readout;
    } cases[] = {{"infinite rate", quiet},  {"bottleneck, at ease", quiet},
                 {"tiles, at ease", quiet}, {"tiles, saturated", quiet},
                 {"rows", quiet},           {"drops", quiet},
                 {"jitter", quiet}};
    cases[0].readout.tick_s = 0;
    cases[1].readout.kind = TIDES_READOUT_BOTTLENECK;
    cases[1].readout.k0 = 1000;
    cases[3].readout.k0 = 8;
    cases[4].readout.kind = TIDES_READOUT_ROWS;
    cases[5].readout.kind = cases[6].readout.kind = TIDES_READOUT_BOTTLENECK;
    cases[5].readout.k0 = cases[6].readout.k0 = 1000;
    cases[5].readout.p0 = 0.1;
    cases[6].readout.sigma0_s = 1e-6;
    printf("%-22s %12s\n", "readout", "Mevents/s");
    int failed = 0;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double seconds = measure(&cases[i].readout, events);
        failed |= seconds < 0;
        printf("%-22s %12.1f\n", cases[i].name, EVENTS / seconds * 1e-6);
    }
    free(events);
    return failed;
}
