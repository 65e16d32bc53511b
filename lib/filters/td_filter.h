/* Internal: the state of a camera's filters. All of it that changes is one array of whole numbers. So a checkpoint
 * (lib/checkpoint) has it in one row of a table, and a step is undone by a copy. */
#ifndef TD_FILTER_H
#define TD_FILTER_H

#include "tides/filters.h"

/* In front of the array. Times [ns], TD_NEVER where there is none. */
#define TD_NEVER INT64_MIN
enum {
    TD_FILTER_LAST,                                        /* time of the event that was taken last */
    TD_FILTER_IN,                                          /* counts: of events taken, */
    TD_FILTER_DROPPED,                                     /* and of those dropped, one for each filter */
    TD_FILTER_ACTIVITY = TD_FILTER_DROPPED + TIDES_STAGES, /* a td_period */
    TD_FILTER_LOW = TD_FILTER_ACTIVITY + 3,                /* 1: it drops because the rate was too low, */
    TD_FILTER_HIGH,                                        /* too high */
    TD_FILTER_ERC,                                         /* a td_period */
    TD_FILTER_HEADER = TD_FILTER_ERC + 3
};

/* State of a filter that counts events by periods: the number of the last event's period, the events so far in it, and those in
 * the period before it. */
enum { TD_PERIOD_NUMBER, TD_PERIOD_COUNT, TD_PERIOD_BEFORE };

/* State of a cell of AFK: the last turn to OFF and to ON; polarity of the last event, or 0; the counter; 1 where it
 * flickers. */
enum { TD_CELL_OFF, TD_CELL_ON, TD_CELL_POLARITY, TD_CELL_COUNTER, TD_CELL_FLICKERS, TD_CELL };

/* State of a pixel of the trail filter: time of its last event; that one's polarity, or 0; 1 where the pixel is armed. */
enum { TD_TRAIL_LAST, TD_TRAIL_POLARITY, TD_TRAIL_ARMED, TD_TRAIL };

struct tides_filter {
    tides_filters filters;
    int32_t width, height, cells_across;
    uint64_t seed;
    int64_t background_ns, activity_ns, erc_ns, trail_ns, afk_least_ns, afk_most_ns;
    int64_t *state; /* (count) */
    size_t count;
    /* in `state`; NULL: that filter is off */
    int64_t *seen;  /* ((height + 2) x (width + 2)) last event of each pixel, with a border of pixels that never have one */
    int64_t *cells; /* (cells x TD_CELL) */
    int64_t *trail; /* (height x width x TD_TRAIL) */
};

/* From then to t, which isn't before it: as long as there is if it never was, or doesn't fit. */
static inline int64_t td_since(int64_t t, int64_t then) {
    const uint64_t gap = (uint64_t)t - (uint64_t)then;
    return then == TD_NEVER || gap > (uint64_t)INT64_MAX ? INT64_MAX : (int64_t)gap;
}

/* Each says whether the event passes, and remembers it (stages.c). Only where the filter is on. */
int td_filter_background(tides_filter *filter, const tides_event *event);
int td_filter_activity(tides_filter *filter, const tides_event *event);
int td_filter_afk(tides_filter *filter, const tides_event *event);
int td_filter_trail(tides_filter *filter, const tides_event *event);
int td_filter_erc(tides_filter *filter, const tides_event *event);

#endif
