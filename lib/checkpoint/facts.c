/* What makes two simulators parts of one run: everything that decides events, as numbers, and where it is too much for that, as
 * checksums. Left out is what doesn't: the stop (a run may be extended), tiles, batches, and the device as far as it computes
 * in the same precision. */
#include "motion/td_motion.h"
#include "td_checkpoint.h"
#include "td_hash.h"

#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

/* -- checksums of what is looked at -- */

/* A callback's own state isn't seen: the caller answers for it. */
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
    if (tides_trajectory_is_open(trajectory)) *sum = td_hash_words(*sum, &open, sizeof open); /* another curve, same samples */
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

/* Image formation as the renderer resolved it, intrinsics, background and blur included. */
static uint64_t image_checksum(const tides_renderer *renderer) {
    double facts[TD_IMAGE_FACTS];
    td_renderer_image_facts(renderer, facts);
    return td_hash_words(0, facts, sizeof facts);
}

/* -- the facts -- */

tides_status td_facts_gather(const tides_simulator *s, td_fact facts[TD_FACTS], tides_error *error) {
    uint64_t scene = 0, path = 0;
    tides_status status = add_scene(&scene, s->scene, error);
    if (status == TIDES_OK) status = add_trajectory(&path, s->camera, error);
    if (status != TIDES_OK) return status;
    const td_fact gathered[TD_FACTS] = {
        {"numerics of the library", 0, TIDES_NUMERICS, 0},
        {"precision of the device in bits", 0, td_renderer_is_double(s->renderer) ? 64 : 32, 0},
        {"camera.width", 0, s->layout.width, 0},
        {"camera.height", 0, s->layout.height, 0},
        {"sensor.threshold_on", 0, s->sensor.sensor.threshold_on, 0},
        {"sensor.threshold_off", 0, s->sensor.sensor.threshold_off, 0},
        {"sensor.max_events_per_step", 0, s->sensor.sensor.max_events_per_step, 0},
        {"time.start", 0, s->epoch, 0},
        {"stepping.mode", 0, s->given.mode, 0},
        {"stepping.model", 0, s->sensor.model, 0},
        {"stepping.local", 0, s->given.local, 0},
        {"stepping.unit", 0, s->given.unit, 0},
        {"stepping.step_s", 0, s->given.step_s, 0},
        {"stepping.min_step_s", 0, s->given.min_step_s, 0},
        {"stepping.tolerance", 0, s->given.tolerance, 0},
        {"stepping.time_tolerance_s", 0, s->given.time_tolerance_s, 0},
        {"stepping.risk.w_b", 0, s->given.risk.w_b, 0},
        {"stepping.risk.w_c", 0, s->given.risk.w_c, 0},
        {"stepping.risk.w_alpha", 0, s->given.risk.w_alpha, 0},
        {"stepping.slope", 0, s->given.slope, 0},
        {"sensor's other parameters or seed", 1, 0, td_hash_words(0, &s->sensor.sensor, sizeof s->sensor.sensor)},
        {"readout", 1, 0, td_hash_words(0, &s->readout.params, sizeof s->readout.params)},
        {"stepping.interpolate_motion", 0, s->given.interpolates, 0},
        {"stepping.solve", 0, s->solve.on, 0},
        {"scene", 1, 0, scene},
        {"camera path", 1, 0, path},
        {"image parameters or intrinsics", 1, 0, image_checksum(s->renderer)},
    };
    memcpy(facts, gathered, sizeof gathered);
    return TIDES_OK;
}

/* -- run files -- */

enum { KEY_MAX = 128, VALUE_MAX = 100 };

static int may_differ(const char *key) { return strcmp(key, "time.stop") == 0 || strcmp(key, "device") == 0; }

/* A value as short text. */
static void print_value(const cJSON *value, char text[VALUE_MAX]) {
    char *printed = value ? cJSON_PrintUnformatted(value) : NULL;
    snprintf(text, VALUE_MAX, "%s", printed ? printed : "not set");
    cJSON_free(printed);
}

/* The first key, depth first, whose values differ, with both; 0 where there is none. */
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
