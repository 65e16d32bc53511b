/* Shot noise and hot pixels: candidates are drawn by counter, and shot candidates thinned by light. */
#include "td_shot_noise.h"
#include "td_base.h"
#include "td_math.h"
#include "td_random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t purpose[TD_NOISES] = {TD_RANDOM_SHOT_ON, TD_RANDOM_SHOT_OFF, TD_RANDOM_HOT};

/* v2e's law: the brightest pixel has this share less than the darkest, and intensity is (DN + 20) / 275 with DN = 255 Y. */
static const double brightest_loss = 0.75, dn_offset = 20, dn_range = 275, dn_full = 255;

static double shot_factor(double Y) {
    double dn = fmin(fmax(dn_full * Y, 0), dn_full);
    return 1 - brightest_loss * (dn + dn_offset) / dn_range;
}

double td_shot_noise_share(double Y) { return shot_factor(Y) / shot_factor(0); }

tides_status td_shot_noise_create(const tides_sensor *sensor, size_t pixels, td_shot_noise *noise, tides_error *error) {
    memset(noise, 0, sizeof *noise);
    noise->seed = sensor->seed;
    noise->rate[TD_NOISE_SHOT_ON] = noise->rate[TD_NOISE_SHOT_OFF] = 0.5e-9 * sensor->shot_noise_hz;
    noise->rate[TD_NOISE_HOT] = sensor->hot_pixel_fraction > 0 ? 1e-9 * sensor->hot_pixel_rate_hz : 0;
    for (int k = 0; k < TD_NOISES; k++) {
        if (!(noise->rate[k] > 0)) continue;
        noise->due[k] = td_alloc(pixels, sizeof *noise->due[k], error);
        noise->drawn[k] = td_alloc(pixels, sizeof *noise->drawn[k], error);
        if (noise->due[k] && noise->drawn[k]) continue;
        td_shot_noise_release(noise);
        return TIDES_NO_MEMORY;
    }
    return TIDES_OK;
}

tides_status td_shot_noise_own(td_shot_noise *noise, int source, size_t pixels, tides_error *error) {
    noise->own[source] = td_alloc(pixels, sizeof *noise->own[source], error);
    if (!noise->due[source]) noise->due[source] = td_alloc(pixels, sizeof *noise->due[source], error);
    if (!noise->drawn[source]) noise->drawn[source] = td_alloc(pixels, sizeof *noise->drawn[source], error);
    if (!noise->own[source] || !noise->due[source] || !noise->drawn[source]) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < pixels; i++) noise->own[source][i] = -1;
    return TIDES_OK;
}

double td_shot_noise_rate(const td_shot_noise *noise, int source, size_t i) {
    if (!noise->due[source] || !(noise->due[source][i] < INFINITY)) return 0;
    return noise->own[source] ? noise->own[source][i] : noise->rate[source];
}

void td_shot_noise_release(td_shot_noise *noise) {
    for (int k = 0; k < TD_NOISES; k++) {
        free(noise->own[k]);
        free(noise->due[k]);
        free(noise->drawn[k]);
    }
    memset(noise, 0, sizeof *noise);
}

/* The random bits of candidate `drawn` (from 1) of a source. Half 0 gives the time since the candidate before, half 1 whether
 * it is kept. Index 0 is for whether the pixel is hot. */
static td_random_bits bits_of(const td_shot_noise *noise, int source, uint32_t pixel, uint32_t drawn) {
    return td_random(noise->seed, pixel, drawn, purpose[source]);
}

static void draw_next(const td_shot_noise *noise, int source, size_t i, uint32_t pixel) {
    td_random_bits bits = bits_of(noise, source, pixel, ++noise->drawn[source][i]);
    double rate = noise->own[source] ? noise->own[source][i] : noise->rate[source];
    double wait = floor(td_random_exponential(&bits, 0) / rate + 0.5);
    noise->due[source][i] += fmax(wait, 1);
}

void td_shot_noise_begin(td_shot_noise *noise, const tides_sensor *sensor, size_t i, uint32_t pixel) {
    for (int k = 0; k < TD_NOISES; k++) {
        if (!noise->due[k]) continue;
        td_random_bits bits = bits_of(noise, k, pixel, 0);
        int silent = k == TD_NOISE_HOT && !(td_random_uniform(&bits, 0) < sensor->hot_pixel_fraction);
        double *own = noise->own[k] ? &noise->own[k][i] : NULL;
        if (own && *own >= 0)
            silent = 0;
        else if (own)
            *own = noise->rate[k];
        if (own && !(*own > 0)) silent = 1;
        noise->drawn[k][i] = 0;
        noise->due[k][i] = silent ? INFINITY : 0;
        if (!silent) draw_next(noise, k, i, pixel);
    }
}

int td_shot_noise_next(const td_shot_noise *noise, size_t i, double *due) {
    int first = -1;
    *due = INFINITY;
    for (int k = 0; k < TD_NOISES; k++) {
        if (!noise->due[k] || !(noise->due[k][i] < *due)) continue;
        *due = noise->due[k][i];
        first = k;
    }
    return first;
}

int td_shot_noise_take(const td_shot_noise *noise, int source, size_t i, uint32_t pixel, double L, double log_eps) {
    td_random_bits bits = bits_of(noise, source, pixel, noise->drawn[source][i]);
    draw_next(noise, source, i, pixel);
    return source == TD_NOISE_HOT || td_random_uniform(&bits, 1) < td_shot_noise_share(td_exp(L) - log_eps);
}
