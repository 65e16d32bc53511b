/* tides simulate: a run file to events. */
#include "session.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* [s] of wall time: what a crash may cost at most, at well below a percent of a run's time. */
#define DEFAULT_CHECKPOINT_S 30.0

/* What can stand for a run of frames: a video, an array, a folder. */
static int32_t is_frames(const char *file) {
    struct stat facts;
    return strcmp(file, "-") == 0 || cli_ends_in(file, ".y4m") || cli_ends_in(file, ".npy") || cli_ends_in(file, ".npz") ||
           (stat(file, &facts) == 0 && S_ISDIR(facts.st_mode));
}

/* Without an operand: what --set names alone, frames (frames.file) or a scene, which leaves the list. NULL: nothing. */
static const char *operand_of(cli_list *sets) {
    static const char *const keys[] = {"frames.file=", "scene.file="};
    const char *operand = NULL;
    for (int k = 0; k < 2 && !operand; k++) {
        const size_t length = strlen(keys[k]);
        size_t kept = 0;
        for (size_t i = 0; i < sets->count; i++) {
            const char *value = sets->items[i] + length;
            const int32_t is_key = strncmp(sets->items[i], keys[k], length) == 0;
            if (is_key && (k ? tides_scene_is_file(value) : is_frames(value)))
                operand = value; /* the last one, as of any key */
            else
                sets->items[kept++] = sets->items[i];
        }
        sets->count = kept;
    }
    return operand;
}

int cmd_simulate(const cli_command *command, int argc, char **argv) {
    cli_common common;
    cli_list sets = {.count = 0};
    const char *run = NULL, *output = NULL, *seed = NULL, *stats = NULL, *preview = NULL, *every = NULL;
    int32_t resume = 0, keep = 0;
    const cli_option options[] = {
        {"--output", 'o', "EVENTS.h5", "where events go (required)", NULL, &output, NULL},
        {"--set", 0, "KEY=VALUE", "override a key of the run file; may be repeated", NULL, NULL, &sets},
        {"--seed", 0, "N", "short for --set seed=N", NULL, &seed, NULL},
        {"--stats", 0, "FILE.json", "write statistics of the run", NULL, &stats, NULL},
        {"--preview", 0, "FILE.png", "picture of image, L_dot and events in the middle of the run", NULL, &preview, NULL},
        {"--resume", 0, NULL, "go on with an interrupted run, or up to a later time.stop, from EVENTS.h5.checkpoint", &resume,
         NULL, NULL},
        {"--keep-checkpoint", 0, NULL, "leave EVENTS.h5.checkpoint beside the finished file, for a later time.stop", &keep,
         NULL, NULL},
        {"--checkpoint", 0, "SECONDS", "how often to save what --resume needs (30; 0: never)", NULL, &every, NULL},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &run);
    if (code == CLI_OK) cli_help_keys();
    if (code != CLI_GO) return code;
    if (!run) run = operand_of(&sets);
    if (!run) return cli_usage(command, "too few arguments: tides %s %s", command->name, command->arguments);
    if (!output) return cli_usage(command, "the output is missing: -o EVENTS.h5");
    double checkpoint_s = DEFAULT_CHECKPOINT_S;
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
                         .sets = &sets,
                         .checkpoint_s = checkpoint_s,
                         .resume = resume,
                         .keep_checkpoint = keep};
    return cli_job_run(&job, &common);
}
