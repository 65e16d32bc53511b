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
    int64_t tick_ns; /* 0: infinite rate */
    int64_t row_ns, event_ps, frame_ns;
    int64_t start_ns;                /* nothing leaves before */
    int drops, jitters;              /* are there any? */
    double wide;                     /* jitter over its standard deviation is a normal number times this */
    int32_t *tile_row, *tile_column; /* (height), (width): first tile of the row's tiles, tile within it */
    double *psi;                     /* (tiles) */
    int32_t *release;                /* (tiles) K_m */
    td_queues queues;
    uint64_t *held;     /* SCANNED: a bit per pixel, it holds an event */
    int32_t next_queue; /* where the scanner goes on */
    int64_t tick;       /* the first that hasn't been served; without ticks [ns] when the bus is free, or the frame begins */
    int64_t tick_end;   /* of the tick of the last arrival; REQUESTED: latch of the row before next_queue, TD_NO_LATCH: none */
    int64_t last_t;     /* of what was pushed */
    td_release out;
    tides_readout_stats stats;
};

#define TD_NO_LATCH INT64_MIN

static inline int td_arbiter_has_ticks(const tides_arbiter *arbiter) { return arbiter->readout.kind < TIDES_READOUT_REQUESTED; }

/* Without ticks (asked.c). Reads all rows and frames that are over before `t`; an event into its queue, `*full` 1 where it
 * finds no room; and the time before which nothing leaves that hasn't left yet. */
tides_status td_asked_until(tides_arbiter *arbiter, int64_t t, tides_error *error);
tides_status td_asked_append(tides_arbiter *arbiter, const tides_event *event, int *full, tides_error *error);
int64_t td_asked_certain(const tides_arbiter *arbiter);

/* 1 where the pixel holds an event already; it does from now on. SCANNED. */
static inline int td_arbiter_hold(tides_arbiter *arbiter, const tides_event *event) {
    const size_t pixel = (size_t)event->y * (size_t)arbiter->width + event->x;
    const uint64_t bit = (uint64_t)1 << pixel % 64;
    const int held = (arbiter->held[pixel / 64] & bit) != 0;
    arbiter->held[pixel / 64] |= bit;
    return held;
}

/* chance.c: 1 where the event is dropped on its arrival in `tile`; the time at which it leaves, with its jitter. */
int td_arbiter_drops(const tides_arbiter *arbiter, const tides_event *event, int32_t tile);
void td_arbiter_jitter(const tides_arbiter *arbiter, tides_event *event, int64_t fired);

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
