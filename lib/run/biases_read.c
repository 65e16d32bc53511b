/* Bias settings from files. A DAVIS' bias is a current, from a coarse value c (0 is the smallest) and a fine value:
 *
 *   jAER       389 nA 8^(c - 5) fine / 256, and its files hold 7 - c
 *   libcaer    libcaer_a[c] fine / 255 (11 pA .. 24.8 uA); rpg_dvs_ros' files hold this c and fine
 *
 * A DVS128's bias is 75 uA code / 2^24 (jAER's Masterbias with its usual resistor). Fine or code 0 means off: it is read as 1,
 * the least current. Only the OFF bias gets a note about it. */
#include "td_biases.h"

#include "td_math.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { LIMIT = 1 << 20 };

static const double libcaer_a[8] = {11e-12, 94e-12, 756e-12, 6054e-12, 48437e-12, 387500e-12, 3.1e-6, 24.8e-6};

static double jaer_current(int32_t coarse, int32_t fine) { return 389e-9 * td_pow(8, coarse - 5) * fine / 256; }
static double libcaer_current(int32_t coarse, int32_t fine) { return libcaer_a[coarse] * fine / 255; }
static double dvs128_current(int32_t code) { return 75e-6 * code / 16777216; }

const td_bias *td_biases_find(const td_biases *biases, const char *name) {
    for (int32_t i = 0; i < biases->count; i++)
        if (strcasecmp(biases->bias[i].name, name) == 0) return &biases->bias[i];
    return NULL;
}

/* Finds or makes the entry of this name; NULL if there are too many, or if the name is empty or too long. */
static td_bias *entry(td_biases *biases, const char *name, size_t length) {
    char own[TD_BIAS_NAME];
    if (length == 0 || length >= sizeof own) return NULL;
    memcpy(own, name, length);
    own[length] = '\0';
    const td_bias *known = td_biases_find(biases, own);
    if (known) return &biases->bias[known - biases->bias];
    if (biases->count == TD_BIASES_MAX) return NULL;
    td_bias *found = &biases->bias[biases->count++];
    *found = (td_bias){.value = -1, .coarse = -1};
    memcpy(found->name, own, length + 1);
    return found;
}

/* -- jAER's preferences --------------------------------------------------------------------------------------------------- */

/* Parses a number up to the closing quote; -1 if it is none. */
static int32_t number_in(const char *text) {
    char *end;
    const long number = strtol(text, &end, 10);
    return end != text && *end == '"' && number >= 0 && number < 1 << 25 ? (int32_t)number : -1;
}

/* Takes an entry: "DAVIS240C.AddressedIPotCF.DiffBn.BitValueCoarse" is the coarse value of DiffBn; "IPot.diff" is the code
 * of a DVS128's diff, "PropheseeConfig.bias.NAME" the value of NAME. */
static void take_entry(td_biases *biases, const char *key, size_t length, int32_t number) {
    char text[160];
    if (length >= sizeof text) return;
    memcpy(text, key, length);
    text[length] = '\0';
    char *name = strstr(text, "AddressedIPotCF."), *plain = strstr(text, "IPot."), *field = NULL;
    /* part of another word, as in ConfigurableIPot.bitViewEnabled */
    if (plain && plain != text && plain[-1] != '.') plain = NULL;
    if (name) {
        name += strlen("AddressedIPotCF.");
        field = strchr(name, '.');
        const int coarse = field && strcmp(field, ".BitValueCoarse") == 0, fine = field && strcmp(field, ".BitValueFine") == 0;
        td_bias *bias = coarse || fine ? entry(biases, name, (size_t)(field - name)) : NULL;
        if (!bias) return;
        biases->kind = TD_BIASES_DAVIS;
        if (coarse) bias->coarse = number >= 0 && number <= 7 ? 7 - number : -1; /* stored inverted */
        if (fine) bias->value = number;
    } else if (plain) {
        td_bias *bias = entry(biases, plain + 5, strlen(plain + 5));
        if (bias) bias->value = number;
        if (bias && !biases->kind) biases->kind = TD_BIASES_DVS128;
    } else if ((name = strstr(text, "PropheseeConfig.bias.")) != NULL) {
        td_bias *bias = entry(biases, name + strlen("PropheseeConfig.bias."), strlen(name + strlen("PropheseeConfig.bias.")));
        if (bias) bias->value = number;
        biases->kind = TD_BIASES_PROPHESEE;
    }
}

static void read_jaer(td_biases *biases, const char *text) {
    for (const char *at = text; (at = strstr(at, "<entry key=\"")) != NULL;) {
        const char *key = at + strlen("<entry key=\""), *end = strchr(key, '"');
        if (!end) return;
        const char *value = strstr(end, "value=\""), *close = strchr(end, '>');
        if (value && close && value < close)
            take_entry(biases, key, (size_t)(end - key), number_in(value + strlen("value=\"")));
        at = end;
    }
}

/* -- text, line by line --------------------------------------------------------------------------------------------------- */

