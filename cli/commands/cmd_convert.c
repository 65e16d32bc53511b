/* tides convert: scenes and event files between the formats that the library writes. */
#include "event_job.h"

#include <stdio.h>

static int convert_scene(const char *in, const char *out, const cli_common *common) {
    tides_error error = {TIDES_OK, ""};
    tides_scene *scene = NULL;
    int code = CLI_OK;
    const cli_output written = {out, NULL};
    tides_status status = cli_check_outputs(in, &written, 1, &error);
    if (status == TIDES_OK) status = tides_scene_create(&scene, &error);
    if (status == TIDES_OK) status = tides_scene_add_file(scene, in, NULL, 1.0, &error);
    if (status == TIDES_OK) status = tides_scene_save(scene, out, &error);
    if (status == TIDES_OK && !common->quiet && cli_ends_in(out, ".splat") && tides_scene_sh_degree(scene) > 0)
        fprintf(stderr, "tides: %s: a .splat has no place for SH beyond the constant: colours don't change with the view\n",
                out);
    if (status != TIDES_OK) {
        code = cli_fail(&error);
    } else if (common->json) {
        cJSON *facts = cJSON_CreateObject();
        cJSON_AddStringToObject(facts, "file", out);
        cJSON_AddNumberToObject(facts, "gaussians", (double)tides_scene_count(scene));
        cJSON_AddNumberToObject(facts, "objects", tides_scene_objects(scene));
        code = cli_print_facts(facts, 1);
    } else if (!common->quiet) {
        printf("%s: %lld Gaussians\n", out, (long long)tides_scene_count(scene));
    }
    tides_scene_destroy(scene);
    return code;
}

/* What opens as events is events; HDF5, numpy and ZIP files may hold a scene as well. Neither, or events that lack something
 * that their reader names (a plugin): its reason is the one that helps. */
static int is_scene(const char *in) {
    tides_event_reader *reader = NULL;
    tides_error error;
    tides_status status = tides_event_reader_open(in, NULL, &reader, &error);
    tides_event_reader_close(reader);
    return status != TIDES_OK && status != TIDES_UNSUPPORTED && tides_scene_is_file(in);
}

int cmd_convert(const cli_command *command, int argc, char **argv) {
    cli_common common;
    tides_event_conversion what;
    tides_event_conversion_defaults(&what);
    const char *files[2] = {NULL, NULL}, *width = NULL, *height = NULL;
    const cli_option options[] = {
        {"--from", 0, "FORMAT", "events: read as this (by content)", NULL, &what.from, NULL},
        {"--to", 0, "FORMAT", "events: write as this (by ending)", NULL, &what.to, NULL},
        {"--width", 0, "PX", "events: the sensor's width, where the file doesn't say", NULL, &width, NULL},
        {"--height", 0, "PX", "events: and its height", NULL, &height, NULL},
        {"--rebase", 0, NULL, "events: count times from the first one", &what.rebase, NULL, NULL},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, files);
    if (code == CLI_OK) cli_help_formats();
    if (code == CLI_GO && width) code = cli_size(command, "--width", width, &what.width);
    if (code == CLI_GO && height) code = cli_size(command, "--height", height, &what.height);
    if (code != CLI_GO) return code;
    const int asked = what.from || what.to || width || height || what.rebase;
    if (!asked && is_scene(files[0])) return convert_scene(files[0], files[1], &common);
    return cli_event_convert(files[0], files[1], &what, &common);
}
