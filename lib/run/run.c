/* A run file as an object: load, parse, and what it says as the library's structs. */
#include "td_run.h"

#include <stdlib.h>
#include <string.h>

/* A run file is a page of text; more is another kind of file given by mistake. */
enum { RUN_FILE_LIMIT = 1 << 22 };

const cJSON *td_run_value(const tides_run *run, const char *key) {
    const tides_param *row = td_param_find(key);
    return row ? run->values[row - tides_params(NULL)] : NULL;
}

double td_run_number(const tides_run *run, const char *key) {
    const cJSON *value = td_run_value(run, key);
    return cJSON_IsNumber(value) ? value->valuedouble : 0.0;
}

static int32_t run_integer(const tides_run *run, const char *key) { return (int32_t)td_run_number(run, key); }

static int32_t run_boolean(const tides_run *run, const char *key) { return cJSON_IsTrue(td_run_value(run, key)) ? 1 : 0; }

/* The text of a row, NULL where it is null. */
static const char *run_text(const tides_run *run, const char *key) {
    const cJSON *value = td_run_value(run, key);
    return cJSON_IsString(value) ? value->valuestring : NULL;
}

static void run_vector(const tides_run *run, const char *key, double vector[3]) {
    for (int i = 0; i < 3; i++) vector[i] = cJSON_GetArrayItem(td_run_value(run, key), i)->valuedouble;
}

char *td_run_resolve(const tides_run *run, const char *path, tides_error *error) {
    if (path[0] == '/' || !run->directory[0]) return td_strdup(path, error);
    const char *slash = run->directory[strlen(run->directory) - 1] == '/' ? "" : "/";
    return td_format(error, "%s%s%s", run->directory, slash, path);
}

/* What no single row can say. */
static tides_status check_whole(const tides_run *run, tides_error *error) {
    size_t count;
    const tides_param *rows = tides_params(&count);
    const int32_t frames = run_text(run, "frames.file") != NULL; /* then there is neither scene nor camera */
    for (size_t i = 0; i < count; i++)
        if (!run->values[i] && !(frames && strcmp(rows[i].key, "camera.file") == 0))
            return td_fail(error, TIDES_BAD_CONFIG, "%s: %s is missing: %s", run->origin, rows[i].key, rows[i].sentence);
    if (frames && run_text(run, "scene.file"))
        return td_fail(error, TIDES_BAD_CONFIG, "%s: scene.file and frames.file are both given; keep one", run->origin);
    if (!frames && !run_text(run, "scene.file") && cJSON_GetArraySize(td_run_value(run, "scene.objects")) == 0)
        return td_fail(error, TIDES_BAD_CONFIG, "%s: scene.file is missing: name a splat file, here or in scene.objects",
                       run->origin);
    if (!frames && strcmp(run_text(run, "method"), "ldati") == 0)
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: method \"ldati\" takes voxel grids: name their .npy, .npz or .h5 in frames.file", run->origin);
    double start = td_run_number(run, "time.start"), stop = td_run_number(run, "time.stop");
    if (stop <= start)
        return td_fail(error, TIDES_BAD_CONFIG, "%s: time.stop = %.15g s is not after time.start = %.15g s", run->origin, stop,
                       start);
    const char *mode = run_text(run, "stepping.mode"), *model = run_text(run, "stepping.model");
    if (strncmp(mode, "error", 5) == 0 && strcmp(model, "hermite") != 0)
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: stepping.model = \"%s\": error control estimates the error of the hermite "
                       "model only; set stepping.mode to \"fixed\" or \"risk\"",
                       run->origin, model);
    return TIDES_OK;
}

/* The texts that are derived from the values: resolved paths and the whole run as JSON. */
static tides_status derive(tides_run *run, tides_error *error) {
    const char *scene_file = run_text(run, "scene.file");
    if (scene_file && !(run->scene_file = td_run_resolve(run, scene_file, error))) return TIDES_NO_MEMORY;
    const char *camera_file = run_text(run, "camera.file");
    if (camera_file && !(run->camera_file = td_run_resolve(run, camera_file, error))) return TIDES_NO_MEMORY;
    tides_status status = td_run_derive_frames(run, error);
    if (status != TIDES_OK) return status;
    return td_run_print(run->values, &run->json, error);
}

