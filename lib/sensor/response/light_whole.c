/* The low-pass whose rate goes with the light, over whole steps of the pixels of a tile, in loops that vectorise. Pixels
 * without an answer here are solved in substeps.
 *
 * With V the integral of its rate, S' = V' (L - S) has the solution
 *
 *   S(1) = L(1) + (S(-1) - L(-1)) e^(V(-1) - V(1)) - integral of L'(x) e^(V(x) - V(1)),    x in [-1, 1] over the step.
 *
 * V' is the Taylor series of e^L (E' = L' E), and Gauss's rule of six nodes computes the integral. The errors of both have
 * bounds for every pixel, and a pixel whose bound is too large has no answer here:
 *
 *   The series. With |l_k| for L's coefficients it has terms g_n >= |e_n|, of which all from g_TERMS on are together at most
 *   (|l1| g_7 + 2 |l2| (g_6 + g_7) + 3 |l3| (g_5 + g_6 + g_7)) / (TERMS - |l1| - 2 |l2| - 3 |l3|): sum n g_n = L' E.
 *   The rule. It is exact for L' alone. The rest, f = L' (e^(V - V(1)) - 1), is an entire function: where |f| <= M on the
 *   ellipse about -1 and 1 whose semi-axes add up to r, the rule's error is at most 64/15 M r^-10 / (r^2 - 1) (Trefethen,
 *   Approximation Theory and Approximation Practice, theorem 19.3). M follows from the g_n, and |e^z - 1| <= |z| e^(Re z)+.
 *
 * A step keeps e^-R of earlier errors, where R is the step's V(1) - V(-1). So each step may have an error of 1 - e^-R of the
 * tolerance, which is at least R / (1 + R): then the sum over all steps is at most the tolerance.
 *
 * Bounds of S on the step come from its ends. At a maximum between them S is L, so at most L's largest. From there S falls no
 * faster than towards L's least, so that it is at most S(1) + (S(1) - least) (e^R - 1). A minimum is bounded likewise. */
#include "td_exponential.h"
#include "td_extremes.h"
#include "td_frontend.h"
#include "td_math.h"
#include "td_wide.h"

#include <float.h>
#include <math.h>

enum { TERMS = 8, NODES = 3, BLOCK = 64, PANELS_MAX = 8 };

/* Gauss's rule: nodes are +- these. */
static const double node[NODES] = {0.23861918608319690863, 0.66120938646626451366, 0.93246951420315202781};
static const double weight[NODES] = {0.46791393457269104739, 0.36076157304813860757, 0.17132449237917034504};

/* The ellipse: r, its larger semi-axis and powers of r. */
#define ELLIPSE 10.0
#define AXIS (0.5 * (ELLIPSE + 1 / ELLIPSE))
#define AXIS_2 (AXIS * AXIS)
#define AXIS_4 (AXIS_2 * AXIS_2)

/* Error of Gauss's rule where M is 1. */
#define RULE (64.0 / 15 / (1e10 * (ELLIPSE * ELLIPSE - 1)))

/* Largest R in full light for one use of the rule; longer steps are cut into panels. */
static const double longest = 3.5;

/* Tolerance of S, a tenth of the promised one. It costs little: bounds are far above the measured error (1e-13). */
static const double tolerance = 0.1 * TD_FRONTEND_TOLERANCE;

/* The filter's numbers that all pixels of a step share. */
typedef struct light_pole {
    double rate, light, beside; /* V' = rate (light e^L + beside) */
    double dark_L;
    double middle, half; /* of the current panel, in x of the step */
} light_pole;

/* Pixels side by side: their input about the panel's middle, its least and largest on the step, and the results. */
typedef struct light_block {
    double l[4][BLOCK], least[BLOCK], most[BLOCK];
    double r[TERMS][BLOCK], end[BLOCK]; /* V' = r0 + r1 x + ..., V(1) - V(0) */
    double missing[BLOCK], M[BLOCK];    /* bounds: of the series' error of V(1) - V(x), and of f on the ellipse */
    double sum[BLOCK];                  /* the integral */
} light_block;

/* Odd and even powers in V(x) - V(0), for x and -x. */
static inline double odd_part(double r0, double r2, double r4, double r6, double x) {
    const double z = x * x;
    return x * (r0 + z * (r2 * (1.0 / 3) + z * (r4 * (1.0 / 5) + z * (r6 * (1.0 / 7)))));
}

