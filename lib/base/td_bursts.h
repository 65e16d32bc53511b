/* Internal: bursts of events that the readout of frames makes (DAVIS): many pixels at once, both polarities, for a few
 * milliseconds. Found over all pixels: the rate leaps far above what it is around, and is back soon. */
#ifndef TD_BURSTS_H
#define TD_BURSTS_H

#include <stddef.h>
#include <stdint.h>

#define TD_BURST_BIN_S 2.5e-4 /* of the rates */

/* Marks the bins of bursts with 1 in `burst` (bins), zero before, of `rate` (bins), events per bin; how many bursts. */
int32_t td_bursts_in(const uint32_t *rate, size_t bins, uint8_t *burst);

#endif
