/* `tides compare`: every method on one run, against its exact stream and a recording. */
#ifndef CLI_COMPARE_H
#define CLI_COMPARE_H

#include "canvas.h"
#include "metrics_report.h"
#include "session.h"
#include "stream.h"

/* One method, and what became of it. */
typedef struct compare_row {
    const char *name;
    tides_error error; /* status TIDES_OK where it ran */
    cJSON *settings;   /* ["key=value", ...] on top of the run file */
    cJSON *parameters; /* those that its column shows, {key: value}, as they were in force */
    cli_stream stream; /* its events */
    tides_stats stats;
    cJSON *against_exact, *against_recording; /* cli_metrics_json; NULL where there is none */
} compare_row;

enum { COMPARE_METHODS_MAX = 8, COMPARE_PATH = 4200 /* of files in the directory */ };

typedef struct comparison {
    const cli_common *common;
    const char *run, *directory;
    const cli_list *sets;
    const char *recording_file; /* NULL: none */
    double window_s;            /* of the picture; 0: what is comfortable */
    canvas_style style;         /* and how it looks */
    int32_t as_configured;      /* 1: the run file's own settings; 0: ideal pixels */
    int32_t keep;               /* 1: events of each go to files */
    int32_t in_double;          /* 1: the exact stream comes from the double-precision reference */

    tides_session *open; /* as the run file says; the rows' are variations of it */
    tides_session_facts session;
    cli_progress progress;
    tides_exact exact;
    cli_window recording;
    compare_row rows[COMPARE_METHODS_MAX];
    int32_t count;
} comparison;

/* The interval that is compared: [start, stop) with the run's last nanosecond in it. */
void compare_interval(const comparison *c, int64_t *start_ns, int64_t *stop_ns);
/* With --keep: the stream into NAME.h5. */
tides_status compare_keep_events(const comparison *c, const char *name, const tides_session_facts *session,
                                 const tides_event *events, size_t count, tides_error *error);

/* compare_methods.c: the name of method number `index`, in the order of the rows; NULL behind the last. */
const char *compare_method(size_t index);
/* 1 where it makes no sense for frames: another method is the same there. */
int32_t compare_scenes_only(const char *method);
/* The session of a method, ideal or as configured, on what c->open has open; with
 * `row` its settings are told. The caller closes it. */
tides_status compare_configure(const comparison *c, const char *method, int32_t what, compare_row *row, tides_session **session,
                               tides_error *error);
/* Runs the row's method; the row keeps the failure. TIDES_CANCELLED where the user stopped it, else TIDES_OK. */
tides_status compare_run(comparison *c, compare_row *row, tides_error *error);
void compare_row_free(compare_row *row);

/* compare_exact.c: c->exact, the stream that all are measured against. */
tides_status compare_exact(comparison *c, tides_error *error);
/* In words what it is. */
const char *compare_exact_what(const comparison *c);

/* compare_table.c: compare.json and .csv, and the table; `report` gets the JSON, the caller's. */
tides_status compare_report(const comparison *c, cJSON **report, tides_error *error);
tides_status compare_write_tables(const comparison *c, const cJSON *report, tides_error *error);
void compare_print(const comparison *c, const cJSON *report);
/* Three digits, or as many as a whole number has; returns `text`. */
const char *compare_number(double value, char text[32]);
/* The value at "comparison.dt_p95_us" of an object in objects, or NULL. */
const cJSON *compare_find(const cJSON *object, const char *path);

/* The table as HTML, as it is printed; 0 or 1: against the exact stream, against the recording. */
void compare_put_table(FILE *file, const cJSON *report, size_t reference);
/* What its columns mean, and which way is better. */
void compare_put_meanings(FILE *file);

/* compare_page.c: index.html with all of it, and with --keep a page of events for each stream. */
tides_status compare_page(const comparison *c, const cJSON *report, tides_error *error);

/* compare_figure.c: compare.png. */
tides_status compare_figure(const comparison *c, tides_error *error);

#endif
