/* Internal: the simulator's state; create.c makes it, run.c advances it. */
#ifndef TD_SIMULATOR_H
#define TD_SIMULATOR_H

#include "render/td_render.h"
#include "sensor/td_estimate.h"
#include "td_state.h"
#include "td_grid.h"
#include "td_portion.h"
#include "td_refine.h"
#include "td_saved_run.h"
#include "td_reached.h"
#include "td_readout.h"
#include "td_solve.h"
#include "td_surround_steps.h"
#include "td_timing.h"
#include "td_units.h"

enum { TD_BATCH_STEPS = 16 }; /* steps per launch at most */

/* Every pixel at one time, unit by unit, each unit's pixels row by row: TD_PLANE_*, (pixels) each. Planes that the run doesn't
 * need are NULL. */
typedef struct td_sample {
    double *plane[TD_PLANES_ALL];
} td_sample;

/* A run's progress while a step is under way. */
typedef struct td_run_progress {
    tides_progress call; /* NULL: nobody asks */
    void *user;
    int64_t launches, usual; /* launches of this step so far, and of the step before */
    int stopped;             /* 1: stopped within a step */
} td_run_progress;

/* The state at the beginning of a step, which is restored if the step is stopped. */
typedef struct td_undo {
    unsigned char *bytes; /* each row of the table of state, one after the other */
    size_t capacity;
    tides_stats stats;       /* td_stats_take */
    td_sensor_counts counts; /* with those that aren't statistics */
    td_render_counts render;
} td_undo;

/* The parameters as asked for, where they can be had. They are final when the run begins. */
typedef struct td_parameters {
    double step_s, min_step_s; /* [s] */
    double tolerance;          /* [thresholds] */
    double time_tolerance_s;
    double memory_mb;
    double interpolates; /* moving Gaussians' rows are interpolated up to this error [thresholds]; 0: not */
    tides_risk risk;
    int mode, local, slope; /* TIDES_STEPPING_*; each unit has its own steps; TIDES_SLOPE_* */
    int coupled;            /* a pixel's signal depends on all others': run/surround_steps.c compares them together */
    int unit;               /* TIDES_UNIT_* */
    int outputs;            /* planes that each sample renders; risk, a mask and the readout need diagnostics */
    int sample_planes;      /* of these, those that are kept: TD_PLANES_SIGNAL or TD_PLANES_ALL */
} td_parameters;

/* The image and its units. */
typedef struct td_layout {
    int width, height;
    int image_tiles; /* tiles of the renderer */
    int units;
    td_tile *unit;       /* (units) the pixels of each */
    size_t *first_pixel; /* (units + 1): where a unit's pixels begin in arrays of pixels */
} td_layout;

/* Units that can change in the interval swept last. */
typedef struct td_moving {
    int *list; /* (units) */
    int count;
    int tiles; /* number of the renderer's tiles with them */
} td_moving;

/* The packet that goes to the sink. */
typedef struct td_packet {
    tides_event *scratch; /* for sorting */
    size_t scratch_capacity;
    tides_event last; /* last event given to the sink, in earlier parts of the run too; polarity 0: there was none */
} td_packet;

/* Steps per launch. */
typedef struct td_batch_size {
    int steps, limit; /* now, and at most */
} td_batch_size;

/* Statistics that no portion of work collects. */
typedef struct td_totals {
    tides_stats here;   /* times and steps since the run began or was restored */
    tides_stats before; /* all counts of the parts before a restore */
} td_totals;

struct tides_simulator {
    tides_renderer *renderer;
    const tides_scene *scene; /* the caller's, as is the camera's path */
    const tides_trajectory *camera;
    td_parameters given;
    tides_stepping stepping; /* as given, with open choices as the simulator settled them; for checkpoints */
    td_layout layout;
    double epoch;  /* [s] the run's start: every other time in the solver counts from it */
    double length; /* [s] of the run */
    td_grid grid;  /* where steps begin and end */
    td_sensor sensor;
    td_surround_steps surround; /* in use where pixels are coupled */
    td_run_readout readout;     /* in use where a readout is attached */
    td_run_filters filters;     /* behind the readout or the pixels */

    int broken;          /* a step failed half way: the pixels no longer agree on the time */
    int started;         /* the first sample exists */
    int64_t step;        /* steps taken */
    td_sample now, next; /* at the step's two ends */
    double *unit_risk;   /* (units) at the time reached */

    td_moving moving;
    td_batch_size batch;
    td_launch launch;   /* what was rendered last */
    td_refine refine;   /* adaptive steps; */
    td_solve solve;     /* look-ups */
    td_portion done;    /* the run's results: events for the next packet, and counts */
    td_sharing sharing; /* work under way, on several threads */
    td_packet packet;
    td_run_progress progress;
    td_undo undo;
    td_totals totals;
};

/* Ends a step: the sample at its end becomes s->now, and the other one is free. */
static inline void td_turn_samples(tides_simulator *simulator) {
    td_sample passed = simulator->now;
    simulator->now = simulator->next;
    simulator->next = passed;
}

/* S of every pixel at the time reached, behind the surround where pixels are coupled: (pixels). */
static inline const double *td_seen_now(const tides_simulator *simulator) {
    return simulator->given.coupled ? simulator->surround.S : simulator->now.plane[TD_PLANE_S];
}

/* Largest risk score of a unit's pixels, from planes of TD_OUT_DIAGNOSTICS. */
double td_unit_risk(const tides_simulator *simulator, const td_tile *tile, const double *planes);

