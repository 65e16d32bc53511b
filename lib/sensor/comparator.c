/* The comparator over the pixels of a tile (paper, "Comparator and sensor model"; DESIGN 3.2 to 3.4).
 *
 * Most pixels do nothing in most steps. Blocks of pixels are passed over by comparing control values with levels, in loops that
 * vectorise, behind low-passes and the circuit too. The others are handled one by one: ideal pixels in td_ideal.h, pixels with
 * blocks in pixel.c. Behind a high-pass each pixel is handled by itself. */
#include "td_block_noise.h"
#include "td_extremes.h"
#include "td_ideal.h"
#include "td_between.h"
#include "td_ideal_block.h"
#include "td_pixel.h"
#include "td_sensor.h"
#include "td_single.h"
#include "td_wide.h"
#include "sensor/response/td_substeps.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { BLOCK = TD_IDEAL_BLOCK };

/* The arguments of a call, and what follows from them. */
typedef struct tile_job {
    td_pixel_job pixel;
    const td_tile *tile;
    size_t first;
    const td_signals *signals;
    const td_coverage *coverage;
    double stop;            /* every wake-up of this step is at or before this time [ns since the run's start] */
    size_t begun;           /* number in the tile of the current block's first pixel */
    const double *on, *off; /* the block's levels: signals that stay within them need nothing */
    td_block_noise *noise;  /* NULL: there is none */
    td_pieces *pieces;      /* of the single pixel at hand; NULL: its model follows from its signals at the step's ends */
} tile_job;

static uint16_t column(const tile_job *job, size_t j) { return (uint16_t)(job->tile->x0 + (int32_t)j % job->tile->width); }

static uint16_t row(const tile_job *job, size_t j) { return (uint16_t)(job->tile->y0 + (int32_t)j / job->tile->width); }

/* The model of pixel j. Rates that `kind` doesn't use count as 0. */
static inline td_model fit(int32_t kind, const td_signals *signals, double h, size_t j) {
    double S0_dot = kind == TIDES_MODEL_SECANT ? 0.0 : signals->S0_dot[j];
    double S1_dot = kind == TIDES_MODEL_HERMITE ? signals->S1_dot[j] : 0.0;
    return td_model_fit(kind, h, signals->S0[j], S0_dot, signals->S1[j], S1_dot);
}

/* outside[k] = 0 where ideal pixel j = first + k needs nothing, otherwise 1. It needs nothing if the control values of S and
 * its end are all strictly between the levels (NaN isn't). With `kind` constant the loop is straight-line code that vectorises
 * (gcc -O3 -fopt-info-vec names it). Flags are doubles, set by one comparison at a time, because gcc 12 doesn't vectorise
 * comparisons of doubles that give integers. */
static inline void reject(int32_t kind, const tile_job *job, size_t first, size_t count, double *restrict outside) {
    const td_sensor *sensor = job->pixel.sensor;
    const td_signals from = *job->signals;
    const double *reference = sensor->pixels.reference + job->first + first;
    const double h = job->pixel.step->length_s, high = sensor->sensor.threshold_on, low = -sensor->sensor.threshold_off;
    for (size_t k = 0; k < count; k++) {
        td_model model = fit(kind, &from, h, first + k);
        double base = -reference[k], r0 = model.control[0] + base, r1 = model.control[1] + base;
        double r2 = model.control[2] + base, r3 = model.control[3] + base, last = from.S1[first + k] + base;
        double flag = r0 < high ? 0.0 : 1.0;
        flag = r0 > low ? flag : 1.0;
        flag = r1 < high ? flag : 1.0;
        flag = r1 > low ? flag : 1.0;
        flag = r2 < high ? flag : 1.0;
        flag = r2 > low ? flag : 1.0;
        flag = r3 < high ? flag : 1.0;
        flag = r3 > low ? flag : 1.0;
        flag = last < high ? flag : 1.0;
        outside[k] = last > low ? flag : 1.0;
    }
}

