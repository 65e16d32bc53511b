/* Ornstein-Uhlenbeck noise by counter. */
#include "td_additive_noise.h"
#include "td_base.h"
#include "td_random.h"

#include <math.h>
#include <string.h>

static const double two_pi = 6.28318530717958647692;
static const double lines_per_tau = 8;

/* Faster noise would have lines of less than a nanosecond, in which times are written. */
static const double largest_cutoff_hz = 1e7;

tides_status td_additive_noise_make(const tides_sensor *sensor, td_additive_noise *noise, tides_error *error) {
    memset(noise, 0, sizeof *noise);
    if (!(sensor->noise_rms >= 0) || !isfinite(sensor->noise_rms))
        return td_fail(error, TIDES_BAD_ARGUMENT, "noise_rms: %g must be a number of log units, at least 0", sensor->noise_rms);
    if (sensor->noise_rms == 0) return TIDES_OK;
    if (!(sensor->noise_cutoff_hz > 0) || !(sensor->noise_cutoff_hz <= largest_cutoff_hz))
        return td_fail(error, TIDES_BAD_ARGUMENT, "noise_cutoff_hz: %g Hz must lie in (0, %g]: noise_rms wants it",
                       sensor->noise_cutoff_hz, largest_cutoff_hz);
    noise->on = 1;
    noise->seed = sensor->seed;
    noise->spacing_ns = 1e9 / (two_pi * sensor->noise_cutoff_hz * lines_per_tau);
    noise->rho = exp(-1 / lines_per_tau);
    noise->sigma = sensor->noise_rms * sqrt(3 / (2 + noise->rho));
    noise->change = noise->sigma * sqrt(-expm1(-2 / lines_per_tau));
    return TIDES_OK;
}

/* n(k) and its neighbour, k even first. */
static void normals_of(const td_additive_noise *noise, uint32_t pixel, uint64_t k, double normal[2]) {
    td_random_bits bits = td_random(noise->seed, pixel, 1 + k / 2, TD_RANDOM_NOISE);
    td_random_normals(&bits, normal);
}

/* Where line 0 begins: at or before the run's start. */
static double origin_of(const td_additive_noise *noise, uint32_t pixel) {
    td_random_bits bits = td_random(noise->seed, pixel, 0, TD_RANDOM_NOISE);
    return -td_random_uniform(&bits, 0) * noise->spacing_ns;
}

/* What follows from k, begin, origin_ns and normal. */
static void finish(const td_additive_noise *noise, td_noise_line *line) {
    line->from_ns = line->origin_ns + (double)line->k * noise->spacing_ns;
    line->to_ns = line->origin_ns + (double)(line->k + 1) * noise->spacing_ns;
    line->end = noise->rho * line->begin + noise->change * line->normal[(line->k + 1) % 2];
}

td_noise_line td_additive_noise_resume(const td_additive_noise *noise, uint32_t pixel, uint64_t k, double value) {
    td_noise_line line = {.k = k, .begin = value, .origin_ns = origin_of(noise, pixel)};
    normals_of(noise, pixel, k + 1, line.normal);
    finish(noise, &line);
    return line;
}

td_noise_line td_additive_noise_first(const td_additive_noise *noise, uint32_t pixel) {
    double normal[2]; /* x(0) = sigma n(0) */
    normals_of(noise, pixel, 0, normal);
    return td_additive_noise_resume(noise, pixel, 0, noise->sigma * normal[0]);
}

td_noise_line td_additive_noise_next(const td_additive_noise *noise, uint32_t pixel, const td_noise_line *line) {
    td_noise_line next = *line;
    next.k++;
    next.begin = line->end;
    if ((next.k + 1) % 2 == 0) normals_of(noise, pixel, next.k + 1, next.normal);
    finish(noise, &next);
    return next;
}

void td_additive_noise_seek(const td_additive_noise *noise, uint32_t pixel, double time_ns, td_noise_line *line) {
    while (line->to_ns < time_ns) *line = td_additive_noise_next(noise, pixel, line);
}

void td_noise_line_add(const td_noise_line *line, double from_ns, double to_ns, td_path *path) {
    double begin = td_noise_line_at(line, from_ns), end = td_noise_line_at(line, to_ns);
    for (int i = 0; i < 4; i++) path->cubic.control[i] += begin + (end - begin) * (i / 3.0);
}
