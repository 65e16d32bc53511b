/* `tides compare`: every method on one run, against its exact stream or a recording. Files from the bottom up: compare_find,
 * compare_mask, compare_settings, compare_fair, compare_score, compare_exact, compare_run, compare_search, then the results:
 * compare_report, compare_table, compare_print, the figures, compare_page. */
#ifndef CLI_COMPARE_H
#define CLI_COMPARE_H

#include "canvas.h"
#include "metrics_report.h"
#include "reading.h"
#include "session.h"
#include "stream.h"

/* The streams that methods are compared with. */
enum { COMPARE_EXACT = 0, COMPARE_RECORDING = 1, COMPARE_REFERENCES = 2 };

enum { COMPARE_METHODS_MAX = 8, COMPARE_PATH = 4200 /* of files in the directory */ };
/* Most parameters that a search varies, and the length of a setting's text. */
enum { COMPARE_SEARCHED = 6, COMPARE_SETTING = 80 };

/* One method and its results. */
typedef struct compare_row {
    const char *name;
    tides_error error; /* TIDES_OK where it ran */
    cJSON *settings;   /* ["key=value", ...], added to the run file's */
    cJSON *parameters; /* shown in results, {key: value}, as used */
    cli_list found;    /* results of a search, "key=value"; texts are in found_texts */
    char found_texts[COMPARE_SEARCHED][COMPARE_SETTING];
    cli_stream stream; /* its events */
    tides_stats stats;
    cJSON *against[COMPARE_REFERENCES]; /* cli_metrics_json; NULL: not compared */
} compare_row;

/* The part of recording and streams that is compared: a stretch of time, and pixels. */
typedef struct compare_fair {
    const char *start, *stop, *mask_file; /* of the options; NULL where not given */
    cli_reading reading;
    tides_event_reading how;
    int32_t all;               /* 1: bursts and hot pixels aren't left out */
    int64_t start_ns, stop_ns; /* [start, stop) */
    double tolerance_s;        /* of matches */
    uint8_t *mask;             /* (height x width): 1 for pixels that count; NULL: all */
    uint64_t masked;           /* the recording's events of other pixels */
    tides_blemishes blemishes;
} compare_fair;

typedef struct comparison {
    const cli_common *common;
    const char *run, *directory;
    const cli_list *sets;
    const char *recording_file; /* NULL: none */
    double window_s;            /* [s] shown in the picture; 0: chosen */
    canvas_style style;         /* of the picture */
    int32_t as_configured;      /* 1: the run file's own settings; 0: ideal pixels */
    int32_t keep;               /* 1: events of each method are written to files */
    int32_t in_double;          /* 1: the exact stream comes from the double-precision reference */
    int32_t with_exact;         /* 1: there is an exact stream */
    int32_t search;             /* runs for the search of each method's parameters; 0: no search */

    tides_session *open; /* the run file's session, which rows vary */
    tides_session_facts session;
    cli_progress progress;
    tides_exact exact;
    cli_window recording; /* its events that are compared */
    compare_fair fair;
    cJSON *floors[2]; /* COMPARE_SEEDS, COMPARE_PIXELS; NULL: none */
    compare_row rows[COMPARE_METHODS_MAX];
    int32_t count;
} comparison;

/* Floors: how close to a recording a stream can be. Two runs of TIDES with different seeds, from references anywhere between
 * the levels; and the recording's even columns against its odd ones. */
enum { COMPARE_SEEDS = 0, COMPARE_PIXELS = 1, COMPARE_FLOORS = 2 };

/* compare_find.c: the value of an object at a path such as "comparison.dt_p95_us", or NULL. */
const cJSON *compare_find(const cJSON *object, const char *path);
/* A number with three digits, or all digits of a whole number; returns `text`. */
const char *compare_number(double value, char text[32]);

/* compare_fair.c: the interval that is compared, [start, stop): the whole run, or the recording's part. */
void compare_interval(const comparison *c, int32_t reference, int64_t *start_ns, int64_t *stop_ns);
/* Reads the recording, and removes events that no simulation makes. */
tides_status compare_read(comparison *c, tides_error *error);
/* Copies the part of a stream that is compared with the recording to `kept`; the caller frees it. */
tides_status compare_fair_events(const comparison *c, const cli_stream *stream, cli_stream *kept, tides_error *error);
/* Runs the row's method with the settings `more` added. `kept` gets the part that is compared; the caller frees it. */
tides_status compare_run_fair(comparison *c, const compare_row *row, const cli_list *more, cli_stream *kept,
                              tides_error *error);
