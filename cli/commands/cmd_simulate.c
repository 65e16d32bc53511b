/* tides simulate: a run file to events. */
#include "session.h"

#include <stdio.h>
#include <string.h>

/* [s] of wall time: what a crash may cost at most, at well below a percent of a run's time. */
#define DEFAULT_CHECKPOINT_S 30.0

int cmd_simulate(const cli_command *command, int argc, char **argv) {
    cli_common common;
    cli_list sets = {.count = 0};
    const char *run = NULL, *output = NULL, *seed = NULL, *stats = NULL, *preview = NULL, *every = NULL;
    int32_t resume = 0;
    const cli_option options[] = {
        {"--output", 'o', "EVENTS.h5", "where events go (required)", NULL, &output, NULL},
        {"--set", 0, "KEY=VALUE", "override a key of the run file; may be repeated", NULL, NULL, &sets},
        {"--seed", 0, "N", "short for --set seed=N", NULL, &seed, NULL},
        {"--stats", 0, "FILE.json", "write statistics of the run", NULL, &stats, NULL},
        {"--preview", 0, "FILE.png", "picture of image, L_dot and events in the middle of the run", NULL, &preview, NULL},
        {"--resume", 0, NULL, "go on with an interrupted run, from EVENTS.h5.checkpoint", &resume, NULL, NULL},
        {"--checkpoint", 0, "SECONDS", "how often to save what --resume needs (30; 0: never)", NULL, &every, NULL},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &run);
    if (code == CLI_OK) cli_help_keys();
    if (code != CLI_GO) return code;
    if (!output) return cli_usage(command, "the output is missing: -o EVENTS.h5");
    double checkpoint_s = DEFAULT_CHECKPOINT_S;
    if (every && (code = cli_number(command, "--checkpoint", every, &checkpoint_s)) != CLI_GO) return code;
    if (checkpoint_s < 0) return cli_usage(command, "--checkpoint %s: give seconds, or 0 for none", every);
    if (!tides_event_writer_can_resume(output)) {
        if (resume) return cli_usage(command, "--resume: only an HDF5 file (.h5) can be gone on with, not %s", output);
        if (every) return cli_usage(command, "--checkpoint: only an HDF5 file (.h5) can be gone on with, not %s", output);
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
                         .resume = resume};
    return cli_job_run(&job, &common);
}
