/* A scene: one or more sets of Gaussians, each at rest or moving as a rigid object.
 *
 * Parameters are raw, as trained: opacity is a logit, scale a logarithm, quaternions (wxyz) need not be normalised, colour
 * is spherical harmonics in INRIA's order and sign (reference: Kerbl et al. 2023; constants in kernels/sh.h). */
#ifndef TIDES_SCENE_H
#define TIDES_SCENE_H

#include "tides/motion.h"
#include "tides/trajectory.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Gaussians in objects, each with its trajectory and motion. Opaque. */
typedef struct tides_scene tides_scene;

/* The highest degree of spherical harmonics that is read and rendered. */
enum { TIDES_SH_DEGREE_MAX = 4 };

/* How Gaussians were trained, and so must be drawn: PLAIN, or with opacities compensated for the dilation (mip-splatting's
 * "antialiased"). UNKNOWN: no file says it; MIXED: objects differ. image.antialias = file in a run uses this. */
enum { TIDES_TRAINED_UNKNOWN = 0, TIDES_TRAINED_PLAIN = 1, TIDES_TRAINED_ANTIALIASED = 2, TIDES_TRAINED_MIXED = 3 };

/* Gaussians as arrays. Plain value; the arrays belong to the code that filled it. K = (sh_degree + 1)^2.
 *
 * Single precision is too coarse for means far from (0, 0, 0), as in georeferenced scans: give those in double, or relative
 * to an origin. If an object is far away compared with its size, a scene keeps its means relative to an origin near them,
 * without rounding those of single precision. tides_scene_object then returns that `origin`. Files are written with the
 * original coordinates. */
typedef struct tides_gaussians {
    int64_t count;              /* N */
    int32_t sh_degree;          /* 0..4 */
    int32_t trained;            /* TIDES_TRAINED_* */
    const float *mean;          /* [scene units]            (N x 3) */
    const float *log_scale;     /* ln [scene units]         (N x 3) */
    const float *quaternion;    /* wxyz, raw                (N x 4) */
    const float *opacity_logit; /*                          (N) */
    const float *sh;            /* coefficient, then r g b  (N x K x 3) */
    double origin[3];           /* [scene units] what means are relative to: a Gaussian is at origin + mean */
    const double *mean_double;  /* [scene units] NULL, or the means in double, in place of `mean`   (N x 3) */
    int32_t transfer;           /* TIDES_TRANSFER_LINEAR (0), _SRGB or _GAMMA: how composited colours code light */
    int32_t reserved;
    double gamma; /* with GAMMA: light = colour^gamma, 1 to 5 */
} tides_gaussians;

/* An empty scene. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_create(tides_scene **scene, tides_error *error);

/* NULL is fine. */
TIDES_API void tides_scene_destroy(tides_scene *scene);

/* Adds a copy of `gaussians`, origin included, as one object. `trajectory` (nullable: at rest) moves it: p_world = scale
 * R(t) p + position(t); it is copied too. `scale` > 0. `name` (nullable) is for people. N = 0, NaN or Inf, a zero
 * quaternion, means or colours beyond 1e18, scales beyond float's range: TIDES_BAD_ARGUMENT naming index and property.
 * `index` (nullable) receives the object's number. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_add(tides_scene *scene, const tides_gaussians *gaussians,
                                                        const tides_trajectory *trajectory, double scale, const char *name,
                                                        int32_t *index, tides_error *error);

/* Appends samples to the open path of object `index` (tides_trajectory_append), of which the scene has a copy. Simulators and
 * renderers of the scene see it at once; none may work in another thread. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_append(tides_scene *scene, int32_t index, const tides_pose_sample *samples,
                                                           size_t count, tides_error *error);

/* Adds Gaussians that move by themselves; `gaussians` are the motion's canonical ones. On success, the motion belongs to the
 * scene. Its own time, start to stop, is mapped to the scene's time from 0 to duration_s (0: stop - start seconds). The
 * trajectory and the scale then apply as to any object. TIDES_BAD_FILE: motion and Gaussians don't match. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_add_moving(tides_scene *scene, const tides_gaussians *gaussians,
                                                               tides_motion *motion, double duration_s,
                                                               const tides_trajectory *trajectory, double scale,
                                                               const char *name, int32_t *index, tides_error *error);

/* Sets the duration of all objects' motions to `duration_s` > 0. Returns their number. */
TIDES_API int32_t tides_scene_set_duration(tides_scene *scene, double duration_s);

