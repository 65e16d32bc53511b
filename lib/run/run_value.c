/* Checks a JSON value against its row of the table: type, range, and choices. */
#include "td_run.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A value as the user wrote it, shortened for an error line. */
typedef struct value_text {
    char text[72];
} value_text;

static value_text show(const cJSON *value) {
    value_text shown = {"?"};
    char *text = cJSON_PrintUnformatted(value);
    if (text) snprintf(shown.text, sizeof shown.text, "%.68s%s", text, strlen(text) > 68 ? "..." : "");
    cJSON_free(text);
    return shown;
}

static tides_status wrong_type(const char *where, const char *key, const cJSON *value, const char *wanted, tides_error *error) {
    if (cJSON_IsString(value) && !value->valuestring[0])
        return td_fail(error, TIDES_BAD_CONFIG, "%s: %s is empty: give %s", where, key, wanted);
    return td_fail(error, TIDES_BAD_CONFIG, "%s: %s = %s is not %s", where, key, show(value).text, wanted);
}

/* 1 for a number beyond double's range (1e999), or a list with one. cJSON_Compare treats such a number as equal to any
 * other. */
static int32_t is_infinite(const cJSON *value) {
    if (cJSON_IsNumber(value)) return isinf(value->valuedouble) ? 1 : 0;
    const cJSON *item;
    for (item = cJSON_IsArray(value) ? value->child : NULL; item; item = item->next)
        if (cJSON_IsNumber(item) && isinf(item->valuedouble)) return 1;
    return 0;
}

int32_t td_param_is_default(const tides_param *row, const cJSON *value) {
    if (is_infinite(value)) return 0;
    cJSON *fallback = row->fallback ? cJSON_Parse(row->fallback) : NULL;
    int32_t same = fallback && cJSON_Compare(value, fallback, 1);
    cJSON_Delete(fallback);
    return same;
}

static tides_status check_number(const tides_param *row, const cJSON *value, const char *where, tides_error *error) {
    const int32_t whole = row->type == TIDES_PARAM_INTEGER;
    if (!cJSON_IsNumber(value)) return wrong_type(where, row->key, value, whole ? "a whole number" : "a number", error);
    double number = value->valuedouble;
    if (whole && number != floor(number)) return wrong_type(where, row->key, value, "a whole number", error);
    if (!(number >= row->lower && number <= row->upper)) /* infinities (1e999) are refused here, too */
        return td_fail(error, TIDES_BAD_CONFIG, "%s: %s = %s is out of range; it must lie in [%.10g, %.10g]%s%s", where,
                       row->key, isinf(number) ? "an infinite number" : show(value).text, row->lower, row->upper,
                       row->unit[0] ? " " : "", row->unit);
    return TIDES_OK;
}

static tides_status check_vector(const tides_param *row, const cJSON *value, const char *where, tides_error *error) {
    const int32_t pair = row->type == TIDES_PARAM_VECTOR2;
    const char *wanted = pair ? "a list of 2 numbers" : "a list of 3 numbers";
    if (!cJSON_IsArray(value) || cJSON_GetArraySize(value) != (pair ? 2 : 3))
        return wrong_type(where, row->key, value, wanted, error);
    const cJSON *item;
    cJSON_ArrayForEach(item, value) {
        if (!cJSON_IsNumber(item)) return wrong_type(where, row->key, value, wanted, error);
        if (!(item->valuedouble >= row->lower && item->valuedouble <= row->upper))
            return td_fail(error, TIDES_BAD_CONFIG, "%s: %s = %s is out of range; each number must lie in [%.10g, %.10g]",
                           where, row->key, show(value).text, row->lower, row->upper);
    }
    return TIDES_OK;
}

