/* Internal: the simulator's state (create.c makes it, run.c advances it). */
#ifndef TD_SIMULATOR_H
#define TD_SIMULATOR_H

#include "render/td_render.h"
#include "sensor/td_estimate.h"
#include "td_state.h"
#include "td_grid.h"
#include "td_portion.h"
#include "td_refine.h"
#include "td_reached.h"
#include "td_readout.h"
#include "td_solve.h"
#include "td_surround_steps.h"
#include "td_timing.h"
#include "td_units.h"

enum { TD_BATCH_STEPS = 16 }; /* steps per launch at most */

/* Every pixel at one time, tile by tile, each tile's pixels row by row: TD_PLANE_*, (pixels) each; those that the run
 * doesn't ask for are NULL. */
typedef struct td_sample {
    double *plane[TD_PLANES_ALL];
} td_sample;

/* A run's progress while a step is under way (undo.c). */
typedef struct td_asking {
    tides_progress progress; /* NULL: nobody asks */
    void *user;
    int64_t launches, usual; /* of this step so far, and of the one before */
    int stopped;             /* within a step */
} td_asking;

/* The state at the beginning of a step, which is what is left of it should it be stopped. */
typedef struct td_undo {
    unsigned char *bytes; /* of each row of the table of state, one after the other */
    size_t capacity;
    tides_stats stats;       /* td_stats_take */
    td_sensor_counts counts; /* also those that are no statistics */
    td_render_counts render;
} td_undo;

/* The parameters as asked for, as far as they can be had: final when the run begins. */
typedef struct td_parameters {
    double step_s, min_step_s; /* [s] */
    double tolerance;          /* [thresholds] */
    double time_tolerance_s;
    double memory_mb;
    double interpolates; /* rows of motions within macro steps, as far as that stays within so much [thresholds]; 0: not */
    tides_risk risk;
    int mode, local, slope; /* TIDES_STEPPING_*; each unit has its own steps; TIDES_SLOPE_* */
    int unit;               /* TIDES_UNIT_* */
    int outputs;            /* planes that each sample renders: risk, a mask and the readout want diagnostics */
    int sample_planes;      /* of these, TD_PLANES_SIGNAL or TD_PLANES_ALL */
} td_parameters;

/* The image and its units (td_units.h), which the solver calls tiles. */
typedef struct td_layout {
    int width, height;
    int image_tiles; /* the renderer's */
    int tiles;
    td_tile *tile;       /* (tiles) */
    size_t *first_pixel; /* (tiles + 1): where a tile's pixels begin in all arrays of pixels */
} td_layout;

/* Tiles that can change in the interval swept last. */
typedef struct td_moving {
    int *list; /* (tiles) */
    int count;
    int tiles; /* in so many of the renderer's tiles */
} td_moving;

/* Giving events away. */
typedef struct td_packet {
    tides_event *scratch; /* for sorting */
    size_t scratch_capacity;
    tides_event last; /* that was given away, of the run's parts before too; of no polarity: there was none */
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
    tides_stepping stepping; /* as given, and what it left open as it was settled; for checkpoints */
    td_layout layout;
    double epoch;  /* [s] the run's start: every other time in the solver is an offset from it, */
    double length; /* [s] up to `length` */
    td_grid grid;  /* where steps begin and end */
    td_sensor sensor;
    td_surround_steps surround; /* between the pixels and the comparator, where the sensor has one */
    td_run_readout readout;     /* where one is attached, */
    td_run_filters filters;     /* and what stands behind it */

    int broken;          /* a step failed half way: the pixels no longer agree on the time */
    int started;         /* the first sample is there */
    int64_t step;        /* steps taken */
    td_sample now, next; /* at the step's two ends */
    double *tile_risk;   /* (tiles) at the time reached */

    td_moving moving;
    td_batch_size batch;
    td_launch launch;   /* what was rendered last */
    td_refine refine;   /* adaptive steps; */
    td_solve solve;     /* and events on the image itself */
    td_portion done;    /* what has come of the run: events that wait to be given away, and what has happened */
    td_sharing sharing; /* of work under way, on several threads */
    td_packet packet;
    td_asking asking;
    td_undo undo;
    td_totals totals;
};

/* A step is over: what was to come is now, and the sample before it is free. */
static inline void td_turn_samples(tides_simulator *simulator) {
    td_sample passed = simulator->now;
    simulator->now = simulator->next;
    simulator->next = passed;
}

/* Largest risk score of a tile's pixels, from planes of TD_OUT_DIAGNOSTICS. */
double td_tile_risk(const tides_simulator *simulator, const td_tile *tile, const double *planes);

/* The renderer's sweep of [start, stop], from the time reached on; then s->moving.list lists the tiles that can change in
 * it, and where motions have a knot at `start` their S_dot becomes that of what begins there (sweep.c). */
tides_status td_sweep(tides_simulator *simulator, double start, double stop, tides_error *error);

/* -- fixed steps (fixed.c) -- */

/* The first sample, of all tiles: every pixel's reference is the signal there. */
tides_status td_begin(tides_simulator *simulator, tides_error *error);

/* How many of the next `most` steps make the next batch; and after it, given what had been rendered before, longer batches
 * while few candidates miss their tiles, shorter ones when many do. */
