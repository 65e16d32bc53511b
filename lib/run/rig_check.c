/* Checks rig.cameras: a list of cameras with names, kinds, poses on the body, and their own values of keys of the run. */
#include "camera/td_rotation.h"
#include "td_run.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

/* Allowed deviation of a matrix in a text file from a rotation. */
#define ROTATION_TOLERANCE 1e-6

static const char *const kinds[] = {"both", "event", "frame"}; /* in the order of TIDES_RIG_* */
enum { KINDS = sizeof kinds / sizeof *kinds };

/* -- one camera ----------------------------------------------------------------------------------------------------------- */

/* Fails with an error about `name`, such as "rig.cameras[1]". */
static tides_status bad(const char *where, const char *name, const char *what, tides_error *error) {
    return td_fail(error, TIDES_BAD_CONFIG, "%s: %s%s", where, name, what);
}

/* 1 for a valid name; folders are named after cameras. */
static int is_name(const cJSON *item) {
    if (!cJSON_IsString(item) || !item->valuestring[0] || strlen(item->valuestring) >= TIDES_RIG_NAME) return 0;
    for (const char *at = item->valuestring; *at; at++)
        if (!isalnum((unsigned char)*at) && *at != '_' && *at != '-') return 0;
    return 1;
}

int32_t td_rig_kind(const cJSON *item) {
    if (!item) return TIDES_RIG_BOTH;
    for (int32_t i = 0; i < KINDS; i++)
        if (cJSON_IsString(item) && strcmp(item->valuestring, kinds[i]) == 0) return i;
    return -1;
}

int32_t td_rig_transform(const cJSON *item, double transform[16]) {
    for (int i = 0; i < 16; i++) transform[i] = i % 5 == 0;
    if (!item) return 1;
    if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != 4) return 0;
    const cJSON *row, *number;
    double *out = transform;
    cJSON_ArrayForEach(row, item) {
        if (!cJSON_IsArray(row) || cJSON_GetArraySize(row) != 4) return 0;
        cJSON_ArrayForEach(number, row) {
            if (!cJSON_IsNumber(number) || !(fabs(number->valuedouble) <= 1e9)) return 0;
            *out++ = number->valuedouble;
        }
    }
    return 1;
}

/* 1 if the columns are orthonormal and right-handed, and the last row is 0 0 0 1. */
static int is_rigid(const double t[16]) {
    double c[3][3], cross[3];
    for (int i = 0; i < 9; i++) c[i % 3][i / 3] = t[i / 3 * 4 + i % 3];
    td_cross3(c[0], c[1], cross);
    int good = fabs(t[12]) + fabs(t[13]) + fabs(t[14]) + fabs(t[15] - 1) <= ROTATION_TOLERANCE;
    for (int k = 0; k < 3; k++) good = good && fabs(td_length3(c[k]) - 1) <= ROTATION_TOLERANCE;
    for (int k = 0; k < 3; k++) good = good && fabs(cross[k] - c[2][k]) <= ROTATION_TOLERANCE;
    return good;
}

