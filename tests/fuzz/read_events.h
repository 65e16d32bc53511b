/* Shared by the fuzz targets of events: reads a file or folder to the end within the sensor that it tells, or it is refused in
 * one line. At most 100 000 events are read, since a few compressed bytes can stand for many. */
#ifndef TESTS_FUZZ_READ_EVENTS_H
#define TESTS_FUZZ_READ_EVENTS_H

#include "fuzz.h"

#include "tides/events.h"

enum { FUZZ_BATCH = 1000, FUZZ_BATCHES = 100 };

static inline void fuzz_check_events(const tides_event_facts *facts, const tides_event *events, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (events[i].polarity != 1 && events[i].polarity != -1) abort();
        if (facts->width && (events[i].x >= facts->width || events[i].y >= facts->height)) abort();
    }
}

static inline void fuzz_read_on(tides_event_reader *reader) {
    static tides_event events[FUZZ_BATCH];
    tides_event_facts facts;
    tides_error error = {TIDES_OK, ""};
    tides_status status = TIDES_OK;
    uint64_t total = 0;
    size_t got = 1;
    tides_event_reader_facts(reader, &facts);
    if (facts.width < 0 || facts.height < 0 || !facts.width != !facts.height) abort();
    for (int i = 0; i < FUZZ_BATCHES && got && status == TIDES_OK; i++) {
        status = tides_event_reader_read(reader, events, FUZZ_BATCH, &got, &error);
        if (status == TIDES_OK) fuzz_check_events(&facts, events, got);
        total += got;
    }
    if (status != TIDES_OK) fuzz_refusal(status, &error);
    if (facts.counted && total > facts.count) abort();
}

/* `may_lack`: that it isn't there, or that a folder holds no events, is no fault. */
static inline void fuzz_read_events(const char *path, const char *format, int may_lack) {
    tides_event_reader *reader = NULL;
    tides_error error = {TIDES_OK, ""};
    tides_status status = tides_event_reader_open(path, format, &reader, &error);
    if (status == TIDES_OK) {
        fuzz_read_on(reader);
        tides_event_reader_close(reader);
        return;
    }
    if (reader) abort();
    if (may_lack && status == TIDES_FILE_NOT_FOUND)
        fuzz_one_line(status, &error);
    else
        fuzz_refusal(status, &error);
}

#endif
