/* Where the references of pixels stood when the stretch began. From there to a pixel's first event the signal moves by what was
 * left to its level: threshold_on less the start, or threshold_off and the start. Leak leaves pixels at rest between 0 and
 * threshold_on, pixels that have been reset start at 0, and others anywhere between both levels. Simulations with each of
 * these (correct.c) tell which the recording is most like. */
#include "td_calibrate.h"
#include "td_random.h"

#include <math.h>
#include <stdlib.h>

enum { FEW = 100 /* pixels */, PURPOSE = 202 /* of td_random */ };
#define NEAR 0.25 /* [thresholds] starts below are at the reference */

/* Pairs from the stretch's start to each pixel's first event. An event in a burst ends a pixel's wait and tells nothing. */
static tides_status make(const td_taken *taken, const td_light *light, td_pairs *pairs, tides_error *error) {
    pairs->list = td_alloc(light->count, sizeof *pairs->list, error);
    pairs->change = td_alloc(light->count, sizeof *pairs->change, error);
    if (!pairs->list || !pairs->change) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < light->count; i++) {
        const size_t first = taken->first[light->pixel[i]];
        if (first == taken->first[light->pixel[i] + 1] || taken->events[first].cause) continue;
        const tides_event *e = &taken->events[first];
        pairs->list[pairs->count++] =
            (td_pair){.place = (uint32_t)i, .after = e->polarity, .to = 1e-9 * (double)(e->t - taken->start_ns)};
    }
    return TIDES_OK;
}

/* The relative deviation of one of the recording's changes, drawn by chance: light that isn't quite the recording's scatters
 * its starts, and has to scatter simulated ones as much. */
static double drawn(const td_calibration *c, size_t i) {
    const td_random_bits bits = td_random(c->options->seed, (uint32_t)i, 0, PURPOSE);
    const size_t k = (size_t)(td_random_uniform(&bits, 0) * (double)c->pairs.count);
    const double usual = td_usual(&c->raw, c->pairs.list[k].after), change = c->pairs.change[k];
    return isfinite(change) && usual > 0 ? change / usual - 1 : 0;
}

static td_starts judge(const td_calibration *c, const td_pairs *pairs, const td_fit *fit, int32_t scattered) {
    double below = 0, above = 0, count = 0;
    for (size_t i = 0; i < pairs->count; i++) {
        const double change = pairs->change[i] * (scattered ? 1 + drawn(c, i) : 1);
        if (!isfinite(change)) continue;
        const double start = pairs->list[i].after > 0 ? fit->on - change : change - fit->off;
        count++;
        below += start < -NEAR * fit->off;
        above += start > NEAR * fit->on;
    }
    return count < FEW ? (td_starts){NAN, NAN} : (td_starts){below / count, above / count};
}

tides_status td_first(td_calibration *c, const td_taken *taken, const td_fit *fit, td_starts *starts, tides_error *error) {
    td_pairs pairs = {.count = 0};
    td_front front = fit->front;
    const tides_status status = make(taken, &c->light, &pairs, error);
    front.refractory_s = 0;
    if (status == TIDES_OK) {
        td_changes(&c->light, &pairs, &front, NULL);
        *starts = judge(c, &pairs, fit, taken != &c->taken);
    }
    td_pairs_free(&pairs);
    return status;
}
