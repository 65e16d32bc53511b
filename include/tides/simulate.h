/* The simulator: from a scene and a camera path to a sorted stream of events. */
#ifndef TIDES_SIMULATE_H
#define TIDES_SIMULATE_H

#include "tides/events.h"
#include "tides/readout.h"
#include "tides/filters.h"
#include "tides/render.h"
#include "tides/sensor.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How S is modelled between two renders (paper Eq. 12; DESIGN 3.2). */
enum {
    TIDES_MODEL_LINEAR = 0,    /* S0 + S0_dot d */
    TIDES_MODEL_QUADRATIC = 1, /* through S0, S0_dot, S1 */
    TIDES_MODEL_HERMITE = 2,   /* the cubic through S0, S0_dot, S1, S1_dot */
    TIDES_MODEL_SECANT = 3     /* S0 to S1 in a straight line: what ESIM assumes */
};

/* How steps are chosen. FIXED: every step_s. The others cut each macro step of step_s, tile by tile. ERROR: each in which
 * something moves once, to compare its model with a render inside it, and further until what such probes saw bounds the
 * model's error within the tolerance wherever a pixel may reach a threshold (lib/solver/td_probe.h). RISK: until it is as
 * short as the paper's risk score asks for (Eq. 13; lib/solver/steps/control.c has the norms and kappa). FIXED and RISK look
 * inside no step, and miss what its ends don't show. */
enum { TIDES_STEPPING_FIXED = 0, TIDES_STEPPING_RISK = 1, TIDES_STEPPING_ERROR = 2 };

/* Where the slopes of S come from. DIFFERENCE is what a renderer without derivatives would have to do, to measure what they are
 * worth: at each step's end the slope of the straight line from its start (at the run's start, to the first end). It takes no
 * more renders, and fixed steps. */
enum { TIDES_SLOPE_EXACT = 0, TIDES_SLOPE_DIFFERENCE = 1 };

/* Where events come from: from the local model between two renders, or from the image itself, which is looked up where events
 * are, pixel by pixel, until no time is off by more than time_tolerance_s (10 ns where that is 0), or than rounding. DOUBLE
 * works single pixels out in double precision whatever the device computes in (motion models in its own). Steps then only have
 * to find the crossings. With ERROR or RISK, and where neither a PSF, a filter, a surround nor additive noise comes between
 * image and comparator, nor rules or a decoder make the image jump; else TIDES_UNSUPPORTED, and says why. AUTO is DOUBLE where
 * it can be had, else OFF: tides_stats.solve says which, and `unsolved` why. That rests on the run alone: a device without
 * double precision has DOUBLE worked out in C, to the same bits, on one processor. */
enum { TIDES_SOLVE_OFF = 0, TIDES_SOLVE_DOUBLE = 1, TIDES_SOLVE_AUTO = 2 };

/* Why a run's events are not looked up: they are; OFF was asked for; steps are fixed; the model isn't HERMITE; a PSF, a filter,
 * a surround or additive noise stands between image and comparator; the rules let splats end abruptly, or a decoder makes the
 * colours. */
enum {
    TIDES_UNSOLVED_NOT = 0,
    TIDES_UNSOLVED_ASKED = 1,
    TIDES_UNSOLVED_FIXED = 2,
    TIDES_UNSOLVED_MODEL = 3,
    TIDES_UNSOLVED_SENSOR = 4,
    TIDES_UNSOLVED_IMAGE = 5
};

/* The unit that has steps of its own under RISK and ERROR, with `local`: a 16x16 tile, or a 4x4 block of pixels. With blocks,
 * only those in which something asks for a sample are composited. AUTO: blocks where events are looked up, because looks make
 * up for what smaller units see less of; else tiles. */
enum { TIDES_UNIT_TILE = 0, TIDES_UNIT_BLOCK = 1, TIDES_UNIT_AUTO = 2 };

/* Weights of the risk score: coverage, contributors, |alpha_dot|. */
typedef struct tides_risk {
    double w_b, w_c, w_alpha; /* [1] >= 0 */
} tides_risk;

/* Step control; fill with tides_stepping_defaults (error, hermite, local, 10 ms, 1 us, 0, 0, 0.3 0.3 0.4, exact, 0, 256,
 * auto, auto). */
