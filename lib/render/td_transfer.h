/* Internal to lib/render: the transfer, which converts composited colours to light. */
#ifndef TD_TRANSFER_OF_IMAGE_H
#define TD_TRANSFER_OF_IMAGE_H

#include "td_renderer.h"

/* Sets the numbers of a transfer (TIDES_TRANSFER_*), which has been checked. The image's log_eps must be set before. */
void td_image_set_transfer(int32_t kind, double gamma, td_image *image);

/* Sets the transfer from the parameters or, if they leave it open, from the scene. */
tides_status td_image_take_transfer(const tides_image_params *params, const tides_scene *scene, td_image *image,
                                    tides_error *error);

/* The colour that codes `light`, if light isn't linear in colours. */
double td_transfer_colour(const td_transfer *transfer, double light);

/* Sets the backdrop behind everything. `background` is light, and is stored as colours; it doesn't change with time, so its
 * rates are 0. `luminance` is the composited value: the backdrop's own or, if light isn't linear in colours, its largest
 * channel. */
void td_backdrop_set(const td_image *image, const double background[3], td_backdrop *backdrop);

#endif
