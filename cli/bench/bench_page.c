/* The page is made of the files that benchmarks leave: NAME.json as tables, NAME.png and NAME_*.png within the text as data, so
 * that it can be sent and kept by itself. */
#include "bench_page.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PICTURES_MAX = 8, COLUMNS_MAX = BENCH_CELLS_MAX };

static const char *const style =
    "body{font:15px/1.5 system-ui,sans-serif;margin:2em auto;max-width:76em;padding:0 1em;color:#1b1b1b}"
    "h1{font-size:1.7em}h2{margin-top:2.2em;border-bottom:1px solid #ccc}img{max-width:100%}"
    "table{border-collapse:collapse;font-size:13px}th,td{padding:.15em .6em;text-align:right;white-space:nowrap;"
    "border-bottom:1px solid #e4e4e4}th{position:sticky;top:0;background:#f4f4f4}td.text,th.text{text-align:left}"
    ".wide{overflow:auto;max-height:40em;margin:.6em 0}.yes{color:#00704a}.no{color:#a33c00}.small{color:#666;font-size:13px}";

/* What each benchmark is about. */
typedef struct chapter {
    const char *name, *sentence;
} chapter;
static const chapter chapters[] = {
    {"accuracy", "Run time against the error of event times: methods and settings, each against its image's exact events."},
    {"ablation", "What each part of the method is worth, and what masking and a readout change."},
    {"blocks", "What each block of the sensor and of the readout costs, alone."},
    {"determinism", "The same runs made in different ways, and one SHA-256 for each run."},
    {"image", "What each measure that makes the image continuous in time is worth, and what it costs."},
    {"scaling", "How cost grows with Gaussians, pixels, events, layers, what moves, speed and threads."},
    {"stability", "Worlds made to break the simulator, and whether they do."},
    {"throughput", "What each stage takes, beside the same image in plain C made for the machine: the limit."},
};

static const char *sentence_of(const char *name) {
    for (size_t i = 0; i < sizeof chapters / sizeof *chapters; i++)
        if (strcmp(chapters[i].name, name) == 0) return chapters[i].sentence;
    return "";
}

/* -- files ---------------------------------------------------------------------------------------------------------------- */

/* All of a file, a 0 behind it; NULL where it can't be read. */
static char *read_all(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    char *bytes = NULL;
    const long end = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    if (end >= 0 && fseek(file, 0, SEEK_SET) == 0 && (bytes = malloc((size_t)end + 1)) != NULL) {
        *size = fread(bytes, 1, (size_t)end, file);
        bytes[*size] = 0;
    }
    fclose(file);
    return bytes;
}

static cJSON *read_results(const bench *b, const char *name) {
    char path[4200];
    size_t size = 0;
    tides_error ignored;
    if (bench_path(b, name, ".json", path, sizeof path, &ignored) != TIDES_OK) return NULL;
    char *text = read_all(path, &size);
    cJSON *json = text ? cJSON_ParseWithLength(text, size) : NULL;
    free(text);
    return json;
}

static int by_name(const void *a, const void *b) { return strcmp(a, b); }

/* NAME.png and NAME_*.png, in the order of their names; how many. */
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

/* -- text ----------------------------------------------------------------------------------------------------------------- */

static void put_text(FILE *file, const char *text) {
    for (; *text; text++)
        if (*text == '<')
            fputs("&lt;", file);
        else if (*text == '&')
            fputs("&amp;", file);
        else if (*text == '"')
            fputs("&quot;", file);
        else
            putc(*text, file);
}

static void put_base64(FILE *file, const unsigned char *bytes, size_t size) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        const size_t left = size - i;
        const uint32_t three =
            (uint32_t)bytes[i] << 16 | (left > 1 ? (uint32_t)bytes[i + 1] << 8 : 0) | (left > 2 ? bytes[i + 2] : 0u);
        putc(digits[three >> 18], file);
        putc(digits[three >> 12 & 63], file);
        putc(left > 1 ? digits[three >> 6 & 63] : '=', file);
        putc(left > 2 ? digits[three & 63] : '=', file);
    }
}

/* A cell that tells its kind by where it stands. */
static void put_value(FILE *file, const cJSON *value) {
    if (cJSON_IsString(value)) {
        fputs("<td class=text>", file);
        put_text(file, value->valuestring);
    } else if (cJSON_IsNumber(value)) {
        fprintf(file, fabs(value->valuedouble) < 1e6 ? "<td>%.5g" : "<td>%.4g", value->valuedouble);
    } else if (cJSON_IsBool(value)) {
        fputs(cJSON_IsTrue(value) ? "<td>yes" : "<td>no", file);
    } else {
        fputs("<td>", file);
    }
    fputs("</td>", file);
}

/* -- a benchmark ---------------------------------------------------------------------------------------------------------- */

