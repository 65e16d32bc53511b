/* Spreads of the pairs about their medians: by transition of polarity, from pixel to pixel, over the image. Also finds hot and
 * dead pixels. */
#include "td_calibrate.h"
#include "td_math.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TILE = 4, TILE_PAIRS = 6, HOT_EVENTS = 20, FEW_NEIGHBOURS = 40 };
#define CLIP 0.8      /* greatest relative deviation from the median that counts: others have other causes */
#define HOT_TIMES 4.0 /* a hot pixel has so many times the events that its light gives */
#define DEAD_CHANGE 3 /* a dead pixel's light has moved by so many thresholds without an event */

static int32_t is_known(const td_pairs *pairs, size_t i) { return isfinite(pairs->change[i]); }

/* -- transitions ----------------------------------------------------------------------------------------------------------- */

static void transitions(td_calibration *c, tides_calibration *found) {
    static const int8_t before[] = {1, -1, -1, 1}, after[] = {1, 1, -1, -1};
    td_pairs *p = &c->pairs;
    for (int32_t k = 0; k < 4; k++) {
        size_t count = 0;
        for (size_t i = 0; i < p->count; i++)
            if (p->list[i].before == before[k] && p->list[i].after == after[k] && is_known(p, i))
                p->room[count++] = p->change[i];
        qsort(p->room, count, sizeof *p->room, td_ascending);
        found->transition_pairs[k] = count;
        found->transitions[k] = count ? p->room[count / 2] / td_usual(&c->fit, after[k]) : NAN;
    }
}

/* -- mismatch ----------------------------------------------------------------------------------------------------------------
 * A pixel's threshold is the same in both halves of the time, and its neighbour's another; wrong light is wrong for both, and
 * as a scene goes by not for long. So with a and b the mean deviations of the halves, (a_i - a_j) (b_i - b_j) of neighbours i
 * and j is twice the variance of thresholds in the mean. */

typedef struct half_means {
    double a, b; /* means of both halves [log units]; NaN: no pair */
} half_means;

static half_means means_of(const td_pairs *pairs, const td_fit *fit, size_t from, size_t to, int8_t polarity, double half_s) {
    const double usual = td_usual(fit, polarity);
    double sum[2] = {0}, count[2] = {0};
    for (size_t i = from; i < to; i++) {
        const td_pair *p = &pairs->list[i];
        if (p->after != polarity || !is_known(pairs, i)) continue;
        const int32_t late = p->to >= half_s;
        sum[late] += fmax(-CLIP, fmin(CLIP, pairs->change[i] / usual - 1)) * usual;
        count[late]++;
    }
    return (half_means){count[0] > 0 ? sum[0] / count[0] : NAN, count[1] > 0 ? sum[1] / count[1] : NAN};
}

typedef struct moments {
    double n, sum, squares;
} moments;

static void add_polarity(const td_light *light, const td_pairs *pairs, const td_fit *fit, double half_s, int8_t polarity,
                         moments *m) {
    half_means before = {NAN, NAN};
    uint32_t pixel = UINT32_MAX - 1;
    for (size_t i = 0, end = 0; i < pairs->count; i = end) {
        const uint32_t here = light->pixel[pairs->list[i].place];
        while (end < pairs->count && pairs->list[end].place == pairs->list[i].place) end++;
        const half_means means = means_of(pairs, fit, i, end, polarity, half_s);
        const double product = 0.5 * (means.a - before.a) * (means.b - before.b);
        if (here == pixel + 1 && product == product) {
            m->n++;
            m->sum += product;
            m->squares += product * product;
        }
        before = means;
        pixel = here;
    }
}

/* Products of neighbours share a pixel, which makes the variance of their sum half as much again. */
td_variance td_spread_of(const td_light *light, const td_pairs *pairs, const td_fit *fit, const td_taken *taken) {
    const double half_s = td_half_s(taken);
    moments m = {0};
    add_polarity(light, pairs, fit, half_s, 1, &m);
    add_polarity(light, pairs, fit, half_s, -1, &m);
    if (m.n < FEW_NEIGHBOURS) return (td_variance){NAN, NAN, 0};
    const double value = m.sum / m.n;
    return (td_variance){value, sqrt(1.5 * fmax(m.squares / m.n - value * value, 0) / m.n), 1};
}

void td_spread_set(const td_calibration *c, tides_calibrated *v) {
    const double sigma = sqrt(fmax(c->spread.value, 0)), error = c->spread.error;
    v->value = NAN;
    if (!c->spread.known) return;
    v->value = sigma;
    v->error = fmin(error / fmax(2 * sigma, 1e-9), sqrt(error)); /* d sqrt(v) = dv / (2 sqrt(v)) */
    v->state = c->spread.value < 3 * error ? TIDES_CALIBRATED_BOUND : TIDES_CALIBRATED_MEASURED;
}

/* Where the spread isn't known, all of the changes' scatter is taken for it, and half of that as its doubt: with a scene's
 * light little else scatters them. Frames' light scatters them more than any spread, and says nothing: then it is the usual
 * one. */