/* Bounds of S_eff over the reference of pixels with blocks: the range of control values and end; NaN where one of these is. */
static inline void bound(int32_t kind, const tile_job *job, size_t first, size_t count, td_block_signals *restrict to) {
    const td_sensor *sensor = job->pixel.sensor;
    const td_signals from = *job->signals;
    const size_t at = job->first + first;
    const double *reference = sensor->pixels.reference + at, *leak = sensor->leak + at;
    const double h = job->pixel.step->length_s, start = job->pixel.start, third = job->pixel.step->length_ns / 3;
    for (size_t k = 0; k < count; k++) {
        td_model model = fit(kind, &from, h, first + k);
        double base = leak[k] * start - reference[k], rise = leak[k] * third;
        double r0 = model.control[0] + base, r1 = model.control[1] + base + rise;
        double r2 = model.control[2] + base + 2 * rise, r3 = model.control[3] + base + 3 * rise;
        double last = from.S1[first + k] + base + 3 * rise, nothing = 0 * (r0 + r1 + r2 + r3 + last);
        to->low[k] = td_lesser(td_lesser(td_lesser(r0, r1), td_lesser(r2, r3)), last) + nothing;
        to->high[k] = td_greater(td_greater(td_greater(r0, r1), td_greater(r2, r3)), last) + nothing;
        to->control[0][k] = r0;
        to->control[1][k] = r1;
        to->control[2][k] = r2;
        to->control[3][k] = r3;
        to->last[k] = last;
    }
}

/* These call the loops with the model's kind as a constant. */
TD_WIDE static void reject_ideal(const tile_job *job, size_t first, size_t count, double *outside) {
    switch (job->pixel.sensor->model) {
        case TIDES_MODEL_LINEAR: reject(TIDES_MODEL_LINEAR, job, first, count, outside); break;
        case TIDES_MODEL_QUADRATIC: reject(TIDES_MODEL_QUADRATIC, job, first, count, outside); break;
        case TIDES_MODEL_SECANT: reject(TIDES_MODEL_SECANT, job, first, count, outside); break;
        default: reject(TIDES_MODEL_HERMITE, job, first, count, outside); break;
    }
}