static tides_status parse(const char *text, size_t bytes, const char *origin, const char *directory,
                          const char *const *overrides, size_t count, tides_run **run, tides_error *error) {
    tides_status status = TIDES_NO_MEMORY;
    tides_run *made = td_alloc(1, sizeof *made, error);
    if (!made) return status;
    if (!(made->origin = td_strdup(origin, error)) || !(made->directory = td_strdup(directory, error))) goto done;
    size_t rows;
    tides_params(&rows);
    if (!(made->values = td_run_defaults(error)) || !(made->given = td_alloc(rows, sizeof *made->given, error))) goto done;
    status = td_run_read(made, text, bytes, error);
    for (size_t i = 0; status == TIDES_OK && i < count; i++) status = td_run_override(made, overrides[i], error);
    if (status == TIDES_OK) status = td_run_preset(made, error);
    if (status == TIDES_OK) status = check_whole(made, error);
    if (status == TIDES_OK) status = derive(made, error);
    if (status != TIDES_OK) goto done;
    *run = made;
    made = NULL;
done:
    tides_run_destroy(made);
    return status;
}

/* "a/b/run.json" -> "a/b/"; "run.json" -> "". */
static char *directory_of(const char *file, tides_error *error) {
    const char *slash = strrchr(file, '/');
    return td_format(error, "%.*s", slash ? (int)(slash - file + 1) : 0, file);
}

tides_status tides_run_load(const char *file, const char *const *overrides, size_t count, tides_run **run, tides_error *error) {
    if (!file || !run || (count && !overrides))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_run_load: file, run or overrides is NULL");
    char *text = NULL, *directory = NULL;
    size_t bytes = 0;
    tides_status status = td_read_file(file, RUN_FILE_LIMIT, &text, &bytes, error);
    if (status != TIDES_OK) return status;
    directory = directory_of(file, error);
    status = directory ? parse(text, bytes, file, directory, overrides, count, run, error) : TIDES_NO_MEMORY;
    free(directory);
    free(text);
    return status;
}

tides_status tides_run_parse(const char *text, const char *directory, const char *const *overrides, size_t count,
                             tides_run **run, tides_error *error) {
    if (!text || !run || (count && !overrides))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_run_parse: text, run or overrides is NULL");
    return parse(text, strlen(text), "run", directory ? directory : "", overrides, count, run, error);
}

void tides_run_destroy(tides_run *run) {
    if (!run) return;
    td_run_free_values(run->values);
    free(run->given);
    free(run->origin);
    free(run->directory);
    free(run->scene_file);
    free(run->camera_file);
    td_run_free_frames(run);
    free(run->json);
    free(run);
}

int32_t tides_run_gives(const tides_run *run, const char *key) {
    const tides_param *row = run && key ? td_param_find(key) : NULL;
    return row && run->given[row - tides_params(NULL)];
}

/* What a choice's name stands for in the library's structs. */
typedef struct named_constant {
    const char *name; /* NULL ends a list */
    int32_t value;
} named_constant;

static const named_constant rules[] = {{"smooth", TIDES_RULES_SMOOTH},
                                       {"inria", TIDES_RULES_INRIA},
                                       {"gsplat", TIDES_RULES_GSPLAT},
                                       {NULL, 0}};
static const named_constant modes[] = {{"fixed", TIDES_STEPPING_FIXED},
                                       {"risk", TIDES_STEPPING_RISK},
                                       {"error", TIDES_STEPPING_ERROR},
                                       {"error_risk", TIDES_STEPPING_ERROR_RISK},
                                       {NULL, 0}};
static const named_constant laws[] = {{"hold", TIDES_REFRACTORY_HOLD},
                                      {"drop_keep", TIDES_REFRACTORY_DROP_KEEP},
                                      {"drop_consume", TIDES_REFRACTORY_DROP_CONSUME},
                                      {NULL, 0}};
static const named_constant photoreceptors[] = {{"constant", TIDES_PHOTORECEPTOR_CONSTANT},
                                                {"intensity", TIDES_PHOTORECEPTOR_INTENSITY},
                                                {NULL, 0}};
