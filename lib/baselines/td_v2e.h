/* Internal: v2e's state, shared by the files for its signal, its noise and its surround. */
#ifndef TD_V2E_H
#define TD_V2E_H

#include "td_baseline.h"

typedef struct td_v2e_state {
    float *on, *off;      /* thresholds [log units] (pixels) */
    float *leak_factor;   /* (pixels) factor of the leak rate, log-normal around 1 */
    double *level;        /* low-passed logarithm (pixels) */
    double *reference;    /* level from which differences are taken [log units] (pixels) */
    double *noise;        /* low-passed photoreceptor noise [log units] (pixels) */
    float *surround;      /* (pixels) horizontal cells [log units]; NULL without a surround */
    float *scratch;       /* (pixels) next value of the surround */
    double *fired;        /* time of the last event [s] (pixels) */
    double *difference;   /* (pixels) input of the comparator [log units] */
    uint32_t *wanted;     /* (pixels) number of events in this interval; their polarity is the sign of the difference */
    uint32_t *kept;       /* (pixels) how many of these are outside the refractory period */
    double noise_frame_s; /* interval for which noise_level holds [s] */
    double noise_level;   /* of white noise before its low-pass [log units] */
} td_v2e_state;

/* The value of a frame that v2e reads [DN]. */
static inline double td_v2e_dn(const tides_v2e *p, double Y) { return 255.0 * Y + p->added_dn; }

/* Diffuses the horizontal cells, state->surround, from the last frame's time to this one's. */
void td_v2e_surround(const tides_baseline *baseline);

/* td_v2e_photoreceptor_noise computes state->noise for the interval. td_v2e_shot_noise makes noise events at the interval's
 * end; then such a pixel's reference equals its level (less the surround). */
void td_v2e_photoreceptor_noise(tides_baseline *baseline);
tides_status td_v2e_shot_noise(tides_baseline *baseline, const double *Y, tides_error *error);

#endif
