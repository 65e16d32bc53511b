/* Internal: the objects of a scene, shared by the scene's readers and writers. */
#ifndef TD_SCENE_H
#define TD_SCENE_H

#include "tides/scene.h"

#include <float.h>
#include <math.h>

/* Gaussians whose arrays are owned here: a writable tides_gaussians, with the same shapes and units. */
typedef struct td_gaussians {
    int64_t count;
    int32_t sh_degree;
    float *mean, *log_scale, *quaternion, *opacity_logit, *sh; /* (N x 3), (N x 3), (N x 4) wxyz, (N), (N x K x 3) */
    double origin[3];                                          /* [scene units] means are relative to it */
    double *mean_double;   /* NULL, or means in double from a reader, until td_scene_take converts them */
    double up[3];          /* up direction in the file; zeros: unknown */
    int32_t trained;       /* TIDES_TRAINED_* */
    int32_t transfer;      /* TIDES_TRANSFER_*; td_scene_take sets it for a file that doesn't give it */
    int32_t says_transfer; /* 1: the file gives it */
    double gamma;          /* the exponent of TIDES_TRANSFER_GAMMA */
    char *notes;           /* NULL, or lines about the file for the user */
} td_gaussians;

typedef struct td_object {
    td_gaussians gaussians;
    tides_trajectory *trajectory; /* NULL: at rest */
    double scale;
    char *name, *source;
    tides_motion *motion; /* NULL: none; owned */
    double duration_s;
    tides_trajectory *open_path; /* NULL, or an open path that replaces `trajectory` */
    int32_t is_lent;             /* 1: all fields but `open_path` belong to another scene */
} td_object;

struct tides_scene {
    td_object *objects;
    size_t count, capacity;
    double up[3]; /* zeros: unknown */
    char *notes;  /* NULL, or lines with "\n" between them */
    int64_t dropped;
    int32_t drop; /* while a file is read: 1: bad Gaussians are left out; -1: none may be, since a motion has a row for each */
    const char *part; /* NULL, or the part of the file being read that is wanted */
};

/* Largest size of means in the world, and of colour coefficients. Single precision must hold squares of distances: 3 (1e18)^2
 * is a hundredth of its range. It must also hold sums of 25 coefficients times rates, where rates may reach 1e18 per second. */
#define TD_VALUE_MOST 1e18

/* Converts to float; infinite beyond float's range, where a cast would be undefined. */
static inline float td_narrow(double value) { return value > FLT_MAX ? INFINITY : value < -FLT_MAX ? -INFINITY : (float)value; }

/* Number of coefficients per channel for an SH degree. */
static inline size_t td_sh_coefficients(int32_t degree) { return (size_t)(degree + 1) * (size_t)(degree + 1); }

/* Converts a colour to the constant SH coefficient dc, and back: colour = 1/2 + dc / (2 sqrt(pi)). */
float td_splat_dc(double colour);
double td_splat_colour(double dc);

/* -- arrays of Gaussians -- */

/* Zeroed arrays for `count` >= 1 Gaussians, with an SH degree from 0 to 4. */
tides_status td_gaussians_create(td_gaussians *gaussians, int64_t count, int32_t sh_degree, tides_error *error);
tides_status td_gaussians_copy(td_gaussians *gaussians, const tides_gaussians *source, tides_error *error);
void td_gaussians_free(td_gaussians *gaussians); /* leaves an empty one, and may be called twice */
tides_gaussians td_gaussians_view(const td_gaussians *gaussians);

/* The training mode of two sets together: the one that is known, or MIXED if they differ. */
int32_t td_trained_join(int32_t a, int32_t b);

/* Records the transfer that a file gives. */
static inline void td_gaussians_tag(td_gaussians *gaussians, int32_t transfer, double gamma) {
    gaussians->transfer = transfer;
    gaussians->gamma = transfer == TIDES_TRANSFER_GAMMA ? gamma : 0;
    gaussians->says_transfer = 1;
}

