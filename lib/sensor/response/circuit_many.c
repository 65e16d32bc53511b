/* The pixel's circuit over whole steps of the pixels of a tile, in loops that vectorise. Pixels without an answer here, and
 * those near a level, are solved one by one by td_frontend_step.
 *
 * With d = L - y, v = y' and the light's current I the photoreceptor is v' = A I d - (B + C I) v. A step is cut into panels of
 * equal length, on which x goes from 0 to 1. There L is a cubic, and I the Taylor series of e^L (E' = L' E) with TERMS terms. y
 * is the Taylor series that follows from them, with ORDER terms, from the panel's beginning, where value and slope are known.
 * The filters after y are low-passes with constant rates, whose responses to x^n are numbers (`passed`) that all pixels share.
 *
 * The error. The truncated y is exactly the response to the input L + g, where A I g is the residual of the equation: all
 * products of orders from ORDER - 1 on. With w = A d - C v and T_j for the sum of |I_k| from k = j on, that is at most
 *
 *   B |v_last| + sum over m of |w_m| T_(ORDER - 1 - m),
 *
 * and T_j's part beyond the TERMS is at most (|l1| e_7 + 2 |l2| (e_6 + e_7) + 3 |l3| (e_5 + e_6 + e_7)) / (TERMS - |l1| - 2
 * |l2| - 3 |l3|), e_k = |E_k|, since the sum of k E_k is L' E. A pixel whose bound of g exceeds a tenth of the tolerance has no
 * answer here. g is an error of the input, as that of td_frontend_step is. Errors of the input don't add up from panel to panel
 * or from step to step, because the circuit forgets them.
 *
 * Bounds. On a panel y is between y(0) plus the sum of its series' negative terms and y(0) plus that of its positive ones. A
 * low-pass is an average of its old value and its input. */
#include "td_exponential.h"
#include "td_math.h"
#include "td_extremes.h"
#include "td_frontend.h"
#include "td_light_step.h"
#include "td_wide.h"

#include <float.h>
#include <math.h>

enum { ORDER = 16, TERMS = 8, BLOCK = 64, LANES = 32, STATES = TD_FRONTEND_STATE };

/* Greatest product of a panel's length and the sum of the equation's rates: longer panels need more than ORDER terms. */
static const double longest = 2;

/* Weight of the change of L in the number of panels: its slope is three times the difference of two neighbouring control
 * values. */
static const double steep = 3 * 4;

/* Numbers of panels to choose from; steps that need more have no answer here. */
enum { CLASSES = 14 };
static const double panels_of[CLASSES] = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128};

/* A step whose bound is too large is tried again so many times, each time with twice as many panels. */
static const int retries = 2;

/* Tolerance of g: a fifth of the error that td_frontend_step may leave. */
static const double tolerance = 0.1 * TD_FRONTEND_TOLERANCE;

/* The equation's numbers [1/s]; those that go with the light are per ampere. */
typedef struct circuit {
    double spring, drag, drag_light;     /* A, B, C */
    double light, dark, log_eps, dark_L; /* light, dark: I = light Y + dark; dark_L: L of Y = 0, log(log_eps) */
} circuit;

/* A low-pass over a panel: the share of its old value at the end, and its response to x^n. */
typedef struct low_pass {
    double kept, of[ORDER + 1];
} low_pass;

/* A panel's numbers, the same for all pixels. */
typedef struct panel {
    circuit law;
    double a, b, c;                /* A, B, C in the panel's time */
    double from, length, length_s; /* place and length in the step's s; length in seconds */
    low_pass follower, after;      /* source follower; the low-pass behind it, whose output is S */
    double lag;                    /* share of the follower's old value in S at the end */
    int has_difference;
} panel;

/* Pixels side by side: their input as a polynomial of the step's s, the least I, their state, and the results. */
typedef struct block {
    double l[4][BLOCK], dimmest[BLOCK], state[STATES][BLOCK];
    double low[BLOCK], high[BLOCK], fails[BLOCK]; /* bounds of S; fails: 0, or NaN without an answer */
    int pixel[BLOCK];
    int count;
} block;

/* Some of the block's pixels, on a panel. */
typedef struct lanes {
    double I[TERMS][LANES], E[TERMS][LANES], l[4][LANES];
    double y[ORDER + 1][LANES], v[ORDER][LANES], w[ORDER + 1][LANES];
    double beyond[TERMS + 1][LANES]; /* T_j */
} lanes;

static circuit circuit_of(const td_frontend *f, double log_eps) {
    const double both = f->input_s + f->miller_s, out = f->sensor->circuit.output_s;
    return (circuit){f->loop / (both * out),
                     (f->input_s + (f->sensor->circuit.gain + 1) * f->miller_s) / (both * out),
                     1 / both,
                     f->light,
                     f->dark,
                     log_eps,
                     td_ln(log_eps)};
}

