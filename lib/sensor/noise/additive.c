/* Ornstein-Uhlenbeck noise by counter: its values at the points of a time grid, for one pixel or for many side by side. */
#include "td_additive_noise.h"
#include "td_base.h"
#include "td_math.h"
#include "td_noise_bridge.h"
#include "td_wide.h"

#include <math.h>
#include <string.h>

/* A choice. Where segments are long few points are drawn for pixels that are far from their levels, but the noise's bound on a
 * segment is wide. User time of the demo's first 50 ms, with a threshold of 10 noise_rms: 6.4 s with 8 per tau, 5.0 with 4,
 * 4.6 with 2, 4.4 with 1. With 1 the process would be up to 8 % wider than the bridge that its bound is of
 * (td_noise_bridge.h). */
static const double segments_per_tau = 2;

/* Highest cutoff: faster noise would have segments of less than a nanosecond, the unit of times. */
static const double largest_cutoff_hz = 1e7;

static tides_status check(const tides_sensor *sensor, tides_error *error) {
    if (!(sensor->noise_rms >= 0) || !isfinite(sensor->noise_rms))
        return td_fail(error, TIDES_BAD_ARGUMENT, "noise_rms: %g must be a number of log units, at least 0", sensor->noise_rms);
    if (!(sensor->noise_sigma >= 0 && sensor->noise_sigma <= 1))
        return td_fail(error, TIDES_BAD_ARGUMENT, "noise_sigma is %g; it must lie in [0, 1] decades", sensor->noise_sigma);
    return TIDES_OK;
}

/* Size and tau at Y = 1 of noise that depends on light. sigma is the larger of that and of the dark's. */
static tides_status take_light(td_additive_noise *noise, double *tau_ns, tides_error *error) {
    const double brightest = td_log1p(noise->light.log_eps),
                 darkest = noise->light.log_eps > 0 ? td_ln(noise->light.log_eps) : -700;
    double dark_sigma, dark_tau_ns;
    td_noise_light_at(&noise->light, darkest, &dark_sigma, &dark_tau_ns);
    td_noise_light_at(&noise->light, brightest, &noise->sigma, tau_ns);
    noise->sigma = fmax(noise->sigma, dark_sigma);
    if (*tau_ns >= 1e9 / (2 * TD_PI * largest_cutoff_hz)) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT, "noise_law photocurrent: a bandwidth of %g Hz at Y = 1; it must be at most %g",
                   1e9 / (2 * TD_PI * *tau_ns), largest_cutoff_hz);
}

td_noise_move td_noise_move_of(double sigma, double l) { return (td_noise_move){td_exp(-l), sigma * sqrt(-td_expm1(-2 * l))}; }

tides_status td_additive_noise_make(const tides_sensor *sensor, double log_eps, td_additive_noise *noise, tides_error *error) {
    double tau_ns = 1e9 / (2 * TD_PI * sensor->noise_cutoff_hz);
    memset(noise, 0, sizeof *noise);
    tides_status status = check(sensor, error);
    if (status == TIDES_OK) status = td_noise_light_make(sensor, log_eps, &noise->light, error);
    if (status != TIDES_OK || (sensor->noise_rms == 0 && !noise->light.on)) return status;
    noise->sigma = sensor->noise_rms;
    if (noise->light.on)
        status = take_light(noise, &tau_ns, error);
    else if (!(sensor->noise_cutoff_hz > 0) || !(sensor->noise_cutoff_hz <= largest_cutoff_hz))
        return td_fail(error, TIDES_BAD_ARGUMENT, "noise_cutoff_hz: %g Hz must lie in (0, %g]: noise_rms wants it",
                       sensor->noise_cutoff_hz, largest_cutoff_hz);
    if (status != TIDES_OK) return status;
    noise->on = 1;
    noise->varies = noise->light.on || sensor->noise_sigma > 0;
    noise->spread = sensor->noise_sigma;
    noise->seed = sensor->seed;
    noise->threshold = fmin(sensor->threshold_on, sensor->threshold_off);
    noise->spacing_ns = tau_ns / segments_per_tau;
    noise->move = td_noise_move_of(noise->sigma, 1 / segments_per_tau);
    noise->usual_ns = tau_ns;
    noise->usual_move = td_noise_move_of(1, noise->spacing_ns / tau_ns);
    td_noise_bridge_make(noise, noise->spacing_ns * segments_per_tau, noise->threshold);
    if (noise->varies) noise->reach = 0; /* td_additive_noise_sweep includes it in its bounds */
    return TIDES_OK;
}

