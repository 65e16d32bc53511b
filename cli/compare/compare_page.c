/* index.html of a comparison: the tables, the picture, each method's settings; and with --keep a page of events for each
 * stream. */
#include "compare.h"
#include "html.h"

typedef struct page {
    const comparison *c;
    const cJSON *report;
} page;

/* -- pages of events --------------------------------------------------------------------------------------------------- */

static tides_status keep_page(const comparison *c, const char *name, const tides_event *events, size_t count,
                              tides_error *error) {
    char path[COMPARE_PATH];
    tides_page_options options;
    tides_page_options_defaults(&options);
    compare_interval(c, COMPARE_EXACT, &options.start_ns, &options.stop_ns);
    options.width = c->session.intrinsics.width;
    options.height = c->session.intrinsics.height;
    options.title = name;
    snprintf(path, sizeof path, "%s/%s.html", c->directory, name);
    return tides_page_write(path, events, NULL, count, &options, NULL, error);
}

static tides_status keep_pages(const comparison *c, tides_error *error) {
    tides_status status =
        c->keep && c->with_exact ? keep_page(c, compare_exact_name(c), c->exact.events, c->exact.count, error) : TIDES_OK;
    for (int32_t i = 0; c->keep && i < c->count && status == TIDES_OK; i++)
        if (c->rows[i].error.status == TIDES_OK)
            status = keep_page(c, c->rows[i].name, c->rows[i].stream.events, c->rows[i].stream.count, error);
    return status;
}

/* -- the page ---------------------------------------------------------------------------------------------------------- */

static void put_links(FILE *file, const comparison *c) {
    if (!c->keep) return;
    fputs("<p>Events to look at:", file);
    if (c->with_exact) fprintf(file, " <a href=\"%s.html\">%s</a>", compare_exact_name(c), compare_exact_name(c));
    for (int32_t i = 0; i < c->count; i++)
        if (c->rows[i].error.status == TIDES_OK) fprintf(file, " <a href=\"%s.html\">%s</a>", c->rows[i].name, c->rows[i].name);
    fputs("</p>\n", file);
}

/* A method's row: its parameters, or the error with which it failed. */
static void put_method(FILE *file, const comparison *c, const cJSON *row) {
    const cJSON *failed = compare_find(row, "error");
    fputs("<tr><td class=text>", file);
    html_text(file, compare_find(row, "method")->valuestring);
    fputs("</td><td class=text>", file);
    if (failed)
        html_text(file, failed->valuestring);
    else
        compare_put_parameters(c, row, html_text, file);
    fputs("</td></tr>\n", file);
}

static void put_methods(FILE *file, const comparison *c, const cJSON *report) {
    const cJSON *row;
    html_table_begin(file);
    fputs("<tr><th class=text>method</th><th class=text>told</th></tr></thead><tbody>\n", file);
    cJSON_ArrayForEach(row, compare_find(report, "methods")) { put_method(file, c, row); }
    html_table_end(file);
}

static void put_recorded(FILE *file, const page *p) {
    char text[COMPARE_SENTENCE];
    fputs("<h2>Against the recording</h2>\n<p>", file);
    html_text(file, p->c->recording_file);
    fputs(": ", file);
    html_text(file, compare_left_out(p->c, text));
    fputs(".</p>\n", file);
    compare_put_table(file, p->report, COMPARE_RECORDING);
    compare_put_meanings(file, COMPARE_RECORDING);
    html_picture(file, p->c->directory, "recording.png");
}

static void put_exact(FILE *file, const page *p) {
    const int32_t of_frames = p->c->session.frames != NULL;
    fputs(of_frames ? "<h2>Beside straight lines between the frames</h2>\n<p>" : "<h2>Against the exact stream</h2>\n<p>",
          file);
    html_text(file, compare_exact_what(p->c));
    fputs(of_frames ? ": TIDES's own way, and no truth: nobody knows what was between the frames.</p>\n" : ".</p>\n", file);
    compare_put_table(file, p->report, COMPARE_EXACT);
    compare_put_meanings(file, COMPARE_EXACT);
    html_picture(file, p->c->directory, "compare.png");
}

static void put_page(FILE *file, const void *what) {
    const page *p = what;
    const comparison *c = p->c;
    html_begin(file, "tides compare");
    fputs("<p>", file);
    html_text(file, c->run);
    fprintf(file, ", %.9g to %.9g s, %d x %d px, %s.</p>\n<p class=small>tides %s on ", c->session.values.start,
            c->session.values.stop, c->session.intrinsics.width, c->session.intrinsics.height,
            c->as_configured ? "pixels as the run file says" : "ideal pixels with the run's thresholds", tides_version());
    html_text(file, c->session.info.name);
    fputs("</p>\n", file);
    if (c->recording_file) put_recorded(file, p);
    if (c->with_exact) put_exact(file, p);
    put_links(file, c);
    fputs("<h2>Methods</h2>\n", file);
    put_methods(file, c, p->report);
    html_end(file);
}

tides_status compare_page(const comparison *c, const cJSON *report, tides_error *error) {
    const page p = {c, report};
    char path[COMPARE_PATH];
    snprintf(path, sizeof path, "%s/index.html", c->directory);
    const tides_status status = keep_pages(c, error);
    return status == TIDES_OK ? cli_write_file(path, put_page, &p, error) : status;
}
