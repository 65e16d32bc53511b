/* Reads Kalibr's camera chains: the part of YAML that PyYAML and OpenCV write for such a file. Mappings are two deep. Values
 * are words, numbers, lists of numbers, and lists of such lists. A list is in [], where it may continue on the next line, or
 * has "- " before each item. All else is refused; so are unknown keys, because they might change the cameras.
 *
 *     cam1:
 *       camera_model: pinhole
 *       intrinsics: [461.6, 460.2, 362.7, 246.0]     fu fv pu pv
 *       distortion_model: radtan                     or equidistant, none; fov isn't supported
 *       distortion_coeffs: [-0.28, 0.07, 0.0, 0.0]
 *       resolution: [752, 480]
 *       T_cn_cnm1:                                   p_cam1 = T p_cam0
 *       - [1.0, 0.0, 0.0, -0.11]
 *       ...
 *
 * libyaml would read all of YAML, but its events need as many lines of code to become cameras. */
#include "td_camchain.h"
#include "camera/td_lens_models.h"

#include "camera/td_path_reader.h"
#include "camera/td_rotation.h"
#include "td_base.h"
#include "td_text.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#define ROTATION_TOLERANCE 1e-4 /* largest deviation of a calibrated matrix from a rotation; files write all digits */

/* The camera that is being read. */
typedef struct reading {
    const char *file;
    tides_error *error;
    td_camchain *chain;
    const char *pinhole, *bent; /* values of camera_model and distortion_model; NULL: not there */
    const char *list[2]; /* values of intrinsics and distortion_coeffs, kept as text: their lengths depend on the models */
    double resolution[2], before[16], imu[16], shift;
    int given; /* bit for each key that was read */
} reading;

enum {
    KEY_MODEL,
    KEY_INTRINSICS,
    KEY_BENT,
    KEY_COEFFICIENTS,
    KEY_RESOLUTION,
    KEY_BEFORE,
    KEY_CAM_IMU,
    KEY_IMU_CAM,
    KEY_SHIFT,
    KEY_OVERLAPS,
    KEY_TOPIC
};

static tides_status bad(const reading *r, tides_status status, const char *what) {
    return td_fail(r->error, status, "%s: cam%d: %s", r->file, r->chain->count, what);
}

/* -- values ---------------------------------------------------------------------------------------------------------------- */

static int read_list(const char *value, double *values, int count) {
    const char *end = td_yaml_row(value, values, count);
    return end && !*end;
}

static int read_matrix(const char *value, double m[16]) {
    const char *end = td_yaml_matrix(value, m);
    return end && !*end;
}

/* A word up to the end of its line, without quotes around it. */
static const char *read_word(char *value) {
    value += strspn(value, " \t\r\n\"'");
    size_t length = strlen(value);
    while (length && strchr(" \t\r\n\"'", value[length - 1])) value[--length] = '\0';
    return value;
}

/* 1 if the matrix is a rotation and a translation. */
static int is_rigid(const double t[16]) {
    double off = fabs(t[12]) + fabs(t[13]) + fabs(t[14]) + fabs(t[15] - 1), cross[3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) off = fmax(off, fabs(td_dot3(t + 4 * i, t + 4 * j) - (i == j)));
    td_cross3(t, t + 4, cross);
    for (int k = 0; k < 3; k++) off = fmax(off, fabs(cross[k] - t[8 + k]));
    return off <= ROTATION_TOLERANCE;
}

static void multiply(const double a[16], const double b[16], double out[16]) {
    for (int i = 0; i < 16; i++) {
        out[i] = 0;
        for (int k = 0; k < 4; k++) out[i] += a[i / 4 * 4 + k] * b[4 * k + i % 4];
    }
}

/* Inverts a rigid transform. */
static void invert(const double t[16], double out[16]) {
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) out[4 * i + j] = t[4 * j + i];
        out[4 * i + 3] = -(t[i] * t[3] + t[4 + i] * t[7] + t[8 + i] * t[11]);
        out[12 + i] = 0;
    }
    out[15] = 1;
}

/* Replaces the rotation, which has rounded digits, by the nearest exact one, so that a chain of any length stays a rotation. */
static void straighten(double t[16]) {
    double r[9] = {t[0], t[1], t[2], t[4], t[5], t[6], t[8], t[9], t[10]};
    td_straighten_rotation(r);
    for (int i = 0; i < 9; i++) t[i / 3 * 4 + i % 3] = r[i];
}

