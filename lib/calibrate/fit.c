/* The front end by which changes agree best, found without a starting point: a grid over black level and pole, the clocks'
 * offset over +-60 ms, and a simplex (Nelder and Mead 1965) from the best of these. */
#include "td_calibrate.h"
#include "td_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PARAMETERS = 4, POINTS = PARAMETERS + 1, STEPS = 80, STEPS_OF_PART = 30, CLOSER = 2 };
#define NORMAL 1.4826   /* a normal distribution's standard deviation over its median of |d| */
#define FAR 3.0         /* standard deviations */
#define LEAST_CLIP 0.1  /* twice what 0.004 log units, by which light leaves straight lines, are of a threshold of 0.08 */
#define EPS_SHIFT 0.004 /* black levels o are varied as ln(o + this): smaller ones are alike */
#define POLE_SHIFT 1e-3 /* [s] poles likewise */
#define FAR_S 0.06      /* [s] greatest offset tried */
#define FEW 20          /* pairs: with fewer there is no median */
#define CLOSE 2e-4      /* of the misfit: the simplex ends when its corners differ by less */
#define CLOSE_OF_PART 1e-3
#define OFFSET_GAIN 1.1 /* factor by which an offset must improve the misfit: 14 % of mismatch alone gave 1.07; */
#define LAW_GAIN 0.98   /* and a pole that goes with light */

/* -- how well changes agree ------------------------------------------------------------------------------------------------ */

/* Hoare's selection: puts the `rank`-th smallest number in its place, and smaller ones before it. A sort would take ten times
 * as long. */
static double select_rank(double *x, size_t count, size_t rank) {
    size_t low = 0, high = count - 1;
    while (low < high) {
        const double pivot = x[low + (high - low) / 2];
        size_t i = low, k = high;
        for (;; i++, k--) {
            while (x[i] < pivot) i++;
            while (x[k] > pivot) k--;
            if (i >= k) break;
            const double other = x[i];
            x[i] = x[k];
            x[k] = other;
        }
        if (rank <= k)
            high = k;
        else
            low = k + 1;
    }
    return x[rank];
}

/* The median of a polarity's changes (of an even number the upper one) that are less than `clip` from `about`, relatively;
 * NaN for few changes. */
static double median(const td_pairs *pairs, int8_t polarity, double about, double clip) {
    size_t count = 0;
    for (size_t i = 0; i < pairs->count; i++) {
        const double change = pairs->change[i];
        if (pairs->list[i].after != polarity || !isfinite(change)) continue;
        if (clip >= TD_CLIP || fabs(change - about) < clip * about) pairs->room[count++] = change;
    }
    return count < FEW ? NAN : select_rank(pairs->room, count, count / 2);
}

/* A close fit's median is that of the changes within its clip. Pairs that noise ends are nearly all too small, and would
 * draw the median of all down. */
static double middle(const td_pairs *pairs, int8_t polarity) {
    const double all = median(pairs, polarity, 0, TD_CLIP);
    if (pairs->clip >= TD_CLIP || !(all > 0)) return all;
    const double within = median(pairs, polarity, all, pairs->clip);
    return within == within ? within : all;
}

double td_usual(const td_fit *fit, int8_t polarity) { return polarity > 0 ? fit->on : fit->off; }

/* The misfit is by squares. Blurred or wrong light makes changes too small, most of all those of short intervals, and by
 * absolute values these would dominate. On slider_depth, against values measured otherwise, squares are 0.6 % high and absolute
 * values 4 % low. Pairs whose light isn't known count as the worst misfit; otherwise offsets that leave few pairs would win. */
