/* The camera of an EuRoC recording. The poses of its csv are the body's, and T_BS of the camera's sensor.yaml maps camera
 * axes to body axes. The file is looked for in ../cam0 and then beside the csv. It also gives the intrinsics. Without it, the
 * path stays the body's. */
#include "camera/td_path_reader.h"

#include "camera/td_rotation.h"
#include "td_base.h"
#include "td_folder.h"
#include "td_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* -- keys of sensor.yaml ----------------------------------------------------------------------------------------------- */

/* The text behind `key:` at a line's start; NULL if there is none. */
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

/* Reads a 4x4 matrix by rows: a list behind `data:` within the key's value, or rows of four numbers. */
static int yaml_matrix(const char *text, const char *key, double m[16]) {
    const char *at = yaml_find(text, key), *data;
    if (!at) return 0;
    const char *end = at; /* the value ends where the indentation does */
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

/* Content of a sensor.yaml; `found` is 1 if the file exists. */
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

/* Reads the lens. If the model or the number of coefficients is none of TIDES', the path is marked as distorted, unless all
 * coefficients are 0. */
static void parse_lens(const char *text, tides_path *path) {
    enum { COEFFICIENTS_MAX = 12 };
    double k[COEFFICIENTS_MAX] = {0};
    int count = COEFFICIENTS_MAX, bends = 0;
    while (count > 0 && !yaml_list(text, "distortion_coefficients", k, count)) count--;
    for (int i = 0; i < count; i++) bends |= k[i] < 0 || k[i] > 0;
    const int equidistant = count == 4 && yaml_says(text, "distortion_model", "equidistant");
    const int radtan = (count == 4 || count == 5) && yaml_says(text, "distortion_model", "radial-tangential");
    if (equidistant) path->intrinsics.lens = td_equidistant(k);
    if (radtan) path->intrinsics.lens = td_radtan(k);
    path->distorted = bends && !equidistant && !radtan;
}

static tides_status parse_sensor(td_path_reader *reader, const char *file, const char *text, sensor *s) {
    double pixels[2], f[4];
    tides_intrinsics *out = &reader->path.intrinsics;
    tides_status status = parse_place(reader, file, text, s);
    if (status != TIDES_OK) return status;
    if (yaml_list(text, "resolution", pixels, 2) && yaml_list(text, "intrinsics", f, 4)) {
        int good = f[0] > 0 && f[1] > 0;
        for (int k = 0; k < 2; k++) good &= pixels[k] >= 1 && pixels[k] <= INT32_MAX && pixels[k] == floor(pixels[k]);
        if (!good) return td_fail(reader->error, TIDES_BAD_FILE, "%s: resolution and intrinsics must be above 0", file);
        /* The file's pixel centres are at whole numbers, ours at halves. */
        *out = (tides_intrinsics){(int32_t)pixels[0], (int32_t)pixels[1], f[0], f[1], f[2] + 0.5, f[3] + 0.5, {0}};
    }
    parse_lens(text, &reader->path);
    return TIDES_OK;
}

/* Reads the sensor.yaml at `place`, relative to the path's file: the sensor's pose, and a camera's intrinsics. */
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

/* Sets the pose of the IMU in the camera's axes, T_C_I = T_BC^-1 T_BI. Without a sensor.yaml of the IMU, it is the body. */
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

/* Turns a body's pose into the camera's: camera to world = (body to world) (camera to body). */
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
