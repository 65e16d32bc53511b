/* tides convert: a scene between the formats that the library writes. */
#include "cli.h"

#include <stdio.h>

int cmd_convert(const cli_command *command, int argc, char **argv) {
    cli_common common;
    const char *files[2] = {NULL, NULL};
    const cli_option options[] = {{NULL, 0, NULL, NULL, NULL, NULL, NULL}};
    int code = cli_parse(command, options, argc, argv, &common, files);
    if (code != CLI_GO) return code;

    tides_error error = {TIDES_OK, ""};
    tides_scene *scene = NULL;
    tides_status status = tides_scene_create(&scene, &error);
    if (status == TIDES_OK) status = tides_scene_add_file(scene, files[0], NULL, 1.0, &error);
    if (status == TIDES_OK) status = tides_scene_save(scene, files[1], &error);
    if (status != TIDES_OK) {
        code = cli_fail(&error);
    } else if (common.json) {
        cJSON *facts = cJSON_CreateObject();
        cJSON_AddStringToObject(facts, "file", files[1]);
        cJSON_AddNumberToObject(facts, "gaussians", (double)tides_scene_count(scene));
        cJSON_AddNumberToObject(facts, "objects", tides_scene_objects(scene));
        code = cli_print_facts(facts, 1);
    } else {
        code = CLI_OK;
        if (!common.quiet) printf("%s: %lld Gaussians\n", files[1], (long long)tides_scene_count(scene));
    }
    tides_scene_destroy(scene);
    return code;
}
