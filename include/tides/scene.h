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

/* How Gaussians were trained, and so must be drawn: plainly, or with opacities that are compensated for the dilation
 * (mip-splatting's "antialiased"). UNKNOWN: no file says; MIXED: parts of the scene differ. A run's image.antialias = file goes
 * by it. */
enum { TIDES_TRAINED_UNKNOWN = 0, TIDES_TRAINED_PLAIN = 1, TIDES_TRAINED_ANTIALIASED = 2, TIDES_TRAINED_MIXED = 3 };

/* Gaussians as arrays. Plain value; the arrays belong to the code that filled it. K = (sh_degree + 1)^2.
 *
 * Single precision has no room for means far from (0, 0, 0), as georeferenced scans have them. Give those in double, or
 * relative to an origin. A scene keeps the means of an object that is far away, compared with the spread of its Gaussians,
 * relative to an origin near them. Means of single precision aren't rounded by this. `origin` of the Gaussians given back
 * (tides_scene_object) isn't 0 then. Files are written with the coordinates that they had. */
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
    int32_t transfer;           /* TIDES_TRANSFER_LINEAR (0), _SRGB or _GAMMA: what composited colours are of light */
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

/* Where object `index` is next: tides_trajectory_append to the scene's copy of an open path (tides_trajectory_create_open) that
 * it was added with. Simulators and renderers of the scene see it at once; none may be at work in another thread. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_append(tides_scene *scene, int32_t index, const tides_pose_sample *samples,
                                                           size_t count, tides_error *error);

/* Adds Gaussians that move by themselves, `gaussians` being the motion's canonical ones. The motion is taken over on success.
 * Its own time, start to stop, runs from second 0 of the scene to duration_s (0: stop - start seconds). The moved Gaussians are
 * then moved by the trajectory and scaled like any object. TIDES_BAD_FILE where motion and Gaussians don't belong together. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_add_moving(tides_scene *scene, const tides_gaussians *gaussians,
                                                               tides_motion *motion, double duration_s,
                                                               const tides_trajectory *trajectory, double scale,
                                                               const char *name, int32_t *index, tides_error *error);

/* Makes the motions of all objects last `duration_s` > 0. Returns how many there are. */
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

/* Treatment of a file's Gaussians that can't be rendered (NaN, Inf, a zero quaternion ...). ERROR: the file is refused. DROP:
 * they are left out, and tides_scene_notes says so; the file is still refused where a motion moves them. */
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

/* tides_scene_add_file as `options` (nullable: its defaults) say. */
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
    int32_t losses;      /* TIDES_LOSES_* (below) of a file of it */
} tides_scene_format;

/* Format number `index` from 0 on; 1, or 0 behind the last. Models that trainers left in folders aren't among them. */
TIDES_API int32_t tides_scene_format_at(size_t index, tides_scene_format *format);

/* 1 where tides_scene_add_file would take `file` for a scene, by the same signs; whether it can be read is another matter: a
 * glTF may hold no splats, and a pointer of Git LFS stand in a scene's place, which that says. 0 also where it can't be
 * opened. */
TIDES_API int32_t tides_scene_is_file(const char *file);

/* Writes `file`, by its ending: .h5 holds everything (layout documented in lib/scene/scene_hdf5.c); .ply (INRIA's binary
 * layout), .spz (version 4: rounded to bytes, scales to 1/16 of their logarithm), .splat (to bytes, without SH beyond the
 * constant) and .glb (floats, in glTF's axes) hold one object at rest (TIDES_UNSUPPORTED for more). Written beside and
 * renamed. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_save(const tides_scene *scene, const char *file, tides_error *error);

/* The properties of the scene that a file of that name can't hold: a sum of TIDES_LOSES_*. */
enum {
    TIDES_LOSES_HARMONICS = 1, /* all SH but the constant: colours don't change with the view */
    TIDES_LOSES_TRAINED = 2,   /* tides_scene_trained */
    TIDES_LOSES_UP = 4,        /* tides_scene_up */
    TIDES_LOSES_TRANSFER = 8,  /* tides_scene_transfer: it is taken for srgb when it is read */
    TIDES_LOSES_EXPONENT = 16  /* of a format: that of a gamma alone; tides_scene_losses has TRANSFER then */
};
TIDES_API int32_t tides_scene_losses(const tides_scene *scene, const char *file);

/* Notes on the scene's files that may surprise a user, a line each: parts left out of a file, or unknown; "" where there are
 * none. The string belongs to the scene and is valid until the scene is added to. */
TIDES_API const char *tides_scene_notes(const tides_scene *scene);

