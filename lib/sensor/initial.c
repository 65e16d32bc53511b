/* The state of pixels when a run begins, by sensor.initial.
 *
 * STEADY is a renewal process. At rest a pixel is reset by the leak, C+ / r after the last reset, or by noise events before
 * that. Noise events have the rate n: both shot noises as the pixel's light thins them, and a hot pixel's own. None comes
 * within the refractory period D. So the age a since the last reset has the density of survival,
 *
 *   1 up to D, e^(-n (a - D)) from there to the leak's time T = C+ / r (HOLD: D + C+ / r, for the reference follows while it is
 *   held), 0 beyond,
 *
 * and the signal is r a (HOLD: r (a - D), from 0) above the reference. A leak that brings a pixel to its level within D fires
 * at D (DROP_KEEP), or loses crossings (DROP_CONSUME). Then T is D, and the reference follows in whole thresholds.
 *
 * Additive noise has a memory, so that this law doesn't hold with it: td_steady.h has another. */
#include "td_base.h"
#include "td_between.h"
#include "td_math.h"
#include "td_random.h"
#include "td_sensor.h"
#include "td_sensor_parts.h"
#include "td_single.h"
#include "td_steady.h"

#include <math.h>

/* Rate of noise events of a pixel with log-luminance L [1/ns]. */
static double noise_rate(const td_sensor *sensor, size_t i, double L) {
    const td_shot_noise *noise = &sensor->noise;
    double rate = 0;
    if (noise->due[TD_NOISE_SHOT_ON])
        rate = (td_shot_noise_rate(noise, TD_NOISE_SHOT_ON, i) + td_shot_noise_rate(noise, TD_NOISE_SHOT_OFF, i)) *
               td_shot_noise_share(td_exp(L) - sensor->log_eps);
    return rate + td_shot_noise_rate(noise, TD_NOISE_HOT, i);
}

/* The age below which the share `u` of all ages is, at most INFINITY. Survival is 1 up to `held`, then falls at `rate` for
 * `length`. */
static double age_at(double u, double held, double length, double rate) {
    const double falling = rate > 0 ? -td_expm1(-rate * length) / rate : length;
    const double area = u * (held + falling);
    if (area < held) return area;
    return held + (rate > 0 ? fmin(-td_log1p(-rate * (area - held)) / rate, length) : fmin(area - held, length));
}

/* A random state of a pixel that has been at rest for ever. */
static td_initial steady(const td_sensor *sensor, size_t i, double L) {
    const double leak = sensor->leak[i], on = sensor->threshold_on[i], held = sensor->refractory_ns;
    const int holds = sensor->sensor.refractory_law == TIDES_REFRACTORY_HOLD;
    const double rate = noise_rate(sensor, i, L);
    const double climb = leak > 0 ? on / leak : INFINITY;
    if (!(leak > 0) && !(rate > 0)) return (td_initial){0, 0, 0};
    const double age = age_at(sensor->first.draw[i], held, holds ? climb : fmax(climb - held, 0), rate);
    const double climbed = leak * (holds ? fmax(age - held, 0) : age);
    td_initial at = {climbed, age, fmax(held - age, 0)};
    if (at.offset >= on) at.offset = fmod(at.offset, on); /* rounding, or crossings lost in the refractory period */
    return at;
}

td_initial td_sensor_initial(const td_sensor *sensor, size_t i, double L) {
    td_initial at = {0, 0, 0};
    const double on = td_sensor_threshold_on(sensor, i), off = td_sensor_threshold_off(sensor, i);
    if (!sensor->first.draw || on >= TD_OUT_OF_REACH) return at;
    if (sensor->sensor.initial == TIDES_INITIAL_STEADY) return steady(sensor, i, L);
    at.offset = sensor->first.draw[i] * (on + off) - off;
    return at;
}

static int draws(const td_sensor *sensor) {
    const int32_t initial = sensor->sensor.initial;
    return initial == TIDES_INITIAL_RANDOM || (initial == TIDES_INITIAL_STEADY && sensor->on);
}

tides_status td_sensor_draw_initial(td_sensor *sensor, const td_sensor_tiles *tiles, tides_error *error) {
    if (!draws(sensor)) return TIDES_OK;
    sensor->first.draw = td_alloc(sensor->count, sizeof *sensor->first.draw, error);
    if (!sensor->first.draw) return TIDES_NO_MEMORY;
    if (sensor->additive.on) td_steady_begin(sensor);
    size_t i = 0;
    for (const td_tile *tile = tiles->tile; tile < tiles->tile + tiles->count; tile++)
        for (int32_t k = 0; k < tile->count; k++, i++) {
            const int32_t x = tile->x0 + k % tile->width, y = tile->y0 + k / tile->width;
            const uint32_t pixel = (uint32_t)y * (uint32_t)sensor->image_width + (uint32_t)x;
            const td_random_bits bits = td_random(sensor->sensor.seed, pixel, 0, TD_RANDOM_INITIAL);
            sensor->first.draw[i] = td_random_uniform(&bits, 0);
        }
    return TIDES_OK;
}

