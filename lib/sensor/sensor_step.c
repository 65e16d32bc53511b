/* The sensor over the pixels of a tile: most do nothing in most steps, and are passed over by comparing control values with
 * levels, as in comparator.c, behind the constant low-pass too; the others go to pixel.c one by one. Filters whose rates go
 * with the light take each pixel by itself. */
#include "td_pixel.h"
#include "td_sensor.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { BLOCK = 64 };

/* A block's additive noise in the step: where its lines end, and the levels less its bounds. */
typedef struct noise_block {
    double line[BLOCK], value[BLOCK], on[BLOCK], off[BLOCK];
} noise_block;

/* What the parts of a call share. */
typedef struct tile_job {
    td_pixel_job pixel;
    const td_tile *tile;
    size_t first;
    const td_signals *signals;
    const td_coverage *coverage;
    double stop;            /* no appointment of this step is later [ns since the run's start] */
    size_t begun;           /* pixels of the tile before the block at hand */
    const double *on, *off; /* the block's levels: what its signals must stay within to need nothing */
    noise_block *noise;     /* NULL: there is none */
} tile_job;

/* Rates that the model doesn't read count as 0. */
static inline td_model fit(int32_t kind, const td_signals *signals, double h, size_t j) {
    double S0_dot = kind == TIDES_MODEL_SECANT ? 0.0 : signals->S0_dot[j];
    double S1_dot = kind == TIDES_MODEL_HERMITE ? signals->S1_dot[j] : 0.0;
    return td_model_fit(kind, h, signals->S0[j], S0_dot, signals->S1[j], S1_dot);
}

/* outside[k] = 0 where pixel j = first + k needs nothing: S_eff strictly between its levels, and no appointment. The loop is
 * straight-line code, as comparator.c's. */
static inline void reject(int32_t kind, const tile_job *job, size_t first, size_t count, double *restrict outside) {
    const td_sensor *sensor = job->pixel.sensor;
    const td_signals from = *job->signals;
    const double *reference = job->pixel.pixels->reference + first, *wake = sensor->wake + job->first + first;
    const double *on = job->on, *off = job->off, *leak = sensor->leak + job->first + first;
    const double h = job->pixel.step->length_s, start = job->pixel.start, third = job->pixel.step->length_ns / 3;
    const double stop = job->stop;
    for (size_t k = 0; k < count; k++) {
        td_model model = fit(kind, &from, h, first + k);
        double base = leak[k] * start - reference[k], rise = leak[k] * third, low = -off[k];
        double r0 = model.control[0] + base, r1 = model.control[1] + base + rise, r2 = model.control[2] + base + 2 * rise;
        double r3 = model.control[3] + base + 3 * rise, last = from.S1[first + k] + base + 3 * rise;
        double flag = r0 < on[k] ? 0.0 : 1.0;
        flag = r0 > low ? flag : 1.0;
        flag = r1 < on[k] ? flag : 1.0;
        flag = r1 > low ? flag : 1.0;
        flag = r2 < on[k] ? flag : 1.0;
        flag = r2 > low ? flag : 1.0;
        flag = r3 < on[k] ? flag : 1.0;
        flag = r3 > low ? flag : 1.0;
        flag = last < on[k] ? flag : 1.0;
        flag = last > low ? flag : 1.0;
        outside[k] = wake[k] > stop ? flag : 1.0;
    }
}

static void reject_block(const tile_job *job, size_t first, size_t count, double *outside) {
    switch (job->pixel.sensor->model) {
        case TIDES_MODEL_LINEAR: reject(TIDES_MODEL_LINEAR, job, first, count, outside); break;
        case TIDES_MODEL_QUADRATIC: reject(TIDES_MODEL_QUADRATIC, job, first, count, outside); break;
        case TIDES_MODEL_SECANT: reject(TIDES_MODEL_SECANT, job, first, count, outside); break;
        default: reject(TIDES_MODEL_HERMITE, job, first, count, outside); break;
    }
}

/* The control values of `count` pixels' inputs. */
static inline void gather(int32_t kind, const tile_job *job, size_t first, size_t count, double control[4][BLOCK]) {
    const td_signals from = *job->signals;
    const double h = job->pixel.step->length_s;
    for (size_t k = 0; k < count; k++) {
        td_model input = fit(kind, &from, h, first + k);
        for (int c = 0; c < 4; c++) control[c][k] = input.control[c];
    }
}

