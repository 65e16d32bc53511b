/* Rigs: several cameras on one body, in the run file's rig.cameras, of which rig.camera chooses the one that a run is of:
 *
 *     "rig": {"cameras": [{"name": "left"},
 *                         {"name": "right", "T_B_C": [[1, 0, 0, 0.1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
 *                          "kind": "event", "camera": {"fx": 320}, "sensor": {"threshold_on": 0.3}}]}
 *
 * camera.file is then the body's path, p_body = T_B_C p_camera [scene units], and `camera`, `sensor`, `frontend` and `readout`
 * are keys of the run that are another camera's. They win over the file's, and --set wins over them. Whatever runs a run so
 * runs one camera of a rig, with no more to know: simulate, render, batch (a grid over rig.camera), Python, checkpoints. */
#include "camera/td_rotation.h"
#include "td_run.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

/* How far a rotation may be from one, of numbers in a text file. */
#define ROTATION_TOLERANCE 1e-6

static const char *const kinds[] = {"both", "event", "frame"}; /* in the order of TIDES_RIG_* */
enum { KINDS = sizeof kinds / sizeof *kinds };

/* -- one camera ----------------------------------------------------------------------------------------------------------- */

/* Fails with `name` ("rig.cameras[1]") before what is wrong. */
static tides_status bad(const char *where, const char *name, const char *what, tides_error *error) {
    return td_fail(error, TIDES_BAD_CONFIG, "%s: %s%s", where, name, what);
}

/* Folders are called so. */
static int is_name(const cJSON *item) {
    if (!cJSON_IsString(item) || !item->valuestring[0] || strlen(item->valuestring) >= TIDES_RIG_NAME) return 0;
    for (const char *at = item->valuestring; *at; at++)
        if (!isalnum((unsigned char)*at) && *at != '_' && *at != '-') return 0;
    return 1;
}

static int32_t kind_of(const cJSON *item) {
    if (!item) return TIDES_RIG_BOTH;
    for (int32_t i = 0; i < KINDS; i++)
        if (cJSON_IsString(item) && strcmp(item->valuestring, kinds[i]) == 0) return i;
    return -1;
}

