/* Makes the page of results from the files that benchmarks write: NAME.json as tables, NAME.png and NAME_*.png as data within
 * the page, so that it can be sent as one file. */
#include "bench_page.h"

#include "html.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PICTURES_MAX = 8 };

/* -- files ---------------------------------------------------------------------------------------------------------------- */

static cJSON *read_results(const bench *b, const char *name) {
    char path[4200];
    size_t size = 0;
    tides_error ignored;
    if (bench_path(b, name, ".json", path, sizeof path, &ignored) != TIDES_OK) return NULL;
    char *text = cli_read_file(path, &size);
    cJSON *json = text ? cJSON_ParseWithLength(text, size) : NULL;
    free(text);
    return json;
}

static int by_name(const void *a, const void *b) { return strcmp(a, b); }

/* Finds NAME.png and NAME_*.png, sorted by name, and returns their number. */
static int32_t find_pictures(const bench *b, const char *name, char pictures[PICTURES_MAX][256]) {
    int32_t count = 0;
    const size_t length = strlen(name);
    DIR *folder = opendir(b->directory);
    for (struct dirent *entry; folder && count < PICTURES_MAX && (entry = readdir(folder)) != NULL;) {
        const char *end = entry->d_name + length;
        if (strncmp(entry->d_name, name, length) != 0 || !cli_ends_in(entry->d_name, ".png")) continue;
        if (*end == '.' || *end == '_') snprintf(pictures[count++], sizeof pictures[0], "%.255s", entry->d_name);
    }
    if (folder) closedir(folder);
    qsort(pictures, (size_t)count, sizeof pictures[0], by_name);
    return count;
}

/* -- a benchmark ---------------------------------------------------------------------------------------------------------- */

static const char *text_of(const cJSON *json, const char *key) {
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, key));
    return text ? text : "";
}

static void put_target(FILE *file, const cJSON *target) {
    const cJSON *reached = cJSON_GetObjectItemCaseSensitive(target, "reached");
    const cJSON *measured = cJSON_GetObjectItemCaseSensitive(target, "measured");
    fputs("<tr><td class=text>", file);
    html_text(file, text_of(target, "target"));
    fputs("</td><td class=text>", file);
    html_text(file, text_of(target, "of"));
    fputs("</td>", file);
    if (cJSON_IsNumber(measured))
        fprintf(file, "<td>%.3g</td>", measured->valuedouble);
    else
        fputs("<td></td>", file);
    fprintf(file, "<td class=text>%s %g ", text_of(target, "is"),
            cJSON_GetNumberValue(cJSON_GetObjectItemCaseSensitive(target, "bound")));
    html_text(file, text_of(target, "unit"));
    fputs(cJSON_IsTrue(reached)    ? "</td><td class=\"text yes\">reached"
          : cJSON_IsFalse(reached) ? "</td><td class=\"text no\">not yet"
                                   : "</td><td class=text>",
          file);
    fputs("</td><td class=\"text small\">", file);
    html_text(file, text_of(target, "note"));
    fputs("</td></tr>\n", file);
}

static void put_targets(FILE *file, const cJSON *targets) {
    const cJSON *target;
    if (cJSON_GetArraySize(targets) == 0) return;
    fputs("<h3>Targets</h3>", file);
    html_table_begin(file);
    fputs("<tr><th class=text>target</th><th class=text>of</th><th>measured</th><th class=text>is to be</th>"
          "<th class=text>reached</th><th class=text>note</th></tr></thead><tbody>\n",
          file);
    cJSON_ArrayForEach(target, targets) { put_target(file, target); }
    html_table_end(file);
}

static void put_pictures(FILE *file, const bench *b, const char *name) {
    char pictures[PICTURES_MAX][256];
    const int32_t count = find_pictures(b, name, pictures);
    for (int32_t i = 0; i < count; i++) html_picture(file, b->directory, pictures[i]);
}

static void put_benchmark(FILE *file, const bench *b, const bench_entry *of, const cJSON *json) {
    const char *name = of->name;
    fprintf(file, "<h2 id=\"%s\">%s</h2>\n<p>%s</p>\n<p class=small>tides %s on ", name, name, of->sentence,
            text_of(json, "version"));
    html_text(file, text_of(json, "device"));
    fprintf(file, ", %g cores, %s%s</p>\n", cJSON_GetNumberValue(cJSON_GetObjectItemCaseSensitive(json, "cores")),
            text_of(json, "date"),
            cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(json, "quick")) ? ", --quick: a look, not a measurement" : "");
    put_targets(file, cJSON_GetObjectItemCaseSensitive(json, "targets"));
    put_pictures(file, b, name);
    const cJSON *results = cJSON_GetObjectItemCaseSensitive(json, "results");
    fprintf(file, "<details><summary>All %d rows (also in %s.json and %s.csv)</summary>\n", cJSON_GetArraySize(results), name,
            name);
    html_table(file, results);
    fputs("</details>\n", file);
}

/* -- the page ------------------------------------------------------------------------------------------------------------- */

typedef struct page {
    const bench *b;
    const bench_list *all;
} page;

static void put_page(FILE *file, const void *what) {
    const page *p = what;
    html_begin(file, "tides bench");
    fputs("<p>Event cameras simulated in continuous time from Gaussian splats: what is measured of it, on this machine.</p>\n",
          file);
    for (size_t i = 0; i < p->all->count; i++) {
        cJSON *json = read_results(p->b, p->all->entry[i].name);
        if (json) put_benchmark(file, p->b, &p->all->entry[i], json);
        cJSON_Delete(json);
    }
    html_end(file);
}

tides_status bench_page(const bench *b, const bench_list *all, tides_error *error) {
    const page p = {b, all};
    char path[4200];
    tides_status status = bench_path(b, "index", ".html", path, sizeof path, error);
    return status == TIDES_OK ? cli_write_file(path, put_page, &p, error) : status;
}
