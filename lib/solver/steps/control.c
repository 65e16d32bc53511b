/* Step control: which steps of a refinement level are too long, by
 *
 *   error   the estimated error of the model, against tolerance C and time_tolerance_s; and a whole macro step, which has
 *           not been probed yet
 *   risk    the paper's score of mixed visibility, against the step's share of the macro step (paper, Eq. 13)
 *   travel  in both modes: a splat that could pass a pixel between two samples
 *
 * Each gives the factor by which the step exceeds its limit, and the largest decides. Without `local` a unit whose step is too
 * long cuts those of all units. refine.c makes the steps. */
#include "td_extremes.h"
#include "sensor/td_between.h"
#include "solver/td_simulator.h"

#include <math.h>
#include <stdlib.h>

/* Diameters that a splat may travel between two samples: within half of one, it is seen by every pixel that it passes. */
static const double most_travel = 0.5;

/* A deviation counts as rounding up to rounding_seen times the rounding of S, computed from three samples with their rates. A
 * deviation that doesn't fall from one cut to the next counts as rounding up to rounding_most: pixels with much light hidden by
 * splats in front have that much. A larger one is a jump of the image, and shorter steps place that better. */
static const double rounding_seen = 2, rounding_most = 50, falls = 0.5;

static const double unseen = 1.000001;      /* excess of a step that hasn't been probed: any above 1 */
static const double most_contributors = 64; /* splats under a pixel at which the risk's norm(c) is 1 */
static const double least_share = 1.0 / 32; /* of the macro step, that a unit of risk 1 may take at once */

/* The largest risk score of a unit's pixels: w_b (1 - b) + w_c norm(c) + w_alpha norm(|alpha_dot|), clipped to [0, 1].
 * norm(c) = c / 64, norm(|alpha_dot|) = the opacity that would change within the longest step, both at most 1. */
double td_unit_risk(const tides_simulator *s, const td_tile *tile, const double *planes) {
    double most = 0;
    for (int y = 0, i = 0; i < tile->count; y++)
        for (int x = 0; x < tile->width; x++, i++) {
            int at = td_unit_pixel(tile, x, y);
            double b = planes[TD_OUT_COVERAGE * TD_TILE_PIXELS + at];
            double c = td_lesser(planes[TD_OUT_CONTRIBUTORS * TD_TILE_PIXELS + at] / most_contributors, 1);
            double a = td_lesser(fabs(planes[TD_OUT_ALPHA_DOT * TD_TILE_PIXELS + at]) * s->given.step_s, 1);
            most = td_greater(most, s->given.risk.w_b * (1 - b) + s->given.risk.w_c * c + s->given.risk.w_alpha * a);
        }
    return td_lesser(most, 1);
}

/* kappa(r): the share of the macro step that a unit of risk r may take at once, from 1 at r = 0 to 1/32 at r = 1. */
static double step_factor(double risk) { return 1 / (1 + (1 / least_share - 1) * risk); }

/* 1 where the last two cuts left the deviation unchanged. That of a kink falls with the step, on average to a half each
 * time. */
static int is_rounding(const tides_simulator *s, const td_refine_step *step, double threshold) {
    return step->deviation * threshold <= rounding_most * s->done.timing.rounding && step->past[1] > 0 &&
           step->deviation > falls * step->past[1];
}

