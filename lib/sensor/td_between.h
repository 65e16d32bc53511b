/* Internal: what pixels hold between two steps: the signal that they compare, thresholds, references and noise, for estimates
 * of errors and for messages. */
#ifndef TD_BETWEEN_H
#define TD_BETWEEN_H

#include "td_sensor.h"

/* The value that a pixel compares with its levels at `time` [ns since the run's start], the time reached, if its log-luminance
 * is L. */
double td_sensor_signal(const td_sensor *sensor, size_t pixel, double L, double time);

/* A pixel's own thresholds, which are the nominal ones if no block is on. */
static inline double td_sensor_threshold_on(const td_sensor *sensor, size_t pixel) {
    return sensor->on ? sensor->threshold_on[pixel] : sensor->sensor.threshold_on;
}
static inline double td_sensor_threshold_off(const td_sensor *sensor, size_t pixel) {
    return sensor->on ? sensor->threshold_off[pixel] : sensor->sensor.threshold_off;
}

/* The smaller of the nominal thresholds: limits of errors are shares of it. */
static inline double td_sensor_least_threshold(const tides_sensor *sensor) {
    return sensor->threshold_on < sensor->threshold_off ? sensor->threshold_on : sensor->threshold_off;
}

/* The levels of a tile's pixels: thresholds of pixel i at [i x stride] (stride 0: one for all), and references after the step.
 * The leak's ramp is added to the signal. */
typedef struct td_levels {
    const double *threshold_on, *threshold_off, *reference;
    int stride;
    const double *leak; /* [log units/ns]; NULL: none */
    double time;        /* when the step begins [ns since the run's start] */
} td_levels;

/* The levels of a tile that begins at pixel `first`, after its step. */
td_levels td_sensor_levels(const td_sensor *sensor, const td_step *step, size_t first);

/* 1 where the ends of refractory periods re-reference pixels. */
static inline int td_sensor_holds(const td_sensor *sensor) {
    return sensor->sensor.refractory_law == TIDES_REFRACTORY_HOLD && sensor->refractory_ns > 0;
}

/* 1 where events also come of noise or kicks. */
static inline int td_sensor_adds(const td_sensor *sensor) {
    return sensor->additive.on || sensor->kick.on || sensor->noise.due[TD_NOISE_SHOT_ON] || sensor->noise.due[TD_NOISE_HOT];
}

/* The largest (S_eff - S_ref) / C+ or (S_ref - S_eff) / C- of the pixels that aren't held or masked at `time`, for
 * log-luminances L and coverages (used only where sensor->masks). It is below 1 after a step. NaN is left out. */
double td_sensor_worst_residual(const td_sensor *sensor, const double *L, const double *coverage, double time);

/* S_ref from the counts: S_init + n_on C+ - n_off C-. Pairs of ON and OFF are taken together, so that with equal thresholds a
 * pixel that returns to a level has the same reference there, to the bit. */
static inline double td_reference_at(double on, double off, double initial, double count_on, double count_off) {
    const double pairs = count_on < count_off ? count_on : count_off;
    const double unpaired = (count_on - pairs) * on - (count_off - pairs) * off; /* one of them is 0 */
    return initial + (pairs * (on - off) + unpaired);
}

/* The segment of the additive noise that contains the time reached. */
td_noise_segment td_sensor_noise_segment(const td_sensor *sensor, size_t pixel);

/* Makes that the pixel's segment. */
void td_sensor_put_segment(const td_sensor *sensor, size_t pixel, const td_noise_segment *segment);

/* Computes what follows from the pixel's segment. */
void td_sensor_resume_noise(const td_sensor *sensor, size_t pixel);

/* The sum of additive noise and kicks at a time [ns since the run's start], not before the time reached; 0 without them. */
double td_sensor_noise_at(const td_sensor *sensor, size_t pixel, double time);

#endif
