/* Internal: one class per format of event files, all in one table. A format reads a stream, writes a sink, or both. Opening,
 * checking, renaming and counting are common to all formats. */
#ifndef TD_EVENT_FORMAT_H
#define TD_EVENT_FORMAT_H

#include "td_pool.h"
#include "tides/events.h"

#include <stdio.h>
#include <string.h>

enum {
    TD_EVENT_HEAD = 4096,   /* first bytes of a file, from which its format is detected */
    TD_EVENT_BUFFER = 65536 /* bytes read or written at once */
};

/* The beginning of a file, from which its format is detected. */
typedef struct td_event_probe {
    const char *path;
    uint64_t size;                /* of the file [bytes] */
    size_t bytes;                 /* in head */
    char head[TD_EVENT_HEAD + 1]; /* NUL-terminated */
} td_event_probe;

/* The time of the first frame, from a list of times beside an event file, or in a folder of events (ECD, EDS); 0 if there is
 * no list. */
int td_event_first_frame(const char *path, int64_t *ns);

/* ---- bytes in ---- */

/* A file read through a buffer. `data` points to the next unread byte; `ready` bytes from there are in memory. */
typedef struct td_event_input {
    const char *path;
    FILE *file;
    uint64_t size, at; /* size of the file; position of the next unread byte */
    unsigned char *buffer;
    const unsigned char *data;
    size_t ready;
} td_event_input;

tides_status td_input_open(td_event_input *input, const char *path, tides_error *error);
void td_input_close(td_event_input *input);

/* Reads until `wanted` <= TD_EVENT_BUFFER bytes are ready, or the file ends. */
tides_status td_input_fill(td_event_input *input, size_t wanted, tides_error *error);

/* Skips `bytes` <= ready. */
void td_input_skip(td_event_input *input, size_t bytes);

/* Copies any number of bytes to `out`; TIDES_BAD_FILE if the file ends first. */
tides_status td_input_copy(td_event_input *input, void *out, size_t bytes, tides_error *error);

/* Reads the next line without its end, NUL-terminated; `*got` is 0 at the end of the file. A line of `size` bytes or more is
 * TIDES_BAD_FILE. td_input_peek leaves it unread; skipping `bytes` reads past it. */
tides_status td_input_line(td_event_input *input, char *line, size_t size, int *got, tides_error *error);
tides_status td_input_peek(td_event_input *input, char *line, size_t size, int *got, size_t *bytes, tides_error *error);

/* ---- a file being read ---- */

typedef struct td_event_stream {
    td_event_input input; /* not opened if the format has `library` */
    tides_event_facts facts;
    tides_event_reading reading;         /* its texts live as long as the stream */
    uint64_t done;                       /* events handed out before this call of read */
    const struct td_event_format *named; /* the format of all files of a folder; NULL: detected */
    void *state;                         /* the format's, freed by its close */
} td_event_stream;

/* Number of the event that comes `behind` events after the last one handed out; events that were left out count, too. */
static inline uint64_t td_event_number(const td_event_stream *stream, size_t behind) {
    return stream->done + stream->facts.dropped + behind;
}

/* Handles an invalid event: counts it and returns TIDES_OK if invalid events are to be left out. Otherwise its error stays,
 * and names the option that leaves them out. */
tides_status td_event_invalid(td_event_stream *stream, tides_status status, tides_error *error);

/* ---- a file being written ---- */

/* Counts events that share a pixel and a tick, where the format's clock is coarse. */
typedef struct td_event_ticks td_event_ticks;

enum { TD_SINK_HELD = 1 << 14 }; /* bytes that are held before they are written */
typedef struct td_event_sink {
    char *path, *part;
    int32_t width, height;
    const char *run, *seed;    /* valid during create only */
    int32_t labels;            /* 1: all labels are stored; only for formats with `labels` */
    const int64_t *fired;      /* during write, with labels: times at which events fired; NULL: their own t */
    int64_t start_ns, stop_ns; /* the recording's span; both 0: unknown */
    uint64_t count;            /* events appended */
    tides_event last;
    int32_t has_last;
    FILE *file;  /* NULL if the format has `library` */
    uint64_t at; /* bytes written to `file` or held */
    int failed;  /* errno of the first failed write to `file`, or 0 */
    int claim;   /* second descriptor that keeps the .part locked after it is closed */
    void *state; /* the format's, freed by its discard */
    td_event_ticks *ticks;
    td_pool *pool; /* during write: whose threads may share it; NULL: none */
    size_t holds;  /* bytes of `at` still in `held`, since a call of fwrite costs as much as ten records of a few bytes */
    unsigned char held[TD_SINK_HELD];
} td_event_sink;

