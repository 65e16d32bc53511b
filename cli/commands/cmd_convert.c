/* tides convert: scenes and event files between the formats that the library writes. */
#include "event_job.h"

#include <stdio.h>
#include <string.h>

/* Prints a warning for each property that the output's format can't hold. */
static void tell_losses(const tides_scene *scene, const char *out) {
    static const struct {
        int32_t lost;
        const char *what;
    } losses[] = {{TIDES_LOSES_HARMONICS, "SH beyond the constant: colours don't change with the view"},
                  {TIDES_LOSES_TRAINED, "how the scene was trained: image.antialias must say it in runs of this file"},
                  {TIDES_LOSES_UP, "where up is: camera.up must say it"},
                  {TIDES_LOSES_TRANSFER, "colours that aren't srgb: image.transfer must say it in runs of this file"}};
    const int32_t lost = tides_scene_losses(scene, out);
    const char *ending = strrchr(out, '.');
    for (size_t i = 0; ending && i < sizeof losses / sizeof losses[0]; i++)
        if (lost & losses[i].lost) fprintf(stderr, "tides: %s: a %s has no place for %s\n", out, ending, losses[i].what);
}

static int convert_scene(const char *in, const char *out, const tides_scene_options *how, const cli_common *common) {
    tides_error error = {TIDES_OK, ""};
    tides_scene *scene = NULL;
    int code = CLI_OK;
    const cli_output written = {out, NULL};
    tides_status status = cli_check_outputs(in, &written, 1, &error);
    if (status == TIDES_OK) status = tides_scene_create(&scene, &error);
    if (status == TIDES_OK) status = tides_scene_read(scene, in, how, NULL, 1.0, &error);
    if (status == TIDES_OK) status = tides_scene_save(scene, out, &error);
    if (status == TIDES_OK && !common->quiet) tell_losses(scene, out);
    cli_tell_lines(common, tides_scene_notes(scene));
    if (status != TIDES_OK) {
        code = cli_fail(&error);
    } else if (common->json) {
        cJSON *facts = cJSON_CreateObject();
        cJSON_AddStringToObject(facts, "file", out);
        cJSON_AddNumberToObject(facts, "gaussians", (double)tides_scene_count(scene));
        cJSON_AddNumberToObject(facts, "objects", tides_scene_objects(scene));
        cJSON_AddNumberToObject(facts, "dropped", (double)tides_scene_dropped(scene));
        code = cli_print_facts(facts, 1);
    } else if (!common->quiet) {
        printf("%s: %lld Gaussians\n", out, (long long)tides_scene_count(scene));
    }
    tides_scene_destroy(scene);
    return code;
}

/* 1 where the file is converted as a scene. HDF5, numpy and ZIP files may hold events or a scene; a file that opens as events
 * counts as events. So does a file that is neither, or whose events need a missing part (a plugin): the events' reader gives
 * the better reason. */
static int is_scene(const char *in) {
    tides_event_reader *reader = NULL;
    tides_error error;
    tides_status status = tides_event_reader_open(in, NULL, &reader, &error);
    tides_event_reader_close(reader);
    return status != TIDES_OK && status != TIDES_UNSUPPORTED && tides_scene_is_file(in);
}

/* Parses filters: keys with or without "filters." in front. */
static int take_filters(const cli_list *given, tides_filters *filters, tides_event_conversion *what) {
    static const char run_of_any[] = "{\"frames\": {\"file\": \"-\"}}";
    char keys[CLI_LIST_MAX][256];
    const char *sets[CLI_LIST_MAX];
    tides_error error = {TIDES_OK, ""};
    tides_run_values values;
    tides_run *run = NULL;
    for (size_t i = 0; i < given->count; i++) {
        const char *prefix = strncmp(given->items[i], "filters.", 8) == 0 ? "" : "filters.";
        snprintf(keys[i], sizeof keys[i], "%s%s", prefix, given->items[i]);
        sets[i] = keys[i];
    }
    tides_status status = tides_run_parse(run_of_any, ".", sets, given->count, &run, &error);
    if (status != TIDES_OK) return cli_fail(&error);
    tides_run_get(run, &values);
    *filters = values.filters;
    tides_run_destroy(run);
    what->filters = filters;
    return CLI_GO;
}

int cmd_convert(const cli_command *command, int argc, char **argv) {
    cli_common common;
    cli_reading reading = {.format = NULL};
    tides_event_conversion what;
    tides_event_conversion_defaults(&what);
    tides_scene_options how;
    tides_scene_options_defaults(&how);
    const char *files[2] = {NULL, NULL}, *width = NULL, *height = NULL;
    tides_filters filters;
    cli_list given = {.count = 0};
    const cli_option options[] = {
        CLI_READING_FILE(reading),
        {"--to", 0, "FORMAT", "events: write as this (by ending)", NULL, &what.to, NULL},
        {"--width", 0, "PX", "events: the sensor's width, where the file doesn't say", NULL, &width, NULL},
        {"--height", 0, "PX", "events: and its height", NULL, &height, NULL},
        {"--filter", 0, "KEY=VALUE", "events: through a camera's filters; keys of filters.* (repeatable)", NULL, NULL, &given},
        {"--part", 0, "PART", "scenes: a glTF's scene, an .h5's object, an iteration, a level", NULL, &how.part, NULL},
        CLI_READING_CLOCK(reading),
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, files);
    if (code == CLI_OK) cli_help_scenes();
    if (code == CLI_OK) cli_help_formats();
    if (code == CLI_GO) code = cli_conversion_reading(command, &reading, &what);
    if (code == CLI_GO && width) code = cli_size(command, "--width", width, &what.width);
    if (code == CLI_GO && height) code = cli_size(command, "--height", height, &what.height);
    if (code == CLI_GO && given.count > 0) code = take_filters(&given, &filters, &what);
    if (code != CLI_GO) return code;
    const int asked = what.filters || what.from || what.to || width || height || what.rebase || what.columns || what.unit ||
                      what.stream || reading.offset;
    how.invalid = what.drop_invalid;
    if (!asked && is_scene(files[0])) return convert_scene(files[0], files[1], &how, &common);
    if (how.part) return cli_usage(command, "--part is of scenes, and %s is none", files[0]);
    return cli_event_convert(files[0], files[1], &what, &common);
}
