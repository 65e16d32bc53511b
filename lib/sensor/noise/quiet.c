/* Additive noise that stays within a band, found for many pixels at once: from segments to quarters, eighths and extremes. */
#include "td_noise_quiet.h"
#include "td_exponential.h"
#include "td_extremes.h"
#include "td_noise_bridge.h"
#include "td_wide.h"

#include <math.h>

enum { LANES = TD_RANDOM_LANES };
enum { SEGMENT, QUARTER, EIGHTH, DEPTH = TD_NOISE_EIGHTH };

/* Relative rounding that is allowed for in the noise's values and its laws. */
static const double rounding = 1e-9;

/* Times are compared with this much to spare [ns]. */
static const double spare_ns = 1;

typedef td_noise_lanes lanes;

/* -- arithmetic ------------------------------------------------------------------------------------------------------------ */

/* 1 - e^-x for x > 0. */
TD_WITHIN double lost_of(double x) {
    const double near = x - x * x * td_exponential_squares(-x), far = 1 - td_exponential(-x);
    return x < 0.3 ? near : far;
}

/* The laws that td_noise_level has, of parts of depths `first` and more. They go from depth to depth by 1 - e^-2x = m (2 - m)
 * with m = 1 - e^-x. */
TD_WIDE static void set_laws(int first, lanes *restrict p) {
    double m[LANES];
    for (int i = 0; i < LANES; i++) m[i] = lost_of(p->l[i] * (1.0 / (1 << DEPTH)));
    for (int i = 0; i < LANES; i++) p->variance[DEPTH][i] = 4 * p->sigma[i] * p->sigma[i] * (m[i] / (2 - m[i]));
    for (int d = DEPTH - 1; d >= first; d--)
        for (int i = 0; i < LANES; i++) {
            const double keeps = 1 - m[i], whole = m[i] * (2 - m[i]), per = 1 / (2 - whole), tangent = whole * per;
            p->variance[d][i] = 4 * p->sigma[i] * p->sigma[i] * tangent;
            p->mean[d][i] = keeps * per;
            p->change[d][i] = p->sigma[i] * sqrt(tangent);
            m[i] = whole;
        }
}

/* 1 where a part may leave its band. */
TD_WITHIN double leaves(const lanes *p, int i, double low, double high) {
    const double flag = low > p->bottom[i] ? 0.0 : 1.0;
    return high < p->top[i] ? flag : 1.0;
}

typedef struct range {
    double low, high;
} range;

TD_WITHIN range bound(double a, double b, double variance, range within) {
    const double change = b - a, sum = a + b, w = sqrt(change * change + 2 * TD_NOISE_Q_MAX * variance);
    return (range){td_greater(0.5 * (sum - w), within.low), td_lesser(0.5 * (sum + w), within.high)};
}

TD_WITHIN double middle(double a, double b, double mean, double change, double normal, range within) {
    return td_lesser(td_greater(mean * (a + b) + change * normal, within.low), within.high);
}

/* Segments become quarters. */
TD_WIDE static void quarter(lanes *restrict p, const float (*restrict normal)[LANES]) {
    for (int i = 0; i < LANES; i++) {
        const double a = p->begin[i], b = p->end[i], v = p->variance[1][i], v2 = p->variance[2][i];
        const double mean = p->mean[1][i], change = p->change[1][i];
        const range all = bound(a, b, p->variance[0][i], (range){-INFINITY, INFINITY});
        const double half = middle(a, b, p->mean[0][i], p->change[0][i], (double)normal[0][i], all);
        const range early = bound(a, half, v, all), late = bound(half, b, v, all);
        const double first = middle(a, half, mean, change, (double)normal[1][i], early);
        const double third = middle(half, b, mean, change, (double)normal[2][i], late);
        const range of[4] = {bound(a, first, v2, early), bound(first, half, v2, early), bound(half, third, v2, late),
                             bound(third, b, v2, late)};
        const double point[5] = {a, first, half, third, b};
        for (int k = 0; k < 5; k++) p->point[k][i] = point[k];
        for (int k = 0; k < 4; k++) {
            p->least[k][i] = of[k].low;
            p->most[k][i] = of[k].high;
            p->leaves[k][i] = leaves(p, i, of[k].low, of[k].high);
        }
    }
}

/* Quarters become eighths. */
TD_WIDE static void halve(lanes *restrict p, const float *restrict normal) {
    for (int i = 0; i < LANES; i++) {
        const double a = p->begin[i], b = p->end[i], v = p->variance[3][i];
        const range all = {p->low[i], p->high[i]};
        const double half = middle(a, b, p->mean[2][i], p->change[2][i], (double)normal[i], all);
        const range early = bound(a, half, v, all), late = bound(half, b, v, all);
        p->point[0][i] = a;
        p->point[1][i] = half;
        p->point[2][i] = b;
        p->least[0][i] = early.low;
        p->most[0][i] = early.high;
        p->least[1][i] = late.low;
        p->most[1][i] = late.high;
        p->leaves[0][i] = leaves(p, i, early.low, early.high);
        p->leaves[1][i] = leaves(p, i, late.low, late.high);
    }
}

