/* Internal: one class per format of event files, in one table. A format reads a stream, writes a sink, or both. The work that
 * all share (opening, checking, renaming, counting) is in event_reader.c and event_writer.c. */
#ifndef TD_EVENT_FORMAT_H
#define TD_EVENT_FORMAT_H

#include "tides/events.h"

#include <stdio.h>
#include <string.h>

enum {
    TD_EVENT_HEAD = 4096,   /* first bytes that a format is found from */
    TD_EVENT_BUFFER = 65536 /* bytes read or written at once */
};

/* The beginning of a file, from which its format is detected. */
typedef struct td_event_probe {
    const char *path;
    uint64_t size;                /* of the file [bytes] */
    size_t bytes;                 /* in head */
    char head[TD_EVENT_HEAD + 1]; /* NUL-terminated */
} td_event_probe;

/* event_zero.c: the time of the first frame in the list that lies beside a file, or in a folder, of events (ECD, EDS); 0: there
 * is no such list. */
int td_event_first_frame(const char *path, int64_t *ns);

/* ---- bytes in ---- */

/* A file read through a buffer. `data` points at the next unread byte, of which `ready` are in memory. */
typedef struct td_event_input {
    const char *path;
    FILE *file;
    uint64_t size, at; /* of the file; of the next unread byte */
    unsigned char *buffer;
    const unsigned char *data;
    size_t ready;
} td_event_input;

tides_status td_input_open(td_event_input *input, const char *path, tides_error *error);
void td_input_close(td_event_input *input);

/* Makes `wanted` <= TD_EVENT_BUFFER bytes ready, or all that are left where they are fewer. */
tides_status td_input_fill(td_event_input *input, size_t wanted, tides_error *error);

/* Passes over `bytes` <= ready. */
void td_input_skip(td_event_input *input, size_t bytes);

/* Copies `bytes` out, however many; TIDES_BAD_FILE where the file ends before. */
tides_status td_input_copy(td_event_input *input, void *out, size_t bytes, tides_error *error);

/* The next line without its end, NUL-terminated, in the caller's buffer; `*got` is 0 at the end of the file. Lines of `size`
 * bytes or more are TIDES_BAD_FILE. _peek leaves it unread: `bytes` are to be passed over. */
tides_status td_input_line(td_event_input *input, char *line, size_t size, int *got, tides_error *error);
tides_status td_input_peek(td_event_input *input, char *line, size_t size, int *got, size_t *bytes, tides_error *error);

/* ---- a file being read ---- */

typedef struct td_event_stream {
    td_event_input input; /* not opened for formats with `library` */
    tides_event_facts facts;
    tides_event_reading reading;         /* its texts live as long as the stream */
    uint64_t done;                       /* events handed out before this call of read */
    const struct td_event_format *named; /* a folder's files are of this format; NULL: what they hold says */
    void *state;                         /* the format's; freed by its close */
} td_event_stream;

/* Number of the event that comes `behind` those that were handed out before: what was left out counts too. */
static inline uint64_t td_event_number(const td_event_stream *stream, size_t behind) {
    return stream->done + stream->facts.dropped + behind;
}

/* Handles an event that can't be valid. Where invalid events are to be left out: TIDES_OK, and it is counted. Else its error,
 * which names the option that leaves such events out. */
tides_status td_event_invalid(td_event_stream *stream, tides_status status, tides_error *error);

/* ---- a file being written ---- */

/* Counts events that share a pixel and a tick (event_ticks.c). */
typedef struct td_event_ticks td_event_ticks;

enum { TD_SINK_HELD = 1 << 14 };
typedef struct td_event_sink {
    char *path, *part;
    int32_t width, height;
    const char *run, *seed;    /* during create only */
    int32_t labels;            /* as tides_event_file; only for formats with `labels` */
    const int64_t *fired;      /* during write, with labels: when the events fired; NULL: at their t */
    int64_t start_ns, stop_ns; /* as tides_event_file */
    uint64_t count;            /* appended */
    tides_event last;
    int32_t has_last;
    FILE *file;  /* NULL for formats with `library` */
    uint64_t at; /* bytes given to `file` */
    int failed;  /* errno of the first failed write to `file`, or 0 */
    int claim;   /* td_keep_claim's of the .part; formats with `library` have it made */
    void *state; /* the format's; freed by its discard */
    td_event_ticks *ticks;
    size_t
        holds; /* bytes of `at` that are here still: records are a few bytes each, and a call of fwrite takes as long as ten */
    unsigned char held[TD_SINK_HELD];
} td_event_sink;

