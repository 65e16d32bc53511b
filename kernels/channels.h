/* Compositing of red, green and blue as three channels, where light isn't linear in colours (sRGB). Each channel is blended
 * with the weights that were computed for luminance. It goes through a batch of splats by itself: all three at once need more
 * registers than processors have, and take twice the time on AVX2. */
#ifndef TD_CHANNELS_H
#define TD_CHANNELS_H

#include "transfer.h"

/* A channel: y is composited so far; b is the light density of the splats that take out light now, in soft order. */
typedef struct td_channel {
    td_lanes y, y_dot, b, b_dot;
} td_channel;

typedef struct td_channels {
    td_channel red, green, blue;
} td_channels;

TD_INLINE td_channel td_channel_dark(void) {
    td_channel of;
    of.y = of.y_dot = of.b = of.b_dot = td_splat(0.0f);
    return of;
}
TD_INLINE td_channels td_channels_dark(void) {
    td_channels of;
    of.red = of.green = of.blue = td_channel_dark();
    return of;
}

/* Adds a value w times to a sum, and the product's rate to the sum's rate. */
TD_INLINE void td_channel_show(td_lanes w, td_lanes w_dot, td_lanes value, td_lanes rate, td_lanes *sum, td_lanes *sum_dot) {
    *sum = td_fma(w, value, *sum);
    *sum_dot = td_fma(w_dot, value, td_fma(w, rate, *sum_dot));
}

/* Light passes a distance in depth. The channel gains w times the density b, of which `left` remains behind the distance. */
TD_INLINE void td_channel_go(td_lanes w, td_lanes w_dot, td_lanes left, td_lanes m_dot, td_channel *of) {
    td_lanes b = of->b, b_dot = of->b_dot;
    td_channel_show(w, w_dot, b, b_dot, &of->y, &of->y_dot);
    of->b = b * left, of->b_dot = td_fma(b_dot, left, b * -m_dot);
}

/* The weight with which a splat is shown. In soft order this is the common weight of the splats in front of it that take out
 * light, else its own blend weight. */
typedef struct td_shown {
    td_lanes w, w_dot;
} td_shown;

/* Clears densities in lanes where the density is negligible: `some` is 0 there, else 1. */
TD_INLINE void td_channels_clear(td_lanes some, td_channels *of) {
    of->red.b = of->red.b * some, of->red.b_dot = of->red.b_dot * some;
    of->green.b = of->green.b * some, of->green.b_dot = of->green.b_dot * some;
    of->blue.b = of->blue.b * some, of->blue.b_dot = of->blue.b_dot * some;
}

/* The stop rule BOUND for three channels. Splats behind add at most T times the largest channel to each, and light f(colour) is
 * convex. So L changes at most by that, times f' at the largest possible channel, over the light of the channels' mean. While
 * the addition is above transfer.sure, and above 2 stop times the largest channel, the rule holds without computing f. `live`
 * are the lanes for which it is asked. */
TD_INLINE td_mask td_channels_above_bound(const td_image *image, td_real brightest, td_lanes transmittance, td_mask live,
                                          const td_channels *of) {
    td_lanes r = of->red.y, g = of->green.y, b = of->blue.y, rest = transmittance * brightest, growth, unused;
    td_lanes most = td_larger(td_larger(r, g), b);
    td_mask unsure = (rest <= image->transfer.sure) | (rest <= 2 * image->stop * most);
    if (!td_any(live & unsure)) return live;
    td_real white = td_white(image);
    td_lanes mean = td_fma(r, image->luminance[0], td_fma(g, image->luminance[1], b * image->luminance[2]));
    td_lanes least = white * td_light_of(image, mean * (white > 0 ? 1 / white : 0), &unused);
    (void)td_light_of(image, most + rest, &growth);
    return live & (rest * white * growth > image->stop * (least + image->log_eps));
}

/* A channel over the backdrop, as light, and its rate. */
TD_INLINE void td_channel_light(const td_image *image, td_lanes t, td_lanes t_dot, td_lanes y, td_lanes y_dot, td_real behind,
                                td_real behind_dot, td_lanes *light, td_lanes *light_dot) {
    td_lanes growth;
    *light = td_light_of(image, td_fma(t, behind, y), &growth);
    *light_dot = growth * td_fma(t_dot, behind, td_fma(t, behind_dot, y_dot));
}

#endif
