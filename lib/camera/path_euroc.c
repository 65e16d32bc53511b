/* The camera on the body whose poses EuRoC's state_groundtruth csv has: T_BS of its sensor.yaml maps the camera's axes to the
 * body's. It is looked for in ../cam0, where EuRoC has it, then beside the csv; without one the path is the body's. From the
 * same file: the intrinsics, where it has them. */
#include "camera/td_path_reader.h"

#include "camera/td_rotation.h"
#include "td_base.h"
#include "td_folder.h"
#include "td_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* -- sensor.yaml: three keys of it, in YAML's flow style, which all of EuRoC's files have --------------------------------- */

/* `count` numbers of the list behind `key:`, or of the `data:` within it; 0 where it isn't there. */
static int yaml_list(const char *text, const char *key, double *values, int count) {
    const char *at = text;
    size_t length = strlen(key);
    while (at && (strncmp(at, key, length) != 0 || at[length] != ':')) at = (at = strchr(at, '\n')) ? at + 1 : NULL;
    if (!at || !(at = strchr(at, '['))) return 0;
    for (int k = 0; k < count; k++) {
        const char *number = at + 1 + strspn(at + 1, " \t\r\n"), *end = td_text_number(number, values + k);
        if (end == number) return 0;
        at = end + strspn(end, " \t\r\n");
        if (*at != (k + 1 < count ? ',' : ']')) return 0;
    }
    return 1;
}

/* 1 where the word behind `key:` is `word`. */
static int yaml_says(const char *text, const char *key, const char *word) {
    size_t length = strlen(key);
    while (text && (strncmp(text, key, length) != 0 || text[length] != ':'))
        text = (text = strchr(text, '\n')) ? text + 1 : NULL;
    if (!text) return 0;
    text += length + 1 + strspn(text + length + 1, " \t\"'");
    return strncmp(text, word, strlen(word)) == 0;
}

/* What the camera's file says; `found` is 1 where there is one. */
typedef struct sensor {
    int found;
    double rotation[9], position[3]; /* sensor to body */
} sensor;

static tides_status parse_sensor(td_path_reader *reader, const char *file, const char *text, sensor *s) {
    double m[16], pixels[2], f[4], bent[5] = {0}, q[4];
    tides_intrinsics *out = &reader->path.intrinsics;
    if (!yaml_list(text, "T_BS", m, 16))
        return td_fail(reader->error, TIDES_BAD_FILE, "%s: needs T_BS with 16 finite numbers in [], by rows", file);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) s->rotation[3 * i + j] = m[4 * i + j];
        s->position[i] = m[4 * i + 3];
    }
    s->found = 1;
    if (yaml_list(text, "resolution", pixels, 2) && yaml_list(text, "intrinsics", f, 4)) {
        int good = f[0] > 0 && f[1] > 0;
        for (int k = 0; k < 2; k++) good &= pixels[k] >= 1 && pixels[k] <= INT32_MAX && pixels[k] == floor(pixels[k]);
        if (!good) return td_fail(reader->error, TIDES_BAD_FILE, "%s: resolution and intrinsics must be above 0", file);
        /* Pixel centres are whole numbers there, as in OpenCV. */
        *out = (tides_intrinsics){(int32_t)pixels[0], (int32_t)pixels[1], f[0], f[1], f[2] + 0.5, f[3] + 0.5, {0}};
    }
    if (yaml_list(text, "distortion_coefficients", bent, 4)) {
        if (yaml_says(text, "distortion_model", "equidistant"))
            out->lens = td_equidistant(bent);
        else
            out->lens = td_radtan(bent);
        if (!yaml_says(text, "distortion_model", "equidistant") && !yaml_says(text, "distortion_model", "radial-tangential")) {
            reader->path.distorted = out->lens.model != TIDES_LENS_NONE;
            out->lens = (tides_lens){.model = TIDES_LENS_NONE};
        }
    }
    td_path_reader blamed = *reader;
    blamed.file = file;
    return td_json_rotation(&blamed, "T_BS", "rotation", s->rotation, q);
}

static tides_status load_sensor(td_path_reader *reader, sensor *s) {
    static const char *const places[] = {"../cam0/sensor.yaml", "sensor.yaml"};
    tides_status status = TIDES_OK;
    for (size_t k = 0; k < 2 && !status && !s->found; k++) {
        char *file = td_beside(reader->file, places[k], reader->error);
        char *text = NULL;
        size_t bytes = 0;
        if (!file) return TIDES_NO_MEMORY;
        if (access(file, F_OK) == 0) {
            status = td_read_file(file, TD_LARGEST_PATH, &text, &bytes, reader->error);
            if (!status) td_break_lines(text);
            if (!status) status = parse_sensor(reader, file, text, s);
        }
        free(text);
        free(file);
    }
    return status;
}

/* Camera to world: body to world times sensor to body. */
static void mount(const sensor *s, tides_pose_sample *pose) {
    double q[4], body[9], camera[9];
    memcpy(q, pose->quaternion, sizeof q);
    if (!s->found || !td_normalise_quaternion(q)) return;
    td_rotation_from_quaternion(q, body);
    for (int i = 0; i < 3; i++) {
        pose->position[i] += td_dot3(body + 3 * i, s->position);
        for (int j = 0; j < 3; j++)
            camera[3 * i + j] =
                body[3 * i] * s->rotation[j] + body[3 * i + 1] * s->rotation[3 + j] + body[3 * i + 2] * s->rotation[6 + j];
    }
    td_quaternion_from_rotation(camera, pose->quaternion);
}

tides_status td_path_mount_euroc(td_path_reader *reader) {
    sensor s = {.found = 0};
    tides_status status = load_sensor(reader, &s);
    for (size_t i = 0; i < reader->count && status == TIDES_OK; i++) mount(&s, &reader->samples[i].pose);
    return status;
}
