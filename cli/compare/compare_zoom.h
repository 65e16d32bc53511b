/* The close view in the picture of a comparison: which part of a row and which time, and the distance of events from exact
 * ones. */
#ifndef CLI_COMPARE_ZOOM_H
#define CLI_COMPARE_ZOOM_H

#include "compare.h"
#include "view.h"

/* The times of exact events at each place, a pixel and a polarity. */
typedef struct compare_index {
    size_t *first; /* places' first entries in `times` */
    int64_t *times;
    int32_t width;
} compare_index;
/* Makes the index. It must be zeroed before, and freed also after a failure. */
tides_status compare_index_make(const comparison *c, compare_index *index, tides_error *error);
void compare_index_free(compare_index *index);
/* How much later an event is than the nearest exact one of its pixel and polarity [ns]; infinite without one. */
double compare_offset_ns(const compare_index *index, const tides_event *event);

/* The part of a row, and the time, that the picture shows. */
tides_status compare_choose_zoom(const comparison *c, view_mark *zoom, tides_error *error);
/* The events within the view, in `kept` (nullable: only counted), which has room for `count`. */
cli_window compare_zoom_events(const view_mark *zoom, const tides_event *events, size_t count, tides_event *kept);

#endif
