/* Applies nerfstudio's dataparser_transforms.json to a path: x' = scale (R x + t). This transform maps COLMAP's frame to the
 * trainer's, in which ns-export writes splats. It includes an earlier transform, which ns-process-data has already applied to
 * the poses in transforms.json (its keys applied_transform, applied_scale). For such poses the earlier one is divided out. */
#include "camera/td_path_reader.h"

#include "camera/td_rotation.h"
#include "td_base.h"
#include "td_folder.h"

#include <stdlib.h>
#include <string.h>

/* The map x' = scale (rotation x + position). */
typedef struct frame {
    double rotation[9], position[3], scale;
} frame;

/* Reads an object's 3x4 matrix, which must be a rotation and translation, and its scale, above 0. Missing ones leave `f`
 * unchanged. */
static tides_status read_frame(td_path_reader *reader, const cJSON *object, const char *transform, const char *scale,
                               frame *f) {
    double m[12], q[4];
    tides_status status = TIDES_OK;
    if (td_json_has(object, transform)) {
        const cJSON *rows = cJSON_GetObjectItemCaseSensitive(object, transform);
        double whole[16];
        const int count = cJSON_GetArraySize(rows) == 4 ? 4 : 3;
        status = td_json_matrix(reader, object, "", transform, whole, count, 4);
        if (status != TIDES_OK) return status;
        memcpy(m, whole, sizeof m);
        for (int i = 0; i < 3; i++) {
            memcpy(f->rotation + 3 * i, m + 4 * i, 3 * sizeof *m);
            f->position[i] = m[4 * i + 3];
        }
        status = td_json_rotation(reader, "", transform, f->rotation, q);
    }
    if (status == TIDES_OK && td_json_has(object, scale)) status = td_json_number(reader, object, "", scale, &f->scale);
    if (status == TIDES_OK && !(f->scale > 0)) status = td_json_fail(reader, "", scale, "must be above 0");
    return status;
}

/* The map that has to follow `applied` to give `whole`. */
static frame without(const frame *whole, const frame *applied) {
    frame left = {.scale = whole->scale / applied->scale};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) left.rotation[3 * i + j] = td_dot3(whole->rotation + 3 * i, applied->rotation + 3 * j);
        left.position[i] = whole->position[i] - td_dot3(left.rotation + 3 * i, applied->position);
    }
    return left;
}

static void move(const frame *f, tides_pose_sample *pose) {
    double q[4], own[9], turned[9], place[3];
    memcpy(q, pose->quaternion, sizeof q);
    if (!td_normalise_quaternion(q)) return;
    td_rotation_from_quaternion(q, own);
    for (int i = 0; i < 3; i++) {
        const double *row = f->rotation + 3 * i;
        for (int j = 0; j < 3; j++) turned[3 * i + j] = row[0] * own[j] + row[1] * own[3 + j] + row[2] * own[6 + j];
        place[i] = f->scale * (td_dot3(row, pose->position) + f->position[i]);
    }
    memcpy(pose->position, place, sizeof place);
    td_quaternion_from_rotation(turned, pose->quaternion);
}

static tides_status apply(td_path_reader *reader, const char *file, const frame *applied) {
    frame whole = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .scale = 1};
    td_path_reader own = *reader;
    char *text = NULL;
    own.file = file;
    tides_status status = td_read_file(file, TD_LARGEST_PATH, &text, &own.bytes, reader->error);
    own.text = text;
    cJSON *root = status == TIDES_OK ? td_json_parse(&own) : NULL;
    if (status == TIDES_OK && !root) status = TIDES_BAD_FILE;
    if (status == TIDES_OK && !td_json_has(root, "transform"))
        status = td_json_fail(&own, "", "transform", "is missing: is it nerfstudio's dataparser_transforms.json?");
    if (status == TIDES_OK) status = read_frame(&own, root, "transform", "scale", &whole);
    const frame left = without(&whole, applied);
    for (size_t i = 0; status == TIDES_OK && i < reader->count; i++) move(&left, &reader->samples[i].pose);
    reader->path.framed = status == TIDES_OK;
    if (status == TIDES_OK) td_path_note(reader, "its poses are put into the trainer's frame by %s (camera.frame)", file);
    cJSON_Delete(root);
    free(text);
    return status;
}

tides_status td_path_apply_frame(td_path_reader *reader, const cJSON *root) {
    frame applied = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .scale = 1};
    const char *named = reader->options->frame;
    if (named && strcmp(named, "none") == 0) return TIDES_OK;
    char *beside = named ? NULL : td_beside(reader->file, "dataparser_transforms.json", reader->error);
    if (!named && !beside) return TIDES_NO_MEMORY;
    const char *file = named ? named : td_is_file(beside) ? beside : NULL;
    tides_status status = TIDES_OK;
    if (file && root) status = read_frame(reader, root, "applied_transform", "applied_scale", &applied);
    if (file && status == TIDES_OK) status = apply(reader, file, &applied);
    free(beside);
    return status;
}
