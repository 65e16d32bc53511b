/* Internal: a block of ideal pixels over one step, of which most of those that need anything have crossings that can be told
 * from their values alone (ideal_block.c). For comparator.c. */
#ifndef TD_IDEAL_BLOCK_H
#define TD_IDEAL_BLOCK_H

#include "td_pixel.h"

enum { TD_IDEAL_BLOCK = 64 }; /* pixels tested together: their flags stay in L1 */

/* The pixels `begin` to begin + count of a tile, whose first is the sensor's `first`. */
typedef struct td_ideal_block {
    const td_tile *tile;
    const td_signals *signals;
    size_t first, begin, count; /* count <= TD_IDEAL_BLOCK */
} td_ideal_block;

/* The pixels whose mark isn't 0, each as td_ideal_advance would do it, their events in the same order. On failure counts of the
 * pixels are those of the events in the buffer. */
TIDES_MUST_CHECK tides_status td_ideal_block_step(td_pixel_job *job, const td_ideal_block *block, const double *mark);

#endif
