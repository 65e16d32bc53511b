/* The event record and event files. */
#ifndef TIDES_EVENTS_H
#define TIDES_EVENTS_H

#include "tides/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One event, 16 bytes. Streams are sorted by (t, y, x, polarity). */
typedef struct tides_event {
    int64_t t;         /* [ns] on the run's clock, which is that of the scene and the path */
    uint16_t x, y;     /* [px] */
    int8_t polarity;   /* +1 or -1 */
    uint8_t cause;     /* TIDES_CAUSE_*: the signal, or which noise */
    uint16_t frontend; /* tides_event_frontend as IEEE 754 binary16, to one part in 2048 */
} tides_event;

/* The front end's contribution to the signal when the event fired: S - L [log units], where S is the comparator's input. It
 * includes the low-pass or circuit, the surround and the additive noise. For example, a low-pass of time constant tau gives
 * -tau L_dot on a ramp. It excludes the optics' blur, because L is blurred already, and the leak, which moves the reference
 * instead of S. It is 0 if none of these is on, or sensor.labels is off; it is never NaN. */
TIDES_API double tides_event_frontend(const tides_event *event);

/* Labels of events, each a column of HDF5 files: /events/cause; /events/fired, when the pixel fired, before the readout [ns];
 * and /events/frontend (tides_event_frontend). */
enum { TIDES_LABEL_CAUSE = 1, TIDES_LABEL_FIRED = 2, TIDES_LABEL_FRONTEND = 4 };

/* Facts for the file's attributes. Plain value; strings are copied. */
typedef struct tides_event_file {
    int32_t width, height; /* [px] */
    const char *run;       /* run file as JSON text, or NULL */
    const char *seed;      /* or NULL */
    int32_t labels; /* 1: with all labels; TIDES_UNSUPPORTED but in HDF5. 0: HDF5 has causes, if some aren't the signal's */
    /* [ns] The recording's stretch; both 0: unknown. If known, a stretch that the format can't hold is TIDES_UNSUPPORTED at
     * once; else the first event that doesn't fit is. HDF5 counts its 32-bit microseconds from t_offset: 0 if the stretch ends
     * before 4294.967 s, else its start. An unknown stretch is taken to last half an hour from the first event. */
    int64_t start_ns, stop_ns; /* as above */
} tides_event_file;

/* A file that is being written. Opaque. */
typedef struct tides_event_writer tides_event_writer;

/* A format of event files: its name ("evt3"), a short summary, and the endings of files written in it ("" if it is only
 * chosen by name). */
typedef struct tides_event_format {
    const char *name, *summary, *endings; /* static storage */
    int32_t reads, writes;                /* 1 where the library can */
    int64_t tick_ns;                      /* times are floored to it on writing */
} tides_event_format;

/* Format number `index`, from 0; texts are constant. Returns 1, or 0 if there is none. */
TIDES_API int32_t tides_event_format_at(size_t index, tides_event_format *format);

/* Starts an event file in the named format, or if `format` is NULL in that of the path's ending (HDF5 for a path without
 * one). tides_event_format_at lists formats. Every format is streamed, floors times to its tick, and bridges the turns of
 * its clock by its own rule. The file is written as `path` + ".part", and _finish renames it. So `path` is either the old
 * file or a complete new one; flushed events stay readable in the .part. HDF5, the native format, has the DSEC layout
 * (events/{p,t,x,y}, ms_to_idx, t_offset), with events/t_ns and attributes of TIDES added. TIDES_UNSUPPORTED: the format
 * isn't written, or the sensor is too large for it. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_writer_open(const char *path, const char *format,
                                                                const tides_event_file *file, tides_event_writer **writer,
                                                                tides_error *error);

/* 1 if tides_event_writer_resume works on files with the ending of `path`. */
TIDES_API int32_t tides_event_writer_can_resume(const char *path);

/* Number of events appended so far that share their pixel and the format's tick with an earlier one: their distance in time
 * is lost. */
TIDES_API uint64_t tides_event_writer_collapsed(const tides_event_writer *writer);

/* Appends `count` events, sorted, not before the last appended one, and inside the image. Else TIDES_BAD_ARGUMENT, and
 * nothing is written. `fired` (nullable: the events' t) is when each event fired [ns], a label that files without labels
 * ignore. Events are buffered, and reach the file chunk by chunk. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_writer_append(tides_event_writer *writer, const tides_event *events,
                                                                  const int64_t *fired, size_t count, tides_error *error);

/* Number of events appended so far. */
TIDES_API uint64_t tides_event_writer_count(const tides_event_writer *writer);

/* Makes the events appended so far survive the death of the process. Whole chunks are in the .part already; later events go
 * to `path` + ".part.tail". TIDES_UNSUPPORTED: a format other than HDF5. After a failure, events that were safe still are,
 * and the writer can be used. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_writer_flush(tides_event_writer *writer, tides_error *error);

/* Continues an interrupted recording. Opens the .part (and its tail) that an abandoned or killed writer of `path` left, and
 * drops every event after the first `count`. These must have been flushed, or be in an abandoned file. The finished file
 * equals that of an uninterrupted recording.
 *
 * Without a .part, it continues a copy of the finished `path`, without its columns of ground truth. `file` must have the size
 * of the .part; its run text replaces the .part's. TIDES_FILE_NOT_FOUND: neither exists. TIDES_BAD_FILE: the file has fewer
 * events or another size, or is damaged. The file isn't changed then, unless the damage is found while cutting. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_writer_resume(const char *path, const tides_event_file *file,
                                                                  uint64_t count, tides_event_writer **writer,
                                                                  tides_error *error);

/* Flushes, completes the index, closes and renames. The writer is gone, whatever is returned. `stop_ns` is the end of the
 * recording, up to which ms_to_idx goes. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_writer_finish(tides_event_writer *writer, int64_t stop_ns,
                                                                  tides_error *error);

/* Flushes and closes the file, and leaves the .part. NULL is fine. */
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