/* Formats a transfer as in files and messages ("linear", "srgb", "gamma 2.2"), and parses it. TIDES_BAD_FILE begins with
 * `where`. */
enum { TD_TRANSFER_TEXT = 40 };
void td_transfer_say(int32_t transfer, double gamma, char text[TD_TRANSFER_TEXT]);
tides_status td_transfer_read(const char *where, const char *text, td_gaussians *gaussians, tides_error *error);

/* TIDES_BAD_ARGUMENT if the transfer is invalid or its exponent out of range; `what` precedes "transfer" or "gamma" in the
 * text. */
tides_status td_transfer_check(const char *what, int32_t transfer, double gamma, tides_error *error);

/* Fails with `blame` (TIDES_BAD_ARGUMENT, TIDES_BAD_FILE), naming Gaussian and property, unless the values can be rendered.
 * All must be finite, quaternions not zero, exp(log_scale) within float's range, and means and coefficients within
 * TD_VALUE_MOST. This holds after multiplication by `scale`. */
tides_status td_gaussians_check(const td_gaussians *gaussians, double scale, tides_status blame, tides_error *error);

/* Leaves out the Gaussians that td_gaussians_check would refuse, and counts them. If none is left, it fails like that
 * function. */
tides_status td_gaussians_drop(td_gaussians *gaussians, double scale, int64_t *dropped, tides_error *error);

/* Row `from` takes the place of row `to`. */
void td_gaussians_move(const td_gaussians *g, size_t to, size_t from);

/* -- origin.c: means far from (0, 0, 0) -- */

/* Coordinate `axis` of Gaussian i in the object, origin included. */
double td_gaussians_mean(const td_gaussians *gaussians, int64_t i, int axis);

/* Allocates mean_double, and copies the present means to it. */
tides_status td_gaussians_widen(td_gaussians *gaussians, tides_error *error);

/* Sets the mean of Gaussian i, for readers. */
static inline void td_gaussians_put_mean(const td_gaussians *gaussians, size_t i, size_t axis, double value) {
    gaussians->mean[3 * i + axis] = td_narrow(value);
    if (gaussians->mean_double) gaussians->mean_double[3 * i + axis] = value;
}

/* Converts means to single precision: relative to an origin near them, if they are far off. td_gaussians_leave_origin makes
 * them relative to (0, 0, 0) again. */
tides_status td_gaussians_recentre(td_gaussians *gaussians, tides_error *error);
void td_gaussians_leave_origin(td_gaussians *gaussians);

/* 1 if single precision holds every coordinate with the origin added. */
int td_gaussians_fit_float(const td_gaussians *gaussians);

/* Changes a pose to that for means relative to `origin`: p_world = scale R (origin + p) + position. Returns 0 if nothing
 * changes. */
int td_pose_add_origin(tides_pose *pose, double scale, const double origin[3]);

/* -- moving and joining -- */

/* Moves Gaussians by p -> A p + t; `map` is A | t row by row, and A is a rotation after factors > 0 along its axes. It
 * changes means, shapes, and the directions of SH. TIDES_NO_MEMORY. */
tides_status td_gaussians_place(td_gaussians *gaussians, const double map[12], tides_error *error);

/* Joins `count` >= 1 sets, with the highest SH degree among them. On success `parts` are left empty. */
tides_status td_gaussians_join(td_gaussians *parts, size_t count, td_gaussians *joined, tides_error *error);

/* -- mip-splatting -- */

/* Applies mip-splatting's smoothing filter, one size [scene units] per Gaussian, to scales and opacities. */
void td_gaussians_fold_filter(td_gaussians *gaussians, const float *filter);

/* -- scenes -- */

/* Appends an object. It takes over the arrays of `gaussians` (left empty on success, unchanged on failure), and copies
 * trajectory and texts. `name` may be NULL. `source` NULL: the arrays come from a caller, and bad values are
 * TIDES_BAD_ARGUMENT; otherwise TIDES_BAD_FILE. */
