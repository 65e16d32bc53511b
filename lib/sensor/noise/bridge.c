/* Additive noise between the points of its grid: a tree of parts, drawn only where the noise may come near a level. */
#include "td_noise_bridge.h"

#include "td_extremes.h"
#include "td_math.h"

#include <float.h>
#include <math.h>

/* Parts of tau / 16 at most: longer ones wander too much between their corners (td_noise_bridge.h). */
enum { DEPTH_MIN = 3 };

/* Least movement of the signal over a part, as a share of the noise's range. A signal that moves less doesn't tell where in the
 * part a level may be reached. */
static const double least_moved = 0.25;

/* A part of a segment, with bounds of the noise on it. */
typedef struct part {
    uint32_t node; /* 1: the segment; 2 n and 2 n + 1: the halves of n */
    int depth;     /* of the node in the tree */
    float normal;  /* of its middle, where the depth is odd */
    int is_late;   /* 1: that normal is still to be drawn, of these bits */
    td_random_bits bits;
    double from_ns, to_ns, begin, end, low, high;
} part;

/* A part at the bottom of the tree: the noise is straight between its corners. */
enum { CORNERS = 4 };
typedef struct corners {
    double time_ns[CORNERS], value[CORNERS];
} corners;

static double variance_of(double sigma, double tangent) { return 4 * sigma * sigma * tangent; }

/* The law of parts of length l / tau: with m = 1 - e^-l, tanh(l / 2) = m / (2 - m) and 1 / cosh(l / 2) = 2
 * e^(-l/2) / (2 - m). */
static td_noise_unit unit_of(double l) {
    const double m = -td_expm1(-l), tangent = m / (2 - m);
    return (td_noise_unit){tangent, td_exp(-0.5 * l) / (2 - m), sqrt(tangent)};
}

static td_noise_level level_of(double sigma, td_noise_unit unit) {
    return (td_noise_level){variance_of(sigma, unit.tangent), unit.mean, sigma * unit.root};
}

static double reach_of(double variance) { return sqrt(0.5 * TD_NOISE_Q_MAX * variance); }

double td_noise_reach(const td_additive_noise *noise, double sigma, double tau_ns) {
    if (tau_ns == noise->usual_ns) return reach_of(variance_of(sigma, noise->usual[0].tangent));
    return reach_of(variance_of(sigma, unit_of(noise->spacing_ns / tau_ns).tangent));
}

/* Sets level and depth; `usual`, where given, has the units of this tau. */
static void make_levels(td_additive_noise *noise, double tau_ns, double threshold, const td_noise_unit *usual) {
    double l = noise->spacing_ns / tau_ns;
    for (int depth = 0;; depth++, l *= 0.5) {
        noise->level[depth] = level_of(noise->sigma, usual ? usual[depth] : unit_of(l));
        noise->depth = depth;
        int fine = noise->level[depth].variance <= TD_NOISE_FINEST * TD_NOISE_FINEST * threshold * threshold;
        if ((depth >= DEPTH_MIN && fine) || depth == TD_NOISE_DEPTH_MAX) break;
    }
}

void td_noise_bridge_make(td_additive_noise *noise, double tau_ns, double threshold) {
    double l = noise->spacing_ns / tau_ns;
    for (int depth = 0; depth <= TD_NOISE_DEPTH_MAX; depth++, l *= 0.5) noise->usual[depth] = unit_of(l);
    make_levels(noise, tau_ns, threshold, noise->usual);
    noise->reach = reach_of(noise->level[0].variance);
}

/* The noise's numbers on this segment; a copy in `own` where they vary. */
static const td_additive_noise *here(const td_additive_noise *noise, const td_noise_segment *segment, td_additive_noise *own) {
    if (!noise->varies) return noise;
    own->seed = noise->seed;
    own->spacing_ns = noise->spacing_ns;
    own->sigma = segment->sigma;
    make_levels(own, segment->tau_ns, noise->threshold, segment->tau_ns == noise->usual_ns ? noise->usual : NULL);
    return own;
}

/* -- the tree -------------------------------------------------------------------------------------------------------------- */

/* Sets a part's bounds: those of its bridge, within those of its parent. */
static void bound(const td_additive_noise *noise, part *p, double low, double high) {
    const double change = p->end - p->begin, sum = p->begin + p->end;
    const double w = sqrt(change * change + 2 * TD_NOISE_Q_MAX * noise->level[p->depth].variance);
    p->low = td_greater(0.5 * (sum - w), low);
    p->high = td_lesser(0.5 * (sum + w), high);
}

