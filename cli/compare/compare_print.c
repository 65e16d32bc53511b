/* Prints a comparison on the terminal: the tables, the meaning of their columns, and each method's settings. */
#include "compare.h"

#include <stdio.h>
#include <string.h>

enum { NAME_WIDTH = 14 };

static int32_t has_own_settings(const comparison *c) { return compare_ideal(c) == TIDES_IDEAL_SENSOR; }

/* 1 where a later setting has the same key, such as one found by a search. */
static int32_t is_replaced(const cJSON *setting) {
    const size_t length = strcspn(setting->valuestring, "=") + 1;
    for (const cJSON *later = setting->next; later; later = later->next)
        if (strncmp(later->valuestring, setting->valuestring, length) == 0) return 1;
    return 0;
}

/* Prints a row's parameters. If the sensor was translated into the method's own parameters, all of these are printed. */
void compare_put_parameters(const comparison *c, const cJSON *row, void (*put)(FILE *file, const char *text), FILE *file) {
    const cJSON *one, *settings = compare_find(row, "settings");
    const char *between = "";
    char text[128];
    if (has_own_settings(c)) {
        cJSON_ArrayForEach(one, settings) {
            if (one == settings->child || is_replaced(one)) continue; /* the first one chooses the method */
            fputs(between, file);
            put(file, one->valuestring);
            between = ", ";
        }
        return;
    }
    cJSON_ArrayForEach(one, compare_find(row, "parameters")) {
        put(file, one->string);
        if (cJSON_IsString(one))
            snprintf(text, sizeof text, " %s", one->valuestring);
        else
            snprintf(text, sizeof text, " %.6g", one->valuedouble);
        put(file, text);
        if (one->next) fputs(", ", file);
    }
}

static void put_plain(FILE *file, const char *text) { fputs(text, file); }

const char *compare_left_out(const comparison *c, char text[COMPARE_SENTENCE]) {
    const tides_blemishes *b = &c->fair.blemishes;
    snprintf(text, COMPARE_SENTENCE,
             "%.9g to %.9g s; of the recording %zu events, without %llu in %zu bursts of frames' readout, %llu of %zu hot "
             "pixels, "
             "%llu masked; the streams likewise. Matches within %.3g ms",
             1e-9 * (double)c->fair.start_ns, 1e-9 * (double)c->fair.stop_ns, c->recording.count,
             (unsigned long long)b->burst_events, b->bursts, (unsigned long long)b->hot_events, b->hots,
             (unsigned long long)c->fair.masked, 1e3 * c->fair.tolerance_s);
    return text;
}

static void print_exact(const comparison *c) {
    const tides_exact *e = &c->exact;
    printf("%-*s %s", NAME_WIDTH, compare_exact_name(c), compare_exact_what(c));
    if (c->session.frames)
        printf(": TIDES's own way, no truth; nobody knows what was between the frames");
    else
        printf(": the last halving moved median %.2g, p95 %.2g, p99 %.2g us, %.2g %% mismatched", e->moved.dt_median_us,
               e->moved.dt_p95_us, e->moved.dt_p99_us, e->moved.mismatch_percent);
    putchar('\n');
}

void compare_print(const comparison *c, const cJSON *report) {
    const cJSON *row;
    char text[COMPARE_SENTENCE];
    if (c->with_exact) compare_print_table(report, COMPARE_EXACT);
    if (c->recording_file) compare_print_table(report, COMPARE_RECORDING);
    compare_print_meanings(c->recording_file ? COMPARE_RECORDING : COMPARE_EXACT);
    cJSON_ArrayForEach(row, compare_find(report, "methods")) {
        if (!compare_find(row, "parameters")) continue;
        printf("%-*s ", NAME_WIDTH, compare_find(row, "method")->valuestring);
        compare_put_parameters(c, row, put_plain, stdout);
        putchar('\n');
    }
    if (c->with_exact) print_exact(c);
    if (c->recording_file) printf("%-*s %s\n", NAME_WIDTH, "compared", compare_left_out(c, text));
    if (c->search)
        printf("%-*s each method's parameters by %d runs, by VP of what is compared here\n", NAME_WIDTH, "searched", c->search);
    printf("%-*s %s\n", NAME_WIDTH, "pixels",
           has_own_settings(c) ? "the run's sensor, in each method's own parameters"
           : c->as_configured  ? "as the run file says"
                               : "ideal, with the run's thresholds (--as-configured takes the run file's)");
    printf("%-*s %s/: index.html, %s%scompare.json, compare.csv%s\n", NAME_WIDTH, "files", c->directory,
           c->with_exact ? "compare.png, " : "", c->recording_file ? "recording.png, " : "",
           c->recording_file ? ", compare.tex" : "");
}
