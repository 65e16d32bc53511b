/* index.html of a calibration: the values and their evidence, the picture, and the preset to copy. */
#include "calibrate_report.h"
#include "html.h"

#include <math.h>
#include <string.h>

static void put_number(FILE *file, double value) {
    if (isfinite(value))
        fprintf(file, "<td>%.4g</td>", value);
    else
        fputs("<td></td>", file);
}

static void put_value(FILE *file, const tides_calibrated *v, const tides_calibrated_row *row) {
    const double halves[] = {v->early, v->late, v->left, v->right, v->raw};
    const int32_t bound = v->state == TIDES_CALIBRATED_BOUND;
    fprintf(file, "<tr><td class=text>%s</td><td class=\"text%s\">%s</td>", row->name,
            v->state == TIDES_CALIBRATED_UNCERTAIN  ? " no"
            : v->state == TIDES_CALIBRATED_MEASURED ? " yes"
                                                    : "",
            calibrate_state(v->state));
    put_number(file, bound ? fabs(v->value) + 2 * v->error : v->value);
    put_number(file, bound ? NAN : v->error);
    fprintf(file, "<td class=text>%s</td>", row->unit);
    for (int32_t i = 0; i < 5; i++) put_number(file, halves[i]);
    fputs("</tr>\n", file);
}

static void put_values(FILE *file, const tides_calibration *f) {
    tides_calibrated_row row;
    html_table_begin(file);
    fputs("<tr><th class=text>value</th><th class=text>state</th><th></th><th>+-</th><th class=text>unit</th><th>first "
          "half</th>"
          "<th>second half</th><th>left half</th><th>right half</th><th>uncorrected</th></tr></thead><tbody>\n",
          file);
    for (int32_t i = 0; tides_calibrated_at(i, &row); i++) put_value(file, &f->values[i], &row);
    html_table_end(file);
}

static void put_transitions(FILE *file, const tides_calibration *f) {
    html_table_begin(file);
    fputs("<tr><th class=text>transition</th><th>median change [thresholds]</th><th>pairs</th></tr></thead><tbody>\n", file);
    for (int32_t i = 0; i < CALIBRATE_TRANSITIONS; i++) {
        fprintf(file, "<tr><td class=text>%s</td>", calibrate_transition(i));
        put_number(file, f->transitions[i]);
        fprintf(file, "<td>%llu</td></tr>\n", (unsigned long long)f->transition_pairs[i]);
    }
    html_table_end(file);
}

static void put_notes(FILE *file, const char *lines) {
    if (!lines || !*lines) return;
    fputs("<h2>To be said</h2>\n<ul>\n", file);
    while (*lines) {
        char line[1024];
        const size_t length = strcspn(lines, "\n");
        snprintf(line, sizeof line, "%.*s", (int)length, lines);
        fputs("<li>", file);
        html_text(file, line);
        fputs("</li>\n", file);
        lines += length + (lines[length] == '\n');
    }
    fputs("</ul>\n", file);
}

static void put_head(FILE *file, const calibrate_report *r) {
    const tides_calibration *f = r->found;
    char start[CLI_SECONDS], stop[CLI_SECONDS];
    fputs("<p>", file);
    html_text(file, r->recording);
    fprintf(file, ", %s to %s s, by the light of ", cli_seconds(f->start_ns, start), cli_seconds(f->stop_ns, stop));
    html_text(file, r->run);
    fprintf(file,
            ".</p>\n<p class=small>tides %s; %llu events, %llu of them in %d bursts of frames' readout; %llu pairs in %llu "
            "pixels; light at "
            "%d times; changes differ by %.1f %% in the mean and %.1f %% have their event's sign; black level and threshold_on "
            "correlate by "
            "%.2f.</p>\n",
            tides_version(), (unsigned long long)f->events, (unsigned long long)f->burst_events, f->bursts,
            (unsigned long long)f->pairs, (unsigned long long)f->pixels, f->samples, 100 * f->deviation, 100 * f->agreement,
            f->correlation);
}

static void put_page(FILE *file, const void *what) {
    const calibrate_report *r = what;
    html_begin(file, "tides calibrate");
    put_head(file, r);
    if (r->found->refused) fputs("<p class=no>Recording and light don't tell the sensor: no preset.</p>\n", file);
    put_notes(file, r->found->notes);
    fputs("<h2>Values</h2>\n", file);
    put_values(file, r->found);
    fputs("<p class=small>Errors are one sigma: of pixels drawn by chance, or half of what halves differ by. Uncertain: halves "
          "differ by a "
          "fifth and more. At most: it can't be told from none.</p>\n<h2>Changes of light from event to event</h2>\n",
          file);
    put_transitions(file, r->found);
    html_picture(file, r->directory, "calibrate.png");
    if (r->preset) {
        fputs("<h2>Preset</h2>\n<pre>", file);
        html_text(file, r->preset);
        fputs("</pre>\n", file);
    }
    html_end(file);
}

tides_status calibrate_page(const calibrate_report *report, tides_error *error) {
    char path[4200];
    snprintf(path, sizeof path, "%s/index.html", report->directory);
    return cli_write_file(path, put_page, report, error);
}