static inline double even_part(double r1, double r3, double r5, double r7, double x) {
    const double z = x * x;
    return z * (r1 * (1.0 / 2) + z * (r3 * (1.0 / 4) + z * (r5 * (1.0 / 6) + z * (r7 * (1.0 / 8)))));
}

/* -- all at once ----------------------------------------------------------------------------------------------------------- */

TD_WIDE static void take_input(const light_pole *given, int count, const double *const control[4], light_block *restrict at) {
    const light_pole p = *given;
    const double *c0 = control[0], *c1 = control[1], *c2 = control[2], *c3 = control[3], m = p.middle, q = p.half;
    for (int i = 0; i < count; i++) {
        const double b0 = c0[i], b1 = c1[i], b2 = c2[i], b3 = c3[i], d0 = b1 - b0, d1 = b2 - b1, d2 = b3 - b2;
        const double l0 = 0.125 * (b0 + 3 * b1 + 3 * b2 + b3), l1 = 0.375 * (d0 + 2 * d1 + d2), l2 = 0.375 * (d2 - d0);
        const double l3 = 0.125 * (d2 - 2 * d1 + d0);
        at->l[0][i] = l0 + m * (l1 + m * (l2 + m * l3));
        at->l[1][i] = q * (l1 + m * (2 * l2 + m * (3 * l3)));
        at->l[2][i] = q * q * (l2 + m * (3 * l3));
        at->l[3][i] = q * q * q * l3;
        at->least[i] = td_lesser(td_lesser(b0, b1), td_lesser(b2, b3));
        at->most[i] = td_greater(td_greater(b0, b1), td_greater(b2, b3));
    }
}

/* The rate's series, and its bounds. */
TD_WIDE static void take_series(const light_pole *given, int count, light_block *restrict at) {
    const light_pole p = *given;
    for (int i = 0; i < count; i++) {
        const double E = p.rate * p.light * td_exponential(at->l[0][i]);
        const double a1 = at->l[1][i], a2 = 2 * at->l[2][i], a3 = 3 * at->l[3][i], r1 = a1 * E;
        const double r2 = (a1 * r1 + a2 * E) * (1.0 / 2), r3 = (a1 * r2 + a2 * r1 + a3 * E) * (1.0 / 3);
        const double r4 = (a1 * r3 + a2 * r2 + a3 * r1) * (1.0 / 4), r5 = (a1 * r4 + a2 * r3 + a3 * r2) * (1.0 / 5);
        const double r6 = (a1 * r5 + a2 * r4 + a3 * r3) * (1.0 / 6), r7 = (a1 * r6 + a2 * r5 + a3 * r4) * (1.0 / 7);
        const double r0 = E + p.rate * p.beside;
        const double m1 = fabs(a1), m2 = fabs(a2), m3 = fabs(a3), g1 = m1 * E;
        const double g2 = (m1 * g1 + m2 * E) * (1.0 / 2), g3 = (m1 * g2 + m2 * g1 + m3 * E) * (1.0 / 3);
        const double g4 = (m1 * g3 + m2 * g2 + m3 * g1) * (1.0 / 4), g5 = (m1 * g4 + m2 * g3 + m3 * g2) * (1.0 / 5);
        const double g6 = (m1 * g5 + m2 * g4 + m3 * g3) * (1.0 / 6), g7 = (m1 * g6 + m2 * g5 + m3 * g4) * (1.0 / 7);
        const double left = m1 * g7 + m2 * (g6 + g7) + m3 * (g5 + g6 + g7), to_spare = TERMS - (m1 + m2 + m3);
        const double bent = g1 * ((AXIS_2 + 1) / 2) + g2 * ((AXIS_2 * AXIS + 1) / 3) + g3 * ((AXIS_4 + 1) / 4) +
                            g4 * ((AXIS_4 * AXIS + 1) / 5) + g5 * ((AXIS_4 * AXIS_2 + 1) / 6) +
                            g6 * ((AXIS_4 * AXIS_2 * AXIS + 1) / 7) + g7 * ((AXIS_4 * AXIS_4 + 1) / 8);
        const double steep = m1 + AXIS * m2 + AXIS_2 * m3;
        /* Above 600 M is far too large in any case. */
        const double M = steep * (r0 * (AXIS + 1) + bent) * td_exponential(td_lesser(r0 * (AXIS - 1) + bent, 600));
        at->r[0][i] = r0;
        at->r[1][i] = r1;
        at->r[2][i] = r2;
        at->r[3][i] = r3;
        at->r[4][i] = r4;
        at->r[5][i] = r5;
        at->r[6][i] = r6;
        at->r[7][i] = r7;
        at->end[i] = odd_part(r0, r2, r4, r6, 1) + even_part(r1, r3, r5, r7, 1);
        at->M[i] = M;
        at->missing[i] = to_spare > 1 ? 2 * left / to_spare : 1e300;
        at->sum[i] = 0;
    }
}

