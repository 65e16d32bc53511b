/* One work-item's share of a tile job. It blends the job's list of splats over TD_LANES pixels of one 4x4 block, and stores
 * these pixels' values in the job's output planes. */
#ifndef TD_BLOCK_H
#define TD_BLOCK_H

#include "decoder.h"
#include "soft_order.h"

/* Column and row within a 4x4 block of TD_LANES pixels, in row-major order from pixel `first` on. */
TD_INLINE void td_block_offsets(int first, td_lanes *x, td_lanes *y) {
    (void)first; /* unused with sixteen lanes, which are the whole block: `first` is 0 */
#if TD_LANES == 16
    *x = (td_lanes)(0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3);
    *y = (td_lanes)(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3);
#elif TD_LANES == 8
    *x = (td_lanes)(0, 1, 2, 3, 0, 1, 2, 3);
    *y = (td_lanes)(0, 0, 0, 0, 1, 1, 1, 1) + (td_real)(first >> 2);
#elif TD_LANES == 4
    *x = (td_lanes)(0, 1, 2, 3);
    *y = (td_lanes)((td_real)(first >> 2));
#else
    *x = (td_real)(first & 3);
    *y = (td_real)(first >> 2);
#endif
}

/* Splats of a batch: their alphas are computed before the first of them is blended. A batch has at most eight splats, because
 * td_look_ahead checks after every eighth one whether the list can end. */
enum { TD_BATCH = TD_LANES < 8 ? TD_LANES : 8 };

/* Computes tau, tau_dot and `wanted` for a batch. `wanted` is the transmittance that must be left behind a splat for it to
 * be blended, -1 where the pixel doesn't see the splat. Three short loops take less time than one long loop: the processor's
 * reorder window is about 100 operations, and in a short loop these belong to more splats, which don't wait for each other. */
TD_INLINE void td_batch_alphas(const td_list *list, const td_image *image, const int *row, int count,
                               const td_composite *pixels, td_lanes *tau, td_lanes *tau_dot, td_lanes *wanted) {
    td_lanes power[TD_BATCH], rate[TD_BATCH], alpha[TD_BATCH];
    for (int k = 0; k < count; k++) td_splat_power(td_list_record(list, row[k]), pixels, power + k, rate + k);
    for (int k = 0; k < count; k++) alpha[k] = td_exp2(power[k]);
    for (int k = 0; k < count; k++) td_splat_tau(image, alpha[k], rate[k], tau + k, tau_dot + k, wanted + k);
}

/* Optical depths `a` and their rates for the splats of a batch that are blended in soft order. Splat k is one of them if the
 * next splat is near in depth (near[k]), or if the splat before it has a near next one (near[k - 1]; `open` for splat 0). */
TD_INLINE void td_batch_depths(const int *near, int open, int count, const td_lanes *tau, const td_lanes *tau_dot, td_lanes *a,
                               td_lanes *a_dot) {
    for (int k = 0; k < count; k++) {
#if TD_LANES == 1
        a[k] = a_dot[k] = 0; /* for compilers that can't see that values of the other splats aren't read */
#endif
        if (near[k] | open) td_optical_depth(tau[k], tau_dot[k], a + k, a_dot + k);
        open = near[k];
    }
}

/* Adds one splat to one colour channel, which is entry c of its colour. In soft order the splat joins the splats that take out
 * light now, and the channel gets their common light as far as the next splat. In hard order the channel gets the light of this
 * splat alone. */
TD_INLINE void td_blend_channel(TD_GLOBAL const td_real *colour, int c, int is_soft, const td_shown *shown, td_lanes a,
                                td_lanes a_dot, td_real left, td_real m_dot, td_channel *channel) {
    td_lanes value = td_splat(colour[c]), rate = td_splat(colour[3 + c]);
    if (is_soft) {
        td_channel_show(a, a_dot, value, rate, &channel->b, &channel->b_dot);
        td_channel_go(shown->w, shown->w_dot, td_splat(left), td_splat(m_dot), channel);
    } else {
        td_channel_show(shown->w, shown->w_dot, value, rate, &channel->y, &channel->y_dot);
    }
}

/* Blends splats [first, first + count) of a group. In soft order, a splat without a neighbour near in depth is blended as
 * in hard order. */
TD_INLINE void td_blend_batch(const td_list *list, const td_image *image, const td_group *group, int first, int count,
                              const td_soft_steps *steps, td_soft *soft, td_channels *channels, td_composite *pixels) {
    td_lanes tau[TD_BATCH], tau_dot[TD_BATCH], wanted[TD_BATCH], a[TD_BATCH], a_dot[TD_BATCH];
    td_batch_alphas(list, image, group->row + first, count, pixels, tau, tau_dot, wanted);
    if (td_soft_order(image)) td_batch_depths(steps->near + first, soft->open, count, tau, tau_dot, a, a_dot);
    for (int k = 0; k < count; k++) {
        TD_GLOBAL const td_real *record = td_list_record(list, group->row[first + k]);
        TD_GLOBAL const td_real *colour = td_list_colour(list, image, group->row[first + k]);
        td_mask on = pixels->live;
        td_shown shown;
        if (td_soft_order(image)) on = td_soft_admit(image, wanted[k], pixels, tau + k, tau_dot + k);
        const int is_soft = td_soft_order(image) && (soft->open | steps->near[first + k]);
        if (is_soft && td_drops_splats(image)) {
            a[k] = td_select(td_splat(0.0f), a[k], on);
            a_dot[k] = td_select(td_splat(0.0f), a_dot[k], on);
        }
        if (is_soft)
            shown = td_blend_soft(record, colour, image, steps, first + k, a[k], a_dot[k], soft, pixels);
        else
            shown = td_blend_alpha(record, colour, image, tau[k], tau_dot[k], wanted[k], pixels);
        if (!td_by_channels(image)) continue;
        const td_real left = is_soft ? steps->left[first + k] : 0, m_dot = is_soft ? steps->m_dot[first + k] : 0;
        const td_lanes density = is_soft ? a[k] : shown.w, density_dot = is_soft ? a_dot[k] : shown.w_dot;
        td_blend_channel(colour, 0, is_soft, &shown, density, density_dot, left, m_dot, &channels->red);
        td_blend_channel(colour, 1, is_soft, &shown, density, density_dot, left, m_dot, &channels->green);
        td_blend_channel(colour, 2, is_soft, &shown, density, density_dot, left, m_dot, &channels->blue);
    }
}