void td_judge(td_pairs *pairs, td_fit *fit) {
    size_t count = 0, agree = 0, lost = 0;
    double sum = 0, squares = 0;
    fit->on = middle(pairs, 1);
    fit->off = middle(pairs, -1);
    for (size_t i = 0; i < pairs->count; i++) {
        const double change = pairs->change[i], usual = td_usual(fit, pairs->list[i].after);
        if (isinf(change)) lost++;
        if (!isfinite(change) || !(usual == usual)) continue;
        const double d = usual > 0 ? fabs(change / usual - 1) : TD_CLIP, clipped = fmin(pairs->clip, d);
        count++;
        agree += change > 0;
        sum += fmin(TD_CLIP, d);
        squares += clipped * clipped;
    }
    fit->pairs = count;
    fit->agreement = count ? (double)agree / (double)count : 0;
    fit->deviation = count >= FEW ? sum / (double)count : TD_CLIP;
    fit->misfit = count >= FEW ? (squares + pairs->clip * pairs->clip * (double)lost) / (double)(count + lost)
                               : pairs->clip * pairs->clip;
}

/* The standard deviation of changes [medians], by their middle half. */
static double scattered(td_pairs *pairs, const td_fit *fit) {
    size_t count = 0;
    for (size_t i = 0; i < pairs->count; i++) {
        const double usual = td_usual(fit, pairs->list[i].after);
        if (isfinite(pairs->change[i]) && usual > 0) pairs->room[count++] = fabs(pairs->change[i] / usual - 1);
    }
    return count < FEW ? TD_CLIP : NORMAL * select_rank(pairs->room, count, count / 2);
}

double td_try(td_light *light, td_pairs *pairs, const td_front *front, const td_part *part, td_fit *fit) {
    fit->front = *front;
    td_changes(light, pairs, front, part);
    td_judge(pairs, fit);
    return fit->misfit;
}

/* -- the simplex ----------------------------------------------------------------------------------------------------------- */

typedef struct search {
    td_light *light;
    td_pairs *pairs;
    const td_part *part;
    td_fit best;
    int32_t law, free, axes[PARAMETERS], count;
    double longest;
    double start[PARAMETERS];
} search;

static void to_place(const td_front *f, double x[PARAMETERS]) {
    x[0] = td_ln(f->log_eps + EPS_SHIFT);
    x[1] = td_ln(f->pole_s + POLE_SHIFT);
    x[2] = f->offset_s / 2e-3;
    x[3] = f->refractory_s / 1e-3;
}

static td_front from_place(const search *s, const double x[PARAMETERS]) {
    return (td_front){.log_eps = fmin(fmax(td_exp(x[0]) - EPS_SHIFT, 1e-6), 10),
                      .pole_s = fmax(td_exp(x[1]) - POLE_SHIFT, 0),
                      .offset_s = 2e-3 * x[2],
                      .refractory_s = fmin(fabs(1e-3 * x[3]), s->longest),
                      .law = s->law};
}

static double value(search *s, const double *moved) {
    double x[PARAMETERS];
    td_fit fit;
    memcpy(x, s->start, sizeof x);
    for (int32_t i = 0; i < s->count; i++) x[s->axes[i]] = moved[i];
    const td_front front = from_place(s, x);
    const double misfit = td_try(s->light, s->pairs, &front, s->part, &fit);
    if (misfit < s->best.misfit) s->best = fit;
    return misfit;
}

typedef struct corner {
    double x[PARAMETERS], value;
} corner;

static int by_value(const void *a, const void *b) {
    const corner *p = a, *q = b;
    return (p->value > q->value) - (p->value < q->value);
}

/* The corner at centre + by (worst - centre). */
static corner moved(search *s, const corner *c, const double *centre, double by) {
    corner m = {.value = 0};
    for (int32_t i = 0; i < s->count; i++) m.x[i] = centre[i] + by * (c[s->count].x[i] - centre[i]);
    m.value = value(s, m.x);
    return m;
}

static void shrink(search *s, corner *c) {
    for (int32_t k = 1; k <= s->count; k++) {
        for (int32_t i = 0; i < s->count; i++) c[k].x[i] = 0.5 * (c[k].x[i] + c[0].x[i]);
        c[k].value = value(s, c[k].x);
    }
}

