/* Events as a page to look at: one HTML file that contains the events and what shows them, for any browser, also from a disk.
 * It shows an x-y-t cloud to turn, a window of time to drag and play, the window's event frame, and the rate. Colours show
 * polarity or cause, and with ground truth depth, optical flow and instance. Nothing is loaded from elsewhere. */
#ifndef TIDES_PAGE_H
#define TIDES_PAGE_H

#include "tides/truth.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The events that the page shows, and its first view of them. */
typedef struct tides_page_options {
    uint32_t size;             /* sizeof this struct */
    int32_t width, height;     /* of the sensor [px]; 0: what the file says, else what the events reach */
    int64_t start_ns, stop_ns; /* events with start <= t < stop are shown */
    int64_t window_ns;         /* first length of the window of time; 0: a fiftieth of the shown stretch */
    uint64_t most;             /* at most this many events are shown; the page and the report say so if there are more */
    const char *title;         /* NULL: the name of the file that is read */
    const char *format;        /* of the file that is read; NULL: by content */
    const struct tides_event_reading *reading; /* options of reading; NULL: as `format` says */
} tides_page_options;

/* Shows all of a recording, up to 10 million events (of some 7 bytes in the page). */
TIDES_API void tides_page_options_defaults(tides_page_options *options);

/* The content of a written page. */
typedef struct tides_page_report {
    uint64_t events;           /* in the page */
    int64_t start_ns, stop_ns; /* the stretch that the page shows */
    int32_t width, height;     /* of the sensor [px] */
    int32_t truth;             /* 1: with ground truth */
    int32_t ended;             /* 1: there were too many events; those from stop_ns on aren't shown */
} tides_page_report;

/* Writes the page of events in memory, which are in order of time (else TIDES_BAD_ARGUMENT). `truth` (count), `options` and
 * `report` may be NULL. */
TIDES_MUST_CHECK TIDES_API tides_status tides_page_write(const char *path, const tides_event *events,
                                                         const tides_event_truth *truth, size_t count,
                                                         const tides_page_options *options, tides_page_report *report,
                                                         tides_error *error);

/* Writes the page of an event file of any format, streamed in a few megabytes, with the file's labels and ground truth.
 * Events that are late by up to 131072 places are sorted; later ones are TIDES_BAD_FILE. `options`, `progress` and `report`
 * may be NULL; progress returns non-zero to stop (TIDES_CANCELLED). */
TIDES_MUST_CHECK TIDES_API tides_status tides_page_write_file(const char *events, const char *path,
                                                              const tides_page_options *options, tides_progress progress,
                                                              void *user, tides_page_report *report, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
