/* Step control: which steps of a refinement level are too long.
 *
 *   error   the estimated error of the model, against tolerance C and time_tolerance_s (estimate.c); and a whole macro step, in
 *           which nothing has been looked at
 *   risk    the paper's score of mixed visibility, against the step's share of the macro step (paper, Eq. 13)
 *   travel  in both modes: a splat that could pass a pixel between two samples (sweep.h)
 *
 * Each gives the factor by which the step is above its limit; the largest decides. Where a budget of renders is set and a level
 * asks for more, the steps furthest above their limits go first. Without `local` a tile whose step is too long cuts those of
 * all. For refine.c, which makes the steps; what errors are worth to a pixel the sensor says. */
#include "td_extremes.h"
#include "td_simulator.h"

#include <math.h>
#include <stdlib.h>

/* Diameters that a splat may travel between two samples: within half of one, none passes a pixel without being seen there. */
static const double most_travel = 0.5;

/* Deviations that are rounding: so many times what rounding does to S, from three samples with their rates; and what doesn't
 * fall from one cut to the next is, up to what pixels with much light hidden by much else were seen to have. Above it is a jump
 * of the image, which shorter steps do place better. */
static const double rounding_seen = 2, rounding_most = 50, falls = 0.5;

static const double unseen = 1.000001;      /* excess of a step that nothing has been compared with: any above 1 */
static const double most_contributors = 64; /* splats under a pixel at which the risk's norm(c) is 1 */
static const double least_share = 1.0 / 32; /* of the macro step, that a tile of risk 1 may take at once */

/* The largest risk score of a tile's pixels: w_b (1 - b) + w_c norm(c) + w_alpha norm(|alpha_dot|), clipped to [0, 1].
 * norm(c) = c / 64, norm(|alpha_dot|) = the opacity that would change within the longest step, both at most 1. */
double td_tile_risk(const tides_simulator *s, const td_tile *tile, const double *planes) {
    double most = 0;
    for (int y = 0, i = 0; i < tile->count; y++)
        for (int x = 0; x < tile->width; x++, i++) {
            int at = td_unit_pixel(tile, x, y);
            double b = planes[TD_OUT_COVERAGE * TD_TILE_PIXELS + at];
            double c = td_lesser(planes[TD_OUT_CONTRIBUTORS * TD_TILE_PIXELS + at] / most_contributors, 1);
            double a = td_lesser(fabs(planes[TD_OUT_ALPHA_DOT * TD_TILE_PIXELS + at]) * s->step_s, 1);
            most = td_greater(most, s->risk.w_b * (1 - b) + s->risk.w_c * c + s->risk.w_alpha * a);
        }
    return td_lesser(most, 1);
}

/* kappa(r): the share of the macro step that a tile of risk r may take at once, from 1 at r = 0 to 1/32 at r = 1. */
static double step_factor(double risk) { return 1 / (1 + (1 / least_share - 1) * risk); }

/* Have the last two cuts left the deviation as it was? A kink's falls with the step, on average to a half each time. */
static int is_rounding(const tides_simulator *s, const td_refine_step *step, double threshold) {
    return step->deviation * threshold <= rounding_most * s->timing.rounding && step->past[1] > 0 &&
           step->deviation > falls * step->past[1];
}

/* Estimates the error, and says how far it is above its limits. */
static double error_excess(tides_simulator *s, td_refine_step *step, double start, double stop) {
    const td_refine *r = &s->refine;
    const double *begin = td_sample_at(&r->samples, step->begin), *end = td_sample_at(&r->samples, step->end);
    const td_signals signals = {begin, begin + r->samples.pixels, end, end + r->samples.pixels};
    const double from = td_refine_time(r, start, stop, step->from),
                 *references = r->early ? r->reference : s->sensor.pixels.reference;
    size_t first = s->first_pixel[step->tile];
    /* Through a surround each pixel's error is everyone's: all count. */
    const td_estimated judged = {td_refine_time(r, start, stop, step->to) - from,
                                 &signals,
                                 s->surround.surround.on ? NULL : references + first,
                                 step->probe < 0 ? NULL : td_sample_deviation(&r->samples, step->probe),
                                 rounding_seen * s->timing.rounding,
                                 s->tile[step->tile].count};
    td_estimate estimate = td_sensor_estimate(&s->sensor, &judged, first, step->cuts, from * 1e9);
    double threshold = td_sensor_least_threshold(&s->sensor.sensor);
    step->error = estimate.error / threshold;
    step->deviation = estimate.deviation / threshold;
    step->rounded = estimate.rounded / threshold;
    const int asks_time = s->time_tolerance_s > 0 && s->solve.precision == TIDES_SOLVE_OFF; /* else no step's matter */
    double excess = is_rounding(s, step, threshold) ? 0 : step->error / s->tolerance;
    if (asks_time && excess > 0) excess = td_greater(excess, estimate.seconds / s->time_tolerance_s);
    return td_greater(excess, estimate.crossings / s->sensor.sensor.max_events_per_step);
}

