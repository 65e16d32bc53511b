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

/* How steps are chosen. FIXED: every step_s. The others cut each macro step of step_s, tile by tile. ERROR cuts each macro
 * step in which something moves once, and compares its model with a render inside it, a probe. It cuts further until the
 * model's error, as probes bound it, is within the tolerance wherever a pixel may reach a threshold. RISK cuts until a step
 * is as short as the paper's risk score asks (Eq. 13; lib/solver/steps/control.c has the norms and kappa). FIXED and RISK
 * look inside no step, and miss changes that its ends don't show. */
enum { TIDES_STEPPING_FIXED = 0, TIDES_STEPPING_RISK = 1, TIDES_STEPPING_ERROR = 2 };

/* Where the slopes of S come from. DIFFERENCE takes the slopes that a renderer without derivatives would have, to measure
 * the value of exact ones. At a step's end this is the slope of the straight line from the step's start; at the run's start,
 * of the line to the first end. It takes no more renders. It needs fixed steps. */
enum { TIDES_SLOPE_EXACT = 0, TIDES_SLOPE_DIFFERENCE = 1 };

/* Where events come from. OFF: from the local model between two renders. DOUBLE: from the image itself. Single pixels are
 * looked up where events are, until no time is off by more than time_tolerance_s (10 ns where that is 0), or than rounding.
 * Look-ups are in double precision on any device (motion models in the device's own). Steps then only have to find the
 * crossings. DOUBLE needs ERROR or RISK. It is TIDES_UNSUPPORTED, with the reason, if a PSF, a filter, a surround or
 * additive noise stands between image and comparator, or if rules or a decoder make the image jump. AUTO is DOUBLE if that
 * is possible, else OFF; tides_stats.solve and `unsolved` tell. The choice depends on the run alone. For a device without
 * double precision, points are computed in C, to the same bits. */
enum { TIDES_SOLVE_OFF = 0, TIDES_SOLVE_DOUBLE = 1, TIDES_SOLVE_AUTO = 2 };

/* Why a run's events are not looked up. In this order: they are looked up; OFF was asked for; steps are fixed; the model
 * isn't HERMITE; a PSF, a filter, a surround or additive noise stands between image and comparator; the rules let splats end
 * abruptly, or a decoder makes the colours. */
enum {
    TIDES_UNSOLVED_NOT = 0,
    TIDES_UNSOLVED_ASKED = 1,
    TIDES_UNSOLVED_FIXED = 2,
    TIDES_UNSOLVED_MODEL = 3,
    TIDES_UNSOLVED_SENSOR = 4,
    TIDES_UNSOLVED_IMAGE = 5
};

