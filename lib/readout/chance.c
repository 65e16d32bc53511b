/* Chance in the readout: which events are dropped, and by how much the times of the others jitter. */
#include "td_arbiter.h"
#include "td_random.h"

#include <math.h>

/* The random bits of an event for one purpose. Their key is the pixel, the time and the polarity. It is unique, as a pixel
 * fires at most once per polarity and nanosecond. */
static td_random_bits draw(const tides_arbiter *a, const tides_event *event, uint32_t purpose) {
    uint32_t pixel = (uint32_t)event->y * (uint32_t)a->width + event->x;
    return td_random(a->seed, pixel, 2 * (uint64_t)event->t + (event->polarity > 0), purpose);
}

int td_arbiter_drops(const tides_arbiter *a, const tides_event *event, int32_t tile) {
    if (!a->drops) return 0;
    double probability = a->readout.p0 + a->readout.eta * a->psi[tile];
    td_random_bits bits = draw(a, event, TD_RANDOM_DROP);
    return td_random_uniform(&bits, 0) < probability;
}

void td_arbiter_jitter(const tides_arbiter *a, tides_event *event, int64_t fired) {
    const tides_event before = {.t = fired, .x = event->x, .y = event->y, .polarity = event->polarity};
    double sigma = a->readout.sigma0_s + a->readout.gamma_sigma_s * a->psi[td_arbiter_tile(a, event)], normal[2];
    td_random_bits bits = draw(a, &before, TD_RANDOM_JITTER);
    td_random_normals(&bits, normal);
    if (a->readout.jitter_law == TIDES_JITTER_DELAY) normal[0] = fabs(normal[0]);
    event->t += (int64_t)llround(sigma * 1e9 * a->wide * normal[0]);
    if (event->t < a->start_ns) event->t = a->start_ns;
}
