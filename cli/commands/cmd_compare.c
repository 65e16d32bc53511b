/* tides compare: compares simulators, and this one, on one run. */
#include "compare.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* -- the command line ------------------------------------------------------------------------------------------------------ */

#define METHODS "tides,esim,esim-fixed,v2e,dvs-voltmeter,iebcs"

static int unknown_method(const cli_command *command, const char *name) {
    const char *names[COMPARE_METHODS_MAX + 1] = {NULL};
    for (size_t i = 0; compare_method(i); i++) names[i] = compare_method(i);
    const char *nearest = tides_nearest_name(name, names);
    if (nearest) return cli_usage(command, "--methods: no method is called %s; did you mean %s?", name, nearest);
    return cli_usage(command, "--methods: no method is called %s; there are " METHODS, name);
}

/* Parses "tides,esim": rows in the order of the list, or all. */
static int parse_methods(const cli_command *command, const char *text, comparison *c) {
    for (size_t i = 0; !text && compare_method(i); i++) c->rows[c->count++].name = compare_method(i);
    while (text) {
        char name[32];
        const size_t length = strcspn(text, ",");
        size_t i = 0;
        snprintf(name, sizeof name, "%.*s", (int)(length < sizeof name ? length : sizeof name - 1), text);
        while (compare_method(i) && strcmp(compare_method(i), name) != 0) i++;
        if (!compare_method(i)) return unknown_method(command, name);
        for (int32_t k = 0; k < c->count; k++)
            if (c->rows[k].name == compare_method(i)) return cli_usage(command, "--methods: %s is there twice", name);
        c->rows[c->count++].name = compare_method(i);
        text = text[length] ? text + length + 1 : NULL;
    }
    return CLI_GO;
}

/* Texts of options that are numbers or lists; NULL where not given. */
typedef struct texts {
    const char *methods, *window, *tolerance, *search, *theme, *pictures;
} texts;

/* Parses a number above 0, if the option was given. */
static int parse_above(const cli_command *command, const char *option, const char *text, double *value) {
    const int code = text ? cli_number(command, option, text, value) : CLI_GO;
    if (code != CLI_GO || !text || *value > 0) return code;
    return cli_usage(command, "%s %s: should be above 0", option, text);
}

/* Takes the options that need a recording; without one it refuses them. */
static int parse_fair(const cli_command *command, const texts *t, comparison *c) {
    compare_fair *f = &c->fair;
    double search = 0;
    int code = cli_reading_parse(command, &f->reading, &f->how);
    if (code == CLI_GO && f->start) code = cli_time(command, "--start", f->start, &f->start_ns);
    if (code == CLI_GO && f->stop) code = cli_time(command, "--stop", f->stop, &f->stop_ns);
    if (code == CLI_GO) code = parse_above(command, "--tolerance", t->tolerance, &f->tolerance_s);
    if (code == CLI_GO) code = parse_above(command, "--search", t->search, &search);
    if (code != CLI_GO) return code;
    if (f->tolerance_s > 10) return cli_usage(command, "--tolerance %s: should be at most 10", t->tolerance);
    if (search > 100000) return cli_usage(command, "--search %s: should be at most 100000 runs", t->search);
    c->search = (int32_t)search;
    if (!c->recording_file && (f->start || f->stop || f->mask_file || f->all || t->tolerance || t->search))
        return cli_usage(command, "--start, --stop, --mask, --all-events, --tolerance and --search are of a --recording");
    return CLI_GO;
}

static int parse(const cli_command *command, const texts *t, comparison *c) {
    int code = parse_methods(command, t->methods, c);
    if (code == CLI_GO) code = parse_above(command, "--window", t->window, &c->window_s);
    if (code == CLI_GO) code = parse_fair(command, t, c);
    if (code == CLI_GO) code = canvas_parse_theme(command, t->theme, &c->style);
    if (code == CLI_GO) code = canvas_parse_pictures(command, t->pictures, &c->style);
    if (code != CLI_GO) return code;
    if (strlen(c->directory) > COMPARE_PATH - 200) return cli_usage(command, "-o: the path is too long");
    return CLI_GO;
}

