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
    int32_t rebase;       /* 1: times count from the recording's zero; start_ns and stop_ns are then relative to it */
    int32_t drop_invalid; /* 1: invalid events are left out and counted; `width` and `height` then bound the sensor too */
    const char *columns, *unit, *stream; /* options of reading (tides_event_reading), or NULL */
    int64_t offset_ns;                   /* added to all times, after `rebase`; start_ns and stop_ns apply after it */
    const tides_filters *filters;        /* filters that the kept events go through; NULL: none */
} tides_event_conversion;

/* Result of a conversion. Plain value. */
typedef struct tides_event_conversion_report {
    uint64_t read, written;          /* events */
    uint64_t disorder;               /* events that were earlier than the one before in the file; they were sorted */
    uint64_t collapsed;              /* events that share their pixel and the format's tick with an earlier one */
    int64_t first_ns, last_ns;       /* of the written events; 0 if there are none */
    int32_t width, height;           /* [px] of the sensor as written */
    char from[32], to[32];           /* names of formats */
    int32_t labels;                  /* TIDES_LABEL_* that the file had; they aren't kept */
    int32_t zero;                    /* with `rebase`: TIDES_ZERO_* */
    int64_t zero_ns;                 /* with `rebase`: what became time 0, on the file's clock */
    uint64_t dropped;                /* invalid events that were left out */
    char read_as[160];               /* how columns and units were decided if the format leaves them open, else "" */
    uint64_t filtered[TIDES_STAGES]; /* dropped by `filters`, by TIDES_STAGE_* */
} tides_event_conversion_report;

/* The whole file; formats by content and by ending. */
TIDES_API void tides_event_conversion_defaults(tides_event_conversion *conversion);

/* Converts and cuts an event file, streamed in a few megabytes. Events of one time are sorted by y, x, polarity. Events that
 * are late by up to 65536 places are sorted; later ones are TIDES_BAD_FILE. The output is complete, or what was there before.
 * Labels aren't kept, because they belong to the simulated recording. TIDES_BAD_ARGUMENT: the stretch isn't within the
 * recording's clock. `progress` (nullable) returns non-zero to stop (TIDES_CANCELLED). */
TIDES_MUST_CHECK TIDES_API tides_status tides_events_convert(const char *in, const char *out,
                                                             const tides_event_conversion *conversion, tides_progress progress,
                                                             void *user, tides_event_conversion_report *report,
                                                             tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