void td_sensor_refer(const td_sensor *sensor, size_t i, double L) {
    const double offset = sensor->first.draw ? td_sensor_initial(sensor, i, L).offset : 0;
    sensor->pixels.initial[i] = sensor->pixels.reference[i] = L - offset;
}

/* Starts the pixel's noise as a process that has gone on for ever in this light. */
static void begin_noise(const td_sensor *sensor, size_t i, double L) {
    const double light = isfinite(L) ? L : 0;
    sensor->segment.number[i] = 0;
    sensor->segment.value[i] = td_additive_noise_first(&sensor->additive, sensor->segment.pixel[i], light);
    if (sensor->segment.light) sensor->segment.light[i] = light;
    td_sensor_resume_noise(sensor, i);
}

/* Sets the pixel's filters and noise. Returns its signal. */
static double rest(const td_sensor *sensor, size_t i, double L) {
    double state[TD_FRONTEND_STATE] = {0}, signal = L;
    if (sensor->frontend.on) signal = td_frontend_rest(&sensor->frontend, L, sensor->log_eps, state);
    for (int k = 0; k < TD_FRONTEND_STATE; k++)
        if (sensor->filtered.state[k]) sensor->filtered.state[k][i] = state[k];
    if (sensor->filtered.error) sensor->filtered.error[i] = 0;
    if (sensor->additive.on) begin_noise(sensor, i, L);
    return signal;
}

/* The initial states of `count` pixels from number `first` on, whose additive noise at the run's start is `now`. */
static void find_initial(const td_sensor *sensor, size_t first, int count, const double *L, const double *now,
                         td_initial *initial) {
    td_rested at[TD_RESTED_MAX];
    td_initial found[TD_RESTED_MAX];
    int of[TD_RESTED_MAX], some = 0;
    const int is_steady = sensor->first.draw && sensor->additive.on && sensor->sensor.initial == TIDES_INITIAL_STEADY;
    for (int k = 0; k < count; k++) {
        const size_t i = first + (size_t)k;
        const double on = td_sensor_threshold_on(sensor, i), off = td_sensor_threshold_off(sensor, i);
        if (!is_steady || on >= TD_OUT_OF_REACH) {
            initial[k] = td_sensor_initial(sensor, i, L[i]);
            continue;
        }
        const td_noise_segment noise = td_sensor_noise_segment(sensor, i);
        const int varies = sensor->additive.varies;
        td_rested *one = &at[some];
        *one = (td_rested){.i = i, .rate = noise_rate(sensor, i, L[i]), .begin = noise.begin, .now = now[k]};
        one->sigma = varies ? noise.sigma : sensor->additive.sigma;
        one->tau = varies ? noise.tau_ns : td_additive_noise_tau(&sensor->additive);
        initial[k] = (td_initial){sensor->first.draw[i] * (on + off) - off, 0, 0};
        if (one->sigma > 0) of[some++] = k;
    }
    if (some > 0) td_steady_noise(sensor, at, some, found);
    for (int n = 0; n < some; n++) initial[of[n]] = found[n];
}

/* Begins `count` pixels from number `first` on, at most TD_RESTED_MAX. */
static void begin_some(const td_sensor *sensor, size_t first, int count, const double *L) {
    const td_pixels *pixels = &sensor->pixels;
    td_initial initial[TD_RESTED_MAX];
    double signal[TD_RESTED_MAX], noise[TD_RESTED_MAX];
    for (int k = 0; k < count; k++) {
        signal[k] = rest(sensor, first + (size_t)k, L[first + (size_t)k]);
        noise[k] = sensor->additive.on ? td_sensor_noise_at(sensor, first + (size_t)k, 0) : 0;
    }
    find_initial(sensor, first, count, L, noise, initial);
    for (int k = 0; k < count; k++) {
        const size_t i = first + (size_t)k;
        pixels->initial[i] = pixels->reference[i] = signal[k] + noise[k] - initial[k].offset;
        pixels->count_on[i] = pixels->count_off[i] = 0;
        if (!sensor->first.draw || !sensor->on) continue;
        sensor->since[i] = -initial[k].age;
        if (initial[k].held > 0) sensor->held_until[i] = initial[k].held;
        td_sensor_set_wake(sensor, i);
    }
}

typedef struct beginning {
    const td_sensor *sensor;
    const double *L;
} beginning;

/* Block k of the pixels. Which pixels share a block changes none of them. */
static void begin_block(void *user, int k) {
    const beginning *all = user;
    const size_t first = (size_t)k * TD_RESTED_MAX, left = all->sensor->count - first;
    begin_some(all->sensor, first, (int)(left < TD_RESTED_MAX ? left : TD_RESTED_MAX), all->L);
}

void td_sensor_begin(td_sensor *sensor, const double *L, td_pool *pool) {
    beginning all = {sensor, L};
    td_pool_run(pool, (int)((sensor->count + TD_RESTED_MAX - 1) / TD_RESTED_MAX), begin_block, &all);
}
