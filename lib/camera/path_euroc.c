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

/* -- sensor.yaml: keys of it ----------------------------------------------------------------------------------------------- */

/* Behind `key:` at a line's start; NULL: it isn't there. */
static const char *yaml_find(const char *text, const char *key) {
    const size_t length = strlen(key);
    while (text && (strncmp(text, key, length) != 0 || text[length] != ':'))
        text = (text = strchr(text, '\n')) ? text + 1 : NULL;
    return text ? text + length + 1 : NULL;
}

static int yaml_list(const char *text, const char *key, double *values, int count) {
    const char *at = yaml_find(text, key);
    return at && td_yaml_row(at, values, count) != NULL;
}

/* A matrix by rows: the list behind the `data:` within it, or rows of four. */
static int yaml_matrix(const char *text, const char *key, double m[16]) {
    const char *at = yaml_find(text, key), *data;
    if (!at) return 0;
    const char *end = at; /* of what is further to the right */
    do end += strcspn(end, "\n") + (strchr(end, '\n') != NULL);
    while (*end && strchr(" \t\n-#", *end));
    data = strstr(at, "data:");
    if (data && data < end) return td_yaml_row(data + 5, m, 16) != NULL;
    return td_yaml_row(at, m, 16) || td_yaml_matrix(at, m);
}

/* 1 where the word behind `key:` is `word`. */
static int yaml_says(const char *text, const char *key, const char *word) {
    const char *at = yaml_find(text, key);
    if (!at) return 0;
    at += strspn(at, " \t\"'");
    return strncmp(at, word, strlen(word)) == 0;
}

/* Content of a sensor's file; `found` is 1 where there is one. */
typedef struct sensor {
    int found;
    double rotation[9], position[3]; /* sensor to body */
} sensor;

static tides_status parse_place(const td_path_reader *reader, const char *file, const char *text, sensor *s) {
    td_path_reader blamed = *reader;
    double m[16], q[4];
    if (!yaml_matrix(text, "T_BS", m))
        return td_fail(reader->error, TIDES_BAD_FILE, "%s: needs T_BS with 16 finite numbers in [], by rows", file);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) s->rotation[3 * i + j] = m[4 * i + j];
        s->position[i] = m[4 * i + 3];
    }
    s->found = 1;
    blamed.file = file;
    return td_json_rotation(&blamed, "T_BS", "rotation", s->rotation, q);
}

static tides_status parse_sensor(td_path_reader *reader, const char *file, const char *text, sensor *s) {
    double pixels[2], f[4], bent[5] = {0};
    tides_intrinsics *out = &reader->path.intrinsics;
    tides_status status = parse_place(reader, file, text, s);
    if (status != TIDES_OK) return status;
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
    return TIDES_OK;
}

/* Reads `place` beside the path's file: a sensor's pose, and a camera's lens. */
static tides_status load_sensor(td_path_reader *reader, const char *place, int is_camera, sensor *s) {
    char *file = td_beside(reader->file, place, reader->error), *text = NULL;
    size_t bytes = 0;
    tides_status status = file ? TIDES_OK : TIDES_NO_MEMORY;
    if (file && access(file, F_OK) == 0) {
        status = td_read_file(file, TD_LARGEST_PATH, &text, &bytes, reader->error);
        if (!status) td_break_lines(text);
        if (!status) status = is_camera ? parse_sensor(reader, file, text, s) : parse_place(reader, file, text, s);
    }
    free(text);
    free(file);
    return status;
}

/* T_C_I = T_BC^-1 T_BI: the IMU as the camera has it. EuRoC's body is its IMU unless that says otherwise. */
static void place_imu(const sensor *camera, const sensor *imu, tides_path *path) {
    double *t = path->T_C_I;
    for (int i = 0; i < 3; i++) {
        double at = 0;
        for (int k = 0; k < 3; k++) at += camera->rotation[3 * k + i] * (imu->position[k] - camera->position[k]);
        for (int j = 0; j < 3; j++) {
            t[4 * i + j] = 0;
            for (int k = 0; k < 3; k++) t[4 * i + j] += camera->rotation[3 * k + i] * imu->rotation[3 * k + j];
        }
        t[4 * i + 3] = at;
        t[12 + i] = 0;
    }
    t[15] = 1;
    path->has_imu = 1;
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
    sensor camera = {.found = 0}, imu = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    if (reader->options->body) return TIDES_OK;
    tides_status status = load_sensor(reader, "../cam0/sensor.yaml", 1, &camera);
    if (!status && !camera.found) status = load_sensor(reader, "sensor.yaml", 1, &camera);
    if (!status && camera.found) status = load_sensor(reader, "../imu0/sensor.yaml", 0, &imu);
    if (status != TIDES_OK || !camera.found) return status;
    for (size_t i = 0; i < reader->count; i++) mount(&camera, &reader->samples[i].pose);
    place_imu(&camera, &imu, &reader->path);
    return TIDES_OK;
}
