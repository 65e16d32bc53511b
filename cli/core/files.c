/* Checks, before anything is opened, that a command's outputs replace neither its inputs nor each other. */
#include "cli.h"

#include <stdio.h>

enum { FILE_NAME = 4200 }; /* longest path in a folder; longer ones can't be opened */

static void take_names(const cli_output *outputs, size_t count, const char *names[CLI_OUTPUTS_MAX]) {
    for (size_t i = 0; i < count; i++) names[i] = outputs[i].path;
}

/* Checks that each name has the ending of its kind. */
static tides_status check_names(const cli_output *outputs, size_t count, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < count && status == TIDES_OK; i++)
        if (outputs[i].path && outputs[i].ending) status = tides_file_named(outputs[i].path, outputs[i].ending, error);
    return status;
}

tides_status cli_check_outputs(const char *input, const cli_output *outputs, size_t count, tides_error *error) {
    const char *names[CLI_OUTPUTS_MAX] = {NULL};
    take_names(outputs, count, names);
    const tides_status status = tides_files_apart(&input, 1, names, count, error);
    return status == TIDES_OK ? check_names(outputs, count, error) : status;
}

tides_status cli_check_run(const char *run, const cli_list *sets, const cli_output *outputs, size_t count, tides_error *error) {
    const char *names[CLI_OUTPUTS_MAX] = {NULL};
    tides_run *loaded = NULL;
    take_names(outputs, count, names);
    tides_status status = tides_run_load(run, sets->items, sets->count, &loaded, error);
    if (status == TIDES_OK) status = tides_run_apart(loaded, names, count, error);
    if (status == TIDES_OK) status = check_names(outputs, count, error);
    tides_run_destroy(loaded);
    return status;
}

tides_status cli_check_folder(const char *run, const cli_list *sets, const char *input, const char *folder,
                              const char *const *names, tides_error *error) {
    char paths[CLI_OUTPUTS_MAX][FILE_NAME];
    cli_output outputs[CLI_OUTPUTS_MAX] = {{NULL, NULL}};
    size_t count = 0;
    for (; *names && count < CLI_OUTPUTS_MAX; names++, count++) {
        snprintf(paths[count], FILE_NAME, "%s/%s", folder, *names);
        outputs[count].path = paths[count];
    }
    const tides_status status = cli_check_outputs(input, outputs, count, error);
    return status == TIDES_OK && run ? cli_check_run(run, sets, outputs, count, error) : status;
}
