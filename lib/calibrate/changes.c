/* By how much the low-passed logarithm moves between a pixel's events: a first-order low-pass of straight lines, exactly. With
 * x = x0 + m t from a sample on, y' = (x - y) / tau has y = x - m tau + (y0 - x0 + m tau) e^(-t / tau). */
#include "td_calibrate.h"

#include "td_math.h"

#include <math.h>

#define SETTLES 8.0 /* a filter begins so many time constants before its first event */

/* The pole's time constant in light Y; by v2e's law the cutoff is proportional to (255 Y + 20) / 275. */
static double pole_at(const td_front *front, float Y) {
    return front->law ? front->pole_s * 275 / (255 * (double)Y + 20) : front->pole_s;
}

/* A filter on its way along one pixel's samples. */
typedef struct walk {
    const td_light *light;
    const td_front *front;
    const float *L, *Y;
    size_t at;     /* the next sample */
    double signal; /* the filter's output at the time reached */
} walk;

static double settled_for(const td_front *front) { return front->law ? pole_at(front, 0) : front->pole_s; }

/* The last sample before `time`, or the first of all. */
static size_t sample_before(const td_light *light, double time) {
    size_t low = 0, high = light->samples - 1;
    while (high - low > 1) {
        const size_t mid = (low + high) / 2;
        if (light->time[mid] <= time)
            low = mid;
        else
            high = mid;
    }
    return low;
}

/* Starts the filter at rest, long enough before `from`. Logarithms are computed up to `to` only. */
static walk begin(td_light *light, size_t place, const td_front *front, double from, double to) {
    walk w = {.light = light, .front = front, .L = light->line, .Y = light->Y + place * light->samples};
    const size_t last = sample_before(light, to) + 1;
    const float eps = (float)front->log_eps;
    w.at = sample_before(light, from - SETTLES * settled_for(front));
    for (size_t k = w.at; k <= last; k++) light->line[k] = (float)td_ln((double)(w.Y[k] + eps));
    w.signal = w.L[w.at];
    return w;
}

static double within(const walk *w, double dt, double decay, double tau) {
    const double x0 = w->L[w->at], m = (w->L[w->at + 1] - x0) / (w->light->time[w->at + 1] - w->light->time[w->at]);
    return tau > 0 ? x0 + m * (dt - tau) + (w->signal - x0 + m * tau) * decay : x0 + m * dt;
}

static double tau_here(const walk *w) {
    return w->front->law ? pole_at(w->front, 0.5f * (w->Y[w->at] + w->Y[w->at + 1])) : w->front->pole_s;
}

/* Advances to `time`, which is never before the last one, and returns the signal; NaN where light isn't known. */
static double walk_to(walk *w, double time) {
    const td_light *light = w->light;
    if (time < light->time[0] || time >= light->time[light->samples - 1]) return NAN;
    while (light->time[w->at + 1] <= time) {
        const double dt = light->time[w->at + 1] - light->time[w->at], tau = tau_here(w);
        const double decay = !w->front->law ? light->decay[w->at] : tau > 0 ? td_exp(-dt / tau) : 0;
        w->signal = within(w, dt, decay, tau);
        w->at++;
    }
    const double dt = time - light->time[w->at], tau = tau_here(w);
    return within(w, dt, tau > 0 ? td_exp(-dt / tau) : 0, tau);
}

static void prepare(td_light *light, const td_front *front) {
    for (size_t i = 0; i + 1 < light->samples; i++)
        light->decay[i] = front->pole_s > 0 ? td_exp(-(light->time[i + 1] - light->time[i]) / front->pole_s) : 0;
}

/* When the last pair of the pixel of pair `at` ends [s]. */
static double pixels_end(const td_pairs *pairs, size_t at) {
    size_t last = at;
    while (last + 1 < pairs->count && pairs->list[last + 1].place == pairs->list[at].place) last++;
    return pairs->list[last].to;
}

void td_changes(td_light *light, td_pairs *pairs, const td_front *front, const td_part *part) {
    walk w = {.at = 0};
    uint32_t place = UINT32_MAX;
    double reached = -INFINITY;
    prepare(light, front);
    for (size_t i = 0; i < pairs->count; i++) {
        const td_pair *p = &pairs->list[i];
        const double hold = fmin(front->refractory_s, p->to - p->from);
        const double from = p->from + hold - front->offset_s, to = p->to - front->offset_s;
        pairs->change[i] = NAN;
        if (!td_in_part(p, light->pixel[p->place], part)) continue;
        if (p->place != place || from < reached) {
            place = p->place;
            w = begin(light, place, front, from, pixels_end(pairs, i) - front->offset_s);
        }
        const double before = walk_to(&w, from);
        const double change = (walk_to(&w, to) - before) * p->after;
        pairs->change[i] = change == change ? change : INFINITY;
        reached = to;
    }
}
