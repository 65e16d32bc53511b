/* Internal: motion models. A tides_motion is what a method trained, as named arrays and settings, so that one reader and one
 * writer (scene_hdf5) serve all models; its class turns that into the numbers that kernels/motion_NAME.h reads.
 *
 * Time: each model has its own time tau in [start, stop] (frames, [0, 1], seconds); the scene maps seconds to it
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

/* Setting of motions whose method doesn't clamp colour at 0 (SpacetimeGaussians, Dynamic3DGaussians). */
#define TD_PLAIN_COLOUR "plain_colour"

/* A HexPlane's grids have four dimensions; no model comes near so many arrays or settings. */
enum { TD_FIELD_RANK_MAX = 4, TD_FIELDS_MAX = 128, TD_SETTINGS_MAX = 48 };

/* A named array of a model; float32 as trained, finite. */
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

/* A motion's numbers for the backends, made once per renderer. */
typedef struct td_mover_numbers {
    double real[TD_MOVER_REALS];
    int own[TD_MOVER_INTS];
    int moves_sh;
    double *data; /* owned (td_mover_release); narrowed to float on a device */
    size_t data_count;
    char defines[256]; /* "#define TD_BUILD_WIDTH 64\n": sizes that the model's kernel is compiled with; may be "" */
} td_mover_numbers;

/* Rows that are asked for: Gaussians index[0 .. count) at own time tau. */
typedef struct td_motion_asked {
    double tau, tau_dot; /* tau_dot: d(tau)/dt [1/s] */
    int side;            /* of a knot at tau: 1 what begins there, -1 what ends */
    int fades;           /* as td_mover has it */
    const int32_t *index;
    int64_t count;
} td_motion_asked;

/* The place of those rows. SH only where the model moves it: else both may be NULL. */
typedef struct td_motion_sink {
    double *geometry, *rates; /* (count x TD_GEOMETRY_STRIDE) */
    double *sh, *sh_rates;    /* (count x sh_stride), 3 k + channel */
    int sh_stride;
} td_motion_sink;

typedef struct td_motion_class {
    const char *name; /* in files and facts: "polynomial" */
    int code;         /* TD_MOTION_... */
    int expensive;    /* 1: rows cost several times what interpolating between others does (measured by bench_motion) */

    /* Whether fields and settings are there, of the right shapes, for `gaussians` (canonical, raw). */
    tides_status (*check)(const tides_motion *motion, const tides_gaussians *gaussians, tides_error *error);

    /* The numbers for kernels; `image_fades` is td_mover.fades. */
    tides_status (*pack)(const tides_motion *motion, const tides_gaussians *gaussians, td_mover_numbers *numbers,
                         tides_error *error);

    /* Fills real[TD_MOMENT_OWN ..] at own time tau; `side` -1 asks for the rates of what ends at tau, +1 of what begins there.
     * May be NULL. */
    void (*moment)(const tides_motion *motion, double tau, int side, double real[TD_MOMENT_REALS]);

    /* Own times strictly within (start, stop) where rates may jump, ascending; returns how many there are, writes at most
     * `capacity`. NULL: the motion is smooth. */
    size_t (*knots)(const tides_motion *motion, double *tau, size_t capacity);

    /* Own times strictly within (from, to), ascending, where the curves that Gaussians follow are joined: rates go on, but not
     * as the same polynomial. How many there are; writes at most `capacity`. NULL: nowhere, or at the knots. */
    size_t (*joints)(const tides_motion *motion, double from, double to, double *tau, size_t capacity);

    /* Own time over which values and rates at the start, the middle and the end show what happens to all Gaussians between
     * `from` and `to`; INFINITY: they do anyway. NULL: that of the knots. */
    double (*scale)(const tides_motion *motion, double from, double to);

    /* The scales of single Gaussians (gaussians->count); where there is a `scale` too, asked for when that is shorter than an
     * interval. NULL: there's none but that of all. */
    void (*scales)(const tides_motion *motion, const tides_gaussians *gaussians, td_time_scale *scales);

    /* rests[i] = 1 where Gaussian i (gaussians->count) is known to do nothing on its shortest scale between `from` and `to`.
     * NULL: nothing is known. TIDES_NO_MEMORY. */
    tides_status (*find_resting)(const tides_motion *motion, const tides_gaussians *gaussians, double from, double to,
                                 uint8_t *rests, tides_error *error);

    /* moving[i] = 0 where Gaussian i is the same at all times. NULL: all move. */
    void (*find_moving)(const tides_motion *motion, const tides_gaussians *gaussians, uint8_t *moving);

    /* TD_MOTION_HOST only: the rows that are asked for; rates per unit of tau. */
    tides_status (*evaluate)(const tides_motion *motion, const tides_gaussians *gaussians, const td_motion_asked *asked,
                             const td_motion_sink *to, tides_error *error);

    /* Frees `own`; NULL where there is none. */
    void (*release)(tides_motion *motion);
} td_motion_class;

struct tides_motion {
    const td_motion_class *type;
    double start, stop; /* own time */
    td_field field[TD_FIELDS_MAX];
    int fields;
    td_setting setting[TD_SETTINGS_MAX];
    int settings;
    void *own; /* the class's */
};

/* -- motion.c -- */

/* An empty motion of a class over own time [start, stop], start < stop. */
tides_status td_motion_create(const td_motion_class *type, double start, double stop, tides_motion **motion,
                              tides_error *error);

/* Adds a field of `rank` 1..4, taking over `value` (malloc'd, product of shape floats) also on failure. Values that aren't
 * finite: TIDES_BAD_FILE naming the field. */
tides_status td_motion_take_field(tides_motion *motion, const char *name, int rank, const uint64_t *shape, float *value,
                                  tides_error *error);
tides_status td_motion_set(tides_motion *motion, const char *name, double value, tides_error *error);

/* NULL, or `fallback`, where there is none. */
const td_field *td_motion_field(const tides_motion *motion, const char *name);
double td_motion_setting(const tides_motion *motion, const char *name, double fallback);

/* The field, of exactly this shape (0 in `shape` fits any extent); TIDES_BAD_FILE naming it otherwise. */
tides_status td_motion_need_field(const tides_motion *motion, const char *name, int rank, const uint64_t *shape,
                                  const td_field **field, tides_error *error);

/* The moment at own time tau, with d(tau)/dt. Reals beyond single precision's: moment[1] holds what is missing from
 * (float)tau, also for the reference. */
void td_motion_moment(const tides_motion *motion, double tau, double tau_dot, int side, double real[TD_MOMENT_REALS]);

void td_mover_release(td_mover_numbers *numbers);

/* Own time of scene second `time` where [start, stop] lasts duration_s seconds: exact at both ends, and a nanosecond (or the
 * rounding of times so late) beyond them is the end. TIDES_OUT_OF_RANGE naming scene.duration_s further out. */
tides_status td_motion_time(const tides_motion *motion, double duration_s, double time, double *tau, double *tau_dot,
                            tides_error *error);

/* moving[i] = 0 where Gaussian i is the same at all times. */
void td_motion_find_moving(const tides_motion *motion, const tides_gaussians *gaussians, uint8_t *moving);

/* -- rows.c -- */

/* The rows in double, rates per second. `numbers` from the class's pack. */
tides_status td_motion_rows(const tides_motion *motion, const tides_gaussians *gaussians, const td_mover_numbers *numbers,
                            const td_motion_asked *asked, const td_motion_sink *to, tides_error *error);

/* The class of a name from a file, or NULL (classes.c: one line per model). */
const td_motion_class *td_motion_class_find(const char *name);

#endif
