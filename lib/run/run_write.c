/* Converts values to text: the table's defaults, a run with all defaults filled in, and the template for new users. */
#include "td_run.h"

#include <stdlib.h>
#include <string.h>

void td_run_free_values(cJSON **values) {
    size_t count;
    tides_params(&count);
    for (size_t i = 0; values && i < count; i++) cJSON_Delete(values[i]);
    free(values);
}

cJSON **td_run_defaults(tides_error *error) {
    size_t count;
    const tides_param *rows = tides_params(&count);
    cJSON **values = td_alloc(count, sizeof *values, error);
    for (size_t i = 0; values && i < count; i++) {
        if (!rows[i].fallback || (values[i] = cJSON_Parse(rows[i].fallback)) != NULL) continue;
        td_fail(error, TIDES_NO_MEMORY, "out of memory: default of %s", rows[i].key);
        td_run_free_values(values);
        values = NULL;
    }
    return values;
}

/* The object that holds `key`, which is made if it doesn't exist; `last` is the key's last name. NULL: out of memory. */
static cJSON *group_of(cJSON *root, const char *key, const char **last) {
    const char *dot;
    while (root && (dot = strchr(key, '.')) != NULL) {
        char name[TD_KEY_MAX];
        snprintf(name, sizeof name, "%.*s", (int)(dot - key), key);
        cJSON *group = cJSON_GetObjectItemCaseSensitive(root, name);
        root = group ? group : cJSON_AddObjectToObject(root, name);
        key = dot + 1;
    }
    *last = key;
    return root;
}

tides_status td_run_print(cJSON *const *values, char **text, tides_error *error) {
    size_t count;
    const tides_param *rows = tides_params(&count);
    tides_status status = TIDES_OK;
    char *printed = NULL;
    cJSON *root = cJSON_CreateObject();
    for (size_t i = 0; root && i < count; i++) {
        if (!values[i]) continue;
        const char *last = NULL;
        cJSON *group = group_of(root, rows[i].key, &last), *copy = cJSON_Duplicate(values[i], 1);
        if (group && copy && cJSON_AddItemToObject(group, last, copy)) continue;
        cJSON_Delete(copy);
        cJSON_Delete(root);
        root = NULL;
    }
    char *made = root ? cJSON_Print(root) : NULL;
    /* a copy, since the caller uses free(), and cJSON's allocator may not be malloc */
    printed = made ? td_strdup(made, error) : NULL;
    if (printed)
        *text = printed;
    else
        status = td_fail(error, TIDES_NO_MEMORY, "out of memory: writing the run as JSON");
    cJSON_free(made);
    cJSON_Delete(root);
    return status;
}

/* Sets a row to a text, or to null. */
static tides_status put_text(cJSON **values, const char *key, const char *text, tides_error *error) {
    cJSON **place = &values[td_param_find(key) - tides_params(NULL)];
    cJSON *value = text ? cJSON_CreateString(text) : cJSON_CreateNull();
    if (!value) return td_fail(error, TIDES_NO_MEMORY, "out of memory: %s", key);
    cJSON_Delete(*place);
    *place = value;
    return TIDES_OK;
}

tides_status tides_run_template(const char *scene_file, const char *camera_file, char **text, tides_error *error) {
    if (!text) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_run_template: text is NULL");
    cJSON **values = td_run_defaults(error);
    if (!values) return TIDES_NO_MEMORY;
    tides_status status = put_text(values, "scene.file", scene_file ? scene_file : "scene.ply", error);
    if (status == TIDES_OK) status = put_text(values, "camera.file", camera_file ? camera_file : "path.json", error);
    if (status == TIDES_OK) status = td_run_print(values, text, error);
    td_run_free_values(values);
    return status;
}

void tides_free(void *memory) { free(memory); }
