/* TIDES's own path file, JSON:
 *
 *   {
 *     "format": "tides-path", "version": 1,
 *     "intrinsics": {"width": 346, "height": 260, "fx": 250, "fy": 250, "cx": 173, "cy": 130,
 *                    "lens": {"model": "radtan", "k1": -0.3, "k2": 0.1, "p1": 0, "p2": 0, "k3": 0}},     (may be left out)
 *     "samples": [
 *       {"t": 0.0, "position": [x, y, z], "quaternion": [w, x, y, z],                             body to world
 *        "velocity": [x, y, z], "angular_velocity": [x, y, z]},                                   both or neither; world axes
 *       ...
 *     ],
 *     "open": false                     (may be left out) true: a live run's open path, with cubics between them
 *   }
 *
 * Times are seconds, in strictly increasing order. Instead of "samples" the file may hold one generator, with the fields of
 * its struct in trajectory.h:
 *
 *   "orbit":    {"target", "up", "radius", "height" (0), "start_angle" (0), "angular_speed", "start" (0), "stop"}
 *   "dolly":    {"from", "to", "target", "up", "start" (0), "stop"}
 *   "handheld": {"position", "target", "up", "position_amplitude", "rotation_amplitude", "frequency", "seed" (0),
 *                "start" (0), "stop"}
 *
 * Values in brackets are what a missing key means. A seed above 2^53 must be a string of digits, since JSON numbers are
 * doubles. Unknown and repeated keys are errors. */
#include "camera/td_path_reader.h"
#include "camera/td_lens_models.h"

#include "td_base.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define TD_PATH_VERSION 1

/* One number or 3-vector of a generator. */
typedef struct field {
    const char *key;
    double *value;
    int count, optional;
} field;

static tides_status read_fields(td_path_reader *reader, const cJSON *object, const char *where, const field *fields) {
    const char *keys[12] = {"seed"}; /* "seed" isn't a number like the others: only "handheld" has it, and read_seed reads it */
    size_t known = strcmp(where, "handheld") == 0;
    for (const field *f = fields; f->key; f++) keys[known++] = f->key;
    keys[known] = NULL;
    tides_status status = td_json_check_keys(reader, object, where, keys);
    for (const field *f = fields; f->key && status == TIDES_OK; f++) {
        if (f->optional && !td_json_has(object, f->key)) continue;
        status = f->count == 1 ? td_json_number(reader, object, where, f->key, f->value)
                               : td_json_vector(reader, object, where, f->key, f->value, f->count);
    }
    return status;
}

static tides_status read_seed(td_path_reader *reader, const cJSON *object, uint64_t *seed) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, "seed");
    if (!item) return TIDES_OK;
    if (cJSON_IsNumber(item) && item->valuedouble >= 0.0 && item->valuedouble <= 0x1p53) {
        *seed = (uint64_t)item->valuedouble;
        if ((double)*seed == item->valuedouble) return TIDES_OK;
    }
    if (cJSON_IsString(item) && *item->valuestring && !item->valuestring[strspn(item->valuestring, "0123456789")]) {
        errno = 0;
        unsigned long long number = strtoull(item->valuestring, NULL, 10);
        *seed = number;
        if (errno == 0 && number <= UINT64_MAX) return TIDES_OK;
    }
    return td_json_fail(reader, "handheld", "seed",
                        "must be a whole number from 0 to 2^53, or a string of digits for more (below 2^64)");
}

/* Applies the options `start` and `rebase` to a generated path, as they apply to samples. */
static void shift_range(const td_path_reader *reader, double *start, double *stop) {
    const td_path_sample first = {.time = *start};
    double origin = td_path_origin(reader, &first).time;
    *start -= origin;
    *stop -= origin;
}

static tides_status read_orbit(td_path_reader *reader, const cJSON *object) {
    tides_orbit orbit = {.radius = 0.0};
    const field fields[] = {{"target", orbit.target, 3, 0},
                            {"up", orbit.up, 3, 0},
                            {"radius", &orbit.radius, 1, 0},
                            {"height", &orbit.height, 1, 1},
                            {"start_angle", &orbit.start_angle, 1, 1},
                            {"angular_speed", &orbit.angular_speed, 1, 0},
                            {"start", &orbit.start, 1, 1},
                            {"stop", &orbit.stop, 1, 0},
                            {NULL, NULL, 0, 0}};
    tides_status status = read_fields(reader, object, "orbit", fields);
    if (status != TIDES_OK) return status;
    shift_range(reader, &orbit.start, &orbit.stop);
    return tides_trajectory_create_orbit(&orbit, &reader->path.trajectory, reader->error);
}

