/* Internal: events without a cause in the scene: shot noise of each polarity, and hot pixels, as Poisson processes in
 * continuous time.
 *
 * Shot noise falls with light as v2e's does, by 1 - 0.75 (DN + 20) / 275 with DN = 255 Y within [0, 255], but from the given
 * rate: shot_noise_hz / 2 per polarity is the rate at Y = 0, and 0.264 of that the rate at Y = 1 and above. (v2e's factor at
 * DN = 0 is 0.945, so that no pixel has the given rate.) Candidates come at the rate in the dark, and each is kept with a
 * probability that depends on the light (thinning: Lewis and Shedler 1979). Hot pixels fire ON: their leakage is like that of
 * leak events, only larger.
 *
 * Candidate k of a pixel depends on (seed, pixel, k) and the candidate before it: not on steps, tiles or cuts. Times are
 * rounded to whole nanoseconds, at least one apart, so that each belongs to exactly one step. Whether a shot candidate is kept
 * also depends on the signal at that time, which is as accurate as the steps' models. */
#ifndef TD_SHOT_NOISE_H
#define TD_SHOT_NOISE_H

#include "tides/sensor.h"

#include <stddef.h>

enum { TD_NOISE_SHOT_ON = 0, TD_NOISE_SHOT_OFF, TD_NOISE_HOT, TD_NOISES };

typedef struct td_shot_noise {
    uint64_t seed;
    double rate[TD_NOISES];     /* candidates [1/ns]; 0: off, without arrays */
    double *own[TD_NOISES];     /* candidates of single pixels [1/ns], where maps give them; NULL: `rate` for all */
    double *due[TD_NOISES];     /* (pixels) [ns since the run's start] time of the next candidate, whole; INFINITY: never */
    uint32_t *drawn[TD_NOISES]; /* (pixels) candidates drawn so far, with the next one */
} td_shot_noise;

/* Allocates arrays for `pixels`; td_shot_noise_release frees them. */
TIDES_MUST_CHECK tides_status td_shot_noise_create(const tides_sensor *sensor, size_t pixels, td_shot_noise *noise,
                                                   tides_error *error);
void td_shot_noise_release(td_shot_noise *noise);

/* Allocates rates per pixel. A rate that is still -1 when td_shot_noise_begin is called is drawn as without a map. */
TIDES_MUST_CHECK tides_status td_shot_noise_own(td_shot_noise *noise, int source, size_t pixels, tides_error *error);

/* Rate of candidates of pixel i [1/ns], after td_shot_noise_begin; 0 for hot events of a pixel that isn't hot. */
double td_shot_noise_rate(const td_shot_noise *noise, int source, size_t i);

/* Draws whether pixel i, number `pixel` of the image, is hot, and the first candidates of its sources. */
void td_shot_noise_begin(td_shot_noise *noise, const tides_sensor *sensor, size_t i, uint32_t pixel);

/* The source of the next candidate, and its time; -1 where there is none. */
int td_shot_noise_next(const td_shot_noise *noise, size_t i, double *due);

/* Takes the next candidate of `source` and draws the one after it. Returns 1 where it is kept in a pixel with log-luminance
 * L. */
int td_shot_noise_take(const td_shot_noise *noise, int source, size_t i, uint32_t pixel, double L, double log_eps);

/* Share of shot candidates kept at luminance Y. */
double td_shot_noise_share(double Y);

#endif