/* compare_mask.c: reads fair->mask from its file. */
tides_status compare_mask_read(compare_fair *fair, int32_t width, int32_t height, tides_error *error);

/* compare_settings.c: the name of method number `index`, in the order of rows; NULL behind the last. */
const char *compare_method(size_t index);
/* 1 where the method is left out for frames, since it equals another one there. */
int32_t compare_scenes_only(const char *method);
/* Keys of a method that may be searched, ended by NULL. */
const char *const *compare_searched(const char *method);
/* Makes a method's session from what c->open has open: ideal (TIDES_IDEAL_*), with `more` added (nullable). With `row`, its
 * settings are noted. The caller closes it. */
tides_status compare_configure(const comparison *c, const char *method, int32_t what, const cli_list *more, compare_row *row,
                               tides_session **session, tides_error *error);
/* The rows' TIDES_IDEAL_*. */
int32_t compare_ideal(const comparison *c);

/* Two streams to be compared. */
typedef struct compare_pair {
    const tides_event *events; /* (count) the reference's */
    size_t count;
    const cli_stream *stream;
    int32_t reference; /* COMPARE_EXACT or _RECORDING: the interval and the limit of matches */
    uint32_t wanted;   /* TIDES_METRIC_* */
} compare_pair;

/* compare_score.c: compares a stream with a reference. */
tides_status compare_measure(comparison *c, const compare_pair *pair, tides_metrics *metrics, tides_error *error);
/* Compares the row's stream with all references; floors go to c->floors. */
tides_status compare_score(comparison *c, compare_row *row, tides_error *error);
tides_status compare_floors(comparison *c, tides_error *error);

/* compare_exact.c: finds c->exact, the stream with which all are compared. */
tides_status compare_exact(comparison *c, tides_error *error);
/* A description of the exact stream. compare_exact_name: "exact", or "lines" on frames. */
const char *compare_exact_what(const comparison *c);
const char *compare_exact_name(const comparison *c);

/* compare_run.c: runs the row's method; the row keeps a failure. TIDES_CANCELLED if the user stopped it, else TIDES_OK. */
tides_status compare_run(comparison *c, compare_row *row, tides_error *error);
void compare_row_free(compare_row *row);
/* With --keep: writes the stream to NAME.h5. */
tides_status compare_keep_events(const comparison *c, const char *name, const tides_session_facts *session,
                                 const tides_event *events, size_t count, tides_error *error);

/* compare_search.c: finds row->found, the parameters for which the stream is closest to the recording, with c->search runs. */
tides_status compare_search(comparison *c, compare_row *row, tides_error *error);

/* compare_report.c: writes compare.json and .csv; `report` gets the JSON, which the caller frees. */
tides_status compare_report(const comparison *c, cJSON **report, tides_error *error);
tides_status compare_write_tables(const comparison *c, const cJSON *report, tides_error *error);
/* The first row's metrics against a reference, for their names; NULL: no method ran. */
const cJSON *compare_names(const cJSON *report, int32_t reference);
/* A row's metrics against a reference. */
const cJSON *compare_against(const cJSON *row, int32_t reference);

/* compare_table.c: the table as text, HTML and (for a recording) compare.tex; the meaning of its columns, and which way is
 * better. */
void compare_print_table(const cJSON *report, int32_t reference);
void compare_put_table(FILE *file, const cJSON *report, int32_t reference);
tides_status compare_write_latex(const comparison *c, const cJSON *report, tides_error *error);
void compare_print_meanings(int32_t reference);
void compare_put_meanings(FILE *file, int32_t reference);

/* compare_print.c: prints all on the terminal. compare_left_out: a sentence on the parts of a recording that were left
 * out. */
void compare_print(const comparison *c, const cJSON *report);
enum { COMPARE_SENTENCE = 400 };
const char *compare_left_out(const comparison *c, char text[COMPARE_SENTENCE]);
/* Writes a row's parameters: "key value, ...". */
void compare_put_parameters(const comparison *c, const cJSON *row, void (*put)(FILE *file, const char *text), FILE *file);

/* compare_page.c: writes index.html, and with --keep a page of events for each stream. */
tides_status compare_page(const comparison *c, const cJSON *report, tides_error *error);

/* compare_figure.c: compare.png, of the exact stream. compare_recorded.c: recording.png. */
tides_status compare_figure(const comparison *c, tides_error *error);
tides_status compare_recorded(const comparison *c, tides_error *error);

#endif
