/* Finds the times of frames: from a text file, a rate, or the array file itself. */
#include "td_frames.h"

#include "td_columns.h"
#include "td_folder.h"
#include "td_kinds.h"
#include "td_math.h"
#include "td_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Largest size of a text of times: more is another kind of file. */
#define TIMES_BYTES_MAX ((size_t)1 << 28)

/* -- text ----------------------------------------------------------------------------------------------------------------- */

enum { COLUMNS = 8, WORD = 64, LINE = 1024 }; /* columns that are judged; room for a word and for a line [bytes] */

/* Facts about a list of times, column by column. */
typedef struct times_text {
    /* number of rows; of those with a number in the column; of those where it is the row's own index */
    size_t rows, numbers[COLUMNS], counting[COLUMNS];
    double first[COLUMNS];
    int column; /* column of the times, from a header or from the numbers; -1: none */
    int digits; /* 10^digits [ns] is the header's unit; -1: no unit */
} times_text;

/* Copies the next line without its end (LF, CR LF or CR). A line that is too long comes in pieces. */
static int next_line(const char **at, char line[LINE]) {
    size_t length = strcspn(*at, "\r\n");
    if (!**at) return 0;
    if (length >= LINE) length = LINE - 1;
    memcpy(line, *at, length);
    line[length] = '\0';
    *at += length;
    if (**at == '\r' && (*at)[1] == '\n') ++*at;
    if (**at == '\r' || **at == '\n') ++*at;
    return 1;
}

/* Reads word number `column` of a line; 1 if it is a number. */
static int take_number(const char *line, int column, double *value) {
    static const char between[] = " \t,;\"'";
    char word[WORD], *end = NULL;
    for (line += strspn(line, between); column > 0 && *line; column--) {
        line += strcspn(line, between);
        line += strspn(line, between);
    }
    const size_t length = strcspn(line, between);
    if (length == 0 || length >= sizeof word) return 0;
    memcpy(word, line, length);
    word[length] = '\0';
    *value = strtod(word, &end);
    return !*end && isfinite(*value);
}

/* Finds the column that a header names as times; `*digits` is -1 if it has no unit. */
static int header_column(const char *line, int *digits) {
    td_columns named;
    if (!td_columns_parse(line, &named)) return -1;
    const int column = td_columns_time(&named, "t|time|timestamp|ts|times|timestamps|stamp|start|*timestamp", digits);
    return column < COLUMNS ? column : -1;
}

static int is_aside(const char *line) {
    line += strspn(line, " \t");
    return !*line || *line == '#' || *line == '%';
}

static void take_row(times_text *t, const char *line) {
    for (int c = 0; c < COLUMNS; c++) {
        double value;
        if (!take_number(line, c, &value)) continue;
        if (t->numbers[c]++ == 0) t->first[c] = value;
        t->counting[c] += (t->first[c] == 0 || t->first[c] == 1) && value == t->first[c] + (double)t->rows;
    }
    t->rows++;
}

/* Chooses the first column of numbers; a column that counts 0, 1, 2 is skipped as an index if there is another one. */
static void choose_column(times_text *t) {
    int index = -1;
    for (int c = 0; c < COLUMNS && t->column < 0; c++) {
        if (t->numbers[c] != t->rows) continue;
        if (t->counting[c] == t->rows && t->rows > 1 && index < 0)
            index = c;
        else
            t->column = c;
    }
    if (t->column < 0) t->column = index;
}

static void look_through(times_text *t, const char *text) {
    char line[LINE];
    *t = (times_text){.column = -1, .digits = -1};
    while (next_line(&text, line)) {
        int digits;
        const int found = t->rows == 0 ? header_column(line, &digits) : -1;
        if (found >= 0) {
            t->column = found;
            t->digits = digits;
        } else if (!is_aside(line))
            take_row(t, line);
    }
    if (t->column < 0) choose_column(t);
}

static tides_status read_lines(tides_frames *frames, const char *file, const char *text, const times_text *t,
                               tides_error *error) {
    size_t count = 0;
    char line[LINE];
    for (size_t number = 1; next_line(&text, line); number++) {
        double value = 0;
        int digits;
        if (is_aside(line) || (count == 0 && header_column(line, &digits) >= 0)) continue;
        /* If no column has a number in all rows, each row's first number is taken, and a row without a number is an error. */
        int column = t->column < 0 ? 0 : t->column;
        while (t->column < 0 && column < COLUMNS && !take_number(line, column, &value)) column++;
        if (!take_number(line, column, &value))
            return td_fail(error, TIDES_BAD_FILE, "%s:%zu: there is no time in this line; write one number per line", file,
                           number);
        if (count < frames->count) frames->times[count] = value;
        count++;
    }
    if (count == frames->count) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: has %zu times, but %s has %zu frames", file, count, frames->path, frames->count);
}

/* Refuses times 0, 1, 2 ...: they may be seconds, but are mostly numbers of frames. */
static tides_status check_counting(const tides_frames *frames, const char *file, const times_text *t, tides_error *error) {
    if (t->column < 0 || t->rows < 3 || t->digits >= 0 || frames->options.unit != TIDES_TIME_AUTO) return TIDES_OK;
    if (t->counting[t->column] != t->rows) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE,
                   "%s: its times count frames, %g, %g ...: frames.frames_per_second says how often they come; "
                   "frames.timestamps_unit = s says that these are seconds",
                   file, t->first[t->column], t->first[t->column] + 1);
}