tides_status td_scene_take(tides_scene *scene, td_gaussians *gaussians, const tides_trajectory *trajectory, double scale,
                           const char *name, const char *source, int32_t *index, tides_error *error);

/* Gives the last object a motion, which it owns on success. duration_s 0: as long as the motion's own clock says. */
tides_status td_scene_give_motion(tides_scene *scene, tides_motion *motion, double duration_s, tides_error *error);

/* Adds Gaussians and their motion from a file, which errors name. Both are taken over, and freed on failure. */
tides_status td_scene_take_moving(tides_scene *scene, td_gaussians *gaussians, tides_motion *motion,
                                  const tides_trajectory *trajectory, double scale, const char *name, const char *source,
                                  tides_error *error);

/* Removes the objects from number `count` on, to undo a failed addition. */
void td_scene_truncate(tides_scene *scene, size_t count);

/* TIDES_BAD_ARGUMENT if the scene has no such object. */
tides_status td_scene_check_index(const tides_scene *scene, int32_t index, tides_error *error);

/* -- objects with open paths -- */

/* Makes a scene with the objects of `scene`, which must outlive it and must not get new objects. */
tides_status td_scene_lend(const tides_scene *scene, tides_scene **lent, tides_error *error);

/* Gives object `index` of such a scene an open path that begins with `first`. */
tides_status td_scene_tell(tides_scene *lent, int32_t index, const tides_pose_sample *first, tides_error *error);

/* The open path of an object; NULL: none. */
tides_trajectory *td_scene_open_path(const tides_scene *scene, int32_t index);

/* -- objects at one time -- */

/* Receives row i of an object's Gaussians, moved: TD_GEOMETRY_STRIDE numbers, and SH (3 k + channel), or NULL if SH don't
 * change. */
typedef void td_row_visitor(void *user, int64_t i, const double *geometry, const double *sh);

/* Visits all rows of an object with a motion, at `time` [s]. Fails if the time is outside the motion, or if a callback
 * fails. */
tides_status td_moving_rows(const td_object *object, double time, td_row_visitor *visit, void *user, tides_error *error);

/* -- readers and writers -- */

/* Parses from memory; `path` is for messages. TIDES_BAD_FILE, TIDES_UNSUPPORTED, TIDES_NO_MEMORY. */
tides_status td_ply_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error);
/* Like td_ply_parse, but a Gaussian that can't be represented becomes NaN, so that it can be left out later. */
tides_status td_ply_parse_leniently(const char *path, const void *data, size_t size, td_gaussians *gaussians,
                                    tides_error *error);

/* How a format is read: parsed from memory, or by a function that reads files itself, perhaps only a part. All NULL: HDF5. */
typedef struct td_scene_reader {
    tides_status (*parse)(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error);
    tides_status (*read)(const char *path, td_gaussians *gaussians, tides_error *error);
    tides_status (*choose)(const char *path, const char *part, td_gaussians *gaussians, tides_error *error);
    tides_status (*moving)(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_motion **motion,
                           tides_error *error); /* parsed with their motion */
} td_scene_reader;

/* Reads a file (td_scene_add_ply: a .ply) as one object; with `name` NULL the object has the file's name. */
tides_status td_scene_read_one(tides_scene *scene, const char *file, td_scene_reader with, const char *name,
                               const tides_trajectory *trajectory, double scale, tides_error *error);
tides_status td_scene_add_ply(tides_scene *scene, const char *file, const char *name, const tides_trajectory *trajectory,
                              double scale, tides_error *error);

/* Writes a .ply; means and scales are multiplied by `scale`. */
tides_status td_ply_write(const char *path, const td_gaussians *gaussians, double scale, tides_error *error);

tides_status td_scene_hdf5_read(tides_scene *scene, const char *path, const tides_trajectory *trajectory, double scale,
                                tides_error *error);
tides_status td_scene_hdf5_write(const tides_scene *scene, const char *path, tides_error *error);

#endif