/* One that is too short to be cut is accepted whatever the measures say. */
void td_control_judge(tides_simulator *s, td_refine_step *step, double start, double stop) {
    const td_refine *r = &s->refine;
    double share = (double)(step->to - step->from) / (double)((uint32_t)1 << r->depth);
    int may_cut = td_refine_may_cut(r, step), controls = s->mode == TIDES_STEPPING_ERROR;
    step->excess = share * td_units_travel(s, step->tile) / most_travel;
    if (controls) step->excess = td_greater(step->excess, error_excess(s, step, start, stop));
    if (controls && may_cut && step->probe < 0) step->excess = td_greater(step->excess, unseen);
    if (s->mode == TIDES_STEPPING_RISK) {
        double begin = *td_sample_risk(&r->samples, step->begin), end = *td_sample_risk(&r->samples, step->end);
        step->excess = td_greater(step->excess, share / step_factor(td_greater(begin, end)));
    }
    /* Last, for places that all units have in common are rendered for all of a tile together. */
    step->swap = controls && may_cut && s->local && step->excess <= 1 ? td_refine_swap(s, step, &step->begins) : 0;
    if (step->swap) step->excess = unseen;
    step->open = (int16_t)(step->excess > 1 && may_cut);
}

/* A step of the whole image that some tile wants halved. */
typedef struct joint {
    uint32_t from;
    double excess; /* of the tile that wants it most */
} joint;

static int by_position(const void *a, const void *b) {
    const joint *x = a, *y = b;
    if (x->from != y->from) return x->from < y->from ? -1 : 1;
    return x->excess > y->excess ? -1 : x->excess < y->excess;
}

/* The first of the sorted joints at or after `from`. */
static size_t find_joint(const joint *sorted, size_t count, uint32_t from) {
    size_t low = 0, high = count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (sorted[middle].from < from)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* One step for the whole image: whatever one tile wants cut is cut in all, and as urgent in all. */
static tides_status join_tiles(td_refine *r, tides_error *error) {
    size_t wanted_count = r->pending_count;
    joint *wanted = td_alloc(wanted_count, sizeof *wanted, error);
    if (!wanted) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < wanted_count; i++) {
        const td_refine_step *step = &r->step[r->pending[i]];
        wanted[i].from = step->from;
        wanted[i].excess = step->excess;
    }
    qsort(wanted, wanted_count, sizeof *wanted, by_position);
    r->pending_count = 0;
    for (size_t i = 0; i < r->fresh_count; i++) {
        td_refine_step *step = &r->step[r->fresh[i]];
        size_t at = find_joint(wanted, wanted_count, step->from);
        if (at == wanted_count || wanted[at].from != step->from) continue;
        step->excess = wanted[at].excess;
        step->open = 1;
        r->pending[r->pending_count++] = r->fresh[i];
    }
    free(wanted);
    return TIDES_OK;
}

/* A pending step and what orders it. */
typedef struct ranked_step {
    double excess;
    uint32_t from; /* steps of the whole image stay together */
    int32_t step;
} ranked_step;

static int by_falling_excess(const void *a, const void *b) {
    const ranked_step *x = a, *y = b;
    if (x->excess != y->excess) return x->excess > y->excess ? -1 : 1;
    if (x->from != y->from) return x->from < y->from ? -1 : 1;
    return x->step < y->step ? -1 : x->step > y->step;
}

/* Cuts the pending steps to what is left of the macro step's share of the budget; without `local` all tiles' or none's. */
static tides_status keep_to_budget(tides_simulator *s, td_refine *r, tides_error *error) {
    double share = s->budget * s->tiles / (double)s->steps, used = (double)r->cuts;
    size_t left = share > used ? (size_t)(share - used) : 0;
    if (s->budget <= 0 || r->pending_count <= left) return TIDES_OK;
    if (!s->local) left -= left % (size_t)s->moving_count;
    ranked_step *ranked = td_alloc(r->pending_count, sizeof *ranked, error);
    if (!ranked) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < r->pending_count; i++) {
        const td_refine_step *step = &r->step[r->pending[i]];
        ranked_step next = {step->excess, step->from, r->pending[i]};
        ranked[i] = next;
    }
    qsort(ranked, r->pending_count, sizeof *ranked, by_falling_excess);
    for (size_t i = left; i < r->pending_count; i++) r->step[ranked[i].step].open = 0;
    r->pending_count = left;
    for (size_t i = 0; i < left; i++) r->pending[i] = ranked[i].step;
    free(ranked);
    return TIDES_OK;
}

tides_status td_control_steps(tides_simulator *s, tides_error *error) {
    td_refine *r = &s->refine;
    tides_status status = td_reserve((void **)&r->pending, &r->pending_capacity, r->fresh_count, sizeof *r->pending, error);
    if (status != TIDES_OK) return status;
    r->pending_count = 0;
    for (size_t i = 0; i < r->fresh_count; i++)
        if (r->step[r->fresh[i]].open) r->pending[r->pending_count++] = r->fresh[i];
    if (!s->local && r->pending_count > 0) status = join_tiles(r, error);
    if (status == TIDES_OK) status = keep_to_budget(s, r, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->open, &r->open_capacity, r->open_count + r->pending_count, sizeof *r->open, error);
    if (status != TIDES_OK) return status;
    if (r->pending_count == 0) return TIDES_OK; /* nothing was ever reserved, perhaps */
    memcpy(r->open + r->open_count, r->pending, r->pending_count * sizeof *r->open);
    r->open_count += r->pending_count;
    s->stats.steps_rejected += r->pending_count;
    return TIDES_OK;
}