/* Appends bytes to the sink's file. A failure is kept in `failed`, and everything after it is dropped. td_sink_flush writes
 * the bytes held. */
void td_sink_flush(td_event_sink *sink);
static inline void td_sink_bytes(td_event_sink *sink, const void *data, size_t bytes) {
    const unsigned char *from = data;
    sink->at += bytes;
    for (size_t some; bytes > TD_SINK_HELD - sink->holds; from += some, bytes -= some) {
        some = TD_SINK_HELD - sink->holds;
        memcpy(sink->held + sink->holds, from, some);
        sink->holds += some;
        td_sink_flush(sink);
    }
    memcpy(sink->held + sink->holds, from, bytes);
    sink->holds += bytes;
}
void td_sink_text(td_event_sink *sink, const char *text);
/* Overwrites bytes that were written before. */
void td_sink_patch(td_event_sink *sink, uint64_t at, const void *data, size_t bytes);

/* ---- the class ---- */

enum { TD_TAKES_COLUMNS = 1, TD_TAKES_UNIT = 2, TD_TAKES_STREAM = 4 };

typedef struct td_event_format {
    const char *name;    /* for --from and --to: "evt3" */
    const char *endings; /* of files to write: ".raw .evt3"; NULL: chosen only by name */
    const char *summary; /* description in a few words */
    int64_t tick_ns;     /* resolution of times, which are rounded down; 1: exact */
    int32_t size_limit;  /* largest width and height [px] */
    int32_t library;     /* the file is opened by a library, not as bytes */
    int32_t labels;      /* 1: stores labels */
    int32_t negative;    /* 1: stores times before 0 */
    int32_t patches;     /* 1: the writer seeks back (td_sink_patch), so devices and FIFOs can't be written */
    int32_t takes;       /* TD_TAKES_*: options of tides_event_reading that the format uses */

    /* For formats that write bytes for time without events, from time 0 on: the longest gap; 0: any. The texts are the errors
     * for an event behind a longer gap, and for a recording that starts behind one. */
    int64_t silence_ns;
    const char *silent_event, *silent_start;

    /* 1 if the file is of this format; NULL: chosen only by name. */
    int (*detect)(const td_event_probe *probe);

    /* Reading; all NULL for a format that is only written. open fills the facts; read sets `got` to 0 only at the end. close
     * is called even if open fails. */
    tides_status (*open)(td_event_stream *stream, tides_error *error);
    tides_status (*read)(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error);
    void (*close)(td_event_stream *stream);

    /* Writing; all NULL for a format that is only read. Events come checked and in order. `span` (may be NULL) says why a
     * recording from start to stop can't be stored, and how to mend it; NULL: it can. `begin` (may be NULL) gets the first
     * event before it is checked. `check` (may be NULL) says why an event can't follow `previous` (may be NULL); NULL: it
     * can. `complete` completes the file; `discard` frees the state. */
    tides_status (*create)(td_event_sink *sink, tides_error *error);
    const char *(*span)(int64_t start_ns, int64_t stop_ns);
    void (*begin)(td_event_sink *sink, const tides_event *first);
    const char *(*check)(const td_event_sink *sink, const tides_event *event, const tides_event *previous);
    int32_t check_ends; /* check depends on times only; if it accepts two events, it accepts all between them */
    tides_status (*write)(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error);
    tides_status (*complete)(td_event_sink *sink, int64_t stop_ns, tides_error *error);
    void (*discard)(td_event_sink *sink);

    /* Surviving an interruption; NULL if the format can't. */
    tides_status (*flush)(td_event_sink *sink, tides_error *error);
    tides_status (*resume)(td_event_sink *sink, uint64_t count, const tides_event *last, tides_error *error);
    void (*abandon)(td_event_sink *sink);
} td_event_format;

/* All formats, NULL-terminated, in the order of detection. */
extern const td_event_format *const td_event_formats[];

extern const td_event_format td_format_hdf5, td_format_ecf, td_format_aedat4, td_format_aedat2, td_format_es, td_format_dat,
    td_format_evt2, td_format_evt21, td_format_evt3, td_format_evt4, td_format_csv, td_format_csv_ns, td_format_csv_openeb,
    td_format_e2vid, td_format_ecd, td_format_nmnist, td_format_npy, td_format_npz, td_format_ergb;

