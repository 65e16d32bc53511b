/* Internal: a page of events on its way: the template of share/page around chunks of columns (page_chunk.c has their
 * layout). */
#ifndef TD_PAGE_H
#define TD_PAGE_H

#include "td_text.h"
#include "tides/page.h"

enum {
    /* Events of a chunk. A chunk is what a browser unpacks, and draws, at a time: large enough for some hundred draw calls to
     * be 10 million events, small enough to be 2 MB while it is written and read. It is also how many places an event of a file
     * may be late by. */
    TD_PAGE_CHUNK = 131072
};

typedef struct td_page {
    td_text text;
    tides_page_options options;
    tides_page_report report;
    tides_event *events; /* 2 TD_PAGE_CHUNK: the first half is written when they are full and in order */
    tides_event *scratch;
    tides_event_truth *truth; /* of events; NULL: they have none */
    size_t count;
    int32_t disorder;                /* what waits isn't in order */
    int64_t last_ns;                 /* of the last event that was written, and */
    int64_t arrived_ns;              /* that was appended */
    int64_t known_start, known_stop; /* the recording's stretch; equal: not known */
    uint64_t chunks;
    uint32_t causes;                /* bit c: an event has cause c */
    unsigned char *planes, *packed; /* a chunk's bytes */
    char *base64;
} td_page;

/* The page up to its events, with room for truth or not. To be closed in any case: `status` as td_text_close has it. */
tides_status td_page_begin(td_page *page, const char *path, const tides_page_options *options, int32_t with_truth,
                           tides_error *error);
/* Takes those of the events that are to be shown; `truth` where the page has it. */
tides_status td_page_append(td_page *page, const tides_event *events, const tides_event_truth *truth, size_t count,
                            tides_error *error);
tides_status td_page_end(td_page *page, tides_status status, tides_error *error);

/* page_chunk.c: writes the first `count` events as chunks. */
tides_status td_page_put_chunks(td_page *page, size_t count, tides_error *error);
size_t td_page_planes_room(int32_t with_truth);
size_t td_page_packed_room(int32_t with_truth);
size_t td_page_base64_room(int32_t with_truth);

/* Bytes as they are; a failure is reported by the next td_text_put, or when the page is closed. */
void td_page_put(td_text *text, const void *bytes, size_t size);

/* page_source.c: the template's lines up to the place of the events, or from there on. */
void td_page_put_head(td_text *text);
void td_page_put_tail(td_text *text);

#endif