/* Reads a file and adds what it holds: TIDES's own .h5 as all its objects, anything else as one object:
 *   .ply     3DGS by property name (any order, type and endianness, ASCII too), and PlayCanvas's compressed kind
 *   .spz     Niantic's, versions 1 to 4 (axes turned to those of a 3DGS .ply)
 *   .ksplat  mkkellogg's, all three compressions; .lcc, XGRIDS' scans with the .bin files beside it
 *   .splat   antimatter15's; .splatv, his splaTV's, whose Gaussians move
 *   .sog     PlayCanvas's versions 1 and 2; also unpacked, as a folder with a meta.json or by that file; and streamed, as a
 *            folder with a lod-meta.json or by that file: its finest level
 *   .glb     glTF with KHR_gaussian_splatting, also .gltf: what its scene shows, each node in its place, axes turned to those
 *            of a 3DGS .ply; without splats TIDES_UNSUPPORTED
 *   a folder that a trainer left: the newest point_cloud/iteration_N/point_cloud.ply in it; gsplat's ckpt_N_rank0.pt, also by
 *            itself; models that move, with their motion, those of SpacetimeGaussians, Fudan's 4d-gaussian-splatting,
 *            Dynamic3DGaussians and FreeTimeGS, and sequences gaussian_pertimestamp/time_NNNNN.ply (lib/scene/method_*.c). A
 *            model that moves in a way this version can't read: TIDES_UNSUPPORTED naming the method
 * The format is found from the content; a .splat, which has no header, from its name. Opacities of exactly 0 and 1 in the
 * packed formats become 2^-24 and 1 - 2^-24, whose logits are finite; scales of 0 float's smallest normal number. For an .h5,
 * `trajectory` (nullable) and `scale` move the whole (only where its objects are at rest); else they work as in
 * tides_scene_add. A file that lies about its size, or holds NaN: TIDES_BAD_FILE, before memory is spent on it. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_add_file(tides_scene *scene, const char *file,
                                                             const tides_trajectory *trajectory, double scale,
                                                             tides_error *error);

/* Treatment of a file's Gaussians that can't be rendered (NaN, Inf, a zero quaternion ...). ERROR: the file is refused.
 * DROP: they are left out, and tides_scene_notes says so; but a file with a motion is refused. */
enum { TIDES_INVALID_ERROR = 0, TIDES_INVALID_DROP = 1 };

/* How files are read. Fill with tides_scene_options_defaults: ERROR, no part. */
typedef struct tides_scene_options {
    uint32_t size;
    /* The part to read of a file that has several: a glTF's scene or an .h5's object by name or number, a streamed SOG's level
     * of detail (0: the finest), a trained model's iteration. NULL: the glTF's default scene, all objects, the finest level,
     * the newest iteration; tides_scene_notes lists the other parts. Where a file has no parts, or not this one:
     * TIDES_BAD_ARGUMENT. */
    const char *part;
    int32_t invalid; /* TIDES_INVALID_* */
    int32_t reserved;
} tides_scene_options;
TIDES_API void tides_scene_options_defaults(tides_scene_options *options);

/* Adds a file like tides_scene_add_file, with `options` (nullable: the defaults). */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_read(tides_scene *scene, const char *file,
                                                         const tides_scene_options *options, const tides_trajectory *trajectory,
                                                         double scale, tides_error *error);

/* How many Gaussians of the scene's files were left out (TIDES_INVALID_DROP). */
TIDES_API int64_t tides_scene_dropped(const tides_scene *scene);

/* A format of scene files, or of folders in their place. */
typedef struct tides_scene_format {
    const char *endings; /* or names of files in a folder, separated by blanks; static */
    const char *summary; /* a few words; static */
    int32_t writes;      /* 1: the library writes it */
    int32_t losses;      /* TIDES_LOSES_*: what a file of this format can't hold */
} tides_scene_format;

/* Format number `index`, from 0. Returns 1, or 0 if there is none. Folders with trained models aren't listed. */
TIDES_API int32_t tides_scene_format_at(size_t index, tides_scene_format *format);

/* 1 if `file` looks like a scene, by its content and name. It may still be unreadable: a glTF may hold no splats, and a
 * pointer of Git LFS may stand in a scene's place. 0 also if it can't be opened. */
TIDES_API int32_t tides_scene_is_file(const char *file);

/* Writes `file`, by its ending. .h5 holds everything. These hold one object at rest (TIDES_UNSUPPORTED for more): .ply
 * (INRIA's binary layout), .spz (version 4: rounded to bytes, scales to 1/16 of their logarithm), .splat (bytes, no SH beyond
 * the constant) and .glb (floats, in glTF's axes). A .part is written, and renamed. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_save(const tides_scene *scene, const char *file, tides_error *error);

/* The properties of the scene that a file of this name can't hold: a sum of TIDES_LOSES_*. */
enum {
    TIDES_LOSES_HARMONICS = 1, /* all SH but the constant: colours don't change with the view */
    TIDES_LOSES_TRAINED = 2,   /* tides_scene_trained */
    TIDES_LOSES_UP = 4,        /* tides_scene_up */
    TIDES_LOSES_TRANSFER = 8,  /* tides_scene_transfer: a reader assumes srgb */
    TIDES_LOSES_EXPONENT = 16  /* in a format's `losses`: the exponent of GAMMA; tides_scene_losses gives TRANSFER instead */
};
TIDES_API int32_t tides_scene_losses(const tides_scene *scene, const char *file);

/* Surprising facts about the scene's files, a line each: parts that were left out, or are unknown; else "". The string is
 * valid until the scene is added to. */
TIDES_API const char *tides_scene_notes(const tides_scene *scene);