/* An array of flat objects; the first one's keys are the columns. */
static void put_table(FILE *file, const cJSON *rows) {
    const cJSON *first = cJSON_GetArrayItem(rows, 0), *row, *cell;
    if (!cJSON_IsObject(first)) return;
    fputs("<div class=wide><table><tr>", file);
    cJSON_ArrayForEach(cell, first) {
        if (cJSON_IsArray(cell) || cJSON_IsObject(cell)) continue;
        fputs(cJSON_IsString(cell) ? "<th class=text>" : "<th>", file);
        put_text(file, cell->string);
        fputs("</th>", file);
    }
    fputs("</tr>\n", file);
    cJSON_ArrayForEach(row, rows) {
        fputs("<tr>", file);
        cJSON_ArrayForEach(cell, first) {
            if (!cJSON_IsArray(cell) && !cJSON_IsObject(cell))
                put_value(file, cJSON_GetObjectItemCaseSensitive(row, cell->string));
        }
        fputs("</tr>\n", file);
    }
    fputs("</table></div>\n", file);
}

static const char *text_of(const cJSON *json, const char *key) {
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, key));
    return text ? text : "";
}

static void put_target(FILE *file, const cJSON *target) {
    const cJSON *reached = cJSON_GetObjectItemCaseSensitive(target, "reached");
    const cJSON *measured = cJSON_GetObjectItemCaseSensitive(target, "measured");
    fputs("<tr><td class=text>", file);
    put_text(file, text_of(target, "target"));
    fputs("</td><td class=text>", file);
    put_text(file, text_of(target, "of"));
    fputs("</td>", file);
    if (cJSON_IsNumber(measured))
        fprintf(file, "<td>%.3g</td>", measured->valuedouble);
    else
        fputs("<td></td>", file);
    fprintf(file, "<td class=text>%s %g ", text_of(target, "is"),
            cJSON_GetNumberValue(cJSON_GetObjectItemCaseSensitive(target, "bound")));
    put_text(file, text_of(target, "unit"));
    fputs(cJSON_IsTrue(reached)    ? "</td><td class=\"text yes\">reached"
          : cJSON_IsFalse(reached) ? "</td><td class=\"text no\">not yet"
                                   : "</td><td class=text>",
          file);
    fputs("</td><td class=\"text small\">", file);
    put_text(file, text_of(target, "note"));
    fputs("</td></tr>\n", file);
}

static void put_targets(FILE *file, const cJSON *targets) {
    const cJSON *target;
    if (cJSON_GetArraySize(targets) == 0) return;
    fputs("<h3>Targets</h3><div class=wide><table><tr><th class=text>target</th><th class=text>of</th><th>measured</th>"
          "<th class=text>is to be</th><th class=text></th><th></th></tr>\n",
          file);
    cJSON_ArrayForEach(target, targets) { put_target(file, target); }
    fputs("</table></div>\n", file);
}

static void put_pictures(FILE *file, const bench *b, const char *name) {
    char pictures[PICTURES_MAX][256];
    const int32_t count = find_pictures(b, name, pictures);
    for (int32_t i = 0; i < count; i++) {
        char path[4500];
        size_t size = 0;
        snprintf(path, sizeof path, "%s/%s", b->directory, pictures[i]);
        char *bytes = read_all(path, &size);
        if (!bytes) continue;
        fputs("<p><img alt=\"", file);
        put_text(file, pictures[i]);
        fputs("\" src=\"data:image/png;base64,", file);
        put_base64(file, (const unsigned char *)bytes, size);
        fputs("\"></p>\n", file);
        free(bytes);
    }
}

static void put_benchmark(FILE *file, const bench *b, const char *name, const cJSON *json) {
    fprintf(file, "<h2 id=\"%s\">%s</h2>\n<p>%s</p>\n<p class=small>tides %s on ", name, name, sentence_of(name),
            text_of(json, "version"));
    put_text(file, text_of(json, "device"));
    fprintf(file, ", %g cores, %s%s</p>\n", cJSON_GetNumberValue(cJSON_GetObjectItemCaseSensitive(json, "cores")),
            text_of(json, "date"),
            cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(json, "quick")) ? ", --quick: a look, not a measurement" : "");
    put_targets(file, cJSON_GetObjectItemCaseSensitive(json, "targets"));
    put_pictures(file, b, name);
    const cJSON *results = cJSON_GetObjectItemCaseSensitive(json, "results");
    fprintf(file, "<details><summary>All %d rows (also in %s.json and %s.csv)</summary>\n", cJSON_GetArraySize(results), name,
            name);
    put_table(file, results);
    fputs("</details>\n", file);
}

/* -- the page ------------------------------------------------------------------------------------------------------------- */

typedef struct page {
    const bench *b;
    const char *const *names;
} page;

static void put_page(FILE *file, const void *what) {
    const page *p = what;
    fprintf(file,
            "<!DOCTYPE html>\n<html lang=en><meta charset=utf-8><meta name=viewport content=\"width=device-width\">\n"
            "<title>tides bench</title><style>%s</style>\n<h1>tides bench</h1>\n"
            "<p>Event cameras simulated in continuous time from Gaussian splats: what is measured of it, on this "
            "machine.</p>\n",
            style);
    for (const char *const *name = p->names; *name; name++) {
        cJSON *json = read_results(p->b, *name);
        if (json) put_benchmark(file, p->b, *name, json);
        cJSON_Delete(json);
    }
    fputs("</html>", file);
}

tides_status bench_page(const bench *b, const char *const *names, tides_error *error) {
    const page p = {b, names};
    char path[4200];
    tides_status status = bench_path(b, "index", ".html", path, sizeof path, error);
    return status == TIDES_OK ? cli_write_file(path, put_page, &p, error) : status;
}