void td_additive_noise_give(td_additive_noise *noise, double *own) {
    noise->own = own;
    if (!noise->on) return;
    noise->varies = 1;
    noise->reach = 0;
}

/* -- one pixel ------------------------------------------------------------------------------------------------------------- */

/* Random number 0 is for this; the normals of block b come of number b + 1. */
double td_additive_noise_origin(const td_additive_noise *noise, uint32_t pixel) {
    td_random_bits bits = td_random(noise->seed, pixel, 0, TD_RANDOM_NOISE);
    return -td_random_uniform(&bits, 0) * noise->spacing_ns;
}

/* Draws the block of normals that contains n(k). Noise that varies draws half of it: it seldom needs another soon. */
static void draw_block(const td_additive_noise *noise, uint32_t pixel, uint64_t k, float normal[TD_NOISE_BLOCK]) {
    const td_random_bits bits = td_random(noise->seed, pixel, 1 + k / TD_NOISE_BLOCK, TD_RANDOM_NOISE);
    for (int half = 0; half < 2; half++)
        if (!noise->varies || half == (int)(k % TD_NOISE_BLOCK / 2)) td_random_short_normals(&bits, half, normal + 2 * half);
}

static double end_of_segment(const td_additive_noise *noise, double origin_ns, double k) {
    return origin_ns + (k + 1) * noise->spacing_ns;
}

double td_additive_noise_tau(const td_additive_noise *noise) { return noise->spacing_ns * segments_per_tau; }

double td_additive_noise_own(const td_additive_noise *noise, uint32_t pixel) {
    double normal[2];
    if (noise->own && !isnan(noise->own[pixel])) return noise->own[pixel];
    if (!(noise->spread > 0)) return 1;
    td_random_bits bits = td_random(noise->seed, pixel, 0, TD_RANDOM_NOISE_SIZE);
    td_random_normals(&bits, normal);
    return td_pow(10, noise->spread * normal[0]);
}

/* Size and tau of the pixel in this light. */
static void size_of(const td_additive_noise *noise, double own, double light, double *sigma, double *tau_ns) {
    *sigma = noise->sigma;
    *tau_ns = noise->spacing_ns * segments_per_tau;
    if (noise->light.on) td_noise_light_at(&noise->light, light, sigma, tau_ns);
    *sigma *= own;
}

/* Fills in the rest of a segment from its k, begin, origin_ns, normal and light. */
static void finish(const td_additive_noise *noise, td_noise_segment *segment) {
    const double normal = (double)segment->normal[(segment->k + 1) % TD_NOISE_BLOCK];
    segment->from_ns = segment->origin_ns + (double)segment->k * noise->spacing_ns;
    segment->to_ns = end_of_segment(noise, segment->origin_ns, (double)segment->k);
    if (noise->varies) {
        size_of(noise, segment->own, segment->light, &segment->sigma, &segment->tau_ns);
        segment->reach = td_noise_reach(noise, segment->sigma, segment->tau_ns);
        td_noise_move move = noise->usual_move;
        if (segment->tau_ns != noise->usual_ns) move = td_noise_move_of(1, noise->spacing_ns / segment->tau_ns);
        move.adds *= segment->sigma;
        segment->end = td_noise_moved(move, segment->begin, normal);
    } else {
        segment->reach = noise->reach;
        segment->end = td_noise_moved(noise->move, segment->begin, normal);
    }
}

td_noise_segment td_additive_noise_resume(const td_additive_noise *noise, uint32_t pixel, uint64_t k, double value,
                                          double light) {
    td_noise_segment segment = {.k = k,
                                .begin = value,
                                .origin_ns = td_additive_noise_origin(noise, pixel),
                                .light = light,
                                .own = td_additive_noise_own(noise, pixel)};
    draw_block(noise, pixel, k + 1, segment.normal);
    finish(noise, &segment);
    return segment;
}

td_noise_segment td_additive_noise_again(const td_additive_noise *noise, uint64_t k, double value, double light,
                                         const td_noise_now *now) {
    return (td_noise_segment){.k = k,
                              .begin = value,
                              .light = light,
                              .origin_ns = now->origin_ns,
                              .own = now->own,
                              .sigma = now->sigma,
                              .tau_ns = now->tau_ns,
                              .reach = now->reach,
                              .end = now->end,
                              .from_ns = now->origin_ns + (double)k * noise->spacing_ns,
                              .to_ns = end_of_segment(noise, now->origin_ns, (double)k)};
}

