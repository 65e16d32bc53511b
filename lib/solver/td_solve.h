/* Internal: events on the image itself. Before accepted steps count as compared, two kinds of places are looked up in the
 * image. At the first a pixel's comparator does something (events, ends of holds, noise). At the second the signal turns so
 * near a level that the model's error decides. Look-ups are single pixels at single times (td_renderer_points), in batches for
 * many tiles. While the device computes one batch, the host goes on with the values of the one before, and fills the next
 * (solve_batches.c). The values found become nodes of that pixel's model in that step (signal/td_pieces.h). The comparator then
 * goes over the pixel again, until no place is off by more than the time asked for, or than rounding.
 *
 * A piece that begins at a node is right there in value and rate, so that at a distance d from it little of the model's error
 * is left: one look nearly always settles an event.
 *
 * Samples at the ends of steps don't decide either: one so near a level that its own error decides is looked up. A pixel that
 * an occluder has passed is where it was before, on a level to the last bit, and fires when the occluder's edge ends.
 *
 * Pixels begin the run with references in the precision of samples. A pixel that may act for the first time, by the error of
 * its reference, has the reference looked up then, at the run's start. A pixel that never acts has none looked up.
 *
 * Events don't depend on batches, windows or cuts: the nodes of a pixel in a step are those that follow from its samples and
 * from the state that it begins the step with. Pixels are run ahead of that state, for longer batches; where the state turns
 * out to be another one, the nodes are found anew. */
#ifndef TD_SOLVE_H
#define TD_SOLVE_H

#include "sensor/td_sensor.h"
#include "td_refine.h"
#include "signal/td_pieces.h"

/* Trust in a piece of a pixel's model: its error in the middle [log units], and how the error lies in it. A smooth signal's is
 * 16 u^2 (1 - u)^2 of that, and that of one with a kink somewhere 4 u (1 - u). `unseen` is a further error in the middle by
 * bends that no look may have met, a kink above all. It decides where events may be, not how well the times of found ones are
 * known. */
typedef struct td_trust {
    double error;
    int is_smooth;
    double unseen;
} td_trust;

/* A node, the piece that begins there, and the pixel's next node in the step, or -1. */
typedef struct td_found {
    td_node node;
    td_trust trust;
    int32_t next;
} td_found;

/* A pixel in a step in which it may do something: all that is read of it round after round, side by side, for samples of a
 * macro step are too many for caches. */
typedef struct td_looked {
    td_ends ends;
    td_trust trust;       /* of the first piece */
    uint64_t state;       /* that the pixel began the step with when something was looked up (state_of) */
    int32_t step;         /* in the macro step */
    int32_t first;        /* node, or -1 */
    int16_t nodes, looks; /* of the latter, rounds */
    int32_t known_ends;   /* TD_KNOWS_*: the ends that are what was found there, and no samples */
} td_looked;
enum { TD_KNOWS_START = 1, TD_KNOWS_END = 2 };

/* A pixel that may do something, and how far it is settled. */
typedef struct td_solving {
    int32_t tile, local;
    int32_t next, end; /* its steps, from the first that isn't settled on: td_looked, side by side */
    int32_t waits;     /* for its reference */
} td_solving;

/* A step that is being solved. */
typedef struct td_solve_step {
    td_step span;
    double from, to; /* [s after the epoch] */
    td_signals signals;
    td_coverage coverage, alpha_dot; /* where there is a mask */
} td_solve_step;

/* The asker of a point (td_looked; the unit's pixel), and the point's place in its step: 0 and 1 are the ends. */
typedef struct td_asked {
    int32_t looked, local;
    double s;
} td_asked;

/* Points that are looked up together. */
typedef struct td_solve_batch {
    td_solving *pixel; /* those that asked, and aren't settled */
    size_t pixels, pixel_capacity;
    td_point *point;
    size_t points, point_capacity;
    td_asked *asked; /* (points) */
    size_t asked_capacity;
    td_point_value *value; /* (points) once they are back */
    size_t value_capacity;
} td_solve_batch;
enum { TD_SOLVE_BATCHES = 3 };

/* An event of a macro step whose time is measured at its end: what the model had there, slope and curvature towards the event's
 * side, per step of length_s; what is rounded; and, of one that waited for coverage, how late it may be [steps]. */
typedef struct td_sampled {
    uint64_t order;
    td_point point;
    double L, slope, bend, floor, late, length_s;
} td_sampled;

/* Pixels whose references are to be looked up. */
typedef struct td_solve_refer_list {
    size_t *wanted;       /* (count) */
    td_point *start;      /* and where they are */
    td_point_value *rest; /* what is found there */
    size_t count, wanted_capacity, start_capacity, rest_capacity;
} td_solve_refer_list;

