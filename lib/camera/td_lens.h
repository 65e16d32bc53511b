/* Internal: converts a camera for the kernels: intrinsics, and the lens with the bounds that kernels need. */
#ifndef TD_LENS_RESOLVE_H
#define TD_LENS_RESOLVE_H

#ifndef TD_REAL_DOUBLE
#define TD_REAL_DOUBLE
#endif
#include "kernels/lens.h"
#include "td_base.h"
#include "tides/camera.h"

/* Sets size, focal lengths, principal point and lens of `image`. TIDES_BAD_ARGUMENT, naming the key, if a number is out of
 * range or isn't part of this lens model, or if the lens folds over within the image. */
tides_status td_camera_resolve(const tides_intrinsics *camera, td_image *image, tides_error *error);

/* The range [x0, x1, y0, y1] of the undistorted x/z and y/z within the image, for a radtan lens. */
void td_camera_range(const td_image *image, double range[4]);

#endif
