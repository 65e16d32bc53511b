/* Facts by which two simulators are parts of one run: all values that decide events, as numbers, or as checksums if there are
 * too many. Values that don't are left out: the stop (a run may be extended), tiles, batches, and the device, if it computes
 * in the same precision. The parameter table says which keys of a run file decide events. */
#include "motion/td_motion.h"
#include "run/td_params.h"
#include "td_checkpoint.h"
#include "td_hash.h"

#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

/* -- checksums of scene and camera -- */

/* Adds a motion. The state behind a user's callback isn't known: that is the user's responsibility. */
static void add_motion(uint64_t *sum, const tides_object *object) {
    const tides_motion *motion = object->motion;
    const double times[] = {motion->start, motion->stop, object->duration_s};
    *sum = td_hash_words(*sum, motion->type->name, strlen(motion->type->name));
    *sum = td_hash_words(*sum, times, sizeof times);
    for (int i = 0; i < motion->settings; i++) {
        *sum = td_hash_words(*sum, motion->setting[i].name, strlen(motion->setting[i].name));
        *sum = td_hash_words(*sum, &motion->setting[i].value, sizeof motion->setting[i].value);
    }
    for (int i = 0; i < motion->fields; i++) {
        const td_field *field = &motion->field[i];
        size_t count = 1;
        for (int k = 0; k < field->rank; k++) count *= (size_t)field->shape[k];
        *sum = td_hash_words(*sum, field->name, strlen(field->name));
        *sum = td_hash_words(*sum, field->value, count * sizeof *field->value);
    }
}

static tides_status add_trajectory(uint64_t *sum, const tides_trajectory *trajectory, tides_error *error) {
    size_t count = trajectory ? tides_trajectory_count(trajectory) : 0;
    const uint64_t open = 1;
    /* an open path has another curve through the same samples */
    if (tides_trajectory_is_open(trajectory)) *sum = td_hash_words(*sum, &open, sizeof open);
    for (size_t i = 0; i < count; i++) {
        tides_pose_sample sample;
        memset(&sample, 0, sizeof sample);
        tides_status status = tides_trajectory_sample(trajectory, i, &sample, error);
        if (status != TIDES_OK) return status;
        *sum = td_hash_words(*sum, &sample.time, sizeof sample.time);
        *sum = td_hash_words(*sum, sample.position, sizeof sample.position);
        *sum = td_hash_words(*sum, sample.quaternion, sizeof sample.quaternion);
        if (!sample.has_rates) continue;
        *sum = td_hash_words(*sum, sample.velocity, sizeof sample.velocity);
        *sum = td_hash_words(*sum, sample.angular_velocity, sizeof sample.angular_velocity);
    }
    return TIDES_OK;
}

static tides_status add_object(uint64_t *sum, const tides_object *object, tides_error *error) {
    const tides_gaussians *g = &object->gaussians;
    size_t n = (size_t)g->count, k = (size_t)(g->sh_degree + 1) * (size_t)(g->sh_degree + 1);
    *sum = td_hash_words(*sum, &object->scale, sizeof object->scale);
    *sum = td_hash_words(*sum, g->mean, 3 * n * sizeof *g->mean);
    if (g->origin[0] != 0 || g->origin[1] != 0 || g->origin[2] != 0) *sum = td_hash_words(*sum, g->origin, sizeof g->origin);
    *sum = td_hash_words(*sum, g->log_scale, 3 * n * sizeof *g->log_scale);
    *sum = td_hash_words(*sum, g->quaternion, 4 * n * sizeof *g->quaternion);
    *sum = td_hash_words(*sum, g->opacity_logit, n * sizeof *g->opacity_logit);
    *sum = td_hash_words(*sum, g->sh, 3 * k * n * sizeof *g->sh);
    if (object->motion) add_motion(sum, object);
    return add_trajectory(sum, object->trajectory, error);
}

static tides_status add_scene(uint64_t *sum, const tides_scene *scene, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int32_t i = 0; i < tides_scene_objects(scene) && status == TIDES_OK; i++) {
        tides_object object;
        status = tides_scene_object(scene, i, &object, error);
        if (status == TIDES_OK) status = add_object(sum, &object, error);
    }
    return status;
}

/* Checksum of the image formation, with intrinsics, background and blur. */
static uint64_t image_checksum(const tides_renderer *renderer) {
    double facts[TD_IMAGE_FACTS];
    td_renderer_image_facts(renderer, facts);
    return td_hash_words(0, facts, sizeof facts);
}

/* -- the facts -- */

static void add(td_facts *facts, const char *key, double number) {
    if (facts->count < TD_FACTS_MAX) facts->fact[facts->count] = (td_fact){key, 0, number, 0};
    facts->count++;
}

static void add_checksum(td_facts *facts, const char *key, uint64_t checksum) {
    if (facts->count < TD_FACTS_MAX) facts->fact[facts->count] = (td_fact){key, 1, 0, checksum};
    facts->count++;
}

/* Adds the keys of a struct of tides_run_values, by the parameter table; the simulator has the struct at `values`. Choices,
 * whole numbers and switches are int32_t there. */
