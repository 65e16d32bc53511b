/* Reads text files with one pose for each line: a camera-to-world matrix in OpenCV axes, row by row. A line has 12 numbers (the
 * upper 3x4 part, as in KITTI's odometry) or 16 (the whole 4x4 matrix).
 *
 * An additional number may precede them: a time, or the frame's number (KITTI-360). options.time_unit says which. Without
 * that option it counts as a time, and a file whose numbers may be those of frames is refused.
 *
 * Poses without times are spread evenly over [0, options.duration], in the order of the lines. */
#include "camera/td_path_reader.h"

#include "td_base.h"

#include <string.h>

enum { LEAST = 12, MOST = 16 }; /* numbers of a 3x4 and of a 4x4 matrix */

int td_path_is_kitti(int columns) { return columns == LEAST || columns == LEAST + 1 || columns == MOST || columns == MOST + 1; }

static tides_status read_line(td_path_reader *reader, size_t line, const char *c, int columns, td_path_sample *sample) {
    const int timed = columns % 4;
    double v[MOST + 1], rotation[9];
    const double *m = v + timed;
    char where[32];
    if (timed) sample->word = c, sample->length = strcspn(c, " \t\r\n");
    for (int k = 0; k < columns; k++) {
        const char *end = td_text_number(c, v + k), *next = td_text_skip(end);
        if (end == c || (k + 1 < columns ? next == end : !td_text_ends(next)))
            return td_fail(reader->error, TIDES_BAD_FILE, "%s:%zu: a KITTI pose is %d finite numbers with blanks between them",
                           reader->file, line, columns);
        c = next;
    }
    sample->time = timed ? v[0] : 0;
    if (columns >= MOST && (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1))
        return td_fail(reader->error, TIDES_BAD_FILE, "%s:%zu: a pose's last row should be 0 0 0 1", reader->file, line);
    for (int i = 0; i < 3; i++) {
        memcpy(rotation + 3 * i, m + 4 * i, 3 * sizeof *m);
        sample->pose.position[i] = m[4 * i + 3];
    }
    snprintf(where, sizeof where, "line %zu", line);
    return td_json_rotation(reader, where, "pose", rotation, sample->pose.quaternion);
}

tides_status td_path_read_kitti(td_path_reader *reader, int columns) {
    tides_status status = TIDES_OK;
    size_t line = 1;
    strcpy(reader->path.format, "kitti");
    for (const char *c = reader->text; *c && !status; line++) {
        const char *data = td_text_skip(c);
        if (!td_text_ends(data)) {
            td_path_sample *sample = td_path_append(reader, line);
            status = sample ? read_line(reader, line, data, columns, sample) : TIDES_NO_MEMORY;
        }
        c += strcspn(c, "\n");
        c += *c == '\n';
    }
    if (status == TIDES_OK && columns % 4) return td_path_take_times(reader, -1, 9);
    td_path_spread(reader);
    return status;
}
