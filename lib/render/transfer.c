/* Computes the numbers of an image's transfer from its parameters and scene, and converts light to colours. */
#include "td_transfer.h"

#include "kernels/transfer.h"
#include "scene/td_scene.h"
#include "td_math.h"

#include <math.h>

double td_transfer_colour(const td_transfer *transfer, double light) {
    const double base = td_pow(fmax(light, 0), 1 / transfer->gamma) / transfer->scale - transfer->offset;
    if (base > transfer->joint || !(transfer->slope > 0)) return base;
    return light / transfer->slope;
}

/* Below this colour a gamma curve is replaced by a straight line. Its slope there is negligible, and single precision has no
 * logarithms of smaller numbers. */
static const double power_joint = 1e-30;

static td_transfer transfer_of(int32_t kind, double gamma) {
    const td_transfer srgb = {.joint = 0.04045, .slope = 1 / 12.92, .offset = 0.055, .scale = 1 / 1.055, .gamma = 2.4};
    const td_transfer power = {.joint = power_joint, .scale = 1, .gamma = gamma};
    return kind == TIDES_TRANSFER_SRGB ? srgb : power;
}

/* The least power of two, with a factor of 2 to spare, such that so much more colour changes any pixel's L by more than `stop`.
 * While more than this can still come, compositing can't stop. Infinite if no channel has luminance. */
static double sure_of(const td_image *image) {
    const double white = td_white(image);
    double sure = 1;
    for (double growth; sure > 1e-30; sure /= 2) {
        (void)td_light_of(image, sure / 2, &growth);
        if (!(0.25 * white * growth * sure / 2 > image->stop * image->log_eps)) break;
    }
    return white > 0 ? sure : HUGE_VAL;
}

/* Sets the transfer. `steepest` is gamma, because f' x / f, the ratio of a change of ln(light) to that of ln(colour), is at
 * most gamma. */
void td_image_set_transfer(int32_t kind, double gamma, td_image *image) {
    td_transfer *to = &image->transfer;
    *to = (td_transfer){.slope = 1, .scale = 1, .gamma = 1, .steepest = 1, .dark = image->log_eps};
    image->is_coded = kind == TIDES_TRANSFER_SRGB || (kind == TIDES_TRANSFER_GAMMA && gamma > 1);
    if (!image->is_coded) return;
    *to = transfer_of(kind, gamma);
    to->steepest = to->gamma;
    to->dark = td_transfer_colour(to, image->log_eps);
    to->sure = fmin(sure_of(image), 1e30);
}

tides_status td_image_take_transfer(const tides_image_params *params, const tides_scene *scene, td_image *image,
                                    tides_error *error) {
    int32_t kind = params->transfer;
    double gamma = params->gamma;
    tides_status status = TIDES_OK;
    if (kind == TIDES_TRANSFER_FILE)
        status = tides_scene_transfer(scene, &kind, &gamma, error);
    else
        status = td_transfer_check("image.", kind, gamma, error);
    if (status == TIDES_OK) td_image_set_transfer(kind, gamma, image);
    return status;
}

/* The slope f' / (f + log_eps) is at most `steepest` divided by the sum of the colour and log_eps's colour; a fourth of that
 * is used. */
double td_renderer_swap_scale(const tides_renderer *renderer, double light) {
    const td_image *image = &renderer->image;
    if (!image->is_coded) return light;
    return (td_transfer_colour(&image->transfer, light - image->log_eps) + image->transfer.dark) / image->transfer.steepest;
}

void td_backdrop_set(const td_image *image, const double background[3], td_backdrop *backdrop) {
    memset(backdrop, 0, sizeof *backdrop);
    for (int c = 0; c < 3; c++) {
        backdrop->colour[c] = image->is_coded ? td_transfer_colour(&image->transfer, background[c]) : background[c];
        if (image->is_coded)
            backdrop->luminance = fmax(backdrop->luminance, backdrop->colour[c]);
        else
            backdrop->luminance += image->luminance[c] * background[c];
    }
}