/* Checks a group of a camera's own keys, such as "sensor". */
static tides_status check_keys(const cJSON *object, const char *group, const char *where, tides_error *error) {
    const cJSON *item;
    cJSON_ArrayForEach(item, object) {
        char key[TD_KEY_MAX];
        const int length = snprintf(key, sizeof key, "%s.%s", group, item->string);
        const tides_param *row = length > 0 && (size_t)length < sizeof key ? td_param_find(key) : NULL;
        if (!row && length > 0 && (size_t)length < sizeof key && td_param_is_group(key) && cJSON_IsObject(item)) {
            const tides_status status = check_keys(item, key, where, error);
            if (status != TIDES_OK) return status;
            continue;
        }
        if (!row) return td_param_unknown(where, key, error);
        static const char *const body[] = {"camera.file",   "camera.duration_s",    "camera.start_s",
                                           "camera.rebase", "camera.raw_positions", "camera.views"};
        for (size_t i = 0; i < sizeof body / sizeof *body; i++)
            if (strcmp(key, body[i]) == 0)
                return td_fail(error, TIDES_BAD_CONFIG,
                               "%s: %s: a rig has one body, whose path and clock are the run's own; a camera has its T_B_C",
                               where, key);
        const tides_status status = td_param_check(row, item, where, error);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

static tides_status check_item(const cJSON *item, const char *name, const char *where, tides_error *error) {
    static const char *const groups[] = {"camera", "sensor", "frontend", "readout", "filters", NULL};
    double transform[16];
    if (strcmp(item->string, "name") == 0)
        return is_name(item)
                   ? TIDES_OK
                   : bad(where, name, ".name: a camera's name is up to 31 letters, digits, _ and -, for folders", error);
    if (strcmp(item->string, "kind") == 0)
        return td_rig_kind(item) >= 0 ? TIDES_OK : bad(where, name, ".kind is none of event, frame, both", error);
    if (strcmp(item->string, "T_B_C") == 0) {
        if (!td_rig_transform(item, transform))
            return bad(where, name, ".T_B_C: four rows of four numbers [scene units]", error);
        return is_rigid(transform) ? TIDES_OK
                                   : bad(where, name, ".T_B_C isn't a rotation and a place (last row 0 0 0 1)", error);
    }
    for (const char *const *group = groups; *group; group++)
        if (strcmp(item->string, *group) == 0 && cJSON_IsObject(item)) {
            char at[2 * TD_KEY_MAX];
            snprintf(at, sizeof at, "%.90s: %.40s", where, name);
            return check_keys(item, *group, at, error);
        }
    if (strcmp(item->string, "time") == 0 || strcmp(item->string, "clock") == 0)
        return bad(where, name, ": cameras of a rig have one clock, the run's: leave its time out", error);
    char shown[64];
    snprintf(shown, sizeof shown, ".%.40s", item->string);
    td_one_line(shown);
    return td_fail(error, TIDES_BAD_CONFIG,
                   "%s: %s%s is unknown: name, T_B_C, kind; objects camera, sensor, frontend, readout, filters", where, name,
                   shown);
}

/* -- all of them ---------------------------------------------------------------------------------------------------------- */

static const cJSON *of(const cJSON *camera, const char *key) { return cJSON_GetObjectItemCaseSensitive(camera, key); }

/* Refuses two cameras with one name, or with pixels of one kind at one place: they would see the same. */
static tides_status check_pair(const cJSON *one, const cJSON *two, const char *where, tides_error *error) {
    const char *first = of(one, "name")->valuestring, *second = of(two, "name")->valuestring;
    if (strcmp(first, second) == 0)
        return td_fail(error, TIDES_BAD_CONFIG, "%s: rig.cameras: two are called \"%s\"; give each its name", where, first);
    const int32_t a = td_rig_kind(of(one, "kind")), b = td_rig_kind(of(two, "kind"));
    /* an event and a frame sensor may share a place behind a beam splitter */
    if (a != b && a != TIDES_RIG_BOTH && b != TIDES_RIG_BOTH) return TIDES_OK;
    double t[16], u[16], apart = 0;
    td_rig_transform(of(one, "T_B_C"), t);
    td_rig_transform(of(two, "T_B_C"), u);
    for (int k = 0; k < 3; k++) apart = fmax(apart, fabs(t[4 * k + 3] - u[4 * k + 3]));
    if (apart > 0) return TIDES_OK;
    return td_fail(error, TIDES_BAD_CONFIG,
                   "%s: rig.cameras: \"%s\" and \"%s\" are at one place, a baseline of 0: give one of them another T_B_C",
                   where, first, second);
}

tides_status td_rig_check(const cJSON *value, const char *where, tides_error *error) {
    if (!cJSON_IsArray(value)) return bad(where, "rig.cameras", " is a list of {name, T_B_C, kind, camera, sensor ...}", error);
    const cJSON *camera, *item, *other;
    int index = 0;
    cJSON_ArrayForEach(camera, value) {
        char name[TD_KEY_MAX / 2];
        snprintf(name, sizeof name, "rig.cameras[%d]", index++);
        if (!cJSON_IsObject(camera)) return bad(where, name, " isn't an object {name, T_B_C, kind ...}", error);
        tides_status status = TIDES_OK;
        cJSON_ArrayForEach(item, camera) if (status == TIDES_OK) status = check_item(item, name, where, error);
        if (status == TIDES_OK && !of(camera, "name")) status = bad(where, name, ".name is missing, such as \"left\"", error);
        for (other = value->child; status == TIDES_OK && other != camera; other = other->next)
            status = check_pair(other, camera, where, error);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}
