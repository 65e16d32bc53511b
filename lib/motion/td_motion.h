/* Internal: motion models. A tides_motion holds what a method trained, as named arrays and settings, so one reader and one
 * writer of scene files serve all models. Its class packs these into the numbers that the model's kernel reads.
 *
 * Each model has its own time tau in [start, stop] (frames, [0, 1], seconds), to which the scene maps seconds
 * (scene.duration_s). Compiled in double. */
#ifndef TD_MOTION_CLASS_H
#define TD_MOTION_CLASS_H

#ifndef TD_REAL_DOUBLE
#define TD_REAL_DOUBLE
#endif
#include "kernels/motion.h"
#include "motion/td_time_scale.h"
#include "td_base.h"
#include "tides/motion.h"
#include "tides/scene.h"

/* Setting of methods that don't clamp colours at 0 (SpacetimeGaussians, Dynamic3DGaussians). */
#define TD_PLAIN_COLOUR "plain_colour"

/* Limits. A HexPlane's grids have four dimensions; no model has nearly as many arrays or settings. */
enum { TD_FIELD_RANK_MAX = 4, TD_FIELDS_MAX = 128, TD_SETTINGS_MAX = 48 };

/* A named array of a model: finite float32 values, as trained. */
typedef struct td_field {
    char name[64];
    int rank;
    uint64_t shape[TD_FIELD_RANK_MAX];
    float *value; /* owned */
} td_field;

/* A named number of a model: a flag, a size, a range. */
typedef struct td_setting {
    char name[32];
    double value;
} td_setting;

/* A motion's numbers for backends, computed once per renderer. */
typedef struct td_mover_numbers {
    double real[TD_MOVER_REALS]; /* the model's own numbers, such as a frequency or a stride, where its kernel reads them */
    int own[TD_MOVER_INTS];
    int moves_sh; /* 1: the model changes SH, too */
    double *data; /* owned (td_mover_release); narrowed to float on a device */
    size_t data_count;
    char defines[256]; /* sizes for compiling the kernel, "#define TD_BUILD_WIDTH 64\n"; may be "" */
} td_mover_numbers;

/* Rows that are asked for: Gaussians index[0 .. count) at own time tau. */
typedef struct td_motion_asked {
    double tau, tau_dot; /* tau_dot: d(tau)/dt [1/s] */
    int side;            /* of a knot at tau: 1 what begins there, -1 what ends */
    int fades;           /* 1: Gaussians that appear suddenly in the model fade in, as smooth images need it */
    const int32_t *index;
    int64_t count;
} td_motion_asked;

/* Targets of rows. SH may be NULL unless the model changes them. */
typedef struct td_motion_sink {
    double *geometry, *rates; /* (count x TD_GEOMETRY_STRIDE) */
    double *sh, *sh_rates;    /* (count x sh_stride), 3 k + channel */
    int sh_stride;
} td_motion_sink;

typedef struct td_motion_class {
    const char *name; /* in files and facts, such as "polynomial" */
    int code;         /* TD_MOTION_... */
    int expensive;    /* 1: a row costs several times as much as interpolating one (measured by bench_motion) */

    /* Checks that fields and settings exist and have shapes that fit `gaussians` (canonical, raw). */
    tides_status (*check)(const tides_motion *motion, const tides_gaussians *gaussians, tides_error *error);

    /* Computes the numbers for kernels. */
    tides_status (*pack)(const tides_motion *motion, const tides_gaussians *gaussians, td_mover_numbers *numbers,
                         tides_error *error);

    /* Fills real[TD_MOMENT_OWN ..] with the numbers that the kernel needs at own time tau, for all Gaussians. At a jump of
     * rates, `side` -1 selects the rates before tau, +1 those after it. May be NULL. */
    void (*moment)(const tides_motion *motion, double tau, int side, double real[TD_MOMENT_REALS]);

    /* Lists knots: own times strictly within (start, stop) where rates may jump, ascending. Returns their number, and writes
     * at most `capacity`. NULL: the motion is smooth. */
    size_t (*knots)(const tides_motion *motion, double *tau, size_t capacity);

    /* Lists own times strictly within (from, to), ascending, where two polynomials of a Gaussian's path are joined, though
     * rates are continuous. Returns their number, and writes at most `capacity`. NULL: there are none but the knots. */
    size_t (*joints)(const tides_motion *motion, double from, double to, double *tau, size_t capacity);

    /* Scale of own time for all Gaussians between `from` and `to`: on intervals so long, values and rates at start, middle
     * and end show all that happens. INFINITY: on any interval. NULL: the scale is the distance of knots. */
    double (*scale)(const tides_motion *motion, double from, double to);

    /* The scales of single Gaussians (gaussians->count). If there is also a `scale`, this is called only when that is shorter
     * than an interval. NULL: only the common scale is known. */
    void (*scales)(const tides_motion *motion, const tides_gaussians *gaussians, td_time_scale *scales);

    /* Sets rests[i] = 1 if Gaussian i (gaussians->count) is known not to change on its shortest scale between `from` and
     * `to`. NULL: nothing is known. TIDES_NO_MEMORY. */
    tides_status (*find_resting)(const tides_motion *motion, const tides_gaussians *gaussians, double from, double to,
                                 uint8_t *rests, tides_error *error);

    /* Sets moving[i] = 0 if Gaussian i is the same at all times. NULL: all move. */
    void (*find_moving)(const tides_motion *motion, const tides_gaussians *gaussians, uint8_t *moving);

    /* For TD_MOTION_HOST only: computes the rows that are asked for, with rates per unit of tau. */
    tides_status (*evaluate)(const tides_motion *motion, const tides_gaussians *gaussians, const td_motion_asked *asked,
                             const td_motion_sink *to, tides_error *error);

    /* Frees `own`; NULL if the class has none. */
    void (*release)(tides_motion *motion);
} td_motion_class;