struct td_portion;
typedef struct td_solve {
    int on;           /* events are looked up */
    int32_t unsolved; /* TIDES_UNSOLVED_* */
    int is_exact;     /* what is looked up is in double, all of it */
    double target_s;  /* times that are as good as that are settled */
    double samples;   /* what samples may be off by beside what is looked up [log units] */
    uint64_t lookups; /* points that were looked up */
    double *known;    /* (pixels) 1 where the reference is one that was looked up */
    int kept;         /* the renderer has kept the run's start (td_solve_keep_start) */
    td_found *found;
    size_t found_count, found_capacity;
    td_solve_step *step; /* of those that are being solved, as refine.step numbers them */
    size_t step_capacity;
    td_solve_batch batch[TD_SOLVE_BATCHES]; /* in turns (solve_batches.c) */
    int asking;                             /* which is filled: td_solve_asking */
    size_t enough;                          /* points that are worth a batch, while a device is at the one before, */
    size_t enough_now;                      /* and of the first ones, when it has nothing to do */
} td_solve;

/* The results of a portion of the work (td_portion.h): pixels that may do something, requested points, settled events. */
typedef struct td_solve_portion {
    td_looked *looked; /* the run's own: of all that may do something; a portion's: of those that it has listed */
    size_t looked_count, looked_capacity;
    td_solve_batch *asks; /* where pixels ask: in the batch that is filled, */
    td_solve_batch own;   /* or in the portion's, which is joined to that */
    td_solve_refer_list refer;
    uint8_t *reaches; /* of each of a unit's steps (samples.pixels): 0 where no pixel's level is (td_sensor_reaches) */
    size_t reach_capacity;
    td_trust *trust; /* likewise: before anything is looked up */
    size_t trust_capacity;
    td_work ahead;       /* of the pixel's step in hand: joined to the portion's once nothing in it is to be looked up */
    td_sampled *sampled; /* of this macro step's events, those that come first in an order of chance */
    size_t sampled_count, sampled_capacity;
    int is_cut;      /* there were more of them */
    size_t fired;    /* events of this macro step in all */
    uint64_t events; /* that were looked up */
} td_solve_portion;
void td_solve_batch_release(td_solve_batch *batch);
void td_solve_portion_clear(td_solve_portion *portion);
void td_solve_portion_release(td_solve_portion *portion);

/* Joins a portion to the run's own (join.c). */
TIDES_MUST_CHECK tides_status td_solve_join(tides_simulator *s, const td_solve_portion *portion, tides_error *error);

/* td_solve_choose decides `on` and `unsolved` from the parameters, once the renderer has its PSF. TIDES_UNSUPPORTED: looking up
 * can't be had; the device has no say in it. td_solve_create allocates its memory, once there is a sensor. */
TIDES_MUST_CHECK tides_status td_solve_choose(tides_simulator *s, const tides_sensor *sensor, const tides_stepping *stepping,
                                              tides_error *error);
TIDES_MUST_CHECK tides_status td_solve_create(tides_simulator *s, tides_error *error);
void td_solve_release(td_solve *solve);

/* To be called before a macro step is swept. Behind the first, it sweeps the run's start, and keeps its lists and views for
 * references (solve_rest.c): paths need not know the start from then on. */
TIDES_MUST_CHECK tides_status td_solve_keep_start(tides_simulator *s, tides_error *error);

/* Runs the comparator over the accepted steps of the tiles that move, as far as no open step is before them (settle.c). */
TIDES_MUST_CHECK tides_status td_solve_steps(tides_simulator *s, tides_error *error);

/* To be called before tiles at rest are compared over a macro step that begins at `start`. Pixels that may do something there
 * get their signals and references from look-ups, so that slow ramps meet the levels where references say (solve_rest.c). */
TIDES_MUST_CHECK tides_status td_solve_still(tides_simulator *s, const td_step *span, double start, tides_error *error);

/* Estimates at the end of a macro step the errors of its events' times, from a sample of them (solve_sample.c). */
TIDES_MUST_CHECK tides_status td_solve_measure(tides_simulator *s, tides_error *error);

/* -- parts of it ---------------------------------------------------------------------------------------------------------- */

/* The batch that is being filled; and asking in one for a pixel of a unit at a time; `looked` and `s` are given back with what
 * was found. */
static inline td_solve_batch *td_solve_asking(td_solve *solve) { return &solve->batch[solve->asking]; }
TIDES_MUST_CHECK tides_status td_solve_ask(td_solve_batch *batch, const td_tile *tile, int32_t local, double time,
                                           const td_asked *asked, tides_error *error);

/* Looking up has taken the time since `begun` [s]. */
void td_solve_note_time(tides_simulator *s, double begun);

/* Gives a batch to the renderer; its values are there when what was given last has been received. Then both at once, of what is
 * asked for: looks it all up (solve_ask.c). */
TIDES_MUST_CHECK tides_status td_solve_send(tides_simulator *s, td_solve_batch *batch, tides_error *error);
TIDES_MUST_CHECK tides_status td_solve_receive(tides_simulator *s, tides_error *error);
TIDES_MUST_CHECK tides_status td_solve_look_up(tides_simulator *s, tides_error *error);