static void gather_block(const tile_job *job, size_t first, size_t count, double control[4][BLOCK]) {
    switch (job->pixel.sensor->model) {
        case TIDES_MODEL_LINEAR: gather(TIDES_MODEL_LINEAR, job, first, count, control); break;
        case TIDES_MODEL_QUADRATIC: gather(TIDES_MODEL_QUADRATIC, job, first, count, control); break;
        case TIDES_MODEL_SECANT: gather(TIDES_MODEL_SECANT, job, first, count, control); break;
        default: gather(TIDES_MODEL_HERMITE, job, first, count, control); break;
    }
}

/* reject behind the constant low-pass. The pixels that need nothing are at the step's end then; the others are as they were.
 * `slack` is for rounding here, so that none is passed over that its path would take to a level. */
static void reject_filtered(const tile_job *job, size_t first, size_t count, double *restrict outside) {
    const td_sensor *sensor = job->pixel.sensor;
    const size_t at = job->first + first;
    const double *reference = job->pixel.pixels->reference + first, *leak = sensor->leak + at, *wake = sensor->wake + at;
    const double *on = job->on, *off = job->off;
    const double start = job->pixel.start, length = job->pixel.step->length_ns, stop = job->stop;
    double b[4][BLOCK], after[BLOCK], low[BLOCK], high[BLOCK], *S = sensor->filter[0] + at;
    const double *const control[4] = {b[0], b[1], b[2], b[3]};
    gather_block(job, first, count, b);
    td_frontend_step_many(&sensor->frontend, job->pixel.step->length_s, count, control, S, after, low, high);
    for (size_t k = 0; k < count; k++) {
        double ramp = leak[k] * start, rise = leak[k] * length, slack = 16 * DBL_EPSILON * (ramp + rise + fabs(reference[k]));
        double flag = high[k] + (ramp - reference[k]) + rise + slack < on[k] ? 0.0 : 1.0;
        flag = low[k] + (ramp - reference[k]) - slack > -off[k] ? flag : 1.0;
        outside[k] = wake[k] > stop ? flag : 1.0;
        S[k] = outside[k] == 0.0 ? after[k] : S[k];
    }
}

/* Where in the step the pixel's coverage, linear between its ends, is at least b_min. */
static void set_visible(const tile_job *job, size_t j, td_pixel_step *pixel) {
    pixel->visible_from = 0;
    pixel->visible_to = 1;
    if (!job->pixel.sensor->masks) return;
    double least = job->pixel.sensor->sensor.b_min, begin = job->coverage->begin[j], end = job->coverage->end[j];
    double crossing = (least - begin) / (end - begin);
    if (!(begin >= least) && !(end >= least))
        pixel->visible_from = pixel->visible_to = 2;
    else if (!(begin >= least))
        pixel->visible_from = crossing;
    else if (!(end >= least))
        pixel->visible_to = crossing;
}

/* The filters' answer to the pixel's input, and their state at the step's end. */
static void filter(const tile_job *job, td_pixel_step *pixel) {
    td_sensor *sensor = job->pixel.sensor;
    double state[TD_FRONTEND_STATE] = {0};
    for (int k = 0; k < TD_FRONTEND_STATE; k++)
        if (sensor->filter[k]) state[k] = sensor->filter[k][pixel->i];
    td_frontend_step(&sensor->frontend, job->pixel.step->length_s, &pixel->input, sensor->log_eps, state, &pixel->path);
    for (int k = 0; k < TD_FRONTEND_STATE; k++)
        if (sensor->filter[k]) sensor->filter[k][pixel->i] = state[k];
    pixel->end = state[0];
}

/* reject, of one filtered pixel. */
static int needs_nothing(const tile_job *job, const td_pixel_step *pixel) {
    const td_sensor *sensor = job->pixel.sensor;
    const size_t k = pixel->local - job->begun;
    double low, high, reference = job->pixel.pixels->reference[pixel->local];
    td_path_range(&pixel->path, &low, &high);
    return low > reference - job->off[k] && high < reference + job->on[k] && sensor->wake[pixel->i] > job->stop;
}

/* -- blocks ---------------------------------------------------------------------------------------------------------------- */

