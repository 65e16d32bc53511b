/* State of a sensor's pixels between steps: their signals, the distance to their levels, and the completion of a state that was
 * put back. */
#include "sensor/noise/td_noise_bridge.h"
#include "td_between.h"
#include "td_sensor.h"
#include "td_sensor_parts.h"

#include <math.h>

/* The pixel's segment; what follows from its number, value and light is in `now`, or NULL and computed. */
static td_noise_segment segment_of(const td_sensor *sensor, size_t pixel, const td_noise_now *now) {
    const uint64_t k = (uint64_t)sensor->segment.number[pixel];
    const double value = sensor->segment.value[pixel], light = sensor->segment.light ? sensor->segment.light[pixel] : 0;
    if (now) return td_additive_noise_again(&sensor->additive, k, value, light, now);
    return td_additive_noise_resume(&sensor->additive, sensor->segment.pixel[pixel], k, value, light);
}

td_noise_segment td_sensor_noise_segment(const td_sensor *sensor, size_t pixel) {
    return segment_of(sensor, pixel, sensor->segment.now ? &sensor->segment.now[pixel] : NULL);
}

void td_sensor_put_segment(const td_sensor *sensor, size_t pixel, const td_noise_segment *segment) {
    sensor->segment.number[pixel] = (double)segment->k;
    sensor->segment.value[pixel] = segment->begin;
    if (sensor->segment.light) sensor->segment.light[pixel] = segment->light;
    if (sensor->segment.now) sensor->segment.now[pixel] = td_noise_now_of(segment);
}

void td_sensor_resume_noise(const td_sensor *sensor, size_t pixel) {
    sensor->segment.ahead[pixel].until_ns = -INFINITY;
    if (!sensor->segment.now) return;
    const td_noise_segment segment = segment_of(sensor, pixel, NULL);
    sensor->segment.now[pixel] = td_noise_now_of(&segment);
}

double td_sensor_noise_at(const td_sensor *sensor, size_t pixel, double time) {
    if (!sensor->segment.pixel) return 0;
    const uint32_t number = sensor->segment.pixel[pixel];
    const double kick =
        sensor->kick.on ? td_kick_at(&sensor->kick, (int32_t)(number / (uint32_t)sensor->image_width), time) : 0;
    if (!sensor->additive.on) return kick;
    td_noise_segment segment = td_sensor_noise_segment(sensor, pixel);
    td_additive_noise_seek(&sensor->additive, number, time, &segment);
    return kick + td_noise_value(&sensor->additive, number, &segment, time);
}

double td_sensor_signal(const td_sensor *sensor, size_t pixel, double L, double time) {
    if (!sensor->on) return L;
    double S = (sensor->frontend.on ? sensor->filtered.state[0][pixel] : L) + sensor->leak[pixel] * time;
    return S + td_sensor_noise_at(sensor, pixel, time);
}

int td_sensor_wants_light(const td_sensor *sensor) {
    int noises = 0;
    for (int k = 0; k < TD_NOISES; k++) noises |= sensor->noise.due[k] != NULL;
    return sensor->labels || sensor->additive.varies || noises;
}

td_levels td_sensor_levels(const td_sensor *sensor, const td_step *step, size_t first) {
    const tides_sensor *same = &sensor->sensor;
    const double *reference = sensor->pixels.reference + first;
    if (!sensor->on) return (td_levels){&same->threshold_on, &same->threshold_off, reference, 0, NULL, 0};
    return (td_levels){sensor->threshold_on + first,
                       sensor->threshold_off + first,
                       reference,
                       1,
                       sensor->leak + first,
                       td_sensor_time(sensor, step->start_ns, step->start_fraction)};
}

/* 1 where the pixel isn't held or masked. */
static int is_free(const td_sensor *sensor, size_t i, const double *coverage, double time) {
    if (!sensor->on) return 1;
    if (sensor->masks && !(coverage[i] >= sensor->sensor.b_min)) return 0;
    return !(sensor->held_until[i] > time);
}

double td_sensor_worst_residual(const td_sensor *sensor, const double *L, const double *coverage, double time) {
    double worst = 0;
    for (size_t i = 0; i < sensor->count; i++) {
        double residual = td_sensor_signal(sensor, i, L[i], time) - sensor->pixels.reference[i];
        double relative =
            fabs(residual) / (residual > 0 ? td_sensor_threshold_on(sensor, i) : td_sensor_threshold_off(sensor, i));
        if (relative > worst && is_free(sensor, i, coverage, time)) worst = relative;
    }
    return worst;
}

void td_sensor_set_wake(const td_sensor *sensor, size_t pixel) {
    double wake;
    td_shot_noise_next(&sensor->noise, pixel, &wake);
    int waits = sensor->sensor.refractory_law == TIDES_REFRACTORY_HOLD && sensor->held_until[pixel] > -INFINITY;
    if (waits && sensor->held_until[pixel] < wake) wake = sensor->held_until[pixel];
    sensor->wake[pixel] = wake;
}

/* A pixel that has never fired keeps the bits of its initial value, also of a NaN. */
void td_sensor_resume(const td_sensor *sensor) {
    const td_pixels *p = &sensor->pixels;
    for (size_t i = 0; i < sensor->count; i++) {
        int fired = p->count_on[i] || p->count_off[i];
        p->reference[i] = fired ? td_reference_at(td_sensor_threshold_on(sensor, i), td_sensor_threshold_off(sensor, i),
                                                  p->initial[i], p->count_on[i], p->count_off[i])
                                : p->initial[i];
        if (sensor->on) td_sensor_set_wake(sensor, i);
        if (sensor->additive.on) td_sensor_resume_noise(sensor, i);
    }
}
