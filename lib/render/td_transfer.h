/* Internal to lib/render: what an image's colours are of light. */
#ifndef TD_TRANSFER_OF_IMAGE_H
#define TD_TRANSFER_OF_IMAGE_H

#include "td_renderer.h"

/* The numbers of a transfer (TIDES_TRANSFER_LINEAR and on) that has been checked; the image's log_eps is known. */
void td_image_set_transfer(int32_t kind, double gamma, td_image *image);

/* Sets the transfer that the parameters name, or the scene's where the parameters leave it open. */
tides_status td_image_take_transfer(const tides_image_params *params, const tides_scene *scene, td_image *image,
                                    tides_error *error);

/* The colour that codes `light`, where light isn't linear in colours. */
double td_transfer_colour(const td_transfer *transfer, double light);

/* Sets the backdrop behind everything: `background` is light, and is kept as colours. It doesn't change with time in this
 * version: its rates are 0. `luminance` is the composited value: the backdrop's own, or where light isn't linear the largest
 * channel, which a sort asks for. */
void td_backdrop_set(const td_image *image, const double background[3], td_backdrop *backdrop);

#endif
