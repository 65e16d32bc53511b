/* Internal: an arbiter's state, and the same as numbers for checkpoints. */
#ifndef TD_ARBITER_H
#define TD_ARBITER_H

#include "td_queues.h"
#include "td_release.h"
#include "tides/readout.h"

struct tides_arbiter {
    tides_readout readout;
    int32_t width, height, across, down;
    uint64_t seed;
    int64_t tick_ns;                 /* 0: infinite rate */
    int64_t start_ns;                /* nothing leaves before */
    int drops, jitters;              /* are there any? */
    double wide;                     /* jitter over its standard deviation is a normal number times this */
    int32_t *tile_row, *tile_column; /* (height), (width): first tile of the row's tiles, tile within it */
    double *psi;                     /* (tiles) */
    int32_t *release;                /* (tiles) K_m */
    td_queues queues;
    int32_t next_queue; /* where the scanner goes on */
    int64_t tick;       /* the first that hasn't been served */
    int64_t tick_end;   /* of the tick of the last arrival */
    int64_t last_t;     /* of what was pushed */
    td_release out;
    tides_readout_stats stats;
};

static inline int32_t td_arbiter_tile(const tides_arbiter *arbiter, const tides_event *event) {
    return arbiter->tile_row[event->y] + arbiter->tile_column[event->x];
}

/* All that changes in an arbiter but for the tiles' activity, as `count` numbers that the caller frees. */
TIDES_MUST_CHECK tides_status td_arbiter_pack(const tides_arbiter *arbiter, int64_t **numbers, size_t *count,
                                              tides_error *error);

/* Into a new arbiter of the same parameters. TIDES_BAD_FILE where the numbers make no state; it is of no use then. */
TIDES_MUST_CHECK tides_status td_arbiter_unpack(tides_arbiter *arbiter, const int64_t *numbers, size_t count,
                                                tides_error *error);

#endif