/* The batch that is filled goes to the device; of the one that was there pixels are run, which may ask again. Whether one is
 * worth it; whether anything is asked for still, or there; and all forgotten. */
TIDES_MUST_CHECK tides_status td_solve_turn(tides_simulator *s, tides_error *error);
int td_solve_has_enough(const tides_simulator *s);
int td_solve_is_busy(const tides_simulator *s);
void td_solve_clear_batches(tides_simulator *s);

/* td_solve_doubt: errors of the references of a unit's pixels, where they aren't known (TD_TILE_PIXELS). td_solve_ask_reference
 * asks for a pixel's reference, and td_solve_refer looks up all that were asked for (solve_rest.c). */
void td_solve_doubt(const tides_simulator *s, int t, double *doubt);
TIDES_MUST_CHECK tides_status td_solve_ask_reference(const tides_simulator *s, td_solve_portion *portion, int t, int32_t local,
                                                     tides_error *error);
TIDES_MUST_CHECK tides_status td_solve_refer(tides_simulator *s, tides_error *error);

/* A swap of depth (td_renderer_swaps) in a step: where its middle is, how far from there it begins and ends, in steps, and what
 * it moves Y by. */
typedef struct td_swap_place {
    double s, wide, light;
} td_swap_place;

/* Swaps that a pixel of the step's unit may see, within a step's length of it: (count), in order of time. td_solve_swap_place:
 * a swap's place in the step (swap_cuts.c). */
const td_swap *td_solve_swaps(const tides_simulator *s, const td_refine_step *step, int32_t local, int *count);
td_swap_place td_solve_swap_place(const tides_simulator *s, const td_refine_step *step, const td_swap *swap);

/* The share of a swap that a cubic through both its ends doesn't show, `wide` cubics' lengths to either side of its middle. All
 * of a short one; of a long one what a kink of the curvature leaves, by the square of how fast the depths pass. */
static inline double td_solve_swap_unseen(double wide) {
    const double left = 0.3 / (wide * wide);
    return left < 1 ? left : 1;
}

/* How far swaps that don't show in a step's samples may move a pixel's log_luminance between these: all together, where it is S
 * or more at both ends. */
double td_solve_swapped(const tides_simulator *s, const td_refine_step *step, int32_t local, double S);

/* td_solve_sample offers a settled event to the measurement, and sets its `order`. td_solve_cut keeps the events to be
 * measured, TD_CHOSEN_MOST at most (chosen.c). */
enum { TD_CHOSEN_MOST = 256 };
TIDES_MUST_CHECK tides_status td_solve_sample(const tides_simulator *s, td_solve_portion *portion, const td_sampled *one,
                                              tides_error *error);

void td_solve_cut(const tides_simulator *s, td_solve_portion *portion);

/* Joins a portion's sampled events to the run's. */
TIDES_MUST_CHECK tides_status td_solve_join_samples(tides_simulator *s, const td_solve_portion *portion, tides_error *error);

/* Runs a pixel on from where it is settled to the first step in which something is to be looked up, and asks for that; an ideal
 * one to the last step. Its steps are of this list (solve_run.c). */
TIDES_MUST_CHECK tides_status td_solve_run(tides_simulator *s, struct td_portion *portion, td_looked *looked, td_solving *pixel,
                                           tides_error *error);

/* Trust in the models of pixels [first, first + count) of a unit, on a step of h seconds, before anything is looked up: (count)
 * (solve_nodes.c). */
void td_solve_first_trust(const tides_simulator *s, const td_refine_step *refined, double h, int32_t first, int32_t count,
                          td_trust *trust);

/* The model of a pixel in a step, and its errors (solve_nodes.c). */
typedef struct td_trusted {
    td_pieces pieces; /* with the leak's ramp */
    td_trust trust[TD_PIECES_MAX];
    double start, end; /* what the signal at the step's ends is off by beyond */
    double floor;      /* what any number that is looked up is off by */
} td_trusted;

/* The model's error at u of piece k, without the floor. */
double td_trusted_error(const td_trusted *model, int k, double u);

/* The model's error at u of piece k that counts where a level is near, without that of the step's ends. */
double td_trusted_doubt(const td_trusted *model, int k, double u);

/* The pixel's nodes, and the trust of each piece; how many nodes. */
int td_solve_nodes(const td_solve *solve, const td_looked *looked, td_node *nodes, td_trust *trust);

/* A value that was looked up at s becomes a node, this one of solve->found; where a node is there already, nothing. */
void td_solve_insert(td_solve *solve, td_looked *looked, int32_t number, double s, const td_point_value *value);

/* The light that compositing leaves out of samples, and not of points in double: image.smoothing.stop_change. */
#define TD_SOLVE_SAMPLES 1e-5

/* Nodes are further apart than this, in steps: far below a nanosecond, and far enough for slopes from their difference. */
#define TD_SOLVE_APART 1e-8

#endif
