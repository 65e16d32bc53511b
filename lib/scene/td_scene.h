/* Internal: the object store behind tides_scene, and what its readers and writers share. */
#ifndef TD_SCENE_H
#define TD_SCENE_H

#include "tides/scene.h"

#include <float.h>
#include <math.h>

/* Gaussians whose arrays we own: the writable twin of tides_gaussians, with the same shapes and units. */
typedef struct td_gaussians {
    int64_t count;
    int32_t sh_degree;
    float *mean, *log_scale, *quaternion, *opacity_logit, *sh;
    double origin[3];    /* [scene units] what means are relative to */
    double *mean_double; /* NULL, or means as a reader found them, more exact than `mean`: until td_scene_take */
    double up[3];        /* what their file says of where up is; zeros: nothing */
    int32_t trained;     /* TIDES_TRAINED_*, as it says */
    int32_t transfer;    /* TIDES_TRANSFER_LINEAR and on; of a file that doesn't say it, what td_scene_take makes of that */
    int32_t says_transfer;
    double gamma; /* with GAMMA */
    char *notes;  /* NULL, or lines that the scene's user should hear of their file */
} td_gaussians;

typedef struct td_object {
    td_gaussians gaussians;
    tides_trajectory *trajectory; /* NULL: at rest */
    double scale;
    char *name, *source;
    tides_motion *motion; /* NULL: none; owned */
    double duration_s;
    tides_trajectory *told; /* NULL, or an open path in the place of `trajectory` */
    int32_t is_lent;        /* 1: all but `told` is another scene's */
} td_object;

struct tides_scene {
    td_object *objects;
    size_t count, capacity;
    double up[3]; /* zeros: not given */
    char *notes;  /* NULL, or lines with "\n" between them */
    int64_t dropped;
    int32_t
        drop; /* 1 while a file is read whose bad Gaussians are left out, -1: of which none can be: a motion has their rows */
    const char *part; /* NULL, or while a file is read which part of it */
};

/* Means, in the world, and coefficients of colour reach no further. In single precision squares of distances are formed of
 * the first, sums of 25 products with rates of the last: 3 (1e18)^2 is a hundredth of its range, and the sums leave rates
 * of 1e18 per second. */
#define TD_VALUE_MOST 1e18

/* In single precision; infinite beyond its range, where a cast would be undefined. */
static inline float td_narrow(double value) { return value > FLT_MAX ? INFINITY : value < -FLT_MAX ? -INFINITY : (float)value; }

/* K: coefficients per channel of a degree. */
static inline size_t td_sh_coefficients(int32_t degree) { return (size_t)(degree + 1) * (size_t)(degree + 1); }

/* The constant SH coefficient of a colour, and back: colour = 1/2 + C0 dc (splat_values.c). */
float td_splat_dc(double colour);
double td_splat_colour(double dc);

/* -- gaussians.c -- */

/* Zeroed arrays for `count` >= 1 Gaussians of a degree in 0..4. */
tides_status td_gaussians_create(td_gaussians *gaussians, int64_t count, int32_t sh_degree, tides_error *error);
tides_status td_gaussians_copy(td_gaussians *gaussians, const tides_gaussians *source, tides_error *error);
void td_gaussians_free(td_gaussians *gaussians); /* leaves an empty one: may be called twice */
tides_gaussians td_gaussians_view(const td_gaussians *gaussians);

/* How two sets together were trained: what one of them says, MIXED where they disagree. */
int32_t td_trained_join(int32_t a, int32_t b);

/* Records the transfer that a file gives. */
static inline void td_gaussians_tag(td_gaussians *gaussians, int32_t transfer, double gamma) {
    gaussians->transfer = transfer;
    gaussians->gamma = transfer == TIDES_TRANSFER_GAMMA ? gamma : 0;
    gaussians->says_transfer = 1;
}

