/* Internal: requirements of every representation on its events. */
#ifndef TD_REPRESENTATION_H
#define TD_REPRESENTATION_H

#include "td_base.h"
#include "tides/representations.h"

/* Checks polarities, order and places of events. `call` is the function's name in the error. */
tides_status td_representation_check(const char *call, const tides_event *events, size_t count, int32_t width, int32_t height,
                                     tides_error *error);

static inline size_t td_representation_pixel(const tides_event *event, int32_t width) {
    return (size_t)event->y * (size_t)width + event->x;
}

#endif