/* The integral of r e^(-r (1 - x)) x^n over [0, 1], by the recurrence of_n = 1 - n / r of_(n-1). Upwards where that reduces
 * errors, else downwards from a high n, where the start hardly matters. */
static low_pass low_pass_of(double r) {
    enum { START = 60 };
    low_pass pass = {td_exp(-r), {-td_expm1(-r)}};
    if (r >= ORDER) {
        for (int n = 1; n <= ORDER; n++) pass.of[n] = 1 - n / r * pass.of[n - 1];
        return pass;
    }
    double of = r / (r + START + 1);
    for (int n = START; n > 0; n--) {
        if (n <= ORDER) pass.of[n] = of;
        of = (1 - of) * (r / n);
    }
    return pass;
}

/* The low-pass of rate r; for r = 0 one that passes its input unchanged. */
static low_pass low_pass_or_none(double r) {
    low_pass pass = {.kept = 0};
    if (r > 0) return low_pass_of(r);
    for (int n = 0; n <= ORDER; n++) pass.of[n] = 1;
    return pass;
}

static void share(const td_frontend *f, panel *p) {
    const double length_s = p->length_s, r1 = f->source_follower * length_s, r2 = f->difference * length_s;
    p->a = length_s * length_s * p->law.spring;
    p->b = length_s * p->law.drag;
    p->c = length_s * p->law.drag_light;
    p->follower = low_pass_or_none(r1);
    p->after = low_pass_or_none(r2);
    p->lag = 0;
    p->has_difference = r2 > 0;
    if (!(r1 > 0 && r2 > 0)) return;
    const double apart = 1 / (r2 - r1);
    for (int n = 0; n <= ORDER; n++) p->after.of[n] = (r2 * p->follower.of[n] - r1 * p->after.of[n]) * apart;
    p->lag = r2 * apart * (p->follower.kept - p->after.kept);
}

/* -- a panel --------------------------------------------------------------------------------------------------------------- */

/* The series of the input and the light; the last of T bounds the terms that are left out. */
static inline void take_light(const panel *p, const block *of, int first, int count, lanes *restrict at) {
    const double m = p->from, q = p->length;
    for (int i = 0; i < count; i++) {
        const double l0 = of->l[0][first + i], l1 = of->l[1][first + i], l2 = of->l[2][first + i], l3 = of->l[3][first + i];
        at->l[0][i] = l0 + m * (l1 + m * (l2 + m * l3));
        at->l[1][i] = q * (l1 + m * (2 * l2 + m * (3 * l3)));
        at->l[2][i] = q * q * (l2 + m * (3 * l3));
        at->l[3][i] = q * q * q * l3;
        at->E[0][i] = p->law.light * td_exponential(at->l[0][i]);
        at->I[0][i] = at->E[0][i] + (p->law.dark - p->law.light * p->law.log_eps);
    }
    for (int k = 1; k < TERMS; k++) {
        const double by = 1.0 / k;
        for (int i = 0; i < count; i++) {
            double sum = at->l[1][i] * at->E[k - 1][i];
            if (k >= 2) sum += 2 * at->l[2][i] * at->E[k - 2][i];
            if (k >= 3) sum += 3 * at->l[3][i] * at->E[k - 3][i];
            at->E[k][i] = at->I[k][i] = sum * by;
        }
    }
    for (int i = 0; i < count; i++) {
        const double m1 = fabs(at->l[1][i]), m2 = 2 * fabs(at->l[2][i]), m3 = 3 * fabs(at->l[3][i]);
        const double e7 = fabs(at->E[7][i]), e6 = fabs(at->E[6][i]), e5 = fabs(at->E[5][i]), to_spare = TERMS - (m1 + m2 + m3);
        const double left = m1 * e7 + m2 * (e6 + e7) + m3 * (e5 + e6 + e7);
        at->beyond[TERMS][i] = to_spare > 1 ? left / to_spare : 1e300;
    }
    for (int k = TERMS - 1; k >= 0; k--)
        for (int i = 0; i < count; i++) at->beyond[k][i] = at->beyond[k + 1][i] + fabs(at->I[k][i]);
}

/* Adds products of I, from one order upwards, with w, downwards to w[0]. `count` isn't a constant, because gcc unrolls loops of
 * constant length before it would vectorise them. */
static inline void add_four(int count, double (*I)[LANES], double (*w)[LANES], double *restrict sum) {
    const double *I0 = I[0], *I1 = I[1], *I2 = I[2], *I3 = I[3], *w0 = w[3], *w1 = w[2], *w2 = w[1], *w3 = w[0];
    for (int i = 0; i < count; i++) sum[i] = (((sum[i] + I0[i] * w0[i]) + I1[i] * w1[i]) + I2[i] * w2[i]) + I3[i] * w3[i];
}

