/* tides batch: many runs, several at a time; a batch that was interrupted can be continued. */
#include "batch.h"
#include "sets.h"

#include <stdio.h>
#include <stdlib.h>

/* Parses "I/N", I from 1. */
static int take_shard(const cli_command *command, const char *text, batch *b) {
    char *end = NULL;
    const long part = strtol(text, &end, 10);
    const long parts = end != text && *end == '/' ? strtol(end + 1, &end, 10) : 0;
    if (*end || parts < 1 || parts > 65536 || part < 1 || part > parts)
        return cli_usage(command, "--shard %s: give I/N, with I from 1 to N", text);
    b->shard = (int32_t)part - 1;
    b->shards = (int32_t)parts;
    return CLI_GO;
}

/* Parses a number from 1; keeps `count` where the option isn't given. */
static int take_count(const cli_command *command, const char *option, const char *text, int32_t most, int32_t *count) {
    char *end = NULL;
    if (!text) return CLI_GO;
    const long given = strtol(text, &end, 10);
    if (end == text || *end || given < 1 || given > most)
        return cli_usage(command, "%s %s: give a number from 1", option, text);
    *count = (int32_t)given;
    return CLI_GO;
}

static void print_counts(const batch *b, size_t done, size_t earlier, size_t failed, int32_t written) {
    printf("runs              %zu done (%zu of them before), %zu failed", done, earlier, failed);
    if (done + failed < b->count) printf(", %zu waiting", b->count - done - failed);
    printf("\n");
    if (written && b->only->count == 0)
        printf("summary           %s/summary%s\n", b->directory, b->shards == 1 ? ".json and .csv" : "-*");
}

/* Prints the batch's result, with failures last, where users see them. */
static int report(const batch *b) {
    size_t done = 0, failed = 0, earlier = 0;
    int code = batch_summary(b);
    for (size_t i = 0; i < b->count; i++) {
        done += b->runs[i].state == BATCH_DONE;
        failed += b->runs[i].state == BATCH_FAILED;
        earlier += b->runs[i].earlier;
    }
    for (size_t i = 0; i < b->count; i++)
        if (b->runs[i].state == BATCH_FAILED) cli_failed("%s failed: %s", b->runs[i].name, b->runs[i].error);
    if (b->stopped)
        return cli_failed("stopped on request; %zu of %zu runs are finished; the same command goes on from there", done,
                          b->count);
    if (!b->common->quiet && !b->common->json) print_counts(b, done, earlier, failed, code == CLI_OK);
    return failed && code == CLI_OK ? CLI_FAILED : code;
}

int cmd_batch(const cli_command *command, int argc, char **argv) {
    cli_common common;
    cli_list only = {.count = 0};
    int32_t look = 0, parent = 0;
    const char *manifest = NULL, *directory = NULL, *shard = NULL, *jobs = NULL, *every = NULL, *starter = NULL;
    const cli_option options[] = {
        {"--output", 'o', "DIR", "where every run gets a folder (required)", NULL, &directory, NULL},
        {"--jobs", 'j', "N", "runs at a time (as many as processors and memory allow)", NULL, &jobs, NULL},
        {"--shard", 0, "I/N", "only every N-th run, from the I-th on: for N machines on one DIR", NULL, &shard, NULL},
        {"--only", 0, "NAME", "only this run, and no summary; repeatable", NULL, NULL, &only},
        {"--summary", 0, NULL, "run nothing: write the summary of what DIR holds by now", &look, NULL, NULL},
        {"--checkpoint", 0, "SECONDS",
         "how often runs save what going on needs (" CLI_TEXT_OF(TIDES_CHECKPOINT_S) "; 0: never)", NULL, &every, NULL},
        {"--parent", 0, "PID", "the process that started this one: end, as if killed, when it ends", NULL, &starter, NULL},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &manifest);
    if (code != CLI_GO) return code;
    if (!directory) return cli_usage(command, "the output is missing: -o DIR");
    batch b = {.manifest = manifest, .directory = directory, .common = &common, .only = &only, .shards = 1};
    b.checkpoint_s = TIDES_CHECKPOINT_S;
    if (every && (code = cli_number(command, "--checkpoint", every, &b.checkpoint_s)) != CLI_GO) return code;
    if (b.checkpoint_s < 0) return cli_usage(command, "--checkpoint %s: give seconds, or 0 for none", every);
    if ((code = take_count(command, "--jobs", jobs, 4096, &b.jobs)) != CLI_GO) return code;
    if ((code = take_count(command, "--parent", starter, INT32_MAX, &parent)) != CLI_GO) return code;
    if (shard && (code = take_shard(command, shard, &b)) != CLI_GO) return code;
    if (shard && only.count) return cli_usage(command, "--only names runs and --shard counts them; give one of the two");

    cli_sets_of_manifest();
    tides_error error = {TIDES_OK, ""};
    tides_status status = parent ? batch_end_with(parent, &error) : TIDES_OK;
    static const char *const summaries[] = {"summary.json", "summary.csv", NULL};
    if (status == TIDES_OK) status = cli_check_folder(NULL, NULL, manifest, directory, summaries, &error);
    if (status == TIDES_OK) status = batch_read(&b, &error);
    if (status == TIDES_OK) status = batch_prepare(&b, &error);
    if (status == TIDES_OK) status = cli_make_directory(directory, &error);
    if (status == TIDES_OK) status = look ? batch_look(&b, &error) : batch_work(&b, &error);
    code = status == TIDES_OK ? report(&b) : cli_fail(&error);
    batch_free(&b);
    return code;
}
