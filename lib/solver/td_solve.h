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

#include "sensor/td_sensor.h"
#include "td_refine.h"
#include "signal/td_pieces.h"
#include "td_math.h"

/* Trust in a piece of a pixel's model. `error` is the model's error in the middle [log units]. Elsewhere it is 16 u^2 (1 - u)^2
 * of that for a smooth signal, and 4 u (1 - u) for one with a kink somewhere. `unseen` is a further error in the middle, by
 * bends that no look may have met, a kink above all. It decides where events may be, not how accurate the times of found ones
 * are. */
typedef struct td_trust {
    double error;
    int is_smooth;
    double unseen;
} td_trust;

/* A node, trust in the piece that begins there, and the pixel's next node in the step, or -1. */
typedef struct td_found {
    td_node node;
    td_trust trust;
    int32_t next;
} td_found;

/* A pixel in a step in which it may do something. All data that each round reads are side by side, because the samples of a
 * macro step don't fit in caches. */
typedef struct td_looked {
    td_ends ends;
    td_trust trust;       /* of the first piece */
    uint64_t state;       /* the pixel's state at the step's start, when something was looked up */
    int32_t step;         /* in the macro step */
    int32_t first;        /* first node, or -1 */
    int16_t nodes, looks; /* number of nodes, and of rounds of look-ups */
    int32_t known_ends;   /* TD_KNOWS_*: ends that were looked up */
} td_looked;
enum { TD_KNOWS_START = 1, TD_KNOWS_END = 2 };

/* A pixel that may do something, and how far it is settled. */
typedef struct td_solving {
    int32_t unit, local;
    int32_t next, end; /* its steps that aren't settled: td_looked, neighbours */
    int32_t waits;     /* for its reference */
} td_solving;

/* A step that is being solved. */
typedef struct td_solve_step {
    td_step span;
    double from, to; /* [s after the epoch] */
    td_signals signals;
    td_coverage coverage, alpha_dot; /* only where coverage masks events */
} td_solve_step;

/* The asker of a point (td_looked; the unit's pixel), and the point's place in its step: 0 and 1 are the ends. */
typedef struct td_asked {
    int32_t looked, local;
    double s;
} td_asked;

/* Points that are looked up together. */
typedef struct td_solve_batch {
    td_solving *pixel; /* the pixels that requested the points, and aren't settled */
    size_t pixels, pixel_capacity;
    td_point *point;
    size_t points, point_capacity;
    td_asked *asked; /* (points) */
    size_t asked_capacity;
    td_point_value *value; /* (points) set when they are back */
    size_t value_capacity;
} td_solve_batch;
enum { TD_SOLVE_BATCHES = 3 };

/* An event of a macro step whose time is measured at the step's end. It has the model's slope and curvature there, towards the
 * event's side and per step of length_s; its rounding; and if it waited for coverage, how late it may be [steps]. */
typedef struct td_sampled {
    uint64_t order;
    td_point point;
    double L, slope, bend, floor, late, length_s;
} td_sampled;

/* Pixels whose references are to be looked up. */
typedef struct td_solve_refer_list {
    size_t *wanted;       /* (count) */
    td_point *start;      /* their places, at the run's start */
    td_point_value *rest; /* the values found there */
    size_t count, wanted_capacity, start_capacity, rest_capacity;
} td_solve_refer_list;

struct td_portion;
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
} td_solve;

