/* From one event file to another: formats, stretches, windows, clocks, and a camera's filters. */
#ifndef TIDES_CONVERT_H
#define TIDES_CONVERT_H

#include "tides/filters.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The part of a file that is kept when it is converted to another format. */
typedef struct tides_event_conversion {
    const char *from, *to;               /* names of formats; NULL: by content, by ending */
    int32_t width, height;               /* of the sensor [px]; 0: what the file says, else what its events reach */
    int64_t start_ns, stop_ns;           /* events with start <= t < stop are kept */
    int32_t x, y, cut_width, cut_height; /* and those in this window, which becomes the sensor; cut_width 0: all */
    int32_t rebase;                      /* as tides_event_reading; start_ns and stop_ns are times after it */
    int32_t drop_invalid;                /* as tides_event_reading; `width` and `height` bound the sensor too */
    const char *columns, *unit, *stream; /* as tides_event_reading */
    int64_t offset_ns;                   /* as tides_event_reading; start_ns and stop_ns are times after it */
    const tides_filters *filters;        /* of a camera, which what is kept goes through; NULL: none */
} tides_event_conversion;

/* Result of a conversion. Plain value. */
typedef struct tides_event_conversion_report {
    uint64_t read, written;          /* events */
    uint64_t disorder;               /* events earlier than the one before them in the file: they were put in order */
    uint64_t collapsed;              /* as tides_event_writer_collapsed */
    int64_t first_ns, last_ns;       /* as written; 0 where nothing was */
    int32_t width, height;           /* [px] of the sensor as written */
    char from[32], to[32];           /* names of formats */
    int32_t labels;                  /* TIDES_LABEL_* of the file, which aren't kept */
    int32_t zero;                    /* with `rebase`: TIDES_ZERO_* */
    int64_t zero_ns;                 /* with `rebase`: what became time 0, on the file's clock */
    uint64_t dropped;                /* invalid events that were left out */
    char read_as[160];               /* as tides_event_facts */
    uint64_t filtered[TIDES_STAGES]; /* dropped by `filters`, by TIDES_STAGE_* */
} tides_event_conversion_report;

/* Everything, by content and by ending. */
TIDES_API void tides_event_conversion_defaults(tides_event_conversion *conversion);

/* Converts and cuts an event file, streamed in a few megabytes. Events of one time are sorted by y, x, polarity; events that
 * are late by up to 65536 places are put in order, and more is TIDES_BAD_FILE. The output is a complete new file or what was
 * there before. Labels aren't kept: they are those of the recording that was simulated. A stretch that isn't the recording's
 * (tides_event_stretch_check) is TIDES_BAD_ARGUMENT. `progress` may be NULL; it returns non-zero to stop (TIDES_CANCELLED). */
TIDES_MUST_CHECK TIDES_API tides_status tides_events_convert(const char *in, const char *out,
                                                             const tides_event_conversion *conversion, tides_progress progress,
                                                             void *user, tides_event_conversion_report *report,
                                                             tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
