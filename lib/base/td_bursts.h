/* Internal: bursts of events that a DAVIS makes when it reads out a frame: many pixels fire at once, in both polarities,
 * for a few milliseconds. In the rate of events over all pixels such a burst is a short leap far above the usual rate. */
#ifndef TD_BURSTS_H
#define TD_BURSTS_H

#include <stddef.h>
#include <stdint.h>

#define TD_BURST_BIN_S 2.5e-4 /* length of a bin of rates */

/* Marks the bins of bursts with 1 in `burst` (bins; all 0 before), from `rate` (bins) in events per bin. Returns the number
 * of bursts. */
int32_t td_bursts_in(const uint32_t *rate, size_t bins, uint8_t *burst);

#endif
