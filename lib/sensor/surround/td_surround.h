/* Internal: the centre-surround of the retina's outer layer, as in v2e's diffuser (CSDVS), in continuous time. With p for the
 * photoreceptors' output, h for the surround, and lap4 the 5-point Laplacian with borders that repeat:
 *
 *   tau h' = (p - h) + lambda^2 lap4(h)        S = p - h
 *
 * In cosine modes this is one first-order low-pass each, of rate (1 + lambda^2 mu) / tau. Its response to the cubic p of a step
 * has a closed form: nothing is integrated numerically, and nothing depends on the length of steps. tau = 0 is the steady state
 * at each moment. All pixels belong to all modes, so all must have their steps in common.
 *
 * The comparator needs S as cubics in time, so that a step is cut into substeps. Where the cubic of a substep misses the exact
 * S of any pixel half way through by more than `tolerance`, the substep is halved. Where it doesn't, its two halves are given
 * out. It is given out whole if a bound from the modes shows that it misses at most a sixteenth of the tolerance, as its halves
 * would. How a step is cut depends on that step alone. */
#ifndef TD_SURROUND_H
#define TD_SURROUND_H

#include "td_dct.h"
#include "tides/sensor.h"

/* Every pixel at a time, (height x width) each. */
typedef struct td_surround_sample {
    double *S, *S_dot;
    double *p, *p_dot; /* the input */
} td_surround_sample;

typedef struct td_surround {
    int on; /* 0: off, and nothing below is set */
    double lambda_px, tau_s, tolerance;
    td_dct cosine;
    double *surround; /* modes of h at `at` */
    double *input[4]; /* p, p_dot [1/s] at the step's beginning, then at its end (height x width) */
    double *modes[4]; /* the same, in modes */
    double *half_modes, *end_modes, *spare, *image;
    td_surround_sample begin, half, end; /* samples of the current substep */
    double length_s;                     /* of the step */
    double at;                           /* place reached in it, 0 to 1 */
    int depth;                           /* length of the next substep: step / 2^depth */
    int pending;                         /* 1: the second half of a substep is still to be given out */
    double pending_part;                 /* its part of the step */
} td_surround;

/* Makes the surround of a sensor whose surround_lambda_px isn't 0. TIDES_BAD_ARGUMENT naming the field. td_surround_release
 * frees. */
TIDES_MUST_CHECK tides_status td_surround_create(const tides_sensor *sensor, int width, int height, double tolerance,
                                                 td_surround *surround, tides_error *error);
void td_surround_release(td_surround *surround);

/* Pixels have rested at p for ever, and begin to change at the rate p_dot (height x width). *now becomes the sample there. */
void td_surround_rest(td_surround *surround, const double *p, const double *p_dot, td_surround_sample *now);

/* Goes on from a run that was saved with `modes` of the surround (height x width), at p and p_dot. */
void td_surround_resume(td_surround *surround, const double *modes, const double *p, const double *p_dot,
                        td_surround_sample *now);

/* Begins a step of `length_s` from the end of the last one, where p_dot is from_dot (it may have jumped), to p and p_dot. */
void td_surround_begin(td_surround *surround, double length_s, const double *from_dot, const double *p, const double *p_dot);

/* The next substep, from *from to *to as parts of the step in [0, 1], and samples at both ends, valid until the next call.
 * Returns 0 where the step is over. */
int td_surround_next(td_surround *surround, double *from, double *to, td_surround_sample *begin, td_surround_sample *end);

#endif
