/* One value of a preset, with what is known about it:
 *
 *   "value"   value of the key
 *   "spread"  [low, high] for numbers: range over cameras, over their settings, or of the measurement's uncertainty
 *   "kind"    documented, measured, derived (by a formula), or guess
 *   "source"  where to look it up; for a guess, the reason
 *
 * A user's own presets may leave out all but the value. */
#include "td_run.h"

#include <string.h>

static tides_status bad(tides_error *error, const char *where, const tides_param *row, const char *why) {
    return td_fail(error, TIDES_BAD_CONFIG, "%s: %s%s", where, row->key, why);
}

static int32_t is_kind(const cJSON *item) {
    static const char *const kinds[] = {"documented", "measured", "derived", "guess"};
    for (size_t i = 0; cJSON_IsString(item) && i < sizeof kinds / sizeof *kinds; i++)
        if (strcmp(item->valuestring, kinds[i]) == 0) return 1;
    return 0;
}

static int32_t is_spread(const cJSON *item, const cJSON *value) {
    const cJSON *low = cJSON_GetArrayItem(item, 0), *high = cJSON_GetArrayItem(item, 1);
    if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != 2 || !cJSON_IsNumber(value)) return 0;
    return cJSON_IsNumber(low) && cJSON_IsNumber(high) && low->valuedouble <= value->valuedouble &&
           value->valuedouble <= high->valuedouble;
}

tides_status td_preset_entry(const tides_param *row, const cJSON *item, const char *where, const cJSON **value,
                             tides_error *error) {
    const cJSON *part;
    *value = cJSON_IsObject(item) ? cJSON_GetObjectItemCaseSensitive(item, "value") : item;
    if (!*value) return bad(error, where, row, " has no value; write { \"value\": ..., \"source\": \"...\" }");
    if (cJSON_IsObject(item)) {
        cJSON_ArrayForEach(part, item) {
            if (strcmp(part->string, "spread") == 0 && !is_spread(part, *value))
                return bad(error, where, row, ": spread must be [low, high] with the value, a number, between them");
            if (strcmp(part->string, "kind") == 0 && !is_kind(part))
                return bad(error, where, row, ": kind must be documented, measured, derived or guess");
            if (strcmp(part->string, "source") == 0 && !cJSON_IsString(part))
                return bad(error, where, row, ": source must be a text");
            if (strcmp(part->string, "value") != 0 && strcmp(part->string, "spread") != 0 &&
                strcmp(part->string, "kind") != 0 && strcmp(part->string, "source") != 0)
                return bad(error, where, row, ": holds more than value, spread, kind and source");
            if (td_is_repeated(part)) return bad(error, where, row, ": holds value, spread, kind or source twice; keep one");
        }
    }
    return td_param_check(row, *value, where, error);
}

/* A whole number from 1 on. */
static int32_t counts(const cJSON *item) {
    return cJSON_IsNumber(item) && item->valueint >= 1 && item->valuedouble == item->valueint;
}

int32_t td_preset_tells(const cJSON *item) {
    if (strcmp(item->string, "about") == 0) return cJSON_IsString(item) ? 1 : -1;
    if (strcmp(item->string, "version") == 0) return counts(item) ? 1 : -1;
    if (strcmp(item->string, "resolution") != 0) return 0;
    return cJSON_GetArraySize(item) == 2 && counts(cJSON_GetArrayItem(item, 0)) && counts(cJSON_GetArrayItem(item, 1)) ? 1 : -1;
}
