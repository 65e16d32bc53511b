/* Internal: a block of ideal pixels over one step. Most of those that need something have crossings that follow from their
 * values alone. */
#ifndef TD_IDEAL_BLOCK_H
#define TD_IDEAL_BLOCK_H

#include "td_pixel.h"

enum { TD_IDEAL_BLOCK = 64 }; /* pixels tested together: their flags stay in L1 */

/* Pixels `begin` to begin + count of a tile, whose first is the sensor's pixel `first`. */
typedef struct td_ideal_block {
    const td_tile *tile;
    const td_signals *signals;
    size_t first, begin, count; /* count <= TD_IDEAL_BLOCK */
} td_ideal_block;

/* Advances the pixels whose mark isn't 0. Results and the order of events are those of td_ideal_advance, pixel by pixel. On
 * failure the pixels' counts are those of the events in the buffer. */
TIDES_MUST_CHECK tides_status td_ideal_block_step(td_pixel_job *job, const td_ideal_block *block, const double *mark);

#endif
