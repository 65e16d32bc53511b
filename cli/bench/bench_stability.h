/* `tides bench stability`: adversarial worlds, each rendered and simulated on the device, in the float reference and in the
 * double reference, in a process of its own. */
#ifndef CLI_BENCH_STABILITY_H
#define CLI_BENCH_STABILITY_H

#include "bench.h"

/* -- rows (bench_stability_rows.c) ------------------------------------------------------------------------------------ */

/* World of a row: a scene, a camera, and the stepping. */
typedef struct stability_world {
    bench_scene scene;
    tides_stepping stepping;
} stability_world;

typedef struct stability_case stability_case;
typedef tides_status (*stability_maker)(const stability_case *c, stability_world *w, tides_error *error);

enum {
    STABILITY_BIG = 1,        /* not with --quick, unless named */
    STABILITY_IMAGE_ONLY = 2, /* the references only render it; they simulate too slowly */
    STABILITY_ALONE = 4       /* without the references */
};

struct stability_case {
    const char *name, *sentence;
    stability_maker make;
    int32_t kind;        /* number of the world within its group */
    double size;         /* how extreme it is */
    const char *refusal; /* the row must be refused with a message that contains this */
    int32_t flags;
    int32_t parts; /* parts of exact events (BENCH_SOLVED ..) that the row has; 0: the library's defaults */
    struct {
        double L, L_dot, dt_us, mismatch_percent, slow, memory; /* 0: the default */
        const char *because;
    } bound; /* bounds of the row's own */
};

extern const stability_case *const stability_groups[]; /* NULL-terminated lists, each ends with a NULL name */

/* The case called `name`, or NULL. _names: all names, NULL-terminated, allocated. */
const stability_case *stability_find(const char *name);
const char *const *stability_names(void);

/* -- worlds (bench_stability_world.c) --------------------------------------------------------------------------------- */

/* Numbers of rows have few digits or come from a counter, and scales and opacities are powers of ten, so that scenes are equal
 * on every machine. */
double stability_random(uint64_t *state); /* in [0, 1), a multiple of 2^-32 */
double stability_between(uint64_t *state, double low, double high);

#define STABILITY_LN10 2.302585092994045684
#define STABILITY_SH0 0.28209479177387814 /* of the constant band: a colour is 1/2 + SH0 sh */

typedef struct stability_splat {
    double mean[3];
    double decades[3]; /* log10 of the scales */
    double quaternion[4];
    double logit;
    double sh; /* constant band, grey */
} stability_splat;

/* Splats as they are added; a failure is reported by stability_put. */
typedef struct stability_pile {
    float *log_scale, *quaternion, *logit, *sh;
    double *mean;
    size_t count, capacity;
    int32_t failed, reserved;
} stability_pile;
void stability_add(stability_pile *pile, const stability_splat *splat);
/* The arrays, borrowed. */
tides_gaussians stability_gaussians(const stability_pile *pile);
void stability_free(stability_pile *pile);
/* Adds the pile to the world, moved by `path` (nullable), and frees it. */
tides_status stability_put(stability_pile *pile, stability_world *w, const tides_trajectory *path, tides_error *error);

/* An ordinary splat in the view of a camera at the origin, 4 to 6 scene units away. */
stability_splat stability_ordinary(uint64_t *state);
void stability_backdrop(stability_pile *pile, size_t count); /* adds so many splats, always the same */
/* Adds a grid of `across` x `down` splats at depth z over the whole view. Each is `wide` spacings wide, with a random grey. */
void stability_wall(stability_pile *pile, const stability_world *w, int32_t across, int32_t down, double z, double wide);

/* A steady path over the world's time, and a little beyond: from `from` [scene units] with `velocity` [scene units/s], turning
 * about y by 2 atan(turn t). */
typedef struct stability_slide {
    double from[3], velocity[3], turn;
} stability_slide;
tides_status stability_path(const stability_world *w, const stability_slide *slide, tides_trajectory **path,
                            tides_error *error);
#define STABILITY_SPEED 8.0 /* [scene units/s] of the camera unless a row says otherwise: 100 px/s at the backdrop */

/* _make: the row's world. _benign: an ordinary one with as many pixels, splats and steps. */
tides_status stability_make(const stability_case *c, stability_world *w, tides_error *error);
tides_status stability_make_benign(const stability_world *like, stability_world *w, tides_error *error);

/* -- makers: kinds in the order of the rows' tables ------------------------------------------------------------------- */