/* As files and messages say it: "linear", "srgb", "gamma 2.2"; and back: TIDES_BAD_FILE, whose message begins with `where`. */
enum { TD_TRANSFER_TEXT = 40 };
void td_transfer_say(int32_t transfer, double gamma, char text[TD_TRANSFER_TEXT]);
tides_status td_transfer_read(const char *where, const char *text, td_gaussians *gaussians, tides_error *error);

/* TIDES_BAD_ARGUMENT where it is none, or its exponent is out of range; `what` stands before "transfer" and "gamma". */
tides_status td_transfer_check(const char *what, int32_t transfer, double gamma, tides_error *error);

/* Fails with `blame` (TIDES_BAD_ARGUMENT, TIDES_BAD_FILE), naming Gaussian and property, unless the values can be rendered:
 * all finite, quaternions that can be normalised, exp(log_scale) within float's range, means and coefficients within
 * TD_VALUE_MOST; in place, that is times `scale`. */
tides_status td_gaussians_check(const td_gaussians *gaussians, double scale, tides_status blame, tides_error *error);

/* Leaves out what td_gaussians_check would refuse; how many that were. At least one is left: else as td_gaussians_check. */
tides_status td_gaussians_drop(td_gaussians *gaussians, double scale, int64_t *dropped, tides_error *error);

/* Row `from` takes the place of row `to`. */
void td_gaussians_move(const td_gaussians *g, size_t to, size_t from);

/* -- origin.c: means far from (0, 0, 0) -- */

/* Coordinate `axis` of Gaussian i in the object, origin included. */
double td_gaussians_mean(const td_gaussians *gaussians, int64_t i, int axis);

/* Makes mean_double, from the means as they are. */
tides_status td_gaussians_widen(td_gaussians *gaussians, tides_error *error);

/* Mean of Gaussian i, as a reader finds it. */
static inline void td_gaussians_put_mean(const td_gaussians *gaussians, size_t i, size_t axis, double value) {
    gaussians->mean[3 * i + axis] = td_narrow(value);
    if (gaussians->mean_double) gaussians->mean_double[3 * i + axis] = value;
}

/* Means to single precision, relative to an origin near them where they are far off. And back to the origin (0, 0, 0). */
tides_status td_gaussians_recentre(td_gaussians *gaussians, tides_error *error);
void td_gaussians_leave_origin(td_gaussians *gaussians);

/* 1 where single precision holds every coordinate, origin included. */
int td_gaussians_fit_float(const td_gaussians *gaussians);

/* Makes an object's pose that of means relative to `origin`: p_world = scale R (origin + p) + position. 0: nothing to do. */
int td_pose_add_origin(tides_pose *pose, double scale, const double origin[3]);

/* -- gaussians_place.c -- */

/* Moves Gaussians by p -> A p + t, `map` being A | t row by row: A a rotation after factors > 0 along its axes. Means, shapes,
 * and the directions that colours are seen from. TIDES_NO_MEMORY. */
tides_status td_gaussians_place(td_gaussians *gaussians, const double map[12], tides_error *error);

/* `count` >= 1 sets, one after the other, as one of the highest SH degree among them. On success they are left empty. */
tides_status td_gaussians_join(td_gaussians *parts, size_t count, td_gaussians *joined, tides_error *error);

/* -- mip_filter.c -- */

/* Folds the smoothing filter that mip-splatting trains beside its Gaussians, one size [scene units] each, into their scale
 * and opacity (mip_filter.c). */
void td_gaussians_fold_filter(td_gaussians *gaussians, const float *filter);

/* -- scene.c -- */

/* Appends an object, taking over the arrays of `gaussians` (left empty on success, untouched on failure); trajectory and
 * texts are copied. `name` may be NULL; so may `source`: then the arrays are a caller's, and bad values TIDES_BAD_ARGUMENT,
 * where otherwise they are TIDES_BAD_FILE. */
tides_status td_scene_take(tides_scene *scene, td_gaussians *gaussians, const tides_trajectory *trajectory, double scale,
                           const char *name, const char *source, int32_t *index, tides_error *error);