/* The zero of a recording's times: its first event, or its start or first frame if the file gives one. A run counts from the
 * first frame if frames.rebase is on. */
enum { TIDES_ZERO_EVENT = 0, TIDES_ZERO_START, TIDES_ZERO_FRAME };

/* Options of reading a file. Fill with tides_event_reading_defaults. */
typedef struct tides_event_reading {
    uint32_t size; /* sizeof this struct */
    /* 1: invalid events (outside the sensor, a wrong polarity, NaN) are left out and counted in the facts; 0: they fail */
    int32_t drop_invalid;
    const char *format;  /* a name; NULL: by content */
    const char *columns; /* of text and tables: "t,x,y,p", "-,x,y,p,t" ("-" isn't read); NULL: as their header says, else the
                          * only order that their values allow */
    const char *unit;    /* of the times: "s", "ms", "us", "ns"; NULL: as format or header say, else found from the values */
    const char *stream;  /* name of one of the file's streams, which errors list; NULL: the only one */
    int64_t offset_ns;   /* added to all times, after `rebase` */
    int32_t rebase;      /* 1: times count from the recording's zero (tides_event_facts.zero_ns) */
    int32_t reserved;
} tides_event_reading;

/* Defaults: format by content, the only stream, the file's own clock; the first invalid event fails. */
TIDES_API void tides_event_reading_defaults(tides_event_reading *reading);

/* A file that is being read. Opaque. */
typedef struct tides_event_reader tides_event_reader;

/* Opens an event file of any format, found from what it holds, or of the named format. Events come in the file's order, in
 * nanoseconds on the file's clock. A folder may be named too: a sequence of DSEC, EDS, ECD, MVSEC, BlinkFlow, HS-ERGB or
 * BS-ERGB, or numbered .npz of rpg_vid2e, whose files are read one after the other. If it holds both cameras of DSEC, name
 * one. TIDES_FILE_NOT_FOUND (no file, or a folder without any of these), TIDES_BAD_FILE (no event file, or a damaged one),
 * TIDES_UNSUPPORTED. A reader is for one thread at a time. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_reader_open(const char *path, const char *format,
                                                                tides_event_reader **reader, tides_error *error);

/* Opens a reader with every option; NULL: the defaults. TIDES_BAD_ARGUMENT: the format has no use for a given option. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_reader_open_as(const char *path, const tides_event_reading *reading,
                                                                   tides_event_reader **reader, tides_error *error);

/* Facts given by the file, and those found since. Times are as read (after `rebase` and offset), except zero_ns. */
TIDES_API void tides_event_reader_facts(const tides_event_reader *reader, tides_event_facts *facts);

/* Reads the next events, up to `capacity`. `*got` is 0 only at the end of the file, or if `capacity` is. A damaged file fails
 * at the damage: events before it stay valid, and every later call fails in the same way. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_reader_read(tides_event_reader *reader, tides_event *events,
                                                                size_t capacity, size_t *got, tides_error *error);

/* NULL is fine. */
TIDES_API void tides_event_reader_close(tides_event_reader *reader);

/* Sets the labels of `count` events, which were read from number `first` on, and `fired` (nullable), from columns of an HDF5
 * file. Missing columns give: cause the signal, front end 0, and fired at t. */
TIDES_MUST_CHECK TIDES_API tides_status tides_events_labels(const char *path, uint64_t first, size_t count, tides_event *events,
                                                            int64_t *fired, tides_error *error);

/* Summary of a file's events. */
typedef struct tides_event_summary {
    uint64_t count, count_on;  /* events, and those that are ON */
    uint64_t disorder;         /* events that are earlier than the one before in the file */
    int64_t first_ns, last_ns; /* the earliest and the latest; 0 without events */
    int32_t width, height;     /* 0 where the file doesn't say */
    int32_t right, bottom;     /* the largest x + 1 and y + 1 [px] */
    char layout[32];           /* as tides_event_facts.format */
    char version[32];          /* of the writer, or "" */
    int32_t labels;            /* as tides_event_facts.labels */
} tides_event_summary;

/* Reads the whole file, of any format. */
TIDES_MUST_CHECK TIDES_API tides_status tides_events_summary(const char *path, tides_event_summary *summary,
                                                             tides_error *error);

/* Summarises the events that a reader hasn't read yet. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_reader_summary(tides_event_reader *reader, tides_event_summary *summary,
                                                                   tides_error *error);

/* Checks that [start_ns, stop_ns) fits a recording from first_ns to end_ns: it must overlap it, and may not begin earlier by
 * more than the recording's length and a second. Else it was probably meant on another clock: TIDES_BAD_ARGUMENT names the
 * stretch and a way out. INT64_MIN, INT64_MAX: open ends. `rebased`: times count from the recording's zero. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_stretch_check(const char *file, int64_t first_ns, int64_t end_ns,
                                                                  int64_t start_ns, int64_t stop_ns, int32_t rebased,
                                                                  tides_error *error);

/* Reads events [first, first + count) of a file of any format into `events`, caller's memory; `got` receives their number.
 * HDF5 in DSEC's layout is read from `first` on, other files from their beginning. Times are those of events/t_ns if present,
 * else events/t in microseconds plus t_offset. On failure `events` may hold some of them. */
TIDES_MUST_CHECK TIDES_API tides_status tides_events_read(const char *path, uint64_t first, size_t count, tides_event *events,
                                                          size_t *got, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
