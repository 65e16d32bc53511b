/* Creates a sensor's pixels: checks parameters, allocates memory, and draws what is drawn once per pixel. The state in which a
 * run begins is set in initial.c. */
#include "td_base.h"
#include "td_maps.h"
#include "td_math.h"
#include "td_random.h"
#include "td_sensor.h"
#include "td_sensor_parts.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* -- parameters ---------------------------------------------------------------------------------------------------------- */

/* Highest rates: intervals must be many whole nanoseconds. */
static const double most_hz = 1e6;

tides_status td_sensor_check_levels(const tides_sensor *s, int32_t model, tides_error *error) {
    if (!(s->threshold_on > 0.0 && s->threshold_on <= DBL_MAX))
        return td_fail(error, TIDES_BAD_ARGUMENT, "threshold_on is %g; it must be finite and above 0", s->threshold_on);
    if (!(s->threshold_off > 0.0 && s->threshold_off <= DBL_MAX))
        return td_fail(error, TIDES_BAD_ARGUMENT, "threshold_off is %g; it must be finite and above 0", s->threshold_off);
    if (model < TIDES_MODEL_LINEAR || model > TIDES_MODEL_SECANT)
        return td_fail(error, TIDES_BAD_ARGUMENT, "model is %d; it must be one of TIDES_MODEL_*", (int)model);
    if (s->max_events_per_step < 1)
        return td_fail(error, TIDES_BAD_ARGUMENT, "max_events_per_step is %d; it must be at least 1",
                       (int)s->max_events_per_step);
    return TIDES_OK;
}

/* The nominal pixel's leak rate [Hz]: that of the reset switch's junction, and the part that light adds. */
static double leak_of(const tides_sensor *s) {
    static const double doubles_c = 8, typed_at_c = 25;
    double rate = s->leak_rate_hz;
    if (s->temperature_c != typed_at_c) rate *= td_pow(2, (s->temperature_c - typed_at_c) / doubles_c);
    if (s->leak_hz_per_a > 0) rate += s->leak_hz_per_a * td_middle_current(&s->circuit);
    return rate;
}

tides_status td_sensor_check(const tides_sensor *s, tides_error *error) {
    const struct {
        const char *name;
        double value, most;
    } fields[] = {{"threshold_sigma", s->threshold_sigma, DBL_MAX},
                  {"refractory_s", s->refractory_s, DBL_MAX},
                  {"leak_rate_hz", s->leak_rate_hz, most_hz},
                  {"leak_sigma", s->leak_sigma, 10},
                  {"leak_hz_per_a", s->leak_hz_per_a, 1e18},
                  {"b_min", s->b_min, 1},
                  {"shot_noise_hz", s->shot_noise_hz, most_hz},
                  {"hot_pixel_fraction", s->hot_pixel_fraction, 1},
                  {"hot_pixel_rate_hz", s->hot_pixel_rate_hz, most_hz},
                  {"dead_pixel_fraction", s->dead_pixel_fraction, 1}};
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        if (!(fields[i].value >= 0 && fields[i].value <= fields[i].most))
            return td_fail(error, TIDES_BAD_ARGUMENT, "sensor: %s is %g; it must lie in [0, %g]", fields[i].name,
                           fields[i].value, fields[i].most);
    if (!(fabs(s->threshold_parity) < 1))
        return td_fail(error, TIDES_BAD_ARGUMENT, "sensor: threshold_parity is %g; it must lie in (-1, 1)",
                       s->threshold_parity);
    if (!(s->temperature_c >= -273.15 && s->temperature_c <= 200))
        return td_fail(error, TIDES_BAD_ARGUMENT, "sensor: temperature_c is %g; it must lie in [-273.15, 200]",
                       s->temperature_c);
    if (!(leak_of(s) <= most_hz))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "sensor: leak_rate_hz at temperature_c with leak_hz_per_a is %g Hz; it must be at most %g", leak_of(s),
                       most_hz);
    if (s->threshold_sigma > 0 && !(s->threshold_min > 0 && s->threshold_min <= DBL_MAX))
        return td_fail(error, TIDES_BAD_ARGUMENT, "sensor: threshold_min is %g; it must be above 0 and finite",
                       s->threshold_min);
    if (s->refractory_law < TIDES_REFRACTORY_HOLD || s->refractory_law > TIDES_REFRACTORY_DROP_CONSUME)
        return td_fail(error, TIDES_BAD_ARGUMENT, "sensor: refractory_law is %d; it must be one of TIDES_REFRACTORY_*",
                       (int)s->refractory_law);
    if (s->initial < TIDES_INITIAL_REST || s->initial > TIDES_INITIAL_STEADY)
        return td_fail(error, TIDES_BAD_ARGUMENT, "sensor: initial is %d; it must be one of TIDES_INITIAL_*", (int)s->initial);
    return TIDES_OK;
}