double td_additive_noise_first(const td_additive_noise *noise, uint32_t pixel, double light) {
    float normal[TD_NOISE_BLOCK];
    double sigma, tau_ns;
    draw_block(noise, pixel, 0, normal);
    size_of(noise, td_additive_noise_own(noise, pixel), light, &sigma, &tau_ns);
    return sigma * (double)normal[0];
}

void td_additive_noise_next(const td_additive_noise *noise, uint32_t pixel, double light, td_noise_segment *segment) {
    segment->k++;
    segment->begin = segment->end;
    if (isfinite(light)) segment->light = light;
    if ((segment->k + 1) % TD_NOISE_BLOCK == 0 || noise->varies) draw_block(noise, pixel, segment->k + 1, segment->normal);
    finish(noise, segment);
}

void td_additive_noise_seek(const td_additive_noise *noise, uint32_t pixel, double time_ns, td_noise_segment *segment) {
    while (segment->to_ns < time_ns) td_additive_noise_next(noise, pixel, segment->light, segment);
}

/* The segment from x(k) = begin to the path's x(k + 1). */
static td_noise_segment take_path(const td_additive_noise *noise, const td_noise_path *path, uint64_t k, double begin) {
    td_noise_segment segment;
    segment.k = k;
    segment.begin = begin;
    segment.origin_ns = path->origin_ns;
    segment.light = 0;
    segment.from_ns = segment.origin_ns + (double)k * noise->spacing_ns;
    segment.to_ns = end_of_segment(noise, segment.origin_ns, (double)k);
    segment.reach = noise->reach;
    segment.end = path->x[(k + 1 - path->from) * TD_RANDOM_LANES];
    return segment;
}

td_noise_segment td_additive_noise_along(const td_additive_noise *noise, uint32_t pixel, uint64_t k, double value, double light,
                                         td_noise_path *path) {
    if (path->x && k + 1 - path->from < TD_NOISE_PATH) return take_path(noise, path, k, value);
    path->x = NULL;
    return td_additive_noise_resume(noise, pixel, k, value, light);
}

void td_additive_noise_next_along(const td_additive_noise *noise, uint32_t pixel, double light, td_noise_path *path,
                                  td_noise_segment *segment) {
    if (path->x)
        *segment = td_additive_noise_along(noise, pixel, segment->k + 1, segment->end, light, path);
    else
        td_additive_noise_next(noise, pixel, light, segment);
}

/* -- many pixels ----------------------------------------------------------------------------------------------------------- */

/* Pixels of a sweep. Values that change from point to point are arrays, so that compilers vectorise. */
typedef struct lanes {
    uint32_t pixel[TD_RANDOM_LANES];
    uint64_t number[TD_RANDOM_LANES];                         /* number of the next block of normals */
    double point[TD_RANDOM_LANES];                            /* the block's first one is n(point) */
    double first[TD_RANDOM_LANES], last[TD_RANDOM_LANES];     /* numbers of segments */
    double x[TD_RANDOM_LANES], begin[TD_RANDOM_LANES];        /* the process at `point`, and at the last segment's start */
    double lowest[TD_RANDOM_LANES], highest[TD_RANDOM_LANES]; /* x so far */
    double origin[TD_RANDOM_LANES];                           /* of segment 0 [ns] */
} lanes;

/* The number of the segment that contains the step's end, from `first` on; computed with the rounding of pixel.c. */
static double last_segment(const td_additive_noise *noise, double origin_ns, double first, double start_ns, double length_ns) {
    double k = (double)(int64_t)((start_ns + length_ns - origin_ns) / noise->spacing_ns) - 1;
    if (!(k > first)) k = first;
    while (k > first && td_place_of(end_of_segment(noise, origin_ns, k - 1), start_ns, length_ns) >= 1) k--;
    while (td_place_of(end_of_segment(noise, origin_ns, k), start_ns, length_ns) < 1) k++;
    return k;
}

/* Sets the lanes' first blocks of normals. Returns how many blocks the longest of them needs. */
static int64_t begin_lanes(const td_additive_noise *noise, double start_ns, double length_ns, lanes *l) {
    int64_t most = 0;
    for (int i = 0; i < TD_RANDOM_LANES; i++) {
        const int64_t block = ((int64_t)l->first[i] + 1) / TD_NOISE_BLOCK;
        l->last[i] = last_segment(noise, l->origin[i], l->first[i], start_ns, length_ns);
        l->number[i] = (uint64_t)block + 1;
        l->point[i] = (double)(TD_NOISE_BLOCK * block);
        l->begin[i] = l->lowest[i] = l->highest[i] = l->x[i];
        const int64_t blocks = ((int64_t)l->last[i] + 1) / TD_NOISE_BLOCK - block + 1;
        most = blocks > most ? blocks : most;
    }
    return most;
}

