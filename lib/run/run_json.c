/* Reads a run file's JSON text and --set assignments into one value per row of the table. */
#include "td_run.h"

#include <stdlib.h>
#include <string.h>

tides_status td_run_store(tides_run *run, const tides_param *row, const cJSON *value, tides_error *error) {
    const int32_t is_number = strcmp(row->key, "seed") == 0 && cJSON_IsNumber(value); /* stored as text, which holds 64 bits */
    const int32_t is_switch = row->type == TIDES_PARAM_CHOICE && cJSON_IsBool(value);
    char digits[24];
    if (is_number) snprintf(digits, sizeof digits, "%.0f", value->valuedouble);
    cJSON *copy =
        is_number || is_switch ? cJSON_CreateString(is_number ? digits : td_choice_text(value)) : cJSON_Duplicate(value, 1);
    if (!copy) return td_fail(error, TIDES_NO_MEMORY, "out of memory: copying %s", row->key);
    cJSON **place = &run->values[row - tides_params(NULL)];
    cJSON_Delete(*place);
    *place = copy;
    return TIDES_OK;
}

/* Checks a value. It stands here, and not with checks of single rows, because cameras of a rig have values of other rows. */
static tides_status check_value(const tides_param *row, const cJSON *value, const char *where, tides_error *error) {
    const int32_t is_rig = strcmp(row->key, "rig.cameras") == 0 && !td_param_is_default(row, value);
    return is_rig ? td_rig_check(value, where, error) : td_param_check(row, value, where, error);
}

/* Reads one object of the file; `group` is its dotted key ("" at the top). Recursion ends with the table's groups. */
static tides_status read_object(tides_run *run, const cJSON *object, const char *group, tides_error *error) {
    const cJSON *item;
    cJSON_ArrayForEach(item, object) {
        char key[TD_KEY_MAX];
        int length = snprintf(key, sizeof key, "%s%s%s", group, group[0] ? "." : "", item->string);
        const tides_param *row = td_param_find(key);
        int32_t is_group = td_param_is_group(key);
        if (length < 0 || (size_t)length >= sizeof key || !(row || is_group)) return td_param_unknown(run->origin, key, error);
        /* "sensor.b_min" is also accepted as a key, as in --set, so a value may be given twice in two ways. */
        if (td_is_repeated(item) || (row && run->given[row - tides_params(NULL)] == TD_GIVEN_FILE))
            return td_given_twice(run->origin, key, error);
        if (is_group && !cJSON_IsObject(item))
            return td_fail(error, TIDES_BAD_CONFIG, "%s: %s is not an object; write \"%s\": { ... }", run->origin, key,
                           item->string);
        tides_status status = row ? check_value(row, item, run->origin, error) : read_object(run, item, key, error);
        if (status == TIDES_OK && row) status = td_run_store(run, row, item, error);
        if (status != TIDES_OK) return status;
        if (row) run->given[row - tides_params(NULL)] = TD_GIVEN_FILE;
    }
    return TIDES_OK;
}

/* Offset at which cJSON failed. If it expected the quote of a key, its offset is one too large. */
static size_t error_offset(const char *text, size_t bytes, const char *at) {
    size_t offset = at && at >= text ? (size_t)(at - text) : 0;
    if (offset > bytes) offset = bytes;
    if (offset < 2 || strchr("\" \t\r\n", text[offset - 1])) return offset;
    size_t before = offset - 1;
    while (before > 0 && strchr(" \t\r\n", text[before - 1])) before--;
    return before > 0 && (text[before - 1] == '{' || text[before - 1] == ',') ? offset - 1 : offset;
}

/* The error for text that isn't JSON. */
static tides_status bad_syntax(const tides_run *run, const char *text, size_t bytes, const char *at, tides_error *error) {
    size_t offset = error_offset(text, bytes, at), line = 1, column = 1;
    for (size_t i = 0; i < offset; i++) {
        column = text[i] == '\n' ? 1 : column + 1;
        line += text[i] == '\n';
    }
    char near_it[24];
    const size_t blank = strspn(text, " \t\r\n\xEF\xBB\xBF"); /* also a byte order mark */
    const int32_t is_json = text[blank] == '{' || text[blank] == '[' || !text[blank];
    snprintf(near_it, sizeof near_it, "%.20s", text + (is_json ? offset : blank));
    near_it[strcspn(near_it, "\r\n")] = '\0';
    td_one_line(near_it);
    if (!is_json)
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: isn't a run file, which is one JSON object { ... }: it begins with \"%s\"; tides info says what it "
                       "is",
                       run->origin, near_it);
    return td_fail(error, TIDES_BAD_CONFIG,
                   "%s:%zu:%zu: not valid JSON from here on: %s%s%s; look for a comma, quote or brace too many or too few",
                   run->origin, line, column, near_it[0] ? "\"" : "", near_it[0] ? near_it : "end of line",
                   near_it[0] ? "\"" : "");
}

