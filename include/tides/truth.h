/* Ground truth: what an image shows, where it is and how it moves, exactly and at any time. It is a separate pass that uses
 * the image's weights. A plane that isn't wanted costs nothing. */
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

/* Planes of ground truth: each (height x width), row 0 on top, caller's memory; NULL: not wanted. Where nothing is seen, all
 * are 0, except the instance, which is -1. */
typedef struct tides_truth {
    double *plane[TIDES_TRUTHS]; /* by TIDES_TRUTH_* */
} tides_truth;

/* Ground truth of the frame at `time` [s] seen from `camera`, without blur by a PSF. TIDES_BAD_ARGUMENT naming pixel and
 * splat: a plane isn't finite. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_truth(tides_renderer *renderer, const tides_trajectory *camera,
                                                             double time, const tides_truth *truth, tides_error *error);

/* -- material points: tracks, and displacement between two times -- */

/* A place in a Gaussian, which moves and deforms with it: xi standard deviations along the Gaussian's own axes. */
typedef struct tides_material_point {
    int32_t object; /* number of the object in the scene; -1: no point */
    int32_t reserved;
    int64_t gaussian; /* within the object */
    double xi[3];     /* in standard deviations [1] */
} tides_material_point;

/* Where a point is at a time. */
typedef struct tides_track {
    double u, v;     /* [px], (0.5, 0.5) is the first pixel's centre; NaN behind the near plane, or without a point */
    double depth;    /* camera z [scene units]; NaN without a point */
    int32_t visible; /* 1: in the image, and not behind what is seen there (the splat of the median depth) */
    int32_t reserved;
} tides_track;

/* The points seen at the places xy (count x 2) [px] at `time`: each is on the splat of median depth. No point where nothing
 * takes the transmittance below 1/2. TIDES_BAD_ARGUMENT: a place outside the image. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_pick(tides_renderer *renderer, const tides_trajectory *camera,
                                                            double time, const double *xy, size_t count,
                                                            tides_material_point *points, tides_error *error);

/* Chooses up to `count` places, evenly over all pixels that show something at `time`: xy (count x 2) [px], and the points
 * seen there. Places depend on (seed, number, draw) alone. `chosen` is their number: less than `count` if less than a 32nd of
 * the image shows something. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_choose(tides_renderer *renderer, const tides_trajectory *camera,
                                                              double time, uint64_t seed, uint32_t number, size_t count,
                                                              double *xy, tides_material_point *points, size_t *chosen,
                                                              tides_error *error);

/* The places of points at `time`, in double precision on any device (except motion models). Takes one pass of ground truth,
 * to find what hides them. TIDES_BAD_ARGUMENT: a Gaussian that the scene doesn't have. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_follow(tides_renderer *renderer, const tides_trajectory *camera,
                                                              double time, const tides_material_point *points, size_t count,
                                                              tides_track *tracks, tides_error *error);

/* The displacement [px] of what each pixel shows at `from` to its place at `to`, forward or backward in time; NaN where no
 * point is seen. Optical flow, in contrast, is a velocity [px/s] at one time. `visible`: 1 if it is also seen at `to`. Planes
 * (height x width), each nullable. */
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

/* Ground truth of events (count), each when it fired: `fired` [ns] (nullable: the event's t). Fastest with events in order.
 * TIDES_BAD_ARGUMENT: an event outside the image. A block of pixels is rendered for each event. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_event_truth(tides_renderer *renderer, const tides_trajectory *camera,
                                                                   const tides_event *events, const int64_t *fired,
                                                                   size_t count, tides_event_truth *truth, tides_error *error);

/* Reads ground truth of events [first, first + count) from columns of an HDF5 recording that was simulated with sensor.truth;
 * 0 events are fine. The column's attribute `unit` gives the unit of depths. TIDES_UNSUPPORTED: the file lacks a column;
 * TIDES_BAD_FILE: it has fewer rows. On failure `truth` may hold some. */
TIDES_MUST_CHECK TIDES_API tides_status tides_events_truth(const char *path, uint64_t first, size_t count,
                                                           tides_event_truth *truth, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