static inline void add_one(int count, const double *I, const double *w, double *restrict sum) {
    for (int i = 0; i < count; i++) sum[i] += I[i] * w[i];
}

/* The series of y and y'. */
static inline void take_series(const panel *p, const block *of, int first, int count, lanes *restrict at) {
    const double a = p->a, b = p->b, c = p->c;
    for (int i = 0; i < count; i++) {
        at->y[0][i] = of->state[1][first + i];
        at->v[0][i] = of->state[2][first + i] * p->length_s;
        at->w[0][i] = a * (at->l[0][i] - at->y[0][i]) - c * at->v[0][i];
    }
    for (int n = 0; n < ORDER; n++) {
        double sum[LANES];
        const double by = 1.0 / (n + 1);
        const int last = n < TERMS ? n : TERMS - 1;
        for (int i = 0; i < count; i++) sum[i] = -(b * at->v[n][i]);
        int k = 0;
        for (; k + 3 <= last; k += 4) add_four(count, &at->I[k], &at->w[n - k - 3], sum);
        for (; k <= last; k++) add_one(count, at->I[k], at->w[n - k], sum);
        for (int i = 0; i < count; i++) {
            const double y = at->v[n][i] * by, d = (n < 3 ? at->l[n + 1][i] : 0) - y;
            double v = 0; /* y's last term: its slope's is beyond the series */
            if (n + 1 < ORDER) v = at->v[n + 1][i] = sum[i] * by;
            at->y[n + 1][i] = y;
            at->w[n + 1][i] = a * d - c * v;
        }
    }
}

/* Advances the pixels to the panel's end. */
static inline void finish(const panel *p, block *restrict of, int first, int count, const lanes *at) {
    double y[LANES], v[LANES], z[LANES], S[LANES], up[LANES], down[LANES], left[LANES];
    for (int i = 0; i < count; i++) {
        const double y0 = at->y[0][i], S0 = of->state[0][first + i], z0 = of->state[3][first + i];
        y[i] = z[i] = S[i] = up[i] = down[i] = 0;
        v[i] = at->v[0][i];
        left[i] = p->b * fabs(at->v[ORDER - 1][i]) + fabs(at->w[0][i]) * at->beyond[TERMS][i];
        z[i] = (z0 - y0) * p->follower.kept;
        S[i] = (S0 - y0) * p->after.kept + (z0 - y0) * p->lag;
    }
    for (int n = 1; n <= ORDER; n++) {
        const double follower = p->follower.of[n], after = p->after.of[n];
        const int from = ORDER - 1 - n < 0 ? 0 : ORDER - 1 - n < TERMS ? ORDER - 1 - n : TERMS;
        for (int i = 0; i < count; i++) {
            const double term = at->y[n][i];
            y[i] += term;
            z[i] += follower * term;
            S[i] += after * term;
            up[i] += td_greater(term, 0);
            down[i] += td_lesser(term, 0);
            left[i] += fabs(at->w[n][i]) * at->beyond[from][i];
            if (n < ORDER) v[i] += at->v[n][i];
        }
    }
    for (int i = 0; i < count; i++) {
        const int j = first + i;
        const double y0 = at->y[0][i], S0 = of->state[0][j], z0 = of->state[3][j], end = y0 + z[i];
        const double low = td_lesser(td_lesser(y0 + down[i], z0), S0), high = td_greater(td_greater(y0 + up[i], z0), S0);
        of->fails[j] += left[i] <= tolerance * p->a * of->dimmest[j] ? 0.0 : NAN;
        of->low[j] = td_lesser(low, of->low[j]);
        of->high[j] = td_greater(high, of->high[j]);
        of->state[0][j] = p->has_difference ? y0 + S[i] : end;
        of->state[1][j] = y0 + y[i];
        of->state[2][j] = v[i] / p->length_s;
        of->state[3][j] = end;
    }
}

TD_WIDE static void step_panel(const panel *p, block *of) {
    lanes at;
    for (int first = 0; first < of->count; first += LANES) {
        const int left = of->count - first, count = left < LANES ? td_whole_vectors(left) : LANES;
        take_light(p, of, first, count, &at);
        take_series(p, of, first, count, &at);
        finish(p, of, first, count, &at);
    }
}

/* -- steps ----------------------------------------------------------------------------------------------------------------- */