/* Takes a line such as "DiffBn_coarse: 4" or "diffOff: 132". */
static void take_yaml(td_biases *biases, const char *line) {
    const size_t length = strcspn(line, ": \t\n");
    const char *colon = line + length;
    char *end;
    const long number = *colon == ':' ? strtol(colon + 1, &end, 10) : 0;
    if (*colon != ':' || end == colon + 1 || number < 0 || number > 1 << 24) return;
    const int coarse = length > 7 && strncmp(colon - 7, "_coarse", 7) == 0;
    const int fine = length > 5 && strncmp(colon - 5, "_fine", 5) == 0;
    td_bias *bias = entry(biases, line, length - (coarse ? 7 : fine ? 5 : 0));
    if (!bias) return;
    if (coarse)
        bias->coarse = number <= 7 ? (int32_t)number : -1;
    else
        bias->value = (int32_t)number;
    if (coarse || fine) biases->kind = TD_BIASES_DAVIS;
}

/* Takes a line such as "300 % bias_diff": value, then name. */
static int take_bias(td_biases *biases, const char *line) {
    char *end, name[TD_BIAS_NAME] = "";
    const long number = strtol(line, &end, 0);
    if (end == line || sscanf(end, " %*s %39s", name) != 1 || labs(number) > 1 << 24) return 0;
    td_bias *bias = entry(biases, name, strlen(name));
    if (bias) bias->value = (int32_t)number;
    biases->kind = TD_BIASES_PROPHESEE;
    return bias != NULL;
}

/* Takes the pairs of a line: one, or several in YAML's flow style {a: 1, b: 2}. */
static void take_pairs(td_biases *biases, char *line) {
    for (char *pair = line; *pair;) {
        pair += strspn(pair, ",{} \t\r");
        const size_t length = strcspn(pair, ",{}");
        const char stop = pair[length];
        pair[length] = '\0';
        take_yaml(biases, pair);
        pair += length + (stop != '\0');
    }
}

static void read_lines(td_biases *biases, char *text) {
    int bias_file = 0;
    for (char *line = text, *next; line; line = next) {
        next = strchr(line, '\n');
        if (next) *next++ = '\0';
        while (*line == ' ' || *line == '\t') line++;
        if (*line == '\0' && bias_file) return; /* the first empty line ends a .bias file */
        if (*line == '%' || *line == '#' || *line == '\0') continue;
        if (take_bias(biases, line))
            bias_file = 1;
        else
            take_pairs(biases, line);
    }
    if (!biases->kind && td_biases_find(biases, "diff") && td_biases_find(biases, "diffOn")) biases->kind = TD_BIASES_DVS128;
}

/* -- Metavision's settings ------------------------------------------------------------------------------------------------ */

static void read_settings(td_biases *biases, const char *text) {
    cJSON *root = cJSON_Parse(text);
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(root, "ll_biases_state"), "bias");
    const cJSON *item;
    cJSON_ArrayForEach(item, list) {
        const char *name = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(item, "name"));
        const cJSON *value = cJSON_GetObjectItemCaseSensitive(item, "value");
        td_bias *bias = name && cJSON_IsNumber(value) ? entry(biases, name, strlen(name)) : NULL;
        if (bias) bias->value = value->valueint;
        if (bias) biases->kind = TD_BIASES_PROPHESEE;
    }
    biases->settings = root;
}

/* -- files ---------------------------------------------------------------------------------------------------------------- */

static void find_currents(td_biases *biases, int jaer) {
    for (int32_t i = 0; i < biases->count; i++) {
        td_bias *b = &biases->bias[i];
        const int32_t value = b->value > 0 ? b->value : 1;
        if (b->value < 0) continue;
        if (biases->kind == TD_BIASES_DVS128) b->current_a = dvs128_current(value);
        if (biases->kind == TD_BIASES_DAVIS && b->coarse >= 0 && value <= 255)
            b->current_a = jaer ? jaer_current(b->coarse, value) : libcaer_current(b->coarse, value);
    }
}

/* Reads the first LIMIT bytes: an .aedat has events behind its header. */
static tides_status read_start(const char *path, char **text, tides_error *error) {
    FILE *file = fopen(path, "rb");
    if (!file) return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened", path);
    *text = td_alloc(LIMIT + 1, 1, error);
    const size_t got = *text ? fread(*text, 1, LIMIT, file) : 0;
    const int failed = ferror(file);
    fclose(file);
    if (!*text) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < got; i++)
        if (!(*text)[i]) (*text)[i] = ' ';
    if (!failed) return TIDES_OK;
    free(*text);
    return td_fail(error, TIDES_BAD_FILE, "%s: can't be read", path);
}

void td_biases_free(td_biases *biases) {
    cJSON_Delete(biases->settings);
    biases->settings = NULL;
}

tides_status td_biases_read(const char *path, td_biases *biases, tides_error *error) {
    char *text = NULL;
    memset(biases, 0, sizeof *biases);
    tides_status status = read_start(path, &text, error);
    if (status != TIDES_OK) return status;
    const int jaer = strstr(text, "<entry key=\"") != NULL;
    if (jaer)
        read_jaer(biases, text);
    else if (strstr(text, "\"ll_biases_state\""))
        read_settings(biases, text);
    else
        read_lines(biases, text);
    free(text);
    if (!biases->kind || biases->count == 0)
        return td_fail(error, TIDES_BAD_FILE,
                       "%s: holds no biases: known are Metavision's settings (ll_biases_state) and .bias, jAER's .xml and "
                       "the header of .aedat 2, and rpg_dvs_ros' .yaml",
                       path);
    find_currents(biases, jaer);
    return TIDES_OK;
}