/* Replaces // comments by spaces, and also a comma before a closing bracket: one remains when the last lines of a template
 * are commented out. Errors keep their line and column. */
static void blank_comments(char *text, size_t bytes) {
    int32_t quoted = 0;
    char *comma = NULL; /* the last character, if it is a comma */
    for (size_t i = 0; i < bytes; i++) {
        if (!quoted && text[i] == '/' && i + 1 < bytes && text[i + 1] == '/')
            while (i < bytes && text[i] != '\n' && text[i] != '\r') text[i++] = ' ';
        if (quoted && text[i] == '\\')
            i++;
        else if (text[i] == '"')
            quoted = !quoted;
        if (i >= bytes || strchr(" \t\r\n", text[i])) continue;
        if (comma && (text[i] == '}' || text[i] == ']')) *comma = ' ';
        comma = text[i] == ',' && !quoted ? &text[i] : NULL;
    }
}

static tides_status read_text(tides_run *run, const char *text, size_t bytes, tides_error *error) {
    const char *end = NULL;
    cJSON *root = cJSON_ParseWithLengthOpts(text, bytes + 1, &end, 1);
    if (!root) return bad_syntax(run, text, bytes, end, error);
    tides_status status = cJSON_IsObject(root)
                              ? read_object(run, root, "", error)
                              : td_fail(error, TIDES_BAD_CONFIG, "%s: a run file is one JSON object { ... }", run->origin);
    cJSON_Delete(root);
    return status;
}

tides_status td_run_read(tides_run *run, const char *text, size_t bytes, tides_error *error) {
    const char *nul = memchr(text, '\0', bytes);
    if (nul) return td_fail(error, TIDES_BAD_CONFIG, "%s: byte %zu is 0; not a text file", run->origin, (size_t)(nul - text));
    char *plain = td_alloc(bytes + 1, 1, error);
    if (!plain) return TIDES_NO_MEMORY;
    memcpy(plain, text, bytes);
    blank_comments(plain, bytes);
    tides_status status = read_text(run, plain, bytes, error);
    free(plain);
    return status;
}

/* The value of an assignment: parsed as JSON if possible, unless the row holds text; otherwise the bare text. So device=0,
 * seed=18446744073709551615 and scene.file=a.ply need no quotes. */
static cJSON *assigned_value(const tides_param *row, const char *text) {
    cJSON *value = cJSON_ParseWithOpts(text, NULL, 1);
    const int32_t holds_text = row->type == TIDES_PARAM_STRING || row->type == TIDES_PARAM_CHOICE;
    const int32_t nullable = row->fallback && strcmp(row->fallback, "null") == 0;
    if (value && holds_text && !cJSON_IsString(value) && !(nullable && cJSON_IsNull(value))) {
        cJSON_Delete(value);
        value = NULL;
    }
    return value ? value : cJSON_CreateString(text);
}

tides_status td_run_override(tides_run *run, const char *assignment, tides_error *error) {
    const char *equals = strchr(assignment, '=');
    if (!equals || equals == assignment)
        return td_fail(error, TIDES_BAD_CONFIG, "--set %.100s: write key=value, such as sensor.threshold_on=0.3", assignment);
    char key[TD_KEY_MAX];
    snprintf(key, sizeof key, "%.*s", (int)(equals - assignment < TD_KEY_MAX ? equals - assignment : TD_KEY_MAX), assignment);
    const tides_param *row = td_param_find(key);
    if (!row && td_param_is_group(key))
        return td_fail(error, TIDES_BAD_CONFIG, "--set: %s is a group of keys; set one of them, such as %s.NAME=value", key,
                       key);
    if (!row) return td_param_unknown("--set", key, error);
    cJSON *value = assigned_value(row, equals + 1);
    if (!value) return td_fail(error, TIDES_NO_MEMORY, "out of memory: reading --set %s", key);
    tides_status status = check_value(row, value, "--set", error);
    if (status == TIDES_OK) status = td_run_store(run, row, value, error);
    if (status == TIDES_OK) run->given[row - tides_params(NULL)] = TD_GIVEN_SET;
    cJSON_Delete(value);
    return status;
}
