/* Internal: adaptive steps. Within a macro step each unit has its own list of steps. It is made by cutting steps whose
 * estimated error is too large in two, and each whole macro step once, to look inside. A job is (tile, time); the jobs of one
 * refinement level go to the device in one launch.
 *
 * Memory is bounded. So many units are refined at a time as there is room for. Where the samples of a level would still be too
 * many, the earliest steps are refined first, until nothing before them is open. Those are then compared, and their samples
 * given back. The resulting steps are the same. How a step is judged depends only on its samples, those of the steps that it
 * was cut out of, and the pixels at the macro step's start. */
#ifndef TD_REFINE_H
#define TD_REFINE_H

#include "td_samples.h"
#include "signal/td_step.h"
#include "tides/simulate.h"

/* One step of one unit: [from, to] in units of the macro step / 2^depth. `next` continues the unit's list in time. */
typedef struct td_refine_step {
    uint32_t from, to;
    int32_t begin, end; /* samples at both ends */
    int32_t probe;      /* the one of these at which a longer step was cut; -1: this is a whole macro step */
    int32_t next;       /* index, or -1 */
    int32_t unit;
    uint32_t swap;    /* where a swap of depth cuts it; 0: it is cut where it is probed */
    int32_t begins;   /* 1: a swap begins at `swap`, 0: it ends there */
    int16_t cuts;     /* cuts of the macro step that led to this step */
    int16_t open;     /* it is to be cut, or not judged yet */
    double excess;    /* factor by which the step's worst measure exceeds its limit: cut above 1 */
    double error;     /* estimated error of S [thresholds]; 0 where it isn't asked for */
    double deviation; /* the largest one where it was cut out [thresholds] */
    double past[2];   /* largest deviations of the longer steps before; 0 where there were none */
    double rounded;   /* as `error`, but rounding counts as an error of the model */
} td_refine_step;

/* Work space of a macro step, reused for the next one. */
typedef struct td_refine {
    uint64_t macro;     /* number of the macro step */
    double start, stop; /* its ends [s after the epoch] */
    int depth;          /* positions are in units of the macro step / 2^depth */
    uint32_t shortest;  /* length of the shortest steps: a step twice as long may be cut */
    size_t limit;       /* samples in memory at most */
    size_t batch;       /* (tile, time) jobs per launch */
    td_refine_step *step;
    size_t steps, step_capacity;
    int32_t spare_step; /* first step that was given back, a list by `next`, or -1 */
    const int *unit;    /* units that are refined together: some of all that move */
    int units;          /* their number */
    int32_t *head;      /* (units) first step that hasn't been compared, or -1 */
    td_samples samples;
    int early;         /* 1: some steps have been compared while others are open */
    double *reference; /* where early: (pixels) references with which the units began */
    size_t reference_capacity;
    int32_t *open; /* steps to be cut */
    size_t open_count, open_capacity;
    int32_t *pending; /* those of `open` that are cut on this level */
    size_t pending_count, pending_capacity;
    int32_t *part; /* (pending_count) the second part of each */
    size_t part_capacity;
    int32_t *fresh; /* new steps, to be judged */
    size_t fresh_count, fresh_capacity;
} td_refine;

/* Begins the macro step from s->now for the units refine->unit; it has been swept. Renders its end, and where it will be cut
 * anyway, a time within. Lists the resulting steps as `fresh`, to be judged. The pixels' state doesn't change until the first
 * step is compared. */
tides_status td_refine_begin(tides_simulator *s, double start, double stop, tides_error *error);

/* Cuts the pending steps in two: renders at the cuts, and lists the parts as `fresh`. */
tides_status td_refine_level(tides_simulator *s, double start, double stop, tides_error *error);

/* Time of position `at` in the macro step. It is exact at both ends, and the same double wherever it is computed. */
static inline double td_refine_time(const td_refine *refine, double start, double stop, uint32_t at) {
    const uint32_t whole = (uint32_t)1 << refine->depth;
    return at == whole ? stop : start + (stop - start) * ((double)at / (double)whole);
}

/* A step shorter than twice the shortest isn't cut, whatever the measures say. */
static inline int td_refine_may_cut(const td_refine *refine, const td_refine_step *step) {
    return step->to - step->from >= 2 * refine->shortest;
}

/* The place nearest to a step's middle where a swap of depth begins or ends that its samples may not show, or 0. */
uint32_t td_refine_swap(const tides_simulator *s, const td_refine_step *step, int32_t *begins);

/* Sets the limits on samples and jobs from memory_mb. given.sample_planes is final then. */
void td_refine_bound(tides_simulator *s);

void td_refine_release(td_refine *refine);

/* td_control_judge: how far a step with samples exceeds its limits, and so whether it is cut. td_control_steps then makes
 * refine->pending of the judged steps of refine->fresh that are cut, and sets their `open`. */
void td_control_judge(const tides_simulator *s, td_refine_step *step, double start, double stop);
tides_status td_control_steps(tides_simulator *s, tides_error *error);

/* 1 where the run ends with this step of the macro step. */
int td_refine_ends_run(const tides_simulator *s, const td_refine_step *step);

/* The planes of a step's samples at both its ends. */
void td_refine_planes(const tides_simulator *s, const td_refine_step *refined, const double *begin[], const double *end[]);

/* How many of the moving units are refined together. A unit's steps don't depend on other units, so that a large image needs
 * the memory of a part of it. All, where the units have their steps in common. */
int td_window_units(const tides_simulator *s);

/* td_window_is_short: 1 where the samples of all open steps would need too much memory, so that accepted steps are compared
 * first. td_window_take moves the steps of the next launch from refine->open to refine->pending: all, or the earliest. */
int td_window_is_short(const tides_simulator *s);
tides_status td_window_take(tides_simulator *s, int is_short, tides_error *error);

#endif
