/* Ground truth: what an image shows, where it is and how it moves, exactly and at any time. A pass of its own beside the image,
 * with the image's weights; what isn't asked for costs nothing. */
#ifndef TIDES_TRUTH_H
#define TIDES_TRUTH_H

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
    double *plane[TIDES_TRUTHS];
} tides_truth;

/* Ground truth of the frame at `time` [s] seen from `camera`, as tides_renderer_frame has it; no PSF blurs it. Planes that
 * aren't finite: TIDES_BAD_ARGUMENT naming pixel and splat. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_truth(tides_renderer *renderer, const tides_trajectory *camera,
                                                             double time, const tides_truth *truth, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
