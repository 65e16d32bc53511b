/* Internal: a page of events that is being written: the template, with chunks of events in the middle. */
#ifndef TD_PAGE_H
#define TD_PAGE_H

#include "td_text.h"
#include "tides/page.h"

enum {
    /* Events in a chunk, which a browser unpacks and draws at once. 10 million events are then about a hundred draw calls,
     * and a chunk takes 2 MB while it is written or read. An event in a file may be late by as many positions. */
    TD_PAGE_CHUNK = 131072
};

typedef struct td_page {
    td_text text;
    tides_page_options options;
    tides_page_report report;
    tides_event *events; /* room for 2 TD_PAGE_CHUNK; when full, it is sorted, and the first half is written */
    tides_event *scratch;
    tides_event_truth *truth; /* of the events; NULL: none */
    size_t count;
    int32_t disorder;                /* 1: the waiting events aren't in order */
    int64_t last_ns;                 /* time of the last written event */
    int64_t arrived_ns;              /* time of the last appended event */
    int64_t known_start, known_stop; /* span of the recording; equal: unknown */
    uint64_t chunks;
    uint32_t causes;                /* bit c: some event has cause c */
    unsigned char *planes, *packed; /* bytes of a chunk */
    char *base64;
} td_page;

/* Writes the page up to its events. End it in any case: td_page_end completes the file if `status` is TIDES_OK, or removes
 * it. */
tides_status td_page_begin(td_page *page, const char *path, const tides_page_options *options, int32_t with_truth,
                           tides_error *error);
/* Appends those events that are to be shown; `truth` is NULL for a page without truth. */
tides_status td_page_append(td_page *page, const tides_event *events, const tides_event_truth *truth, size_t count,
                            tides_error *error);
tides_status td_page_end(td_page *page, tides_status status, tides_error *error);

/* Writes the first `count` events as chunks. The others give the most bytes that a chunk takes: as planes, deflated, and as
 * base64. */
tides_status td_page_put_chunks(td_page *page, size_t count, tides_error *error);
size_t td_page_planes_room(int32_t with_truth);
size_t td_page_packed_room(int32_t with_truth);
size_t td_page_base64_room(int32_t with_truth);

/* Writes bytes; a failure is reported by the next td_text_put, or when the page is closed. */
void td_page_put(td_text *text, const void *bytes, size_t size);

/* Write the template's lines before the events, and behind them. */
void td_page_put_head(td_text *text);
void td_page_put_tail(td_text *text);

#endif