/* The unit that has steps of its own under RISK and ERROR, with `local`: a 16x16 tile, or a 4x4 block of pixels. With
 * blocks, only blocks in which something asks for a sample are composited. AUTO: blocks if events are looked up, since
 * look-ups make up for changes that smaller units don't see; else tiles. */
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
    int32_t local;              /* 1: each `unit` has steps of its own where they are chosen, and none where nothing moves;
                                0: whole frames, the same steps for all */
    double step_s;              /* [s] > 0: the step, or the longest; the last is shortened to end at `stop` */
    double min_step_s;          /* [s] > 0: steps that are no longer than this aren't cut */
    double tolerance;           /* ERROR: estimated error of S, in units of the smaller threshold. 0: 0.1 if events are
                                 * looked up, else 0.01 */
    double time_tolerance_s;    /* ERROR: estimated error of event times [s]; 0: not asked for */
    tides_risk risk;            /* RISK */
    int32_t slope;              /* TIDES_SLOPE_* */
    int32_t interpolate_motion; /* 1: between the start, middle and end of a macro step expensive motion models (networks,
                                   callbacks) are interpolated, Gaussian by Gaussian where that is estimated to stay within
                                   both tolerances (0.01 where `tolerance` is 0: looking up sees the same motion). FIXED: has
                                   no effect, each step is worked out */
    double memory_mb; /* [1e6 bytes] >= 1: memory for the samples of a macro step and their launches; it decides how many
                       * tiles are taken at a time. If tiles share their steps, it is at least a few samples of each moving
                       * tile. Look-ups have room of their own, at most 512. Changes the order of the work, no event */
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
    uint64_t events_written;                /* given to the sink, behind readout and filters */
    uint64_t events_dropped;                /* by the readout: by chance, or because a queue was full */
    uint64_t events_overflowed;             /* of events_dropped: because a queue was full */
    uint64_t events_delayed;                /* left the readout later than they fired */
    uint64_t events_suppressed; /* by sensor.b_min: crossings put off to where their pixel became visible, noise events lost */
    uint64_t events_refractory; /* crossings consumed and noise events lost in refractory periods */
    uint64_t steps;             /* (tile or block, step) pairs that went to the comparator */
    uint64_t steps_rejected;    /* such pairs that were cut in two: too coarse, or to be probed */
    uint64_t steps_at_minimum;  /* accepted above the tolerance because they were as short as min_step_s */
    double worst_delay_s;       /* in the readout, jitter aside [s] */
    double worst_error; /* largest estimate among accepted steps [thresholds]; 0 under fixed steps, which have no estimates */
    /* Estimated timing error that so many percent of the events stay below [s]; 0 under fixed steps. An event's error is the
     * error that probes found there, and rounding, by the signal's slope and curvature where it fired. Under RISK, if
     * nothing was cut, it comes from the ends of steps, which may show no error. */
    double error_p50_s, error_p95_s, error_p99_s; /* as above [s] */
    double worst_residual;                /* max over pixels at the end of (S - S_ref) / threshold; below 1 by construction */
    uint64_t tile_steps_still;            /* (tile, step) pairs in which nothing moved: neither rendered nor compared */
    double renders_full_frame_equivalent; /* 4x4 blocks composited, over those of all tiles */
    double simulated_s, run_time_s, real_time_factor; /* simulated / run time */
    double time_compare_s, time_sink_s, time_other_s; /* wall time of the comparator, the sink, the rest [s] */
    uint64_t peak_memory_bytes;                       /* of the process */
    /* The part of `steps` that rests on a probe: a render inside the longer step that they are cut from, compared with its
     * model in value and rate. Under error control these are all steps, except macro steps that min_step_s leaves whole. */
    uint64_t steps_probed;
    /* Steps accepted above the tolerance because the deviation at the probe is no more than rounding of S in single
     * precision: shorter steps would show as much. */
    uint64_t steps_at_rounding;
    /* Events that the signal's estimated error may undo, and places where it may make events: the signal turns, or the run
     * ends, so near a level that the error decides whether it is reached. Where events are looked up, a turn counts as two,
     * because the pixel's next event depends on it. A tile counts too, once a macro step, where more pairs of splats may swap
     * in depth than are searched. Not counted under FIXED. */
    uint64_t events_uncertain;
    double worst_deviation;                 /* largest deviation at a probe on which a step rests [thresholds] */
    uint64_t events_solved;                 /* of `events`, those whose times were looked up in the image (stepping.solve) */
    uint64_t points_looked_up;              /* pixels at single times that were looked up for them */
    double time_look_up_s;                  /* time of waiting for look-ups [s] */
    uint64_t solve;                         /* TIDES_SOLVE_* of the run: OFF or DOUBLE */
    uint64_t unsolved;                      /* TIDES_UNSOLVED_*: why `solve` is OFF */
    uint64_t unit;                          /* TIDES_UNIT_* of the run: TILE or BLOCK */
    double tolerance;                       /* the run's [thresholds] */
    uint64_t events_filtered[TIDES_STAGES]; /* dropped behind the readout, by TIDES_STAGE_* */
    /* Processor time of the calling thread while no other worked beside it on the host, and no launch on a device [s]: time
     * that more threads don't shorten. Waiting for a device takes none, unless its driver spins. */
    double time_alone_s;
} tides_stats;

enum { TIDES_STAT_COUNT = 0 /* uint64_t */, TIDES_STAT_REAL = 1 /* double */, TIDES_STAT_WHOLE = 2 /* int32_t */ };

/* How a row's values of two parts of a run make that of the whole: computed from others and the state, their sum, or the
 * larger one. */
enum { TIDES_JOIN_DERIVED = 0, TIDES_JOIN_SUM = 1, TIDES_JOIN_LARGEST = 2 };

/* One row of the table of statistics, from which --stats and checkpoints are made: a field of tides_stats. Rows
 * "time_s.NAME" are parts of run_time_s and add up to it; "settings.NAME" are the run's choices where the stepping leaves
 * them open. */
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

/* A simulator with a renderer of its own. `device`, `scene` and `camera` must outlive it. Pixel state starts at `start` [s]:
 * each reference is the signal there. The paths of the camera and every object must cover [start, stop]; else
 * TIDES_OUT_OF_RANGE. An open path (tides_trajectory_create_open) must begin by then, and needs more samples only when the
 * run comes to their times. `start` and `stop` are absolute times, like those of paths, within +-9.2e9 s. Inside the run,
 * times count from `start`: steps of a microsecond at 2e9 s are as exact as at 0, and a path moved in time gives the same
 * events, moved. */