/* Number of objects; all Gaussians; the largest SH degree. */
TIDES_API int32_t tides_scene_objects(const tides_scene *scene);
TIDES_API int64_t tides_scene_count(const tides_scene *scene);
TIDES_API int32_t tides_scene_sh_degree(const tides_scene *scene);

/* One object, as views that live as long as the scene and until the next add. */
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

/* Object `index`'s Gaussians at `time` [s], raw and in its own coordinates, before its trajectory and scale: fills mean,
 * log_scale, quaternion, opacity_logit and sh of `theta` for all N of them, where those aren't NULL; its rates are left alone.
 * An opacity of 0, by which a motion hides a Gaussian, becomes 2^-24. TIDES_BAD_ARGUMENT: there is no such object;
 * TIDES_OUT_OF_RANGE where its motion doesn't cover the time, and what a callback returns. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_gaussians_at(const tides_scene *scene, int32_t index, double time,
                                                                 const tides_theta *theta, tides_error *error);

/* How many of an object's Gaussians move, the others being the same at all times; -1 without memory to find out. And how many
 * times there are at which their rates may jump. */
TIDES_API int64_t tides_motion_moving(const tides_motion *motion, const tides_gaussians *gaussians);
TIDES_API uint64_t tides_motion_knots(const tides_motion *motion);

/* Axis-aligned box of the means, objects at their start or, for a static path, in place. For objects with a motion these are
 * the means that the motion starts from (canonical ones of networks, the first keyframe, a polynomial's at each Gaussian's own
 * centre in time). No motion is evaluated, since that may take seconds, and a Gaussian's means while it is invisible are no
 * part of the scene. So it tells where the scene is, not all that it ever reaches. */
TIDES_API void tides_scene_bounds(const tides_scene *scene, double lower[3], double upper[3]);

/* The times that all objects cover [s]: -INFINITY and INFINITY where all are at rest; start > stop where there are none. */
TIDES_API void tides_scene_range(const tides_scene *scene, double *start, double *stop);

/* That box at `time` [s], with every Gaussian where it is then; all of them are evaluated, which takes a network's motion
 * seconds. TIDES_OUT_OF_RANGE where an object's motion doesn't cover the time, and what a callback returns. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_bounds_at(const tides_scene *scene, double time, double lower[3],
                                                              double upper[3], tides_error *error);

/* How all objects were trained that say so: TIDES_TRAINED_*. Files say it in .h5; in a .ply's comments "SplatRenderMode: mip"
 * or "default" (Brush, splat-transform), "antialiased 1" or "0" (Postshot), or its filter_3D (mip-splatting); a .spz's flag 1;
 * a SOG's "model"; "antialiased" in the cfg.yml of gsplat's checkpoints. tides_scene_save keeps it in .h5, .ply and .spz. */
TIDES_API int32_t tides_scene_trained(const tides_scene *scene);

/* How the colours of all objects code light, TIDES_TRANSFER_*, and with GAMMA its exponent: one image can only be decoded in
 * one way. TIDES_BAD_CONFIG, naming two objects, where they differ. An empty scene is LINEAR. Files say it in a .ply's
 * comment "ColourTransfer: linear" ("srgb", "gamma 2.2"), an .h5's attribute colour_transfer, a glTF's colorSpace;
 * tides_scene_save keeps it there. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_transfer(const tides_scene *scene, int32_t *transfer, double *gamma,
                                                             tides_error *error);

/* Which way up is in the scene, a direction of any length: what its first file that is at rest says (.h5; a .ply's comments
 * "up x y z", Brush's "Vertical axis: x y z", and nerfstudio's "Vertical Axis: z"), what tides_generate makes, or what was
 * set. 1; 0 and zeros where nothing says it. tides_scene_save keeps it in .h5 and .ply. Zeros or NULL, set, say that it isn't
 * known. */
TIDES_API int32_t tides_scene_up(const tides_scene *scene, double up[3]);
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_set_up(tides_scene *scene, const double up[3], tides_error *error);

/* An orbit for a scene without a camera path. A thing is seen whole from every side, as large as fits into `field_of_view`
 * [rad], the narrower one of the image; in a place (a capture with what was behind it) the camera goes round the median of the
 * Gaussians, as far from it as half of them are. A turn in 12 s, from 0 to 12 s. `up` NULL: tides_scene_up's, else guessed: -y,
 * as trainers on photographs have it, or z where the scene lies flat across it. For tides_trajectory_create_orbit. An empty
 * scene: TIDES_BAD_ARGUMENT. */
TIDES_MUST_CHECK TIDES_API tides_status tides_scene_orbit(const tides_scene *scene, const double up[3], double field_of_view,
                                                          tides_orbit *orbit, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
