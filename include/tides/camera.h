/* The camera: intrinsics, lenses, and paths read from the files that people have. */
#ifndef TIDES_CAMERA_H
#define TIDES_CAMERA_H

#include "tides/trajectory.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Models of tides_lens. */
enum { TIDES_LENS_NONE = 0, TIDES_LENS_RADTAN, TIDES_LENS_EQUIDISTANT };

/* The name of a model, as in camera.lens ("radtan"); NULL for other numbers. */
TIDES_API const char *tides_lens_name(int32_t model);

/* The distortion of slopes (a, b) = (x/z, y/z), r^2 = a^2 + b^2, to (a', b'). All zeros is a pinhole.
 *   RADTAN (OpenCV's, COLMAP's OPENCV, ROS's plumb_bob), with k4 0:
 *     a' = a (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 a b + p2 (r^2 + 2 a^2),
 *     b' = b (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 b^2) + 2 p2 a b
 *   EQUIDISTANT (OpenCV's fisheye, Kannala-Brandt), with p1 and p2 0 and theta = atan(r):
 *     (a', b') = (a, b) theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8) / r
 * A lens whose image folds over is refused. Only what is in front of the near plane is seen, as without a lens. Where an
 * equidistant image reaches to 90 degrees and beyond, the background shows. */
typedef struct tides_lens {
    int32_t model; /* TIDES_LENS_* */
    int32_t reserved;
    double k1, k2, k3, k4, p1, p2; /* [1] 0 where the model has no such term */
} tides_lens;

/* u = fx a' + cx, v = fy b' + cy. Pixel (0,0) is the top left one and its centre is at (0.5, 0.5). OpenCV, ROS, Kalibr and
 * DSEC put pixel centres at whole numbers: add 0.5 to their cx and cy. */
typedef struct tides_intrinsics {
    int32_t width, height; /* [px] */
    double fx, fy, cx, cy; /* [px] */
    tides_lens lens;       /* zeros: a pinhole */
} tides_intrinsics;

/* How to read a path file; fill with tides_path_options_defaults. */
typedef struct tides_path_options {
    uint32_t size;     /* sizeof this struct, set by the defaults function */
    int32_t time_unit; /* TIDES_TIME_* of a file's times; AUTO: as its header says, else the format's usual unit if plausible */
    double duration;   /* [s] files without times (cameras.json, COLMAP, LLFF ...): poses are spread evenly over
                               [0, duration], in the order of pictures' names, with digits as numbers, where the file has
                               them, else of the file; files with trainer's times in [0, 1]
                               (D-NeRF, nerfies): times are multiplied by it */
    double start;      /* [s] subtracted from every time, after scaling */
    int32_t rebase;    /* 1: the first sample is at 0, and `start` is ignored */
    int32_t raw_positions; /* nerfies: 1 leaves positions as the camera files have them (as 4DGaussians trains) instead of
                               applying scene.json (as Nerfies, HyperNeRF and Deformable-3D-Gaussians do) */
    const char *views;     /* which poses to keep, as Python slices with commas between: "7", "0:100:10", "3,5,-1"; NULL:
                              all. Counted from 0 in the path's order: of times, of images' names, else of the file. The
                              poses kept of a file without times are spread over `duration` */
    int32_t body; /* EuRoC: 1 leaves the body's poses as they are instead of putting its camera there (T_BS of sensor.yaml) */
    int32_t reserved;
    const char *frame; /* transforms.json and COLMAP: nerfstudio's dataparser_transforms.json, which puts cameras where
                          ns-export puts splats; NULL: the one beside the file; "none": as the file has them */
} tides_path_options;

TIDES_API void tides_path_options_defaults(tides_path_options *options); /* duration 1, start 0, rebase 0 */

/* Bytes of tides_path.notes. */
enum { TIDES_PATH_NOTES = 1024 };

/* Bits of tides_path.varied: intrinsics that differ from frame to frame. */
enum {
    TIDES_VARIED_WIDTH = 1,
    TIDES_VARIED_HEIGHT = 2,
    TIDES_VARIED_FX = 4,
    TIDES_VARIED_FY = 8,
    TIDES_VARIED_CX = 16,
    TIDES_VARIED_CY = 32
};

