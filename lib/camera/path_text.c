/* Parses lines of numbers, for the readers of path files that are text. */
#include "camera/td_path_reader.h"

#include "td_base.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Largest deviation of a quaternion's length from 1. Files write unit quaternions with at least four decimals: if the length is
 * off by more than this, the columns have another meaning. */
#define TD_QUATERNION_TOLERANCE 0.05

const char *td_text_skip(const char *c) { return c + strspn(c, " \t\r"); }

int td_text_ends(const char *c) { return *c == '\n' || *c == '\0' || *c == '#'; }

const char *td_text_number(const char *c, double *value) {
    char *end = NULL;
    *value = strtod(c, &end);
    return isfinite(*value) ? end : c;
}

static int columns_of(const char *data, const char *end) {
    int columns = 1;
    for (const char *c = data; c < end; c++) columns += *c == ',';
    return columns;
}

static int decimals_of(const char *data, const char *end) {
    while (end > data && strchr(" \t\r", end[-1])) end--;
    const char *c = end;
    while (c > data && c[-1] >= '0' && c[-1] <= '9') c--;
    return c > data && c[-1] == '.' ? (int)(end - c) : 0;
}

tides_status td_text_take(td_text_lines *lines, const td_path_reader *reader, size_t line, const char *data) {
    enum { ENOUGH = 2 /* lines needed to know what is usual */ };
    const char *end = data + strcspn(data, "#\n");
    const int columns = columns_of(data, end), decimals = decimals_of(data, end);
    const int less = columns < lines->columns || (columns == lines->columns && decimals < lines->decimals);
    if (lines->count >= ENOUGH && lines->alike && less && *end == '\0')
        return td_fail(reader->error, TIDES_BAD_FILE,
                       "%s:%zu: the file ends within this line, as it seems: those before it have %s; if it is whole, end it "
                       "with "
                       "a line break",
                       reader->file, line, columns < lines->columns ? "more columns" : "more decimals");
    if (lines->count == 0) *lines = (td_text_lines){0, columns, decimals, 1};
    lines->alike &= columns == lines->columns && decimals == lines->decimals;
    lines->count++;
    return TIDES_OK;
}

void td_text_time(const char *c, int places, td_path_sample *sample, const char **end) {
    char *after = NULL;
    long long per_second = 1;
    for (int k = 0; k < places; k++) per_second *= 10;
    double value = strtod(c, &after);
    *end = isfinite(value) ? after : c;
    sample->time = places ? value / (double)per_second : value;
    sample->low = 0.0;
    size_t sign = strspn(c, "+-"), digits = strspn(c + sign, "0123456789"), decimals = 0;
    const char *point = c + sign + digits;
    if (*point == '.') decimals = 1 + strspn(point + 1, "0123456789");
    errno = 0;
    long long units = strtoll(c, NULL, 10);
    if (point + decimals != after || errno != 0) return; /* an exponent, or too many digits for 64 bits: the double is kept */
    long long seconds = units / per_second;
    double fraction = decimals > 1 ? strtod(point, NULL) : 0.0;
    double rest = ((double)(units % per_second) + (*c == '-' ? -fraction : fraction)) / (double)per_second;
    sample->low = ((double)seconds - sample->time) + rest;
}

tides_status td_path_check_quaternion(const td_path_reader *reader, const char *where, const double q[4], const char *columns) {
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (fabs(length - 1.0) <= TD_QUATERNION_TOLERANCE) return TIDES_OK;
    return td_fail(reader->error, TIDES_BAD_FILE, "%s%s%s: the quaternion's length is %.4g instead of 1: %s must be %s",
                   reader->file, *where == ':' ? "" : ": ", where, length, *where == ':' ? "columns 5 to 8" : "the numbers",
                   columns);
}

const char *td_path_quote(const char *word, size_t bytes, char out[TD_QUOTE]) {
    size_t length = bytes < TD_QUOTE ? bytes : TD_QUOTE - 1;
    for (size_t i = 0; i < length; i++) {
        unsigned char c = (unsigned char)word[i];
        out[i] = c < ' ' || c == 127 ? '?' : word[i];
    }
    out[length] = '\0';
    return out;
}
