/* Composites the splats that points see. Lanes are points, single pixels at single times. Each lane has its own depth order, so
 * that distances in depth, which all pixels of a tile share elsewhere, are vectors here. */
#ifndef TD_POINT_LIGHT_H
#define TD_POINT_LIGHT_H

#include "point_splats.h"

/* Light on its way to the points: T, the density A, and luminance, or red, green and blue where light isn't linear in
 * colours. */
typedef struct td_point_light {
    td_lanes t, t_dot, a, a_dot;
    td_channel first, green, blue;
} td_point_light;

/* Blends a splat in hard order. */
TD_INLINE void td_point_hard(const td_image *image, const td_point_entry *splat, td_point_light *light) {
    td_lanes tau = splat->takes, w = light->t * tau, w_dot = td_fma(light->t, splat->takes_dot, light->t_dot * tau);
    td_channel_show(w, w_dot, splat->luminance, splat->luminance_dot, &light->first.y, &light->first.y_dot);
    if (td_is_coded(image)) {
        td_channel_show(w, w_dot, splat->green, splat->green_dot, &light->green.y, &light->green.y_dot);
        td_channel_show(w, w_dot, splat->blue, splat->blue_dot, &light->blue.y, &light->blue.y_dot);
    }
    light->t = light->t - w;
    light->t_dot = light->t_dot - w_dot;
}

/* The last splat that each lane saw. */
typedef struct td_point_last {
    td_lanes depth, growth;
} td_point_last;

/* An entry's depth and growth are replaced by the distance m = 1 - exp(-x) from the splat in front, and its rate. Where that
 * splat isn't near, m = 1 and its rate 0: all its light is taken. Where the point doesn't see the splat, both are 0. */
enum { TD_E_M = TD_E_DEPTH, TD_E_M_DOT = TD_E_GROWTH };

TD_INLINE void td_point_measure(const td_image *image, TD_GLOBAL td_real *entry, td_point_last *last) {
    td_lanes none = td_splat(0.0f), one = td_splat(1.0f);
    td_lanes depth = td_load_lanes(entry + TD_E_DEPTH * TD_LANES), growth = td_load_lanes(entry + TD_E_GROWTH * TD_LANES);
    td_mask sees = td_load_lanes(entry + TD_E_TAKES * TD_LANES) != none;
    td_mask near = sees & td_is_near(image, last->depth, depth);
    td_lanes gap = depth - last->depth, both = td_select(one, depth + last->depth, near);
    td_lanes u = td_select(none, gap / both, near), square = u * u;
    td_lanes rest = td_fma(square, td_fma(square, TD_REAL(0.14285714285714286), TD_REAL(0.2)), TD_REAL(0.33333333333333333));
    td_real scale = 1 / image->soft_depth;
    td_lanes m = td_select(one, td_soft_taken(2 * td_fma(u * square, rest, u) * scale), near);
    td_lanes m_dot = td_select(none, (1 - m) * ((growth - last->growth) * scale), near);
    td_store_lanes(entry + TD_E_M * TD_LANES, td_select(none, m, sees));
    td_store_lanes(entry + TD_E_M_DOT * TD_LANES, m_dot);
    last->depth = td_select(last->depth, depth, sees);
    last->growth = td_select(last->growth, growth, sees);
}

/* Soft order: light passes a distance m, and densities fall. Where m is 0 all values stay, to the bit. */
TD_INLINE void td_point_go(const td_image *image, td_lanes m, td_lanes m_dot, td_point_light *light) {
    const td_real log2_e = TD_REAL(1.44269504088896340736), tiny = TD_REAL(1e-20);
    td_lanes none = td_splat(0.0f), left = 1 - m, a = light->a, a_dot = light->a_dot;
    td_lanes fall = td_exp2(a * m * -log2_e), t = light->t * fall;
    td_lanes t_dot = td_fma(light->t_dot, fall, -t * td_fma(a_dot, m, a * m_dot));
    td_lanes inverse = 1 / (a + tiny);
    td_lanes w = (light->t - t) * inverse, w_dot = td_fma(-w, a_dot, light->t_dot - t_dot) * inverse;
    light->t = t, light->t_dot = t_dot;
    td_mask on = (a * left > tiny) | (m == 0.0f); /* negligible densities become 0 */
    left = td_select(none, left, on), m_dot = td_select(none, m_dot, on);
    light->a = a * left, light->a_dot = td_fma(a_dot, left, a * -m_dot);
    td_channel_go(w, w_dot, left, m_dot, &light->first);
    if (!td_is_coded(image)) return;
    td_channel_go(w, w_dot, left, m_dot, &light->green);
    td_channel_go(w, w_dot, left, m_dot, &light->blue);
}