/* The content of a path file. */
typedef struct tides_path {
    tides_trajectory *trajectory; /* owned by the caller after success */
    tides_intrinsics intrinsics;  /* fields that the file lacks, or that differ from frame to frame, are 0 */
    double field_of_view_x;       /* [rad] if the file gives one (Blender and D-NeRF give it without a width), else 0 */
    char format[32];   /* "tides", "transforms", "camera_path", "cameras", "tum", "esim", "euroc", "kitti", "colmap", "llff",
                          "nerfies" */
    int32_t distorted; /* 1: the file's lens is no tides_lens, or differs from frame to frame. Runs then want camera.lens.
                          Focal lengths are the file's. Those of COLMAP's FOV are multiplied by the lens's magnification
                          at its axis */
    int32_t untimed;   /* 1: the file has several poses without times; they are spread over options.duration */
    int32_t varied;    /* TIDES_VARIED_* of intrinsics that are 0 because they differ from frame to frame */
    int32_t framed;    /* 1: dataparser_transforms.json was applied */
    int32_t reserved;
    int32_t has_imu;  /* 1: the folder of the file says where an IMU is (EuRoC) */
    double T_C_I[16]; /* if has_imu: p_camera = T_C_I p_imu, row-major */
    /* surprising facts about the path, a line each, such as poses that leap, or a unit that was guessed; else "" */
    char notes[TIDES_PATH_NOTES];
} tides_path;

/* Reads a camera path. The format is found from the content (COLMAP's binary files: from the name):
 *   tides       JSON of TIDES, as tides_path_save writes it
 *   transforms  nerfstudio / instant-ngp / Blender / D-NeRF transforms.json (OpenGL axes, converted)
 *   camera_path nerfstudio's camera_path.json, as its viewer and Blender add-on write it: perspective and fisheye
 *   cameras     INRIA cameras.json
 *   colmap      images.txt or images.bin, with cameras.txt or .bin beside it: camera models 0 to 10
 *   llff        poses_bounds.npy (also Neu3D)
 *   nerfies     a camera's JSON; a folder camera/ of them with scene.json and metadata.json beside it (also HyperNeRF)
 *   tum         text `t tx ty tz qx qy qz qw`, seconds
 *   esim        csv `t_ns, x, y, z, qx, qy, qz, qw`
 *   euroc       state_groundtruth csv, `t_ns, x, y, z, qw, qx, qy, qz ...` of the body, with the camera's T_BS from sensor.yaml
 *   kitti       12 numbers per line
 * In a folder, one of these is searched for. Paths of objects are read too: axes are those of the file's body frame,
 * converted to OpenCV's. Errors name file, line or key. */
TIDES_MUST_CHECK TIDES_API tides_status tides_path_load(const char *file, const tides_path_options *options, tides_path *path,
                                                        tides_error *error);

/* Writes the JSON of TIDES: intrinsics (nullable) and samples, with rates if the path has them. */
TIDES_MUST_CHECK TIDES_API tides_status tides_path_save(const char *file, const tides_trajectory *trajectory,
                                                        const tides_intrinsics *intrinsics, tides_error *error);

/* For each raw pixel, its place in the image of a pinhole camera. `map` (raw height x width x 2) receives (u, v) of the ray
 * through the pixel's centre, turned by `rotation` (3x3 row-major, raw camera to rectified; NULL: none). As in OpenCV and
 * DSEC's rectify_map, pixel centres are at whole numbers: a pinhole's own map is (column, row). NaN where the ray isn't in
 * front of both cameras. */
TIDES_MUST_CHECK TIDES_API tides_status tides_rectify_map(const tides_intrinsics *raw, const tides_intrinsics *rectified,
                                                          const double rotation[9], float *map, tides_error *error);

/* Writes the map of tides_rectify_map to a .npy file of float32. */
TIDES_MUST_CHECK TIDES_API tides_status tides_rectify_save(const char *file, const tides_intrinsics *raw,
                                                           const tides_intrinsics *rectified, const double rotation[9],
                                                           tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