double td_spread_used(const td_calibration *c, double *doubt) {
    const double mean = 0.5 * (c->raw.on + c->raw.off), least = fmin(c->raw.on, c->raw.off), all = c->scattered * c->scattered;
    *doubt = c->spread.error / (mean * mean);
    if (c->spread.known) return fmax(c->spread.value, 0) / (least * least);
    const double used = fmin(all, c->facts.frames ? TD_USUAL_VARIANCE : TD_LARGEST_VARIANCE);
    *doubt = c->facts.frames ? used : 0.5 * used;
    return used;
}

/* -- over the image -------------------------------------------------------------------------------------------------------- */

static tides_status map(const td_calibration *c, tides_calibration *found, tides_error *error) {
    const int32_t width = (c->taken.width + TILE - 1) / TILE, height = (c->taken.height + TILE - 1) / TILE;
    const size_t tiles = (size_t)width * (size_t)height;
    uint32_t *count = td_alloc(tiles, sizeof *count, error);
    found->map = td_alloc(tiles, sizeof *found->map, error);
    for (size_t i = 0; count && found->map && i < c->pairs.count; i++) {
        const td_pair *p = &c->pairs.list[i];
        const uint32_t pixel = c->light.pixel[p->place], x = pixel % (uint32_t)c->taken.width,
                       y = pixel / (uint32_t)c->taken.width;
        const size_t tile = (size_t)(y / TILE) * (size_t)width + x / TILE;
        if (!is_known(&c->pairs, i)) continue;
        count[tile]++;
        found->map[tile] += fmax(0, fmin(2, c->pairs.change[i] / td_usual(&c->fit, p->after)));
    }
    for (size_t i = 0; count && found->map && i < tiles; i++)
        found->map[i] = count[i] < TILE_PAIRS ? NAN : found->map[i] / count[i];
    found->map_width = width;
    found->map_height = height;
    const tides_status status = count && found->map ? TIDES_OK : TIDES_NO_MEMORY;
    free(count);
    return status;
}

/* -- pixels that don't do as light does ------------------------------------------------------------------------------------ */

/* The total way of a pixel's logarithm, up and down together. */
static double way_of(const td_light *light, size_t place, double log_eps) {
    const float *Y = light->Y + place * light->samples;
    double way = 0;
    for (size_t k = 1; k < light->samples; k++) way += fabs(td_ln((Y[k] + log_eps) / (Y[k - 1] + log_eps)));
    return way;
}

static size_t events_of(const td_taken *t, size_t pixel) {
    size_t count = 0;
    for (size_t i = t->first[pixel]; i < t->first[pixel + 1]; i++) count += !t->events[i].cause;
    return count;
}

static void hot(const td_calibration *c, tides_calibration *found) {
    const double least = fmin(c->fit.on, c->fit.off);
    for (size_t i = 0; i < c->light.count; i++) {
        const size_t count = events_of(&c->taken, c->light.pixel[i]);
        if (count < HOT_EVENTS || (double)count < HOT_TIMES * (1 + way_of(&c->light, i, c->fit.front.log_eps) / least))
            continue;
        if (found->hot_count < TIDES_CALIBRATION_HOT) {
            found->hot[found->hot_count][0] = (uint16_t)(c->light.pixel[i] % (uint32_t)c->taken.width);
            found->hot[found->hot_count][1] = (uint16_t)(c->light.pixel[i] / (uint32_t)c->taken.width);
        }
        found->hot_count++;
    }
}

static void dead(const td_calibration *c, tides_calibration *found) {
    const size_t pixels = (size_t)c->taken.width * (size_t)c->taken.height;
    const double eps = c->fit.front.log_eps, change = DEAD_CHANGE * fmax(c->fit.on, c->fit.off);
    size_t moved = 0, silent = 0;
    for (size_t p = 0; p < pixels; p++) {
        if (!(td_ln((c->light.highest[p] + eps) / (c->light.lowest[p] + eps)) > change)) continue;
        moved++;
        silent += c->taken.first[p + 1] == c->taken.first[p];
    }
    found->dead_share = moved ? (double)silent / (double)moved : 0;
}

tides_status td_spread(td_calibration *c, tides_calibration *found, tides_error *error) {
    td_changes(&c->light, &c->pairs, &c->fit.front, NULL);
    transitions(c, found);
    c->spread = td_spread_of(&c->light, &c->pairs, &c->fit, &c->taken);
    const double given = c->options->given[TIDES_CALIBRATED_SIGMA];
    if (given == given) c->spread = (td_variance){given * given, 0, 1};
    td_spread_set(c, &found->values[TIDES_CALIBRATED_SIGMA]);
    found->values[TIDES_CALIBRATED_SIGMA].raw = found->values[TIDES_CALIBRATED_SIGMA].value;
    hot(c, found);
    dead(c, found);
    return map(c, found, error);
}
