/* Internal: a tile's pixels and their signals on a step. */
#ifndef TD_SIGNALS_H
#define TD_SIGNALS_H

#include <stdint.h>

/* The place of a tile: pixel i is at (x0 + i % width, y0 + i / width). Coordinates fit 16 bits. */
typedef struct td_tile {
    int32_t x0, y0, width;
    int32_t count; /* pixels */
} td_tile;

/* Signals of a tile's pixels at both ends of a step. Unused arrays may be NULL: the secant reads no rates, and only the cubic
 * reads S1_dot. */
typedef struct td_signals {
    const double *S0;     /* [log units]   (count) */
    const double *S0_dot; /* [log units/s] (count) */
    const double *S1;     /* [log units]   (count) */
    const double *S1_dot; /* [log units/s] (count) */
} td_signals;

#endif
