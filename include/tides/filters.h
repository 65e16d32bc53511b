/* The filters that a camera applies to its events, after the readout. A filter passes or drops each event, and doesn't change
 * its time. It decides at once, from earlier events only, so a stream may be cut anywhere, and memory depends only on the
 * sensor's size.
 *
 * Filters work in this order; each sees only the events that the one before it passed. The order of AFK, trail and ERC is that
 * of Prophesee's manual (docs.prophesee.ai, hw/manuals/esp). The place of its activity filter isn't published, and no camera
 * has background and the others. t is the event's time, p its polarity; "before" is at that filter's input.
 *
 *   BACKGROUND   passes where at least `background_support` of the 8 neighbours had an event, of any polarity, at or after
 *                t - background_s (Metavision's activity noise filter; libcaer's and jAER's background activity filters)
 *   ACTIVITY     the rate of each period activity_period_s decides on the next ones: dropping begins where it is below
 *                activity_low_start, and ends above activity_low_stop; likewise above activity_high_start and below
 *                activity_high_stop. It begins dropping where there is a lower bound (Metavision's HAL,
 *                I_EventRateActivityFilterModule)
 *   AFK          anti-flicker. A cell of afk_cell_px squared turns to a polarity where its event before had the other (the
 *                first event turns to its own). v is the time since its turn before to this polarity. The cell's counter goes
 *                up by 1 where 1 / afk_high_hz <= v <= 1 / afk_low_hz, else down by 1, within 0 to 7. The cell flickers from
 *                the time when the counter reaches afk_start until it is at afk_stop or below. BAND_STOP drops the events of
 *                cells that flicker, BAND_PASS all others. (Bounds, cells and the counter's numbers are Prophesee's; the rule
 *                by which it counts isn't published, and is TIDES's own.)
 *   TRAIL        by pixel; L and q are time and polarity of its event before (Metavision's trail and spatio-temporal contrast
 *                filters):
 *                  TRAIL      passes where p != q or t - L >= trail_s
 *                  STC_CUT    where p != q the event is dropped and arms the pixel; else it passes where the pixel is armed and
 *                             t - L <= trail_s, and disarms it: the second event of a burst alone
 *                  STC_KEEP   the same without disarming: the second event and all after it
 *   ERC          event rate control. CHANCE: each with probability min(1, erc_events / events of the period before). FIRST: the
 *                first erc_events of each period. Periods begin at whole multiples of erc_period_s on the events' clock, as do
 *                those of ACTIVITY. */
#ifndef TIDES_FILTERS_H
#define TIDES_FILTERS_H

#include "tides/events.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The modes of anti-flicker, trail and event rate control. */
enum { TIDES_AFK_OFF = 0, TIDES_AFK_BAND_STOP = 1, TIDES_AFK_BAND_PASS = 2 };
enum { TIDES_TRAIL_OFF = 0, TIDES_TRAIL_TRAIL = 1, TIDES_TRAIL_STC_CUT = 2, TIDES_TRAIL_STC_KEEP = 3 };
enum { TIDES_ERC_CHANCE = 0, TIDES_ERC_FIRST = 1 };

/* The filters, in the order in which they are applied. */
enum {
    TIDES_STAGE_BACKGROUND = 0,
    TIDES_STAGE_ACTIVITY = 1,
    TIDES_STAGE_AFK = 2,
    TIDES_STAGE_TRAIL = 3,
    TIDES_STAGE_ERC = 4,
    TIDES_STAGES = 5
};

/* Fill with tides_filters_defaults: all off (1, 0; 0 0 0 0, 1 ms; OFF, 50 and 520 Hz, 4, 6, 4;
 * OFF, 10 ms; 0, CHANCE, 0.2 ms). */
typedef struct tides_filters {
    uint32_t size;
    int32_t background_support;                     /* 1 to 8 */
    double background_s;                            /* [s] >= 0; 0: off */
    double activity_low_start, activity_low_stop;   /* [events/s] bound below; start 0: none; stop 0: equal to start, */
    double activity_high_start, activity_high_stop; /* else low_stop >= low_start and high_stop <= high_start */
    double activity_period_s;                       /* [s] whole nanoseconds, at least 1 */
    double afk_low_hz, afk_high_hz;                 /* [Hz] 0 < low <= high */
    int32_t afk;                                    /* TIDES_AFK_* */
    int32_t afk_cell_px;                            /* side of a cell [px] >= 1 */
    int32_t afk_start, afk_stop;                    /* 0 <= stop < start <= 7 */
    double trail_s;                                 /* [s] >= 0 */
    int32_t trail;                                  /* TIDES_TRAIL_* */
    int32_t erc_events;                             /* >= 0; 0: off */
    double erc_period_s;                            /* [s] whole nanoseconds, at least 1 */
    int32_t erc_law;                                /* TIDES_ERC_* */
    int32_t reserved;
} tides_filters;
TIDES_API void tides_filters_defaults(tides_filters *filters);

/* 1 if any filter is on. */
TIDES_API int32_t tides_filters_any(const tides_filters *filters);

/* Counts of the events: in = out + the sum of dropped. */
typedef struct tides_filter_stats {
    uint64_t in, out;               /* events given, and passed */
    uint64_t dropped[TIDES_STAGES]; /* by TIDES_STAGE_* */
} tides_filter_stats;

/* Filters with their memory of earlier events. Opaque; for one thread at a time. */
typedef struct tides_filter tides_filter;

/* For sensors of width x height pixels, at most 65536 each. ERC's CHANCE draws from the seed and the event alone.
 * TIDES_BAD_ARGUMENT naming the field; TIDES_NO_MEMORY. */
TIDES_MUST_CHECK TIDES_API tides_status tides_filter_create(const tides_filters *filters, int32_t width, int32_t height,
                                                            uint64_t seed, tides_filter **filter, tides_error *error);

/* NULL is fine. */
TIDES_API void tides_filter_destroy(tides_filter *filter);

/* Takes `count` events, sorted by time and not before earlier ones (else TIDES_BAD_ARGUMENT, and none is taken). The `kept`
 * events that pass are moved to the front of `events`, in order, and so are their times in `fired` (count; nullable). The
 * result doesn't depend on how a stream is cut into calls. */
TIDES_MUST_CHECK TIDES_API tides_status tides_filter_apply(tides_filter *filter, tides_event *events, int64_t *fired,
                                                           size_t count, size_t *kept, tides_error *error);

/* Counts since the filter was made. */
TIDES_API void tides_filter_stats_get(const tides_filter *filter, tides_filter_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