/* The number of objects; the number of all Gaussians; the largest SH degree. */
TIDES_API int32_t tides_scene_objects(const tides_scene *scene);
TIDES_API int64_t tides_scene_count(const tides_scene *scene);
TIDES_API int32_t tides_scene_sh_degree(const tides_scene *scene);

/* One object, as views that are valid until the scene is added to or destroyed. */
typedef struct tides_object {
    tides_gaussians gaussians;          /* views of its arrays */
    const tides_trajectory *trajectory; /* NULL: at rest */
    double scale;                       /* of the object in the world [1] */
    const char *name;                   /* or "" */
    const char *source;                 /* file it came from, or "" */
    const tides_motion *motion;         /* NULL: the Gaussians don't move by themselves */
    double duration_s;                  /* [s] how long the motion lasts; 0 without one */
} tides_object;
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_object(const tides_scene *scene, int32_t index, tides_object *object,
                                                           tides_error *error);

/* Fills mean, log_scale, quaternion, opacity_logit and sh of `theta` with the N Gaussians of object `index` at `time` [s].
 * They are raw, in the object's own coordinates, before its trajectory and scale. NULL arrays are skipped, and rates aren't
 * filled. An opacity of 0, by which a motion hides a Gaussian, becomes 2^-24. TIDES_BAD_ARGUMENT: there is no such object.
 * TIDES_OUT_OF_RANGE: the motion doesn't cover the time. A callback's status is returned. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_gaussians_at(const tides_scene *scene, int32_t index, double time,
                                                                 const tides_theta *theta, tides_error *error);

/* The number of an object's Gaussians that move; -1: out of memory. _knots: the number of times at which their rates may
 * jump. */
TIDES_API int64_t tides_motion_moving(const tides_motion *motion, const tides_gaussians *gaussians);
TIDES_API uint64_t tides_motion_knots(const tides_motion *motion);

/* The axis-aligned box of the means at the start (static paths: in place). For objects with a motion, these are the means
 * that the motion starts from: a network's canonical ones, the first keyframe, a polynomial's at each Gaussian's own centre
 * in time. No motion is evaluated, since that may take seconds, and places of invisible Gaussians don't matter. So the box
 * tells where the scene is, but not all that it ever reaches. */
TIDES_API void tides_scene_bounds(const tides_scene *scene, double lower[3], double upper[3]);

/* The times that all objects cover [s]: -INFINITY and INFINITY if all are at rest; start > stop if there are none. */
TIDES_API void tides_scene_range(const tides_scene *scene, double *start, double *stop);

/* The axis-aligned box of the means at `time` [s]. All motions are evaluated, which takes seconds for a network's.
 * TIDES_OUT_OF_RANGE: a motion doesn't cover the time. A callback's status is returned. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_bounds_at(const tides_scene *scene, double time, double lower[3],
                                                              double upper[3], tides_error *error);

/* How all objects were trained that say so: TIDES_TRAINED_*. Files say it in .h5; in a .ply's comments "SplatRenderMode: mip"
 * or "default" (Brush, splat-transform), "antialiased 1" or "0" (Postshot), or its filter_3D (mip-splatting); a .spz's flag 1;
 * a SOG's "model"; "antialiased" in the cfg.yml of gsplat's checkpoints. tides_scene_save keeps it in .h5, .ply and .spz. */
TIDES_API int32_t tides_scene_trained(const tides_scene *scene);

/* How the colours of all objects code light: TIDES_TRANSFER_*, and the exponent of GAMMA. TIDES_BAD_CONFIG, naming two
 * objects: they differ, and an image can only be decoded in one way. An empty scene is LINEAR. It is in a .ply's comment
 * "ColourTransfer: linear" ("srgb", "gamma 2.2"), an .h5's attribute colour_transfer, and a glTF's colorSpace;
 * tides_scene_save writes these. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_transfer(const tides_scene *scene, int32_t *transfer, double *gamma,
                                                             tides_error *error);

/* The direction of up in the scene, of any length. It comes from the first file at rest that gives it (.h5; a .ply's comments
 * "up x y z", Brush's "Vertical axis: x y z", and nerfstudio's "Vertical Axis: z"), from tides_generate, or was set. Returns
 * 1, or 0 and zeros if unknown. tides_scene_save writes it to .h5 and .ply. Setting zeros or NULL means unknown. */
TIDES_API int32_t tides_scene_up(const tides_scene *scene, double up[3]);
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_set_up(tides_scene *scene, const double up[3], tides_error *error);

/* An orbit for a scene without a camera path, for tides_trajectory_create_orbit. An object is seen whole from every side, as
 * large as fits into `field_of_view` [rad], the image's narrower one. In a capture with surroundings, the camera circles the
 * median of the Gaussians, at the median distance from it. A turn takes 12 s, from 0 to 12 s. `up` NULL: tides_scene_up's,
 * else guessed: -y, as trainers on photographs have it, or z if the scene lies flat across it. TIDES_BAD_ARGUMENT: an empty
 * scene. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_orbit(const tides_scene *scene, const double up[3], double field_of_view,
                                                          tides_orbit *orbit, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
