/* The event record and event files. */
#ifndef TIDES_EVENTS_H
#define TIDES_EVENTS_H

#include "tides/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One event, 16 bytes. Streams are sorted by (t, y, x, polarity). */
typedef struct tides_event {
    int64_t t;         /* [ns] of the run's clock: the scene's and the path's time, absolute */
    uint16_t x, y;     /* [px] */
    int8_t polarity;   /* +1 or -1 */
    uint8_t cause;     /* TIDES_CAUSE_*: the signal, or which noise */
    uint16_t frontend; /* tides_event_frontend as an IEEE 754 binary16 number: to one part in 2048 */
} tides_event;

/* The front end's contribution to the signal when the event fired: S - L [log units], S being the comparator's input. It
 * includes the low-pass or circuit, the surround and the additive noise: behind a low-pass of time constant tau it is -tau
 * L_dot on a ramp. It excludes the optics' blur, because L is behind it, and the leak, which moves the reference and not S. It
 * is 0 where none of these is on and where sensor.labels is off; it is never NaN. */
TIDES_API double tides_event_frontend(const tides_event *event);

/* Labels of events, each a column of HDF5 files: /events/cause, /events/fired [ns], when the pixel fired, before the readout,
 * and /events/frontend, tides_event_frontend. */
enum { TIDES_LABEL_CAUSE = 1, TIDES_LABEL_FIRED = 2, TIDES_LABEL_FRONTEND = 4 };

/* Facts written into the file's attributes. Plain value; strings are copied. */
typedef struct tides_event_file {
    int32_t width, height; /* [px] */
    const char *run;       /* run file as JSON text, or NULL */
    const char *seed;      /* or NULL */
    int32_t labels; /* 1: with all labels; TIDES_UNSUPPORTED but in HDF5. 0: HDF5 has causes, if some aren't the signal's */
    /* [ns] The recording's stretch; both 0: not known. Where it is, what the format can't hold of it is TIDES_UNSUPPORTED at
     * once; else the first event that doesn't fit is. HDF5 counts its 32-bit microseconds from t_offset: 0 where the recording
     * lies within their first 4294.967 s, else its start; where that isn't known, of half an hour from its first event. */
    int64_t start_ns, stop_ns; /* as above */
} tides_event_file;

/* A file that is being written. Opaque. */
typedef struct tides_event_writer tides_event_writer;

/* The formats of event files: name ("evt3"), a few words, the endings of files that are written in it ("" where it is only
 * chosen by name), and what the library does with it. */
typedef struct tides_event_format {
    const char *name, *summary, *endings; /* static storage */
    int32_t reads, writes;                /* 1 where the library can */
    int64_t tick_ns;                      /* times are floored to it on writing */
} tides_event_format;

/* Format number `index` from 0 on, its texts constant; 1, or 0 behind the last. */
TIDES_API int32_t tides_event_format_at(size_t index, tides_event_format *format);

/* Starts an event file in the named format, or where `format` is NULL in that of the path's ending (tides_event_format_at; HDF5
 * without one). Every format is streamed, floors times to its tick, bridges the turns of its clock by its own rule, and is
 * written as `path` + ".part", renamed by _finish: `path` is either the old file or a complete new one; flushed events stay
 * readable in the .part. HDF5, the native one: the DSEC layout (events/{p,t,x,y}, ms_to_idx, t_offset), with events/t_ns and
 * our attributes added (lib/events/events_hdf5.c). TIDES_UNSUPPORTED: the format isn't written, or the sensor is too large for
 * it. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_writer_open(const char *path, const char *format,
                                                                const tides_event_file *file, tides_event_writer **writer,
                                                                tides_error *error);

/* 1 where tides_event_writer_resume can go on with files that the ending of `path` stands for. */
TIDES_API int32_t tides_event_writer_can_resume(const char *path);

/* Events appended so far that share their pixel and the format's tick with an earlier one: their distance in time is lost. */
TIDES_API uint64_t tides_event_writer_collapsed(const tides_event_writer *writer);

