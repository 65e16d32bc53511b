/* Internal: the centre-surround of the retina's outer layer, as in v2e's diffuser (CSDVS), in continuous time. With p for the
 * photoreceptors' output, h for the surround, and lap4 the 5-point Laplacian with borders that repeat:
 *
 *   tau h' = (p - h) + lambda^2 lap4(h)        S = p - h
 *
 * h of a step follows from the cubic p to rounding: by its Taylor series on the image (td_diffuse.h), or where that takes more
 * operations, in cosine modes. There the equation is one first-order low-pass each, of rate (1 + lambda^2 mu) / tau, whose
 * response to a cubic has a closed form. tau = 0 is the steady state at each moment. All pixels belong together, so all must
 * have their steps in common.
 *
 * The comparator needs S as cubics in time, so that a step is cut into substeps. Where the cubic of a substep misses the exact
 * S of any pixel half way through by more than `tolerance`, the substep is halved. Where it doesn't, its two halves are given
 * out. It is given out whole if it misses at most a sixteenth of the tolerance, as its halves would. How a step is cut depends
 * on that step alone. */
#ifndef TD_SURROUND_H
#define TD_SURROUND_H

#include "td_dct.h"
#include "td_diffuse.h"
#include "tides/sensor.h"

/* Every pixel at a time, (height x width) each. */
typedef struct td_surround_sample {
    double *S, *S_dot;
    const double *p, *p_dot;   /* the input: of an end of the step, or */
    double *own_p, *own_p_dot; /* of a place within it */
} td_surround_sample;

typedef struct td_surround {
    double lambda_px, tau_s, tolerance;
    int has_cubics; /* 1: the comparator has cubics. Other models are off by more on whole substeps, which are always halved */
    td_dct cosine;
    td_diffusion diffusion;
    double *surround; /* h at `at` (height x width) */
    double *input[4]; /* p, p_dot [1/s] at the step's beginning, then at its end */
    double *modes[4]; /* the same, in modes, */
    int has_modes[4]; /* where 1 */
    double *half_h, *end_h, *spare, *image;
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

/* Pixels have rested at p for ever, and begin to change at the rate p_dot (height x width). `end` is the sample there. */
void td_surround_rest(td_surround *surround, const double *p, const double *p_dot);

/* Goes on from a run that was saved with the surround h (height x width), at p and p_dot. */
void td_surround_resume(td_surround *surround, const double *h, const double *p, const double *p_dot);

/* Where p and p_dot at the next step's end are written before it begins (height x width). */
void td_surround_next_input(td_surround *surround, double **p, double **p_dot);

/* Begins a step of `length_s` from the end of the last one, to the next input. p_dot begins at from_dot (nullable: where the
 * last step ended). */
void td_surround_begin(td_surround *surround, double length_s, const double *from_dot);

/* The next substep, from *from to *to as parts of the step in [0, 1], and samples at both ends, valid until the next call.
 * Returns 0 where the step is over. */
int td_surround_next(td_surround *surround, double *from, double *to, td_surround_sample *begin, td_surround_sample *end);

#endif