static tides_status read_dolly(td_path_reader *reader, const cJSON *object) {
    tides_dolly dolly = {.start = 0.0};
    const field fields[] = {{"from", dolly.from, 3, 0}, {"to", dolly.to, 3, 0},        {"target", dolly.target, 3, 0},
                            {"up", dolly.up, 3, 0},     {"start", &dolly.start, 1, 1}, {"stop", &dolly.stop, 1, 0},
                            {NULL, NULL, 0, 0}};
    tides_status status = read_fields(reader, object, "dolly", fields);
    if (status != TIDES_OK) return status;
    shift_range(reader, &dolly.start, &dolly.stop);
    return tides_trajectory_create_dolly(&dolly, &reader->path.trajectory, reader->error);
}

static tides_status read_handheld(td_path_reader *reader, const cJSON *object) {
    tides_handheld hand = {.start = 0.0};
    const field fields[] = {{"position", hand.position, 3, 0},
                            {"target", hand.target, 3, 0},
                            {"up", hand.up, 3, 0},
                            {"position_amplitude", &hand.position_amplitude, 1, 0},
                            {"rotation_amplitude", &hand.rotation_amplitude, 1, 0},
                            {"frequency", &hand.frequency, 1, 0},
                            {"start", &hand.start, 1, 1},
                            {"stop", &hand.stop, 1, 0},
                            {NULL, NULL, 0, 0}};
    tides_status status = read_fields(reader, object, "handheld", fields);
    if (status == TIDES_OK) status = read_seed(reader, object, &hand.seed);
    if (status != TIDES_OK) return status;
    shift_range(reader, &hand.start, &hand.stop);
    return tides_trajectory_create_handheld(&hand, &reader->path.trajectory, reader->error);
}

static tides_status read_sample(td_path_reader *reader, const cJSON *item, const char *where, td_path_sample *sample) {
    static const char *const keys[] = {"t", "position", "quaternion", "velocity", "angular_velocity", NULL};
    tides_pose_sample *pose = &sample->pose;
    double time = 0.0;
    tides_status status = td_json_check_keys(reader, item, where, keys);
    if (status == TIDES_OK) status = td_json_number(reader, item, where, "t", &time);
    if (status == TIDES_OK) status = td_json_vector(reader, item, where, "position", pose->position, 3);
    if (status == TIDES_OK) status = td_json_vector(reader, item, where, "quaternion", pose->quaternion, 4);
    sample->time = time;
    pose->has_rates = td_json_has(item, "velocity") || td_json_has(item, "angular_velocity");
    if (status != TIDES_OK || !pose->has_rates) return status;
    status = td_json_vector(reader, item, where, "velocity", pose->velocity, 3);
    return status == TIDES_OK ? td_json_vector(reader, item, where, "angular_velocity", pose->angular_velocity, 3) : status;
}

