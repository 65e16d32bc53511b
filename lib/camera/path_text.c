/* TUM text (`t tx ty tz qx qy qz qw`, seconds, blanks between) and ESIM csv (`t, x, y, z, qx, qy, qz, qw`, nanoseconds,
 * commas between); '#' starts a comment. Both hold body-to-world poses and are told apart by the comma. */
#include "camera/td_path_reader.h"

#include "camera/td_rotation.h"
#include "td_base.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TD_COLUMNS 8

static const char *const column_names[TD_COLUMNS] = {"time", "x", "y", "z", "qx", "qy", "qz", "qw"};

/* Files write unit quaternions with four decimals or more; a length beyond this says that the columns are others. */
#define TD_QUATERNION_TOLERANCE 0.05

/* An ESIM file shorter than this was written in seconds. */
#define TD_SHORTEST_ESIM 1e-6 /* [s] */

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
    enum { ENOUGH = 2 /* lines that say what is usual */ };
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

static tides_status fail_column(const td_path_reader *reader, size_t line, int column, const char *at) {
    char word[TD_QUOTE];
    return td_fail(reader->error, TIDES_BAD_FILE, "%s:%zu: column %d (%s) must be a finite number, not \"%s\"", reader->file,
                   line, column + 1, column_names[column], td_path_quote(at, strcspn(at, " \t\r\n,"), word));
}

void td_text_time(const char *c, int nanoseconds, td_path_sample *sample, const char **end) {
    char *after = NULL;
    double value = strtod(c, &after);
    *end = isfinite(value) ? after : c;
    sample->time = nanoseconds ? value / 1e9 : value;
    sample->low = 0.0;
    size_t sign = strspn(c, "+-"), digits = strspn(c + sign, "0123456789"), decimals = 0;
    const char *point = c + sign + digits;
    if (*point == '.') decimals = 1 + strspn(point + 1, "0123456789");
    errno = 0;
    long long units = strtoll(c, NULL, 10), per_second = nanoseconds ? 1000000000 : 1;
    if (point + decimals != after || errno != 0) return; /* an exponent, or too long for 64 bits: the double must do */
    long long seconds = units / per_second;
    double fraction = decimals > 1 ? strtod(point, NULL) : 0.0;
    double rest = ((double)(units % per_second) + (*c == '-' ? -fraction : fraction)) / (double)per_second;
    sample->low = ((double)seconds - sample->time) + rest;
}

/* Seven numbers after the time. */
static void set_pose(const double v[TD_COLUMNS], tides_pose_sample *pose) {
    memcpy(pose->position, v + 1, sizeof pose->position);
    pose->quaternion[0] = v[7]; /* the files write w last */
    memcpy(pose->quaternion + 1, v + 4, 3 * sizeof *v);
}

/* Eight numbers of one line. */
static tides_status read_line(const td_path_reader *reader, const char *c, int commas, td_path_sample *sample) {
    double v[TD_COLUMNS] = {0};
    int column = 0;
    size_t line = sample->place;
    for (c = td_text_skip(c); !td_text_ends(c) && column < TD_COLUMNS; column++) {
        const char *end = c;
        if (column == 0)
            td_text_time(c, commas, sample, &end);
        else
            end = td_text_number(c, v + column);
        const char *next = td_text_skip(end);
        if (end == c || (!td_text_ends(next) && (commas ? *next != ',' : next == end)))
            return fail_column(reader, line, column, c);
        c = commas && *next == ',' ? td_text_skip(next + 1) : next;
    }
    set_pose(v, &sample->pose);
    if (column == TD_COLUMNS && td_text_ends(c)) return TIDES_OK;
    return td_fail(reader->error, TIDES_BAD_FILE, "%s:%zu: %s than 8 columns; %s has %s", reader->file, line,
                   column < TD_COLUMNS ? "fewer" : "more", commas ? "an ESIM csv" : "a TUM file",
                   commas ? "t_ns, x, y, z, qx, qy, qz, qw" : "t tx ty tz qx qy qz qw");
}

tides_status td_path_check_quaternion(const td_path_reader *reader, const char *where, const double q[4], const char *columns) {
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (fabs(length - 1.0) <= TD_QUATERNION_TOLERANCE) return TIDES_OK;
    return td_fail(reader->error, TIDES_BAD_FILE, "%s%s%s: the quaternion's length is %.4g instead of 1: %s must be %s",
                   reader->file, *where == ':' ? "" : ": ", where, length, *where == ':' ? "columns 5 to 8" : "the numbers",
                   columns);
}

tides_status td_path_read_text(td_path_reader *reader) {
    int commas = -1; /* known from the first line with data on */
    size_t line = 1;
    td_text_lines lines = {0};
    char where[32];
    for (const char *c = reader->text; *c; line++) {
        const char *end = c + strcspn(c, "\n"), *data = td_text_skip(c);
        if (!td_text_ends(data)) {
            if (commas < 0) commas = memchr(c, ',', (size_t)(end - c)) != NULL;
            td_path_sample *sample = td_path_append(reader, line);
            tides_status status = sample ? read_line(reader, data, commas, sample) : TIDES_NO_MEMORY;
            snprintf(where, sizeof where, ":%zu", line);
            if (status == TIDES_OK) status = td_path_check_quaternion(reader, where, sample->pose.quaternion, "qx qy qz qw");
            if (status == TIDES_OK) status = td_text_take(&lines, reader, line, data);
            if (status != TIDES_OK) return status;
        }
        c = *end ? end + 1 : end;
    }
    snprintf(reader->path.format, sizeof reader->path.format, "%s", commas == 1 ? "esim" : "tum");
    if (commas != 1 || reader->count < 2) return TIDES_OK;
    double duration = td_path_since(reader->samples + reader->count - 1, reader->samples);
    if (duration > 0.0 && duration < TD_SHORTEST_ESIM)
        return td_fail(reader->error, TIDES_BAD_FILE,
                       "%s: lasts %.3g ns: the times of an ESIM csv are nanoseconds; for seconds put blanks instead of commas "
                       "(TUM)",
                       reader->file, duration * 1e9);
    return TIDES_OK;
}