/* -- the work -------------------------------------------------------------------------------------------------------------- */

/* Leaves out methods that differ only in their sampling: frames come at their own times. */
static void leave_out(comparison *c) {
    int32_t count = 0;
    for (int32_t i = 0; i < c->count; i++)
        if (!compare_scenes_only(c->rows[i].name)) c->rows[count++].name = c->rows[i].name;
    c->count = count;
}

/* Checks outputs. The recording may be a file that an earlier comparison wrote, and the run file may be of any kind. */
static tides_status check_outputs(const comparison *c, tides_error *error) {
    static const char *const tables[] =
        {"compare.json",  "compare.csv",   "compare.tex",   "compare.png", "compare.svg", "compare.pdf",
         "recording.png", "recording.svg", "recording.pdf", "index.html",  NULL};
    static const char *const kept[] = {"exact.h5", "exact.html", "lines.h5", "lines.html", NULL};
    tides_status status = cli_check_folder(c->run, c->sets, c->recording_file, c->directory, tables, error);
    if (status == TIDES_OK && c->keep) status = cli_check_folder(c->run, c->sets, c->recording_file, c->directory, kept, error);
    for (int32_t i = 0; i < c->count && c->keep && status == TIDES_OK; i++) {
        char events[64], page[64];
        snprintf(events, sizeof events, "%s.h5", c->rows[i].name);
        snprintf(page, sizeof page, "%s.html", c->rows[i].name);
        const char *const names[] = {events, page, NULL};
        status = cli_check_folder(c->run, c->sets, c->recording_file, c->directory, names, error);
    }
    return status;
}

/* Opens the run, and refuses one that can't be compared before any long work begins. */
static tides_status prepare(comparison *c, tides_error *error) {
    tides_status status = check_outputs(c, error);
    if (status == TIDES_OK) status = cli_session_open(c->run, c->sets, c->common, NULL, 0, &c->open, error);
    if (status == TIDES_OK) tides_session_get(c->open, &c->session);
    if (status == TIDES_OK && c->session.values.baseline.method == TIDES_METHOD_LDATI)
        return cli_error(error, TIDES_UNSUPPORTED,
                         "%s: method ldati: a voxel grid has lost the signal that the others need; give a scene or frames",
                         c->run);
    /* Not with a recording on frames, or of a measured sensor. On frames the exact stream is that of straight lines between
     * them, which TIDES uses itself. A measured sensor has no exact stream. */
    c->with_exact = !c->recording_file || (!c->session.frames && !c->as_configured);
    if (status == TIDES_OK) status = cli_make_directory(c->directory, error);
    if (status == TIDES_OK && c->session.frames) leave_out(c);
    return status == TIDES_OK ? compare_read(c, error) : status;
}

static tides_status work(comparison *c, cJSON **report, tides_error *error) {
    tides_status status = prepare(c, error);
    if (status == TIDES_OK && c->count == 0)
        status = cli_error(error, TIDES_BAD_ARGUMENT, "--methods esim-fixed: needs a scene; on frames it is esim");
    if (status == TIDES_OK) status = compare_exact(c, error);
    for (int32_t i = 0; status == TIDES_OK && i < c->count; i++) {
        status = compare_search(c, &c->rows[i], error);
        if (status == TIDES_OK) status = compare_run(c, &c->rows[i], error);
    }
    if (status == TIDES_OK) status = compare_floors(c, error);
    if (status == TIDES_OK) status = compare_report(c, report, error);
    if (status == TIDES_OK) status = compare_write_tables(c, *report, error);
    if (status == TIDES_OK) status = compare_write_latex(c, *report, error);
    if (status == TIDES_OK) status = compare_figure(c, error);
    if (status == TIDES_OK) status = compare_recorded(c, error);
    return status == TIDES_OK ? compare_page(c, *report, error) : status;
}

/* Prints failures last, where users see them. */
static int report_failures(const comparison *c) {
    int code = CLI_OK;
    for (int32_t i = 0; i < c->count; i++)
        if (c->rows[i].error.status != TIDES_OK) code = cli_failed("%s failed: %s", c->rows[i].name, c->rows[i].error.text);
    return code;
}

