/* Light on its way to single pixels at single times (points.h): each lane has a list of its own, in an order of its own, so
 * that what soft_order.h and compositing.h know of a splat for all pixels at once has a value per lane here. */
#ifndef TD_POINT_LIGHT_H
#define TD_POINT_LIGHT_H

#include "point_splats.h"

/* Light on its way to the points: T, Y; of the splats that take out light now A and B (soft_order.h). */
typedef struct td_point_light {
    td_lanes t, t_dot, y, y_dot;
    td_lanes a, a_dot, b, b_dot;
} td_point_light;

/* Hard order (td_blend_alpha). */
TD_INLINE void td_point_hard(const td_point_entry *splat, td_point_light *light) {
    td_lanes tau = splat->takes, w = light->t * tau, w_dot = td_fma(light->t, splat->takes_dot, light->t_dot * tau);
    light->y = td_fma(w, splat->luminance, light->y);
    light->y_dot = td_fma(w_dot, splat->luminance, td_fma(w, splat->luminance_dot, light->y_dot));
    light->t = light->t - w;
    light->t_dot = light->t_dot - w_dot;
}

/* A splat of each lane, and the way to the next: where that is near, m = 1 - exp(-x) and its rate (td_soft_steps), else to the
 * end of what it takes, 1 and 0. */
enum { TD_S_TAKES = 0, TD_S_TAKES_DOT, TD_S_LUMINANCE, TD_S_LUMINANCE_DOT, TD_S_M, TD_S_M_DOT };

TD_INLINE void td_point_measure(const td_image *image, const td_point_entry *splat, const td_point_entry *next,
                                td_mask followed, TD_GLOBAL td_real *step) {
    td_lanes none = td_splat(0.0f), one = td_splat(1.0f);
    td_lanes gap = next->depth - splat->depth, both = td_select(one, next->depth + splat->depth, followed);
    td_mask near = followed & td_is_near(image, splat->depth, next->depth);
    td_lanes u = td_select(none, gap / both, near), square = u * u;
    td_lanes rest = td_fma(square, td_fma(square, TD_REAL(0.14285714285714286), TD_REAL(0.2)), TD_REAL(0.33333333333333333));
    td_real scale = 1 / image->soft_depth;
    td_lanes m = td_select(one, td_soft_taken(2 * td_fma(u * square, rest, u) * scale), near);
    td_lanes m_dot = td_select(none, (1 - m) * ((next->growth - splat->growth) * scale), near);
    td_store_lanes(step + TD_S_TAKES * TD_LANES, splat->takes);
    td_store_lanes(step + TD_S_TAKES_DOT * TD_LANES, splat->takes_dot);
    td_store_lanes(step + TD_S_LUMINANCE * TD_LANES, splat->luminance);
    td_store_lanes(step + TD_S_LUMINANCE_DOT * TD_LANES, splat->luminance_dot);
    td_store_lanes(step + TD_S_M * TD_LANES, m);
    td_store_lanes(step + TD_S_M_DOT * TD_LANES, m_dot);
}

/* Soft order: the splat begins to take out light, and that goes on to the next (td_blend_soft, with a way to the next for each
 * lane). A splat with nobody near is of this too, but for rounding. */
TD_INLINE void td_point_soft(TD_GLOBAL const td_real *step, td_point_light *light) {
    const td_real log2_e = TD_REAL(1.44269504088896340736), tiny = TD_REAL(1e-20);
    td_lanes none = td_splat(0.0f);
    td_lanes a = td_load_lanes(step + TD_S_TAKES * TD_LANES), a_dot = td_load_lanes(step + TD_S_TAKES_DOT * TD_LANES);
    td_lanes luminance = td_load_lanes(step + TD_S_LUMINANCE * TD_LANES);
    td_lanes luminance_dot = td_load_lanes(step + TD_S_LUMINANCE_DOT * TD_LANES);
    td_lanes m = td_load_lanes(step + TD_S_M * TD_LANES), m_dot = td_load_lanes(step + TD_S_M_DOT * TD_LANES), left = 1 - m;
    td_lanes density = light->a + a, density_dot = light->a_dot + a_dot;
    td_lanes colour = td_fma(a, luminance, light->b);
    td_lanes colour_dot = td_fma(a_dot, luminance, td_fma(a, luminance_dot, light->b_dot));
    td_lanes fall = td_exp2(density * m * -log2_e), t = light->t * fall;
    td_lanes t_dot = td_fma(light->t_dot, fall, -t * td_fma(density_dot, m, density * m_dot));
    td_lanes inverse = 1 / (density + tiny);
    td_lanes w = (light->t - t) * inverse, w_dot = td_fma(-w, density_dot, light->t_dot - t_dot) * inverse;
    light->y = td_fma(w, colour, light->y);
    light->y_dot = td_fma(w_dot, colour, td_fma(w, colour_dot, light->y_dot));
    light->t = t, light->t_dot = t_dot;
    td_mask on = density * left > tiny; /* next to nothing is nothing (td_soft_clear) */
    left = td_select(none, left, on), m_dot = td_select(none, m_dot, on);
    light->a = density * left, light->a_dot = td_fma(density_dot, left, density * -m_dot);
    light->b = colour * left, light->b_dot = td_fma(colour_dot, left, colour * -m_dot);
}

/* All splats that the points see, front to back; `most` in any lane. Steps don't depend on one another: they have a loop of
 * their own (TD_POINT_BATCH). */
TD_INLINE td_point_light td_point_composite(const td_image *image, const td_point_room *room, int most) {
    td_lanes none = td_splat(0.0f);
    td_point_light light = {td_splat(1.0f), none, none, none, none, none, none, none};
    td_point_entry splat = td_point_fetch(room, room->order);
    for (int j = 0; j < most; j++) {
        TD_GLOBAL const int *behind = room->order + (j + 1) * TD_LANES;
        td_point_entry next = td_point_fetch(room, behind);
        if (image->soft_order)
            td_point_measure(image, &splat, &next, td_load_ints(behind) != 0, room->steps + j * (TD_POINT_STEP * TD_LANES));
        else
            td_point_hard(&splat, &light);
        splat = next;
    }
    if (!image->soft_order) return light;
    for (int j = 0; j < most; j++) td_point_soft(room->steps + j * (TD_POINT_STEP * TD_LANES), &light);
    return light;
}

#endif
