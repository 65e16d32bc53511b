/* Internal: swaps of depth as a pixel's signal sees them: places where its model may be off, for step control and look-ups. */
#ifndef TD_SWAPPED_H
#define TD_SWAPPED_H

#include "render/td_render.h"
#include "signal/td_signals.h"
#include "td_refine.h"

/* A swap of depth in a step: its middle `s`, its half-width `wide` [steps], and the change of Y that it makes. */
typedef struct td_swap_place {
    double s, wide, light;
} td_swap_place;

/* td_solve_swaps: swaps that a pixel of the step's unit may see, within a step's length of it: (count), in order of time.
 * td_solve_swap_place: a swap's place in the step. */
const td_swap *td_solve_swaps(const tides_simulator *s, const td_refine_step *step, int32_t local, int *count);
td_swap_place td_solve_swap_place(const tides_simulator *s, const td_refine_step *step, const td_swap *swap);

/* The share of a swap that a cubic through both its ends doesn't show, `wide` cubics' lengths to either side of its middle. All
 * of a short one; of a long one what a kink of the curvature leaves, by the square of how fast the depths pass. A cubic misses
 * at most 0.17, 0.057, 0.016 of a swap of two faint splats, for `wide` 1, 2, 4, wherever in the cubic it is; of two of
 * optical depth 1 0.25, 0.10, 0.034. Two opaque ones change within a shorter time, and more is missed: up to 0.9, 0.36, 0.18,
 * which their looks must show. */
static inline double td_solve_swap_unseen(double wide) {
    const double left = 0.3 / (wide * wide);
    return left < 1 ? left : 1;
}

/* How far unseen light of swaps moves log_luminance, where that is S or more. */
double td_solve_moved_by(const tides_simulator *s, double light, double S);

/* The light of those of `count` swaps that don't show in the step's samples, all together. td_solve_widen_swapped adds how far
 * it may move log_luminance between these to `widen` of each of the unit's pixels. */
double td_solve_unseen_light(const tides_simulator *s, const td_refine_step *step, const td_swap *swap, int count);
void td_solve_widen_swapped(const tides_simulator *s, const td_refine_step *step, const td_signals *signals, double *widen);

#endif