/* Finds a format by name; TIDES_BAD_ARGUMENT names the nearest one. */
tides_status td_event_format_named(const char *name, const td_event_format **format, tides_error *error);

/* Reads folders of data sets. It isn't in the table: it reads no single file, and takes the name of the files' format. */
extern const td_event_format td_format_folder;

/* Detects a file's format from its content and the options; TIDES_FILE_NOT_FOUND, TIDES_BAD_FILE. */
tides_status td_event_format_detect(const char *path, const tides_event_reading *how, const td_event_format **format,
                                    tides_error *error);

/* The format of a file to write, by its ending; HDF5 without an ending. */
tides_status td_event_format_for(const char *path, const td_event_format **format, tides_error *error);

/* Checks that events may follow in a file: order, size, polarity, and the format's own conditions. TIDES_BAD_ARGUMENT,
 * TIDES_UNSUPPORTED. */
tides_status td_event_check(const td_event_format *format, const td_event_sink *sink, const tides_event *events, size_t count,
                            tides_error *error);

/* Resumes an interrupted recording behind its first `count` events, as tides_event_writer_resume does. If `last` isn't NULL,
 * event number count - 1 must be equal to it: otherwise TIDES_BAD_FILE, and the file is unchanged. */
tides_status td_event_writer_resume(const char *path, const tides_event_file *file, uint64_t count, const tides_event *last,
                                    tides_event_writer **writer, tides_error *error);

/* tides_event_writer_append, in which a pool's threads (NULL: none) may pack what is written. Only the calling thread is in
 * HDF5. */
tides_status td_event_writer_append(tides_event_writer *writer, const tides_event *events, const int64_t *fired, size_t count,
                                    td_pool *pool, tides_error *error);

/* Fraction of the file that has been read, 0 to 1; negative if unknown. */
double td_event_reader_part(const tides_event_reader *reader);

/* ---- helpers of several formats ---- */

/* Converts [us] to [ns]; 0 if the result overflows 64 bits. */
int td_event_microseconds(int64_t us, int64_t *ns);

/* The close and discard of formats whose state is one block of memory, or NULL. */
void td_event_close_state(td_event_stream *stream);
void td_event_discard_state(td_event_sink *sink);

/* Fails with "PATH: event N WHAT". */
tides_status td_event_bad(const td_event_stream *stream, uint64_t number, const char *what, tides_error *error);

/* Fails because the file ends too early. */
tides_status td_event_cut_off(const td_event_stream *stream, tides_error *error);

/* `*fine` is 1 if the .npz holds events of BS-ERGB, or coordinates so large that they must be 1/32 px. */
tides_status td_event_npz_is_fine(const char *path, int *fine, tides_error *error);

/* The header of Prophesee's files: lines "% key value" before the data. */
typedef struct td_event_header {
    char evt[16];    /* "3.0" from "% evt 3.0", or "" */
    char format[16]; /* "EVT3" from "% format EVT3;...", or "" */
    int32_t version; /* from "% Version 2", else 0 */
    int32_t width, height;
    int32_t swapped; /* EVT 2.1 with its 32-bit halves exchanged */
    size_t bytes;    /* size of the header; 0: none */
} td_event_header;
/* Parses a header from the first bytes of a file. */
void td_event_header_parse(const char *head, size_t bytes, td_event_header *header);
/* Reads the header from a stream into its facts. */
tides_status td_event_header_read(td_event_stream *stream, td_event_header *header, tides_error *error);
/* Writes the header of an EVT file, such as "2.0", "EVT2". */
void td_event_header_write(td_event_sink *sink, const char *evt, const char *format);

/* Parses a number exactly, in any locale: `*value` is number * 10^digits, rounded to the nearest integer, half away from
 * zero. 0 if [text, text + length) is no number, or the result overflows 64 bits. */
int td_decimal(const char *text, size_t length, int digits, int64_t *value);
/* Parses a whole number ("12", "12.0") from `least` to `most`. */
int td_decimal_whole(const char *text, size_t length, int64_t least, int64_t most, int64_t *value);

td_event_ticks *td_event_ticks_create(int64_t tick_ns, tides_error *error);
void td_event_ticks_destroy(td_event_ticks *ticks);
tides_status td_event_ticks_add(td_event_ticks *ticks, const tides_event *events, size_t count, tides_error *error);
uint64_t td_event_ticks_collapsed(const td_event_ticks *ticks);

#endif
