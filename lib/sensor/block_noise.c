/* Additive noise and kicks of a block of pixels in a step: which pixels may reach a level. */
#include "td_between.h"
#include "td_block_noise.h"
#include "td_extremes.h"

#include <float.h>
#include <math.h>

/* Sets a pixel's levels, within which noise between `low` and `high` can't reach one. `slack` covers rounding, so that no pixel
 * is passed over that noise takes to a level. */
static void set_levels(td_block_noise *noise, const td_noisy_step *step, size_t k, double low, double high) {
    const td_sensor *sensor = step->sensor;
    const size_t i = step->at + k;
    const double on = sensor->threshold_on[i], off = sensor->threshold_off[i];
    const double least = low + noise->kick_low[k], most = high + noise->kick_high[k];
    const double ramp = sensor->leak[i] * (step->start + step->length);
    const double slack = 64 * DBL_EPSILON * (fabs(sensor->pixels.reference[i]) + ramp + on + off + fabs(least) + fabs(most));
    noise->on[k] = on - most - slack;
    noise->off[k] = off + least - slack;
}

/* 1 where the pixel's noise is known up to the step's end, in the segment at the time reached. */
static int is_known(const td_noisy_step *step, size_t k) {
    return td_place_of(step->sensor->segment.ahead[step->at + k].until_ns, step->start, step->length) >= 1;
}

void td_block_noise_begin(td_block_noise *noise, const td_noisy_step *step) {
    const td_sensor *sensor = step->sensor;
    for (size_t k = 0; k < step->count; k++) {
        noise->slot[k] = -1;
        noise->quiet_before[k] = 0;
        noise->low[k] = -INFINITY;
        noise->high[k] = INFINITY;
        noise->paths[k].x = NULL;
        if (!sensor->additive.on) {
            set_levels(noise, step, k, 0, 0);
        } else if (is_known(step, k)) {
            set_levels(noise, step, k, sensor->segment.ahead[step->at + k].low, sensor->segment.ahead[step->at + k].high);
        } else {
            noise->on[k] = noise->off[k] = -INFINITY;
        }
    }
}

/* -- the sweep ------------------------------------------------------------------------------------------------------------- */

/* The time up to which what is known of a segment is of use: a little before its end, so that the next step goes on from it as
 * a sweep would. */
static double known_until(const td_sensor *sensor, double origin_ns, double k) {
    return origin_ns + (k + 1) * sensor->additive.spacing_ns - 1;
}

static void sweep(td_block_noise *noise, const td_noisy_step *step, const double *mark) {
    const td_sensor *sensor = step->sensor;
    const td_additive_noise *additive = &sensor->additive;
    uint32_t pixel[TD_NOISY_BLOCK];
    double low[TD_NOISY_BLOCK], high[TD_NOISY_BLOCK], begun[TD_NOISY_BLOCK];
    td_model input[TD_NOISY_BLOCK];
    td_noise_path paths[TD_NOISY_BLOCK];
    noise->swept = 0;
    for (size_t k = 0; k < step->count; k++) {
        if (mark[k] == 0) continue;
        const int n = noise->swept++;
        const size_t i = step->at + k;
        noise->k[n] = (int)k;
        noise->slot[k] = n;
        pixel[n] = sensor->segment.pixel[i];
        noise->segment[n] = sensor->segment.number[i];
        noise->value[n] = sensor->segment.value[i];
        if (!additive->varies) begun[n] = sensor->segment.origin[i];
        if (!additive->varies) continue;
        noise->few[n].segment[0] = td_sensor_noise_segment(sensor, i);
        input[n] = noise->input[k];
    }
    const td_noise_sweep all = {noise->segment, noise->value, low, high, noise->few, input, noise->path, paths, begun};
    td_additive_noise_sweep(additive, step->start, step->length, pixel, (size_t)noise->swept, &all);
    for (int n = 0; n < noise->swept; n++) {
        const size_t k = (size_t)noise->k[n];
        const double origin = additive->varies ? noise->few[n].segment[0].origin_ns : paths[n].origin_ns;
        td_noise_ahead *ahead = &sensor->segment.ahead[step->at + k];
        *ahead = (td_noise_ahead){low[n] - additive->reach, high[n] + additive->reach,
                                  known_until(sensor, origin, noise->segment[n])};
        set_levels(noise, step, k, ahead->low, ahead->high);
        if (!additive->varies) noise->paths[k] = paths[n];
    }
}

/* -- a close look ---------------------------------------------------------------------------------------------------------- */

/* The signal's bounds between two times: a cubic is at most its greatest curvature / 8 times (to - from)^2 from its chord. */
static void range_of(const td_block_signals *signals, const td_noisy_step *step, size_t k, double from_ns, double to_ns,
                     double *low, double *high) {
    *low = signals->low[k];
    *high = signals->high[k];
    if (!signals->cubic) return;
    const td_model model = {{signals->control[0][k], signals->control[1][k], signals->control[2][k], signals->control[3][k]}};
    const double from = td_greater(td_place_of(from_ns, step->start, step->length), 0);
    const double to = td_lesser(td_place_of(to_ns, step->start, step->length), 1);
    const double *b = model.control, a = td_model_value(&model, from), last = to < 1 ? a : signals->last[k];
    const double bend = 0.75 * td_greater(fabs(b[0] - 2 * b[1] + b[2]), fabs(b[1] - 2 * b[2] + b[3]));
    const double beyond = bend * (to - from) * (to - from) + 64 * DBL_EPSILON * (fabs(*low) + fabs(*high));
    const double end = td_model_value(&model, to);
    *low = td_greater(td_lesser(td_lesser(a, end), last) - beyond, *low);
    *high = td_lesser(td_greater(td_greater(a, end), last) + beyond, *high);
}