static void step(search *s, corner *c) {
    double centre[PARAMETERS] = {0};
    const int32_t n = s->count;
    for (int32_t k = 0; k < n; k++)
        for (int32_t i = 0; i < n; i++) centre[i] += c[k].x[i] / n;
    const corner mirrored = moved(s, c, centre, -1);
    if (mirrored.value < c[0].value) {
        const corner further = moved(s, c, centre, -2);
        c[n] = further.value < mirrored.value ? further : mirrored;
    } else if (mirrored.value < c[n - 1].value) {
        c[n] = mirrored;
    } else {
        const corner nearer = moved(s, c, centre, mirrored.value < c[n].value ? -0.5 : 0.5);
        if (nearer.value < c[n].value)
            c[n] = nearer;
        else
            shrink(s, c);
    }
    qsort(c, (size_t)n + 1, sizeof *c, by_value);
}

void td_refine(td_light *light, td_pairs *pairs, td_fit *fit, int32_t free, double longest_refractory_s, const td_part *part) {
    static const double reach[PARAMETERS] = {0.25, 0.25, 0.3, 0.15};
    search s = {.light = light, .pairs = pairs, .part = part, .law = fit->front.law, .longest = longest_refractory_s};
    corner c[POINTS];
    memset(c, 0, sizeof c);
    s.best.misfit = INFINITY;
    to_place(&fit->front, s.start);
    for (int32_t i = 0; i < PARAMETERS; i++)
        if (free & (1 << i)) s.axes[s.count++] = i;
    for (int32_t k = 0; k <= s.count; k++) {
        for (int32_t i = 0; i < s.count; i++) c[k].x[i] = s.start[s.axes[i]] + (i + 1 == k ? reach[s.axes[i]] : 0);
        c[k].value = value(&s, c[k].x);
    }
    qsort(c, (size_t)s.count + 1, sizeof *c, by_value);
    const int32_t steps = s.count == 0 ? 0 : part ? STEPS_OF_PART : STEPS;
    const double close = part ? CLOSE_OF_PART : CLOSE;
    for (int32_t i = 0; i < steps && c[s.count].value - c[0].value > close * c[0].value + 1e-8; i++) step(&s, c);
    *fit = s.best;
}

/* -- from nothing ---------------------------------------------------------------------------------------------------------- */

static void best_of(td_calibration *c, const td_front *front, td_fit *best) {
    td_fit fit;
    if (td_try(&c->light, &c->pairs, front, NULL, &fit) < best->misfit) *best = fit;
}

static void look_around(td_calibration *c, td_fit *best) {
    static const double eps[] = {0.003, 0.012, 0.04, 0.12}, pole[] = {0, 2e-3, 5e-3, 12e-3};
    for (size_t i = 0; i < 4; i++) {
        for (size_t k = 0; k < 4; k++) {
            td_front front = best->front;
            if (c->free & TD_FREE_EPS) front.log_eps = eps[i];
            if (c->free & TD_FREE_POLE) front.pole_s = pole[k];
            best_of(c, &front, best);
        }
    }
}

static void look_for_offset(td_calibration *c, td_fit *best) {
    const td_front front = best->front;
    for (double offset = -FAR_S; offset <= FAR_S * 1.001; offset += 3e-3) {
        td_front at = front;
        at.offset_s = offset;
        best_of(c, &at, best);
    }
}