static int makes_noise(const tides_sensor *s) {
    return s->shot_noise_hz > 0 || (s->hot_pixel_fraction > 0 && s->hot_pixel_rate_hz > 0);
}

/* -- pixels -------------------------------------------------------------------------------------------------------------- */

/* Sets the pixel's own rates, where maps have them. */
static void set_noise(td_shot_noise *noise, const td_maps *maps, size_t i, uint32_t pixel) {
    if (td_maps_has(maps, TD_MAP_NOISE, pixel))
        noise->own[TD_NOISE_SHOT_ON][i] = noise->own[TD_NOISE_SHOT_OFF][i] = 0.5e-9 * maps->map[TD_MAP_NOISE][pixel];
    if (td_maps_has(maps, TD_MAP_HOT, pixel)) noise->own[TD_NOISE_HOT][i] = 1e-9 * maps->map[TD_MAP_HOT][pixel];
}

static void draw_pixel(td_sensor *sensor, const td_maps *maps, double leak, size_t i, uint32_t pixel) {
    const tides_sensor *s = &sensor->sensor;
    double on = s->threshold_on, off = s->threshold_off, normal[2];
    if (s->threshold_parity != 0) {
        const double part = pixel % (uint32_t)sensor->image_width % 2 ? 1 + s->threshold_parity : 1 - s->threshold_parity;
        on *= part;
        off *= part;
    }
    if (s->threshold_sigma > 0) {
        td_random_bits bits = td_random(s->seed, pixel, 0, TD_RANDOM_THRESHOLD);
        td_random_normals(&bits, normal);
        on = fmax(on + s->threshold_sigma * normal[0], s->threshold_min);
        off = fmax(off + s->threshold_sigma * normal[1], s->threshold_min);
    }
    if (td_maps_has(maps, TD_MAP_ON, pixel)) on = maps->map[TD_MAP_ON][pixel];
    if (td_maps_has(maps, TD_MAP_OFF, pixel)) off = maps->map[TD_MAP_OFF][pixel];
    double rate = leak;
    if (s->leak_sigma > 0 && rate > 0) {
        td_random_bits bits = td_random(s->seed, pixel, 0, TD_RANDOM_LEAK);
        td_random_normals(&bits, normal);
        rate *= td_pow(10, s->leak_sigma * normal[0]);
    }
    if (td_maps_has(maps, TD_MAP_LEAK, pixel)) rate = 1e-9 * maps->map[TD_MAP_LEAK][pixel];
    sensor->leak[i] = rate * on;
    td_random_bits bits = td_random(s->seed, pixel, 0, TD_RANDOM_DEAD);
    int dead = s->dead_pixel_fraction > 0 && td_random_uniform(&bits, 0) < s->dead_pixel_fraction;
    if (td_maps_has(maps, TD_MAP_DEAD, pixel)) dead = maps->map[TD_MAP_DEAD][pixel] > 0;
    if (dead) {
        on = off = TD_OUT_OF_REACH;
        sensor->leak[i] = 0;
    }
    sensor->threshold_on[i] = on;
    sensor->threshold_off[i] = off;
    sensor->held_until[i] = -INFINITY;
    sensor->since[i] = 0;
    set_noise(&sensor->noise, maps, i, pixel);
    td_shot_noise_begin(&sensor->noise, s, i, pixel);
    for (int k = 0; k < TD_NOISES && dead; k++)
        if (sensor->noise.due[k]) sensor->noise.due[k][i] = INFINITY;
    if (sensor->segment.pixel) sensor->segment.pixel[i] = pixel;
    if (sensor->additive.on) {
        sensor->segment.number[i] = 0;
        sensor->segment.value[i] = 0;
        if (sensor->segment.origin) sensor->segment.origin[i] = td_additive_noise_origin(&sensor->additive, pixel);
    }
    td_sensor_set_wake(sensor, i);
}

static void draw_pixels(td_sensor *sensor, const td_maps *maps, const td_sensor_tiles *tiles) {
    const double leak = 1e-9 * leak_of(&sensor->sensor);
    size_t i = 0;
    for (const td_tile *tile = tiles->tile; tile < tiles->tile + tiles->count; tile++)
        for (int32_t k = 0; k < tile->count; k++) {
            int32_t x = tile->x0 + k % tile->width, y = tile->y0 + k / tile->width;
            draw_pixel(sensor, maps, leak, i++, (uint32_t)y * (uint32_t)sensor->image_width + (uint32_t)x);
        }
}

