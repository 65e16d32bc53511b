/* Internal: the state of a camera's filters. All changing state is one array of whole numbers, so that a checkpoint stores it
 * as one array, and a step is undone by a copy. */
#ifndef TD_FILTER_H
#define TD_FILTER_H

#include "tides/filters.h"

/* The beginning of the array. Times are in [ns], TD_NEVER for none. */
#define TD_NEVER INT64_MIN
enum {
    TD_FILTER_LAST,                                        /* time of the last event */
    TD_FILTER_IN,                                          /* number of events given to the filters */
    TD_FILTER_DROPPED,                                     /* numbers of events that each filter dropped */
    TD_FILTER_ACTIVITY = TD_FILTER_DROPPED + TIDES_STAGES, /* activity filter's counter by periods (TD_PERIOD_*) */
    TD_FILTER_LOW = TD_FILTER_ACTIVITY + 3,                /* 1: the activity filter drops, since the rate was too low */
    TD_FILTER_HIGH,                                        /* 1: it drops, since the rate was too high */
    TD_FILTER_ERC,                                         /* event rate control's counter by periods (TD_PERIOD_*) */
    TD_FILTER_HEADER = TD_FILTER_ERC + 3
};

/* A counter of events by periods: number of the last event's period, events in it so far, and events in the period before. */
enum { TD_PERIOD_NUMBER, TD_PERIOD_COUNT, TD_PERIOD_BEFORE };

/* State of a cell of AFK, the anti-flicker filter: times of the last changes to OFF and to ON; polarity of the last event, or
 * 0; counter of changes at a flicker's period; 1 if the cell flickers. */
enum { TD_CELL_OFF, TD_CELL_ON, TD_CELL_POLARITY, TD_CELL_COUNTER, TD_CELL_FLICKERS, TD_CELL };

/* State of a pixel of the trail filter: time of its last event; polarity of that, or 0; 1 if the pixel is armed. A change of
 * polarity arms a pixel, so that the next event of that polarity passes. */
enum { TD_TRAIL_LAST, TD_TRAIL_POLARITY, TD_TRAIL_ARMED, TD_TRAIL };

struct tides_filter {
    tides_filters filters;
    int32_t width, height, cells_across;
    uint64_t seed;
    int64_t background_ns, activity_ns, erc_ns, trail_ns, afk_least_ns, afk_most_ns;
    int64_t *state; /* (count) */
    size_t count;
    /* parts of `state`; NULL if the filter is off */
    /* ((height + 2) x (width + 2)) time of each pixel's last event, with a border of pixels that never have one */
    int64_t *seen;
    int64_t *cells; /* (cells x TD_CELL) */
    int64_t *trail; /* (height x width x TD_TRAIL) */
};

/* Time from `then` to t >= then; the largest number if `then` is TD_NEVER, or if the difference overflows. */
static inline int64_t td_since(int64_t t, int64_t then) {
    const uint64_t gap = (uint64_t)t - (uint64_t)then;
    return then == TD_NEVER || gap > (uint64_t)INT64_MAX ? INT64_MAX : (int64_t)gap;
}

/* Each takes an event, updates its filter's state, and returns 1 if the event passes. Call it only if the filter is on. */
int td_filter_background(tides_filter *filter, const tides_event *event);
int td_filter_activity(tides_filter *filter, const tides_event *event);
int td_filter_afk(tides_filter *filter, const tides_event *event);
int td_filter_trail(tides_filter *filter, const tides_event *event);
int td_filter_erc(tides_filter *filter, const tides_event *event);

#endif
