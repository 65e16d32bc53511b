/* Internal to lib/render: what an image's colours are of light. */
#ifndef TD_TRANSFER_OF_IMAGE_H
#define TD_TRANSFER_OF_IMAGE_H

#include "td_renderer.h"

/* The numbers of a transfer (TIDES_TRANSFER_LINEAR and on) that has been checked; the image's log_eps is known. */
void td_image_set_transfer(int32_t kind, double gamma, td_image *image);

/* The same, for what the parameters say, or the scene where these leave it to that. */
tides_status td_image_take_transfer(const tides_image_params *params, const tides_scene *scene, td_image *image,
                                    tides_error *error);

/* The colour of light that isn't linear in it. */
double td_transfer_colour(const td_transfer *transfer, double light);

/* What lies behind everything: light, as colours. It doesn't change with time in this version: its rates are 0. `luminance` is
 * what of it is composited: that, or where light isn't linear the largest channel, which a sort asks for. */
void td_backdrop_set(const td_image *image, const double background[3], td_backdrop *backdrop);

#endif