static tides_status allocate(td_sensor *sensor, tides_error *error) {
    td_pixels *pixels = &sensor->pixels;
    double **arrays[] = {&pixels->initial, &pixels->reference};
    uint32_t **counts[] = {&pixels->count_on, &pixels->count_off};
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        if (!(*arrays[k] = td_alloc(sensor->count, sizeof **arrays[k], error))) return TIDES_NO_MEMORY;
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++)
        if (!(*counts[k] = td_alloc(sensor->count, sizeof **counts[k], error))) return TIDES_NO_MEMORY;
    return TIDES_OK;
}

static tides_status allocate_blocks(td_sensor *sensor, tides_error *error) {
    double **arrays[] = {&sensor->threshold_on, &sensor->threshold_off, &sensor->leak,
                         &sensor->held_until,   &sensor->since,         &sensor->wake};
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        if (!(*arrays[k] = td_alloc(sensor->count, sizeof **arrays[k], error))) return TIDES_NO_MEMORY;
    if (sensor->additive.on) {
        sensor->segment.number = td_alloc(sensor->count, sizeof *sensor->segment.number, error);
        sensor->segment.value = td_alloc(sensor->count, sizeof *sensor->segment.value, error);
        sensor->segment.ahead = td_alloc(sensor->count, sizeof *sensor->segment.ahead, error);
        if (!sensor->segment.number || !sensor->segment.value || !sensor->segment.ahead) return TIDES_NO_MEMORY;
        if (!sensor->additive.varies &&
            !(sensor->segment.origin = td_alloc(sensor->count, sizeof *sensor->segment.origin, error)))
            return TIDES_NO_MEMORY;
        if (sensor->additive.varies && !(sensor->segment.light = td_alloc(sensor->count, sizeof *sensor->segment.light, error)))
            return TIDES_NO_MEMORY;
        if (sensor->additive.varies && !(sensor->segment.now = td_alloc(sensor->count, sizeof *sensor->segment.now, error)))
            return TIDES_NO_MEMORY;
    }
    if (sensor->additive.on || sensor->kick.on) {
        sensor->segment.pixel = td_alloc(sensor->count, sizeof *sensor->segment.pixel, error);
        if (!sensor->segment.pixel) return TIDES_NO_MEMORY;
    }
    int states = !sensor->frontend.on                            ? 0
                 : sensor->frontend.kind == TD_FRONTEND_CONSTANT ? 1
                 : sensor->frontend.kind == TD_FRONTEND_HIGHPASS ? 2
                                                                 : TD_FRONTEND_STATE;
    for (int k = 0; k < states; k++)
        if (!(sensor->filtered.state[k] = td_alloc(sensor->count, sizeof *sensor->filtered.state[k], error)))
            return TIDES_NO_MEMORY;
    if (sensor->frontend.kind == TD_FRONTEND_CONSTANT || sensor->frontend.kind == TD_FRONTEND_INTENSITY) {
        sensor->filtered.error = td_alloc(sensor->count, sizeof *sensor->filtered.error, error);
        if (!sensor->filtered.error) return TIDES_NO_MEMORY;
    }
    sensor->reach = td_alloc(sensor->count, sizeof *sensor->reach, error);
    if (!sensor->reach) return TIDES_NO_MEMORY;
    return td_shot_noise_create(&sensor->sensor, sensor->count, &sensor->noise, error);
}

/* Allocates rates per pixel, where maps have some. */
static tides_status allocate_own(td_sensor *sensor, const td_maps *maps, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int k = 0; k < TD_NOISES && status == TIDES_OK; k++)
        if (maps->map[k == TD_NOISE_HOT ? TD_MAP_HOT : TD_MAP_NOISE])
            status = td_shot_noise_own(&sensor->noise, k, sensor->count, error);
    return status;
}

/* Reads the file of maps, if one is named, for an image as large as the tiles. The file's name is the caller's, and isn't
 * kept. */
static tides_status read_maps(td_sensor *sensor, const td_sensor_tiles *tiles, td_maps *maps, tides_error *error) {
    const char *path = sensor->sensor.maps;
    int32_t height = 0;
    sensor->sensor.maps = NULL;
    memset(maps, 0, sizeof *maps);
    if (!path) return TIDES_OK;
    for (const td_tile *tile = tiles->tile; tile < tiles->tile + tiles->count; tile++) {
        const int32_t bottom = tile->y0 + (tile->count + tile->width - 1) / tile->width;
        if (bottom > height) height = bottom;
    }
    const tides_status status = td_maps_read(path, sensor->image_width, height, maps, error);
    sensor->maps_checksum = maps->checksum;
    return status;
}