typedef struct tides_stepping {
    uint32_t size;
    int32_t mode;               /* TIDES_STEPPING_* */
    int32_t model;              /* TIDES_MODEL_* */
    int32_t local;              /* 1: each `unit` goes its own way: none where nothing moves, steps of its own where they are
                                chosen; 0: whole frames, the same steps for all */
    double step_s;              /* [s] > 0: the step, or the longest; the last is shortened to end at `stop` */
    double min_step_s;          /* [s] > 0: steps that are no longer than this aren't cut */
    double tolerance;           /* ERROR: estimated error of S, in units of the smaller threshold. 0: 0.1 where events are
                                   looked up and steps only have to find them, 0.01 where the model says when they are */
    double time_tolerance_s;    /* ERROR: estimated error of event times [s]; 0: not asked for */
    tides_risk risk;            /* RISK */
    int32_t slope;              /* TIDES_SLOPE_* */
    int32_t interpolate_motion; /* 1: between the start, middle and end of a macro step expensive motion models (networks,
                                   callbacks) are interpolated, Gaussian by Gaussian where that is estimated to stay within
                                   both tolerances (0.01 where `tolerance` is 0: looking up sees the same motion). FIXED: has
                                   no effect, each step is worked out */
    double memory_mb; /* [1e6 bytes] >= 1: what the samples of a macro step and their launches may take: tiles are taken so
                         many at a time. Where tiles share their steps, a few samples of each moving tile, if
                         that is more; looking up single pixels has a room of its own, 512 at most. Changes the order of
                         the work, no event */
    int32_t solve;    /* TIDES_SOLVE_* */
    int32_t unit;     /* TIDES_UNIT_* */
} tides_stepping;
TIDES_API void tides_stepping_defaults(tides_stepping *stepping);

/* Counts of a run. Field for field what --stats writes (DESIGN 6); tides_stats_table lists them. */
typedef struct tides_stats {
    tides_render_stats render;              /* of its renderer */
    uint64_t events, events_on, events_off; /* that pixels fired */
    uint64_t events_truncated;              /* crossings beyond max_events_per_step in a step, moved to the step's end */
    uint64_t events_caught_up; /* crossings that the local model missed or put out of range, fired at the step's end */
    uint64_t events_by_cause[TIDES_CAUSES]; /* of `events`, by TIDES_CAUSE_* */
    uint64_t events_written;                /* given to the sink: without a readout `events`, with one fewer */
    uint64_t events_dropped;                /* by the readout, by chance or because a queue was full; */
    uint64_t events_overflowed;             /* of these, the latter */
    uint64_t events_delayed;                /* left the readout later than they fired */
    uint64_t events_suppressed; /* by sensor.b_min: crossings put off to where their pixel became visible, noise events lost */
    uint64_t events_refractory; /* crossings consumed and noise events lost in refractory periods */
    uint64_t steps;             /* (tile or block, step) pairs that went to the comparator */
    uint64_t steps_rejected;    /* cut in two: such pairs that were too coarse, or to be looked into */
    uint64_t steps_at_minimum;  /* accepted above the tolerance because they were as short as min_step_s */
    double worst_delay_s;       /* in the readout, jitter aside [s] */
    double worst_error; /* largest estimate among accepted steps [thresholds]; 0 under fixed steps, which estimate none */
    /* Estimated timing error that so many percent of the events stay below [s]; likewise 0 under fixed steps. An event's error
     * is that which probes saw there, and rounding, by the slope and the curvature of the signal where it fired. Under RISK
     * alone, where nothing was cut, it comes from the ends of steps, which may show nothing. */
    double error_p50_s, error_p95_s, error_p99_s; /* as above [s] */
    double worst_residual;                /* max over pixels at the end of (S - S_ref) / threshold; below 1 by construction */
    uint64_t tile_steps_still;            /* (tile, step) pairs in which nothing moved: neither rendered nor compared */
    double renders_full_frame_equivalent; /* 4x4 blocks composited, over those of all tiles */
    double simulated_s, run_time_s, real_time_factor; /* simulated / run time */
    double time_compare_s, time_sink_s, time_other_s; /* wall time of the comparator, the sink, the rest [s] */
    uint64_t peak_memory_bytes;                       /* of the process */
    /* The part of `steps` that rests on a probe: an evaluation inside a step that they are a part of, compared with its model
     * in value and rate. Under error control that is all of them, but where min_step_s leaves macro steps whole. */
    uint64_t steps_probed;
    /* Accepted although above the tolerance, because what a probe saw is no more than rounding of S in single precision:
     * shorter steps would see as much. */
    uint64_t steps_at_rounding;
    /* Events that the signal's estimated error may undo, and places where it may make some: it turns, or the run ends, so near
     * a level that the error decides whether it is reached. A tile counts too, once a macro step, where more pairs of splats may
     * swap in depth than are searched. Not for FIXED. */
    uint64_t events_uncertain;
    double worst_deviation;    /* the largest that a probe saw where a step rests on it [thresholds] */
    uint64_t events_solved;    /* of `events`, those whose times were looked up in the image (stepping.solve), and */
    uint64_t points_looked_up; /* pixels at single times that were looked up for them */
    double time_look_up_s;     /* waiting for that */
    uint64_t solve;            /* TIDES_SOLVE_* that the run has: AUTO is OFF or DOUBLE; */
    uint64_t unsolved;         /* TIDES_UNSOLVED_*: why it is OFF */
    uint64_t unit;             /* TIDES_UNIT_* that the run has: TILE or BLOCK */
    double tolerance;          /* that the run has [thresholds] */
    uint64_t events_filtered[TIDES_STAGES]; /* dropped behind the readout, by TIDES_STAGE_* */
    /* Processor time of the calling thread while no other worked beside it on the host: what more threads leave as it is.
     * Waiting for a device takes none, but where its driver spins [s]. */
    double time_alone_s;
} tides_stats;