/* Adds the integral's share of the nodes x and -x. */
TD_WIDE static void add_nodes(double x, double by, int count, light_block *restrict at) {
    for (int i = 0; i < count; i++) {
        const double odd = odd_part(at->r[0][i], at->r[2][i], at->r[4][i], at->r[6][i], x);
        const double even = even_part(at->r[1][i], at->r[3][i], at->r[5][i], at->r[7][i], x) - at->end[i];
        const double flat = at->l[1][i] + 3 * at->l[3][i] * (x * x), tilt = 2 * at->l[2][i] * x;
        at->sum[i] += by * ((flat + tilt) * td_exponential(even + odd) + (flat - tilt) * td_exponential(even - odd));
    }
}

/* Takes S to the panel's end, and extends `low` and `high`. They become NaN where the error's bound is too large. */
TD_WIDE static void finish(const light_pole *given, int count, const light_block *restrict at, double *restrict S_at,
                           double *restrict low, double *restrict high) {
    const light_pole p = *given;
    for (int i = 0; i < count; i++) {
        const double l0 = at->l[0][i], l1 = at->l[1][i], l2 = at->l[2][i], l3 = at->l[3][i], S = S_at[i];
        const double least = at->least[i], most = at->most[i];
        const double R = 2 * odd_part(at->r[0][i], at->r[2][i], at->r[4][i], at->r[6][i], 1), lag = S - (l0 - l1 + l2 - l3);
        const double decay = td_exponential(td_greater(-R, -600)), after = (l0 + l1 + l2 + l3) + lag * decay - at->sum[i];
        const double moved = 2 * (fabs(l1) + 2 * fabs(l2) + 3 * fabs(l3));
        const double error =
            1.01 * at->missing[i] * (fabs(lag) + moved) + RULE * at->M[i]; /* e^missing < 1.01 where the bound can be met */
        const double over = after + TD_FRONTEND_TOLERANCE, under = after - TD_FRONTEND_TOLERANCE, grown = 1 / decay - 1;
        const double peak = td_lesser(most, over + td_greater(over - least, 0) * grown);
        const double trough = td_greater(least, under - td_greater(most - under, 0) * grown);
        const double margin = TD_FRONTEND_TOLERANCE + 64 * DBL_EPSILON * (fabs(S) + fabs(most) + fabs(least));
        double fails = error * (1 + R) <= tolerance * R ? 0.0 : NAN;
        fails = R > 0 ? fails : NAN; /* a series that is far off may give any value */
        fails = least >= p.dark_L ? fails : NAN;
        fails = most < 60 ? fails : NAN;
        S_at[i] = after;
        low[i] = td_lesser(td_lesser(td_lesser(S, under), trough) - margin, low[i]) + fails;
        high[i] = td_greater(td_greater(td_greater(S, over), peak) + margin, high[i]) + fails;
    }
}

static void step_block(light_pole *p, int panels, const td_filter_block *pixels) {
    const int count = (int)pixels->count;
    light_block at;
    for (int k = 0; k < panels; k++) {
        p->middle = (2 * k + 1) * p->half - 1;
        take_input(p, count, pixels->control, &at);
        take_series(p, count, &at);
        for (int i = 0; i < NODES; i++) add_nodes(node[i], weight[i], count, &at);
        finish(p, count, &at, pixels->after[0], pixels->low, pixels->high);
    }
}

void td_light_whole(const td_frontend *frontend, double h, double log_eps, const td_filter_block *pixels) {
    const double full = frontend->rate * h, most = PANELS_MAX;
    const int panels = (int)td_lesser(ceil(td_greater(full / longest, 1)), most);
    light_pole p = {0.5 * full / panels, frontend->light, frontend->dark - frontend->light * log_eps, td_ln(log_eps), 0,
                    1.0 / panels};
    for (size_t i = 0; i < pixels->count; i++) {
        pixels->after[0][i] = pixels->state[0][i];
        pixels->low[i] = INFINITY;
        pixels->high[i] = -INFINITY;
    }
    for (size_t done = 0; done < pixels->count; done += BLOCK) {
        const td_filter_block part = td_filter_part(pixels, done, BLOCK);
        step_block(&p, panels, &part);
    }
}
