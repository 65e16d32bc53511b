/* Random draws of a batch: "draw": {"count": N, "seed": "S", "set": {KEY: ITEM, ...}} makes N runs. In each run, KEY has a
 * value that is drawn from its item:
 *   - [LOWEST, HIGHEST]: two numbers are a range, and the value is a random number of it.
 *   - [VALUE, ...]: any other list is a choice of values.
 *   - {"of": OTHER, "times": [LOWEST, HIGHEST]}: the value drawn for the key OTHER, times a random number of the range. It
 *     keeps two thresholds near each other, for example. OTHER must have a range, and not be "seed".
 *
 * A run's own key "seed" is derived from S and the run's index, unless the run file or a "set" gives that key. With one seed
 * for all runs, a model trained on them would learn their common noise.
 *
 * The random number behind each value is a function of (S, index of the run, key) alone. So another key, or more runs,
 * changes no other value. */
#include "batch.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* 64 random bits: a hash of "draw", seed, index and key, mixed by the finaliser of splitmix64 (Steele, Lea, Flood 2014). */
static uint64_t random_bits(const char *seed, int index, const char *key) {
    char number[16];
    snprintf(number, sizeof number, "%d", index);
    const char *const texts[] = {"draw", seed, number, key};
    uint64_t bits = tides_fingerprint_text(texts, 4);
    bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ bits >> 27) * 0x94d049bb133111ebu;
    return bits ^ bits >> 31;
}

/* A random number, uniform in [0, 1), of 53 bits. */
static double uniform(const char *seed, int index, const char *key) {
    return ldexp((double)(random_bits(seed, index, key) >> 11), -53);
}

char *batch_draw_seed(const char *seed, int index) {
    return batch_text("seed=\"%" PRIu64 "\"", random_bits(seed, index, "seed"));
}

/* The row of a key in the table of parameters; NULL: no such key, which reading the run will report. */
static const tides_param *row_of(const char *key) {
    size_t count;
    const tides_param *rows = tides_params(&count);
    for (size_t i = 0; i < count; i++)
        if (strcmp(rows[i].key, key) == 0) return &rows[i];
    return NULL;
}

static int32_t is_range(const cJSON *values) {
    return cJSON_GetArraySize(values) == 2 && cJSON_IsNumber(values->child) && cJSON_IsNumber(values->child->next);
}

/* The number at the share `u` (0 to 1) of `range`. For integer keys and "seed" it is a whole number, and may be HIGHEST; "seed"
 * gets it as a text of digits. */
static cJSON *between(const char *key, const cJSON *range, double u) {
    const tides_param *row = row_of(key);
    const double low = range->child->valuedouble, high = range->child->next->valuedouble;
    const int32_t is_seed = strcmp(key, "seed") == 0;
    if (!is_seed && !(row && row->type == TIDES_PARAM_INTEGER)) return cJSON_CreateNumber(low + u * (high - low));
    const double whole = fmin(floor(low + u * (high - low + 1)), high);
    if (!is_seed) return cJSON_CreateNumber(whole);
    char text[32];
    snprintf(text, sizeof text, "%.0f", whole);
    return cJSON_CreateString(text);
}

/* The value of {"of": OTHER, "times": RANGE}: OTHER's value, at the share `of_base` of its range `base`, times the number at
 * the share `u` of RANGE. */
static cJSON *times(const cJSON *item, const cJSON *base, double u, double of_base) {
    const cJSON *range = cJSON_GetObjectItemCaseSensitive(item, "times");
    cJSON *first = between(base->string, base, of_base);
    const double low = range->child->valuedouble, high = range->child->next->valuedouble;
    cJSON *made = cJSON_IsNumber(first) ? cJSON_CreateNumber(first->valuedouble * (low + u * (high - low))) : NULL;
    cJSON_Delete(first);
    return made;
}

static const cJSON *one_of(const cJSON *values, double u) {
    return cJSON_GetArrayItem(values, (int)(u * cJSON_GetArraySize(values)));
}

/* The range in `from` of the key OTHER, if `item` is {"of": OTHER, "times": RANGE}. NULL: `item` has another form, or OTHER is
 * "seed" or has no range. */
static const cJSON *base_of(const cJSON *from, const cJSON *item) {
    const cJSON *of = cJSON_GetObjectItemCaseSensitive(item, "of");
    const cJSON *base = cJSON_IsString(of) && strcmp(of->valuestring, "seed") != 0
                            ? cJSON_GetObjectItemCaseSensitive(from, of->valuestring)
                            : NULL;
    return base && is_range(base) && is_range(cJSON_GetObjectItemCaseSensitive(item, "times")) ? base : NULL;
}

static int32_t is_reversed(const cJSON *range) {
    return is_range(range) && !(range->child->valuedouble <= range->child->next->valuedouble);
}

tides_status batch_check_draws(const batch *b, const cJSON *from, tides_error *error) {
    const cJSON *item;
    cJSON_ArrayForEach(item, from) {
        if (cJSON_IsObject(item) && !base_of(from, item))
            return cli_error(error, TIDES_BAD_CONFIG,
                             "%s: draw: %.100s isn't { \"of\": KEY, \"times\": [LOWEST, HIGHEST] } with another KEY that has "
                             "a range, and isn't seed",
                             b->manifest, item->string);
        if (!cJSON_IsObject(item) && (!cJSON_IsArray(item) || !item->child))
            return cli_error(error, TIDES_BAD_CONFIG,
                             "%s: draw: %.100s has nothing to draw from: write [LOWEST, HIGHEST] or a list of values",
                             b->manifest, item->string);
        if (is_reversed(item) || is_reversed(cJSON_GetObjectItemCaseSensitive(item, "times")))
            return cli_error(error, TIDES_BAD_CONFIG, "%s: draw: %.100s: its lowest is above its highest", b->manifest,
                             item->string);
    }
    return TIDES_OK;
}

cJSON *batch_draw(const cJSON *from, const char *seed, int index) {
    cJSON *drawn = cJSON_CreateObject();
    const cJSON *item;
    cJSON_ArrayForEach(item, from) {
        const double u = uniform(seed, index, item->string);
        const cJSON *base = base_of(from, item);
        cJSON *value = base             ? times(item, base, u, uniform(seed, index, base->string))
                       : is_range(item) ? between(item->string, item, u)
                                        : cJSON_Duplicate(one_of(item, u), 1);
        if (!value || !cJSON_AddItemToObject(drawn, item->string, value)) {
            cJSON_Delete(value);
            cJSON_Delete(drawn);
            return NULL;
        }
    }
    return drawn;
}