TIDES_MUST_CHECK TIDES_API tides_status tides_simulator_create(
    tides_device *device, const tides_scene *scene, const tides_trajectory *camera, const tides_intrinsics *intrinsics,
    const tides_image_params *image, const tides_sensor *sensor, const tides_stepping *stepping, double start, double stop,
    tides_progress progress, void *user, tides_simulator **simulator, tides_error *error);

/* Puts a readout between pixels and sink, before the run begins and before a restore. A readout that isn't enabled does
 * nothing. Jitter and drops draw from the sensor's seed. A tile's activity comes from the scene, by |L_dot|, |alpha_dot| and
 * contributors. The sink then receives events that have left; the rest comes with the last packet. */
TIDES_MUST_CHECK TIDES_API tides_status tides_simulator_readout(tides_simulator *simulator, const tides_readout *readout,
                                                                tides_error *error);

/* Puts filters behind the readout, or behind the pixels if there is none, before the run begins and before a restore.
 * Filters that are all off do nothing. */
TIDES_MUST_CHECK TIDES_API tides_status tides_simulator_filters(tides_simulator *simulator, const tides_filters *filters,
                                                                tides_error *error);

/* The time [ns] at which each event of the present packet fired, in the packet's order; to be called by a sink. NULL without
 * a readout: events fired at their t. */
TIDES_API const int64_t *tides_simulator_fired(const tides_simulator *simulator);

/* NULL is fine. */
TIDES_API void tides_simulator_destroy(tides_simulator *simulator);

/* Advances to `until` (at most stop), and gives `sink` the events of each packet, sorted by (t, y, x, polarity). Event times
 * are absolute nanoseconds: `start`, rounded to the nearest one, plus whole nanoseconds since then, floored. Steps lie on
 * the grid start + k step_s whatever `until` is (a last one below 1/1024 of step_s is part of the one before). So a run cut
 * into several calls gives the same events: a call ends at the last grid point up to `until`, or at `stop`. A time within
 * rounding of a grid point is that point: 0.051 is the end of 51 steps of 0.001, and so is their sum. Where doubles as late
 * as the run can't tell some grid points apart, it ends at the last of these. TIDES_OUT_OF_RANGE: an open path, which is
 * named, ends too early; nothing happened, and the call may be repeated. */
TIDES_MUST_CHECK TIDES_API tides_status tides_simulator_run(tides_simulator *simulator, double until, tides_event_sink sink,
                                                            void *sink_user, tides_progress progress, void *user,
                                                            tides_error *error);

/* Counts of the run up to the time reached, restored parts of it included. worst_residual (0 before the first step) and
 * peak_memory_bytes are those of this moment. Costs one pass over the pixels; call it between runs, from the thread that
 * runs, or from a sink. */
TIDES_API void tides_simulator_stats(const tides_simulator *simulator, tides_stats *stats);

/* The state of every pixel as planes (height x width), caller's memory, each nullable. `signal` is the comparator's input at
 * the time reached, with the leak's ramp, which begins at 0 at the run's start. Counts of events begin when the reference
 * was last taken from the signal: at the run's start, at noise events and at the end of a hold. For pixels neither held nor
 * masked, -threshold_off < signal - reference < threshold_on, with the pixel's own thresholds. Nothing is rendered before
 * the first tides_simulator_run (or restore): until then signal and reference are NaN. */
TIDES_API void tides_simulator_state(const tides_simulator *simulator, double *signal, double *reference, uint32_t *count_on,
                                     uint32_t *count_off);

/* Writes the run's state to `path`, an HDF5 file, as a .part that is renamed (lib/checkpoint/checkpoint.c has the layout).
 * Call it between two calls of tides_simulator_run. A run that progress stopped is at the end of a step; a step that was
 * stopped half way is undone. A new simulator that restores the state gives the rest of the events, the same to the bit.
 * `run` (nullable) is the run file as JSON, for tides_simulator_restore to compare with. */
TIDES_MUST_CHECK TIDES_API tides_status tides_simulator_save(const tides_simulator *simulator, const char *run,
                                                             const char *path, tides_error *error);

/* Puts a new simulator, which hasn't run yet, into a saved state: tides_simulator_run continues from there, and the
 * statistics count both parts. TIDES_BAD_CONFIG, naming the difference: the checkpoint is of another run. This compares
 * `run` (nullable) in all but time.stop, device and stepping.memory_mb; the scene, the camera, the sensor, the stepping, the
 * start, and the device's precision. The stop may be another time after the checkpoint's, unless the checkpoint is at the
 * run's end: tides_recording.keep_checkpoint saves one a step earlier. TIDES_BAD_FILE: the file is damaged. */
TIDES_MUST_CHECK TIDES_API tides_status tides_simulator_restore(tides_simulator *simulator, const char *run, const char *path,
                                                                tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