/* Appends bytes to the sink's file; a failure is kept in `failed`, and everything after it is dropped. Buffered bytes go to the
 * file when an append is over (event_writer.c). */
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
/* Overwrites bytes that are there already. */
void td_sink_patch(td_event_sink *sink, uint64_t at, const void *data, size_t bytes);

/* ---- the class ---- */

enum { TD_TAKES_COLUMNS = 1, TD_TAKES_UNIT = 2, TD_TAKES_STREAM = 4 };

typedef struct td_event_format {
    const char *name;    /* of --from and --to: "evt3" */
    const char *endings; /* ".raw .evt3": of files to write; NULL: only by name */
    const char *summary; /* what it is, in a few words */
    int64_t tick_ns;     /* times are floored to it; 1: exact */
    int32_t size_limit;  /* widest and highest sensor that fits [px] */
    int32_t library;     /* the file is opened by a library, not as bytes */
    int32_t labels;      /* it has a place for them */
    int32_t negative;    /* times before 0 have a place in it */
    int32_t patches;     /* its writer goes back (td_sink_patch): not into devices and FIFOs */
    int32_t takes;       /* TD_TAKES_*: what of a tides_event_reading it has a use for */

    /* Formats that write something for time without events, from 0 on, take only so much of it at once; 0: any. And why an
     * event or the start of a recording that lies further off can't be stored, and what to do. */
    int64_t silence_ns;
    const char *silent_event, *silent_start;

    /* 1 where the file is of this format; NULL: only by name. */
    int (*detect)(const td_event_probe *probe);

    /* Reading; all NULL where the format is only written. open fills the facts; read leaves 0 in `got` only at the end. close
     * is called after a failed open too. */
    tides_status (*open)(td_event_stream *stream, tides_error *error);
    tides_status (*read)(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error);
    void (*close)(td_event_stream *stream);

    /* Writing; all NULL where it is only read. Events come checked and in order. `span` (nullable) says why a recording from
     * start to stop can't be stored and what to do, or NULL; `begin` (nullable) gets the first event before it is checked;
     * `check` (nullable) says why an event can't be stored after `previous` (nullable), or NULL. `complete` makes the file
     * whole; `discard` frees the state. */
    tides_status (*create)(td_event_sink *sink, tides_error *error);
    const char *(*span)(int64_t start_ns, int64_t stop_ns);
    void (*begin)(td_event_sink *sink, const tides_event *first);
    const char *(*check)(const td_event_sink *sink, const tides_event *event, const tides_event *previous);
    int32_t check_ends; /* check asks for the time alone, and what it takes of two events it takes of all between them */
    tides_status (*write)(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error);
    tides_status (*complete)(td_event_sink *sink, int64_t stop_ns, tides_error *error);
    void (*discard)(td_event_sink *sink);

    /* Survival of an interrupted run: only where a format can; else NULL. */
    tides_status (*flush)(td_event_sink *sink, tides_error *error);
    tides_status (*resume)(td_event_sink *sink, uint64_t count, const tides_event *last, tides_error *error);
    void (*abandon)(td_event_sink *sink);
} td_event_format;

/* The table: NULL-terminated, in the order of detection. */
extern const td_event_format *const td_event_formats[];

extern const td_event_format td_format_hdf5, td_format_ecf, td_format_aedat4, td_format_aedat2, td_format_es, td_format_dat,
    td_format_evt2, td_format_evt21, td_format_evt3, td_format_evt4, td_format_csv, td_format_csv_ns, td_format_csv_openeb,
    td_format_e2vid, td_format_ecd, td_format_nmnist, td_format_npy, td_format_npz, td_format_ergb;

