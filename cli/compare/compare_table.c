/* The tables of a comparison: one for each reference, a line for each stream, as text, as HTML and in LaTeX.
 *
 * Scores against a recording are in the order that a test found (tests/golden/test_scores.c): first those that rank streams
 * correctly under every known degradation, then those that do so under some. A score that improves when the number of events
 * is wrong is in brackets, if numbers differ by more than a quarter. */
#include "compare.h"
#include "html.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A column. The reference has a value too where `own`. */
typedef struct column {
    const char *title, *own, *path;
    int32_t where; /* OF_EXACT ... */
} column;
enum { OF_EXACT = 1, OF_RECORDING = 2, ON_PAGE = 4 /* not on a terminal: there is no room */, CONDITIONED = 8 };

static const column columns[] = {
    {"events", "events", "simulated.events", OF_EXACT | OF_RECORDING},
    {"ratio", NULL, "comparison.count_ratio", OF_EXACT | OF_RECORDING},
    {"median us", NULL, "comparison.dt_median_us", OF_EXACT},
    {"p95 us", NULL, "comparison.dt_p95_us", OF_EXACT},
    {"mismatch %", NULL, "comparison.mismatch_percent", OF_EXACT},
    {"Same-ts", "same_ts", "simulated.same_ts", OF_EXACT},
    {"VP", NULL, "comparison.victor_purpura_fraction", OF_RECORDING},
    {"VR", NULL, "comparison.van_rossum_fraction", OF_RECORDING},
    {"matched", NULL, "comparison.matched_share", OF_RECORDING},
    {"rate 1ms", NULL, "comparison.rate_error_1ms", OF_RECORDING},
    {"rate 5ms", NULL, "comparison.rate_error_5ms", OF_RECORDING | ON_PAGE},
    {"regions", NULL, "comparison.region_error", OF_RECORDING},
    {"ON", NULL, "comparison.count_ratio_on", OF_RECORDING | ON_PAGE},
    {"OFF", NULL, "comparison.count_ratio_off", OF_RECORDING | ON_PAGE},
    {"IG-NLL+", NULL, "comparison.ig_nll_excess", OF_EXACT | OF_RECORDING | CONDITIONED},
    {"log ISI W1", NULL, "comparison.isi_w1_decades", OF_EXACT | OF_RECORDING | CONDITIONED},
    {"after ON", NULL, "comparison.isi_w1_after_on_decades", OF_RECORDING | ON_PAGE | CONDITIONED},
    {"after OFF", NULL, "comparison.isi_w1_after_off_decades", OF_RECORDING | ON_PAGE | CONDITIONED},
    {"Fano 1ms", NULL, "comparison.fano_error_1ms", OF_EXACT | OF_RECORDING | ON_PAGE},
    {"Chamfer px", NULL, "comparison.chamfer_px", OF_EXACT | OF_RECORDING | CONDITIONED},
    {"|dt| us", NULL, "comparison.dt_median_us", OF_RECORDING | CONDITIONED},
    {"VP", NULL, "comparison.victor_purpura_fraction", OF_EXACT},
};
enum { COLUMNS = sizeof columns / sizeof columns[0], NAME_WIDTH = 14, WIDTH = 11, CELL = 24 };
#define COUNTS_DIFFER 1.25

static int32_t is_shown(const column *k, int32_t reference, int32_t on_page) {
    if (!(k->where & (reference == COMPARE_EXACT ? OF_EXACT : OF_RECORDING))) return 0;
    return on_page || reference == COMPARE_EXACT || !(k->where & ON_PAGE);
}

/* -- lines ---------------------------------------------------------------------------------------------------------------- */

/* A line: of the reference, of a floor, or of a method. */
typedef struct line {
    const char *name, *failed;
    const cJSON *metrics, *row; /* NULL: it has none, or isn't a method */
    int32_t of_reference;       /* 1: its own values */
} line;
enum { LINES_MAX = COMPARE_METHODS_MAX + 1 + COMPARE_FLOORS };