int td_fixed_batch(const tides_simulator *simulator, int64_t most);
void td_fixed_adapt(tides_simulator *simulator, const tides_render_stats *before);

/* Renders the ends of the next `count` steps, which are swept; then takes step `k` of them into a sample, tiles at rest staying
 * as they are now. */
tides_status td_fixed_render(tides_simulator *simulator, int count, tides_error *error);
tides_status td_fixed_take(tides_simulator *simulator, int k, const td_sample *sample, tides_error *error);

/* TIDES_SLOPE_DIFFERENCE: replaces the slopes at the end of the step of h seconds that is about to be compared, and at the
 * run's start. */
void td_difference_slopes(tides_simulator *simulator, double h);

/* The grid of steps, for the renderer, whose epoch is the run's (leaps.c). */
tides_status td_lay_grid(tides_simulator *simulator, tides_error *error);

/* Time of grid point k [s after the epoch]; the last one is `length`. */
static inline double td_grid_time(const tides_simulator *simulator, int64_t k) { return td_grid_at(&simulator->grid, k); }

/* The absolute time reached [s], for messages. */
static inline double td_time_reached(const tides_simulator *simulator) {
    return simulator->epoch + td_grid_time(simulator, simulator->step);
}

/* The rest of TD_PLANE_* of a rendered tile into a sample of refine.c, whose planes are `apart` numbers apart. */
static inline void td_unpack_diagnostics(const td_tile *tile, const double *planes, size_t apart, double *sample) {
    static const int output[] = {TD_OUT_COVERAGE, TD_OUT_ALPHA_DOT, TD_OUT_CONTRIBUTORS};
    for (int k = 0; k < TD_PLANES_ALL - TD_PLANES_SIGNAL; k++)
        td_unpack_plane(tile, planes + output[k] * TD_TILE_PIXELS, sample + (size_t)(TD_PLANES_SIGNAL + k) * apart);
}

/* The outputs that fixed steps and the first sample render: they need no risk. */
static inline int td_fixed_outputs(const tides_simulator *simulator) {
    return simulator->given.sample_planes == TD_PLANES_ALL ? TD_OUT_DIAGNOSTICS : TD_OUT_SIGNAL;
}

/* A step of a tile between two samples of it: sample_planes pointers each; `light` as td_seen has it. The sensor over it
 * (tile_step.c). Only the tile's pixels change in the simulator. */
typedef struct td_compared {
    int tile;
    const td_step *step;
    const double *const *begin, *const *end;
    const td_signals *light;
} td_compared;
tides_status td_compare_tile(tides_simulator *simulator, td_portion *portion, const td_compared *compared, tides_error *error);

/* The sensor over one step of the tiles in which nothing moves, where it wants that. */
tides_status td_compare_still(tides_simulator *simulator, const td_step *step, tides_error *error);

/* The portion's events from number `first` on came of a tile's accepted step, so compared (tile_step.c). */
void td_time_events(const tides_simulator *simulator, td_portion *portion, const td_refine_step *refined,
                    const td_compared *compared, size_t first);

/* Compares, in time order, the accepted steps that nothing open is before. With `early` their samples are given back, and more
 * is to come; else all are accepted (settle.c). */
tides_status td_settle(tides_simulator *simulator, double start, double stop, int early, tides_error *error);

/* With a readout: the events of the step that ends at the grid point reached go through it (readout.c). */
tides_status td_readout_step(tides_simulator *simulator, tides_error *error);

/* Sends on all events that the arbiter still holds. */
tides_status td_readout_finish(tides_simulator *simulator, tides_error *error);

/* Begins and ends asking a run's progress within its steps; the launches of each step are counted from td_ask_step on. */
void td_ask_begin(tides_simulator *simulator, tides_progress progress, void *user);
void td_ask_step(tides_simulator *simulator);
void td_ask_end(tides_simulator *simulator);

/* Keeps the state at the time reached where somebody may stop the step that begins there; then, where the status says that
 * somebody did, goes back to it. */
tides_status td_undo_keep(tides_simulator *simulator, tides_error *error);
void td_undo_stopped(tides_simulator *simulator, tides_status status);

/* The value that a pixel's comparator sees at the time reached: S with its leak's ramp. */
double td_signal_now(const tides_simulator *simulator, size_t pixel);

/* Adds the arrays that a checkpoint holds; then, with these and the sensor's as they were at grid point `step`, makes the
 * simulator go on from there. `before` is what had been counted (state.c). */
void td_simulator_state(tides_simulator *simulator, td_state *state);
void td_simulator_resume(tides_simulator *simulator, int64_t step, const tides_stats *before);

/* Counts of the simulator itself, without the renderer's. td_stats_put restores them, but for the time that was spent. */
void td_stats_take(const tides_simulator *simulator, tides_stats *stats);
void td_stats_put(tides_simulator *simulator, const tides_stats *stats);

/* One of the statistics set to a number (counts and reals). */
void td_stat_set(tides_stats *stats, const tides_stat *row, double value);

/* tides_stats.worst_residual. */
double td_worst_residual(const tides_simulator *simulator);

#endif