/* The front end with all given values set. Given values aren't fitted. */
static td_front given_front(td_calibration *c) {
    const double *g = c->options->given;
    td_front front = {.log_eps = 0.02, .law = TIDES_PHOTORECEPTOR_CONSTANT};
    c->free = TD_FREE_ALL;
    if (g[TIDES_CALIBRATED_EPS] == g[TIDES_CALIBRATED_EPS]) {
        front.log_eps = g[TIDES_CALIBRATED_EPS];
        c->free &= ~TD_FREE_EPS;
    }
    if (g[TIDES_CALIBRATED_POLE] == g[TIDES_CALIBRATED_POLE]) {
        front.pole_s = g[TIDES_CALIBRATED_POLE];
        c->free &= ~TD_FREE_POLE;
    }
    if (g[TIDES_CALIBRATED_OFFSET] == g[TIDES_CALIBRATED_OFFSET]) {
        front.offset_s = g[TIDES_CALIBRATED_OFFSET];
        c->free &= ~TD_FREE_OFFSET;
    }
    if (g[TIDES_CALIBRATED_REFRACTORY] == g[TIDES_CALIBRATED_REFRACTORY]) {
        front.refractory_s = g[TIDES_CALIBRATED_REFRACTORY];
        c->free &= ~TD_FREE_REFRACTORY;
    }
    return front;
}

/* A rough fit on half of the pixels, to choose the kind of front end. */
static void rough(td_calibration *c, td_fit *fit, int32_t free) {
    const td_part half = {.what = TD_RANDOM_HALF, .seed = c->options->seed};
    td_refine(&c->light, &c->pairs, fit, free, c->longest_refractory_s, &half);
}

/* Takes the best offset only if it improves the fit clearly. A delay and a pole have nearly the same effect, and a simulation
 * has no delay. */
static void settle_offset(td_calibration *c, td_fit *best) {
    td_fit held = *best;
    c->offset_s = best->front.offset_s;
    if (!(c->free & TD_FREE_OFFSET)) return;
    held.front.offset_s = 0;
    held.misfit = INFINITY;
    look_around(c, &held); /* without an offset the best pole may be far away */
    rough(c, &held, c->free & ~TD_FREE_OFFSET);
    rough(c, &held, c->free & ~TD_FREE_OFFSET);
    if (held.misfit > OFFSET_GAIN * best->misfit) return;
    c->free &= ~TD_FREE_OFFSET;
    *best = held;
}

/* Takes a pole that goes with light where it fits better. */
static void settle_law(td_calibration *c, td_fit *best) {
    td_fit with_light = *best;
    if (!(c->free & TD_FREE_POLE) || best->front.pole_s <= 0) return;
    with_light.front.law = TIDES_PHOTORECEPTOR_INTENSITY;
    with_light.front.pole_s *= 0.3;
    rough(c, &with_light, c->free);
    if (with_light.misfit < LAW_GAIN * best->misfit) *best = with_light;
}

void td_come_closer(td_calibration *c, td_light *light, td_fit *fit) {
    td_try(light, &c->pairs, &fit->front, NULL, fit);
    c->scattered = scattered(&c->pairs, fit);
    c->pairs.clip = fmin(TD_CLIP, fmax(LEAST_CLIP, FAR * c->scattered));
    td_refine(light, &c->pairs, fit, c->free, c->longest_refractory_s, NULL);
}

tides_status td_search(td_calibration *c, tides_error *error) {
    td_fit best = {.front = given_front(c), .misfit = INFINITY};
    if (!(c->free & TD_FREE_REFRACTORY)) c->longest_refractory_s = best.front.refractory_s;
    look_around(c, &best);
    tides_status status = td_calibrate_told(c, 0.53, "fitting", error);
    if (c->free & TD_FREE_OFFSET && status == TIDES_OK) look_for_offset(c, &best);
    look_around(c, &best);
    if (status == TIDES_OK) status = td_calibrate_told(c, 0.56, "fitting", error);
    if (status != TIDES_OK) return status;
    rough(c, &best, c->free);
    rough(c, &best, c->free);
    settle_offset(c, &best);
    settle_law(c, &best);
    status = td_calibrate_told(c, 0.6, "fitting", error);
    if (status != TIDES_OK) return status;
    td_refine(&c->light, &c->pairs, &best, c->free, c->longest_refractory_s, NULL);
    for (int32_t i = 0; i < CLOSER; i++) td_come_closer(c, &c->light, &best);
    c->fit = best;
    return td_calibrate_told(c, 0.65, "fitting", error);
}
