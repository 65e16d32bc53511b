/* Internal: a tile's pixels and their signals on a step, which the solver gives to the sensor. */
#ifndef TD_SIGNALS_H
#define TD_SIGNALS_H

#include <stdint.h>

/* The places of a tile's pixels: pixel i is at (x0 + i % width, y0 + i / width). Coordinates fit 16 bits. */
typedef struct td_tile {
    int32_t x0, y0, width;
    int32_t count; /* number of pixels */
} td_tile;

/* Signals of a tile's pixels at both ends of the step. Arrays that the model doesn't use may be NULL: the secant uses no rates,
 * only the cubic uses S1_dot. */
typedef struct td_signals {
    const double *S0;     /* [log units]   (count) */
    const double *S0_dot; /* [log units/s] (count) */
    const double *S1;     /* [log units]   (count) */
    const double *S1_dot; /* [log units/s] (count) */
} td_signals;

#endif