/* Estimates the error, and says how far it is above its limits. */
static double error_excess(const tides_simulator *s, td_refine_step *step, double start, double stop) {
    const td_refine *r = &s->refine;
    const double *begin = td_sample_at(&r->samples, step->begin), *end = td_sample_at(&r->samples, step->end);
    const td_signals signals = {begin, begin + r->samples.pixels, end, end + r->samples.pixels};
    const double from = td_refine_time(r, start, stop, step->from),
                 *references = r->early ? r->reference : s->sensor.pixels.reference;
    size_t first = s->layout.first_pixel[step->unit];
    /* Where pixels are coupled, each one's error affects all others, so that all pixels count. */
    const td_estimated judged = {td_refine_time(r, start, stop, step->to) - from,
                                 &signals,
                                 s->given.coupled ? NULL : references + first,
                                 step->probe < 0 ? NULL : td_sample_deviation(&r->samples, step->probe),
                                 rounding_seen * s->done.timing.rounding,
                                 s->layout.unit[step->unit].count};
    td_estimate estimate = td_sensor_estimate(&s->sensor, &judged, first, step->cuts, from * 1e9);
    double threshold = td_sensor_least_threshold(&s->sensor.sensor);
    step->error = estimate.error / threshold;
    step->deviation = estimate.deviation / threshold;
    step->rounded = estimate.rounded / threshold;
    const int asks_time = s->given.time_tolerance_s > 0 && !s->solve.on; /* with look-ups, steps don't decide times */
    double excess = is_rounding(s, step, threshold) ? 0 : step->error / s->given.tolerance;
    if (asks_time && excess > 0) excess = td_greater(excess, estimate.seconds / s->given.time_tolerance_s);
    return td_greater(excess, estimate.crossings / s->sensor.sensor.max_events_per_step);
}

/* Judges a step. A step that is too short to be cut is accepted whatever the measures say. */
void td_control_judge(const tides_simulator *s, td_refine_step *step, double start, double stop) {
    const td_refine *r = &s->refine;
    double share = (double)(step->to - step->from) / (double)((uint32_t)1 << r->depth);
    int may_cut = td_refine_may_cut(r, step), controls = s->given.mode == TIDES_STEPPING_ERROR;
    step->excess = share * td_units_travel(s, step->unit) / most_travel;
    if (controls) step->excess = td_greater(step->excess, error_excess(s, step, start, stop));
    if (controls && may_cut && step->probe < 0) step->excess = td_greater(step->excess, unseen);
    if (s->given.mode == TIDES_STEPPING_RISK) {
        double begin = *td_sample_risk(&r->samples, step->begin), end = *td_sample_risk(&r->samples, step->end);
        step->excess = td_greater(step->excess, share / step_factor(td_greater(begin, end)));
    }
    /* Swaps come last. Their cuts are at places that all units share, so that a tile's units are rendered together there. */
    step->swap = controls && may_cut && s->given.local && step->excess <= 1 ? td_refine_swap(s, step, &step->begins) : 0;
    if (step->swap) step->excess = unseen;
    step->open = (int16_t)(step->excess > 1 && may_cut);
}

static int by_position(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

/* Joins the steps of all units: where one unit cuts, all do. */
static tides_status join_units(td_refine *r, tides_error *error) {
    const size_t count = r->pending_count;
    uint32_t *wanted = td_alloc(count, sizeof *wanted, error);
    if (!wanted) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < count; i++) wanted[i] = r->step[r->pending[i]].from;
    qsort(wanted, count, sizeof *wanted, by_position);
    r->pending_count = 0;
    for (size_t i = 0; i < r->fresh_count; i++) {
        td_refine_step *step = &r->step[r->fresh[i]];
        if (!bsearch(&step->from, wanted, count, sizeof *wanted, by_position)) continue;
        step->open = 1;
        r->pending[r->pending_count++] = r->fresh[i];
    }
    free(wanted);
    return TIDES_OK;
}

tides_status td_control_steps(tides_simulator *s, tides_error *error) {
    td_refine *r = &s->refine;
    tides_status status = td_reserve((void **)&r->pending, &r->pending_capacity, r->fresh_count, sizeof *r->pending, error);
    if (status != TIDES_OK) return status;
    r->pending_count = 0;
    for (size_t i = 0; i < r->fresh_count; i++)
        if (r->step[r->fresh[i]].open) r->pending[r->pending_count++] = r->fresh[i];
    if (!s->given.local && r->pending_count > 0) status = join_units(r, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->open, &r->open_capacity, r->open_count + r->pending_count, sizeof *r->open, error);
    if (status != TIDES_OK) return status;
    if (r->pending_count == 0) return TIDES_OK; /* the list may not exist yet */
    memcpy(r->open + r->open_count, r->pending, r->pending_count * sizeof *r->open);
    r->open_count += r->pending_count;
    s->totals.here.steps_rejected += r->pending_count;
    return TIDES_OK;
}
