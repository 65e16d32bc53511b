/* Red, green and blue on their way to pixels where light isn't linear in them (transfer.h): what compositing.h and
 * soft_order.h do with luminance, by the weights that they have found. Each channel goes through a batch of splats by
 * itself: all three at once leave processors no room for what they add to (twice the time on AVX2). */
#ifndef TD_CHANNELS_H
#define TD_CHANNELS_H

#include "transfer.h"

/* A channel's light: Y, composited so far, and B, of the splats that take out light now (soft_order.h). */
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

/* Adds a value w times to a sum, with their rates. */
TD_INLINE void td_channel_show(td_lanes w, td_lanes w_dot, td_lanes value, td_lanes rate, td_lanes *sum, td_lanes *sum_dot) {
    *sum = td_fma(w, value, *sum);
    *sum_dot = td_fma(w_dot, value, td_fma(w, rate, *sum_dot));
}

/* Light goes a way on through what takes it out, W of which is seen, and of whose density `left` is left (td_soft_go). */
TD_INLINE void td_channel_go(td_lanes w, td_lanes w_dot, td_lanes left, td_lanes m_dot, td_channel *of) {
    td_lanes b = of->b, b_dot = of->b_dot;
    td_channel_show(w, w_dot, b, b_dot, &of->y, &of->y_dot);
    of->b = b * left, of->b_dot = td_fma(b_dot, left, b * -m_dot);
}

/* The weight of a splat: in soft order W of the splats that take out light before it, else its own weight. */
typedef struct td_shown {
    td_lanes w, w_dot;
} td_shown;

/* Lanes where next to nothing takes out light. */
TD_INLINE void td_channels_clear(td_lanes some, td_channels *of) {
    of->red.b = of->red.b * some, of->red.b_dot = of->red.b_dot * some;
    of->green.b = of->green.b * some, of->green.b_dot = of->green.b_dot * some;
    of->blue.b = of->blue.b * some, of->blue.b_dot = of->blue.b_dot * some;
}

/* BOUND where light isn't linear: what comes adds T times the largest channel at most to each, and f' grows; Y is no less
 * than the light of the channels' mean, since f is convex. For the same reason f is at most f' times its colour, so that
 * while what comes is more than transfer.sure, and than 2 stop times the largest channel, there's nothing to work out.
 * `live`: lanes for which it is asked. */
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

/* A channel with the backdrop behind, as light. */
TD_INLINE void td_channel_light(const td_image *image, td_lanes t, td_lanes t_dot, td_lanes y, td_lanes y_dot, td_real behind,
                                td_real behind_dot, td_lanes *light, td_lanes *light_dot) {
    td_lanes growth;
    *light = td_light_of(image, td_fma(t, behind, y), &growth);
    *light_dot = growth * td_fma(t_dot, behind, td_fma(t, behind_dot, y_dot));
}

#endif