/* The extremes of eighths. */
TD_WIDE static void find_extremes(lanes *restrict p, const float (*restrict q)[LANES]) {
    for (int i = 0; i < LANES; i++) {
        const double change = p->end[i] - p->begin[i], sum = p->begin[i] + p->end[i], v = 2 * p->variance[3][i];
        const double down = sqrt(change * change + v * td_lesser((double)q[0][i], TD_NOISE_Q_MAX));
        const double up = sqrt(change * change + v * td_lesser((double)q[1][i], TD_NOISE_Q_MAX));
        p->least[0][i] = td_greater(0.5 * (sum - down), p->low[i]);
        p->most[0][i] = td_lesser(0.5 * (sum + up), p->high[i]);
        p->leaves[0][i] = leaves(p, i, p->least[0][i], p->most[0][i]);
    }
}

/* -- parts ----------------------------------------------------------------------------------------------------------------- */

static int is_settled(const td_noise_quiet *quiet, int owner, uint64_t k) {
    const td_noise_found *found = &quiet->found[owner];
    return found->reaches && found->first <= k;
}

/* A part that may leave its band. */
static void reach(const td_noise_quiet *quiet, const td_noise_part *part) {
    td_noise_found *found = &quiet->found[part->owner];
    if (part->from_ns > quiet->stop_ns + spare_ns) {
        found->until_ns = td_lesser(found->until_ns, part->from_ns - spare_ns);
        return;
    }
    if (!found->reaches || part->k < found->first) found->first = part->k;
    found->reaches = 1;
}

/* Keeps the bounds of a part that doesn't leave its band, from the step's end on: only these are asked for later. */
static void keep(const td_noise_quiet *quiet, int owner, double to_ns, double low, double high) {
    td_noise_found *found = &quiet->found[owner];
    if (to_ns < quiet->stop_ns) return;
    found->low = td_lesser(found->low, low);
    found->high = td_greater(found->high, high);
}

/* Takes the last parts of a kind that aren't settled, and repeats one where there are fewer than lanes. Returns their number.
 * They stay where they are until parts of their kind are added. */
static int gather(td_noise_quiet *quiet, int kind, const td_noise_part *taken[LANES]) {
    lanes *p = &quiet->lanes;
    int count = 0;
    while (quiet->count[kind] > 0 && count < LANES) {
        const td_noise_part *part = &quiet->part[kind][--quiet->count[kind]];
        if (!is_settled(quiet, part->owner, part->k)) taken[count++] = part;
    }
    for (int i = 0; i < LANES && count > 0; i++) {
        const td_noise_part *part = taken[i] = taken[i < count ? i : 0];
        p->begin[i] = part->begin;
        p->end[i] = part->end;
        p->low[i] = part->low;
        p->high[i] = part->high;
        p->bottom[i] = part->bottom;
        p->top[i] = part->top;
        p->sigma[i] = part->sigma;
        p->l[i] = part->l;
    }
    return count;
}

/* Parts of a tau that is given: tangents and means by depth. */
TD_WIDE static void scale_laws(const td_noise_unit *unit, int first, lanes *restrict p) {
    for (int d = first; d <= DEPTH; d++) {
        const double tangent = 4 * unit[d].tangent, mean = unit[d].mean, root = unit[d].root;
        for (int i = 0; i < LANES; i++) p->variance[d][i] = p->sigma[i] * p->sigma[i] * tangent;
        for (int i = 0; i < LANES && d < DEPTH; i++) {
            p->mean[d][i] = mean;
            p->change[d][i] = p->sigma[i] * root;
        }
    }
}

/* Noise that doesn't vary has had its laws since the beginning. */
static void take_laws(td_noise_quiet *quiet, int first) {
    const td_additive_noise *noise = quiet->noise;
    lanes *p = &quiet->lanes;
    int usual = 1;
    if (!noise->varies) return;
    for (int i = 0; i < LANES; i++) usual &= p->l[i] == noise->spacing_ns / noise->usual_ns;
    if (usual)
        scale_laws(noise->usual, first, p);
    else
        set_laws(first, p);
}

/* Takes parts of a kind to the lanes, with their laws from depth `first` on and random numbers. Returns their number. */
static int take(td_noise_quiet *quiet, int kind, int first, const td_noise_part *taken[LANES], td_random_lanes *bits) {
    const int count = gather(quiet, kind, taken);
    uint32_t pixel[LANES], purpose[LANES];
    uint64_t index[LANES];
    if (count == 0) return 0;
    take_laws(quiet, first);
    for (int i = 0; i < LANES; i++) {
        pixel[i] = taken[i]->pixel;
        index[i] = taken[i]->k;
        purpose[i] = TD_RANDOM_NOISE_BRIDGE | taken[i]->node << TD_RANDOM_PURPOSE_BITS;
    }
    td_random_each(quiet->noise->seed, pixel, index, purpose, bits);
    return count;
}

