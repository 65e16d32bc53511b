/* Reads rig.file, Kalibr's camchain.yaml, as rig.cameras: cam0, cam1 ... with lens, size and pose. The file's
 * positions are in metres, so scene.metres_per_unit is needed if any camera is away from the body's origin. An entry of
 * rig.cameras overrides values of the file's camera with the same name; a name that isn't in the file is refused. */
#include "camera/td_camchain.h"
#include "camera/td_lens_models.h"
#include "td_kinds.h"
#include "td_run.h"

#include <stdlib.h>
#include <string.h>

enum { FILE_LIMIT = 1 << 20 }; /* [bytes]; a chain of cameras takes a few KB */

static int put_number(cJSON *object, const char *name, double value) {
    return cJSON_AddNumberToObject(object, name, value) != NULL;
}

/* Puts "camera": size, focal lengths, principal point, lens. */
static int put_intrinsics(cJSON *camera, const tides_intrinsics *k) {
    const td_lens_model *model = td_lens_model_of(k->lens.model);
    const double plain[] = {k->fx, k->fy, k->cx, k->cy};
    static const char *const names[] = {"fx", "fy", "cx", "cy"};
    double bent[TD_COEFFICIENTS_MAX];
    td_lens_list(&k->lens, bent);
    cJSON *object = cJSON_AddObjectToObject(camera, "camera");
    int ok = put_number(object, "width", k->width) && put_number(object, "height", k->height) &&
             cJSON_AddStringToObject(object, "lens", model->name) != NULL;
    for (int i = 0; i < 4 && ok; i++) ok = put_number(object, names[i], plain[i]);
    for (int i = 0; i < model->count && ok; i++) ok = put_number(object, model->key[i], bent[i]);
    return ok;
}

static int put_place(cJSON *camera, const double T_B_C[16], double units_per_metre) {
    cJSON *rows = cJSON_AddArrayToObject(camera, "T_B_C");
    int ok = rows != NULL;
    for (int i = 0; i < 4 && ok; i++) {
        double row[4];
        for (int k = 0; k < 4; k++) row[k] = T_B_C[4 * i + k] * (k == 3 && i < 3 ? units_per_metre : 1);
        ok = cJSON_AddItemToArray(rows, cJSON_CreateDoubleArray(row, 4));
    }
    return ok;
}

static cJSON *list_of(const td_camchain *chain, double units_per_metre) {
    cJSON *list = cJSON_CreateArray();
    int ok = list != NULL;
    for (int i = 0; i < chain->count && ok; i++) {
        char name[16];
        cJSON *camera = cJSON_CreateObject();
        snprintf(name, sizeof name, "cam%d", i);
        ok = cJSON_AddItemToArray(list, camera) && cJSON_AddStringToObject(camera, "name", name) &&
             put_place(camera, chain->camera[i].T_B_C, units_per_metre) && put_intrinsics(camera, &chain->camera[i].intrinsics);
    }
    if (ok) return list;
    cJSON_Delete(list);
    return NULL;
}

/* Puts the items of `from` over those of `to`; objects are merged item by item. */
static int merge(cJSON *to, const cJSON *from) {
    const cJSON *item;
    cJSON_ArrayForEach(item, from) {
        cJSON *own = cJSON_GetObjectItemCaseSensitive(to, item->string);
        if (own && cJSON_IsObject(own) && cJSON_IsObject(item)) {
            if (!merge(own, item)) return 0;
            continue;
        }
        cJSON *copy = cJSON_Duplicate(item, 1);
        if (!copy) return 0;
        if (!(own ? cJSON_ReplaceItemInObjectCaseSensitive(to, item->string, copy)
                  : cJSON_AddItemToObject(to, item->string, copy)))
            return 0;
    }
    return 1;
}

static const char *name_of(const cJSON *camera) { return cJSON_GetObjectItemCaseSensitive(camera, "name")->valuestring; }