static part whole(const td_additive_noise *noise, const td_noise_segment *segment) {
    part p = {.node = 1, .from_ns = segment->from_ns, .to_ns = segment->to_ns, .begin = segment->begin, .end = segment->end};
    bound(noise, &p, -INFINITY, INFINITY);
    return p;
}

static td_random_bits bits_of(const td_additive_noise *noise, uint32_t pixel, uint64_t k, const part *p) {
    return td_random(noise->seed, pixel, k, TD_RANDOM_NOISE_BRIDGE | p->node << TD_RANDOM_PURPOSE_BITS);
}

/* A part of even depth draws the middles of its halves with its own; that of the later half when it is halved. */
static void halve(const td_additive_noise *noise, uint32_t pixel, uint64_t k, const part *p, part half[2]) {
    const td_noise_level *level = &noise->level[p->depth];
    const double middle_ns = 0.5 * (p->from_ns + p->to_ns);
    const int draws = p->depth % 2 == 0;
    td_random_bits bits = p->bits;
    float normal[2] = {p->normal};
    if (draws) bits = bits_of(noise, pixel, k, p);
    if (draws || p->is_late) td_random_short_normals(&bits, !draws, normal);
    const double free = level->mean * (p->begin + p->end) + level->change * (double)normal[0];
    const double middle = td_lesser(td_greater(free, p->low), p->high);
    half[0] = (part){2 * p->node, p->depth + 1, normal[1], 0, bits, p->from_ns, middle_ns, p->begin, middle, 0, 0};
    half[1] = (part){2 * p->node + 1, p->depth + 1, 0, draws, bits, middle_ns, p->to_ns, middle, p->end, 0, 0};
    bound(noise, &half[0], p->low, p->high);
    bound(noise, &half[1], p->low, p->high);
}

static int is_bottom(const td_additive_noise *noise, const part *p) { return p->depth == noise->depth; }

/* The place of its maximum or minimum, as a share of the part. */
static double share_of(const part *p, double extreme) {
    const double rise = fabs(extreme - p->begin), fall = fabs(extreme - p->end);
    return rise + fall > 0 ? rise / (rise + fall) : 0.5;
}

/* Where both extremes would be in the middle, they are kept apart, so that the line between isn't too steep. */
static const double first_latest = 7.0 / 16, second_earliest = 9.0 / 16;

static void find_corners(const td_additive_noise *noise, uint32_t pixel, uint64_t k, const part *p, corners *c) {
    const double change = p->end - p->begin, sum = p->begin + p->end, length = p->to_ns - p->from_ns;
    const double v = noise->level[p->depth].variance;
    const int low_first = change >= 0;
    double extreme[2]; /* minimum, maximum */
    const td_random_bits bits = bits_of(noise, pixel, k, p);
    for (int i = 0; i < 2; i++) {
        const double w = sqrt(change * change + 2 * v * td_lesser(td_random_short_exponential(&bits, i), TD_NOISE_Q_MAX));
        extreme[i] = i == 0 ? td_greater(0.5 * (sum - w), p->low) : td_lesser(0.5 * (sum + w), p->high);
    }
    c->value[0] = p->begin;
    c->value[1] = extreme[!low_first];
    c->value[2] = extreme[low_first];
    c->value[3] = p->end;
    c->time_ns[0] = p->from_ns;
    c->time_ns[1] = p->from_ns + length * fmin(share_of(p, c->value[1]), first_latest);
    c->time_ns[2] = p->from_ns + length * fmax(share_of(p, c->value[2]), second_earliest);
    c->time_ns[3] = p->to_ns;
}

double td_noise_value(const td_additive_noise *any, uint32_t pixel, const td_noise_segment *segment, double time_ns) {
    td_additive_noise own;
    const td_additive_noise *noise = here(any, segment, &own);
    part p = whole(noise, segment), half[2];
    corners c;
    while (!is_bottom(noise, &p)) {
        halve(noise, pixel, segment->k, &p, half);
        p = half[time_ns > half[0].to_ns];
    }
    find_corners(noise, pixel, segment->k, &p, &c);
    int i = 0;
    while (i < CORNERS - 2 && time_ns > c.time_ns[i + 1]) i++;
    const double share = (time_ns - c.time_ns[i]) / (c.time_ns[i + 1] - c.time_ns[i]);
    return c.value[i] + (c.value[i + 1] - c.value[i]) * fmin(fmax(share, 0), 1);
}