/* Gives the last object added a motion, taken over on success; duration_s 0 is that of its own clock (scene_motion.c). */
tides_status td_scene_give_motion(tides_scene *scene, tides_motion *motion, double duration_s, tides_error *error);

/* td_scene_take and td_scene_give_motion of what a file holds, named in errors: both are taken over, on failure freed. */
tides_status td_scene_take_moving(tides_scene *scene, td_gaussians *gaussians, tides_motion *motion,
                                  const tides_trajectory *trajectory, double scale, const char *name, const char *source,
                                  tides_error *error);

/* Drops the objects from number `count` on: undoes a half-done addition. */
void td_scene_truncate(tides_scene *scene, size_t count);

/* TIDES_BAD_ARGUMENT where the scene has no such object. */
tides_status td_scene_check_index(const tides_scene *scene, int32_t index, tides_error *error);

/* -- scene_told.c: objects that are told where they are as a run goes -- */

/* A scene of the same objects, which stay those of `scene`: that must outlive it, and not be added to. */
tides_status td_scene_lend(const tides_scene *scene, tides_scene **lent, tides_error *error);

/* Gives object `index` of such a scene an open path that begins as `first`. */
tides_status td_scene_tell(tides_scene *lent, int32_t index, const tides_pose_sample *first, tides_error *error);

/* The open path of an object, NULL where it has none. */
tides_trajectory *td_scene_told(const tides_scene *scene, int32_t index);

/* -- moment.c -- */

/* Row i of an object's Gaussians where its motion has them: TD_GEOMETRY_STRIDE numbers; SH, 3 k + channel, or NULL: its own. */
typedef void td_row_visitor(void *user, int64_t i, const double *geometry, const double *sh);

/* All rows of an object that has a motion, at `time` [s]. Fails as the motion's clock, or a callback, fails. */
tides_status td_moving_rows(const td_object *object, double time, td_row_visitor *visit, void *user, tides_error *error);

/* -- readers and writers: ply_reader.c, ply_writer.c, scene_hdf5.c, scene_hdf5_write.c -- */

/* From memory; `path` is only for messages. TIDES_BAD_FILE, TIDES_UNSUPPORTED, TIDES_NO_MEMORY. */
tides_status td_ply_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error);
/* As td_ply_parse, but a Gaussian that our parameters can't express becomes NaN, for td_gaussians_drop to leave out. */
tides_status td_ply_parse_leniently(const char *path, const void *data, size_t size, td_gaussians *gaussians,
                                    tides_error *error);

/* A format whose files are parsed from memory, or which reads what it needs, perhaps a part; NULLs: td_scene_hdf5_read. */
typedef struct td_scene_reader {
    tides_status (*parse)(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error);
    tides_status (*read)(const char *path, td_gaussians *gaussians, tides_error *error);
    tides_status (*choose)(const char *path, const char *part, td_gaussians *gaussians, tides_error *error);
    tides_status (*moving)(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_motion **motion,
                           tides_error *error); /* parsed with their motion */
} td_scene_reader;

/* Reads a file as one object, and a .ply so; a NULL `name` is the file's (scene_read.c). */
tides_status td_scene_read_one(tides_scene *scene, const char *file, td_scene_reader with, const char *name,
                               const tides_trajectory *trajectory, double scale, tides_error *error);
tides_status td_scene_add_ply(tides_scene *scene, const char *file, const char *name, const tides_trajectory *trajectory,
                              double scale, tides_error *error);

/* `scale` multiplies means and scales on their way out. */
tides_status td_ply_write(const char *path, const td_gaussians *gaussians, double scale, tides_error *error);

tides_status td_scene_hdf5_read(tides_scene *scene, const char *path, const tides_trajectory *trajectory, double scale,
                                tides_error *error);
tides_status td_scene_hdf5_write(const tides_scene *scene, const char *path, tides_error *error);

#endif
