/* Internal: events on the image itself. Before accepted steps count as compared, two kinds of places are looked up in the
 * image. At the first a pixel's comparator does something (events, ends of holds, noise). At the second the signal turns so
 * near a level that the model's error decides. Look-ups are single pixels at single times (td_renderer_points), in batches for
 * many tiles. While the device computes one batch, the host goes on with the values of the one before, and fills the next. The
 * values found become nodes of that pixel's model in that step. The comparator then goes over the pixel again, until no place
 * is off by more than the time asked for, or than rounding.
 *
 * A piece that begins at a node is right there in value and rate, so that near it little of the model's error is left: one look
 * nearly always settles an event.
 *
 * Samples at the ends of steps aren't trusted either: one so near a level that its own error decides is looked up. After an
 * occluder has passed, for example, a pixel's signal is back on a level to the last bit, and an event fires when the occluder's
 * edge ends.
 *
 * Pixels begin the run with references in the precision of samples. A pixel that may act for the first time, by the error of
 * its reference, has the reference looked up then, at the run's start. A pixel that never acts has none looked up.
 *
 * Events don't depend on batches, windows or cuts: the nodes of a pixel in a step follow from its samples and from its state at
 * the step's start. Pixels are run ahead with a provisional state, for longer batches. Where the state turns out to be another,
 * the nodes are found anew. */
#ifndef TD_SOLVE_H
#define TD_SOLVE_H

#include "signal/td_step.h"
#include "td_look_up.h"
#include "td_math.h"
#include "td_nodes.h"

/* A step that is being solved. */
typedef struct td_solve_step {
    td_step span;
    double from, to; /* [s after the epoch] */
    td_signals signals;
    td_coverage coverage, alpha_dot; /* only where coverage masks events */
} td_solve_step;

/* Look-ups of a run. */
typedef struct td_solve {
    int on;           /* events are looked up */
    int32_t unsolved; /* TIDES_UNSOLVED_* */
    int is_exact;     /* 1: look-ups are in double precision throughout */
    double target_s;  /* accuracy of times at which an event is settled [s] */
    double samples;   /* error of samples beside looked-up values [log units], */
    double dark;      /* and that of their light, which counts in dark pixels */
    uint64_t lookups; /* number of look-ups */
    double *known;    /* (pixels) 1 where the reference was looked up */
    int kept;         /* the renderer has kept the run's start */
    td_found *found;
    size_t found_count, found_capacity;
    td_solve_step *step; /* steps that are being solved, numbered as refine.step */
    size_t step_capacity;
    td_solve_batch batch[TD_SOLVE_BATCHES]; /* used in turns */
    int filling;                            /* number of the one that is being filled */
    size_t enough;                          /* points of a full batch, while the device works on another */
    size_t enough_now;                      /* and now: smaller at first, when the device has nothing to do */
    double sent_s, sent_alone_s; /* td_now and td_alone_time when the device was given a batch; sent_s 0: it has none */
    double covered_s;            /* time of the calling thread alone while the device worked on batches [s] */
} td_solve;

/* The batch that is being filled. */
static inline td_solve_batch *td_solve_filling(td_solve *solve) { return &solve->batch[solve->filling]; }

/* td_solve_choose sets `on` and `unsolved` from the parameters, when the renderer has its PSF. TIDES_UNSUPPORTED: look-ups were
 * demanded and aren't possible; the device doesn't matter. td_solve_create allocates memory, when the sensor exists. */
TIDES_MUST_CHECK tides_status td_solve_choose(tides_simulator *s, const tides_sensor *sensor, const tides_stepping *stepping,
                                              tides_error *error);
TIDES_MUST_CHECK tides_status td_solve_create(tides_simulator *s, tides_error *error);
void td_solve_release(td_solve *solve);

/* Called before a macro step is swept. Before the second, it sweeps the run's start, and keeps its lists and views for
 * references. From then on paths need not cover the start. */
TIDES_MUST_CHECK tides_status td_solve_keep_start(tides_simulator *s, tides_error *error);

/* Runs the comparator over the accepted steps of the units that move, as far as no open step is before them. */
TIDES_MUST_CHECK tides_status td_solve_steps(tides_simulator *s, tides_error *error);

/* Called before units at rest are compared over a macro step that begins at `start`. Pixels that may do something there get
 * their signals and references from look-ups, so that slow ramps meet levels at the right time. */
TIDES_MUST_CHECK tides_status td_solve_still(tides_simulator *s, const td_step *span, double start, tides_error *error);

/* Estimates at the end of a macro step the errors of its events' times, from a sample of them. */
TIDES_MUST_CHECK tides_status td_solve_measure(tides_simulator *s, tides_error *error);

/* The error of a sample whose log_luminance is S. A dark pixel's is larger by the error of its light. */
static inline double td_solve_sample_error(const td_solve *solve, double S) {
    const double darker = -3; /* elsewhere that is below 5e-6, a quarter of the other errors */
    return S < darker ? solve->samples + solve->dark * td_exp(-S) : solve->samples;
}

/* How far a signal may be from its model before anything is looked up, but for swaps of depth, where log_luminance is S or more
 * at both ends. */
static inline double td_solve_first_widen(const td_solve *solve, const td_trust *trust, double S) {
    return td_solve_first_doubt(trust) + td_solve_sample_error(solve, S);
}

#endif
