/* Internal to lib/render: the transfer, which converts composited colours to light. */
#ifndef TD_TRANSFER_OF_IMAGE_H
#define TD_TRANSFER_OF_IMAGE_H

#include "td_renderer.h"

/* Sets image->transfer and image->is_coded. td_transfer_check must have accepted `kind` (TIDES_TRANSFER_*, but not _FILE) and
 * `gamma`. The image's log_eps, luminance and stop must be set before. */
void td_image_set_transfer(int32_t kind, double gamma, td_image *image);

/* Calls td_image_set_transfer with the transfer of `params` or, if params->transfer is TIDES_TRANSFER_FILE, that of the scene.
 * TIDES_BAD_ARGUMENT: the parameters are invalid. Other failures are those of tides_scene_transfer. */
tides_status td_image_take_transfer(const tides_image_params *params, const tides_scene *scene, td_image *image,
                                    tides_error *error);

/* The colour whose light is `light`: the inverse of td_light_of in kernels/transfer.h. With a linear transfer it is `light`. */
double td_transfer_colour(const td_transfer *transfer, double light);

/* Sets the backdrop, which is behind all splats. `background` is light, and is stored as colours. It doesn't change with time,
 * so its rates are 0. backdrop->luminance is the background's luminance Y or, if image->is_coded, its largest colour. */
void td_backdrop_set(const td_image *image, const double background[3], td_backdrop *backdrop);

#endif
