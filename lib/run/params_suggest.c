/* The error for an unknown key. People misspell one part of a key, or put a key into a wrong group. So the suggestion comes
 * from the names possible at that place, or else from equal last names anywhere in the table. */
#include "td_run.h"

#include <string.h>

enum { NAMES_MAX = 256 };

/* Names from the table, without duplicates, NULL-terminated. */
typedef struct name_list {
    char text[NAMES_MAX][TD_KEY_MAX];
    const char *names[NAMES_MAX + 1];
    size_t count;
} name_list;

static void add_name(name_list *list, const char *name, size_t length) {
    if (list->count == NAMES_MAX || length >= TD_KEY_MAX) return;
    for (size_t i = 0; i < list->count; i++)
        if (strlen(list->text[i]) == length && memcmp(list->text[i], name, length) == 0) return;
    memcpy(list->text[list->count], name, length);
    list->text[list->count][length] = '\0';
    list->names[list->count] = list->text[list->count];
    list->names[++list->count] = NULL;
}

/* Collects the names that may follow `group` (with its dot; "" is the top). */
static void names_below(const char *group, size_t length, name_list *list) {
    size_t count;
    const tides_param *rows = tides_params(&count);
    for (size_t i = 0; i < count; i++)
        if (strncmp(rows[i].key, group, length) == 0) add_name(list, rows[i].key + length, strcspn(rows[i].key + length, "."));
}

/* The key whose last name is nearest to `name`; NULL if none is near. */
static const char *nearest_anywhere(const char *name) {
    size_t count;
    const tides_param *rows = tides_params(&count);
    const char *last[NAMES_MAX + 1] = {NULL};
    for (size_t i = 0; i < count && i < NAMES_MAX; i++) {
        const char *dot = strrchr(rows[i].key, '.');
        last[i] = dot ? dot + 1 : rows[i].key;
    }
    const char *nearest = tides_nearest_name(name, last);
    for (size_t i = 0; nearest && i < count && i < NAMES_MAX; i++)
        if (strcmp(last[i], nearest) == 0) return rows[i].key;
    return NULL;
}

/* Length of the leading part of `key` that is a group of the table, with its dot. */
static size_t known_part(const char *key) {
    size_t known = 0;
    char part[TD_KEY_MAX];
    for (const char *dot = strchr(key, '.'); dot; dot = strchr(dot + 1, '.')) {
        size_t length = (size_t)(dot - key);
        if (length >= sizeof part) break;
        memcpy(part, key, length);
        part[length] = '\0';
        if (!td_param_is_group(part)) break;
        known = length + 1;
    }
    return known;
}

/* Joins the list as "a, b, c", cut off where it doesn't fit. */
static void join_names(const name_list *list, char *text, size_t size) {
    size_t used = 0;
    text[0] = '\0';
    for (size_t i = 0; i < list->count && used < size; i++) {
        int length = snprintf(text + used, size - used, "%s%s", i ? ", " : "", list->names[i]);
        used += length > 0 ? (size_t)length : 0;
    }
}

void td_one_line(char *text) {
    for (; *text; text++)
        if ((unsigned char)*text < ' ' || *text == 127) *text = '?';
}

tides_status td_param_unknown(const char *where, const char *given, tides_error *error) {
    char key[TD_KEY_MAX];
    snprintf(key, sizeof key, "%.*s", TD_KEY_MAX - 1, given);
    td_one_line(key);
    const char *instead = td_param_retired(key, NULL);
    if (instead) return td_fail(error, TIDES_BAD_CONFIG, "%s: %s is gone: %s", where, key, instead);
    size_t known = known_part(key), length = strcspn(key + known, ".");
    name_list list = {.count = 0};
    names_below(key, known, &list);
    char name[TD_KEY_MAX];
    snprintf(name, sizeof name, "%.*s", (int)length, key + known);

    const char *near_here = tides_nearest_name(name, list.names);
    if (near_here) { /* keep the rest if that gives a known key: sensr.b_min -> sensor.b_min */
        char whole[3 * TD_KEY_MAX], stem[2 * TD_KEY_MAX];
        snprintf(stem, sizeof stem, "%.*s%s", (int)known, key, near_here);
        snprintf(whole, sizeof whole, "%s%s", stem, key + known + length);
        const char *suggestion = td_param_find(whole) ? whole : stem;
        return td_fail(error, TIDES_BAD_CONFIG, "%s: unknown key \"%s\"; did you mean \"%s\"?", where, key, suggestion);
    }
    const char *dot = strrchr(key, '.');
    const char *elsewhere = nearest_anywhere(dot ? dot + 1 : key);
    if (elsewhere)
        return td_fail(error, TIDES_BAD_CONFIG, "%s: unknown key \"%s\"; did you mean \"%s\"?", where, key, elsewhere);
    char all[400];
    join_names(&list, all, sizeof all);
    return td_fail(error, TIDES_BAD_CONFIG, "%s: unknown key \"%s\"; the names known here are %s", where, key, all);
}
