/* Internal: events without a cause in the scene: shot noise of each polarity, and hot pixels, as Poisson processes in
 * continuous time.
 *
 * Shot noise falls with light as v2e's does, by 1 - 0.75 (DN + 20) / 275 with DN = 255 Y within [0, 255], but from the rate
 * that was asked for: shot_noise_hz / 2 per polarity is the rate at Y = 0, and 0.264 of that is the rate at Y = 1 and above.
 * (v2e's own factor at DN = 0 is 0.945: with it nobody gets what is asked.) Candidates come at the rate in the dark, and each
 * is kept with the probability that its light leaves (thinning: Lewis and Shedler 1979). Hot pixels fire ON: their leakage is
 * that of leak events, only larger.
 *
 * Candidate k of a pixel depends on (seed, pixel, k) and the candidate before it: not on steps, tiles or cuts. Times are
 * rounded to whole nanoseconds, at least one after the other, so that every one belongs to one step exactly. Whether a shot
 * candidate is kept also depends on the signal at that time, which is known as well as the steps are fine. */
#ifndef TD_SHOT_NOISE_H
#define TD_SHOT_NOISE_H

#include "tides/sensor.h"

#include <stddef.h>

enum { TD_NOISE_SHOT_ON = 0, TD_NOISE_SHOT_OFF, TD_NOISE_HOT, TD_NOISES };

typedef struct td_shot_noise {
    uint64_t seed;
    double rate[TD_NOISES];     /* candidates [1/ns]; 0: off, and the arrays aren't there */
    double *own[TD_NOISES];     /* the same of single pixels, where maps say so; NULL: `rate` is all pixels' */
    double *due[TD_NOISES];     /* [ns since the run's start], whole: the next candidate; INFINITY: never (pixels) */
    uint32_t *drawn[TD_NOISES]; /* candidates drawn so far, that one included (pixels) */
} td_shot_noise;

/* Room for `pixels`; td_shot_noise_release frees. */
TIDES_MUST_CHECK tides_status td_shot_noise_create(const tides_sensor *sensor, size_t pixels, td_shot_noise *noise,
                                                   tides_error *error);
void td_shot_noise_release(td_shot_noise *noise);

/* Gives pixels rates of their own, which are drawn as if there were none where they stay -1 until
 * td_shot_noise_begin. */
TIDES_MUST_CHECK tides_status td_shot_noise_own(td_shot_noise *noise, int source, size_t pixels, tides_error *error);

/* Candidates of pixel i once it has begun [1/ns]; a pixel that isn't hot has none of hot ones. */
double td_shot_noise_rate(const td_shot_noise *noise, int source, size_t i);

/* Draws whether pixel i, number `pixel` of the image, is hot, and the first candidates of its sources. */
void td_shot_noise_begin(td_shot_noise *noise, const tides_sensor *sensor, size_t i, uint32_t pixel);

/* The source whose candidate comes first, and when; -1 where there is none. */
int td_shot_noise_next(const td_shot_noise *noise, size_t i, double *due);

/* Takes the candidate at hand from `source` and draws the next; 1 where it is kept in a pixel with log-luminance L. */
int td_shot_noise_take(td_shot_noise *noise, int source, size_t i, uint32_t pixel, double L, double log_eps);

/* Share of shot candidates kept at luminance Y. */
double td_shot_noise_share(double Y);

#endif