enum { TIDES_STAT_COUNT = 0 /* uint64_t */, TIDES_STAT_REAL = 1 /* double */, TIDES_STAT_WHOLE = 2 /* int32_t */ };

/* How those of two parts of a run make one of the whole: worked out from others and the state, by their sum, or the larger
 * one. */
enum { TIDES_JOIN_DERIVED = 0, TIDES_JOIN_SUM = 1, TIDES_JOIN_LARGEST = 2 };

/* One row of the table of statistics, from which --stats and checkpoints are made: a field of tides_stats. Rows "time_s.NAME"
 * are parts of run_time_s and add up to it; "settings.NAME" are what the run has where the stepping left it open. */
typedef struct tides_stat {
    const char *name; /* "events_on" */
    const char *unit; /* "s", or "" */
    int32_t type;     /* TIDES_STAT_* */
    int32_t joined;   /* TIDES_JOIN_* */
    size_t offset;    /* in tides_stats */
} tides_stat;

/* The table; static storage, `count` (nullable) receives its length. */
TIDES_API const tides_stat *tides_stats_table(size_t *count);

/* A row's field as a number, whatever its type; counts above 2^53 are rounded. Neither may be NULL. */
TIDES_API double tides_stat_value(const tides_stats *stats, const tides_stat *row);

/* Receives events in order; `count` may be 0. Non-zero stops the run: TIDES_CANCELLED, or the status it stored itself. */
typedef int (*tides_event_sink)(void *user, const tides_event *events, size_t count);

/* A simulation between two of its times. Opaque. */
typedef struct tides_simulator tides_simulator;

/* A simulator on its own renderer. `device`, `scene` and `camera` must outlive it. Pixel state starts at `start` [s]: each
 * reference is the signal there. The camera's path (and every object's) must cover [start, stop]: TIDES_OUT_OF_RANGE; one that
 * is told as it goes (tides_trajectory_create_open) must begin by then, and is asked for more when the run comes to it. Both
 * are absolute times, as the paths', within +-9.2e9 s; within the run everything counts from `start`, so that steps of a
 * microsecond at 2e9 s are as exact as at 0, and a path moved in time gives the same events, moved. */
TIDES_MUST_CHECK TIDES_API tides_status tides_simulator_create(
    tides_device *device, const tides_scene *scene, const tides_trajectory *camera, const tides_intrinsics *intrinsics,
    const tides_image_params *image, const tides_sensor *sensor, const tides_stepping *stepping, double start, double stop,
    tides_progress progress, void *user, tides_simulator **simulator, tides_error *error);