/* Merges rig.cameras over the file's cameras. */
static tides_status merge_all(const tides_run *run, cJSON *list, const char *file, tides_error *error) {
    const cJSON *given;
    cJSON_ArrayForEach(given, td_run_value(run, "rig.cameras")) {
        cJSON *camera = list->child;
        while (camera && strcmp(name_of(camera), name_of(given)) != 0) camera = camera->next;
        if (!camera)
            return td_fail(error, TIDES_BAD_CONFIG,
                           "%s: rig.cameras: \"%s\" isn't in rig.file %s, whose cameras are cam0 to cam%d", run->origin,
                           name_of(given), file, cJSON_GetArraySize(list) - 1);
        if (!merge(camera, given)) return td_fail(error, TIDES_NO_MEMORY, "out of memory: %s", file);
    }
    return TIDES_OK;
}

static int has_places(const td_camchain *chain) {
    for (int i = 0; i < chain->count; i++)
        for (int k = 3; k < 12; k += 4)
            if (chain->camera[i].T_B_C[k] < 0 || chain->camera[i].T_B_C[k] > 0) return 1;
    return 0;
}

static tides_status read_file(const tides_run *run, const char *file, td_camchain *chain, tides_error *error) {
    char *text = NULL;
    size_t bytes = 0;
    tides_status status = td_read_file(file, FILE_LIMIT, &text, &bytes, error);
    if (status == TIDES_OK && memchr(text, 0, bytes))
        status = td_fail(error, TIDES_BAD_FILE, "%s: has a byte 0; not a text file", file);
    if (status == TIDES_OK) status = td_camchain_parse(file, text, chain, error);
    status = td_kind_judge(file, TD_WANTS_TEXT, status, error);
    free(text);
    return status == TIDES_OK ? status : td_fail_within(error, status, "%s: rig.file", run->origin);
}

/* Replaces rig.cameras by the merged list. run->beneath keeps the run's own value: tides_run_vary makes further runs from
 * it, and their rig.file may be another. */
static tides_status replace(tides_run *run, const cJSON *list, const char *where, tides_error *error) {
    const tides_param *row = td_param_find("rig.cameras");
    const size_t place = (size_t)(row - tides_params(NULL));
    tides_status status = td_rig_check(list, where, error);
    if (status != TIDES_OK) return status;
    if (run->given[place]) {
        run->beneath[place] = cJSON_Duplicate(run->values[place], 1);
        if (!run->beneath[place]) return td_fail(error, TIDES_NO_MEMORY, "out of memory: %s", where);
    }
    run->given[place] = TD_GIVEN_RIG;
    return td_run_store(run, row, list, error);
}

tides_status td_rig_read_file(tides_run *run, tides_error *error) {
    const cJSON *value = td_run_value(run, "rig.file");
    if (!cJSON_IsString(value)) return TIDES_OK;
    char *file = td_run_resolve(run, value->valuestring, error);
    td_camchain *chain = file ? td_alloc(1, sizeof *chain, error) : NULL;
    tides_status status = chain ? read_file(run, file, chain, error) : TIDES_NO_MEMORY;
    const double metres = td_run_number(run, "scene.metres_per_unit");
    cJSON *list = NULL;
    if (status == TIDES_OK && !(metres > 0) && has_places(chain))
        status =
            td_fail(error, TIDES_BAD_CONFIG,
                    "%s: rig.file: its places are in metres, and what a scene unit is isn't known: set scene.metres_per_unit",
                    run->origin);
    if (status == TIDES_OK && !(list = list_of(chain, metres > 0 ? 1 / metres : 1)))
        status = td_fail(error, TIDES_NO_MEMORY, "out of memory: %s", file);
    if (status == TIDES_OK) status = merge_all(run, list, file, error);
    if (status == TIDES_OK) status = replace(run, list, file, error);
    if (status == TIDES_OK) run->imu_body = chain->has_imu;
    cJSON_Delete(list);
    free(chain);
    free(file);
    return status;
}
