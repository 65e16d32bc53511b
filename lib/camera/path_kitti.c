/* Reads KITTI's odometry poses: 12 numbers per line, a 3x4 matrix by rows, camera to world in OpenCV axes. No times: poses
 * are spread over `duration` in the order of the lines. */
#include "camera/td_path_reader.h"

#include "td_base.h"

#include <string.h>

enum { COLUMNS = 12 };

static tides_status read_line(td_path_reader *reader, size_t line, const char *c, tides_pose_sample *pose) {
    double v[COLUMNS], rotation[9];
    char where[32];
    for (int k = 0; k < COLUMNS; k++) {
        const char *end = td_text_number(c, v + k), *next = td_text_skip(end);
        if (end == c || (k + 1 < COLUMNS ? next == end : !td_text_ends(next)))
            return td_fail(reader->error, TIDES_BAD_FILE, "%s:%zu: a KITTI pose is 12 finite numbers with blanks between them",
                           reader->file, line);
        c = next;
    }
    for (int i = 0; i < 3; i++) {
        memcpy(rotation + 3 * i, v + 4 * i, 3 * sizeof *v);
        pose->position[i] = v[4 * i + 3];
    }
    snprintf(where, sizeof where, "line %zu", line);
    return td_json_rotation(reader, where, "pose", rotation, pose->quaternion);
}

tides_status td_path_read_kitti(td_path_reader *reader) {
    tides_status status = TIDES_OK;
    size_t line = 1;
    strcpy(reader->path.format, "kitti");
    for (const char *c = reader->text; *c && !status; line++) {
        const char *data = td_text_skip(c);
        if (!td_text_ends(data)) {
            td_path_sample *sample = td_path_append(reader, line);
            status = sample ? read_line(reader, line, data, &sample->pose) : TIDES_NO_MEMORY;
        }
        c += strcspn(c, "\n");
        c += *c == '\n';
    }
    td_path_spread(reader);
    return status;
}