static int32_t make_lines(const cJSON *report, int32_t reference, line *lines) {
    const cJSON *row, *floors = compare_find(report, "floors"), *names = compare_names(report, reference);
    const char *const own = reference == COMPARE_RECORDING ? "recording" : compare_find(report, "lines") ? "lines" : "exact";
    int32_t count = 0;
    if (!names) return 0;
    lines[count++] = (line){own, NULL, names, NULL, 1};
    if (reference == COMPARE_RECORDING && compare_find(floors, "seeds"))
        lines[count++] = (line){"floor: seeds", NULL, compare_find(floors, "seeds"), NULL, 0};
    if (reference == COMPARE_RECORDING && compare_find(floors, "pixels"))
        lines[count++] = (line){"floor: pixels", NULL, compare_find(floors, "pixels"), NULL, 0};
    cJSON_ArrayForEach(row, compare_find(report, "methods")) {
        const cJSON *failed = compare_find(row, "error");
        lines[count++] = (line){compare_find(row, "method")->valuestring, failed ? failed->valuestring : NULL,
                                compare_against(row, reference), row, 0};
    }
    return count;
}

static const char *cell(const line *l, const column *k, char text[CELL]) {
    char number[32];
    const cJSON *ratio = compare_find(l->metrics, "comparison.count_ratio");
    const cJSON *value = !l->of_reference ? compare_find(l->metrics, k->path)
                         : k->own         ? compare_find(compare_find(l->metrics, "reference"), k->own)
                                          : NULL;
    if (!cJSON_IsNumber(value)) return "-";
    const double off = cJSON_IsNumber(ratio) && ratio->valuedouble > 0 ? fabs(log(ratio->valuedouble)) : 0;
    const int32_t brackets = (k->where & CONDITIONED) && !l->of_reference && off > log(COUNTS_DIFFER);
    snprintf(text, CELL, brackets ? "(%s)" : "%s", compare_number(value->valuedouble, number));
    return text;
}

static const char *cell_of_row(const line *l, const char *key, char text[CELL]) {
    char number[32];
    const cJSON *value = compare_find(l->row, key);
    if (!cJSON_IsNumber(value)) return l->of_reference ? "" : "-";
    snprintf(text, CELL, "%s", compare_number(value->valuedouble, number));
    return text;
}

static const char *const of_rows[] = {"renders", "run_time_s"}, *const row_titles[] = {"renders", "seconds"};
enum { OF_ROWS = 2 };

/* -- text ----------------------------------------------------------------------------------------------------------------- */

void compare_print_table(const cJSON *report, int32_t reference) {
    line lines[LINES_MAX];
    char text[CELL];
    const int32_t count = make_lines(report, reference, lines), with_rows = reference == COMPARE_EXACT;
    if (count == 0) return;
    printf("%-*s", NAME_WIDTH, "");
    for (size_t k = 0; k < COLUMNS; k++)
        if (is_shown(&columns[k], reference, 0)) printf("%*s", WIDTH, columns[k].title);
    for (int32_t k = 0; with_rows && k < OF_ROWS; k++) printf("%*s", WIDTH, row_titles[k]);
    putchar('\n');
    for (int32_t i = 0; i < count; i++) {
        printf("%-*s", NAME_WIDTH, lines[i].name);
        if (lines[i].failed) printf("   failed: %s", lines[i].failed);
        for (size_t k = 0; k < COLUMNS && !lines[i].failed; k++)
            if (is_shown(&columns[k], reference, 0)) printf("%*s", WIDTH, cell(&lines[i], &columns[k], text));
        for (int32_t k = 0; with_rows && k < OF_ROWS && !lines[i].failed; k++)
            printf("%*s", WIDTH, cell_of_row(&lines[i], of_rows[k], text));
        putchar('\n');
    }
    putchar('\n');
}

/* -- what it means -------------------------------------------------------------------------------------------------------- */

/* The meaning of a column, and which way is better; NULL for a column of a single stream. */
static const char *meaning_of(const column *k, char text[CLI_MEANING]) {
    static const char part[] = "comparison.";
    const size_t prefix = sizeof part - 1;
    if (strcmp(k->title, "Same-ts") == 0) return "events that share their time with another; the reference's value is best";
    return strncmp(k->path, part, prefix) == 0 ? cli_metric_meaning(k->path + prefix, text) : NULL;
}

#define BRACKETS "another count of events moves this score by itself: counts differ by more than a quarter"

