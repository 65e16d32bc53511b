/* The event record and event files. */
#ifndef TIDES_EVENTS_H
#define TIDES_EVENTS_H

#include "tides/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One event, 16 bytes. Streams are sorted by (t, y, x, polarity). */
typedef struct tides_event {
    int64_t t;       /* [ns] from the run's time zero */
    uint16_t x, y;   /* [px] */
    int8_t polarity; /* +1 or -1 */
    uint8_t cause;   /* TIDES_CAUSE_*: the signal, or which noise */
    uint8_t reserved[2];
} tides_event;

/* Facts written into the file's attributes. Plain value; strings are copied. */
typedef struct tides_event_file {
    int32_t width, height; /* [px] */
    const char *run;       /* run file as JSON text, or NULL */
    const char *seed;      /* or NULL */
} tides_event_file;

typedef struct tides_event_writer tides_event_writer;

/* Starts an HDF5 event file in the DSEC layout (events/{p,t,x,y}, ms_to_idx, t_offset), with events/t_ns and our attributes
 * added; layout documented in lib/events/events_hdf5.c. Written as `path` + ".part" and renamed by _finish, so that `path`
 * is either the old file or a complete new one; what was flushed to the .part stays readable. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_writer_open(const char *path, const tides_event_file *file,
                                                                tides_event_writer **writer, tides_error *error);

/* Appends `count` events. They must be sorted, not before the last appended one, and inside the image: else
 * TIDES_BAD_ARGUMENT and nothing of this call is written. Buffered: reaches the file chunk by chunk. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_writer_append(tides_event_writer *writer, const tides_event *events,
                                                                  size_t count, tides_error *error);

/* Number of events appended so far. */
TIDES_API uint64_t tides_event_writer_count(const tides_event_writer *writer);

/* Makes everything appended so far survive the death of the process: whole chunks are in the .part already, the events after
 * them go to `path` + ".part.tail". A failure leaves what was safe as it was, and the writer usable. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_writer_flush(tides_event_writer *writer, tides_error *error);

/* Goes on with a recording that was interrupted: opens the .part (and its tail) that a writer of `path` left, abandoned or
 * killed, and drops every event after the first `count`. These must have been flushed, or be in an abandoned file; the
 * file that _finish makes is then the same as that of a recording in one piece. `file` must have the size that the .part has;
 * its run text replaces the .part's. TIDES_FILE_NOT_FOUND without a .part; TIDES_BAD_FILE where it holds fewer events, is of
 * another size, or damaged: it is then left as it was, unless the damage was only found while cutting. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_writer_resume(const char *path, const tides_event_file *file,
                                                                  uint64_t count, tides_event_writer **writer,
                                                                  tides_error *error);

/* Flushes, completes the index, closes and renames. The writer is gone afterwards whatever is returned. `stop_ns` is the end
 * of the recording: ms_to_idx covers it. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_writer_finish(tides_event_writer *writer, int64_t stop_ns,
                                                                  tides_error *error);

/* Flushes and closes what there is, and leaves the .part file. NULL is fine. */
TIDES_API void tides_event_writer_abandon(tides_event_writer *writer);

/* Sets the causes of `count` events that were read from number `first` on (tides_events_read): those of /events/cause, and 0,
 * the signal, where the file has no such column. */
TIDES_MUST_CHECK TIDES_API tides_status tides_events_causes(const char *path, uint64_t first, size_t count, tides_event *events,
                                                            tides_error *error);

/* What a file holds. */
typedef struct tides_event_summary {
    uint64_t count, count_on;
    int64_t first_ns, last_ns; /* 0 where empty */
    int32_t width, height;     /* 0 where the file doesn't say */
    char layout[32];           /* "tides", "dsec" */
    char version[32];          /* of the writer, or "" */
} tides_event_summary;

TIDES_MUST_CHECK TIDES_API tides_status tides_events_summary(const char *path, tides_event_summary *summary,
                                                             tides_error *error);

/* Reads events [first, first + count) of an HDF5 file in the DSEC layout into `events` (caller's memory); `got` receives how
 * many there were. Times from events/t_ns where present, else events/t in microseconds plus t_offset; foreign files come in
 * their own order. On failure `events` may hold some of them. */
TIDES_MUST_CHECK TIDES_API tides_status tides_events_read(const char *path, uint64_t first, size_t count, tides_event *events,
                                                          size_t *got, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