/* -- keys ------------------------------------------------------------------------------------------------------------------ */

static const struct key {
    const char *name;
    int id, count; /* numbers in []; 16: a matrix; 0: a word, a list that is parsed later, or a key that is ignored */
    size_t offset; /* in `reading` */
} keys[] = {{"camera_model", KEY_MODEL, 0, 0},
            {"intrinsics", KEY_INTRINSICS, 0, 0},
            {"distortion_model", KEY_BENT, 0, 0},
            {"distortion_coeffs", KEY_COEFFICIENTS, 0, 0},
            {"resolution", KEY_RESOLUTION, 2, offsetof(reading, resolution)},
            {"T_cn_cnm1", KEY_BEFORE, 16, offsetof(reading, before)},
            {"T_cam_imu", KEY_CAM_IMU, 16, offsetof(reading, imu)},
            {"T_imu_cam", KEY_IMU_CAM, 16, offsetof(reading, imu)},
            {"timeshift_cam_imu", KEY_SHIFT, 1, offsetof(reading, shift)},
            {"cam_overlaps", KEY_OVERLAPS, 0, 0},
            {"rostopic", KEY_TOPIC, 0, 0}};
enum { KEYS = sizeof keys / sizeof *keys };

static int has(const reading *r, int id) { return r->given >> id & 1; }

static tides_status take_numbers(reading *r, const struct key *key, const char *value) {
    double *values = (void *)((char *)r + key->offset);
    if (key->count == 16) {
        if (read_matrix(value, values) && is_rigid(values)) {
            straighten(values);
            return TIDES_OK;
        }
        return td_fail(r->error, TIDES_BAD_FILE, "%s: cam%d: %s must be four rows of four numbers, a rotation and a place",
                       r->file, r->chain->count, key->name);
    }
    const char *at = td_yaml_skip(value), *end;
    const int one = key->count == 1 && (end = td_text_number(at, values)) != at && !*td_yaml_skip(end);
    if (one || read_list(value, values, key->count)) return TIDES_OK;
    return td_fail(r->error, TIDES_BAD_FILE, "%s: cam%d: %s must be %d finite number%s", r->file, r->chain->count, key->name,
                   key->count, key->count > 1 ? "s in []" : "");
}

/* Takes a key with its value, a text that ends in a NUL. */
static tides_status take_key(reading *r, const char *name, char *value) {
    const struct key *key = NULL;
    char word[TD_QUOTE];
    for (int i = 0; i < KEYS; i++)
        if (strcmp(keys[i].name, name) == 0) key = &keys[i];
    td_path_quote(name, strlen(name), word);
    if (!key)
        return td_fail(r->error, TIDES_BAD_FILE, "%s: cam%d: key %s isn't one of Kalibr's camera chains; leave it out", r->file,
                       r->chain->count, word);
    if (has(r, key->id))
        return td_fail(r->error, TIDES_BAD_FILE, "%s: cam%d: %s is given twice", r->file, r->chain->count, word);
    r->given |= 1 << key->id;
    if (key->id == KEY_MODEL) r->pinhole = read_word(value);
    if (key->id == KEY_BENT) r->bent = read_word(value);
    if (key->id == KEY_INTRINSICS) r->list[0] = value;
    if (key->id == KEY_COEFFICIENTS) r->list[1] = value;
    return key->count ? take_numbers(r, key, value) : TIDES_OK;
}

/* -- cameras --------------------------------------------------------------------------------------------------------------- */

/* Checks the models before any coefficients: other models have other numbers of them. */
static tides_status check_models(const reading *r) {
    char word[TD_QUOTE];
    if (r->pinhole && strcmp(r->pinhole, "pinhole") != 0)
        return td_fail(r->error, TIDES_UNSUPPORTED,
                       "%s: cam%d: camera_model %s isn't supported: calibrate as pinhole, with radtan or equidistant", r->file,
                       r->chain->count, td_path_quote(r->pinhole, strlen(r->pinhole), word));
    if (!r->bent || td_lens_named(r->bent) >= 0) return TIDES_OK;
    if (strcmp(r->bent, "plumb_bob") == 0 || strcmp(r->bent, "equi") == 0) return TIDES_OK; /* ROS's and Kalibr's other names */
    return td_fail(r->error, TIDES_UNSUPPORTED, "%s: cam%d: distortion_model %s isn't supported: radtan, equidistant or none",
                   r->file, r->chain->count, td_path_quote(r->bent, strlen(r->bent), word));
}

