/* Cuts of steps because of swaps of depth. A step that is accepted otherwise may contain a swap too short to show in its
 * samples. It is cut where the swap begins and ends, and refined between. */
#include "td_extremes.h"
#include "sensor/td_between.h"
#include "solver/td_swapped.h"
#include "td_math.h"
#include "solver/td_simulator.h"

#include <math.h>

/* Swaps that change log_luminance by less than this are left to the samples: a share of a threshold, or of a tolerance where
 * that is larger. A choice: with lower limits blocks of a tile have more cuts of their own, which are rendered for one block
 * alone. */
static const double least_share = 0.05, share_of_tolerance = 0.5;

/* The least light of a unit at the macro step's start: exp(S). */
static double least_light(const tides_simulator *s, int32_t unit) {
    const double *S = s->now.plane[TD_PLANE_S] + s->layout.first_pixel[unit];
    double least = S[0];
    for (int i = 1; i < s->layout.unit[unit].count; i++) least = td_lesser(least, S[i]);
    return td_exp(least);
}

/* A unit of swaps' times, in units of steps' positions. */
static double part_of(const tides_simulator *s) { return (double)((uint32_t)1 << s->refine.depth) / TD_SWAP_PARTS; }

/* The first swap at `part` or later. */
static int find_swap(const td_swap *swap, int count, double part) {
    int low = 0, high = count;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (swap[middle].part < part)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* A swap that takes no less than this share of a step shows in its samples, like any smooth change. A choice. */
static const double shows = 0.25;

/* Where a step may be cut, in units of swaps' times, and the limits of swaps that count. best: the cut, below 0: none. */
typedef struct cuts {
    double least, most, wide, light, best;
    int begins; /* 1: a swap begins there, 0: it ends */
} cuts;

/* Finds the end of a block's swaps that is nearest to the step's middle. */
static void find_nearest(const td_swap *swap, int count, cuts *of) {
    const double middle = 0.5 * (of->least + of->most);
    for (int i = find_swap(swap, count, of->least - of->wide); i < count && swap[i].part <= of->most + of->wide; i++) {
        if ((double)swap[i].wide > of->wide || (double)swap[i].light < of->light) continue;
        for (int side = -1; side <= 1; side += 2) {
            const double at = swap[i].part + side * (double)swap[i].wide;
            if (at < of->least || at > of->most) continue;
            if (of->best < 0 || fabs(at - middle) < fabs(of->best - middle)) of->best = at, of->begins = side < 0;
        }
    }
}

uint32_t td_refine_swap(const tides_simulator *s, const td_refine_step *step, int32_t *begins) {
    const td_refine *r = &s->refine;
    const double part = part_of(s);
    cuts of = {.least = (step->from + (double)r->shortest) / part,
               .most = (step->to - (double)r->shortest) / part,
               .wide = shows * (step->to - step->from) / part,
               .light = -1,
               .best = -1};
    for (int block = 0; block < td_units_blocks(s); block++) {
        int count;
        const td_swap *swap = td_units_swaps(s, step->unit, block, &count);
        if (count > 0 && of.light < 0)
            of.light = td_greater(least_share, share_of_tolerance * s->given.tolerance) *
                       td_sensor_least_threshold(&s->sensor.sensor) *
                       td_renderer_swap_scale(s->renderer, least_light(s, step->unit));
        if (count > 0) find_nearest(swap, count, &of);
    }
    *begins = of.begins;
    return of.best < 0 ? 0 : (uint32_t)(of.best * part + 0.5);
}

/* -- looking at them ------------------------------------------------------------------------------------------------------- */

/* The block of a unit that contains one of its pixels. */
static int block_of(const tides_simulator *s, const td_refine_step *step, int32_t local) {
    const td_tile *unit = &s->layout.unit[step->unit];
    const int across = TD_TILE / TD_BLOCK, x = local % unit->width / TD_BLOCK, y = local / unit->width / TD_BLOCK;
    return td_units_blocks(s) > 1 ? y * across + x : 0;
}

/* The swaps of the block that contains a pixel of a unit. */
static const td_swap *swaps_of(const tides_simulator *s, const td_refine_step *step, int32_t local, int *count) {
    return td_units_swaps(s, step->unit, block_of(s, step, local), count);
}

const td_swap *td_solve_swaps(const tides_simulator *s, const td_refine_step *step, int32_t local, int *count) {
    int all;
    const td_swap *swap = swaps_of(s, step, local, &all);
    const double length = (double)step->to - step->from, part = part_of(s);
    const int first = find_swap(swap, all, (step->from - length) / part);
    *count = find_swap(swap, all, floor((step->to + length) / part) + 1) - first;
    return all > 0 ? swap + first : NULL;
}

td_swap_place td_solve_swap_place(const tides_simulator *s, const td_refine_step *step, const td_swap *swap) {
    const double part = part_of(s), length = (double)step->to - step->from;
    return (td_swap_place){(swap->part * part - step->from) / length, (double)swap->wide * part / length, (double)swap->light};
}

double td_solve_unseen_light(const tides_simulator *s, const td_refine_step *step, const td_swap *list, int count) {
    double squares = 0;
    for (int k = 0; k < count; k++) {
        const td_swap_place swap = td_solve_swap_place(s, step, &list[k]);
        if (!(swap.s + swap.wide > 0 && swap.s - swap.wide < 1)) continue;
        const double light = swap.light * td_solve_swap_unseen(swap.wide);
        squares += light * light;
    }
    return sqrt(squares);
}

double td_solve_moved_by(const tides_simulator *s, double light, double S) {
    return light > 0 ? light / td_renderer_swap_scale(s->renderer, td_exp(S)) : 0;
}

void td_solve_widen_swapped(const tides_simulator *s, const td_refine_step *step, const td_signals *signals, double *widen) {
    double light[TD_TILE_BLOCKS];
    for (int k = 0; k < TD_TILE_BLOCKS; k++) light[k] = -1; /* not known yet */
    for (int32_t i = 0; i < s->layout.unit[step->unit].count; i++) {
        double *own = &light[block_of(s, step, i)];
        int count;
        const td_swap *list = *own < 0 ? td_solve_swaps(s, step, i, &count) : NULL;
        if (*own < 0) *own = td_solve_unseen_light(s, step, list, count);
        widen[i] += td_solve_moved_by(s, *own, td_lesser(signals->S0[i], signals->S1[i]));
    }
}
