/* The constant low-pass over the pixels of a tile, in loops that vectorise.
 *
 * The operations are those of td_poles_respond and td_response_value with one real pole at the step's end. So results are equal
 * to the bit, and events don't depend on which pixels had their response computed. */
#include "td_extremes.h"
#include "td_frontend.h"
#include "td_modes.h"

#include <float.h>

/* The pole's numbers that all pixels of a step share. */
typedef struct real_pole {
    double rate, inverse; /* lambda per step, and 1 / lambda */
    double basis;         /* of the mode's cosine at s = 1 */
    double way;           /* S goes at most this share of the way to the input: 1 - e^-rate, or a little more */
} real_pole;

/* S at the end of the step; b are the input's control values. */
static inline double respond(int slow, const real_pole *pole, const double b[4], double S) {
    double d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2], offset = S - b[0];
    double l1 = 3 * d0, l2 = 3 * (d1 - d0), l3 = d2 - 2 * d1 + d0;
    if (slow) {
        double x1 = -(pole->rate * offset), x2 = pole->rate * (l1 - x1) * (1.0 / 2);
        double x3 = pole->rate * (l2 - x2) * (1.0 / 3), x4 = pole->rate * (l3 - x3) * (1.0 / 4);
        return S + x1 + x2 + x3 + x4 * 24 * pole->basis;
    }
    double p2 = l2 - l3 * pole->inverse * 3, p1 = l1 - p2 * pole->inverse * 2, amplitude = offset + p1 * pole->inverse;
    return S - amplitude + p1 + p2 + l3 + amplitude * pole->basis;
}

/* Rounding of S and of its response. S is an average of its old value and the input: it goes towards the input, but for
 * rounding. */
static const double rounding = 64 * DBL_EPSILON;

static inline void step(int slow, const real_pole *pole, size_t count, const double *const control[4], const double *restrict S,
                        double *restrict after, double *restrict low, double *restrict high) {
    const double *b0 = control[0], *b1 = control[1], *b2 = control[2], *b3 = control[3];
    for (size_t i = 0; i < count; i++) {
        const double b[4] = {b0[i], b1[i], b2[i], b3[i]};
        double finite = (b[0] - b[0]) + (b[1] - b[1]) + (b[2] - b[2]) + (b[3] - b[3]); /* 0, or NaN */
        double begin = S[i] - S[i] == 0 ? S[i] : b[0], end = respond(slow, pole, b, begin);
        double least = td_lesser(td_least4(b), begin);
        double most = td_greater(td_most4(b), begin);
        double margin = rounding * (td_greater(most, -least) + (most - least));
        after[i] = finite == 0 ? end : S[i];
        low[i] = begin - pole->way * (begin - least) - margin + finite;
        high[i] = begin + pole->way * (most - begin) + margin + finite;
    }
}

void td_frontend_step_many(const td_frontend *frontend, double h, const td_filter_block *of) {
    const double rate = frontend->rate * h;
    const int slow = !(rate > 1); /* as td_poles_respond has it */
    const td_mode mode = {rate, 0, 1, 0, slow};
    const real_pole pole = {rate, 1 / rate, td_mode_value(&mode, 1), slow ? rate : 1};
    if (slow)
        step(1, &pole, of->count, of->control, of->state[0], of->after[0], of->low, of->high);
    else
        step(0, &pole, of->count, of->control, of->state[0], of->after[0], of->low, of->high);
}
