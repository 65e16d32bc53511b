/* Internal: the state of a pixel with additive noise after a long time at rest (sensor.initial STEADY).
 *
 * Noise of correlation time tau wanders about the mean, which stands `o` above the reference. The mean leaves its place slowly:
 * by the leak's drift and by events, which come with the hazards of one level each,
 *
 *   ON  h((C+ - o) / sigma) / tau,  OFF  h((C- + o) / sigma) / tau,  h(u) = 1 / int_0^u sqrt(2 pi) e^(z^2 / 2) P(n < z) dz
 *
 * the mean first passage of the Ornstein-Uhlenbeck process, and with those of shot noise and hot pixels. An event takes o by a
 * threshold, or, where pixels are held, to where the noise has come by the end of that. So much is followed from event to event
 * for ten seconds or 512 events, from a reference anywhere between the levels. At the end the noise and o
 * belong together: over the last few tau the very path of the noise that the run begins with is drawn backwards, and walked
 * through with its events.
 *
 * Without leak, shot noise or a refractory period there is no steady state: equal levels keep o, but for whole thresholds, for
 * ever, and levels that differ by little move it to where events are rare, ever more slowly (measured: 1.3 times the tenth
 * second's rate in the first). Ten seconds is then what it says. */
#ifndef TD_STEADY_H
#define TD_STEADY_H

#include "td_sensor.h"

/* The initial state of a pixel whose noise stands at the run's start, and which has shot noise and hot events at `rate`
 * [1/ns]. */
td_initial td_steady_noise(const td_sensor *sensor, size_t i, double rate);

/* Fills sensor->passage. */
void td_steady_begin(td_sensor *sensor);

#endif
