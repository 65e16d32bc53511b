/* The readout: how events leave a sensor whose bus carries only so many of them at a time (paper, "Derivative-conditioned
 * finite-bandwidth readout"; DESIGN 3.4).
 *
 * Pixels queue; a scanner serves one queue per tick. An event that is served in the tick in which it fired keeps its time; one
 * that had to wait gets the start of the tick that serves it. So nothing leaves before it fired, and an infinite rate (tick_s =
 * 0) changes nothing.
 *
 *   TILES        one FIFO queue per tile. The scanner goes to the next tile, row by row, that has something, and takes up to
 *                K_m = floor(k0 (1 - beta_k psi_m)), at least 1, of its events.
 *   ROWS         one queue per row of pixels, as in DAVIS346's synchronous readout: the scanner takes the rows in turn, empty
 *                or not, one per tick, and stamps all that waits in it with the end of the tick.
 *   BOTTLENECK   a single queue for the whole sensor, k0 events per tick.
 *
 * Two kinds have no ticks: they follow what a chip's arbiter does, and know nothing of activity (k0, tick_s, beta_k, eta and
 * gamma_sigma_s aren't read).
 *
 *   REQUESTED    one queue per row, which asks for the bus when something waits in it. A free bus is given at once to the
 *                next row that asks, going round from the row that had it last. row_s later the row is latched: all that has
 *                fired in it by then is read, event_s each, and the bus is free again after the last (whole
 *                nanoseconds, rounded up). Event k of the reading, from 0 on in the order of firing, is stamped k + 1 event_s
 *                after the latch, floored (STAMP_EVENT), or all with the latch (STAMP_ROW, as EVT 3 chips do, whose row is one
 *                vector).
 *   SCANNED      the sensor is read as event frames (DVXplorer): at whole multiples of frame_s all that has fired by then is
 *                read, and stamped with that time (global hold). A pixel holds one event until it is read, and what it fires
 *                meanwhile is lost (counted as overflowed; queue_capacity isn't read). A frame of n events lasts
 *                max(frame_s, n event_s); the frame after one that lasts longer begins when it is over.
 *
 * psi_m in [0, 1] is a tile's activity (tides_arbiter_activity). Events are dropped on arrival with probability p0 + eta psi_m,
 * and where a queue is full. The time stamp of an event that leaves gets jitter, of standard deviation sigma = sigma0 +
 * gamma_sigma psi_m by either law. Queues, ticks and delays are as without jitter.
 *
 *   GAUSSIAN     normal, of mean 0 (the paper's): a stamp may come before its event fired, and events change places
 *   DELAY        never early: |n| sigma / sqrt(1 - 2 / pi), n normal, which is 1.32 sigma late on average
 *
 * Events leave sorted all the same: an event is held until none that is still to come can be before it, 8.6 sigma_max with
 * GAUSSIAN. Nothing is stamped before the run's start (tides_arbiter_start): stamps that jitter would move there are set to the
 * start. Random numbers depend on the seed and the event alone. */
#ifndef TIDES_READOUT_H
#define TIDES_READOUT_H

#include "tides/events.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The queues of a readout, by kind. */
enum {
    TIDES_READOUT_TILES = 0,
    TIDES_READOUT_ROWS = 1,
    TIDES_READOUT_BOTTLENECK = 2,
    TIDES_READOUT_REQUESTED = 3,
    TIDES_READOUT_SCANNED = 4
};
enum { TIDES_STAMP_EVENT = 0, TIDES_STAMP_ROW = 1 };
enum { TIDES_JITTER_GAUSSIAN = 0, TIDES_JITTER_DELAY = 1 };

/* Fill with tides_readout_defaults (disabled; tiles of 16, 1 us, 32, 0.5, 0, 0.2, 0, 10 us, 65536, GAUSSIAN, EVENT, 0, 0,
 * 0.2 ms). */