/* The results of a portion of the work: pixels that may do something, requested points, settled events. */
typedef struct td_solve_portion {
    td_looked *looked; /* the run's: of all pixels that may do something; a portion's: of those that it listed */
    size_t looked_count, looked_capacity;
    td_solve_batch *asks; /* where points are requested: in the run's batch, or */
    td_solve_batch own;   /* in the portion's, which is joined to the run's */
    td_solve_refer_list refer;
    uint8_t *reaches; /* for each of a unit's steps (samples.pixels): 0 where a pixel has no level within reach */
    size_t reach_capacity;
    td_trust *trust; /* likewise: trust before anything is looked up */
    size_t trust_capacity;
    td_work ahead;       /* results of the pixel's current step; joined to the portion's when nothing in it must be looked up */
    td_sampled *sampled; /* of this macro step's events, the first in a random order */
    size_t sampled_count, sampled_capacity;
    int is_cut;      /* 1: there were more of them */
    size_t fired;    /* number of events of this macro step */
    uint64_t events; /* events found by look-ups */
} td_solve_portion;
void td_solve_batch_release(td_solve_batch *batch);
void td_solve_portion_clear(td_solve_portion *portion);
void td_solve_portion_release(td_solve_portion *portion);

/* Joins a portion's results to the run's. */
TIDES_MUST_CHECK tides_status td_solve_join(tides_simulator *s, const td_solve_portion *portion, tides_error *error);

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

/* -- parts of it ---------------------------------------------------------------------------------------------------------- */

/* td_solve_filling: the batch that is being filled. td_solve_ask requests a point for a pixel of a unit; `asked` is returned
 * with the value. */
static inline td_solve_batch *td_solve_filling(td_solve *solve) { return &solve->batch[solve->filling]; }
TIDES_MUST_CHECK tides_status td_solve_ask(td_solve_batch *batch, const td_tile *tile, int32_t local, double time,
                                           const td_asked *asked, tides_error *error);

/* Adds the time since `begun` [s] to that of look-ups. */
void td_solve_note_time(tides_simulator *s, double begun);

/* td_solve_send gives a batch to the renderer, and td_solve_receive waits for its values. td_solve_look_up does both for the
 * batch that is being filled. */
TIDES_MUST_CHECK tides_status td_solve_send(tides_simulator *s, td_solve_batch *batch, tides_error *error);
TIDES_MUST_CHECK tides_status td_solve_receive(tides_simulator *s, tides_error *error);
TIDES_MUST_CHECK tides_status td_solve_look_up(tides_simulator *s, tides_error *error);

/* td_solve_turn sends the filled batch to the device, and runs the pixels of the batch that is back, which may request more.
 * td_solve_has_enough: a full batch is there. td_solve_is_busy: points are requested or under way. td_solve_clear_batches drops
 * all. */
TIDES_MUST_CHECK tides_status td_solve_turn(tides_simulator *s, tides_error *error);
int td_solve_has_enough(const tides_simulator *s);
int td_solve_is_busy(const tides_simulator *s);
void td_solve_clear_batches(tides_simulator *s);

/* td_solve_doubt: error bounds of a unit's references, 0 where they were looked up (TD_TILE_PIXELS). td_solve_ask_reference
 * requests a pixel's reference, and td_solve_refer looks up all that were requested. */
void td_solve_doubt(const tides_simulator *s, int t, double *doubt);
TIDES_MUST_CHECK tides_status td_solve_ask_reference(const tides_simulator *s, td_solve_portion *portion, int t, int32_t local,
                                                     tides_error *error);
TIDES_MUST_CHECK tides_status td_solve_refer(tides_simulator *s, tides_error *error);

/* A swap of depth in a step: its middle `s`, its half-width `wide` [steps], and the change of Y that it makes. */
typedef struct td_swap_place {
    double s, wide, light;
} td_swap_place;

/* td_solve_swaps: swaps that a pixel of the step's unit may see, within a step's length of it: (count), in order of time.
 * td_solve_swap_place: a swap's place in the step. */
const td_swap *td_solve_swaps(const tides_simulator *s, const td_refine_step *step, int32_t local, int *count);
td_swap_place td_solve_swap_place(const tides_simulator *s, const td_refine_step *step, const td_swap *swap);

/* The share of a swap that a cubic through both its ends doesn't show, `wide` cubics' lengths to either side of its middle. All
 * of a short one; of a long one what a kink of the curvature leaves, by the square of how fast the depths pass. */
static inline double td_solve_swap_unseen(double wide) {
    const double left = 0.3 / (wide * wide);
    return left < 1 ? left : 1;
}