static const named_constant bandwidths[] = {{"first_order", TIDES_BANDWIDTH_FIRST_ORDER},
                                            {"circuit", TIDES_BANDWIDTH_CIRCUIT},
                                            {NULL, 0}};
static const named_constant readouts[] = {{"tiles", TIDES_READOUT_TILES},
                                          {"rows", TIDES_READOUT_ROWS},
                                          {"bottleneck", TIDES_READOUT_BOTTLENECK},
                                          {NULL, 0}};
static const named_constant jitters[] = {{"gaussian", TIDES_JITTER_GAUSSIAN}, {"delay", TIDES_JITTER_DELAY}, {NULL, 0}};
static const named_constant models[] = {{"hermite", TIDES_MODEL_HERMITE},
                                        {"quadratic", TIDES_MODEL_QUADRATIC},
                                        {"linear", TIDES_MODEL_LINEAR},
                                        {"secant", TIDES_MODEL_SECANT},
                                        {NULL, 0}};

static const named_constant psf_domains[] = {{"log", TIDES_PSF_LOG}, {"linear", TIDES_PSF_LINEAR}, {NULL, 0}};

/* The table has checked the name against its choices, so it is in the list. */
static int32_t run_constant(const tides_run *run, const char *key, const named_constant *list) {
    const char *name = run_text(run, key);
    while (list->name && strcmp(list->name, name) != 0) list++;
    return list->value;
}

static void get_image(const tides_run *run, tides_image_params *image) {
    tides_image_params_defaults(image);
    image->rules = run_constant(run, "image.rules", rules);
    image->antialias = run_boolean(run, "image.antialias");
    image->sh_degree = run_integer(run, "image.sh_degree");
    image->dilation = td_run_number(run, "image.dilation");
    image->log_eps = td_run_number(run, "image.log_eps");
    run_vector(run, "image.luminance", image->luminance);
    run_vector(run, "scene.background", image->background);
}

static void get_intrinsics(const tides_run *run, tides_intrinsics *intrinsics) {
    intrinsics->width = run_integer(run, "camera.width");
    intrinsics->height = run_integer(run, "camera.height");
    intrinsics->fx = td_run_number(run, "camera.fx");
    intrinsics->fy = td_run_number(run, "camera.fy");
    intrinsics->cx = td_run_number(run, "camera.cx");
    intrinsics->cy = td_run_number(run, "camera.cy");
}

/* The table has checked that the text is a 64-bit number. */
static uint64_t run_seed(const tides_run *run) { return strtoull(run_text(run, "seed"), NULL, 10); }

static void get_sensor(const tides_run *run, tides_sensor *sensor) {
    tides_sensor_defaults(sensor);
    const struct {
        const char *key;
        double *field;
    } numbers[] = {{"sensor.threshold_on", &sensor->threshold_on},
                   {"sensor.threshold_off", &sensor->threshold_off},
                   {"sensor.threshold_sigma", &sensor->threshold_sigma},
                   {"sensor.threshold_min", &sensor->threshold_min},
                   {"sensor.refractory_s", &sensor->refractory_s},
                   {"sensor.leak_rate_hz", &sensor->leak_rate_hz},
                   {"sensor.leak_sigma", &sensor->leak_sigma},
                   {"sensor.b_min", &sensor->b_min},
                   {"sensor.dead_pixel_fraction", &sensor->dead_pixel_fraction},
                   {"frontend.shot_noise_hz", &sensor->shot_noise_hz},
                   {"frontend.noise_rms", &sensor->noise_rms},
                   {"frontend.noise_cutoff_hz", &sensor->noise_cutoff_hz},
                   {"frontend.hot_pixel_fraction", &sensor->hot_pixel_fraction},
                   {"frontend.hot_pixel_rate_hz", &sensor->hot_pixel_rate_hz},
                   {"frontend.photoreceptor_cutoff_hz", &sensor->photoreceptor_cutoff_hz},
                   {"frontend.circuit.photocurrent_a", &sensor->circuit.photocurrent_a},
                   {"frontend.circuit.dark_current_a", &sensor->circuit.dark_current_a},
                   {"frontend.circuit.gain", &sensor->circuit.gain},
                   {"frontend.circuit.kappa", &sensor->circuit.kappa},
                   {"frontend.circuit.thermal_v", &sensor->circuit.thermal_v},
                   {"frontend.circuit.photodiode_f", &sensor->circuit.photodiode_f},
                   {"frontend.circuit.miller_f", &sensor->circuit.miller_f},
                   {"frontend.circuit.output_s", &sensor->circuit.output_s},
                   {"frontend.circuit.source_follower_hz", &sensor->circuit.source_follower_hz},
                   {"frontend.circuit.difference_hz", &sensor->circuit.difference_hz}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) *numbers[i].field = td_run_number(run, numbers[i].key);
    sensor->max_events_per_step = run_integer(run, "sensor.max_events_per_step");
    sensor->refractory_law = run_constant(run, "sensor.refractory_law", laws);
    sensor->photoreceptor_law = run_constant(run, "frontend.photoreceptor_law", photoreceptors);
    sensor->bandwidth = run_constant(run, "frontend.bandwidth", bandwidths);
    sensor->labels = run_boolean(run, "sensor.labels");
    sensor->seed = run_seed(run);
}