/* Blends the splats that touch `block`, in hard or soft depth order; the list ends early where the stop rule says so.
 * Returns the number of splats blended. */
TD_INLINE int td_composite_list(const td_list *list, const td_image *image, int block, td_channels *channels,
                                td_composite *pixels) {
    int blended = 0;
    td_finder finder;
    td_group group;
    td_soft soft;
    td_soft_steps steps;
    td_soft_start(&soft, image);
    td_finder_start(list, block, &finder);
    for (td_next_group(list, image, block, &finder, &group); group.count > 0;
         td_next_group(list, image, block, &finder, &group)) {
        if (td_soft_order(image)) td_soft_measure(list, image, &group, &steps);
        for (int first = 0; first < group.count; first += TD_BATCH) {
            int left = group.count - first, count = left < TD_BATCH ? left : TD_BATCH;
            td_blend_batch(list, image, &group, first, count, &steps, &soft, channels, pixels);
            blended += count;
            if ((blended & 7) != 0) continue;
            if (!td_look_ahead(image, list->brightest, channels, pixels)) return blended;
            if (td_soft_order(image)) td_soft_clear(image, &soft, channels);
        }
    }
    return blended;
}

/* Composites pixels [first, first + TD_LANES) of block `block` (0..15) of a job. `out` is the place of pixel `first` in the
 * block's first plane; each further plane begins TD_BLOCK_PIXELS values later. Returns the number of splats blended. */
TD_INLINE int td_composite_block(const td_job *job, const td_list *list, const td_image *image,
                                 TD_GLOBAL const td_backdrop *backdrop, int block, int first, TD_GLOBAL td_real *out) {
    td_lanes x, y;
    td_block_offsets(first, &x, &y);
    x = x + ((td_real)(job->x + 4 * (block & 3)) + 0.5f);
    y = y + ((td_real)(job->y + 4 * (block >> 2)) + 0.5f);
    td_composite pixels;
    td_composite_start(&pixels, x, y, image);
    td_channels channels = td_channels_dark();
    int blended = td_composite_list(list, image, block, &channels, &pixels);
    pixels.transmittance = pixels.transmittance + pixels.stopped;
    pixels.transmittance_dot = pixels.transmittance_dot + pixels.stopped_dot;
    td_lanes signal[3];
    td_composite shown = pixels;
    if (td_with_decoder(image)) shown = td_develop(image, list->view, list->weights, &pixels);
    td_lanes channel[6];
    if (td_is_coded(image) || td_with_colour(image)) td_finish_channels(image, &shown, &channels, backdrop, channel);
    if (td_is_coded(image))
        td_finish_coded(image, channel, signal);
    else
        td_finish_signal(&shown, backdrop->luminance, backdrop->luminance_dot, image->log_eps, signal);
    if (!td_with_rates(image)) { /* Y alone is stored; compilers drop the computation of the rest */
        td_store_lanes(out, signal[2]);
        return blended;
    }
    td_store_lanes(out + TD_OUT_L * TD_BLOCK_PIXELS, signal[0]);
    td_store_lanes(out + TD_OUT_L_DOT * TD_BLOCK_PIXELS, signal[1]);
    if (td_outputs(image) > TD_OUT_Y) td_store_lanes(out + TD_OUT_Y * TD_BLOCK_PIXELS, signal[2]);
    if (td_with_diagnostics(image)) {
        td_store_lanes(out + TD_OUT_ALPHA * TD_BLOCK_PIXELS, 1 - pixels.transmittance);
        td_store_lanes(out + TD_OUT_ALPHA_DOT * TD_BLOCK_PIXELS, -pixels.transmittance_dot);
        td_store_lanes(out + TD_OUT_COVERAGE * TD_BLOCK_PIXELS, pixels.sums.weight);
        td_store_lanes(out + TD_OUT_CONTRIBUTORS * TD_BLOCK_PIXELS, pixels.contributors);
    }
    if (td_with_colour(image)) {
        td_lanes depth[2];
        td_finish_depth(&shown, depth);
        for (int c = 0; c < 6; c++) td_store_lanes(out + (TD_OUT_R + c) * TD_BLOCK_PIXELS, channel[c]);
        td_store_lanes(out + TD_OUT_Z * TD_BLOCK_PIXELS, depth[0]);
        td_store_lanes(out + TD_OUT_Z_DOT * TD_BLOCK_PIXELS, depth[1]);
    }
    return blended;
}

#endif