/* How far unseen light of swaps moves log_luminance, where that is S or more. */
double td_solve_moved_by(const tides_simulator *s, double light, double S);

/* How far swaps that don't show in a step's samples may move a pixel's log_luminance between these: all together, where it is S
 * or more at both ends. td_solve_widen_swapped adds it to `widen` of each of the unit's pixels. */
double td_solve_swapped(const tides_simulator *s, const td_refine_step *step, int32_t local, double S);
void td_solve_widen_swapped(const tides_simulator *s, const td_refine_step *step, const td_signals *signals, double *widen);

/* td_solve_sample offers a settled event to the measurement, and sets its `order`. td_solve_cut keeps the events to be
 * measured, TD_CHOSEN_MOST at most (chosen.c). */
enum { TD_CHOSEN_MOST = 256 };
TIDES_MUST_CHECK tides_status td_solve_sample(const tides_simulator *s, td_solve_portion *portion, const td_sampled *one,
                                              tides_error *error);

void td_solve_cut(const tides_simulator *s, td_solve_portion *portion);

/* Joins a portion's sampled events to the run's. */
TIDES_MUST_CHECK tides_status td_solve_join_samples(tides_simulator *s, const td_solve_portion *portion, tides_error *error);

/* Runs a pixel from its first unsettled step to the first in which something must be looked up, and requests that. An ideal
 * pixel is run to its last step. Its steps are in `looked`. */
TIDES_MUST_CHECK tides_status td_solve_run(const tides_simulator *s, struct td_portion *portion, td_looked *looked,
                                           td_solving *pixel, tides_error *error);

/* Trust in the models of pixels [first, first + count) of a unit, on a step of h seconds, before anything is looked up:
 * (count). */
void td_solve_first_trust(const tides_simulator *s, const td_refine_step *refined, double h, int32_t first, int32_t count,
                          td_trust *trust);

/* The model of a pixel in a step, and its errors. */
typedef struct td_trusted {
    td_pieces pieces; /* with the leak's ramp added */
    td_trust trust[TD_PIECES_MAX];
    double swapped[TD_PIECES_MAX]; /* what swaps of depth may hide within each piece [log units] */
    double start, end;             /* additional errors of the signal at the step's ends */
    double floor;                  /* error of any value that is looked up */
} td_trusted;

/* The model's error at u of piece k, without the floor. */
double td_trusted_error(const td_trusted *model, int k, double u);

/* The model's error at u of piece k that may decide whether a level is reached, without those of the step's ends. */
double td_trusted_doubt(const td_trusted *model, int k, double u);

/* The pixel's nodes, and the trust of each piece. Returns the number of nodes. */
int td_solve_nodes(const td_solve *solve, const td_looked *looked, td_node *nodes, td_trust *trust);

/* Makes the value at s a node, number `number` of solve->found. If s has a node already, nothing changes. */
void td_solve_insert(const td_solve *solve, td_looked *looked, int32_t number, double s, const td_point_value *value);

/* Light that compositing leaves out of samples: image.smoothing.stop_change. Points in double precision don't leave it out. */
#define TD_SOLVE_SAMPLES 1e-5

/* Units in the last place of 1 by which the light of a sample in single precision may be off: weights of splats are differences
 * of transmittances near 1. Two events were wrong by samples that were off by 1.3 and 2.5 (check_lost, taper 404 and 1111:
 * faint splats before black). It counts where log_luminance is below DARKER: elsewhere it is below 5e-6, a quarter of the other
 * errors. */
#define TD_SOLVE_DARK 4
#define TD_SOLVE_DARKER (-3.0)

/* The error of a sample whose log_luminance is S. */
static inline double td_solve_sample_error(const td_solve *solve, double S) {
    return S < TD_SOLVE_DARKER ? solve->samples + solve->dark * td_exp(-S) : solve->samples;
}

/* Least distance of nodes, in steps: far below a nanosecond, and enough for slopes from differences. */
#define TD_SOLVE_APART 1e-8

#endif
