/* Writes the run file of a made world. */
#include "scene_run.h"

/* Adds an empty object `name`. If memory runs out, printing the text reports it. */
static cJSON *group(cJSON *parent, const char *name) { return cJSON_AddObjectToObject(parent, name); }

static void add_objects(cJSON *scene, const scene_run *run) {
    if (!run->object_file) return;
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "file", run->object_file);
    cJSON_AddStringToObject(object, "trajectory", run->trajectory_file);
    cJSON_AddItemToArray(cJSON_AddArrayToObject(scene, "objects"), object);
}

static cJSON *run_json(const scene_run *run) {
    cJSON *json = cJSON_CreateObject(), *scene = group(json, "scene"), *camera = group(json, "camera"),
          *time = group(json, "time"), *image = group(json, "image"), *sensor = group(json, "sensor"),
          *stepping = group(json, "stepping");
    cJSON_AddStringToObject(scene, "file", run->scene_file);
    cJSON_AddItemToObject(scene, "background", cJSON_CreateDoubleArray(run->world->background, 3));
    add_objects(scene, run);
    cJSON_AddStringToObject(camera, "file", run->camera_file);
    cJSON_AddNumberToObject(time, "start", 0);
    cJSON_AddNumberToObject(time, "stop", run->world->duration_s);
    cJSON_AddStringToObject(image, "rules", "smooth");
    cJSON_AddNumberToObject(image, "log_eps", 0.01);
    cJSON_AddNumberToObject(sensor, "threshold_on", 0.2);
    cJSON_AddNumberToObject(sensor, "threshold_off", 0.2);
    cJSON_AddStringToObject(stepping, "mode", "error");
    cJSON_AddNumberToObject(stepping, "step_s", 0.01);
    if (run->seed) cJSON_AddStringToObject(json, "seed", run->seed); /* without one, each drawn run of a batch has its own */
    return json;
}

tides_status scene_run_write(const char *path, const scene_run *run, tides_error *error) {
    cJSON *json = run_json(run);
    char *text = cJSON_Print(json);
    cJSON_Delete(json);
    if (!text) return cli_error(error, TIDES_NO_MEMORY, "out of memory: %s", path);
    tides_status status = cli_write_text(path, text, error);
    cJSON_free(text);
    return status;
}