/* Reads the lens. The coefficients are ignored without a model, or with "none". */
static tides_status find_lens(const reading *r, tides_lens *lens) {
    double k[5] = {0};
    *lens = (tides_lens){.model = TIDES_LENS_NONE};
    if (!r->bent || strcmp(r->bent, "none") == 0) return TIDES_OK;
    if (!has(r, KEY_COEFFICIENTS)) return bad(r, TIDES_BAD_FILE, "distortion_model needs distortion_coeffs");
    if (!read_list(r->list[1], k, 4)) return bad(r, TIDES_BAD_FILE, "distortion_coeffs must be 4 finite numbers in a list");
    *lens = strncmp(r->bent, "equi", 4) == 0 ? td_equidistant(k) : td_radtan(k);
    return TIDES_OK;
}

static tides_status find_intrinsics(const reading *r, tides_intrinsics *out) {
    enum { LARGEST = 16384 }; /* pixels of a side */
    double f[4];
    if (!read_list(r->list[0], f, 4)) return bad(r, TIDES_BAD_FILE, "intrinsics must be 4 finite numbers in a list");
    int good = f[0] > 0 && f[1] > 0;
    for (int k = 0; k < 2; k++)
        good = good && r->resolution[k] >= 1 && r->resolution[k] <= LARGEST && r->resolution[k] == floor(r->resolution[k]);
    if (!good) return bad(r, TIDES_BAD_FILE, "resolution and focal lengths must be above 0, and the former whole numbers");
    *out = (tides_intrinsics){.width = (int32_t)r->resolution[0],
                              .height = (int32_t)r->resolution[1],
                              .fx = f[0],
                              .fy = f[1],
                              .cx = f[2] + 0.5,
                              .cy = f[3] + 0.5};
    return find_lens(r, &out->lens);
}

