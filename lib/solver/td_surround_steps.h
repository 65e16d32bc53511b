/* Internal: the simulator's centre-surround, and all that the solver asks it. All pixels belong together in it, so that all
 * tiles have the same steps, and the comparator sees each step in the surround's pieces. Step control, which doesn't know the
 * surround, goes by td_parameters.coupled. Without a surround the functions below do
 * nothing.
 *
 * The photoreceptor's low-pass comes after the surround here, and before it in the eye. Where the filter is constant and equal
 * for all pixels, both are linear, and the order makes no difference. Other photoreceptors are refused. */
#ifndef TD_SURROUND_STEPS_H
#define TD_SURROUND_STEPS_H

#include "sensor/surround/td_surround.h"

struct tides_simulator;

typedef struct td_surround_steps {
    td_surround surround;
    double *from_dot, *p, *p_dot; /* (height x width) */
    double *S;                    /* (pixels), tile by tile: the comparator's input at the time reached */
    double *h;                    /* (pixels) the surround at that time */
} td_surround_steps;

/* Makes the steps of a sensor with a surround. */
TIDES_MUST_CHECK tides_status td_surround_steps_create(struct tides_simulator *s, const tides_sensor *sensor, int height,
                                                       tides_error *error);
void td_surround_steps_release(td_surround_steps *steps);

/* Begins the run at s->now, or continues it from there with `h`. */
void td_surround_steps_begin(struct tides_simulator *s);
void td_surround_steps_resume(struct tides_simulator *s);

/* For coupled pixels alone: runs the comparator over the step of all tiles from s->now, at `start`, to s->next, at `stop`.
 * `which` (tiles; nullable) are the refined steps of the tiles. */
tides_status td_surround_compare(struct tides_simulator *s, double start, double stop, const int32_t *which,
                                 tides_error *error);

#endif