/* Advances the lanes by the normals n(point + after), where these belong to their segments, and keeps x. */
TD_WIDE static void advance(const td_additive_noise *noise, double after, const float *restrict normal, lanes *restrict l,
                            double *restrict kept) {
    for (int i = 0; i < TD_RANDOM_LANES; i++) {
        const double point = l->point[i] + after, next = td_noise_moved(noise->move, l->x[i], (double)normal[i]);
        double x = l->x[i];
        x = point > l->first[i] ? next : x;
        x = point <= l->last[i] + 1 ? x : l->x[i];
        l->begin[i] = point <= l->last[i] ? x : l->begin[i];
        l->lowest[i] = x < l->lowest[i] ? x : l->lowest[i];
        l->highest[i] = x > l->highest[i] ? x : l->highest[i];
        l->x[i] = kept[i] = x;
    }
}

static void sweep_lanes(const td_additive_noise *noise, double start_ns, double length_ns, lanes *l, double *path) {
    float normal[TD_NOISE_BLOCK][TD_RANDOM_LANES];
    double beyond[TD_RANDOM_LANES];
    int kept = 0;
    td_random_lanes bits;
    for (int64_t left = begin_lanes(noise, start_ns, length_ns, l); left > 0; left--) {
        td_random_many(noise->seed, l->pixel, l->number, TD_RANDOM_NOISE, &bits);
        td_random_short_normals_many(&bits, normal);
        for (int n = 0; n < TD_NOISE_BLOCK; n++, kept++)
            advance(noise, n, normal[n], l, kept < TD_NOISE_PATH ? path + kept * TD_RANDOM_LANES : beyond);
        for (int i = 0; i < TD_RANDOM_LANES; i++) {
            l->number[i]++;
            l->point[i] += TD_NOISE_BLOCK;
        }
    }
}

/* td_additive_noise_sweep for noise that depends on light or pixel: one pixel after the other. */
static void sweep_varying(const td_additive_noise *noise, double start_ns, double length_ns, const uint32_t *pixel,
                          size_t count, const td_noise_sweep *sweep) {
    for (size_t i = 0; i < count; i++) {
        td_noise_few *few = &sweep->at[i];
        td_noise_segment *at = &few->segment[0];
        double low = INFINITY, high = -INFINITY;
        for (few->count = 1;; few->count++) {
            low = fmin(low, fmin(at->begin, at->end) - at->reach);
            high = fmax(high, fmax(at->begin, at->end) + at->reach);
            const double until = td_place_of(at->to_ns, start_ns, length_ns);
            if (!(until < 1)) break;
            if (few->count < TD_NOISE_FEW) {
                at[1] = at[0];
                at++;
            }
            td_additive_noise_next(noise, pixel[i], td_noise_light_of(&sweep->input[i], until), at);
        }
        sweep->segment[i] = (double)at->k;
        sweep->value[i] = at->begin;
        sweep->low[i] = low;
        sweep->high[i] = high;
    }
}

void td_additive_noise_sweep(const td_additive_noise *noise, double start_ns, double length_ns, const uint32_t *pixel,
                             size_t count, const td_noise_sweep *sweep) {
    if (noise->varies) {
        sweep_varying(noise, start_ns, length_ns, pixel, count, sweep);
        return;
    }
    for (size_t done = 0; done < count; done += TD_RANDOM_LANES) {
        lanes l;
        for (size_t i = 0; i < TD_RANDOM_LANES; i++) {
            const size_t j = done + i < count ? done + i : done; /* the last group repeats its first pixel */
            l.pixel[i] = pixel[j];
            l.first[i] = sweep->segment[j];
            l.x[i] = sweep->value[j];
            l.origin[i] = sweep->origin[j];
        }
        double *path = sweep->path + done * TD_NOISE_PATH;
        sweep_lanes(noise, start_ns, length_ns, &l, path);
        for (size_t i = 0; i < TD_RANDOM_LANES && done + i < count; i++) {
            const uint64_t block = ((uint64_t)l.first[i] + 1) / TD_NOISE_BLOCK;
            sweep->paths[done + i] = (td_noise_path){path + i, block * TD_NOISE_BLOCK, l.origin[i]};
            sweep->segment[done + i] = l.last[i];
            sweep->value[done + i] = l.begin[i];
            sweep->low[done + i] = l.lowest[i];
            sweep->high[done + i] = l.highest[i];
        }
    }
}
