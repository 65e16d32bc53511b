/* Finds when a recording's frames begin, for event files that don't say it: in the list of times beside them, as ECD and EDS
 * have. frames.rebase counts times from the first frame, so rebased events must do so, too. */
#include "td_event_format.h"
#include "td_event_rows.h"

#include "td_base.h"
#include "td_folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WORDS_MOST = 4 /* a time, a picture, little else; COLMAP's images.txt has ten */, LOOKED = 64 };

/* The first rows of a list. */
typedef struct list {
    int rows, column, digits; /* digits: of the header's unit; -1: none */
    char word[2][64];         /* the texts in the column of times */
} list;

/* The column of times in the first row of a list without a header; -1: none. It is the first number, or the second one if the
 * first number counts frames: that is 0 or 1 without decimals. */
static int find_column(char *const words[], int count) {
    double value;
    int decimals, found = -1;
    for (int i = 0; i < count; i++) {
        if (!td_event_value(words[i], &value, &decimals)) continue;
        if (found < 0 || (found == 0 && decimals == 0 && i == 1)) found = i;
        if (i == 0 && (decimals || (value != 0 && value != 1))) return 0;
    }
    return found;
}

/* Takes a line; 0 if it isn't from a list of frames. */
static int take_line(list *l, char *line) {
    td_columns named;
    char *words[TD_TABLE_COLUMNS_MAX];
    int digits;
    if (l->rows == 0 && td_columns_parse(line, &named)) {
        const int column = td_columns_time(&named, "t|time|timestamp|timestamps|*stamp", &digits);
        if (column >= 0) l->column = column, l->digits = digits;
        return td_event_is_aside(line) || column >= 0;
    }
    if (td_event_is_aside(line)) return 1;
    const int count = td_event_split(line, strchr(line, ',') ? ',' : ' ', words);
    if (l->column < 0) l->column = find_column(words, count);
    if (count > WORDS_MOST || l->column < 0 || l->column >= count) return 0;
    snprintf(l->word[l->rows++], sizeof l->word[0], "%s", words[l->column]);
    return 1;
}

/* Reads the first time in a list; 0 if there is none. `usual`: 10^usual ns is the unit in lists of this file name; -1: the unit
 * is found from the values. */
static int first_time(const char *path, int usual, int64_t *ns) {
    list l = {.column = -1, .digits = -1};
    char line[TD_ROW_LINE];
    double value[2];
    int decimals[2], sound = 1;
    FILE *file = fopen(path, "r");
    if (!file) return 0;
    for (int k = 0; k < LOOKED && sound && l.rows < 2 && fgets(line, sizeof line, file); k++) {
        line[strcspn(line, "\r\n")] = '\0';
        sound = take_line(&l, line);
    }
    fclose(file);
    if (!sound || l.rows < 2 || !td_event_value(l.word[0], &value[0], &decimals[0]) ||
        !td_event_value(l.word[1], &value[1], &decimals[1]) || !(value[1] > value[0]))
        return 0;
    const int digits = l.digits >= 0 ? l.digits : usual >= 0 ? usual : td_likely_digits(fabs(value[1]), value[1] - value[0]);
    return td_decimal(l.word[0], strlen(l.word[0]), digits, ns);
}

int td_event_first_frame(const char *path, int64_t *ns) {
    static const struct {
        const char *name;
        int digits;
    } lists[] = {{"images.txt", -1}, {"images_timestamps.txt", 3}, {"image_timestamps.txt", 3}};
    const int folder = td_is_folder(path);
    int found = 0;
    for (size_t i = 0; !found && i < sizeof lists / sizeof *lists; i++) {
        char *file = folder ? td_format(NULL, "%s/%s", path, lists[i].name) : td_beside(path, lists[i].name, NULL);
        if (file && td_is_file(file)) found = first_time(file, lists[i].digits, ns);
        free(file);
    }
    return found;
}