/* bench_stability_shapes.c */
enum {
    SHAPE_NEEDLES,
    SHAPE_PANCAKES,
    SHAPE_SMALL,
    SHAPE_LARGE,
    SHAPE_SINGULAR,
    SHAPE_NEAR,
    SHAPE_CROSSING,
    SHAPE_CLAMP,
    SHAPE_OPACITY,
    SHAPE_QUATERNION,
    SHAPE_SH,
    SHAPE_SH_BANDS,
    SHAPE_RADIANCE
};
tides_status stability_shapes(const stability_case *c, stability_world *w, tides_error *error);

/* bench_stability_layers.c */
enum {
    LAYERS_APART,
    LAYERS_AT_ONE_DEPTH,
    LAYERS_SWAP,
    LAYERS_INTERSECT,
    LAYERS_TURNING,
    LAYERS_SPINNING,
    LAYERS_SURFACE,
    LAYERS_RULES
};
tides_status stability_layers(const stability_case *c, stability_world *w, tides_error *error);

/* bench_stability_places.c */
enum { PLACE_MEANS, PLACE_OBJECT, PLACE_EPOCH, PLACE_SPEED, PLACE_VIBRATION, PLACE_JUMP, PLACE_CLOSE_SAMPLES };
tides_status stability_places(const stability_case *c, stability_world *w, tides_error *error);

/* bench_stability_motions.c */
enum { MOTION_FLIPS, MOTION_CLOSE_KEYS, MOTION_DECODER, MOTION_NETWORK };
tides_status stability_motions(const stability_case *c, stability_world *w, tides_error *error);

/* bench_stability_limits.c */
enum {
    LIMIT_THRESHOLD,
    LIMIT_CAPPED,
    LIMIT_EVENTS,
    LIMIT_SENSOR_1X1,
    LIMIT_SENSOR_7X3,
    LIMIT_SENSOR_SQUARE,
    LIMIT_GAUSSIANS,
    LIMIT_TOLERANCE,
    LIMIT_BACKGROUND,
    LIMIT_LOG_EPS
};
tides_status stability_limits(const stability_case *c, stability_world *w, tides_error *error);
enum { FRONT_PHOTORECEPTOR, FRONT_INTENSITY, FRONT_CIRCUIT, FRONT_SOURCE_FOLLOWER, FRONT_SURROUND, FRONT_NOISE, FRONT_PSF };
tides_status stability_front_ends(const stability_case *c, stability_world *w, tides_error *error);

/* -- measuring (bench_stability_run.c, in a process of bench_child.c) ------------------------------------------------- */

/* Sent through a pipe, so that it has no pointers. */
typedef struct stability_result {
    int32_t how; /* BENCH_RAN .. BENCH_LATE */
    int32_t signal;
    int32_t same_bits;           /* device against float reference: 1, 0, or -1 where it isn't compared */
    int32_t rendered, simulated; /* 1: by the double reference too */
    int64_t gaussians, pixels;
    char said[sizeof((tides_error *)0)->text]; /* the message of a refusal */
    double L, L_dot;                      /* errors of the float image against the double one; L_dot over the largest rate */
    tides_match match;                    /* of the device's events against the double reference's */
    tides_stats stats, exact;             /* of the device's run, and of the double reference's */
    double run_time_s, benign_s, exact_s; /* least of some runs; of processor time where the device is a processor */
    double elapsed_s;
    uint64_t peak_bytes; /* of the process when the device's run ended */
} stability_result;

/* Measures a case on the device that `b` names (b->device isn't open). */
void stability_measure(const bench *b, const stability_case *c, stability_result *result);

/* -- verdicts (bench_stability_verdict.c) ------------------------------------------------------------------------------ */

enum { VERDICT_L, VERDICT_L_DOT, VERDICT_DT, VERDICT_MISMATCH, VERDICT_CUT, VERDICT_SLOW, VERDICT_MEMORY, VERDICTS };
typedef struct stability_verdict {
    double measured[VERDICTS], bound[VERDICTS]; /* NaN: not measured */
    int32_t pass, reserved;
    char why[512]; /* why it fails, or a remark on a pass; "" for neither */
} stability_verdict;
/* Names and units of the judged values, and a sentence with the default bounds and their reasons. */
typedef struct stability_measured {
    const char *name, *unit, *bound;
} stability_measured;
extern const stability_measured stability_measures[VERDICTS];
stability_verdict stability_judge(const stability_case *c, const stability_result *r);

/* bench_stability_figure.c: stability.png. */
typedef struct stability_row {
    const stability_case *of;
    stability_result result;
    stability_verdict verdict;
} stability_row;
tides_status stability_figure(const bench *b, const stability_row *rows, size_t count, tides_error *error);

#endif
