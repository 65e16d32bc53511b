/* Parts of HTML pages with results. */
#include "html.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* -- the page's own ---------------------------------------------------------------------------------------------------- */

static const char *const style[] =
    {":root{color-scheme:light dark;--ink:#1b1d21;--paper:#fff;--soft:#646a73;--line:#dcdfe3;--head:#f3f4f6;--yes:#00704a;"
     "--no:#a33c00}\n",
     "@media(prefers-color-scheme:dark){:root{--ink:#e8eaed;--paper:#111317;--soft:#9aa1ab;--line:#33373f;--head:#1b1e24;"
     "--yes:#4fc79a;--no:#ff9b66}}\n",
     "body{font:15px/1.5 system-ui,sans-serif;margin:2em auto;max-width:76em;padding:0 1em;color:var(--ink);"
     "background:var(--paper)}\n",
     "h1{font-size:1.7em}h2{margin-top:2.2em;border-bottom:1px solid "
     "var(--line)}img{max-width:100%;background:#fff}a{color:inherit}\n",
     "table{border-collapse:collapse;font-size:13px}th,td{padding:.15em .6em;text-align:right;white-space:nowrap;"
     "border-bottom:1px solid var(--line)}\n",
     "th{position:sticky;top:0;background:var(--head);cursor:pointer}th[aria-sort=ascending]::after{content:' \\2191'}"
     "th[aria-sort=descending]::after{content:' \\2193'}\n",
     "td.text,th.text{text-align:left}.wide{overflow:auto;max-height:40em;margin:.6em 0}.yes{color:var(--yes)}"
     ".no{color:var(--no)}.small{color:var(--soft);font-size:13px}\n",
     NULL};

/* A click on a column's head sorts by it, a second one in reverse: numbers as numbers, before texts; empty cells come last. */
static const char *const script[] =
    {"for (const head of document.querySelectorAll('th')) {\n",
     "    const sort = () => {\n",
     "        const up = head.getAttribute('aria-sort') !== 'ascending', body = head.closest('table').tBodies[0];\n",
     "        for (const other of head.parentNode.cells) other.removeAttribute('aria-sort');\n",
     "        head.setAttribute('aria-sort', up ? 'ascending' : 'descending');\n",
     "        const key = (row) => {\n",
     "            const text = row.cells[head.cellIndex]?.textContent.trim() ?? '', number = Number(text);\n",
     "            return text === '' || text === '-' ? [2, 0] : Number.isNaN(number) ? [1, text] : [0, number];\n",
     "        };\n",
     "        const rows = [...body.rows].map((row) => [key(row), row]);\n",
     "        rows.sort(([[a, x]], [[b, y]]) => a - b || (x < y ? -1 : x > y ? 1 : 0) * (up ? 1 : -1));\n",
     "        body.append(...rows.map(([, row]) => row));\n",
     "    };\n",
     "    head.tabIndex = 0;\n",
     "    head.addEventListener('click', sort);\n",
     "    head.addEventListener('keydown', (event) => {\n",
     "        if (event.key === 'Enter' || event.key === ' ') { event.preventDefault(); sort(); }\n",
     "    });\n",
     "}\n",
     NULL};

static void put_lines(FILE *file, const char *const *lines) {
    for (; *lines; lines++) fputs(*lines, file);
}

void html_begin(FILE *file, const char *title) {
    fputs("<!DOCTYPE html>\n<html lang=en><meta charset=utf-8><meta name=viewport content=\"width=device-width\">\n<title>",
          file);
    html_text(file, title);
    fputs("</title><style>\n", file);
    put_lines(file, style);
    fputs("</style>\n<h1>", file);
    html_text(file, title);
    fputs("</h1>\n", file);
}

void html_end(FILE *file) {
    fputs("<script>\n", file);
    put_lines(file, script);
    fputs("</script>\n</html>\n", file);
}

void html_text(FILE *file, const char *text) {
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

/* -- pictures ---------------------------------------------------------------------------------------------------------- */

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

void html_picture(FILE *file, const char *directory, const char *name) {
    char path[4500];
    size_t size = 0;
    snprintf(path, sizeof path, "%s/%s", directory, name);
    char *bytes = cli_read_file(path, &size);
    if (!bytes) return;
    fputs("<p><img alt=\"", file);
    html_text(file, name);
    fprintf(file, "\" src=\"data:image/%s;base64,", cli_ends_in(name, ".svg") ? "svg+xml" : "png");
    put_base64(file, (const unsigned char *)bytes, size);
    fputs("\"></p>\n", file);
    free(bytes);
}

/* -- tables ------------------------------------------------------------------------------------------------------------ */

static void html_cell(FILE *file, const cJSON *value) {
    if (cJSON_IsString(value)) {
        fputs("<td class=text>", file);
        html_text(file, value->valuestring);
    } else if (cJSON_IsNumber(value)) {
        fprintf(file, fabs(value->valuedouble) < 1e6 ? "<td>%.5g" : "<td>%.4g", value->valuedouble);
    } else if (cJSON_IsBool(value)) {
        fputs(cJSON_IsTrue(value) ? "<td>yes" : "<td>no", file);
    } else {
        fputs("<td>", file);
    }
    fputs("</td>", file);
}

void html_table_begin(FILE *file) { fputs("<div class=wide><table><thead>", file); }
void html_table_end(FILE *file) { fputs("</tbody></table></div>\n", file); }

static int is_plain(const cJSON *value) { return !cJSON_IsArray(value) && !cJSON_IsObject(value); }

void html_table(FILE *file, const cJSON *rows) {
    const cJSON *first = cJSON_GetArrayItem(rows, 0), *row, *cell;
    if (!cJSON_IsObject(first)) return;
    html_table_begin(file);
    fputs("<tr>", file);
    cJSON_ArrayForEach(cell, first) {
        if (!is_plain(cell)) continue;
        fputs(cJSON_IsString(cell) ? "<th class=text>" : "<th>", file);
        html_text(file, cell->string);
        fputs("</th>", file);
    }
    fputs("</tr></thead><tbody>\n", file);
    cJSON_ArrayForEach(row, rows) {
        fputs("<tr>", file);
        cJSON_ArrayForEach(cell, first) {
            if (is_plain(cell)) html_cell(file, cJSON_GetObjectItemCaseSensitive(row, cell->string));
        }
        fputs("</tr>\n", file);
    }
    html_table_end(file);
}
