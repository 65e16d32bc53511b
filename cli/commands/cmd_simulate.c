/* tides simulate: simulates the events of a run file, or of frames or a scene alone. */
#include "session.h"

#include <stdio.h>
#include <string.h>

/* The operand if the command line has none: the frames or scene that --set names, which is removed from the list. NULL:
 * --set names none either. */
static const char *operand_of(cli_list *sets, int32_t *names_scene) {
    static const char *const keys[] = {"frames.file=", "scene.file="};
    const char *operand = NULL;
    for (int k = 0; k < 2 && !operand; k++) {
        const size_t length = strlen(keys[k]);
        size_t kept = 0;
        for (size_t i = 0; i < sets->count; i++) {
            const char *value = sets->items[i] + length;
            if (strncmp(sets->items[i], keys[k], length) == 0)
                operand = value; /* the last one, like any key */
            else
                sets->items[kept++] = sets->items[i];
        }
        sets->count = kept;
        *names_scene = operand && k;
    }
    return operand;
}

/* Refuses a file, given without a run file, that the reader of frames can't read. Frames without times are left to the run to
 * refuse. */
static int check_frames(const char *file) {
    tides_error error = {TIDES_OK, ""};
    tides_frames_options options;
    tides_frames *frames = NULL;
    if (strcmp(file, "-") == 0 || cli_ends_in(file, ".y4m")) return CLI_GO; /* a pipe can be read only once */
    tides_frames_options_defaults(&options);
    const tides_status status = tides_frames_open(file, &options, &frames, &error);
    tides_frames_close(frames);
    return status == TIDES_OK || status == TIDES_BAD_CONFIG ? CLI_GO : cli_fail(&error);
}

/* Refuses a file, given without a run file, that the reader of scenes can't read, with its reason; else CLI_GO. */
static int check_scene(const char *file) {
    tides_error error = {TIDES_OK, ""};
    tides_scene *scene = NULL;
    if (tides_scene_is_file(file)) return CLI_GO;
    tides_status status = tides_scene_create(&scene, &error);
    if (status == TIDES_OK) status = tides_scene_add_file(scene, file, NULL, 1.0, &error);
    tides_scene_destroy(scene);
    return status == TIDES_OK ? CLI_GO : cli_fail(&error);
}

int cmd_simulate(const cli_command *command, int argc, char **argv) {
    cli_common common;
    cli_list sets = {.count = 0};
    const char *run = NULL, *output = NULL, *seed = NULL, *stats = NULL, *preview = NULL, *every = NULL, *maps = NULL;
    int32_t resume = 0, keep = 0, all_keys = 0;
    const cli_option options[] = {
        {"--output", 'o', "EVENTS.h5", "where events go (required)", NULL, &output, NULL},
        {"--set", 0, "KEY=VALUE", "override a key of the run file; may be repeated", NULL, NULL, &sets},
        {"--seed", 0, "N", "short for --set seed=N", NULL, &seed, NULL},
        {"--stats", 0, "FILE.json", "write statistics of the run", NULL, &stats, NULL},
        {"--preview", 0, "FILE.png", "picture of image, L_dot and events in the middle of the run", NULL, &preview, NULL},
        {"--maps", 0, "FILE.h5", "write what the sensor's pixels are, for sensor.maps of another run", NULL, &maps, NULL},
        {"--resume", 0, NULL, "go on with an interrupted run, or up to a later time.stop, from EVENTS.h5.checkpoint", &resume,
         NULL, NULL},
        {"--keep-checkpoint", 0, NULL, "leave EVENTS.h5.checkpoint beside the finished file, for a later time.stop", &keep,
         NULL, NULL},
        {"--checkpoint", 0, "SECONDS", "how often to save what --resume needs (" CLI_TEXT_OF(TIDES_CHECKPOINT_S) "; 0: never)",
         NULL, &every, NULL},
        {"--help-all", 0, NULL, "this text with every key of the run file", &all_keys, NULL, NULL},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &run);
    if (code == CLI_GO && all_keys) {
        cli_help_command(command, options);
        code = CLI_OK;
    }
    if (code == CLI_OK) cli_help_keys(all_keys);
    if (code != CLI_GO) return code;
    int32_t names_scene = 0;
    if (!run && (run = operand_of(&sets, &names_scene)))
        if ((code = names_scene ? check_scene(run) : check_frames(run)) != CLI_GO) return code;
    if (!run) return cli_usage(command, "too few arguments: tides %s %s", command->name, command->arguments);
    if (!output) return cli_usage(command, "the output is missing: -o EVENTS.h5");
    double checkpoint_s = TIDES_CHECKPOINT_S;
    if (every && (code = cli_number(command, "--checkpoint", every, &checkpoint_s)) != CLI_GO) return code;
    if (checkpoint_s < 0) return cli_usage(command, "--checkpoint %s: give seconds, or 0 for none", every);
    if (!tides_event_writer_can_resume(output)) {
        const char *option = resume ? "--resume" : keep ? "--keep-checkpoint" : every ? "--checkpoint" : NULL;
        if (option) return cli_usage(command, "%s: only an HDF5 file (.h5) can be gone on with, not %s", option, output);
        checkpoint_s = 0;
    }
    char seed_set[64];
    if (seed) {
        if (strlen(seed) > 32) return cli_usage(command, "--seed %s: not a 64-bit number", seed);
        if (sets.count == CLI_LIST_MAX) return cli_usage(command, "--set is given over %d times", CLI_LIST_MAX - 1);
        snprintf(seed_set, sizeof seed_set, "seed=%s", seed);
        sets.items[sets.count++] = seed_set;
    }
    const cli_job job = {.run = run,
                         .events = output,
                         .stats = stats,
                         .preview = preview,
                         .maps = maps,
                         .sets = &sets,
                         .checkpoint_s = checkpoint_s,
                         .resume = resume,
                         .keep_checkpoint = keep};
    return cli_job_run(&job, &common);
}
