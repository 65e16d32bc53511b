/* tides compare: every method on one run. */
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

/* "tides,esim": rows in the list's order; all without one. */
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

static int parse(const cli_command *command, const char *methods, const char *window, comparison *c) {
    int code = parse_methods(command, methods, c);
    if (code == CLI_GO && window) code = cli_number(command, "--window", window, &c->window_s);
    if (code != CLI_GO) return code;
    if (window && !(c->window_s > 0)) return cli_usage(command, "--window %s: should be above 0", window);
    if (strlen(c->directory) > COMPARE_PATH - 200) return cli_usage(command, "-o: the path is too long");
    return CLI_GO;
}

/* -- the work -------------------------------------------------------------------------------------------------------------- */

void compare_interval(const comparison *c, int64_t *start_ns, int64_t *stop_ns) {
    *start_ns = cli_nanoseconds(c->session.values.start);
    *stop_ns = cli_nanoseconds(c->session.values.stop) + 1;
}

tides_status compare_keep_events(const comparison *c, const char *name, const tides_session_facts *s, const tides_event *events,
                                 size_t count, tides_error *error) {
    tides_event_writer *writer = NULL;
    int64_t start_ns, stop_ns;
    char path[COMPARE_PATH];
    if (!c->keep) return TIDES_OK;
    snprintf(path, sizeof path, "%s/%s.h5", c->directory, name);
    compare_interval(c, &start_ns, &stop_ns);
    const tides_event_file facts = {.width = s->intrinsics.width,
                                    .height = s->intrinsics.height,
                                    .run = s->values.json,
                                    .seed = s->values.seed,
                                    .start_ns = start_ns,
                                    .stop_ns = stop_ns - 1};
    tides_status status = tides_event_writer_open(path, NULL, &facts, &writer, error);
    if (status == TIDES_OK) status = tides_event_writer_append(writer, events, NULL, count, error);
    if (status == TIDES_OK) return tides_event_writer_finish(writer, stop_ns - 1, error);
    tides_event_writer_abandon(writer);
    return status;
}

/* The recording's events of the run's time, of a sensor of the run's size. */
static tides_status read_recording(comparison *c, tides_error *error) {
    cli_window *w = &c->recording;
    const tides_intrinsics *size = &c->session.intrinsics;
    if (!c->recording_file) return TIDES_OK;
    compare_interval(c, &w->first_ns, &w->stop_ns);
    tides_status status = cli_window_read(c->recording_file, w, error);
    if (status == TIDES_OK) status = cli_window_ordered(c->recording_file, w, error);
    if (status != TIDES_OK) return status;
    if (w->count == 0)
        return cli_error(error, TIDES_BAD_ARGUMENT,
                         "%s: lasts from %.15g to %.15g s and has no events from %.15g to %.15g s, the run's time: tides "
                         "convert --rebase counts from its zero, --offset shifts it",
                         c->recording_file, 1e-9 * (double)w->seen_ns, 1e-9 * (double)w->seen_stop_ns, c->session.values.start,
                         c->session.values.stop);
    if (w->width > size->width || w->height > size->height)
        return cli_error(error, TIDES_BAD_ARGUMENT, "%s: is %dx%d px and the run %dx%d px: tides cut --roi makes it as small",
                         c->recording_file, w->width, w->height, size->width, size->height);
    return TIDES_OK;
}

/* Frames come at their own times: ESIM has no other sampling there. */
static void leave_out(comparison *c) {
    int32_t count = 0;
    for (int32_t i = 0; i < c->count; i++)
        if (!compare_scenes_only(c->rows[i].name)) c->rows[count++].name = c->rows[i].name;
    c->count = count;
}

