/* The full SpacetimeGaussians model's colour of a pixel (Li et al. 2024): nine composited features f and the pixel's ray make
 *
 *   rgb = out(f_0..2 + W_2 relu(W_1 (f_3..8, centre of the camera, unit direction of the pixel)))
 *
 * with rates by forward mode. `out` is a sigmoid, a clamp to [0, 1], or nothing. Rays are in the object's coordinates, as
 * view directions are. There is no background: a ray that meets no splat has features 0, and shows the network's colour for
 * these. */
#ifndef TD_DECODER_H
#define TD_DECODER_H

#include "compositing.h"
#include "lens.h"
#include "motion.h"

enum { TD_DECODER_SIGMOID = 1, TD_DECODER_CLAMP = 2, TD_DECODER_PLAIN = 3 };
enum { TD_DECODER_INPUTS = 12, TD_DECODER_HIDDEN = 6, TD_DECODER_SECOND = 72 };

/* The last six inputs: the eye, and the unit direction of the pixels in the object's coordinates. */
TD_INLINE void td_decoder_ray(const td_image *image, TD_GLOBAL const td_view *view, const td_composite *pixels,
                              td_dual ray[6]) {
    td_lanes x, y;
    td_ray_of(image, pixels->x, pixels->y, &x, &y);
    td_dual square = td_dual_make(td_splat(0.0f), td_splat(0.0f));
    for (int j = 0; j < 3; j++) {
        td_lanes v = td_fma(x, view->r[j], td_fma(y, view->r[3 + j], td_splat(view->r[6 + j])));
        td_lanes d = td_fma(x, view->r_dot[j], td_fma(y, view->r_dot[3 + j], td_splat(view->r_dot[6 + j])));
        ray[j] = td_dual_make(td_splat(view->eye[j]), td_splat(view->eye_dot[j]));
        ray[3 + j] = td_dual_make(v, d);
        square = td_dual_fma(ray[3 + j], ray[3 + j], square);
    }
    td_dual inverse = td_dual_reciprocal(td_dual_sqrt(square));
    for (int j = 3; j < 6; j++) ray[j] = td_dual_mul(ray[j], inverse);
}

TD_INLINE td_dual td_decoder_out(td_dual x, int decoder) {
    if (decoder == TD_DECODER_SIGMOID) return td_dual_sigmoid(x);
    if (decoder == TD_DECODER_CLAMP) return td_dual_clamp(x, 0, 1);
    return x;
}

/* Gives a composite with the decoded colour and luminance. Its T is 0: no backdrop is added to them. */
TD_INLINE td_composite td_develop(const td_image *image, TD_GLOBAL const td_view *view, TD_GLOBAL const td_real *weights,
                                  const td_composite *pixels) {
    td_composite shown = *pixels;
    td_dual in[TD_DECODER_INPUTS], hidden[TD_DECODER_HIDDEN], zero = td_dual_make(td_splat(0.0f), td_splat(0.0f));
    td_dual luminance = zero;
    for (int k = 0; k < 6; k++) in[k] = td_dual_make(pixels->sums.feature[3 + k], pixels->sums.feature[TD_FEATURES + 3 + k]);
    td_decoder_ray(image, view, pixels, in + 6);
    for (int i = 0; i < TD_DECODER_HIDDEN; i++) {
        td_dual sum = zero;
        for (int k = 0; k < TD_DECODER_INPUTS; k++) sum = td_dual_plus(sum, weights[TD_DECODER_INPUTS * i + k], in[k]);
        hidden[i] = td_dual_select(zero, sum, sum.v > 0.0f);
    }
    for (int c = 0; c < 3; c++) {
        td_dual sum = td_dual_make(pixels->sums.feature[c], pixels->sums.feature[TD_FEATURES + c]);
        for (int i = 0; i < TD_DECODER_HIDDEN; i++)
            sum = td_dual_plus(sum, weights[TD_DECODER_SECOND + TD_DECODER_HIDDEN * c + i], hidden[i]);
        sum = td_decoder_out(sum, td_decoder(image));
        shown.sums.colour[c] = sum.v;
        shown.sums.colour[3 + c] = sum.d;
        luminance = td_dual_plus(luminance, image->luminance[c], sum);
    }
    shown.sums.luminance = luminance.v;
    shown.sums.luminance_dot = luminance.d;
    shown.transmittance = shown.transmittance_dot = td_splat(0.0f);
    return shown;
}

#endif