/* A splat begins to take light from a channel. A splat without a near neighbour is treated likewise: the result is that of hard
 * order, except for rounding. */
TD_INLINE void td_point_begin_channel(TD_GLOBAL const td_real *entry, int k, td_lanes takes, td_lanes takes_dot,
                                      td_channel *of) {
    td_lanes value = td_load_lanes(entry + k * TD_LANES), rate = td_load_lanes(entry + (k + 1) * TD_LANES);
    td_channel_show(takes, takes_dot, value, rate, &of->b, &of->b_dot);
}
TD_INLINE void td_point_begin(const td_image *image, TD_GLOBAL const td_real *entry, td_point_light *light) {
    td_lanes takes = td_load_lanes(entry + TD_E_TAKES * TD_LANES);
    td_lanes takes_dot = td_load_lanes(entry + TD_E_TAKES_DOT * TD_LANES);
    light->a = light->a + takes, light->a_dot = light->a_dot + takes_dot;
    td_point_begin_channel(entry, TD_E_LUMINANCE, takes, takes_dot, &light->first);
    if (!td_is_coded(image)) return;
    td_point_begin_channel(entry, TD_E_GREEN, takes, takes_dot, &light->green);
    td_point_begin_channel(entry, TD_E_BLUE, takes, takes_dot, &light->blue);
}

/* Composites all that the points see, front to back. Distances don't depend on one another, so that their loop runs ahead,
 * TD_POINT_BATCH entries at a time. */
TD_INLINE td_point_light td_point_composite(const td_image *image, TD_GLOBAL td_real *entries, int count) {
    td_lanes none = td_splat(0.0f);
    const td_channel dark = td_channel_dark();
    td_point_light light = {td_splat(1.0f), none, none, none, dark, dark, dark};
    const int room = td_point_room(image);
    td_point_last last = {none, none};
    if (!td_soft_order(image)) {
        for (int j = 0; j < count; j++) {
            td_point_entry splat = td_point_load_entry(image, entries + j * room);
            td_point_hard(image, &splat, &light);
        }
        return light;
    }
    for (int j = 0; j < count; j++) td_point_measure(image, entries + j * room, &last);
    for (int j = 0; j < count; j++) {
        TD_GLOBAL const td_real *entry = entries + j * room;
        td_point_go(image, td_load_lanes(entry + TD_E_M * TD_LANES), td_load_lanes(entry + TD_E_M_DOT * TD_LANES), &light);
        td_point_begin(image, entry, &light);
    }
    td_point_go(image, td_splat(1.0f), none, &light);
    return light;
}

/* The background, which doesn't change in time: luminance, or red, green and blue. */
typedef struct td_point_backdrop {
    td_real first, first_dot, green, blue;
} td_point_backdrop;

/* L, L_dot and Y over the background. */
TD_INLINE void td_point_finish(const td_image *image, const td_point_light *light, const td_point_backdrop *behind,
                               td_lanes planes[3]) {
    td_lanes t = light->t, t_dot = light->t_dot, channel[6], growth;
    td_lanes y = td_fma(t, behind->first, light->first.y);
    td_lanes y_dot = td_fma(t_dot, behind->first, td_fma(t, behind->first_dot, light->first.y_dot));
    if (!td_is_coded(image)) {
        td_finish_luminance(y, y_dot, image->log_eps, planes);
        return;
    }
    const td_channel *green = &light->green, *blue = &light->blue;
    channel[0] = td_light_of(image, y, &growth);
    channel[3] = growth * y_dot;
    td_channel_light(image, t, t_dot, green->y, green->y_dot, behind->green, 0, channel + 1, channel + 4);
    td_channel_light(image, t, t_dot, blue->y, blue->y_dot, behind->blue, 0, channel + 2, channel + 5);
    td_finish_coded(image, channel, planes);
}

#endif