typedef struct tides_readout {
    uint32_t size;
    int32_t enabled;                /* 1: a run uses it; an arbiter itself ignores this */
    int32_t kind;                   /* TIDES_READOUT_* */
    int32_t tile_px;                /* side of a tile [px], >= 1 */
    int32_t k0;                     /* events per tick at rest, >= 1 */
    int32_t queue_capacity;         /* events that wait in one queue, >= 1 */
    double tick_s;                  /* [s]: whole nanoseconds; 0: infinite rate */
    double beta_k;                  /* in [0, 1] */
    double p0, eta;                 /* in [0, 1] */
    double sigma0_s, gamma_sigma_s; /* [s] >= 0 */
    int32_t jitter_law;             /* TIDES_JITTER_* */
    int32_t stamp;                  /* TIDES_STAMP_*, of REQUESTED */
    double row_s;                   /* [s] >= 0, whole nanoseconds */
    double event_s;                 /* [s] 0 to 1e-3, whole picoseconds */
    double frame_s;                 /* [s] whole nanoseconds, at least 1 */
} tides_readout;
TIDES_API void tides_readout_defaults(tides_readout *readout);

/* Counts of events: in = out + dropped + overflowed + waiting. */
typedef struct tides_readout_stats {
    uint64_t in, out;     /* events given to it; events that left */
    uint64_t dropped;     /* by chance */
    uint64_t overflowed;  /* lost because their queue was full */
    uint64_t waiting;     /* in queues, or held until the order is certain */
    uint64_t delayed;     /* left later than they fired, jitter aside */
    uint64_t ticks;       /* ticks in which something was served, or rows or frames that were read; idle ticks are skipped */
    double worst_delay_s; /* from firing to leaving, jitter aside [s] */
} tides_readout_stats;

/* A readout with the events that wait in it. Opaque. */
typedef struct tides_arbiter tides_arbiter;

/* Receives events in order (t, y, x, polarity), with the time [ns] at which each fired. Non-zero stops: TIDES_CANCELLED. */
typedef int (*tides_readout_sink)(void *user, const tides_event *events, const int64_t *fired, size_t count);

/* For sensors of width x height pixels, at most 65536 each. TIDES_BAD_ARGUMENT naming the field. */
TIDES_MUST_CHECK TIDES_API tides_status tides_arbiter_create(const tides_readout *readout, int32_t width, int32_t height,
                                                             uint64_t seed, tides_arbiter **arbiter, tides_error *error);

/* NULL is fine. */
TIDES_API void tides_arbiter_destroy(tides_arbiter *arbiter);

/* Sets the run's start [ns], before anything is pushed: no event leaves earlier. Without it, jitter may move events to any
 * time. */
TIDES_API void tides_arbiter_start(tides_arbiter *arbiter, int64_t start_ns);

/* The number of tiles of tile_px, across and down. ROWS and BOTTLENECK have them too, for drops and jitter. */
TIDES_API void tides_arbiter_tiles(const tides_arbiter *arbiter, int32_t *across, int32_t *down);

/* psi of every tile (across x down), each in [0, 1], for events pushed from now on. Copied. */
TIDES_MUST_CHECK TIDES_API tides_status tides_arbiter_activity(tides_arbiter *arbiter, const double *psi, tides_error *error);

/* Takes `count` events, sorted and not before any pushed earlier (else TIDES_BAD_ARGUMENT and none is taken). `sink`
 * (nullable) receives events that have left. The result doesn't depend on how a stream is cut into calls. */
TIDES_MUST_CHECK TIDES_API tides_status tides_arbiter_push(tides_arbiter *arbiter, const tides_event *events, size_t count,
                                                           tides_readout_sink sink, void *user, tides_error *error);

/* Gives `sink` all events that still wait: the scanner goes on until the queues are empty. */
TIDES_MUST_CHECK TIDES_API tides_status tides_arbiter_finish(tides_arbiter *arbiter, tides_readout_sink sink, void *user,
                                                             tides_error *error);

/* Counts since the arbiter was made. */
TIDES_API void tides_arbiter_stats(const tides_arbiter *arbiter, tides_readout_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
