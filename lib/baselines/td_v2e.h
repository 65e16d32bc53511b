/* Internal: v2e's state, and the parts of it that have a file each. */
#ifndef TD_V2E_H
#define TD_V2E_H

#include "td_baseline.h"

typedef struct td_v2e_state {
    float *on, *off;      /* thresholds [log units] (pixels) */
    float *leak_factor;   /* of the leak rate, 1 on average in decades (pixels) */
    double *level;        /* low-passed logarithm (pixels) */
    double *reference;    /* (pixels) */
    double *noise;        /* low-passed photoreceptor noise [log units] (pixels) */
    float *surround;      /* horizontal cells [log units] (pixels), NULL without a surround */
    float *scratch;       /* its next value (pixels) */
    double *fired;        /* time of the last event [s] (pixels) */
    double *difference;   /* what the comparator sees [log units] (pixels) */
    uint32_t *wanted;     /* events that it asks for in this interval, polarity by sign of the difference (pixels) */
    uint32_t *kept;       /* of these, outside the refractory period (pixels) */
    double noise_frame_s; /* interval that noise_level is for [s] */
    double noise_level;   /* of the white noise before its low-pass [log units] */
} td_v2e_state;

/* The value of a frame that v2e reads [DN]. */
static inline double td_v2e_dn(const tides_v2e *p, double Y) { return 255.0 * Y + p->added_dn; }

/* v2e_surround.c: the diffuser of horizontal cells, from the last frame to this one. */
void td_v2e_surround(const tides_baseline *baseline);

/* v2e_noise.c: one interval's photoreceptor noise, low-passed, into state->noise; shot noise events at `stop`, after which the
 * pixel's reference is its level. */
void td_v2e_photoreceptor_noise(tides_baseline *baseline);
tides_status td_v2e_shot_noise(tides_baseline *baseline, const double *Y, tides_error *error);

#endif
