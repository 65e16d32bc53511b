/* Internal: the simulator's centre-surround. Its modes belong to all pixels, so all tiles have the same steps then, and the
 * comparator sees each step in the surround's pieces.
 *
 * The photoreceptor's low-pass comes after it here, before it in the eye: where the filter is the same for all pixels and
 * constant in time, both are linear and it makes no difference. Other photoreceptors are refused. */
#ifndef TD_SURROUND_STEPS_H
#define TD_SURROUND_STEPS_H

#include "sensor/surround/td_surround.h"

struct tides_simulator;

typedef struct td_surround_steps {
    td_surround surround;
    double *from_dot, *p, *p_dot; /* (height x width) */
    double *S;                    /* (pixels), tile by tile: what the comparator sees at the time reached */
    double *modes;                /* (pixels) modes of the surround then, mode (j, k) in the place of pixel (k, j) */
} td_surround_steps;

/* Makes the steps of a sensor with a surround. */
TIDES_MUST_CHECK tides_status td_surround_steps_create(struct tides_simulator *s, const tides_sensor *sensor, int height,
                                                       tides_error *error);
void td_surround_steps_release(td_surround_steps *steps);

/* The run begins at s->now, or goes on from there with `modes`. */
void td_surround_steps_begin(struct tides_simulator *s);
void td_surround_steps_resume(struct tides_simulator *s);

/* The comparator over the step of all tiles from s->now, at `start`, to s->next, at `stop`; `which` (nullable) are the refined
 * steps (tiles) that these are. */
tides_status td_surround_compare(struct tides_simulator *s, double start, double stop, const int32_t *which,
                                 tides_error *error);

#endif