/* The block's levels. `slack` is for rounding, so that none is passed over that a line would take to a level. */
static void take_levels(tile_job *job, size_t first, size_t count) {
    const td_sensor *sensor = job->pixel.sensor;
    const size_t at = job->first + first;
    const double *reference = job->pixel.pixels->reference + first, *leak = sensor->leak + at;
    const double stop = job->pixel.start + job->pixel.step->length_ns;
    noise_block *noise = job->noise;
    job->begun = first;
    job->on = sensor->threshold_on + at;
    job->off = sensor->threshold_off + at;
    if (!noise) return;
    double low[BLOCK], high[BLOCK];
    memcpy(noise->line, sensor->noise_line + at, count * sizeof *noise->line);
    memcpy(noise->value, sensor->noise_value + at, count * sizeof *noise->value);
    const td_noise_sweep sweep = {noise->line, noise->value, low, high};
    td_additive_noise_sweep(&sensor->additive, job->pixel.start, job->pixel.step->length_ns, sensor->number + at, count,
                            &sweep);
    for (size_t k = 0; k < count; k++) {
        low[k] -= sensor->additive.reach;
        high[k] += sensor->additive.reach;
        double size = fabs(reference[k]) + leak[k] * stop + job->on[k] + job->off[k] + fabs(low[k]) + fabs(high[k]);
        double slack = 64 * DBL_EPSILON * size;
        noise->on[k] = job->on[k] - high[k] - slack;
        noise->off[k] = job->off[k] + low[k] - slack;
    }
    job->on = noise->on;
    job->off = noise->off;
}

/* A pixel that needs nothing is at the step's end. */
static void pass_over(const tile_job *job, size_t j) {
    td_sensor *sensor = job->pixel.sensor;
    if (!job->noise) return;
    sensor->noise_line[job->first + j] = job->noise->line[j - job->begun];
    sensor->noise_value[job->first + j] = job->noise->value[j - job->begun];
}

static tides_status step_pixel(tile_job *job, size_t j) {
    const td_step *step = job->pixel.step;
    const td_sensor *sensor = job->pixel.sensor;
    td_pixel_step pixel = {.local = j, .i = job->first + j};
    pixel.x = (uint16_t)(job->tile->x0 + (int32_t)j % job->tile->width);
    pixel.y = (uint16_t)(job->tile->y0 + (int32_t)j / job->tile->width);
    pixel.input = fit(sensor->model, job->signals, step->length_s, j);
    pixel.path.cubic = pixel.input;
    pixel.end = job->signals->S1[j];
    if (sensor->frontend.on) filter(job, &pixel);
    if (sensor->light) pixel.input = fit(TIDES_MODEL_HERMITE, sensor->light, step->length_s, j);
    double ramp = sensor->leak[pixel.i] * job->pixel.start, rise = sensor->leak[pixel.i] * step->length_ns;
    for (int c = 0; c < 4; c++) pixel.path.cubic.control[c] += ramp + rise * (c / 3.0);
    pixel.end += ramp + rise;
    if (sensor->frontend.on && needs_nothing(job, &pixel)) {
        pass_over(job, j);
        return TIDES_OK;
    }
    set_visible(job, j, &pixel);
    return td_pixel_advance(&job->pixel, &pixel);
}

static void add_counts(td_sensor_counts *sum, const td_sensor_counts *more) {
    for (int c = 0; c < TIDES_CAUSES; c++) sum->cause[c] += more->cause[c];
    sum->suppressed += more->suppressed;
    sum->refractory += more->refractory;
}

tides_status td_sensor_step(td_sensor *sensor, const td_step *step, const td_tile *tile, size_t first,
                            const td_signals *signals, const td_coverage *coverage, const td_pixels *pixels,
                            td_event_buffer *buffer, td_comparator_counts *counts, tides_error *error) {
    noise_block noise;
    tile_job job = {{sensor,
                     step,
                     pixels,
                     td_sensor_time(sensor, step->start_ns, step->start_fraction),
                     buffer,
                     *counts,
                     {{0}, 0, 0},
                     error},
                    tile,
                    first,
                    signals,
                    coverage,
                    (double)(step->stop_ns - sensor->start_ns) + 2, /* floored, and less one: see step_between */
                    0,
                    NULL,
                    NULL,
                    sensor->additive.on ? &noise : NULL};
    const int passes = !sensor->frontend.on, filters = sensor->frontend.kind == TD_FRONTEND_CONSTANT;
    size_t before = buffer->count, pixel_count = (size_t)tile->count;
    double outside[BLOCK];
    for (size_t done = 0; done < pixel_count; done += BLOCK) {
        size_t count = pixel_count - done < BLOCK ? pixel_count - done : BLOCK;
        take_levels(&job, done, count);
        if (passes) reject_block(&job, done, count, outside);
        if (filters) reject_filtered(&job, done, count, outside);
        for (size_t k = 0; k < count; k++) {
            tides_status status = TIDES_OK;
            if ((passes || filters) && outside[k] == 0.0)
                pass_over(&job, done + k);
            else
                status = step_pixel(&job, done + k);
            if (status != TIDES_OK) {
                buffer->count = before;
                return status;
            }
        }
    }
    *counts = job.pixel.counts;
    add_counts(&sensor->counts, &job.pixel.sensor_counts);
    return TIDES_OK;
}