TD_WIDE static void bound_cubics(const tile_job *job, size_t first, size_t count, td_block_signals *to) {
    switch (job->pixel.sensor->model) {
        case TIDES_MODEL_LINEAR: bound(TIDES_MODEL_LINEAR, job, first, count, to); break;
        case TIDES_MODEL_QUADRATIC: bound(TIDES_MODEL_QUADRATIC, job, first, count, to); break;
        case TIDES_MODEL_SECANT: bound(TIDES_MODEL_SECANT, job, first, count, to); break;
        default: bound(TIDES_MODEL_HERMITE, job, first, count, to); break;
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

TD_WIDE static void gather_block(const tile_job *job, size_t first, size_t count, double control[4][BLOCK]) {
    switch (job->pixel.sensor->model) {
        case TIDES_MODEL_LINEAR: gather(TIDES_MODEL_LINEAR, job, first, count, control); break;
        case TIDES_MODEL_QUADRATIC: gather(TIDES_MODEL_QUADRATIC, job, first, count, control); break;
        case TIDES_MODEL_SECANT: gather(TIDES_MODEL_SECANT, job, first, count, control); break;
        default: gather(TIDES_MODEL_HERMITE, job, first, count, control); break;
    }
}

/* The block's signals behind the filters, and the filters' states at the step's end. */
typedef struct filtered_block {
    td_block_signals signals;
    double after[TD_FRONTEND_STATE][BLOCK];
    int states;
} filtered_block;

/* Steps the filters of `count` pixels from the sensor's pixel `at` on. */
static void step_filters(const tile_job *job, size_t at, size_t count, double control[4][BLOCK], filtered_block *block) {
    const td_sensor *sensor = job->pixel.sensor;
    const td_frontend *frontend = &sensor->frontend;
    const double h = job->pixel.step->length_s;
    td_filter_block pixels = {.count = count, .low = block->signals.low, .high = block->signals.high};
    block->states = frontend->kind == TD_FRONTEND_CIRCUIT ? TD_FRONTEND_STATE : 1;
    for (int c = 0; c < 4; c++) pixels.control[c] = control[c];
    for (int s = 0; s < block->states; s++) {
        pixels.state[s] = sensor->filtered.state[s] + at;
        pixels.after[s] = block->after[s];
    }
    switch (frontend->kind) {
        case TD_FRONTEND_CIRCUIT: td_circuit_step_many(frontend, h, sensor->log_eps, &pixels); break;
        case TD_FRONTEND_INTENSITY: td_frontend_step_light(frontend, h, sensor->log_eps, &pixels); break;
        default: td_frontend_step_many(frontend, h, &pixels); break;
    }
}

/* Bounds of S_eff over the reference behind filters. They cover rounding, so that no pixel is passed over whose response
 * reaches a level. */
static void bound_filtered(const tile_job *job, size_t first, size_t count, filtered_block *block) {
    const td_sensor *sensor = job->pixel.sensor;
    const size_t at = job->first + first;
    const double *reference = sensor->pixels.reference + at, *leak = sensor->leak + at;
    const double start = job->pixel.start, length = job->pixel.step->length_ns;
    double b[4][BLOCK], *low = block->signals.low, *high = block->signals.high;
    gather_block(job, first, count, b);
    step_filters(job, at, count, b, block);
    for (size_t k = 0; k < count; k++) {
        double ramp = leak[k] * start, rise = leak[k] * length, slack = 16 * DBL_EPSILON * (ramp + rise + fabs(reference[k]));
        high[k] = high[k] + (ramp - reference[k]) + rise + slack;
        low[k] = low[k] + (ramp - reference[k]) - slack;
    }
}

/* Gives the filters of pixels that need nothing their state at the step's end; the others keep theirs. */
static void keep_states(const tile_job *job, size_t first, size_t count, const filtered_block *block, const double *outside) {
    for (int s = 0; s < block->states; s++) {
        double *state = job->pixel.sensor->filtered.state[s] + job->first + first;
        for (size_t k = 0; k < count; k++) state[k] = outside[k] == 0.0 ? block->after[s][k] : state[k];
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

/* Computes the pixel's response behind the filters, and their state at the step's end. */
static void filter(const tile_job *job, td_pixel_step *pixel, td_kept_substeps *kept) {
    const td_sensor *sensor = job->pixel.sensor;
    double state[TD_FRONTEND_STATE] = {0};
    for (int k = 0; k < TD_FRONTEND_STATE; k++)
        if (sensor->filtered.state[k]) state[k] = sensor->filtered.state[k][pixel->i];
    td_frontend_step(&sensor->frontend, job->pixel.step->length_s, &pixel->input, sensor->log_eps, state, &pixel->response,
                     kept);
    for (int k = 0; k < TD_FRONTEND_STATE; k++)
        if (sensor->filtered.state[k]) sensor->filtered.state[k][pixel->i] = state[k];
    pixel->end = state[0];
}

/* 1 where a filtered pixel needs nothing: its response stays within the levels, and no wake-up is due. */
static int needs_nothing(const tile_job *job, const td_pixel_step *pixel) {
    const td_sensor *sensor = job->pixel.sensor;
    const size_t k = pixel->local - job->begun;
    double low, high, reference = sensor->pixels.reference[pixel->i];
    td_response_range(&pixel->response, &low, &high);
    return low > reference - job->off[k] && high < reference + job->on[k] && sensor->wake[pixel->i] > job->stop;
}

/* 1 where pixels can be passed over in blocks: not behind a high-pass. */
static int can_reject(const td_sensor *sensor) { return !sensor->exhaustive && sensor->frontend.kind != TD_FRONTEND_HIGHPASS; }

/* -- blocks ---------------------------------------------------------------------------------------------------------------- */

/* The model of the pixel's log-luminance on the step. */
static td_model light_of(const tile_job *job, size_t j) {
    const double h = job->pixel.step->length_s;
    return job->pixel.light ? fit(TIDES_MODEL_HERMITE, job->pixel.light, h, j)
                            : fit(job->pixel.sensor->model, job->signals, h, j);
}

static void bound_kicks(const tile_job *job, size_t first, size_t count, double *low, double *high) {
    const double start = job->pixel.start, stop = start + job->pixel.step->length_ns;
    double least = 0, most = 0;
    for (size_t k = 0; k < count; k++) {
        const int32_t y = row(job, first + k);
        if (k == 0 || y != row(job, first + k - 1)) td_kick_bounds(&job->pixel.sensor->kick, y, start, stop, &least, &most);
        low[k] = least;
        high[k] = most;
    }
}

static td_noisy_step noisy_step(const tile_job *job, size_t first, size_t count) {
    return (td_noisy_step){job->pixel.sensor, job->pixel.start,   job->pixel.step->length_ns,
                           job->stop,         job->first + first, count};
}

/* The block's levels, within which noise can't reach one. */
static void take_levels(tile_job *job, size_t first, size_t count) {
    const td_sensor *sensor = job->pixel.sensor;
    td_block_noise *noise = job->noise;
    job->begun = first;
    job->on = sensor->threshold_on + job->first + first;
    job->off = sensor->threshold_off + job->first + first;
    if (!noise) return;
    const td_noisy_step step = noisy_step(job, first, count);
    if (sensor->kick.on)
        bound_kicks(job, first, count, noise->kick_low, noise->kick_high);
    else
        for (size_t k = 0; k < count; k++) noise->kick_low[k] = noise->kick_high[k] = 0;
    td_block_noise_begin(noise, &step);
    job->on = noise->on;
    job->off = noise->off;
}

/* Finds the pixels of a block that need something; `signals` is NULL where all do. */
static void mark_block(const tile_job *job, size_t first, size_t count, const td_block_signals *signals, double *outside) {
    const td_sensor *sensor = job->pixel.sensor;
    const double *wake = sensor->wake + job->first + first;
    for (size_t k = 0; k < count; k++) {
        double flag = signals && signals->high[k] < job->on[k] ? 0.0 : 1.0;
        flag = signals && signals->low[k] > -job->off[k] ? flag : 1.0;
        outside[k] = wake[k] > job->stop ? flag : 1.0;
    }
    if (!job->noise || !sensor->additive.on) return;
    for (size_t k = 0; k < count && sensor->additive.varies; k++)
        if (outside[k] != 0.0) job->noise->input[k] = light_of(job, first + k);
    const td_noisy_step step = noisy_step(job, first, count);
    td_block_noise_look(job->noise, &step, signals, outside);
}

/* Takes the noise of a pixel that needs nothing to the step's end. */
static void pass_over(const tile_job *job, size_t j) {
    if (!job->noise || !job->pixel.sensor->additive.on) return;
    const td_noisy_step step = noisy_step(job, job->begun, 0);
    td_block_noise_pass(job->noise, &step, j - job->begun);
}

static tides_status step_pixel(tile_job *job, size_t j) {
    const td_step *step = job->pixel.step;
    const td_sensor *sensor = job->pixel.sensor;
    td_pixel_step pixel = {.local = j, .i = job->first + j, .x = column(job, j), .y = row(job, j)};
    pixel.input = fit(sensor->model, job->signals, step->length_s, j);
    if (job->noise && sensor->additive.on) {
        pixel.noise = job->noise->paths[j - job->begun];
        pixel.low = job->noise->low[j - job->begun];
        pixel.high = job->noise->high[j - job->begun];
        pixel.quiet_before = job->noise->quiet_before[j - job->begun];
    }
    pixel.response.cubic = pixel.input;
    pixel.end = job->signals->S1[j];
    td_kept_substeps kept;
    if (sensor->frontend.on) filter(job, &pixel, &kept);
    if (job->pixel.light) pixel.input = light_of(job, j);
    double ramp = sensor->leak[pixel.i] * job->pixel.start, rise = sensor->leak[pixel.i] * step->length_ns;
    for (int c = 0; c < 4; c++) pixel.response.cubic.control[c] += ramp + rise * (c / 3.0);
    pixel.end += ramp + rise;
    if (job->pieces) td_pieces_add_ramp(job->pieces, ramp, rise);
    pixel.response.pieces = job->pieces;
    if (sensor->frontend.on && !sensor->exhaustive && needs_nothing(job, &pixel)) {
        pass_over(job, j);
        return TIDES_OK;
    }
    set_visible(job, j, &pixel);
    return td_pixel_advance(&job->pixel, &pixel);
}

/* -- the tile -------------------------------------------------------------------------------------------------------------- */

/* Undoes the events from number `before` on. An ideal pixel's counts follow from its events. */
static void undo(const tile_job *job, size_t before) {
    const td_sensor *sensor = job->pixel.sensor;
    const td_pixels *pixels = &sensor->pixels;
    for (size_t k = before; k < job->pixel.buffer->count && !sensor->on; k++) {
        const tides_event *event = &job->pixel.buffer->events[k];
        size_t i =
            job->first + (size_t)(event->y - job->tile->y0) * (size_t)job->tile->width + (size_t)(event->x - job->tile->x0);
        if (event->polarity > 0)
            pixels->count_on[i]--;
        else
            pixels->count_off[i]--;
        pixels->reference[i] = td_reference_at(sensor->sensor.threshold_on, sensor->sensor.threshold_off, pixels->initial[i],
                                               pixels->count_on[i], pixels->count_off[i]);
    }
    job->pixel.buffer->count = before;
}

/* Advances a block of ideal pixels. */
static tides_status step_ideal_block(tile_job *job, size_t first, size_t count) {
    double outside[BLOCK];
    if (job->pixel.sensor->exhaustive)
        for (size_t k = 0; k < count; k++) outside[k] = 1;
    else
        reject_ideal(job, first, count, outside);
    const td_ideal_block block = {job->tile, job->signals, job->first, first, count};
    return td_ideal_block_step(&job->pixel, &block, outside);
}

/* Advances a block of pixels with blocks of the sensor model. */
static tides_status step_block(tile_job *job, size_t first, size_t count) {
    const td_sensor *sensor = job->pixel.sensor;
    const int rejects = can_reject(sensor);
    double outside[BLOCK];
    filtered_block block;
    block.states = 0;
    block.signals.cubic = !sensor->frontend.on;
    take_levels(job, first, count);
    if (rejects && sensor->frontend.on)
        bound_filtered(job, first, count, &block);
    else if (rejects)
        bound_cubics(job, first, count, &block.signals);
    mark_block(job, first, count, rejects ? &block.signals : NULL, outside);
    if (rejects) keep_states(job, first, count, &block, outside);
    for (size_t k = 0; k < count; k++) {
        tides_status status = TIDES_OK;
        if (outside[k] == 0.0)
            pass_over(job, first + k);
        else
            status = step_pixel(job, first + k);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

static tides_status step_all(tile_job *job) {
    const size_t pixels = (size_t)job->tile->count;
    tides_status status = TIDES_OK;
    for (size_t done = 0; done < pixels && status == TIDES_OK; done += BLOCK) {
        const size_t count = pixels - done < BLOCK ? pixels - done : BLOCK;
        status = job->pixel.sensor->on ? step_block(job, done, count) : step_ideal_block(job, done, count);
    }
    return status;
}

/* Not inlined: the noise of a block is large, and compilers touch all pages of a frame. */
TD_BESIDE static tides_status step_noisy(tile_job *job) {
    td_block_noise noise;
    job->noise = &noise;
    return step_all(job);
}

tides_status td_sensor_step(const td_sensor *sensor, const td_step *step, const td_tile *tile, size_t first,
                            const td_seen *seen, td_work *work, tides_error *error) {
    const size_t before = work->events.count;
    tile_job job = {.pixel = {.sensor = sensor,
                              .step = step,
                              .light = seen->light,
                              .buffer = &work->events,
                              .slopes = work->slopes.on ? &work->slopes : NULL,
                              .error = error},
                    .tile = tile,
                    .first = first,
                    .signals = seen->signals,
                    .coverage = &seen->coverage};
    if (sensor->kick.on && step->length_ns > TD_KICK_STEP_MAX * sensor->kick.recovery_ns)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "sensor: kick_recovery_s is %g, too short for a step of %g s: at least a %gth of it",
                       1e-9 * sensor->kick.recovery_ns, step->length_s, TD_KICK_STEP_MAX);
    job.pixel.start = td_sensor_time(sensor, step->start_ns, step->start_fraction);
    job.stop = (double)(step->stop_ns - sensor->start.ns) + 2; /* stop_ns may be 1 less and is floored */
    const tides_status status = sensor->additive.on || sensor->kick.on ? step_noisy(&job) : step_all(&job);
    if (status != TIDES_OK) {
        undo(&job, before);
        return status;
    }
    if (!sensor->on) job.pixel.counts.cause[TIDES_CAUSE_SIGNAL] = job.pixel.counts.events_on + job.pixel.counts.events_off;
    td_counts_add(&work->counts, &job.pixel.counts);
    return TIDES_OK;
}

/* -- one pixel ------------------------------------------------------------------------------------------------------------- */

/* Advances a pixel of a sensor with blocks. */
static tides_status advance_pixel(const td_pixel_job *pixel, const td_sensor_single *single, td_sensor_counts *counts) {
    const td_ends *ends = single->ends;
    const td_tile tile = {single->x, single->y, 1, 1};
    const td_signals signals = {&ends->S0, &ends->S0_dot, &ends->S1, &ends->S1_dot};
    tile_job job = {.pixel = *pixel,
                    .tile = &tile,
                    .first = single->pixel,
                    .signals = &signals,
                    .coverage = &single->coverage,
                    .pieces = single->pieces};
    job.stop = (double)(single->step->stop_ns - pixel->sensor->start.ns) + 2; /* stop_ns may be 1 less */
    take_levels(&job, 0, 1);
    tides_status status = step_pixel(&job, 0);
    *counts = job.pixel.counts;
    return status;
}

static tides_status advance_ideal(td_pixel_job *pixel, const td_sensor_single *single, td_sensor_counts *counts) {
    const td_ends *ends = single->ends;
    const td_model model =
        td_model_fit(TIDES_MODEL_HERMITE, single->step->length_s, ends->S0, ends->S0_dot, ends->S1, ends->S1_dot);
    tides_status status =
        td_ideal_advance(pixel, single->pixel, (uint16_t)single->x, (uint16_t)single->y, &model, single->pieces, ends->S1);
    *counts = pixel->counts;
    counts->cause[TIDES_CAUSE_SIGNAL] = counts->events_on + counts->events_off;
    return status;
}

tides_status td_sensor_advance(const td_sensor *sensor, const td_sensor_single *single, td_work *work, tides_error *error) {
    td_sensor_counts counts;
    td_pixel_job job = {.sensor = sensor,
                        .step = single->step,
                        .buffer = &work->events,
                        .changes = single->changes,
                        .error = error};
    job.start = td_sensor_time(sensor, single->step->start_ns, single->step->start_fraction);
    single->changes->count = single->changes->lost = 0;
    tides_status status = sensor->on ? advance_pixel(&job, single, &counts) : advance_ideal(&job, single, &counts);
    td_counts_add(&work->counts, &counts);
    return status;
}