/* Rows of 4 numbers, the last of them 0 0 0 1; what isn't given is no displacement. 0 where it isn't such a matrix. */
static int read_transform(const cJSON *item, double transform[16]) {
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

/* Columns of length 1, at right angles, right-handed; and the row that says nothing. */
static int is_rigid(const double t[16]) {
    double c[3][3], cross[3];
    for (int i = 0; i < 9; i++) c[i % 3][i / 3] = t[i / 3 * 4 + i % 3];
    td_cross3(c[0], c[1], cross);
    int good = fabs(t[12]) + fabs(t[13]) + fabs(t[14]) + fabs(t[15] - 1) <= ROTATION_TOLERANCE;
    for (int k = 0; k < 3; k++) good = good && fabs(td_length3(c[k]) - 1) <= ROTATION_TOLERANCE;
    for (int k = 0; k < 3; k++) good = good && fabs(cross[k] - c[2][k]) <= ROTATION_TOLERANCE;
    return good;
}

/* A key of the run that is the camera's own; `group` is "sensor". */
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
        return kind_of(item) >= 0 ? TIDES_OK : bad(where, name, ".kind is none of event, frame, both", error);
    if (strcmp(item->string, "T_B_C") == 0) {
        if (!read_transform(item, transform)) return bad(where, name, ".T_B_C: four rows of four numbers [scene units]", error);
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

/* Two cameras that have one name; or see with one kind of pixel from one place, which makes no stereo. */
static tides_status check_pair(const cJSON *one, const cJSON *two, const char *where, tides_error *error) {
    const char *first = of(one, "name")->valuestring, *second = of(two, "name")->valuestring;
    if (strcmp(first, second) == 0)
        return td_fail(error, TIDES_BAD_CONFIG, "%s: rig.cameras: two are called \"%s\"; give each its name", where, first);
    const int32_t a = kind_of(of(one, "kind")), b = kind_of(of(two, "kind"));
    if (a != b && a != TIDES_RIG_BOTH && b != TIDES_RIG_BOTH) return TIDES_OK; /* behind one beam splitter */
    double t[16], u[16], apart = 0;
    read_transform(of(one, "T_B_C"), t);
    read_transform(of(two, "T_B_C"), u);
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

/* The camera that rig.camera names, the first where it names none; NULL without a rig. */
static const cJSON *chosen(const tides_run *run) {
    const cJSON *name = td_run_value(run, "rig.camera"), *camera;
    cJSON_ArrayForEach(camera, td_run_value(run, "rig.cameras")) {
        if (!cJSON_IsString(name) || strcmp(of(camera, "name")->valuestring, name->valuestring) == 0) return camera;
    }
    return NULL;
}

/* What a camera has of its own, below what --set says. */
static tides_status apply(tides_run *run, const cJSON *object, const char *group, tides_error *error) {
    const cJSON *item;
    cJSON_ArrayForEach(item, object) {
        char key[TD_KEY_MAX];
        snprintf(key, sizeof key, "%s.%s", group, item->string);
        const tides_param *row = td_param_find(key);
        tides_status status = row ? TIDES_OK : apply(run, item, key, error);
        const size_t place = row ? (size_t)(row - tides_params(NULL)) : 0;
        if (row && run->given[place] != TD_GIVEN_SET) {
            run->beneath[place] = run->given[place] ? cJSON_Duplicate(run->values[place], 1) : NULL;
            if (run->given[place] && !run->beneath[place])
                return td_fail(error, TIDES_NO_MEMORY, "out of memory: a rig's %s", key);
            status = td_run_store(run, row, item, error);
            run->given[place] = TD_GIVEN_RIG;
        }
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

tides_status td_rig_apply(tides_run *run, tides_error *error) {
    static const char *const groups[] = {"camera", "sensor", "frontend", "readout", "filters"};
    const cJSON *name = td_run_value(run, "rig.camera"), *camera = chosen(run);
    if (!camera && cJSON_IsString(name))
        return td_fail(error, TIDES_BAD_CONFIG, "%s: rig.camera = \"%.40s\" is no name of rig.cameras", run->origin,
                       name->valuestring);
    tides_status status = TIDES_OK;
    for (int i = 0; camera && i < 5 && status == TIDES_OK; i++) status = apply(run, of(camera, groups[i]), groups[i], error);
    return status;
}

/* Noise is a function of seed and pixel: two cameras of one seed would have the same. The first keeps the run's; others are
 * 2^64 / phi further each, which hashing spreads. */
uint64_t td_rig_seed(const tides_run *run, uint64_t seed) {
    const cJSON *mine = chosen(run), *camera;
    cJSON_ArrayForEach(camera, td_run_value(run, "rig.cameras")) {
        if (camera == mine) break;
        seed += 0x9e3779b97f4a7c15u;
    }
    return seed;
}

/* -- for readers ---------------------------------------------------------------------------------------------------------- */

static void describe(const cJSON *camera, tides_rig_camera *facts) {
    *facts = (tides_rig_camera){.kind = kind_of(of(camera, "kind"))};
    snprintf(facts->name, sizeof facts->name, "%s", of(camera, "name")->valuestring);
    read_transform(of(camera, "T_B_C"), facts->T_B_C);
}

int32_t tides_run_rig_camera(const tides_run *run, size_t index, tides_rig_camera *camera) {
    const cJSON *cameras = run ? td_run_value(run, "rig.cameras") : NULL;
    const cJSON *item = index < (size_t)cJSON_GetArraySize(cameras) ? cJSON_GetArrayItem(cameras, (int)index) : NULL;
    if (item && camera) describe(item, camera);
    return item != NULL;
}

void td_rig_move_imu(const tides_run *run, double T[16]) {
    const cJSON *camera = chosen(run);
    if (!camera) return;
    tides_rig_camera facts;
    describe(camera, &facts);
    const double *c = facts.T_B_C;
    double made[12];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            made[4 * i + j] = 0;
            for (int k = 0; k < 3; k++) made[4 * i + j] += c[4 * k + i] * (T[4 * k + j] - (j == 3 ? c[4 * k + 3] : 0));
        }
    memcpy(T, made, sizeof made);
}

tides_status td_rig_mount(const tides_run *run, tides_trajectory **path, tides_error *error) {
    const cJSON *camera = chosen(run);
    if (!camera) return TIDES_OK;
    tides_rig_camera facts;
    describe(camera, &facts);
    const double *t = facts.T_B_C, rotation[9] = {t[0], t[1], t[2], t[4], t[5], t[6], t[8], t[9], t[10]};
    const double position[3] = {t[3], t[7], t[11]};
    double quaternion[4];
    td_quaternion_from_rotation(rotation, quaternion);
    tides_trajectory *mounted = NULL;
    tides_status status = tides_trajectory_create_mounted(*path, position, quaternion, &mounted, error);
    if (status != TIDES_OK) return status;
    tides_trajectory_destroy(*path);
    *path = mounted;
    return TIDES_OK;
}