/* Appends `count` events. They must be sorted, not before the last appended one, and inside the image: else
 * TIDES_BAD_ARGUMENT and nothing of this call is written. `fired` (nullable) is their label, when each of them fired [ns];
 * NULL: at its t. A file without labels doesn't read it. Buffered: reaches the file chunk by chunk. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_writer_append(tides_event_writer *writer, const tides_event *events,
                                                                  const int64_t *fired, size_t count, tides_error *error);

/* Number of events appended so far. */
TIDES_API uint64_t tides_event_writer_count(const tides_event_writer *writer);

/* Makes everything appended so far survive the death of the process: whole chunks are in the .part already, the events after
 * them go to `path` + ".part.tail". HDF5 only: TIDES_UNSUPPORTED for other formats. A failure leaves what was safe as it was,
 * and the writer usable. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_writer_flush(tides_event_writer *writer, tides_error *error);

/* Goes on with a recording that was interrupted: opens the .part (and its tail) that a writer of `path` left, abandoned or
 * killed, and drops every event after the first `count`. These must have been flushed, or be in an abandoned file; the
 * file that _finish makes is then the same as that of a recording in one piece. Without a .part a finished `path` is gone on
 * with, in a copy of it, less its columns of ground truth. `file` must have the size that the .part has; its run text replaces
 * the .part's. TIDES_FILE_NOT_FOUND with neither of them; TIDES_BAD_FILE where it holds fewer events, is of another size, or
 * damaged: it is then left as it was, unless the damage was only found while cutting. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_writer_resume(const char *path, const tides_event_file *file,
                                                                  uint64_t count, tides_event_writer **writer,
                                                                  tides_error *error);

/* Flushes, completes the index, closes and renames. The writer is gone afterwards whatever is returned. `stop_ns` is the end
 * of the recording: ms_to_idx covers it. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_writer_finish(tides_event_writer *writer, int64_t stop_ns,
                                                                  tides_error *error);

/* Flushes and closes what there is, and leaves the .part file. NULL is fine. */
TIDES_API void tides_event_writer_abandon(tides_event_writer *writer);

/* Facts about a file that are known when it is opened. */
typedef struct tides_event_facts {
    char format[32];  /* "evt3" ...; of HDF5 its layout: "tides", "dsec", "eds", "mvsec", "v2e", "timostoff", "m3ed", "rvt";
                         of a folder that of its files */
    char version[32]; /* of TIDES that wrote it, or "" */
    int32_t width, height;     /* [px]; 0 where the file doesn't say */
    int32_t counted;           /* 1: count is known without reading the file */
    uint64_t count;            /* events; where `counted` */
    int32_t labels;            /* TIDES_LABEL_* that the file has, for tides_events_labels */
    int32_t zero;              /* TIDES_ZERO_* */
    int64_t start_ns, stop_ns; /* the recording's stretch; both 0: the file doesn't say. Our HDF5 does once it is complete */
    int64_t zero_ns;           /* the recording's zero on the file's clock; with TIDES_ZERO_EVENT 0 until an event was read */
    uint64_t dropped;          /* events that were left out so far (drop_invalid) */
    char read_as[160];         /* how columns and unit were decided where the format leaves them open, else "" */
} tides_event_facts;

/* The zero of a recording's times: its first event, or, where its container says more, its start or its first frame. A run
 * counts from the first frame where frames.rebase is on. */
enum { TIDES_ZERO_EVENT = 0, TIDES_ZERO_START, TIDES_ZERO_FRAME };

/* How a file is read: what it doesn't say itself, and what is wanted of it. Fill with tides_event_reading_defaults. */
typedef struct tides_event_reading {
    uint32_t size;        /* sizeof this struct */
    int32_t drop_invalid; /* 1: events that can't be (outside the sensor, a polarity that is none, NaN) are left out and counted
                             in the facts; 0: the first of them fails */
    const char *format;   /* a name; NULL: by content */
    const char *columns;  /* of text and tables: "t,x,y,p", "-,x,y,p,t" ("-" isn't read); NULL: as their header says, else as
                             their values can only be meant */
    const char *unit;     /* of the times: "s", "ms", "us", "ns"; NULL: as format or header say, else as values can be meant */
    const char *stream;   /* which of a file's streams of events, by a name that the error lists; NULL: the only one */
    int64_t offset_ns;    /* added to all times, after `rebase` */
    int32_t rebase;       /* 1: times count from the recording's zero (tides_event_facts.zero_ns) */
    int32_t reserved;
} tides_event_reading;