/* 1 if `choices` ("smooth|inria|gsplat") holds `text`; lists the choices in `names` as "smooth, inria, gsplat". */
static int32_t is_choice(const char *choices, const char *text, char *names, size_t size) {
    int32_t found = 0;
    size_t used = 0;
    for (const char *at = choices; *at;) {
        size_t length = strcspn(at, "|");
        if (strlen(text) == length && memcmp(at, text, length) == 0) found = 1;
        int written = snprintf(names + used, size - used, "%s%.*s", used ? ", " : "", (int)length, at);
        if (written < 0 || (size_t)written >= size - used) break;
        used += (size_t)written;
        at += length + (at[length] == '|');
    }
    return found;
}

const char *td_choice_text(const cJSON *value) {
    if (cJSON_IsBool(value)) return cJSON_IsTrue(value) ? "true" : "false";
    return cJSON_IsString(value) ? value->valuestring : "";
}

static tides_status check_choice(const tides_param *row, const cJSON *value, const char *where, tides_error *error) {
    char names[256], suggestion[TD_SUGGESTION_MAX];
    const char *given = td_choice_text(value);
    if (is_choice(row->choices, given, names, sizeof names)) return TIDES_OK;
    const char *instead = td_param_retired(row->key, given);
    if (instead) return td_fail(error, TIDES_BAD_CONFIG, "%s: %s = \"%s\" is gone: %s", where, row->key, given, instead);
    return td_fail(error, TIDES_BAD_CONFIG, "%s: %s = %s is none of %s%s", where, row->key, show(value).text, names,
                   td_suggest(given, row->choices, "|", suggestion));
}

static tides_status check_seed(const cJSON *value, const char *where, tides_error *error) {
    static const char *const wanted = "a 64-bit number from 0 on, such as 42 (above 2^53 in quotes)";
    const double number = cJSON_IsNumber(value) ? value->valuedouble : 0;
    if (cJSON_IsNumber(value) && number >= 0 && number <= 0x1p53 && number == floor(number)) return TIDES_OK;
    if (!cJSON_IsString(value)) return wrong_type(where, "seed", value, wanted, error);
    const char *text = value->valuestring;
    size_t digits = strspn(text, "0123456789");
    errno = 0;
    if (digits == 0 || text[digits] || digits > 20 || (strtoull(text, NULL, 10), errno == ERANGE))
        return wrong_type(where, "seed", value, wanted, error);
    return TIDES_OK;
}

static tides_status check_string(const tides_param *row, const cJSON *value, const char *where, tides_error *error) {
    if (strcmp(row->key, "seed") == 0) return check_seed(value, where, error);
    if (cJSON_IsString(value) && value->valuestring[0]) return TIDES_OK;
    return wrong_type(where, row->key, value, "a text in quotes", error);
}

const char *const td_object_path_keys[] = {"time_unit", "duration_s", "start_s", NULL};

/* The row of the camera's path whose last name is `name`; NULL if an object's path has no such key. */
static const tides_param *path_row(const char *name) {
    char key[TD_KEY_MAX];
    size_t count;
    const tides_param *rows = tides_params(&count);
    for (const char *const *known = td_object_path_keys; *known; known++) {
        if (strcmp(*known, name) != 0) continue;
        snprintf(key, sizeof key, "camera.%s", name);
        for (size_t i = 0; i < count; i++)
            if (strcmp(rows[i].key, key) == 0) return &rows[i];
    }
    return NULL;
}

static tides_status check_object_path(const char *key, const cJSON *item, const char *where, tides_error *error) {
    tides_param row = *path_row(item->string);
    row.key = key;
    return td_param_check(&row, item, where, error);
}

int32_t td_is_repeated(const cJSON *item) {
    for (const cJSON *other = item->next; other; other = other->next)
        if (strcmp(other->string, item->string) == 0) return 1;
    return 0;
}

tides_status td_given_twice(const char *where, const char *key, tides_error *error) {
    return td_fail(error, TIDES_BAD_CONFIG, "%s: %s is given twice; keep one", where, key);
}

