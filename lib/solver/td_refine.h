/* Internal: adaptive steps. Within a macro step each tile has its own list of steps, made by halving those whose estimated
 * error is too large. A job is (tile, time); the jobs of one refinement level go to the device in one launch. */
#ifndef TD_REFINE_H
#define TD_REFINE_H

#include "render/td_render.h"
#include "tides/simulate.h"

/* One step of one tile: [from, to] in units of the macro step / 2^depth. `next` continues the tile's list in time. */
typedef struct td_refine_step {
    uint32_t from, to;
    int32_t begin, end; /* samples at both ends */
    int32_t next;       /* index, or -1 */
    int32_t tile;
    double excess; /* how far above its limit the step's worst measure is: halved above 1 */
    double error;  /* estimated error of S [thresholds]; 0 where it isn't asked for */
} td_refine_step;

/* Planes of a sample: S and S_dot, and where the sensor or the readout asks for them the diagnostics. */
enum { TD_KEPT_S, TD_KEPT_S_DOT, TD_KEPT_ALPHA, TD_KEPT_ALPHA_DOT, TD_KEPT_CONTRIBUTORS, TD_KEPT_ALL, TD_KEPT_SIGNAL = 2 };

/* Workspace of a macro step, reused from one to the next. */
typedef struct td_refine {
    int depth; /* halvings at most */
    td_refine_step *step;
    size_t steps, step_capacity;
    int planes_kept; /* of a sample, TD_KEPT_SIGNAL or TD_KEPT_ALL */
    double *samples; /* (sample x planes_kept x TD_TILE_PIXELS), row by row */
    size_t sample_count, sample_capacity;
    double *risk; /* (sample): the tile's risk score there */
    size_t risk_capacity;
    int32_t *pending; /* steps to be halved on this level */
    size_t pending_count, pending_capacity;
    int32_t *halved; /* steps that came of it */
    size_t halved_capacity;
    int32_t *level_tile; /* what the level renders: tiles, */
    size_t level_tile_capacity;
    double *level_time; /* and times */
    size_t level_time_capacity;
    double *times; /* the distinct ones of these */
    size_t time_capacity;
    td_request *requests;
    size_t request_capacity;
    double *planes;
    size_t plane_capacity;
} td_refine;

/* S of a sample, then the other planes. */
static inline double *td_refine_sample(const td_refine *refine, int32_t sample) {
    return refine->samples + (size_t)sample * (size_t)refine->planes_kept * TD_TILE_PIXELS;
}

/* Renders and accepts steps for the macro step that begins at s->now: its steps are the lists that begin at refine->step[tile].
 * Nothing of the simulator's pixel state changes. */
tides_status td_refine_macro_step(tides_simulator *s, double start, double stop, tides_error *error);

/* Time of position `at` in the macro step: exact at both ends, the same double wherever it is asked for. */
double td_refine_time(const td_refine *refine, double start, double stop, uint32_t at);

void td_refine_release(td_refine *refine);

/* Which of the `count` new steps `fresh` are too long: refine->pending (control.c). */
tides_status td_control_steps(tides_simulator *s, const int32_t *fresh, size_t count, double start, double stop,
                              tides_error *error);

#endif