/* By content, the only stream, the file's own clock, the first invalid event fails. */
TIDES_API void tides_event_reading_defaults(tides_event_reading *reading);

/* A file that is being read. Opaque. */
typedef struct tides_event_reader tides_event_reader;

/* Opens an event file of any format, found from what it holds, or of the named format. Events come in the file's order, in
 * nanoseconds on the file's clock. A folder may be named too: a sequence of DSEC, EDS, ECD, MVSEC, BlinkFlow, HS-ERGB or
 * BS-ERGB, or numbered .npz of rpg_vid2e, whose files are read one after the other (lib/events/event_folder.c has the layouts);
 * where it holds both cameras of DSEC, name one. TIDES_FILE_NOT_FOUND (no file, or a folder without any of these),
 * TIDES_BAD_FILE (no event file, or a damaged one), TIDES_UNSUPPORTED. A reader is for one thread at a time. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_reader_open(const char *path, const char *format,
                                                                tides_event_reader **reader, tides_error *error);

/* Opens a reader with every option; NULL: the defaults. TIDES_BAD_ARGUMENT where the format has no use for an option that is
 * given. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_reader_open_as(const char *path, const tides_event_reading *reading,
                                                                   tides_event_reader **reader, tides_error *error);

/* Facts that the file gave when it was opened, and those found since; times are as they are read, but for zero_ns. */
TIDES_API void tides_event_reader_facts(const tides_event_reader *reader, tides_event_facts *facts);

/* The next events, up to `capacity`; `*got` is 0 only at the end of the file (or where capacity is). A damaged file fails
 * where the damage is: what was read before stays good, and every later call fails the same. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_reader_read(tides_event_reader *reader, tides_event *events,
                                                                size_t capacity, size_t *got, tides_error *error);

/* NULL is fine. */
TIDES_API void tides_event_reader_close(tides_event_reader *reader);

/* Sets the labels of `count` events that were read from number `first` on (tides_events_read), and `fired` (nullable), from the
 * columns of an HDF5 file; where it lacks one: the signal, 0, and their t. */
TIDES_MUST_CHECK TIDES_API tides_status tides_events_labels(const char *path, uint64_t first, size_t count, tides_event *events,
                                                            int64_t *fired, tides_error *error);

/* Summary of a file's events. */
typedef struct tides_event_summary {
    uint64_t count, count_on;  /* events, and those that are ON */
    uint64_t disorder;         /* events earlier than the one before them */
    int64_t first_ns, last_ns; /* the earliest and the latest; 0 where empty */
    int32_t width, height;     /* 0 where the file doesn't say */
    int32_t right, bottom;     /* the largest x + 1 and y + 1 [px] */
    char layout[32];           /* as tides_event_facts.format */
    char version[32];          /* of the writer, or "" */
    int32_t labels;            /* as tides_event_facts.labels */
} tides_event_summary;

/* Reads the whole file, of any format. */
TIDES_MUST_CHECK TIDES_API tides_status tides_events_summary(const char *path, tides_event_summary *summary,
                                                             tides_error *error);

/* Summarises the events that a reader still has: all of the file's where none was read. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_reader_summary(tides_event_reader *reader, tides_event_summary *summary,
                                                                   tides_error *error);

/* Whether [start_ns, stop_ns) can be meant of a recording that lasts from first_ns to end_ns: it touches that, and doesn't
 * begin further before it than it is long and than a second. Else it was meant on another clock: TIDES_BAD_ARGUMENT names the
 * stretch and how to bring both together. INT64_MIN, INT64_MAX: open ends. `rebased`: times count from the recording's zero. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_stretch_check(const char *file, int64_t first_ns, int64_t end_ns,
                                                                  int64_t start_ns, int64_t stop_ns, int32_t rebased,
                                                                  tides_error *error);

/* Reads events [first, first + count) of a file of any format into `events` (caller's memory); `got` receives how many there
 * were. HDF5 in the layout of DSEC is read from there on, others from their beginning. Times of that layout are those of
 * events/t_ns where present, else events/t in microseconds plus t_offset; foreign files come in their own order. On failure
 * `events` may hold some of them. */
TIDES_MUST_CHECK TIDES_API tides_status tides_events_read(const char *path, uint64_t first, size_t count, tides_event *events,
                                                          size_t *got, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