static void add_keys(td_facts *facts, const void *values, size_t from, size_t size) {
    for (size_t i = 0; i < td_params_count; i++) {
        const td_param *row = &td_params[i];
        if (row->no_event || row->type == TIDES_PARAM_STRING || row->field < from || row->field - from >= size) continue;
        const char *at = (const char *)values + (row->field - from);
        const int numbers = row->type == TIDES_PARAM_VECTOR3 ? 3 : row->type == TIDES_PARAM_VECTOR2 ? 2 : 1;
        double number;
        int32_t whole;
        memcpy(&whole, at, sizeof whole);
        memcpy(&number, at, row->type == TIDES_PARAM_NUMBER ? sizeof number : sizeof whole);
        if (numbers > 1)
            add_checksum(facts, row->key, td_hash_words(0, at, (size_t)numbers * sizeof number));
        else
            add(facts, row->key, row->type == TIDES_PARAM_NUMBER ? number : whole);
    }
}

#define ADD_KEYS(facts, values, member) add_keys(facts, values, offsetof(tides_run_values, member), sizeof *(values))

tides_status td_facts_gather(const tides_simulator *s, td_facts *facts, tides_error *error) {
    const td_saved_run run = td_simulator_saved(s);
    uint64_t scene = 0, path = 0;
    tides_status status = add_scene(&scene, run.scene, error);
    if (status == TIDES_OK) status = add_trajectory(&path, run.camera, error);
    if (status != TIDES_OK) return status;
    facts->count = 0;
    add(facts, "numerics of the library", TIDES_NUMERICS);
    add(facts, "precision of the device in bits", td_renderer_is_double(run.renderer) ? 64 : 32);
    add(facts, "camera.width", run.width);
    add(facts, "camera.height", run.height);
    add(facts, "time.start", run.epoch);
    ADD_KEYS(facts, run.stepping, stepping);
    ADD_KEYS(facts, run.sensor, sensor);
    add_checksum(facts, "sensor's seed or labels", td_hash_words(0, run.sensor, sizeof *run.sensor));
    if (run.maps_checksum) add_checksum(facts, "sensor.maps", run.maps_checksum);
    if (run.kick_checksum) add_checksum(facts, "sensor.kick_times", run.kick_checksum);
    ADD_KEYS(facts, run.readout, readout);
    ADD_KEYS(facts, run.filters, filters);
    add_checksum(facts, "scene", scene);
    add_checksum(facts, "camera path", path);
    add_checksum(facts, "image parameters or intrinsics", image_checksum(run.renderer));
    if (facts->count <= TD_FACTS_MAX) return TIDES_OK;
    return td_fail(error, TIDES_UNSUPPORTED, "a run has %d facts: raise TD_FACTS_MAX", facts->count);
}

/* -- run files -- */

enum { KEY_MAX = 128, VALUE_MAX = 100 };

static int may_differ(const char *key) {
    for (size_t i = 0; i < td_params_count; i++)
        if (td_params[i].no_event && strcmp(td_params[i].key, key) == 0) return 1;
    return 0;
}

/* Formats a value as a short text. */
static void print_value(const cJSON *value, char text[VALUE_MAX]) {
    char *printed = value ? cJSON_PrintUnformatted(value) : NULL;
    snprintf(text, VALUE_MAX, "%s", printed ? printed : "not set");
    cJSON_free(printed);
}

/* Finds the first key, depth first, whose values differ, and both values; 0 if there is none. */
static int find_difference(const cJSON *saved, const cJSON *given, const char *key, char found[KEY_MAX],
                           const cJSON *values[2]) {
    if (may_differ(key) || cJSON_Compare(saved, given, 1)) return 0;
    char inner[KEY_MAX];
    if (cJSON_IsObject(saved) && cJSON_IsObject(given)) {
        const cJSON *item;
        cJSON_ArrayForEach(item, given) {
            snprintf(inner, sizeof inner, "%s%s%s", key, key[0] ? "." : "", item->string);
            if (find_difference(cJSON_GetObjectItemCaseSensitive(saved, item->string), item, inner, found, values)) return 1;
        }
        cJSON_ArrayForEach(item, saved) {
            if (cJSON_GetObjectItemCaseSensitive(given, item->string)) continue;
            snprintf(inner, sizeof inner, "%s%s%s", key, key[0] ? "." : "", item->string);
            if (find_difference(item, NULL, inner, found, values)) return 1;
        }
        return 0;
    }
    snprintf(found, KEY_MAX, "%s", key);
    values[0] = saved;
    values[1] = given;
    return 1;
}

tides_status td_facts_compare_runs(const char *path, const char *saved, const char *given, tides_error *error) {
    cJSON *a = cJSON_Parse(saved), *b = cJSON_Parse(given);
    char key[KEY_MAX] = "", there[VALUE_MAX], here[VALUE_MAX];
    const cJSON *values[2] = {NULL, NULL};
    tides_status status = TIDES_OK;
    if (!a || !b)
        status = td_fail(error, TIDES_BAD_ARGUMENT, "%s: the run file's text %s isn't JSON", path, a ? "given" : "in it");
    else if (find_difference(a, b, "", key, values)) {
        print_value(values[0], there);
        print_value(values[1], here);
        status = td_fail(error, TIDES_BAD_CONFIG, "%s: is of another run: %s is %s there and %s here", path, key, there, here);
    }
    cJSON_Delete(a);
    cJSON_Delete(b);
    return status;
}
