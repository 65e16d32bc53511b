/* JSON helpers of the readers of camera paths. An error names the file, the key ("frames[3].position"), and how to mend it. */
#include "camera/td_path_reader.h"

#include "camera/td_rotation.h"
#include "td_base.h"

#include <math.h>
#include <string.h>

tides_status td_json_fail(td_path_reader *reader, const char *where, const char *key, const char *text) {
    const char *dot = *where && *key ? "." : "";
    return td_fail(reader->error, TIDES_BAD_FILE, "%s: %s%s%s: %s", reader->file, where, dot, key, text);
}

cJSON *td_json_parse(td_path_reader *reader) {
    const char *stop = NULL;
    cJSON *root = cJSON_ParseWithLengthOpts(reader->text, reader->bytes + 1, &stop, 1);
    if (root) return root;
    size_t line = 1, column = 1;
    for (const char *c = reader->text; stop && c < stop && c < reader->text + reader->bytes; c++) {
        column = *c == '\n' ? 1 : column + 1;
        line += *c == '\n';
    }
    td_fail(reader->error, TIDES_BAD_FILE, "%s:%zu:%zu: isn't valid JSON from here on: check commas, quotes and brackets",
            reader->file, line, column);
    return NULL;
}

int td_json_has(const cJSON *object, const char *key) { return cJSON_GetObjectItemCaseSensitive(object, key) != NULL; }

tides_status td_json_number(td_path_reader *reader, const cJSON *object, const char *where, const char *key, double *value) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    if (!item) return td_json_fail(reader, where, key, "is missing: give a number");
    if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble))
        return td_json_fail(reader, where, key, "must be a finite number");
    *value = item->valuedouble;
    return TIDES_OK;
}

/* Reads a list of exactly `count` finite numbers; returns 0 if it is something else. */
static int read_numbers(const cJSON *list, double *values, int count) {
    if (!cJSON_IsArray(list) || cJSON_GetArraySize(list) != count) return 0;
    const cJSON *item;
    cJSON_ArrayForEach(item, list) {
        if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble)) return 0;
        *values++ = item->valuedouble;
    }
    return 1;
}

tides_status td_json_vector(td_path_reader *reader, const cJSON *object, const char *where, const char *key, double *values,
                            int count) {
    if (read_numbers(cJSON_GetObjectItemCaseSensitive(object, key), values, count)) return TIDES_OK;
    const char *problem = td_json_has(object, key) ? "must be" : "is missing: give";
    return td_fail(reader->error, TIDES_BAD_FILE, "%s: %s%s%s: %s a list of %d finite numbers", reader->file, where,
                   *where ? "." : "", key, problem, count);
}

tides_status td_json_matrix(td_path_reader *reader, const cJSON *object, const char *where, const char *key, double *values,
                            int rows, int columns) {
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(object, key), *row = list ? list->child : NULL;
    int good = 0;
    for (; cJSON_IsArray(list) && row && good < rows; row = row->next, good++)
        if (!read_numbers(row, values + good * columns, columns)) break;
    if (good == rows && !row) return TIDES_OK;
    const char *problem = list ? "must be" : "is missing: give";
    return td_fail(reader->error, TIDES_BAD_FILE, "%s: %s%s%s: %s a matrix, a list of %d rows of %d finite numbers",
                   reader->file, where, *where ? "." : "", key, problem, rows, columns);
}

tides_status td_json_pixels(td_path_reader *reader, const cJSON *object, const char *where, const char *key, int32_t *value) {
    double number = 0.0;
    tides_status status = td_json_number(reader, object, where, key, &number);
    if (status != TIDES_OK) return status;
    if (!(number >= 1.0 && number <= INT32_MAX && number == floor(number)))
        return td_json_fail(reader, where, key, "must be a whole number of pixels, at least 1");
    *value = (int32_t)number;
    return TIDES_OK;
}

tides_status td_json_check_keys(td_path_reader *reader, const cJSON *object, const char *where, const char *const *keys) {
    if (!cJSON_IsObject(object)) return td_json_fail(reader, where, "", "must be an object, {...}");
    const cJSON *item;
    cJSON_ArrayForEach(item, object) {
        const char *const *known = keys;
        while (*known && strcmp(*known, item->string) != 0) known++;
        if (*known && cJSON_GetObjectItemCaseSensitive(object, item->string) == item) continue;
        if (*known) return td_json_fail(reader, where, item->string, "is given twice; keep one");
        char word[TD_QUOTE];
        const char *nearest = tides_nearest_name(item->string, keys);
        return td_fail(reader->error, TIDES_BAD_FILE, "%s: %s%s%s: unknown key%s%s%s", reader->file, where, *where ? "." : "",
                       td_path_quote(item->string, strlen(item->string), word), nearest ? "; did you mean \"" : "",
                       nearest ? nearest : "", nearest ? "\"?" : "");
    }
    return TIDES_OK;
}

tides_status td_json_opengl_pose(td_path_reader *reader, const char *where, const char *key, const double matrix[16],
                                 tides_pose_sample *pose) {
    double rotation[9];
    if (matrix[12] != 0.0 || matrix[13] != 0.0 || matrix[14] != 0.0 || matrix[15] != 1.0)
        return td_json_fail(reader, where, key, "must end in the row 0 0 0 1: is it transposed?");
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) rotation[3 * i + j] = j == 0 ? matrix[4 * i] : -matrix[4 * i + j];
        pose->position[i] = matrix[4 * i + 3];
    }
    return td_json_rotation(reader, where, key, rotation, pose->quaternion);
}

/* R counts as a rotation if no entry of R^T R - 1 is larger than this. Matrices with four decimals pass; scaled or sheared ones
 * don't. */
#define TD_ROTATION_TOLERANCE 1e-3

tides_status td_json_rotation(td_path_reader *reader, const char *where, const char *key, const double rotation[9],
                              double q[4]) {
    double worst = 0.0, column[3][3], normal[3];
    for (int i = 0; i < 9; i++) column[i % 3][i / 3] = rotation[i];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) worst = fmax(worst, fabs(td_dot3(column[i], column[j]) - (i == j)));
    td_cross3(column[0], column[1], normal);
    if (!(worst <= TD_ROTATION_TOLERANCE))
        return td_fail(reader->error, TIDES_BAD_FILE,
                       "%s: %s%s%s: isn't a rotation: its columns are off unit length or right angles by %.3g; remove scale "
                       "and "
                       "shear",
                       reader->file, where, *where ? "." : "", key, worst);
    if (!(td_dot3(normal, column[2]) > 0.0))
        return td_json_fail(reader, where, key, "isn't a rotation but a mirror image (its determinant is -1); flip one axis");
    td_quaternion_from_rotation(rotation, q);
    return TIDES_OK;
}
