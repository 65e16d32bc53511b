/* Rigs: several cameras on one body, from rig.cameras in the run file. A run is of one camera, named by rig.camera:
 *
 *     "rig": {"cameras": [{"name": "left"},
 *                         {"name": "right", "T_B_C": [[1, 0, 0, 0.1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
 *                          "kind": "event", "camera": {"fx": 320}, "sensor": {"threshold_on": 0.3}}]}
 *
 * camera.file is then the body's path, with p_body = T_B_C p_camera [scene units]. `camera`, `sensor`, `frontend` and
 * `readout` hold the camera's own values of keys. They override the file's, and --set overrides them. Any code that handles a
 * run thus handles one camera of a rig: simulate, render, batch (a grid over rig.camera), Python, checkpoints. */
#include "camera/td_rotation.h"
#include "td_run.h"

#include <string.h>

static const cJSON *of(const cJSON *camera, const char *key) { return cJSON_GetObjectItemCaseSensitive(camera, key); }

/* The camera that rig.camera names, or the first one; NULL without a rig. */
static const cJSON *chosen(const tides_run *run) {
    const cJSON *name = td_run_value(run, "rig.camera"), *camera;
    cJSON_ArrayForEach(camera, td_run_value(run, "rig.cameras")) {
        if (!cJSON_IsString(name) || strcmp(of(camera, "name")->valuestring, name->valuestring) == 0) return camera;
    }
    return NULL;
}

/* Applies a camera's own values; --set overrides them. */
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

/* The seed of the rig's camera. Noise depends on seed and pixel, so two cameras with one seed would have equal noise. The
 * first camera has the run's seed; each further one adds 2^64 / 1.618 (the golden ratio), and hashing spreads the sums. */
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
    *facts = (tides_rig_camera){.kind = td_rig_kind(of(camera, "kind"))};
    snprintf(facts->name, sizeof facts->name, "%s", of(camera, "name")->valuestring);
    td_rig_transform(of(camera, "T_B_C"), facts->T_B_C);
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