/* How many panels each pixel needs, INFINITY where it has no answer, and the least I. */
TD_WIDE static void want(const circuit *given, double h, int count, const double *const control[4], double *restrict wanted,
                         double *restrict dimmest) {
    const circuit law = *given;
    const double *c0 = control[0], *c1 = control[1], *c2 = control[2], *c3 = control[3], by = 1 / longest;
    for (int i = 0; i < count; i++) {
        const double b0 = c0[i], b1 = c1[i], b2 = c2[i], b3 = c3[i];
        const double most = td_greater(td_greater(b0, b1), td_greater(b2, b3));
        const double least = td_lesser(td_lesser(b0, b1), td_lesser(b2, b3));
        const double odd = (b0 - b0) + (b1 - b1) + (b2 - b2) + (b3 - b3); /* 0, or NaN */
        const double I = law.light * (td_exponential(most) - law.log_eps) + law.dark;
        const double turns = h * (sqrt(I > 0 ? law.spring * I : 0) + law.drag + law.drag_light * I);
        const double panels = by * (turns + steep * td_greater(td_greater(fabs(b1 - b0), fabs(b3 - b2)), fabs(b2 - b1)));
        double many = least >= law.dark_L ? panels : INFINITY;
        many = most < TD_LIGHT_MOST ? many : INFINITY;
        wanted[i] = odd == 0 ? many : INFINITY;
        dimmest[i] = law.light * (td_exponential(least) - law.log_eps) + law.dark;
    }
}

static void take(block *of, size_t pixel, const double b[4], double dimmest, const double *const state[STATES]) {
    const double d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2];
    const int k = of->count++;
    of->l[0][k] = b[0];
    of->l[1][k] = 3 * d0;
    of->l[2][k] = 3 * (d1 - d0);
    of->l[3][k] = d2 - 2 * d1 + d0;
    of->dimmest[k] = dimmest;
    of->fails[k] = 0;
    for (int s = 0; s < STATES; s++) {
        of->state[s][k] = state[s][pixel];
        of->fails[k] += of->state[s][k] - of->state[s][k]; /* 0, or NaN */
    }
    of->low[k] = INFINITY;
    of->high[k] = -INFINITY;
    of->pixel[k] = (int)pixel;
}

/* Fills the last vector by repeating the last pixel. */
static void fill_up(block *of) {
    const int last = of->count - 1;
    for (int k = of->count; k < td_whole_vectors(of->count); k++) {
        for (int s = 0; s < STATES; s++) of->state[s][k] = of->state[s][last];
        for (int c = 0; c < 4; c++) of->l[c][k] = of->l[c][last];
        of->dimmest[k] = of->dimmest[last];
        of->low[k] = of->high[k] = of->fails[k] = 0;
    }
}

static void step_class(const td_frontend *frontend, const circuit *law, double h, double panels, block *of) {
    panel p = {.law = *law, .length = 1 / panels, .length_s = h / panels};
    share(frontend, &p);
    fill_up(of);
    for (int k = 0; k < panels; k++) {
        p.from = k * p.length;
        step_panel(&p, of);
    }
}

static void step_block(const td_frontend *frontend, const circuit *law, double h, const td_filter_block *pixels) {
    const double *const *control = pixels->control;
    const int count = (int)pixels->count;
    double wanted[BLOCK], dimmest[BLOCK], fewer = 0;
    int tried[BLOCK] = {0};
    want(law, h, count, control, wanted, dimmest);
    for (int i = 0; i < count; i++) pixels->low[i] = pixels->high[i] = NAN;
    for (int c = 0; c < CLASSES; fewer = panels_of[c++]) {
        block of;
        of.count = 0;
        for (int i = 0; i < count; i++) {
            const double b[4] = {control[0][i], control[1][i], control[2][i], control[3][i]};
            if (wanted[i] <= panels_of[c] && !(c > 0 && wanted[i] <= fewer)) take(&of, (size_t)i, b, dimmest[i], pixels->state);
        }
        if (of.count == 0) continue;
        step_class(frontend, law, h, panels_of[c], &of);
        for (int k = 0; k < of.count; k++) {
            const int i = of.pixel[k];
            if (isnan(of.fails[k]) && tried[i]++ < retries) wanted[i] = 2 * panels_of[c];
            const double margin = TD_FRONTEND_TOLERANCE + 64 * DBL_EPSILON * (fabs(of.low[k]) + fabs(of.high[k]));
            for (int s = 0; s < STATES; s++) pixels->after[s][i] = of.state[s][k];
            pixels->low[i] = of.low[k] - margin + of.fails[k];
            pixels->high[i] = of.high[k] + margin + of.fails[k];
        }
    }
}

void td_circuit_step_many(const td_frontend *frontend, double h, double log_eps, const td_filter_block *pixels) {
    const circuit law = circuit_of(frontend, log_eps);
    for (size_t done = 0; done < pixels->count; done += BLOCK) {
        const td_filter_block part = td_filter_part(pixels, done, BLOCK);
        step_block(frontend, &law, h, &part);
    }
}