struct tides_motion {
    const td_motion_class *type;
    double start, stop; /* in own time */
    td_field field[TD_FIELDS_MAX];
    int fields;
    td_setting setting[TD_SETTINGS_MAX];
    int settings;
    void *own; /* data of the class */
};

/* -- motions -- */

/* Makes an empty motion of a class, over own time [start, stop], start < stop. */
tides_status td_motion_create(const td_motion_class *type, double start, double stop, tides_motion **motion,
                              tides_error *error);

/* Adds a field of rank 1 to 4. It takes over `value` (malloc'd, as many floats as the product of shape), also on failure.
 * TIDES_BAD_FILE names the field if a value isn't finite. */
tides_status td_motion_take_field(tides_motion *motion, const char *name, int rank, const uint64_t *shape, float *value,
                                  tides_error *error);
/* Adds a setting. TIDES_BAD_FILE if its name is too long, the value isn't finite, or there are too many. */
tides_status td_motion_set(tides_motion *motion, const char *name, double value, tides_error *error);

/* A field, or a setting; NULL, or `fallback`, if it doesn't exist. */
const td_field *td_motion_field(const tides_motion *motion, const char *name);
double td_motion_setting(const tides_motion *motion, const char *name, double fallback);

/* Finds a field of exactly this shape (0 in `shape` fits any extent); otherwise TIDES_BAD_FILE names it. */
tides_status td_motion_need_field(const tides_motion *motion, const char *name, int rank, const uint64_t *shape,
                                  const td_field **field, tides_error *error);

/* Computes a moment: the numbers at own time tau, with d(tau)/dt, that are common to all Gaussians. real[1] is tau -
 * (float)tau, which single precision needs; the reference uses both, too. */
void td_motion_moment(const tides_motion *motion, double tau, double tau_dot, int side, double real[TD_MOMENT_REALS]);

void td_mover_release(td_mover_numbers *numbers);

/* Own time at scene second `time`, if [start, stop] lasts duration_s seconds. Both ends are exact; up to a nanosecond (or the
 * rounding of such late times) beyond an end counts as the end. Farther out, TIDES_OUT_OF_RANGE names scene.duration_s. */
tides_status td_motion_time(const tides_motion *motion, double duration_s, double time, double *tau, double *tau_dot,
                            tides_error *error);

/* Sets moving[i] = 0 if Gaussian i is the same at all times. */
void td_motion_find_moving(const tides_motion *motion, const tides_gaussians *gaussians, uint8_t *moving);

/* -- rows -- */

/* Computes rows in double, with rates per second. `numbers` come from the class's pack. */
tides_status td_motion_rows(const tides_motion *motion, const tides_gaussians *gaussians, const td_mover_numbers *numbers,
                            const td_motion_asked *asked, const td_motion_sink *to, tides_error *error);

/* The class of this name, or NULL. */
const td_motion_class *td_motion_class_find(const char *name);

#endif
