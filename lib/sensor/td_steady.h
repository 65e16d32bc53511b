/* Internal: the state of a pixel with additive noise after a long time at rest (sensor.initial STEADY).
 *
 * Noise of correlation time tau wanders about the mean, which is `o` above the reference. The mean changes slowly: by the
 * leak's drift and by events. Events at each level have the hazards
 *
 *   ON  h((C+ - o) / sigma) / tau,  OFF  h((C- + o) / sigma) / tau,  h(u) = 1 / int_0^u sqrt(2 pi) e^(z^2 / 2) P(n < z) dz,
 *
 * by the mean first passage of the Ornstein-Uhlenbeck process; shot noise and hot pixels have theirs. An event changes o by a
 * threshold. Where pixels are held, the noise at the hold's end sets it. This is followed from event to event, from a reference
 * anywhere between the levels, for a time that is set beforehand: pixels that fire often soon forget where they began, and
 * others are followed for up to five minutes. At the end noise and o depend on each other. So over the last few tau the path of
 * the noise with which the run begins is drawn backwards, and its events are followed.
 *
 * Without leak, shot noise or a refractory period there is no steady state. With equal levels o only changes by whole
 * thresholds, for ever. Levels that differ by little move it to where events are rare, ever more slowly (measured: 1.3 times
 * the rate of the tenth second in the first). STEADY then means ten seconds. */
#ifndef TD_STEADY_H
#define TD_STEADY_H

#include "td_sensor.h"
#include "td_sensor_parts.h"

/* A pixel that has been at rest. */
typedef struct td_rested {
    size_t i;          /* its number in the sensor */
    double rate;       /* of its shot noise and hot events [1/ns] */
    double sigma, tau; /* of its noise; sigma > 0; tau [ns] */
    double begin, now; /* the noise's value where its first segment begins, and at the run's start */
    /* Results of a part of the work: the mean above the reference, times since the last event and until the noise is back. */
    double o, age, falls;
} td_rested;

/* Random initial states of pixels whose noise at the run's start is given. */
enum { TD_RESTED_MAX = 1024 };
void td_steady_noise(const td_sensor *sensor, td_rested *at, int count, td_initial *initial);

/* Fills sensor->first.log_passage, the table of ln h(u). */
void td_steady_begin(td_sensor *sensor);

#endif
