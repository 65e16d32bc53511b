/* tides demo: simulates a made world, and leaves its files in a folder, as an example of a run. */
#include "demo.h"
#include "session.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_SIZE = 4200 };

typedef struct demo_files {
    char run[PATH_SIZE], events[PATH_SIZE], stats[PATH_SIZE], preview[PATH_SIZE], exr[PATH_SIZE];
} demo_files;

static void name_files(const char *directory, demo_files *files) {
    snprintf(files->run, PATH_SIZE, "%s/run.json", directory);
    snprintf(files->events, PATH_SIZE, "%s/events.h5", directory);
    snprintf(files->stats, PATH_SIZE, "%s/stats.json", directory);
    snprintf(files->preview, PATH_SIZE, "%s/preview.png", directory);
    snprintf(files->exr, PATH_SIZE, "%s/frame.exr", directory);
}

int cmd_demo(const cli_command *command, int argc, char **argv) {
    cli_common common;
    const char *directory = NULL;
    const cli_option options[] = {
        {"--output", 'o', "DIR", "where everything goes (tides-demo)", NULL, &directory, NULL},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, NULL);
    if (code != CLI_GO) return code;
    if (!directory) directory = "tides-demo";

    tides_error error = {TIDES_OK, ""};
    if (strlen(directory) > 4000) return cli_usage(command, "-o: the path is too long");
    demo_files *files = malloc(sizeof *files);
    if (!files) return cli_failed("out of memory");
    name_files(directory, files);
    tides_status status = cli_make_directory(directory, &error);
    if (status == TIDES_OK) status = demo_scene_write(directory, &error);
    if (status == TIDES_OK) {
        static const cli_list no_sets = {.count = 0};
        const cli_job job = {.run = files->run,
                             .events = files->events,
                             .stats = files->stats,
                             .preview = files->preview,
                             .exr = files->exr,
                             .sets = &no_sets};
        code = cli_job_run(&job, &common);
    } else {
        code = cli_fail(&error);
    }
    if (code == CLI_OK && !common.quiet && !common.json)
        printf("files             %s/: preview.png (look here first), events.h5, frame.exr, stats.json,\n"
               "                  run.json, room.h5, fan.ply, fan.json, camera.json\n"
               "again             tides simulate %s -o events.h5\n",
               directory, files->run);
    free(files);
    return code;
}