/* Adds the segment to the search if the noise may reach a level on it. */
static void add_segment(td_block_noise *noise, const td_noisy_step *step, const td_block_signals *signals, int n,
                        const td_noise_segment *segment, double levels[2]) {
    td_noise_found *found = &noise->found[n];
    const double low = td_lesser(segment->begin, segment->end) - segment->reach;
    const double high = td_greater(segment->begin, segment->end) + segment->reach;
    double least, most;
    range_of(signals, step, (size_t)noise->k[n], segment->from_ns, segment->to_ns, &least, &most);
    const double bottom = -levels[1] - least, top = levels[0] - most;
    if (low > bottom && high < top) {
        if (segment->to_ns < step->start + step->length) return;
        found->low = td_lesser(found->low, low);
        found->high = td_greater(found->high, high);
        return;
    }
    td_noise_quiet_add(&noise->quiet, n, step->sensor->segment.pixel[step->at + (size_t)noise->k[n]], segment, bottom, top);
}

/* Searches a swept pixel's segments of the step. */
static void search(td_block_noise *noise, const td_noisy_step *step, const td_block_signals *signals, int n) {
    const td_sensor *sensor = step->sensor;
    const size_t k = (size_t)noise->k[n], i = step->at + k;
    const double known = sensor->segment.ahead[i].until_ns;
    noise->found[n] = (td_noise_found){.low = INFINITY, .high = -INFINITY, .until_ns = known};
    double levels[2] = {noise->on[k] + sensor->segment.ahead[i].high, noise->off[k] - sensor->segment.ahead[i].low};
    if (sensor->additive.varies) {
        for (int f = 0; f < noise->few[n].count; f++) add_segment(noise, step, signals, n, &noise->few[n].segment[f], levels);
        return;
    }
    td_noise_path path = noise->paths[k];
    td_noise_segment segment = td_additive_noise_along(&sensor->additive, sensor->segment.pixel[i],
                                                       (uint64_t)sensor->segment.number[i], sensor->segment.value[i], 0, &path);
    while (td_place_of(segment.to_ns, step->start, step->length) < 1) {
        if (td_place_of(segment.to_ns, step->start, step->length) >= 0) add_segment(noise, step, signals, n, &segment, levels);
        td_additive_noise_next_along(&sensor->additive, sensor->segment.pixel[i], 0, &path, &segment);
    }
    add_segment(noise, step, signals, n, &segment, levels);
}

static int is_within(const td_block_noise *noise, const td_block_signals *signals, size_t k) {
    return signals->high[k] < noise->on[k] && signals->low[k] > -noise->off[k];
}

/* 1 where a swept pixel's segments of the step are at hand. */
static int is_listed(const td_block_noise *noise, const td_noisy_step *step, int n) {
    if (step->sensor->additive.varies) return noise->few[n].count <= TD_NOISE_FEW;
    const double first = step->sensor->segment.number[step->at + (size_t)noise->k[n]];
    return noise->segment[n] - first < TD_NOISE_PATH - TD_NOISE_BLOCK;
}

void td_block_noise_look(td_block_noise *noise, const td_noisy_step *step, const td_block_signals *signals, double *mark) {
    const td_sensor *sensor = step->sensor;
    int searched[TD_NOISY_BLOCK], count = 0;
    sweep(noise, step, mark);
    if (!signals) return;
    td_noise_quiet_begin(&noise->quiet, &sensor->additive, step->start, step->start + step->length, noise->found);
    for (int n = 0; n < noise->swept; n++) {
        const size_t k = (size_t)noise->k[n];
        if (!(sensor->wake[step->at + k] > step->stop)) continue;
        if (is_within(noise, signals, k)) {
            mark[k] = 0;
        } else if (isfinite(signals->low[k]) && isfinite(signals->high[k]) && is_listed(noise, step, n)) {
            search(noise, step, signals, n);
            searched[count++] = n;
        }
    }
    td_noise_quiet_end(&noise->quiet);
    for (int c = 0; c < count; c++) {
        const int n = searched[c];
        const size_t k = (size_t)noise->k[n];
        const td_noise_found *found = &noise->found[n];
        if (found->reaches) {
            const double reference = sensor->pixels.reference[step->at + k];
            const double slack = 4 * DBL_EPSILON * (fabs(reference) + fabs(signals->low[k]) + fabs(signals->high[k]));
            noise->quiet_before[k] = found->first;
            noise->low[k] = reference + signals->low[k] - slack;
            noise->high[k] = reference + signals->high[k] + slack;
            continue;
        }
        mark[k] = 0;
        sensor->segment.ahead[step->at + k] = (td_noise_ahead){found->low, found->high, found->until_ns};
    }
}

void td_block_noise_pass(const td_block_noise *noise, const td_noisy_step *step, size_t k) {
    const td_sensor *sensor = step->sensor;
    const int n = noise->slot[k];
    const size_t i = step->at + k;
    if (n < 0) return;
    if (sensor->additive.varies) {
        const td_noise_few *few = &noise->few[n];
        td_sensor_put_segment(sensor, i, &few->segment[few->count < TD_NOISE_FEW ? few->count - 1 : TD_NOISE_FEW - 1]);
        return;
    }
    sensor->segment.number[i] = noise->segment[n];
    sensor->segment.value[i] = noise->value[n];
}
