/* Splats that fade at the near plane within an interval, for the search of swaps of depth (td_swaps.h): alpha passes the taper
 * of opacity in less time than the fade takes. */
#include "camera/td_rotation.h"
#include "td_extremes.h"
#include "td_swaps.h"

#include <math.h>

int td_swaps_is_fading(const tides_renderer *renderer, const td_swap_samples *at, int g) {
    const td_image *image = &renderer->image;
    const double *mean = renderer->store.geometry + (size_t)g * TD_GEOMETRY_STRIDE + TD_G_MEAN;
    const float *box = renderer->sweep.boxes + 4 * (size_t)g;
    double least = INFINITY, most = -INFINITY;
    if (!(box[0] <= box[2])) return 0;
    for (int k = 0; k <= 2; k++) {
        const size_t sample = (size_t)(k * at->parts / 2);
        const td_view *view = &at->view[sample * (size_t)at->objects + (size_t)renderer->store.object[g]];
        const double z = td_dot3(view->r + 6, mean) + view->t[2];
        least = td_lesser(least, z);
        most = td_greater(most, z);
    }
    return least < image->near_full && most > image->near;
}

int td_swaps_some_fade(const tides_renderer *renderer, const struct td_swaps *swaps, const td_swap_samples *at, int first,
                       int end) {
    const td_image *image = &renderer->image;
    int some = 0;
    if (!(image->near_full > image->near) || !(image->cut_full > image->cut) || td_lens_model(image)) return 0;
    for (int g = first; g < end && !some; g++) some = swaps->mover[g] < 0 && td_swaps_is_fading(renderer, at, g);
    return some;
}
