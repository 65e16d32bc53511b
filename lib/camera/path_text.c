/* TUM text (`t tx ty tz qx qy qz qw`, seconds, blanks between) and ESIM csv (`t, x, y, z, qx, qy, qz, qw`, nanoseconds,
 * commas between); '#' starts a comment. Both hold body-to-world poses and are told apart by the comma. */
#include "camera/td_path.h"

#include "camera/td_rotation.h"
#include "td_base.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TD_COLUMNS 8

static const char *const column_names[TD_COLUMNS] = {"time", "x", "y", "z", "qx", "qy", "qz", "qw"};

/* Files write unit quaternions with four decimals or more; a length beyond this says that the columns are others. */
#define TD_QUATERNION_TOLERANCE 0.05

/* An ESIM file shorter than this was written in seconds. */
#define TD_SHORTEST_ESIM 1e-6L /* [s] */

static const char *skip_blanks(const char *c) { return c + strspn(c, " \t\r"); }

/* 1 where the line at `c` holds nothing more. */
static int line_ends(const char *c) { return *c == '\n' || *c == '\0' || *c == '#'; }

static tides_status fail_column(const td_path_reader *reader, size_t line, int column, const char *at) {
    char word[TD_QUOTE];
    return td_fail(reader->error, TIDES_BAD_FILE, "%s:%zu: column %d (%s) must be a finite number, not \"%s\"", reader->file,
                   line, column + 1, column_names[column], td_path_quote(at, strcspn(at, " \t\r\n,"), word));
}

/* Eight numbers of one line. */
static tides_status read_line(const td_path_reader *reader, size_t line, const char *c, int commas, long double v[TD_COLUMNS]) {
    int column = 0;
    for (c = skip_blanks(c); !line_ends(c); column++) {
        if (column == TD_COLUMNS) break;
        char *end = NULL;
        v[column] = strtold(c, &end);
        if (end == c || !isfinite((double)v[column])) return fail_column(reader, line, column, c);
        const char *next = skip_blanks(end);
        if (!line_ends(next) && (commas ? *next != ',' : next == end)) return fail_column(reader, line, column, c);
        c = commas && *next == ',' ? skip_blanks(next + 1) : next;
    }
    if (column == TD_COLUMNS && line_ends(c)) return TIDES_OK;
    return td_fail(reader->error, TIDES_BAD_FILE, "%s:%zu: %s than 8 columns; %s has %s", reader->file, line,
                   column < TD_COLUMNS ? "fewer" : "more", commas ? "an ESIM csv" : "a TUM file",
                   commas ? "t_ns, x, y, z, qx, qy, qz, qw" : "t tx ty tz qx qy qz qw");
}

static tides_status add_sample(td_path_reader *reader, size_t line, const long double v[TD_COLUMNS], long double time_unit) {
    td_path_sample *sample = td_path_append(reader, line);
    if (!sample) return TIDES_NO_MEMORY;
    sample->time = v[0] * time_unit;
    for (int k = 0; k < 3; k++) sample->pose.position[k] = (double)v[1 + k];
    double *q = sample->pose.quaternion, square = 0.0;
    q[0] = (double)v[7]; /* the files write w last */
    for (int k = 0; k < 3; k++) q[1 + k] = (double)v[4 + k];
    for (int k = 0; k < 4; k++) square += q[k] * q[k];
    if (fabs(sqrt(square) - 1.0) <= TD_QUATERNION_TOLERANCE) return TIDES_OK;
    return td_fail(reader->error, TIDES_BAD_FILE,
                   "%s:%zu: the quaternion's length is %.4g instead of 1: columns 5 to 8 must be qx qy qz qw", reader->file,
                   line, sqrt(square));
}

tides_status td_path_read_text(td_path_reader *reader) {
    int commas = -1; /* known from the first line with data on */
    size_t line = 1;
    for (const char *c = reader->text; *c; line++) {
        const char *end = c + strcspn(c, "\n"), *data = skip_blanks(c);
        if (!line_ends(data)) {
            if (commas < 0) commas = memchr(c, ',', (size_t)(end - c)) != NULL;
            long double v[TD_COLUMNS] = {0};
            tides_status status = read_line(reader, line, data, commas, v);
            if (status == TIDES_OK) status = add_sample(reader, line, v, commas ? 1e-9L : 1.0L);
            if (status != TIDES_OK) return status;
        }
        c = *end ? end + 1 : end;
    }
    snprintf(reader->path.format, sizeof reader->path.format, "%s", commas == 1 ? "esim" : "tum");
    long double duration = reader->count ? reader->samples[reader->count - 1].time - reader->samples[0].time : 0.0L;
    if (commas == 1 && duration > 0.0L && duration < TD_SHORTEST_ESIM)
        return td_fail(reader->error, TIDES_BAD_FILE,
                       "%s: lasts %.3Lg ns: the times of an ESIM csv are nanoseconds; for seconds put blanks instead of commas "
                       "(TUM)",
                       reader->file, duration * 1e9L);
    return TIDES_OK;
}