static int finish(const comparison *c, tides_status status, cJSON *report, const tides_error *error) {
    if (status == TIDES_CANCELLED) {
        cJSON_Delete(report);
        return cli_failed("stopped on request; no table was written");
    }
    if (status != TIDES_OK) {
        cJSON_Delete(report);
        return cli_fail(error);
    }
    if (c->common->json)
        cli_print_facts(report, 1);
    else {
        if (!c->common->quiet) compare_print(c, report);
        cJSON_Delete(report);
    }
    return report_failures(c);
}

static void free_all(comparison *c) {
    for (int32_t i = 0; i < c->count; i++) compare_row_free(&c->rows[i]);
    for (int32_t i = 0; i < COMPARE_FLOORS; i++) cJSON_Delete(c->floors[i]);
    tides_free(c->exact.events);
    tides_blemishes_free(&c->fair.blemishes);
    free(c->fair.mask);
    free(c->recording.events);
    tides_session_close(c->open);
}

int cmd_compare(const cli_command *command, int argc, char **argv) {
    cli_common common;
    cli_list sets = {.count = 0};
    comparison c;
    memset(&c, 0, sizeof c);
    texts t = {.methods = NULL};
    c.fair.tolerance_s = 5e-3;
    const cli_option options[] = {
        {"--output", 'o', "DIR", "where results go (tides-compare)", NULL, &c.directory, NULL},
        {"--methods", 0, "LIST", METHODS ": only these", NULL, &t.methods, NULL},
        {"--as-configured", 0, NULL, "the run file's own settings in place of ideal pixels", &c.as_configured, NULL, NULL},
        {"--recording", 0, "EVENTS", "compare with a recording of this scene, too", NULL, &c.recording_file, NULL},
        {"--start", 0, "S", "with a recording: compare from here on (what run and recording both have)", NULL, &c.fair.start,
         NULL},
        {"--stop", 0, "S", "and before this time", NULL, &c.fair.stop, NULL},
        {"--mask", 0, "FILE", "pixels that don't count: black in a .png, or a text file's lines of x and y", NULL,
         &c.fair.mask_file, NULL},
        {"--all-events", 0, NULL, "leave bursts of frames' readout and hot pixels in", &c.fair.all, NULL, NULL},
        {"--tolerance", 0, "S", "events of the recording and of a stream are the same within this (0.005)", NULL, &t.tolerance,
         NULL},
        {"--search", 0, "RUNS", "move each method's parameters towards the recording, by so many runs each", NULL, &t.search,
         NULL},
        CLI_READING_FILE(c.fair.reading),
        CLI_READING_CLOCK(c.fair.reading),
        {"--window", 0, "S", "the picture shows so much of the run's middle (as long as it stays clear)", NULL, &t.window,
         NULL},
        {"--theme", 0, "THEME", CANVAS_THEME_HELP, NULL, &t.theme, NULL},
        {"--pictures", 0, "FORMAT", CANVAS_PICTURES_HELP, NULL, &t.pictures, NULL},
        {"--keep", 0, NULL, "keep the events: DIR/exact.h5 and DIR/METHOD.h5, and pages of them (.html)", &c.keep, NULL, NULL},
        {"--double", 0, NULL, "the exact stream in double precision, by the reference device: slow", &c.in_double, NULL, NULL},
        {"--set", 0, "KEY=VALUE", "override a key of the run file; may be repeated", NULL, NULL, &sets},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &c.run);
    if (code != CLI_GO) return code;
    if (!c.directory) c.directory = "tides-compare";
    if ((code = parse(command, &t, &c)) != CLI_GO) return code;
    c.common = &common;
    c.sets = &sets;
    c.progress.quiet = common.quiet;
    tides_error error = {TIDES_OK, ""};
    cJSON *report = NULL;
    cli_catch_interrupt();
    const tides_status status = work(&c, &report, &error);
    code = finish(&c, status, report, &error);
    free_all(&c);
    return code;
}