/* By name; TIDES_BAD_ARGUMENT names the nearest. */
tides_status td_event_format_named(const char *name, const td_event_format **format, tides_error *error);

/* Folders of data sets (event_folder.c); not in the table: it takes no file, and its name is that of the files within. */
extern const td_event_format td_format_folder;

/* By what the file holds, and what is said of it; TIDES_FILE_NOT_FOUND, TIDES_BAD_FILE. */
tides_status td_event_format_detect(const char *path, const tides_event_reading *how, const td_event_format **format,
                                    tides_error *error);

/* The format of a file to write, by its ending; HDF5 where it has none. */
tides_status td_event_format_for(const char *path, const td_event_format **format, tides_error *error);

/* Events may follow in a file: order, size, polarity, and what the format itself asks. TIDES_BAD_ARGUMENT,
 * TIDES_UNSUPPORTED. */
tides_status td_event_check(const td_event_format *format, const td_event_sink *sink, const tides_event *events, size_t count,
                            tides_error *error);

/* tides_event_writer_resume of a recording whose event number count - 1 is `last` (nullable): TIDES_BAD_FILE, and nothing has
 * changed, where the file has another there. */
tides_status td_event_writer_resume(const char *path, const tides_event_file *file, uint64_t count, const tides_event *last,
                                    tides_event_writer **writer, tides_error *error);

/* How much of the file is read, 0 to 1; negative where that isn't known. */
double td_event_reader_part(const tides_event_reader *reader);

/* ---- what several formats need ---- */

/* [us] to [ns]; 0 where 64 bits don't hold it. */
int td_event_microseconds(int64_t us, int64_t *ns);

/* Close and discard of a state that is one block of memory, or NULL. */
void td_event_close_state(td_event_stream *stream);
void td_event_discard_state(td_event_sink *sink);

/* "PATH: event N ..." */
tides_status td_event_bad(const td_event_stream *stream, uint64_t number, const char *what, tides_error *error);

/* The file ends within something. */
tides_status td_event_cut_off(const td_event_stream *stream, tides_error *error);

/* Whether the .npz holds events of BS-ERGB or coordinates that only 1/32 px can be (event_npy.c). */
tides_status td_event_npz_is_fine(const char *path, int *fine, tides_error *error);

/* Lines "% key value" before the data of Prophesee's files (event_header.c). */
typedef struct td_event_header {
    char evt[16];    /* "3.0" of "% evt 3.0", or "" */
    char format[16]; /* "EVT3" of "% format EVT3;...", or "" */
    int32_t version; /* of "% Version 2", else 0 */
    int32_t width, height;
    int32_t swapped; /* EVT 2.1 with its 32-bit halves the other way round */
    size_t bytes;    /* of the header; 0: none */
} td_event_header;
/* From the first bytes of a file. */
void td_event_header_parse(const char *head, size_t bytes, td_event_header *header);
/* Reads it from a stream into the facts, and passes over it. */
tides_status td_event_header_read(td_event_stream *stream, td_event_header *header, tides_error *error);
/* Writes that of an EVT file: "2.0", "EVT2". */
void td_event_header_write(td_event_sink *sink, const char *evt, const char *format);

/* Numbers of text, exactly and in any locale (event_decimal.c). `digits`: value * 10^digits, rounded to the nearest integer,
 * half away from zero. 0 where [text, text + length) is no number or 64 bits don't hold it. */
int td_decimal(const char *text, size_t length, int digits, int64_t *value);
/* A whole number ("12", "12.0") from `least` to `most`. */
int td_decimal_whole(const char *text, size_t length, int64_t least, int64_t most, int64_t *value);

td_event_ticks *td_event_ticks_create(int64_t tick_ns, tides_error *error);
void td_event_ticks_destroy(td_event_ticks *ticks);
tides_status td_event_ticks_add(td_event_ticks *ticks, const tides_event *events, size_t count, tides_error *error);
uint64_t td_event_ticks_collapsed(const td_event_ticks *ticks);

#endif