/* -- crossings ------------------------------------------------------------------------------------------------------------- */

static double place_of(const td_noise_search *search, double time_ns) {
    return td_place_of(time_ns, search->start_ns, search->length_ns);
}

static int is_cubic(const td_response *response) {
    return response->modes == 0 && !response->pieces && !response->source.frontend;
}

/* 1: the cubic's control values on [from, to] are between both by more than their rounding. */
static int stays_within(const td_model *cubic, double bottom, double top, double from, double to) {
    const td_model within = td_model_part(cubic, from, to);
    const double *b = cubic->control, *c = within.control;
    const double slack = 16 * DBL_EPSILON * td_greater(td_greater(fabs(b[0]), fabs(b[1])), td_greater(fabs(b[2]), fabs(b[3])));
    const double low = td_least4(c);
    const double high = td_most4(c);
    return low - slack > bottom && high + slack < top;
}

/* 0: the response with any noise in [low, high] reaches no level on [from, to]. 1: it may, but not before *s. */
static int may_reach(const td_noise_search *search, double low, double high, double from, double to, double *s) {
    const double top = search->reference + search->on - high, bottom = search->reference - search->off - low;
    *s = from;
    if (search->low > bottom && search->high < top) return 0;
    if (is_cubic(search->response)) return !stays_within(&search->response->cubic, bottom, top, from, to);
    /* 1 where only a crossing search can tell: the levels leave no room, or the signal hardly moves. */
    if (!(top > bottom) || search->high - search->low < least_moved * (high - low)) return 1;
    const double half = 0.5 * (top - bottom);
    return td_response_crossing(search->response, bottom + half, half, half, from, to, s) != 0;
}

/* The first crossing of the response with a straight line of noise. */
static int cross_straight(const td_noise_search *search, const corners *c, int i, double from, double to, double *s) {
    const double slope = (c->value[i + 1] - c->value[i]) / (c->time_ns[i + 1] - c->time_ns[i]);
    const double begin = c->value[i] + slope * (search->start_ns - c->time_ns[i]), rise = slope * search->length_ns;
    for (int k = 0; k < 4; k++)
        search->scratch->cubic.control[k] = search->response->cubic.control[k] + (begin + rise * (k / 3.0));
    return td_response_crossing(search->scratch, search->reference, search->on, search->off, from, to, s);
}

static int cross_corners(const td_noise_search *search, const corners *c, double from, double to, double *s) {
    const double low = fmin(c->value[1], c->value[2]), high = fmax(c->value[1], c->value[2]);
    if (!may_reach(search, low, high, from, to, &from)) return 0;
    for (int i = 0; i + 1 < CORNERS; i++) {
        const double begin = fmax(from, i == 0 ? from : place_of(search, c->time_ns[i]));
        const double end = fmin(to, i + 2 == CORNERS ? to : place_of(search, c->time_ns[i + 1]));
        const int polarity = begin <= end ? cross_straight(search, c, i, begin, end, s) : 0;
        if (polarity) return polarity;
    }
    return 0;
}

/* Visits the parts in order of time, with a stack as deep as the tree. */
int td_noise_crossing(const td_noise_search *search, const td_noise_segment *segment, double from, double to, double *s) {
    part left[TD_NOISE_DEPTH_MAX + 2];
    td_additive_noise own;
    const td_additive_noise *noise = here(search->noise, segment, &own);
    int count = 0, polarity = 0;
    left[count++] = whole(noise, segment);
    while (count > 0 && polarity == 0) {
        const part p = left[--count];
        double begin = p.node == 1 ? from : fmax(from, place_of(search, p.from_ns)), end = to;
        corners c;
        part half[2];
        if (p.node & (p.node + 1)) end = fmin(to, place_of(search, p.to_ns)); /* the last part ends with the segment */
        if (!(begin <= end) || !may_reach(search, p.low, p.high, begin, end, &begin)) continue;
        if (is_bottom(noise, &p)) {
            find_corners(noise, search->pixel, segment->k, &p, &c);
            polarity = cross_corners(search, &c, begin, end, s);
        } else {
            halve(noise, search->pixel, segment->k, &p, half);
            left[count++] = half[1];
            left[count++] = half[0];
        }
    }
    return polarity;
}