/* Puts a readout between pixels and sink, before the run begins and before a restore; one that isn't enabled does nothing.
 * Jitter and drops draw from the sensor's seed. How active a tile is comes from the scene: lib/solver/run/readout.c. The
 * sink then receives what has left so far; the rest comes with the last packet. */
TIDES_MUST_CHECK TIDES_API tides_status tides_simulator_readout(tides_simulator *simulator, const tides_readout *readout,
                                                                tides_error *error);

/* Puts filters behind the readout, or behind the pixels where there is none, before the run begins and before a restore; where
 * none of them is on this does nothing. */
TIDES_MUST_CHECK TIDES_API tides_status tides_simulator_filters(tides_simulator *simulator, const tides_filters *filters,
                                                                tides_error *error);

/* For a sink while it is called: when its events fired [ns], in their order. NULL without a readout: when they say. */
TIDES_API const int64_t *tides_simulator_fired(const tides_simulator *simulator);

/* NULL is fine. */
TIDES_API void tides_simulator_destroy(tides_simulator *simulator);

/* Advances to `until` (at most stop), giving `sink` the events of each packet, sorted by (t, y, x, polarity). Event times are
 * absolute nanoseconds: those of `start`, rounded once to the nearest one, and whole ones since then, floored. Steps lie on
 * the grid start + k step_s whatever `until` is (a last one below 1/1024 of step_s is part of the one before), so a run cut
 * into several calls gives the same events: times between grid points end at the last grid point before them, except `stop`.
 * A time within rounding of a grid point is that point: 0.051 is the end of 51 steps of 0.001, and so is their sum; where
 * doubles as late as the run can't tell some grid points apart, it ends at the last of these. Where a path is open, and
 * not told that far: TIDES_OUT_OF_RANGE, naming it; nothing happened, and the call may be made again. */
TIDES_MUST_CHECK TIDES_API tides_status tides_simulator_run(tides_simulator *simulator, double until, tides_event_sink sink,
                                                            void *sink_user, tides_progress progress, void *user,
                                                            tides_error *error);

/* Counts of the run up to the time reached, restored parts of it included. worst_residual (0 before the first step) and
 * peak_memory_bytes are of this moment rather than of the run. Costs one pass over the pixels; call it between runs, from the
 * thread that runs, or from a sink. */
TIDES_API void tides_simulator_stats(const tides_simulator *simulator, tides_stats *stats);

/* The state of every pixel, planes (height x width), caller's memory, each nullable: the signal at the time reached as the
 * comparator sees it (with the leak's ramp, which begins at 0 at the run's start), the reference, and the counts of events
 * since the reference was last taken from the signal: at the start, at noise events and at the end of a hold. The invariant,
 * with the pixel's own thresholds and where it is neither held nor masked: -threshold_off < signal - reference < threshold_on.
 * Nothing is rendered before the first tides_simulator_run (or restore): till then signal and reference are NaN. */
TIDES_API void tides_simulator_state(const tides_simulator *simulator, double *signal, double *reference, uint32_t *count_on,
                                     uint32_t *count_off);

/* Writes the run's state to `path`, HDF5, beside and renamed (layout documented in lib/checkpoint/checkpoint.c), between two
 * calls of tides_simulator_run; a progress that stops the run makes such a place, at the end of a step or, where it stops
 * one half way, at its start. A new simulator that restores it gives the rest of the events, the same to the bit. `run`
 * (nullable) is the run file as JSON, for tides_simulator_restore to compare with. */
TIDES_MUST_CHECK TIDES_API tides_status tides_simulator_save(const tides_simulator *simulator, const char *run,
                                                             const char *path, tides_error *error);

/* Puts a new simulator, which hasn't run yet, where a saved one was: tides_simulator_run goes on from there, and the statistics
 * count both. TIDES_BAD_CONFIG naming what differs where the checkpoint is of another run: `run` (nullable) in anything but
 * time.stop, device and stepping.memory_mb, the scene, the camera, the sensor, the stepping, the start, the device's
 * precision. The stop may be another one after the time of the checkpoint, unless that was the run's end (the step before it
 * will do: tides_recording.keep_checkpoint). TIDES_BAD_FILE where the file is damaged. */
TIDES_MUST_CHECK TIDES_API tides_status tides_simulator_restore(tides_simulator *simulator, const char *run, const char *path,
                                                                tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
