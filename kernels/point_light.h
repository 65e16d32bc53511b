/* Light on its way to single pixels at single times (points.h): each lane has a list of its own, in an order of its own, so
 * that what soft_order.h and compositing.h know of a splat for all pixels at once has a value per lane here. */
#ifndef TD_POINT_LIGHT_H
#define TD_POINT_LIGHT_H

#include "point_splats.h"
#include "soft_order.h"

/* Light on its way to the points: T, Y; of the splats that take out light now A and B (soft_order.h). */
typedef struct td_point_light {
    td_lanes t, t_dot, y, y_dot;
    td_lanes a, a_dot, b, b_dot;
} td_point_light;

/* Hard order (td_blend_alpha). */
TD_INLINE td_point_light td_point_hard(const td_point_light *light, const td_point_entry *splat) {
    td_point_light on = *light;
    td_lanes w = light->t * splat->tau, w_dot = td_fma(light->t, splat->tau_dot, light->t_dot * splat->tau);
    on.y = td_fma(w, splat->luminance, light->y);
    on.y_dot = td_fma(w_dot, splat->luminance, td_fma(w, splat->luminance_dot, light->y_dot));
    on.t = light->t - w;
    on.t_dot = light->t_dot - w_dot;
    return on;
}

/* Soft order: the splat begins to take out light, and that goes on to the next, where it is near, or to its end (td_blend_soft,
 * with a way to the next for each lane). */
TD_INLINE td_point_light td_point_soft(const td_image *image, const td_point_light *light, const td_point_entry *splat,
                                       const td_point_entry *next, td_mask near) {
    const td_real log2_e = TD_REAL(1.44269504088896340736);
    td_lanes none = td_splat(0.0f), gap = next->depth - splat->depth, both = next->depth + splat->depth;
    td_lanes u = td_select(none, gap / both, near), square = u * u;
    td_lanes rest = td_fma(square, td_fma(square, TD_REAL(0.14285714285714286), TD_REAL(0.2)), TD_REAL(0.33333333333333333));
    td_real scale = 1 / image->soft_depth;
    td_lanes x = 2 * td_fma(u * square, rest, u) * scale;
    td_lanes x_dot = (next->growth - splat->growth) * scale;
    td_lanes m = td_select(td_splat(1.0f), td_soft_taken(x), near), left = td_select(none, 1 - m, near);
    td_lanes m_dot = td_select(none, left * x_dot, near), a, a_dot;
    td_optical_depth(splat->tau, splat->tau_dot, &a, &a_dot);
    td_point_light on = *light;
    td_lanes density = light->a + a, density_dot = light->a_dot + a_dot;
    td_lanes colour = td_fma(a, splat->luminance, light->b);
    td_lanes colour_dot = td_fma(a_dot, splat->luminance, td_fma(a, splat->luminance_dot, light->b_dot));
    td_lanes fall = td_exp2(density * m * -log2_e);
    on.t = light->t * fall;
    on.t_dot = td_fma(light->t_dot, fall, -on.t * td_fma(density_dot, m, density * m_dot));
    td_lanes inverse = 1 / (density + TD_REAL(1e-20));
    td_lanes w = (light->t - on.t) * inverse;
    td_lanes w_dot = td_fma(-w, density_dot, light->t_dot - on.t_dot) * inverse;
    on.y = td_fma(w, colour, light->y);
    on.y_dot = td_fma(w_dot, colour, td_fma(w, colour_dot, light->y_dot));
    left = td_select(none, left, density * left > TD_REAL(1e-20)); /* next to nothing is nothing (td_soft_clear) */
    m_dot = td_select(none, m_dot, left != 0.0f);
    on.a = density * left;
    on.a_dot = td_fma(density_dot, left, density * -m_dot);
    on.b = colour * left;
    on.b_dot = td_fma(colour_dot, left, colour * -m_dot);
    return on;
}

TD_INLINE td_point_light td_point_choose(const td_point_light *otherwise, const td_point_light *then, td_mask mask) {
    td_point_light light;
    light.t = td_select(otherwise->t, then->t, mask), light.t_dot = td_select(otherwise->t_dot, then->t_dot, mask);
    light.y = td_select(otherwise->y, then->y, mask), light.y_dot = td_select(otherwise->y_dot, then->y_dot, mask);
    light.a = td_select(otherwise->a, then->a, mask), light.a_dot = td_select(otherwise->a_dot, then->a_dot, mask);
    light.b = td_select(otherwise->b, then->b, mask), light.b_dot = td_select(otherwise->b_dot, then->b_dot, mask);
    return light;
}

/* Blends a splat: in hard order where nobody is near. */
TD_INLINE void td_point_blend(const td_image *image, const td_point_entry *splat, const td_point_entry *next, td_mask followed,
                              td_point_light *light) {
    td_point_light hard = td_point_hard(light, splat);
    td_mask near = followed & td_is_near(image, splat->depth, next->depth), soft = near | (light->a != 0.0f);
    if (!image->soft_order || !td_any(soft)) {
        *light = hard;
        return;
    }
    td_point_light other = td_point_soft(image, light, splat, next, near);
    *light = td_point_choose(&hard, &other, soft);
}

/* All splats that the points see, front to back; `most` in any lane, the entry of nothing is number `nothing`. */
TD_INLINE td_point_light td_point_composite(const td_image *image, const td_point_room *room, int most, int nothing) {
    td_lanes none = td_splat(0.0f);
    td_point_light light = {td_splat(1.0f), none, none, none, none, none, none, none};
    if (most == 0) return light;
    td_point_entry splat = td_point_fetch(room, room->order);
    for (int j = 0; j < most; j++) {
        TD_GLOBAL const int *behind = room->order + (j + 1) * TD_LANES;
        td_point_entry next = td_point_fetch(room, behind);
        td_point_blend(image, &splat, &next, td_load_ints(behind) != nothing, &light);
        splat = next;
    }
    return light;
}

#endif
