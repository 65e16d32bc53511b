/* JSON of splat files: parsed with a decimal point in any locale, and with checks of the numbers' ranges. */
#include "td_splat_json.h"
#include "td_text.h"

#include <float.h>
#include <math.h>
#include <string.h>

tides_status td_splat_json(const char *path, const char *name, const void *text, size_t size, cJSON **json,
                           tides_error *error) {
    td_plain_numbers numbers;
    tides_status status = td_plain_begin(&numbers, path, error);
    if (status) return status;
    *json = cJSON_ParseWithLength(text, size);
    td_plain_end(&numbers);
    if (*json) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: %s%sisn't valid JSON", path, name ? name : "", name ? ": " : "");
}

int64_t td_json_whole(const cJSON *object, const char *key, int64_t least, int64_t most) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    if (!cJSON_IsNumber(item)) return -1;
    const double value = item->valuedouble;
    return value >= (double)least && value <= (double)most && value == floor(value) ? (int64_t)value : -1;
}

int td_json_numbers(const cJSON *object, const char *key, double *values, int count) {
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(object, key), *item;
    int good = 0;
    if (!cJSON_IsArray(list) || cJSON_GetArraySize(list) != count) return 0;
    cJSON_ArrayForEach(item, list) {
        if (!cJSON_IsNumber(item) || !(fabs(item->valuedouble) <= (double)FLT_MAX)) return 0;
        values[good++] = item->valuedouble;
    }
    return 1;
}

const char *td_json_text(const cJSON *object, const char *key) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    return cJSON_IsString(item) ? item->valuestring : NULL;
}

int td_json_is_below(const char *name) {
    if (*name == '/') return 0;
    for (const char *part = name; part; part = (part = strchr(part, '/')) ? part + 1 : NULL)
        if (strncmp(part, "../", 3) == 0) return 0;
    return 1;
}
