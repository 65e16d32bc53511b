/* Crossings of a cubic plus modes with a pair of levels.
 *
 * The step is cut into parts so short that the modes are their Taylor polynomials to rounding. Half a part is about half a time
 * constant of the fastest mode alive, and longer as it dies. The polynomial then decides:
 *   - no level within its range: nothing in this part;
 *   - the slope, or else the second derivative, keeps its sign: there is at most one extremum, which is found, and on monotone
 *     pieces a level is crossed if and only if the piece's end has reached it;
 *   - else the part is halved. That needs two extrema, or an inflection next to an extremum, close to a level. */
#include "signal/td_root.h"
#include "td_modes.h"
#include "td_math.h"

#include <float.h>
#include <math.h>

enum { DEGREE = 15 };

/* The constants of a search. */
typedef struct search {
    const td_response *response;
    double reference, on, off;
    double tiny;  /* modes smaller than this are below rounding */
    double least; /* parts this short aren't halved */
    long tries;   /* parts looked at so far: bounds the work */
} search;

/* S at centre + half v, v in [-1, 1]: the sum of term[k] v^k. */
typedef struct series {
    double begin, end, centre, half;
    double term[DEGREE + 1];
    double spread; /* sum of |term[k]|, k >= 1 */
} series;

/* -- the polynomial of a part ---------------------------------------------------------------------------------------------- */

static void add_cubic(series *part, const td_model *cubic) {
    td_model piece = td_model_part(cubic, part->begin, part->end);
    const double *b = piece.control;
    double d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2];
    part->term[0] += 0.125 * (b[0] + 3 * b[1] + 3 * b[2] + b[3]);
    part->term[1] += 0.375 * (d0 + 2 * d1 + d2);
    part->term[2] += 0.375 * (d2 - d0);
    part->term[3] += 0.125 * (d2 - 2 * d1 + d0);
}

static void add_decay(series *part, const td_mode *mode) {
    td_complex rate = td_mode_rate(mode), step = td_scaled(rate, -part->half);
    td_complex term = td_times((td_complex){mode->cosine, mode->sine}, td_decay(rate, part->centre));
    for (int k = 0; k <= DEGREE; k++) {
        part->term[k] += term.re;
        term = td_scaled(td_times(term, step), 1.0 / (k + 1));
    }
}

/* The k-th derivative of a tail is its (4 - k)-th order, and beyond the fourth e^(-lambda s) (-lambda)^(k - 4). */
static void add_tail(series *part, const td_mode *mode) {
    td_complex rate = td_mode_rate(mode), size = {mode->cosine, mode->sine}, tail[5], derivative;
    double power = 1; /* half^k / k! */
    td_mode_tails(rate, part->centre, tail);
    derivative = tail[0];
    for (int k = 0; k <= DEGREE; k++) {
        if (k > 4) derivative = td_times(derivative, td_scaled(rate, -1));
        part->term[k] += td_times(size, k <= 4 ? tail[4 - k] : derivative).re * power;
        power *= part->half / (k + 1);
    }
}

static double size_at(const td_mode *mode, double s) { return td_hypot(mode->cosine, mode->sine) * td_exp(-mode->rate * s); }

/* Half the length of a part from s on in which the Taylor series of a mode is exact: the first term left out is below
 * rounding. */
static double half_of(const search *at, const td_mode *mode, double s) {
    const double factorial = 20922789888000.0; /* 16! */
    if (mode->tail) return INFINITY;
    double size = size_at(mode, s);
    if (!(size > at->tiny)) return INFINITY;
    return td_pow(factorial * at->tiny / size, 1.0 / (DEGREE + 1)) / td_magnitude(td_mode_rate(mode));
}

/* The series of the part from `begin` on, at most 2 * half long; modes that have died are left out. */
static void expand(const search *at, double begin, double half, double to, series *part) {
    double end = begin + 2 * half;
    if (!(end > begin)) end = nextafter(begin, 2);
    *part = (series){.begin = begin, .end = end < to ? end : to};
    part->half = 0.5 * (part->end - begin);
    part->centre = begin + part->half;
    add_cubic(part, &at->response->cubic);
    for (int k = 0; k < at->response->modes; k++) {
        const td_mode *mode = &at->response->mode[k];
        if (mode->tail)
            add_tail(part, mode);
        else if (size_at(mode, begin) > at->tiny)
            add_decay(part, mode);
    }
    for (int k = 1; k <= DEGREE; k++) part->spread += fabs(part->term[k]);
}

static double value_at(const series *part, double v) {
    double sum = part->term[DEGREE];
    for (int k = DEGREE - 1; k >= 0; k--) sum = sum * v + part->term[k];
    return sum;
}

static double slope_at(const series *part, double v) {
    double sum = DEGREE * part->term[DEGREE];
    for (int k = DEGREE - 1; k >= 1; k--) sum = sum * v + k * part->term[k];
    return sum;
}

static double bend_at(const series *part, double v) {
    double sum = DEGREE * (DEGREE - 1) * part->term[DEGREE];
    for (int k = DEGREE - 1; k >= 2; k--) sum = sum * v + k * (k - 1) * part->term[k];
    return sum;
}