/* Checks a key of an entry of scene.objects; `name` is "scene.objects[i]". */
static tides_status check_object_key(const char *name, const cJSON *item, const char *where, tides_error *error) {
    static const char *const known[] = {"file", "trajectory", "scale", "part", "time_unit", "duration_s", "start_s", NULL};
    char key[TD_KEY_MAX];
    snprintf(key, sizeof key, "%s.%.40s", name, item->string);
    td_one_line(key);
    if (strcmp(item->string, "file") == 0) {
        if (!cJSON_IsString(item) || !item->valuestring[0]) return wrong_type(where, key, item, "a text in quotes", error);
    } else if (strcmp(item->string, "trajectory") == 0) {
        if (!cJSON_IsNull(item) && (!cJSON_IsString(item) || !item->valuestring[0]))
            return wrong_type(where, key, item, "a path file in quotes, or null for an object at rest", error);
    } else if (strcmp(item->string, "part") == 0) {
        if (!cJSON_IsNull(item) && (!cJSON_IsString(item) || !item->valuestring[0]))
            return wrong_type(where, key, item, "a text in quotes, or null for what the file shows first", error);
    } else if (strcmp(item->string, "scale") == 0) {
        if (!cJSON_IsNumber(item)) return wrong_type(where, key, item, "a number", error);
        if (!(item->valuedouble >= 1e-6 && item->valuedouble <= 1e6))
            return td_fail(error, TIDES_BAD_CONFIG, "%s: %s = %s is out of range; it must lie in [1e-06, 1000000]", where, key,
                           show(item).text);
    } else if (path_row(item->string)) {
        tides_status status = check_object_path(key, item, where, error);
        if (status != TIDES_OK) return status;
    } else {
        const char *nearest = tides_nearest_name(item->string, known);
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: unknown key \"%s\"; did you mean \"%s.%s\"? (file, trajectory, scale, part; of the trajectory "
                       "time_unit, duration_s, start_s)",
                       where, key, name, nearest ? nearest : "file");
    }
    return td_is_repeated(item) ? td_given_twice(where, key, error) : TIDES_OK;
}

static tides_status check_objects(const tides_param *row, const cJSON *value, const char *where, tides_error *error) {
    if (!cJSON_IsArray(value)) return wrong_type(where, row->key, value, "a list of {file, trajectory, scale}", error);
    const cJSON *object, *item;
    int index = 0;
    cJSON_ArrayForEach(object, value) {
        char name[TD_KEY_MAX / 2];
        snprintf(name, sizeof name, "%s[%d]", row->key, index++);
        if (!cJSON_IsObject(object)) return wrong_type(where, name, object, "an object {file, trajectory, scale}", error);
        cJSON_ArrayForEach(item, object) {
            tides_status status = check_object_key(name, item, where, error);
            if (status != TIDES_OK) return status;
        }
        if (!cJSON_GetObjectItemCaseSensitive(object, "file"))
            return td_fail(error, TIDES_BAD_CONFIG, "%s: %s.file is missing; name the object's splat file", where, name);
    }
    return TIDES_OK;
}

tides_status td_param_check(const tides_param *row, const cJSON *value, const char *where, tides_error *error) {
    if (td_param_is_default(row, value)) return TIDES_OK;
    switch (row->type) {
        case TIDES_PARAM_NUMBER:
        case TIDES_PARAM_INTEGER: return check_number(row, value, where, error);
        case TIDES_PARAM_BOOLEAN:
            return cJSON_IsBool(value) ? TIDES_OK : wrong_type(where, row->key, value, "true or false", error);
        case TIDES_PARAM_CHOICE: return check_choice(row, value, where, error);
        case TIDES_PARAM_VECTOR2:
        case TIDES_PARAM_VECTOR3: return check_vector(row, value, where, error);
        case TIDES_PARAM_OBJECTS: return check_objects(row, value, where, error);
        default: return check_string(row, value, where, error);
    }
}