/* The recording may be what an earlier comparison kept, and the run file anything. */
static tides_status check_outputs(const comparison *c, tides_error *error) {
    static const char *const tables[] = {"compare.json", "compare.csv", "compare.png", "compare.svg",
                                         "compare.pdf",  "index.html",  NULL};
    const char *kept[] = {"exact.h5", "exact.html", "recording.html", NULL};
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

/* Opens the run and refuses one that can't be compared, before anything long begins. */
static tides_status prepare(comparison *c, tides_error *error) {
    tides_status status = check_outputs(c, error);
    if (status == TIDES_OK) status = cli_session_open(c->run, c->sets, c->common, NULL, 0, &c->open, error);
    if (status == TIDES_OK) tides_session_get(c->open, &c->session);
    if (status == TIDES_OK && c->session.values.baseline.method == TIDES_METHOD_LDATI)
        return cli_error(error, TIDES_UNSUPPORTED,
                         "%s: method ldati: a voxel grid has lost the signal that the others need; give a scene or frames",
                         c->run);
    if (status == TIDES_OK) status = cli_make_directory(c->directory, error);
    if (status == TIDES_OK && c->session.frames) leave_out(c);
    return status == TIDES_OK ? read_recording(c, error) : status;
}

static tides_status work(comparison *c, cJSON **report, tides_error *error) {
    tides_status status = prepare(c, error);
    if (status == TIDES_OK && c->count == 0)
        status = cli_error(error, TIDES_BAD_ARGUMENT, "--methods esim-fixed: needs a scene; on frames it is esim");
    if (status == TIDES_OK) status = compare_exact(c, error);
    for (int32_t i = 0; status == TIDES_OK && i < c->count; i++) status = compare_run(c, &c->rows[i], error);
    if (status == TIDES_OK) status = compare_report(c, report, error);
    if (status == TIDES_OK) status = compare_write_tables(c, *report, error);
    if (status == TIDES_OK) status = compare_figure(c, error);
    return status == TIDES_OK ? compare_page(c, *report, error) : status;
}

/* Failures come last, where they are seen. */
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
    tides_free(c->exact.events);
    free(c->recording.events);
    tides_session_close(c->open);
}

int cmd_compare(const cli_command *command, int argc, char **argv) {
    cli_common common;
    cli_list sets = {.count = 0};
    comparison c;
    memset(&c, 0, sizeof c);
    const char *methods = NULL, *window = NULL, *theme = NULL, *pictures = NULL;
    const cli_option options[] = {
        {"--output", 'o', "DIR", "where results go (tides-compare)", NULL, &c.directory, NULL},
        {"--methods", 0, "LIST", METHODS ": only these", NULL, &methods, NULL},
        {"--as-configured", 0, NULL, "the run file's own settings in place of ideal pixels", &c.as_configured, NULL, NULL},
        {"--recording", 0, "EVENTS", "compare with a recording of this scene, too", NULL, &c.recording_file, NULL},
        {"--window", 0, "S", "the picture shows so much of the run's middle (as long as it stays clear)", NULL, &window, NULL},
        {"--theme", 0, "THEME", CANVAS_THEME_HELP, NULL, &theme, NULL},
        {"--pictures", 0, "FORMAT", CANVAS_PICTURES_HELP, NULL, &pictures, NULL},
        {"--keep", 0, NULL, "keep the events: DIR/exact.h5 and DIR/METHOD.h5, and pages of them (.html)", &c.keep, NULL, NULL},
        {"--double", 0, NULL, "the exact stream in double precision, by the reference device: slow", &c.in_double, NULL, NULL},
        {"--set", 0, "KEY=VALUE", "override a key of the run file; may be repeated", NULL, NULL, &sets},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &c.run);
    if (code != CLI_GO) return code;
    if (!c.directory) c.directory = "tides-compare";
    if ((code = parse(command, methods, window, &c)) != CLI_GO) return code;
    if ((code = canvas_parse_theme(command, theme, &c.style)) != CLI_GO) return code;
    if ((code = canvas_parse_pictures(command, pictures, &c.style)) != CLI_GO) return code;
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
