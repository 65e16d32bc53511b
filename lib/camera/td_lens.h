/* Internal: a camera as kernels have it: intrinsics, and the lens with what its bounds are worked out to be. */
#ifndef TD_LENS_RESOLVE_H
#define TD_LENS_RESOLVE_H

#ifndef TD_REAL_DOUBLE
#define TD_REAL_DOUBLE
#endif
#include "kernels/lens.h"
#include "td_base.h"
#include "tides/camera.h"

/* Sets size, focal lengths, principal point and lens of an image. TIDES_BAD_ARGUMENT, naming the key, where a number is out of
 * range, isn't of that lens, or the lens folds over within the image. */
tides_status td_camera_resolve(const tides_intrinsics *camera, td_image *image, tides_error *error);

/* The range [x0, x1, y0, y1] of x/z and y/z within the image of a radtan lens. */
void td_camera_range(const td_image *image, double range[4]);

#endif
