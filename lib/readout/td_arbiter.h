/* Internal: the state of a readout arbiter, and the state as numbers for checkpoints. */
#ifndef TD_ARBITER_H
#define TD_ARBITER_H

#include "td_queues.h"
#include "td_release.h"
#include "tides/readout.h"

struct tides_arbiter {
    tides_readout readout;
    int32_t width, height, across, down;
    uint64_t seed;
    int64_t tick_ns;                    /* 0: infinite rate */
    int64_t row_ns, event_ps, frame_ns; /* row_s, event_s and frame_s of `readout`, in [ns], [ps] and [ns] */
    int64_t start_ns;                   /* no event leaves before this [ns] */
    int drops, jitters;                 /* whether any event may be dropped, or jittered */
    double wide;                        /* jitter = standard deviation x normal number x this */
    int32_t *tile_row, *tile_column;    /* (height), (width): the first tile of the row of tiles; the column of tiles */
    double *psi;                        /* (tiles) activity of each tile, 0 to 1 */
    int32_t *release;                   /* (tiles) K_m: events per tick */
    td_queues queues;
    uint64_t *held;     /* for sensors read as frames (SCANNED): a bit per pixel, 1 if it holds an event */
    int32_t next_queue; /* the queue from which the search for the next one goes on: behind the one that was found last */
    struct {
        int64_t next; /* the first one that hasn't been served */
        int64_t end;  /* end of the last arrival's [ns] */
    } tick;           /* of readouts with ticks */
    struct {
        int64_t free;  /* when the bus becomes free, or the next frame begins [ns] */
        int64_t latch; /* REQUESTED: when row next_queue - 1 is latched [ns], or TD_NO_LATCH */
    } bus;             /* of readouts without */
    int64_t last_t;    /* time of the last event that was pushed [ns] */
    td_release out;
    tides_readout_stats stats;
};

#define TD_NO_LATCH INT64_MIN

static inline int td_arbiter_has_ticks(const tides_arbiter *arbiter) { return arbiter->readout.kind < TIDES_READOUT_REQUESTED; }

/* Readouts without ticks: rows that request the bus (REQUESTED), and sensors read as frames (SCANNED). _until reads all rows
 * and frames that are over before `t` [ns]. _append puts an event into its queue and sets `*full` if there is no room.
 * _certain: no event that waits leaves before this time [ns]. */
tides_status td_asked_until(tides_arbiter *arbiter, int64_t t, tides_error *error);
tides_status td_asked_append(tides_arbiter *arbiter, const tides_event *event, int *full, tides_error *error);
int64_t td_asked_certain(const tides_arbiter *arbiter);

/* SCANNED: marks the pixel as holding an event; returns 1 if it held one already. */
static inline int td_arbiter_hold(tides_arbiter *arbiter, const tides_event *event) {
    const size_t pixel = (size_t)event->y * (size_t)arbiter->width + event->x;
    const uint64_t bit = (uint64_t)1 << pixel % 64;
    const int held = (arbiter->held[pixel / 64] & bit) != 0;
    arbiter->held[pixel / 64] |= bit;
    return held;
}

/* Returns 1 if the event is dropped on its arrival in `tile`. _jitter adds jitter to the time at which the event leaves. */
int td_arbiter_drops(const tides_arbiter *arbiter, const tides_event *event, int32_t tile);
void td_arbiter_jitter(const tides_arbiter *arbiter, tides_event *event, int64_t fired);

static inline int32_t td_arbiter_tile(const tides_arbiter *arbiter, const tides_event *event) {
    return arbiter->tile_row[event->y] + arbiter->tile_column[event->x];
}

/* The changing state, but for the tiles' activity, as `count` numbers that the caller frees. */
TIDES_MUST_CHECK tides_status td_arbiter_pack(const tides_arbiter *arbiter, int64_t **numbers, size_t *count,
                                              tides_error *error);

/* Restores the state of a new arbiter with the same parameters. After TIDES_BAD_FILE the arbiter can't be used. */
TIDES_MUST_CHECK tides_status td_arbiter_unpack(tides_arbiter *arbiter, const int64_t *numbers, size_t count,
                                                tides_error *error);

#endif