static tides_status read_file(tides_frames *frames, const char *file, tides_error *error) {
    char *text = NULL;
    size_t bytes = 0;
    tides_status status = td_read_file(file, TIMES_BYTES_MAX, &text, &bytes, error);
    if (status != TIDES_OK) return status;
    td_plain_numbers numbers;
    status = td_plain_begin(&numbers, file, error);
    if (status == TIDES_OK) {
        times_text t;
        const char *start = strncmp(text, "\xEF\xBB\xBF", 3) == 0 ? text + 3 : text;
        look_through(&t, start);
        status = check_counting(frames, file, &t, error);
        if (status == TIDES_OK) status = td_kind_judge(file, TD_WANTS_TEXT, read_lines(frames, file, start, &t, error), error);
        const char *name = td_base_name(file); /* files called as in DSEC and EDS have microseconds */
        const int known = strstr(name, "image_timestamps") || strstr(name, "images_timestamps");
        frames->digits = t.digits < 0 && known ? 3 : t.digits;
        frames->stored = 1;
        td_plain_end(&numbers);
    }
    free(text);
    return status;
}

/* Finds a file of timestamps in the folder, or beside the folder or file; NULL if there is none. */
static char *find_file(const char *path, tides_error *error, tides_status *status) {
    static const char *const names[] = {"timestamps.txt",    "image_timestamps.txt",    "timestamp.txt",
                                        "../timestamps.txt", "../image_timestamps.txt", "../images_timestamps.txt",
                                        "../images.txt",     "../../timestamps.txt",    "../../image_timestamps.txt"};
    const int folder = td_is_folder(path);
    *status = TIDES_OK;
    for (size_t i = 0; i < (folder ? sizeof names / sizeof *names : 2u); i++) {
        char *file = folder ? td_format(error, "%s/%s", path, names[i]) : td_beside(path, names[i], error);
        if (!file) {
            *status = TIDES_NO_MEMORY;
            return NULL;
        }
        if (td_is_file(file)) return file;
        free(file);
    }
    return NULL;
}

static tides_status fill(tides_frames *frames, tides_error *error) {
    const tides_frames_options *o = &frames->options;
    const int own = frames->times != NULL;
    if (!own && !(frames->times = td_alloc(frames->count, sizeof *frames->times, error))) return TIDES_NO_MEMORY;
    if (o->timestamps) return read_file(frames, o->timestamps, error);
    if (o->frames_per_second > 0) {
        for (size_t k = 0; k < frames->count; k++) frames->times[k] = (double)k / o->frames_per_second;
        frames->stored = 0;
        return TIDES_OK;
    }
    if (own) return TIDES_OK;
    tides_status status;
    char *file = find_file(frames->path, error, &status);
    if (status != TIDES_OK) return status;
    status = file ? read_file(frames, file, error)
                  : td_fail(error, TIDES_BAD_CONFIG,
                            "%s: its frames have no times: give frames.timestamps or frames.frames_per_second, or put a "
                            "timestamps.txt there",
                            frames->path);
    free(file);
    return status;
}

/* Decimal digits of the unit: given, or from the header, or the one in which frames come 1 to 1000 times a second. */
static int unit_digits(const tides_frames *frames) {
    static const int digits[] = {[TIDES_TIME_S] = 9, [TIDES_TIME_MS] = 6, [TIDES_TIME_US] = 3, [TIDES_TIME_NS] = 0};
    const size_t count = frames->count;
    if (frames->options.unit != TIDES_TIME_AUTO) return digits[frames->options.unit];
    if (frames->digits >= 0) return frames->digits;
    const double first = frames->times[0], last = frames->times[count - 1];
    return td_likely_digits(fmax(fabs(first), fabs(last)), count > 1 ? (last - first) / (double)(count - 1) : 0);
}

/* Converts times to seconds. It divides by a power of ten when possible: 1e-6 isn't exact in a double, but 1e6 is. */
static void to_seconds(tides_frames *frames) {
    const double per_second = round(td_pow(10, 9 - unit_digits(frames)));
    for (size_t k = 0; k < frames->count; k++) frames->times[k] /= per_second;
}

tides_status td_frames_times(tides_frames *frames, tides_error *error) {
    frames->digits = -1;
    tides_status status = fill(frames, error);
    if (status != TIDES_OK) return status;
    if (frames->stored) to_seconds(frames);
    const double first = (frames->options.rebase ? frames->times[0] : 0) - frames->options.offset_s;
    for (size_t k = 0; k < frames->count; k++) {
        if (!isfinite(frames->times[k]) || (k > 0 && !(frames->times[k] - first > frames->times[k - 1])))
            return td_fail(error, TIDES_BAD_FILE,
                           "%s: frame %zu is at %.15g s, which isn't after the one before: times ascend, with a point for "
                           "decimals",
                           frames->path, k, frames->times[k]);
        frames->times[k] -= first;
    }
    return TIDES_OK;
}