static void get_readout(const tides_run *run, tides_readout *readout) {
    tides_readout_defaults(readout);
    readout->enabled = run_boolean(run, "readout.enabled");
    readout->kind = run_constant(run, "readout.kind", readouts);
    readout->tile_px = run_integer(run, "readout.tile_px");
    readout->k0 = run_integer(run, "readout.k0");
    readout->queue_capacity = run_integer(run, "readout.queue_capacity");
    readout->tick_s = td_run_number(run, "readout.tick_s");
    readout->beta_k = td_run_number(run, "readout.beta_k");
    readout->p0 = td_run_number(run, "readout.p0");
    readout->eta = td_run_number(run, "readout.eta");
    readout->sigma0_s = td_run_number(run, "readout.sigma0_s");
    readout->gamma_sigma_s = td_run_number(run, "readout.gamma_sigma_s");
    readout->jitter_law = run_constant(run, "readout.jitter_law", jitters);
}

void tides_run_get(const tides_run *run, tides_run_values *values) {
    memset(values, 0, sizeof *values);
    get_intrinsics(run, &values->intrinsics);
    get_image(run, &values->image);
    get_sensor(run, &values->sensor);
    get_readout(run, &values->readout);
    const cJSON *surround = td_run_value(run, "frontend.center_surround");
    if (cJSON_IsArray(surround)) {
        values->sensor.surround_lambda_px = cJSON_GetArrayItem(surround, 0)->valuedouble;
        values->sensor.surround_tau_s = cJSON_GetArrayItem(surround, 1)->valuedouble;
    }
    values->sensor.psf_sigma_px = td_run_number(run, "frontend.psf_sigma_px");
    values->sensor.psf_domain = run_constant(run, "frontend.psf_domain", psf_domains);
    tides_stepping_defaults(&values->stepping);
    values->stepping.mode = run_constant(run, "stepping.mode", modes);
    values->stepping.model = run_constant(run, "stepping.model", models);
    values->stepping.step_s = td_run_number(run, "stepping.step_s");
    values->stepping.min_step_s = td_run_number(run, "stepping.min_step_s");
    values->stepping.tolerance = td_run_number(run, "stepping.tolerance");
    values->stepping.time_tolerance_s = td_run_number(run, "stepping.time_tolerance_s");
    values->stepping.local = run_boolean(run, "stepping.local");
    values->stepping.interpolate_motion = run_boolean(run, "scene.interpolate_motion");
    values->stepping.budget = td_run_number(run, "stepping.budget");
    values->stepping.memory_mb = td_run_number(run, "stepping.memory_mb");
    values->stepping.risk.w_b = td_run_number(run, "stepping.risk.w_b");
    values->stepping.risk.w_c = td_run_number(run, "stepping.risk.w_c");
    values->stepping.risk.w_alpha = td_run_number(run, "stepping.risk.w_alpha");
    values->start = td_run_number(run, "time.start");
    values->stop = td_run_number(run, "time.stop");
    values->scene_file = run->scene_file;
    values->camera_file = run->camera_file;
    values->device = run_text(run, "device");
    values->seed = run_text(run, "seed");
    values->method = run_text(run, "method");
    values->json = run->json;
    td_run_get_frames(run, values);
}