static tides_status read_samples(td_path_reader *reader, const cJSON *list) {
    if (!cJSON_IsArray(list)) return td_json_fail(reader, "", "samples", "must be a list");
    const cJSON *item;
    size_t index = 0;
    reader->list = "samples";
    cJSON_ArrayForEach(item, list) {
        char where[48];
        snprintf(where, sizeof where, "samples[%zu]", index);
        td_path_sample *sample = td_path_append(reader, index++);
        tides_status status = sample ? read_sample(reader, item, where, sample) : TIDES_NO_MEMORY;
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

/* Reads a lens such as {"model": "radtan"}, and the coefficients, which are 0 if missing. */
static tides_status read_lens(td_path_reader *reader, const cJSON *object, tides_lens *lens) {
    static const char where[] = "intrinsics.lens";
    const char *keys[TD_COEFFICIENTS_MAX + 2] = {"model"};
    memcpy(keys + 1, td_lens_key, sizeof td_lens_key);
    const cJSON *model = cJSON_GetObjectItemCaseSensitive(object, "model");
    tides_status status = td_json_check_keys(reader, object, where, keys);
    if (status != TIDES_OK) return status;
    const char *name = cJSON_IsString(model) ? model->valuestring : "";
    lens->model = td_lens_named(name);
    if (lens->model <= TIDES_LENS_NONE) {
        char choices[TD_LENS_WORDS];
        return td_fail(reader->error, TIDES_BAD_FILE, "%s: %s.model: must be %s", reader->file, where,
                       td_lens_choices(choices));
    }
    for (int k = 0; k < TD_COEFFICIENTS_MAX && status == TIDES_OK; k++)
        if (td_json_has(object, td_lens_key[k]))
            status = td_json_number(reader, object, where, td_lens_key[k], td_lens_at(lens, k));
    return status;
}

static tides_status read_intrinsics(td_path_reader *reader, const cJSON *object, tides_intrinsics *out) {
    static const char *const keys[] = {"width", "height", "fx", "fy", "cx", "cy", "lens", NULL};
    const char *where = "intrinsics";
    double *values[] = {&out->fx, &out->fy, &out->cx, &out->cy};
    tides_status status = td_json_check_keys(reader, object, where, keys);
    if (status == TIDES_OK) status = td_json_pixels(reader, object, where, "width", &out->width);
    if (status == TIDES_OK) status = td_json_pixels(reader, object, where, "height", &out->height);
    for (int k = 0; k < 4 && status == TIDES_OK; k++) status = td_json_number(reader, object, where, keys[2 + k], values[k]);
    if (status == TIDES_OK && td_json_has(object, "lens"))
        status = read_lens(reader, cJSON_GetObjectItemCaseSensitive(object, "lens"), &out->lens);
    if (status == TIDES_OK && !(out->fx > 0.0 && out->fy > 0.0))
        return td_json_fail(reader, where, "fx, fy", "must be above 0");
    return status;
}

static tides_status check_root(td_path_reader *reader, const cJSON *root) {
    static const char *const keys[] = {"format", "version", "intrinsics", "open", "samples",
                                       "orbit",  "dolly",   "handheld",   NULL};
    enum { SOURCES = 4 }; /* keys from here on are sources of the path */
    double version = 0.0;
    tides_status status = td_json_check_keys(reader, root, "", keys);
    if (status == TIDES_OK) status = td_json_number(reader, root, "", "version", &version);
    if (status != TIDES_OK) return status;
    if (version != TD_PATH_VERSION)
        return td_fail(reader->error, TIDES_UNSUPPORTED, "%s: version %g; this TIDES reads version %d", reader->file, version,
                       TD_PATH_VERSION);
    if (td_json_has(root, "open") && !td_json_has(root, "samples"))
        return td_json_fail(reader, "", "open", "is of samples; a generator's path is known as a whole");
    int sources = 0;
    for (int k = SOURCES; keys[k]; k++) sources += td_json_has(root, keys[k]);
    if (sources == 1) return TIDES_OK;
    return td_fail(reader->error, TIDES_BAD_FILE,
                   "%s: needs exactly one of \"samples\", \"orbit\", \"dolly\", \"handheld\", but has %d", reader->file,
                   sources);
}

tides_status td_path_read_tides(td_path_reader *reader, const cJSON *root) {
    static const struct {
        const char *key;
        tides_status (*read)(td_path_reader *reader, const cJSON *object);
    } generators[] = {{"orbit", read_orbit}, {"dolly", read_dolly}, {"handheld", read_handheld}};
    strcpy(reader->path.format, "tides");
    tides_status status = check_root(reader, root);
    const cJSON *intrinsics = cJSON_GetObjectItemCaseSensitive(root, "intrinsics");
    if (status == TIDES_OK && intrinsics) status = read_intrinsics(reader, intrinsics, &reader->path.intrinsics);
    if (status != TIDES_OK) return status;
    for (int k = 0; k < 3; k++) {
        const cJSON *object = cJSON_GetObjectItemCaseSensitive(root, generators[k].key);
        if (!object) continue;
        status = generators[k].read(reader, object);
        if (status != TIDES_BAD_ARGUMENT) return status;
        td_fail_within(reader->error, status, "%s", reader->file);
        if (reader->error) reader->error->status = TIDES_BAD_FILE;
        return TIDES_BAD_FILE;
    }
    const cJSON *open = cJSON_GetObjectItemCaseSensitive(root, "open");
    if (open && !cJSON_IsBool(open)) return td_json_fail(reader, "", "open", "must be true or false");
    reader->is_open = cJSON_IsTrue(open);
    return read_samples(reader, cJSON_GetObjectItemCaseSensitive(root, "samples"));
}