/* Sets up the blocks that the parameters ask for, and the run's start [ns]. */
static tides_status set_blocks(td_sensor *sensor, td_maps *maps, double start, tides_error *error) {
    const tides_sensor *params = &sensor->sensor;
    td_step first; /* splits a time as steps of the simulator do */
    tides_status status = td_frontend_make(params, &sensor->frontend, error);
    if (status == TIDES_OK) status = td_additive_noise_make(params, sensor->log_eps, &sensor->additive, error);
    if (status == TIDES_OK && maps->map[TD_MAP_SIZE]) {
        td_additive_noise_give(&sensor->additive, maps->map[TD_MAP_SIZE]);
        maps->map[TD_MAP_SIZE] = NULL; /* the noise's */
    }
    if (status == TIDES_OK) status = td_kick_make(params, start, &sensor->kick, error);
    sensor->sensor.kick_times = NULL; /* as that of the maps */
    if (status == TIDES_OK && sensor->kick.on && sensor->frontend.kind > TD_FRONTEND_CONSTANT)
        status = td_fail(error, TIDES_UNSUPPORTED,
                         "sensor: kick isn't available with the circuit, a pole that goes with the light or a high-pass; leave "
                         "one of them off");
    if (status == TIDES_OK) status = td_step_between(start, start + 1, &first, error);
    if (status != TIDES_OK) return status;
    sensor->active_at_rest = maps->checksum || sensor->frontend.on || sensor->additive.on || sensor->kick.on ||
                             leak_of(params) > 0 || params->refractory_s > 0 || makes_noise(params);
    const int surround = params->surround_lambda_px > 0, draws = surround && params->initial == TIDES_INITIAL_STEADY;
    sensor->labels = params->labels && (sensor->frontend.on || sensor->additive.on || sensor->kick.on || surround);
    sensor->on = sensor->active_at_rest || sensor->masks || sensor->labels || draws || params->threshold_sigma > 0 ||
                 params->threshold_parity != 0 || params->dead_pixel_fraction > 0;
    sensor->start.ns = first.start_ns;
    sensor->start.fraction = first.start_fraction;
    return TIDES_OK;
}

static tides_status make_pixels(td_sensor *sensor, const td_maps *maps, const td_sensor_tiles *tiles, tides_error *error) {
    for (int32_t t = 0; t < tiles->count; t++) sensor->count += (size_t)tiles->tile[t].count;
    tides_status status = allocate(sensor, error);
    if (status == TIDES_OK && sensor->on) status = allocate_blocks(sensor, error);
    if (status == TIDES_OK && sensor->on) status = allocate_own(sensor, maps, error);
    if (status == TIDES_OK) status = td_sensor_list(sensor, error);
    if (status == TIDES_OK && sensor->on) draw_pixels(sensor, maps, tiles);
    return status;
}

tides_status td_sensor_create(const tides_sensor *given, int32_t model, double log_eps, double start,
                              const td_sensor_tiles *tiles, td_sensor *sensor, tides_error *error) {
    memset(sensor, 0, sizeof *sensor);
    sensor->sensor = *given;
    tides_status status = td_sensor_check_levels(&sensor->sensor, model, error);
    if (status == TIDES_OK) status = td_sensor_check(&sensor->sensor, error);
    if (status != TIDES_OK) return status;
    sensor->model = model;
    sensor->log_eps = log_eps;
    sensor->image_width = tiles->width;
    sensor->masks = sensor->sensor.b_min > 0;
    sensor->refractory_ns = 1e9 * sensor->sensor.refractory_s;
    td_maps maps;
    status = read_maps(sensor, tiles, &maps, error);
    if (status == TIDES_OK) status = set_blocks(sensor, &maps, start, error);
    if (status == TIDES_OK) status = make_pixels(sensor, &maps, tiles, error);
    td_maps_release(&maps);
    if (status == TIDES_OK) status = td_sensor_draw_initial(sensor, tiles, error);
    if (status != TIDES_OK) td_sensor_release(sensor);
    return status;
}

void td_sensor_release(td_sensor *sensor) {
    double *arrays[] = {sensor->threshold_on, sensor->threshold_off, sensor->leak,           sensor->held_until,
                        sensor->since,        sensor->wake,          sensor->pixels.initial, sensor->pixels.reference,
                        sensor->first.draw};
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
    for (int k = 0; k < TD_FRONTEND_STATE; k++) free(sensor->filtered.state[k]);
    free(sensor->pixels.count_on);
    free(sensor->pixels.count_off);
    free(sensor->filtered.error);
    free(sensor->reach);
    free(sensor->segment.number);
    free(sensor->segment.value);
    free(sensor->segment.light);
    free(sensor->segment.ahead);
    free(sensor->segment.now);
    free(sensor->segment.origin);
    free(sensor->additive.own);
    free(sensor->segment.pixel);
    td_shot_noise_release(&sensor->noise);
    td_kick_release(&sensor->kick);
    memset(sensor, 0, sizeof *sensor);
}
