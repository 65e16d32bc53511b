/* tides batch: a manifest's runs, each in a folder of its own, several at a time. After any interruption a batch can be
 * continued.
 *
 * A folder DIR/NAME holds job.json (what was started) and run.json (the run file with every value). It has events.h5 and
 * stats.json, or with dataset.layout dataset/, or the output of the run's command, and log.txt. When the run has ended it
 * has result.json, or failure.json (job.json and "error"). These carry a hash of the resolved run, its command and the files
 * that it reads. A run that has a result with its hash is skipped. A run that has a checkpoint, and a job.json with its
 * hash, is continued. Any other run starts anew. */
#ifndef CLI_BATCH_H
#define CLI_BATCH_H

#include "session.h"

#include <sys/types.h>

enum { BATCH_WAITING = 0, BATCH_RUNNING, BATCH_DONE, BATCH_FAILED };
enum { BATCH_HASH = 17 }; /* 16 hex digits */
enum { BATCH_BUSY = 75 }; /* exit code of a run whose folder another process has locked (EX_TEMPFAIL of sysexits.h) */

typedef struct batch_run {
    char *name;  /* of its folder, unique in the batch */
    char *file;  /* run file */
    char **sets; /* "key=value", `count` of them */
    size_t count;
    char *seed;    /* "seed=N" of a drawn run: the last of `sets` if neither they nor the file have a seed; or NULL */
    char *command; /* makes one output of the run, in place of simulate; NULL: events, or a dataset */
    char **option; /* of its command line, `options` of them */
    size_t options;
    char *layouts;   /* dataset.layout: a dataset is made; NULL: events */
    char *directory; /* DIR/NAME */
    char hash[BATCH_HASH];
    double estimate; /* memory [bytes] */
    int32_t state;   /* BATCH_* */
    int32_t earlier; /* 1: finished before this batch began */
    pid_t child;     /* while running */
    int words;       /* a pipe with the child's messages, until it has a log */
    double began;    /* cli_now at the start */
    char *error;     /* one line, where it failed */
} batch_run;

typedef struct batch {
    const char *manifest, *directory;
    const cli_common *common;
    double checkpoint_s;
    const cli_list *only;  /* names of the runs to do; empty: all */
    int32_t shard, shards; /* this process does runs i with i mod shards == shard */
    int32_t jobs;          /* runs at a time; 0: as many as there are processors */
    int32_t stopped;       /* on the user's request */
    batch_run *runs;
    size_t count, capacity;
} batch;

/* batch_manifest.c: makes runs from the manifest, names them, and keeps those of the shard, or those named in `only`. */
tides_status batch_read(batch *b, tides_error *error);
void batch_free(batch *b);

/* batch_draws.c. _check_draws: whether `from`, keys with ranges or values, is valid. batch_draw: the values of run `index`.
 * _seed: its own seed, as "seed=N". NULL: out of memory. */
tides_status batch_check_draws(const batch *b, const cJSON *from, tides_error *error);
cJSON *batch_draw(const cJSON *from, const char *seed, int index);
char *batch_draw_seed(const char *seed, int index);

/* batch_hash.c: reads every run once. An invalid run is an error that names it; a run whose inputs can't be read counts as
 * failed. Fills hash and estimate. */
tides_status batch_prepare(batch *b, tides_error *error);

/* batch_job.c: the run itself, called in a process of its own. */
int batch_job(const batch *b, const batch_run *run);
/* batch_dataset.c: the dataset, and stats.json. */
tides_status batch_dataset(const batch *b, const batch_run *run, const char *stats, tides_error *error);
/* batch_command.c. _check_command: TIDES_BAD_CONFIG where a batch has no such command. Others: the path of the command's output
 * in the run's folder; removal of that output, or of another command's; and running the command, which gives its exit code. */
tides_status batch_check_command(const batch *b, const char *name, tides_error *error);
/* Checks an item of "options": files that it names for output must be in the run's folder. */
tides_status batch_check_option(const batch *b, const cJSON *option, tides_error *error);
const char *batch_output(const batch_run *run);
tides_status batch_clear(const batch_run *run, tides_error *error);
int batch_command(const batch *b, const batch_run *run);
/* Removes a file, link or folder, with its contents; a missing one is fine. */
tides_status batch_remove(const char *path, tides_error *error);
/* A line of the tool without its name, or the last such line of the run's process. Allocated; NULL: out of memory. */
char *batch_words(const char *line);
char *batch_last_words(const batch_run *run);

/* batch_run_file.c: writes run.json to the folder, the run file with every value. It gives the same run on its own. */
tides_status batch_write_run(const batch_run *run, tides_error *error);

/* batch_folder.c. _describe: the run as JSON (name, hash, file, set); NULL: out of memory. _has_hash: whether a JSON file
 * carries the run's hash. _is_made: whether its output is there; _is_finished: and its result. */
cJSON *batch_describe(const batch_run *run);
int32_t batch_has_hash(const char *path, const batch_run *run);
int32_t batch_is_made(const batch_run *run);
int32_t batch_is_finished(const batch_run *run);
/* Writes run->error to failure.json, for a later --summary. Errors are ignored, for the disk may be full. */
void batch_leave_failure(const batch_run *run);
/* Sets the runs' states by their folders. */
tides_status batch_look(batch *b, tides_error *error);

/* batch_parent.c: from now on this process is killed when its parent ends. `parent` is the parent's id. */
tides_status batch_end_with(pid_t parent, tides_error *error);

/* batch_pool.c: runs all that isn't finished, several at a time, within memory, and prints a line for each. */
tides_status batch_work(batch *b, tides_error *error);

/* batch_summary.c: writes summary.json and summary.csv to the batch's folder, for this shard where there are several; not where
 * only some runs are done. With --json prints the JSON. */
int batch_summary(const batch *b);

/* batch_text.c: helpers. _text: a formatted string, allocated; NULL: out of memory. _read_json: a JSON file; NULL: there is
 * none. */
char *batch_text(const char *format, ...) CLI_PRINTF(1, 2);
cJSON *batch_read_json(const char *path);
tides_status batch_write_json(const char *path, const cJSON *json, tides_error *error);
tides_status batch_no_memory(tides_error *error);

#endif
