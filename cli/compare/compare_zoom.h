/* The close view in compare's picture: the part of a row and the time that it shows, and how far events are from exact ones. */
#ifndef CLI_COMPARE_ZOOM_H
#define CLI_COMPARE_ZOOM_H

#include "compare.h"
#include "view.h"

/* The times of exact events at each place: of a pixel and a polarity. */
typedef struct compare_index {
    size_t *first; /* of each place, in `times` */
    int64_t *times;
    int32_t width;
} compare_index;
/* Makes the index. Zero it before, and free it also after a failure. */
tides_status compare_index_make(const comparison *c, compare_index *index, tides_error *error);
void compare_index_free(compare_index *index);
/* How much later an event is than the nearest exact one of its pixel and polarity; infinite where there is none. */
double compare_offset_ns(const compare_index *index, const tides_event *event);

/* The part of a row, and the time, that the picture shows. */
tides_status compare_choose_zoom(const comparison *c, view_mark *zoom, tides_error *error);
/* Events there, in `kept` (nullable: counted only), which has room for `count`. */
cli_window compare_zoom_events(const view_mark *zoom, const tides_event *events, size_t count, tides_event *kept);

#endif