/* -- roots ----------------------------------------------------------------------------------------------------------------- */

/* A series less a level, or its slope. */
typedef struct target {
    const series *part;
    double level;
} target;

static double target_excess(const void *of, double v) {
    const target *at = of;
    return value_at(at->part, v) - at->level;
}

static double target_slope(const void *of, double v) { return slope_at(((const target *)of)->part, v); }

static double target_bend(const void *of, double v) { return bend_at(((const target *)of)->part, v); }

static int polarity_of(const search *at, double value) {
    double residual = value - at->reference;
    return residual >= at->on ? 1 : residual <= -at->off ? -1 : 0;
}

/* The crossing in (low, high], where S is monotone and no level is reached at `low`. */
static int cross_monotone(const search *at, const series *part, double low, double high, double *s) {
    int polarity = polarity_of(at, value_at(part, high));
    if (polarity == 0) return 0;
    double level = at->reference + (polarity > 0 ? at->on : -at->off);
    const target at_level = {part, level};
    double v = td_root(target_excess, target_slope, &at_level, polarity, low, high, 0.5 * (low + high));
    *s = fmin(fmax(part->centre + part->half * v, part->begin), part->end);
    return polarity;
}

/* -- parts ----------------------------------------------------------------------------------------------------------------- */

static int may_reach(const search *at, const series *part) {
    return part->term[0] + part->spread - at->reference >= at->on || part->term[0] - part->spread - at->reference <= -at->off;
}

/* 1 where the derivative of this order keeps its sign, since its first term exceeds the others: the slope with `order` 1, the
 * second derivative with 2. */
static int keeps_sign(const series *part, int order) {
    double rest = 0;
    for (int k = order + 1; k <= DEGREE; k++) rest += (order == 1 ? k : k * (k - 1)) * fabs(part->term[k]);
    return order * fabs(part->term[order]) >= rest;
}

/* Searches a part whose second derivative keeps its sign: two monotone pieces at most. */
static int cross_bent(const search *at, const series *part, double *s) {
    double begin = slope_at(part, -1), end = slope_at(part, 1);
    if (!((begin > 0 && end < 0) || (begin < 0 && end > 0))) return cross_monotone(at, part, -1, 1, s);
    const target level = {part, 0};
    double extremum = td_root(target_slope, target_bend, &level, end, -1, 1, 0);
    int polarity = cross_monotone(at, part, -1, extremum, s);
    return polarity ? polarity : cross_monotone(at, part, extremum, 1, s);
}

/* 1 where the part's variation is rounding: only its ends count. */
static int is_flat(const search *at, const series *part) {
    return part->spread <= 4 * DBL_EPSILON * fabs(part->term[0]) || part->half <= at->least;
}

/* 1: the part is searched; its crossing is in `polarity` and `s`. 0: it must be halved. */
static int look(const search *at, const series *part, int *polarity, double *s) {
    *polarity = polarity_of(at, value_at(part, -1));
    *s = part->begin;
    if (*polarity || !may_reach(at, part)) return 1;
    if (keeps_sign(part, 1) || is_flat(at, part))
        *polarity = cross_monotone(at, part, -1, 1, s);
    else if (keeps_sign(part, 2))
        *polarity = cross_bent(at, part, s);
    else
        return 0;
    return 1;
}

/* Bounds the work beyond any filter's need. The circuit's slowest swing dies within 5000 parts, and halving takes 45
 * generations around each of a few places. Beyond that many parts the least length grows. */
static void bound_work(search *at) {
    enum { PATIENCE = 1 << 14 };
    if (++at->tries % PATIENCE == 0) at->least = fmax(at->least, 0x1p-20) * 16;
}

/* The largest term of the sum S. */
static double scale_of(const td_response *response) {
    double scale = 0;
    for (int i = 0; i < 4; i++) scale = fmax(scale, fabs(response->cubic.control[i]));
    for (int k = 0; k < response->modes; k++) scale = fmax(scale, td_hypot(response->mode[k].cosine, response->mode[k].sine));
    return scale;
}

int td_modes_crossing(const td_response *response, double reference, double threshold_on, double threshold_off, double from,
                      double to, double *s) {
    search at = {response, reference, threshold_on, threshold_off, 0x1p-60 * scale_of(response), 0x1p-45, 0};
    double limit = INFINITY; /* limit of the next part's half, after halving */
    for (double begin = from;;) {
        double half = limit;
        for (int k = 0; k < response->modes; k++) half = fmin(half, half_of(&at, &response->mode[k], begin));
        if (at.least > 0x1p-30) half = fmax(half, at.least);
        series part;
        int polarity;
        expand(&at, begin, half, to, &part);
        bound_work(&at);
        if (!look(&at, &part, &polarity, s)) {
            limit = 0.5 * part.half;
            continue;
        }
        if (polarity) return polarity;
        if (!(part.end < to)) return 0;
        limit = 2 * part.half;
        begin = part.end;
    }
}