void compare_print_meanings(int32_t reference) {
    char text[CLI_MEANING];
    for (size_t k = 0; k < COLUMNS; k++)
        if (is_shown(&columns[k], reference, 0) && meaning_of(&columns[k], text))
            printf("%-*s %s\n", NAME_WIDTH, columns[k].title, meaning_of(&columns[k], text));
    if (reference == COMPARE_RECORDING) printf("%-*s %s\n", NAME_WIDTH, "(in brackets)", BRACKETS);
    putchar('\n');
}

void compare_put_meanings(FILE *file, int32_t reference) {
    fputs("<table class=small>\n", file);
    for (size_t k = 0; k < COLUMNS; k++) {
        char text[CLI_MEANING];
        const char *meaning = is_shown(&columns[k], reference, 1) ? meaning_of(&columns[k], text) : NULL;
        if (!meaning) continue;
        fprintf(file, "<tr><td class=text>%s</td><td class=text>", columns[k].title);
        html_text(file, meaning);
        fputs("</td></tr>\n", file);
    }
    if (reference == COMPARE_RECORDING)
        fputs("<tr><td class=text>(in brackets)</td><td class=text>" BRACKETS "</td></tr>\n", file);
    fputs("</table>\n", file);
}

/* -- HTML -------------------------------------------------------------------------------------------------------------- */

void compare_put_table(FILE *file, const cJSON *report, int32_t reference) {
    line lines[LINES_MAX];
    char text[CELL];
    const int32_t count = make_lines(report, reference, lines), with_rows = reference == COMPARE_EXACT;
    html_table_begin(file);
    fputs("<tr><th class=text>stream</th>", file);
    for (size_t k = 0; k < COLUMNS; k++)
        if (is_shown(&columns[k], reference, 1)) fprintf(file, "<th>%s</th>", columns[k].title);
    fputs(with_rows ? "<th>renders</th><th>seconds</th></tr></thead><tbody>\n" : "</tr></thead><tbody>\n", file);
    for (int32_t i = 0; i < count; i++) {
        if (!lines[i].metrics) continue;
        fputs("<tr><td class=text>", file);
        html_text(file, lines[i].name);
        fputs("</td>", file);
        for (size_t k = 0; k < COLUMNS; k++)
            if (is_shown(&columns[k], reference, 1)) fprintf(file, "<td>%s</td>", cell(&lines[i], &columns[k], text));
        for (int32_t k = 0; with_rows && k < OF_ROWS; k++)
            fprintf(file, "<td>%s</td>", cell_of_row(&lines[i], of_rows[k], text));
        fputs("</tr>\n", file);
    }
    html_table_end(file);
}

/* -- LaTeX ---------------------------------------------------------------------------------------------------------------- */

static void put_escaped(FILE *file, const char *text) {
    for (; *text; text++) {
        if (strchr("%&_#", *text)) putc('\\', file);
        if (*text == '|')
            fputs("$|$", file);
        else
            putc(*text, file);
    }
}

static void put_latex(FILE *file, const void *report) {
    line lines[LINES_MAX];
    char text[CELL];
    const int32_t count = make_lines(report, COMPARE_RECORDING, lines);
    fputs("% made by tides compare; lower is better but for ratios (1) and matched (1)\n\\begin{tabular}{l", file);
    for (size_t k = 0; k < COLUMNS; k++)
        if (is_shown(&columns[k], COMPARE_RECORDING, 0)) putc('r', file);
    fputs("}\n\\hline\n", file);
    for (size_t k = 0; k < COLUMNS; k++) {
        if (!is_shown(&columns[k], COMPARE_RECORDING, 0)) continue;
        fputs(" & ", file);
        put_escaped(file, columns[k].title);
    }
    fputs(" \\\\\n\\hline\n", file);
    for (int32_t i = 0; i < count; i++) {
        if (!lines[i].metrics) continue;
        put_escaped(file, lines[i].name);
        for (size_t k = 0; k < COLUMNS; k++)
            if (is_shown(&columns[k], COMPARE_RECORDING, 0)) fprintf(file, " & %s", cell(&lines[i], &columns[k], text));
        fputs(" \\\\\n", file);
    }
    fputs("\\hline\n\\end{tabular}\n", file);
}

tides_status compare_write_latex(const comparison *c, const cJSON *report, tides_error *error) {
    char path[COMPARE_PATH];
    if (!c->recording_file) return TIDES_OK;
    snprintf(path, sizeof path, "%s/compare.tex", c->directory);
    return cli_write_file(path, put_latex, report, error);
}
