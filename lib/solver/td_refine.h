/* Internal: adaptive steps. Within a macro step each tile has its own list of steps, made by cutting those in two whose
 * estimated error is too large, and each whole macro step once, to look inside (td_probe.h). A job is (tile, time); the jobs of
 * one refinement level go to the device in one launch.
 *
 * Memory is bounded: units are refined so many at a time as there is room for, and where the samples of a level would still be
 * too many, the earliest of its steps are refined first, until nothing before them is open; those are compared, and their
 * samples given back. The steps that come of it are the same: how a step is
 * judged depends on its samples, those of the steps that it was cut out of, and the pixels at the start of the macro step. */
#ifndef TD_REFINE_H
#define TD_REFINE_H

#include "td_samples.h"
#include "signal/td_step.h"
#include "tides/simulate.h"

/* One step of one tile: [from, to] in units of the macro step / 2^depth. `next` continues the tile's list in time. */
typedef struct td_refine_step {
    uint32_t from, to;
    int32_t begin, end; /* samples at both ends */
    int32_t probe;      /* of these, the one at which a longer step was cut; -1: this is a whole macro step */
    int32_t next;       /* index, or -1 */
    int32_t tile;
    uint32_t swap;    /* where it is cut because of a swap of depth; 0: where it is probed; */
    int32_t begins;   /* 1: which begins there, 0: or ends */
    int16_t cuts;     /* of the macro step that led here */
    int16_t open;     /* it is to be cut, or hasn't been judged */
    double excess;    /* how far above its limit the step's worst measure is: cut above 1 */
    double error;     /* estimated error of S [thresholds]; 0 where it isn't asked for */
    double deviation; /* the largest one seen where it was cut out [thresholds] */
    double past[2];   /* the same of the longer steps before, 0 where there were none */
    double rounded;   /* as `error`, but rounding counts as an error of the model */
} td_refine_step;

/* Workspace of a macro step, reused from one to the next. */
typedef struct td_refine {
    uint64_t macro;     /* number of the macro step, */
    double start, stop; /* and where it is [s after the epoch] */
    int depth;          /* positions are in units of its 2^depth'th part */
    uint32_t shortest;  /* units of the shortest steps: those of twice as many are cut */
    size_t limit;       /* samples at a time */
    size_t batch;       /* (tile, time) jobs per launch */
    td_refine_step *step;
    size_t steps, step_capacity;
    int32_t spare_step; /* given back: a list by `next`, or -1 */
    const int *unit;    /* those that are refined together, some of all that move, */
    int units;          /* so many */
    int32_t *head;      /* (tiles) first step that hasn't been compared, or -1 */
    td_samples samples;
    int early;         /* some of its steps have been compared while others are open; then */
    double *reference; /* (pixels) the references that the units which are refined began with */
    size_t reference_capacity;
    int32_t *open; /* steps to be cut */
    size_t open_count, open_capacity;
    int32_t *pending; /* of these, on this level */
    size_t pending_count, pending_capacity;
    int32_t *part; /* (pending_count) what they are cut into: the second part of each */
    size_t part_capacity;
    int32_t *fresh; /* steps that came of it */
    size_t fresh_count, fresh_capacity;
} td_refine;

/* Begins the macro step from s->now, which is swept, for the tiles refine->unit: renders its end and, where it is to be looked
 * into, a first time within, and lists the steps that come of it as `fresh`, to be judged. Until the first step is compared
 * nothing of the simulator's pixel state changes. */
tides_status td_refine_begin(tides_simulator *s, double start, double stop, tides_error *error);

/* Cuts the pending steps in two: renders where, and lists the parts as `fresh`. */
tides_status td_refine_level(tides_simulator *s, double start, double stop, tides_error *error);

/* Time of position `at` in the macro step: exact at both ends, the same double wherever it is asked for. */
static inline double td_refine_time(const td_refine *refine, double start, double stop, uint32_t at) {
    const uint32_t whole = (uint32_t)1 << refine->depth;
    return at == whole ? stop : start + (stop - start) * ((double)at / (double)whole);
}

/* A step shorter than twice the shortest isn't cut, whatever the measures say. */
static inline int td_refine_may_cut(const td_refine *refine, const td_refine_step *step) {
    return step->to - step->from >= 2 * refine->shortest;
}

/* The place nearest to a step's middle where a swap of depth begins or ends that its samples may not show, or 0
 * (swap_cuts.c). */
uint32_t td_refine_swap(const tides_simulator *s, const td_refine_step *step, int32_t *begins);

/* Bytes for the samples of a macro step, for sample_planes that are final. */
void td_refine_bound(tides_simulator *s);

void td_refine_release(td_refine *refine);

/* Judges a step whose samples are there: how far it is above its limits, and by that whether it is to be cut. Then, of all
 * steps refine->fresh, which have been judged, those that are: refine->pending, and `open` (control.c). */
void td_control_judge(tides_simulator *s, td_refine_step *step, double start, double stop);
tides_status td_control_steps(tides_simulator *s, tides_error *error);

/* Whether the run ends with this step of the macro step. */
int td_refine_ends_run(const tides_simulator *s, const td_refine_step *step);

/* The planes of a step's samples at both its ends. */
void td_refine_planes(const tides_simulator *s, const td_refine_step *refined, const double *begin[], const double *end[]);

/* How many of the moving units are refined together: nothing that decides a unit's steps is another's, so that a large image
 * needs the memory of a part of it; all, where they have their steps in common (window.c). */
int td_window_units(const tides_simulator *s);

/* 1 where the samples of all open steps would be too many: what is accepted is to be compared first. Then takes the steps of
 * the next launch from refine->open to refine->pending, all or the earliest (window.c). */
int td_window_is_short(const tides_simulator *s);
tides_status td_window_take(tides_simulator *s, int is_short, tides_error *error);

#endif
