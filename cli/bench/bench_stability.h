/* `tides bench stability`: worlds made to break the simulator. A row is one world, rendered and simulated in a process of its
 * own: on the device, in the float reference and in the double reference. */
#ifndef CLI_BENCH_STABILITY_H
#define CLI_BENCH_STABILITY_H

#include "bench.h"

/* -- rows (bench_stability_rows.c) ------------------------------------------------------------------------------------ */

/* The world of a row: a scene with its camera, and the stepping. */
typedef struct stability_world {
    bench_scene scene;
    tides_stepping stepping;
} stability_world;

typedef struct stability_case stability_case;
typedef tides_status (*stability_maker)(const stability_case *c, stability_world *w, tides_error *error);

enum {
    STABILITY_BIG = 1,        /* with --quick the row runs only if --row names it */
    STABILITY_IMAGE_ONLY = 2, /* the references render the world, but don't simulate it: they are too slow */
    STABILITY_ALONE = 4       /* the references do neither */
};

struct stability_case {
    const char *name, *sentence;
    stability_maker make;
    int32_t kind;        /* the maker's kind of world, SHAPE_NEEDLES and others */
    double size;         /* how extreme the world is; the maker gives it a meaning */
    const char *refusal; /* the row must be refused with a message that contains this text; NULL: it must run */
    int32_t flags;       /* STABILITY_BIG and others */
    int32_t parts;       /* BENCH_SOLVED and BENCH_BLOCKS, or-ed together; 0: neither */
    struct {
        double L, L_dot, dt_us, mismatch_percent, slow, memory; /* 0: the default bound */
        const char *because;                                    /* the reason of the row's own bounds */
    } bound;
};

extern const stability_case *const stability_groups[]; /* ends with a NULL; each group ends with a NULL name */

const stability_case *stability_find(const char *name); /* or NULL */
const char *const *stability_names(void);               /* of all cases; ends with a NULL */

/* -- worlds (bench_stability_world.c) --------------------------------------------------------------------------------- */

/* Worlds are equal on every machine, because no number of a splat comes from libm. Their numbers have few digits or are drawn
 * by stability_random, and scales are given by their logarithms. */
double stability_random(uint64_t *state); /* in [0, 1), a multiple of 2^-32 */
double stability_between(uint64_t *state, double low, double high);

#define STABILITY_LN10 2.302585092994045684
#define STABILITY_SH0 0.28209479177387814 /* 1 / (2 sqrt(pi)): a colour is 1/2 + SH0 sh, sh of the constant band */

typedef struct stability_splat {
    double mean[3];
    double decades[3]; /* log10 of the scales */
    double quaternion[4];
    double logit; /* of the opacity */
    double sh;    /* of the constant band, equal for r, g and b */
} stability_splat;

/* A list of splats that grows; stability_put reports a failure of stability_add. */
typedef struct stability_pile {
    float *log_scale, *quaternion, *logit, *sh;
    double *mean;
    size_t count, capacity;
    int32_t failed, reserved;
} stability_pile;
void stability_add(stability_pile *pile, const stability_splat *splat);
/* The pile's arrays, borrowed. */
tides_gaussians stability_gaussians(const stability_pile *pile);
void stability_free(stability_pile *pile);
/* Adds the pile to the world, moved by `path` (nullable), and frees it. */
tides_status stability_put(stability_pile *pile, stability_world *w, const tides_trajectory *path, tides_error *error);

/* An ordinary splat in the view of a camera at the origin, 4 to 6 scene units away. */
stability_splat stability_ordinary(uint64_t *state);
/* Adds `count` ordinary splats: the first of one list, whatever the row. */
void stability_backdrop(stability_pile *pile, size_t count);
/* Adds a grid of `across` x `down` splats at depth z over the whole view. Each is `wide` spacings wide, with a random grey. */
void stability_wall(stability_pile *pile, const stability_world *w, int32_t across, int32_t down, double z, double wide);

/* A steady path over the world's time and beyond both ends. t [s] after the start it is at from + velocity t [scene units], and
 * turned about y by 2 atan(turn t). */
typedef struct stability_slide {
    double from[3], velocity[3], turn;
} stability_slide;
tides_status stability_path(const stability_world *w, const stability_slide *slide, tides_trajectory **path,
                            tides_error *error);
#define STABILITY_SPEED 8.0 /* [scene units/s] of the camera, unless a row says otherwise: about 100 px/s at the backdrop */

/* stability_make makes the row's world. stability_make_benign makes an ordinary world with as many pixels, splats and steps as
 * `like`. */
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

/* The result goes through a pipe, so it must have no pointers. */
typedef struct stability_result {
    int32_t how;                 /* BENCH_RAN and others */
    int32_t died;                /* as that of bench_ending */
    int32_t same_bits;           /* device against float reference: 1 equal, 0 different, -1 not compared */
    int32_t rendered, simulated; /* 1: by the double reference too */
    int64_t gaussians, pixels;
    char said[sizeof((tides_error *)0)->text]; /* the message of a refusal */
    double L, L_dot;          /* largest errors of the device's image; L_dot's is over the largest rate of its frame */
    tides_match match;        /* of the device's events against the double reference's */
    tides_stats stats, exact; /* of the device's run, and of the double reference's */
    /* Time of the row's run, of the ordinary world's, and of the double reference's: the least of some runs. It is processor
     * time where the device is a processor. */
    double run_time_s, benign_s, exact_s;
    double elapsed_s;    /* of the whole measurement */
    uint64_t peak_bytes; /* of the process when the device's run ended */
} stability_result;

/* Measures a case on the device that `b` names, and opens it: b->device isn't used. */
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
