/* tides presets: lists the library's sensors, and the values that they leave to the run. */
#include "info_preset.h"

#include <stdio.h>
#include <string.h>

/* The columns: a key of the preset, and its heading. */
static const struct {
    const char *group, *name, *title;
} columns[] = {{"sensor", "threshold_on", "C+"},        {"sensor", "threshold_off", "C-"},
               {"sensor", "threshold_sigma", "sigma"},  {"frontend", "photoreceptor_cutoff_hz", "pole [Hz]"},
               {"sensor", "leak_rate_hz", "leak [Hz]"}, {"frontend", "shot_noise_hz", "shot [Hz]"},
               {"sensor", "refractory_s", "dead [s]"},  {"image", "log_eps", "black"},
               {"readout", "kind", "readout"}};
enum { COLUMNS = sizeof columns / sizeof *columns, CELL = 24 };

static const cJSON *value_at(const cJSON *preset, int column) {
    const cJSON *group = cJSON_GetObjectItemCaseSensitive(preset, columns[column].group);
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(group, columns[column].name);
    return cJSON_IsObject(item) ? cJSON_GetObjectItemCaseSensitive(item, "value") : item;
}

static void print_row(const char *name, const cJSON *preset, int32_t guesses, int32_t values) {
    const cJSON *size = cJSON_GetObjectItemCaseSensitive(preset, "resolution");
    char cell[CELL] = "-";
    if (cJSON_GetArraySize(size) == 2)
        snprintf(cell, sizeof cell, "%dx%d", cJSON_GetArrayItem(size, 0)->valueint, cJSON_GetArrayItem(size, 1)->valueint);
    printf("%-16s %9s", name, cell);
    for (int c = 0; c < COLUMNS; c++) {
        const cJSON *value = value_at(preset, c);
        snprintf(cell, sizeof cell, "-");
        if (cJSON_IsNumber(value)) snprintf(cell, sizeof cell, "%.3g", value->valuedouble);
        if (cJSON_IsString(value)) snprintf(cell, sizeof cell, "%s", value->valuestring);
        printf(" %9s", cell);
    }
    printf("  %d of %d\n", guesses, values);
}

static cJSON *row_json(const char *name, const cJSON *preset, int32_t guesses, int32_t values) {
    cJSON *row = cJSON_CreateObject();
    cJSON_AddStringToObject(row, "name", name);
    for (const cJSON *item = preset->child; item; item = item->next)
        if (!cJSON_IsObject(item)) cJSON_AddItemToObject(row, item->string, cJSON_Duplicate(item, 1));
    for (int c = 0; c < COLUMNS; c++) {
        char key[96];
        const cJSON *value = value_at(preset, c);
        snprintf(key, sizeof key, "%s.%s", columns[c].group, columns[c].name);
        if (value) cJSON_AddItemToObject(row, key, cJSON_Duplicate(value, 1));
    }
    cJSON_AddNumberToObject(row, "guesses", guesses);
    cJSON_AddNumberToObject(row, "value_count", values);
    return row;
}

static int32_t count_values(const cJSON *preset) {
    int32_t count = 0;
    for (const cJSON *group = preset->child; group; group = group->next)
        if (cJSON_IsObject(group)) count += cJSON_GetArraySize(group);
    return count;
}

static void print_head(void) {
    printf("%-16s %9s", "preset", "pixels");
    for (int c = 0; c < COLUMNS; c++) printf(" %9s", columns[c].title);
    printf("  guesses\n");
}

static void print_foot(void) {
    printf("Left to the run: camera.width and height (the pixels above, or fewer), camera.lux, frontend.psf_sigma_px (the\n"
           "lens), and image.log_eps where no black is said above: it is the light of the dark against that of Y = 1.\n"
           "tides info PRESET has every value with its spread and source.\n");
}

int cmd_presets(const cli_command *command, int argc, char **argv) {
    cli_common common;
    const cli_option options[] = {{NULL, 0, NULL, NULL, NULL, NULL, NULL}};
    int code = cli_parse(command, options, argc, argv, &common, NULL);
    if (code != CLI_GO) return code;
    const int32_t shown = !common.json && !common.quiet;
    char name[TIDES_PRESET_NAME];
    cJSON *rows = common.json ? cJSON_CreateArray() : NULL;
    if (shown) print_head();
    for (size_t i = 0; tides_preset_at(i, name); i++) {
        tides_error error = {TIDES_OK, ""};
        char *text = NULL;
        if (tides_preset_read(name, &text, &error) != TIDES_OK) {
            cJSON_Delete(rows);
            return cli_fail(&error);
        }
        cJSON *preset = cJSON_Parse(text);
        tides_free(text);
        const int32_t guesses = info_preset_kinds(preset, "guess"), values = preset ? count_values(preset) : 0;
        if (rows && preset) cJSON_AddItemToArray(rows, row_json(name, preset, guesses, values));
        if (shown && preset) print_row(name, preset, guesses, values);
        cJSON_Delete(preset);
    }
    if (shown) print_foot();
    return common.json ? cli_print_facts(rows, 1) : CLI_OK;
}
