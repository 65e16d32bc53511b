/* Ground truth: what an image shows, where it is and how it moves, exactly and at any time. It is a pass of its own beside the
 * image, with the image's weights; a plane that isn't asked for costs nothing. */
#ifndef TIDES_TRUTH_H
#define TIDES_TRUTH_H

#include "tides/events.h"
#include "tides/image.h"
#include "tides/render.h"

#ifdef __cplusplus
extern "C" {
#endif

/* clang-format off */
/* Planes of ground truth, in the order of tides_truth_name. Each splat is its Gaussian's densest point on the ray of the
 * pixel, a material point that moves with its splat (kernels/truth.h); means are over splats, by blend weight. */
enum {
    TIDES_TRUTH_FLOW_U = 0,       /* optical flow: velocity on the screen of what is seen, a mean  [px/s] */
    TIDES_TRUTH_FLOW_V = 1,
    TIDES_TRUTH_DEPTH = 2,        /* camera z of what is seen, a mean            [scene units] */
    TIDES_TRUTH_DEPTH_MEDIAN = 3, /* of the splat that takes the transmittance below 1/2; 0: none does   [scene units] */
    TIDES_TRUTH_ALPHA = 4,        /* how much is seen: how valid the others are  [1] */
    TIDES_TRUTH_INSTANCE = 5,     /* the object that weighs most, by its number in the scene; -1 where nothing is seen */
    TIDES_TRUTH_NORMAL_X = 6,     /* of what is seen, to the camera, in its coordinates; a mean, of length 1 */
    TIDES_TRUTH_NORMAL_Y = 7,
    TIDES_TRUTH_NORMAL_Z = 8,
    TIDES_TRUTHS = 9
};
/* clang-format on */

/* "flow_u", "flow_v", "depth", "depth_median", "alpha", "instance", "normal_x", ..; NULL out of range. */
TIDES_API const char *tides_truth_name(int32_t truth);

/* Where planes go: each (height x width), row 0 on top, caller's memory, NULL where not wanted. Where nothing is seen all are
 * 0, but for the instance. */
typedef struct tides_truth {
    double *plane[TIDES_TRUTHS]; /* by TIDES_TRUTH_* */
} tides_truth;

/* Ground truth of the frame at `time` [s] seen from `camera`, as tides_renderer_frame has it; no PSF blurs it. Planes that
 * aren't finite: TIDES_BAD_ARGUMENT naming pixel and splat. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_truth(tides_renderer *renderer, const tides_trajectory *camera,
                                                             double time, const tides_truth *truth, tides_error *error);

/* -- material points: tracks, and displacement between two times -- */

/* A place in a Gaussian, which it moves and deforms with: xi standard deviations along its own axes (the columns of its factor,
 * kernels/truth.h). */
typedef struct tides_material_point {
    int32_t object; /* of the scene; -1: no point */
    int32_t reserved;
    int64_t gaussian; /* within the object */
    double xi[3];     /* in standard deviations [1] */
} tides_material_point;

/* Where a point is at a time. */
typedef struct tides_track {
    double u, v;     /* [px], (0.5, 0.5) being the first pixel's centre; NaN behind the near plane, or where there's no point */
    double depth;    /* camera z [scene units]; NaN where there's no point */
    int32_t visible; /* 1: in the image, and not behind what is seen there (the splat of the median depth) */
    int32_t reserved;
} tides_track;

/* Points that the places xy (count x 2) [px] show at `time`: of the splat that has the median depth at the pixel; none where
 * nothing takes the transmittance below 1/2. TIDES_BAD_ARGUMENT: a place outside of the image. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_pick(tides_renderer *renderer, const tides_trajectory *camera,
                                                            double time, const double *xy, size_t count,
                                                            tides_material_point *points, tides_error *error);

/* Chooses up to `count` places where something is seen at `time`, even over all pixels that show something: xy (count x 2)
 * [px], and the points there. Places are drawn by (seed, number, draw) alone. `chosen` says how many there are: fewer than
 * asked for where less than a 32nd of the image shows something. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_choose(tides_renderer *renderer, const tides_trajectory *camera,
                                                              double time, uint64_t seed, uint32_t number, size_t count,
                                                              double *xy, tides_material_point *points, size_t *chosen,
                                                              tides_error *error);

/* Where points are at `time`, in double precision whatever the renderer computes in (but for what motion models make of them).
 * One pass of ground truth, for what hides them. TIDES_BAD_ARGUMENT: a Gaussian that the scene doesn't have. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_follow(tides_renderer *renderer, const tides_trajectory *camera,
                                                              double time, const tides_material_point *points, size_t count,
                                                              tides_track *tracks, tides_error *error);

/* Displacement [px] of what each pixel shows at `from` to where it is at `to`, forward or backward in time; NaN where no
 * point is seen. It isn't optical flow, which is a velocity [px/s] at one time. `visible`: 1 where it is seen at `to` as
 * well. Planes (height x width), each nullable. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_displacement(tides_renderer *renderer, const tides_trajectory *camera,
                                                                    double from, double to, double *u, double *v,
                                                                    double *visible, tides_error *error);

/* -- files -- */

/* Ground truth out of a file, as planes by name that tides_exr_size, _name and _pixels tell: float, and NaN where the file says
 * that nothing is known:
 *   .exr  its channels as they are: what tides render writes
 *   .png  of 16 bits, r g b: "displacement_u", "displacement_v" [px], as DSEC has optical flow; grey: "disparity" [px] where
 *         the path names a folder disparity, as DSEC has it, else "depth" [m], as TUM does; of 8 bits, grey: "instance"
 *   .npy  (height, width, 2 or 3): "displacement_u", "displacement_v", the third being whether it is known, as BlinkFlow has
 *         it; (height, width): "instance" of whole numbers, "depth" of others
 * TIDES_UNSUPPORTED: another ending. The caller destroys the planes. */
TIDES_MUST_CHECK TIDES_API tides_status tides_truth_read(const char *path, tides_exr **planes, tides_error *error);

/* -- events -- */

/* Ground truth at an event's pixel when it fired. */
typedef struct tides_event_truth {
    double flow_u, flow_v;      /* [px/s] */
    double depth, alpha;        /* [scene units], [1] */
    int32_t instance, reserved; /* the scene's object; -1 where nothing is seen */
} tides_event_truth;

/* Ground truth of events (count), each at its own time: when it fired [ns] (nullable: its t). Events are best in order; one
 * outside of the image is TIDES_BAD_ARGUMENT. A block of pixels is rendered for each. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_event_truth(tides_renderer *renderer, const tides_trajectory *camera,
                                                                   const tides_event *events, const int64_t *fired,
                                                                   size_t count, tides_event_truth *truth, tides_error *error);

/* Reads the columns of ground truth of events [first, first + count) of an HDF5 recording that was simulated with
 * sensor.truth; 0 events are fine. Depths are in what the column's attribute `unit` says. TIDES_UNSUPPORTED: the file hasn't
 * all columns; TIDES_BAD_FILE: it has fewer rows. On failure `truth` may hold some. */
TIDES_MUST_CHECK TIDES_API tides_status tides_events_truth(const char *path, uint64_t first, size_t count,
                                                           tides_event_truth *truth, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