/* Finds the camera's pose on the body: from the IMU if the file has it, else along the chain. */
static tides_status find_place(const reading *r, double T_B_C[16]) {
    static const double same[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    double back[16];
    const int n = r->chain->count;
    if (has(r, KEY_CAM_IMU) && has(r, KEY_IMU_CAM)) return bad(r, TIDES_BAD_FILE, "T_cam_imu and T_imu_cam: keep one");
    if (n == 0) r->chain->has_imu = has(r, KEY_IMU_CAM) || has(r, KEY_CAM_IMU);
    if (!r->chain->has_imu && !has(r, KEY_BEFORE) && n > 0) { /* its pose to an IMU doesn't give its pose to cam0 */
        return bad(r, TIDES_BAD_FILE, "T_cn_cnm1 is missing: how it stands to the camera before it");
    } else if (r->chain->has_imu && has(r, KEY_IMU_CAM)) {
        memcpy(T_B_C, r->imu, sizeof same);
    } else if (r->chain->has_imu && has(r, KEY_CAM_IMU)) {
        invert(r->imu, T_B_C);
    } else if (n == 0) {
        memcpy(T_B_C, same, sizeof same);
    } else if (has(r, KEY_BEFORE)) {
        invert(r->before, back);
        multiply(r->chain->camera[n - 1].T_B_C, back, T_B_C);
    } else {
        return bad(r, TIDES_BAD_FILE, "T_cn_cnm1 is missing: how it stands to the camera before it");
    }
    return TIDES_OK;
}

/* Appends the camera that was read to the chain. */
static tides_status finish_camera(reading *r) {
    static const int needed[] = {KEY_INTRINSICS, KEY_RESOLUTION};
    td_camchain_camera *camera = &r->chain->camera[r->chain->count];
    tides_status status = check_models(r);
    if (status != TIDES_OK) return status;
    for (int i = 0; i < 2; i++)
        if (!has(r, needed[i])) return bad(r, TIDES_BAD_FILE, i ? "resolution is missing" : "intrinsics are missing");
    if (r->shift < 0 || r->shift > 0)
        return td_fail(r->error, TIDES_UNSUPPORTED,
                       "%s: cam%d: timeshift_cam_imu is %.9g s: what is simulated has one clock; set it to 0", r->file,
                       r->chain->count, r->shift);
    status = find_intrinsics(r, &camera->intrinsics);
    if (status == TIDES_OK) status = find_place(r, camera->T_B_C);
    r->chain->count += status == TIDES_OK;
    return status;
}

/* -- lines ----------------------------------------------------------------------------------------------------------------- */

/* Splits "name: rest" at `at`: puts a NUL in place of the colon, and returns the rest. NULL if there is no such key. */
static char *split_key(char *at) {
    char *end = at;
    while (isalnum((unsigned char)*end) || *end == '_') end++;
    if (end == at || *end != ':' || !strchr(" \t\r\n", end[1])) return NULL; /* strchr also finds the NUL at the text's end */
    *end = '\0';
    return end + 1;
}

/* Blanks out comments (a # at the line's start or behind a blank, and what follows), directives and markers. */
static void blank_comments(char *text) {
    int comment = 0, start = 1;
    for (char *at = text; *at; at++) {
        if (*at == '\n') comment = 0;
        if (start && (*at == '%' || strncmp(at, "---", 3) == 0)) comment = 1;
        if (*at == '#' && (at == text || strchr(" \t\n", at[-1]))) comment = 1;
        start = *at == '\n';
        if (comment) *at = ' ';
    }
}

static tides_status begin_camera(reading *r, const char *name, const char *rest, size_t line) {
    char wanted[16];
    const tides_status status = r->given >= 0 ? finish_camera(r) : TIDES_OK;
    if (status != TIDES_OK) return status;
    snprintf(wanted, sizeof wanted, "cam%d", r->chain->count);
    if (strcmp(name, wanted) != 0 || *(rest + strspn(rest, " \t\r")) != '\n' || r->chain->count == TD_CAMCHAIN_MOST)
        return td_fail(r->error, TIDES_BAD_FILE, "%s:%zu: %s was expected: cameras cam0, cam1 ... in their order, %d at most",
                       r->file, line, wanted, TD_CAMCHAIN_MOST);
    *r = (reading){.file = r->file, .error = r->error, .chain = r->chain};
    return TIDES_OK;
}

/* Reads line by line. A key's value may span lines, and ends where the next key begins. */
static tides_status read_lines(reading *r, char *text) {
    char *name = NULL, *value = NULL, *next;
    size_t line = 1, inner = 0;
    tides_status status = TIDES_OK;
    for (char *at = text; *at && status == TIDES_OK; at = next, line++) {
        const size_t indent = strspn(at, " ");
        next = at + strcspn(at, "\n");
        next += *next == '\n';
        if (next - at <= (ptrdiff_t)strspn(at, " \t\r\n")) continue;
        if (name && indent > inner) continue; /* the value goes on */
        if (name && indent == inner && at[indent] == '-') continue;
        if (name) at[-1] = '\0', status = take_key(r, name, value); /* ends the value: its last line break becomes a NUL */
        name = NULL;
        if (status != TIDES_OK) break;
        char *key = at + indent, *rest = split_key(key);
        if (!rest || (indent > 0 && r->given < 0))
            status = td_fail(r->error, TIDES_BAD_FILE,
                             "%s:%zu: this isn't Kalibr's camera chain: \"camN:\", or \"  key: value\"", r->file, line);
        else if (indent == 0)
            status = begin_camera(r, key, rest, line);
        else
            name = key, value = rest, inner = indent;
    }
    if (status == TIDES_OK && name) status = take_key(r, name, value);
    return status;
}

static tides_status read_chain(reading *r, char *text) {
    blank_comments(text);
    tides_status status = read_lines(r, text);
    if (status != TIDES_OK) return status;
    if (r->given < 0) return td_fail(r->error, TIDES_BAD_FILE, "%s: no camera: \"cam0:\" is missing", r->file);
    return finish_camera(r);
}

tides_status td_camchain_parse(const char *file, char *text, td_camchain *chain, tides_error *error) {
    reading r = {.file = file, .error = error, .chain = chain, .given = -1};
    chain->count = 0;
    chain->has_imu = 0;
    td_break_lines(text);
    td_plain_numbers numbers;
    tides_status status = td_plain_begin(&numbers, file, error);
    if (status != TIDES_OK) return status;
    status = read_chain(&r, text);
    td_plain_end(&numbers);
    return status;
}