/* Sweeps [start, stop], from the time reached on. s->moving.list then lists the units that can change in it. Where motions have
 * a knot at `start`, S_dot becomes the rate of the motion that begins there. */
tides_status td_sweep(tides_simulator *simulator, double start, double stop, tides_error *error);

/* -- fixed steps (fixed.c) -- */

/* Takes the first sample of all units: every pixel's reference is the signal there. */
tides_status td_begin(tides_simulator *simulator, tides_error *error);

/* td_fixed_batch: how many of the next `most` steps make a batch. td_fixed_adapt sizes the next one by the last: longer while
 * few candidates miss their tiles, shorter when many do. */
int td_fixed_batch(const tides_simulator *simulator, int64_t most);
void td_fixed_adapt(tides_simulator *simulator, const tides_render_stats *before);

/* td_fixed_render renders the ends of the next `count` steps, which have been swept. td_fixed_take makes a sample of step k of
 * them; units at rest stay as they are. */
tides_status td_fixed_render(tides_simulator *simulator, int count, tides_error *error);
tides_status td_fixed_take(tides_simulator *simulator, int k, const td_sample *sample, tides_error *error);

/* Replaces slopes by differences, for TIDES_SLOPE_DIFFERENCE: at the end of the next compared step of h seconds, and at the
 * run's start. */
void td_difference_slopes(tides_simulator *simulator, double h);

/* Makes the grid of steps, with the run's start as the renderer's epoch. */
tides_status td_lay_grid(tides_simulator *simulator, tides_error *error);

/* Time of grid point k [s after the epoch]; the last one is `length`. */
static inline double td_grid_time(const tides_simulator *simulator, int64_t k) { return td_grid_at(&simulator->grid, k); }

/* The absolute time reached [s], for messages. */
static inline double td_time_reached(const tides_simulator *simulator) {
    return simulator->epoch + td_grid_time(simulator, simulator->step);
}

/* Copies the diagnostics of a rendered tile into a sample, whose planes are `apart` numbers apart. */
static inline void td_unpack_diagnostics(const td_tile *tile, const double *planes, size_t apart, double *sample) {
    static const int output[] = {TD_OUT_COVERAGE, TD_OUT_ALPHA_DOT, TD_OUT_CONTRIBUTORS};
    for (int k = 0; k < TD_PLANES_ALL - TD_PLANES_SIGNAL; k++)
        td_unpack_plane(tile, planes + output[k] * TD_TILE_PIXELS, sample + (size_t)(TD_PLANES_SIGNAL + k) * apart);
}

/* The outputs that fixed steps and the first sample render: they need no risk. */
static inline int td_fixed_outputs(const tides_simulator *simulator) {
    return simulator->given.sample_planes == TD_PLANES_ALL ? TD_OUT_DIAGNOSTICS : TD_OUT_SIGNAL;
}

/* A step of a unit between two samples of it: sample_planes pointers each; `light` is log-luminance where the planes aren't
 * (behind a surround), else NULL. The comparator changes only the unit's pixels. */
typedef struct td_compared {
    int unit;
    const td_step *step;
    const double *const *begin, *const *end;
    const td_signals *light;
} td_compared;
tides_status td_compare_unit(const tides_simulator *simulator, td_portion *portion, const td_compared *compared,
                             tides_error *error);

/* Runs the comparator over one step of the units in which nothing moves, for sensors that may fire at rest. */
tides_status td_compare_still(tides_simulator *simulator, const td_step *step, tides_error *error);

/* Adds the error estimates of the portion's events from number `first` on, which the comparator made of a unit's accepted
 * step. */
void td_time_events(const tides_simulator *simulator, td_portion *portion, const td_refine_step *refined,
                    const td_compared *compared, size_t first);

/* Compares, in order of time, the accepted steps before which none is open. With `early` more steps are to come, and the
 * samples of compared ones are given back; else all are accepted. */
tides_status td_settle(tides_simulator *simulator, double start, double stop, int early, tides_error *error);

/* With a readout: sends the events of the step that ends at the reached grid point through it. */
tides_status td_readout_step(tides_simulator *simulator, tides_error *error);

/* Sends on all events that the arbiter still holds. */
tides_status td_readout_finish(tides_simulator *simulator, tides_error *error);

/* td_progress_begin and td_progress_end frame a run whose progress is asked within steps too; td_progress_step begins to count
 * a step's launches. */
void td_progress_begin(tides_simulator *simulator, tides_progress progress, void *user);
void td_progress_step(tides_simulator *simulator);
void td_progress_end(tides_simulator *simulator);

/* td_undo_keep keeps the state at the beginning of a step that somebody may stop. td_undo_stopped goes back to it where the
 * status says so. */
tides_status td_undo_keep(tides_simulator *simulator, tides_error *error);
void td_undo_stopped(tides_simulator *simulator, tides_status status);

/* The value that a pixel's comparator sees at the time reached: S with its leak's ramp. */
double td_signal_now(const tides_simulator *simulator, size_t pixel);

/* Counts of the simulator itself, without the renderer's. td_stats_put restores them, except for the time spent. */
void td_stats_take(const tides_simulator *simulator, tides_stats *stats);
void td_stats_put(tides_simulator *simulator, const tides_stats *stats);

/* tides_stats.worst_residual. */
double td_worst_residual(const tides_simulator *simulator);

#endif