/* Lists the parts that came of each lane and may leave their band as parts of the kind `next`. */
static void go_on(td_noise_quiet *quiet, const td_noise_part *const taken[LANES], int count, int parts, int next) {
    const lanes *p = &quiet->lanes;
    for (int i = 0; i < count; i++) {
        const td_noise_part *of = taken[i];
        const double length = (of->to_ns - of->from_ns) / parts;
        for (int n = 0; n < parts; n++) {
            const double from_ns = of->from_ns + n * length, to_ns = from_ns + length;
            if (p->leaves[n][i] == 0) {
                keep(quiet, of->owner, to_ns, p->least[n][i], p->most[n][i]);
                continue;
            }
            if (to_ns < quiet->start_ns - spare_ns) continue;
            td_noise_part *part = &quiet->part[next][quiet->count[next]++];
            *part = *of;
            part->node = (uint32_t)parts * of->node + (uint32_t)n;
            part->from_ns = from_ns;
            part->to_ns = to_ns;
            part->begin = p->point[n][i];
            part->end = p->point[n + 1][i];
            part->low = p->least[n][i];
            part->high = p->most[n][i];
        }
    }
}

static void look_at_segments(td_noise_quiet *quiet) {
    const td_noise_part *taken[LANES];
    float normal[4][LANES];
    td_random_lanes bits;
    const int count = take(quiet, SEGMENT, 0, taken, &bits);
    if (count == 0) return;
    td_random_short_normals_many(&bits, normal);
    quarter(&quiet->lanes, (const float(*)[LANES])normal);
    go_on(quiet, taken, count, 4, QUARTER);
}

static void look_at_quarters(td_noise_quiet *quiet) {
    const td_noise_part *taken[LANES];
    float normal[4][LANES];
    td_random_lanes bits;
    const int count = take(quiet, QUARTER, 2, taken, &bits);
    if (count == 0) return;
    td_random_short_normals_many(&bits, normal);
    halve(&quiet->lanes, normal[0]);
    go_on(quiet, taken, count, 2, EIGHTH);
}

/* Eighths at which trees end have extremes; deeper trees are left to td_noise_crossing. */
static void look_at_eighths(td_noise_quiet *quiet) {
    const td_noise_part *taken[LANES];
    const double most = TD_NOISE_FINEST * quiet->noise->threshold;
    const lanes *p = &quiet->lanes;
    float q[2][LANES];
    td_random_lanes bits;
    const int count = take(quiet, EIGHTH, DEPTH, taken, &bits);
    if (count == 0) return;
    td_random_short_exponentials_many(&bits, q);
    find_extremes(&quiet->lanes, (const float(*)[LANES])q);
    for (int i = 0; i < count; i++) {
        if (p->leaves[0][i] == 0 && p->variance[DEPTH][i] <= most * most * (1 - rounding))
            keep(quiet, taken[i]->owner, taken[i]->to_ns, p->least[0][i], p->most[0][i]);
        else
            reach(quiet, taken[i]);
    }
}

/* -- the search ------------------------------------------------------------------------------------------------------------ */

void td_noise_quiet_begin(td_noise_quiet *quiet, const td_additive_noise *noise, double start_ns, double stop_ns,
                          td_noise_found *found) {
    quiet->noise = noise;
    quiet->start_ns = start_ns;
    quiet->stop_ns = stop_ns;
    quiet->found = found;
    for (int d = 0; d <= DEPTH && !noise->varies; d++)
        for (int i = 0; i < LANES; i++) {
            quiet->lanes.variance[d][i] = noise->level[d].variance;
            if (d == DEPTH) continue;
            quiet->lanes.mean[d][i] = noise->level[d].mean;
            quiet->lanes.change[d][i] = noise->level[d].change;
        }
    quiet->count[SEGMENT] = quiet->count[QUARTER] = quiet->count[EIGHTH] = 0;
}

/* Looks where there are at least `least` parts, later kinds first, so that there is always room for what comes of a kind. */
static void look(td_noise_quiet *quiet, int least) {
    for (;;) {
        if (quiet->count[EIGHTH] >= least)
            look_at_eighths(quiet);
        else if (quiet->count[QUARTER] >= least)
            look_at_quarters(quiet);
        else if (quiet->count[SEGMENT] >= least)
            look_at_segments(quiet);
        else
            return;
    }
}

void td_noise_quiet_add(td_noise_quiet *quiet, int owner, uint32_t pixel, const td_noise_segment *segment, double bottom,
                        double top) {
    const td_additive_noise *noise = quiet->noise;
    if (is_settled(quiet, owner, segment->k)) return;
    td_noise_part *part = &quiet->part[SEGMENT][quiet->count[SEGMENT]++];
    *part = (td_noise_part){.owner = owner, .pixel = pixel, .node = 1, .k = segment->k};
    part->from_ns = segment->from_ns;
    part->to_ns = segment->to_ns;
    part->begin = segment->begin;
    part->end = segment->end;
    part->sigma = noise->varies ? segment->sigma : noise->sigma;
    part->l = noise->varies ? noise->spacing_ns / segment->tau_ns : 0;
    const double slack = rounding * (fabs(part->begin) + fabs(part->end) + part->sigma);
    part->bottom = bottom + slack;
    part->top = top - slack;
    look(quiet, LANES);
}

void td_noise_quiet_end(td_noise_quiet *quiet) { look(quiet, 1); }
