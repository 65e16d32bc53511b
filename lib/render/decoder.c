/* Decoders: a small network that makes each pixel's colour from composited features (the full SpacetimeGaussians model). */
#include "td_renderer.h"

#include "kernels/decoder.h"
#include "motion/td_motion.h"

#include <math.h>

/* The motion that has a decoder, or NULL. */
static const tides_motion *find(const tides_scene *scene) {
    tides_object object;
    for (int32_t i = 0; i < tides_scene_objects(scene); i++)
        if (tides_scene_object(scene, i, &object, NULL) == TIDES_OK && object.motion &&
            td_motion_setting(object.motion, "decoder", 0) != 0)
            return object.motion;
    return NULL;
}

tides_status td_store_find_decoder(const tides_scene *scene, td_store *store, tides_error *error) {
    const tides_motion *motion = find(scene);
    if (!motion) return TIDES_OK;
    if (tides_scene_objects(scene) > 1)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "scene: a SpacetimeGaussians model whose colours a network makes (full) can't be "
                       "shown with other objects: render it alone, or use a lite model");
    const td_field *first = td_motion_field(motion, "decoder_first"), *second = td_motion_field(motion, "decoder_second");
    store->decoder = td_alloc(TD_DECODER_REALS, sizeof *store->decoder, error);
    if (!store->decoder) return TIDES_NO_MEMORY;
    for (int i = 0; i < TD_DECODER_SECOND; i++) store->decoder[i] = first->value[i];
    for (int i = TD_DECODER_SECOND; i < TD_DECODER_REALS; i++) store->decoder[i] = second->value[i - TD_DECODER_SECOND];
    return TIDES_OK;
}

/* Assumed largest colour of a decoder without bounds, to estimate how much light may change. Trained decoders reach 1. */
static const double largest_colour = 2;

/* Largest change of luminance if no feature changes by more than 1. Slopes of relu are at most 1, of the sigmoid 1/4. */
static double gain_of(const double *weights, const td_real luminance[3], int decoder) {
    double gain = 0;
    for (int c = 0; c < 3; c++) {
        double most = 1;
        for (int i = 0; i < TD_DECODER_HIDDEN; i++) {
            double reach = 0;
            for (int k = 0; k < 6; k++) reach += fabs(weights[TD_DECODER_INPUTS * i + k]);
            most += reach * fabs(weights[TD_DECODER_SECOND + TD_DECODER_HIDDEN * c + i]);
        }
        gain += fabs(luminance[c]) * most;
    }
    return decoder == TD_DECODER_SIGMOID ? gain / 4 : gain;
}

void td_image_set_decoder(const tides_scene *scene, const td_store *store, td_image *image) {
    if (!store->decoder) return;
    image->decoder = (int)td_motion_setting(find(scene), "decoder", 0);
    image->decoder_gain = gain_of(store->decoder, image->luminance, image->decoder);
    if (image->is_coded) {
        td_real growth;
        (void)td_light_of(image, image->decoder == TD_DECODER_PLAIN ? largest_colour : 1, &growth);
        image->decoder_gain *= growth;
    }
}
