/* tides batch: a manifest's runs, each in a folder of its own, several at a time, and gone on with after any interruption.
 *
 * A folder DIR/NAME holds job.json (what was started), run.json (the run file with every value), events.h5 and stats.json or,
 * with dataset.layout, dataset/, or what the run's command makes, log.txt, and once the run has ended result.json, or
 * failure.json (job.json and "error"). They carry a hash of the resolved run, its command and the files that it reads: a result
 * with the run's hash is skipped, a checkpoint under a job with the run's hash is gone on with, anything else starts anew. */
#ifndef CLI_BATCH_H
#define CLI_BATCH_H

#include "session.h"

#include <sys/types.h>

enum { BATCH_WAITING = 0, BATCH_RUNNING, BATCH_DONE, BATCH_FAILED };
enum { BATCH_HASH = 17 }; /* 16 hex digits */
enum { BATCH_BUSY = 75 }; /* exit code of a run that another process is at (EX_TEMPFAIL of sysexits.h): no failure of its own */

typedef struct batch_run {
    char *name;  /* of its folder, unique in the batch */
    char *file;  /* run file */
    char **sets; /* "key=value", `count` of them */
    size_t count;
    char *
        seed; /* "seed=N", of a drawn run, which becomes the last of `sets` where neither they nor the file have one; or NULL */
    char *command; /* another command than simulate, which makes one thing of the run; NULL: events, or a dataset */
    char **option; /* of its command line, `options` of them */
    size_t options;
    char *layouts;   /* dataset.layout: a dataset is made; NULL: events */
    char *directory; /* DIR/NAME */
    char hash[BATCH_HASH];
    double estimate; /* memory [bytes] */
    int32_t state;   /* BATCH_* */
    int32_t earlier; /* finished before this batch began */
    pid_t child;     /* while running */
    int words;       /* and what it says before it has a log can be read from here */
    double began;    /* as cli_now */
    char *error;     /* one line, where it failed */
} batch_run;

typedef struct batch {
    const char *manifest, *directory;
    const cli_common *common;
    double checkpoint_s;
    const cli_list *only;  /* the names of the runs that are meant; empty: all */
    int32_t shard, shards; /* run i belongs to shard i mod shards */
    int32_t jobs;          /* runs at a time; 0: as many as there are processors */
    int32_t stopped;       /* on request */
    batch_run *runs;
    size_t count, capacity;
} batch;

/* batch_manifest.c: fills runs from the manifest, names them, keeps those of the shard, or those that are meant. */
tides_status batch_read(batch *b, tides_error *error);
void batch_free(batch *b);

/* batch_draws.c: whether `from`, keys with ranges or values, can be drawn from; the values that run `index` draws, and its own
 * seed, as "seed=N"; NULL: out of memory. */
tides_status batch_check_draws(const batch *b, const cJSON *from, tides_error *error);
cJSON *batch_draw(const cJSON *from, const char *seed, int index);
char *batch_draw_seed(const char *seed, int index);

/* batch_hash.c: reads every run once: wrong ones are an error that names the run; a run whose inputs can't be read has failed.
 * Fills hash and estimate. */
tides_status batch_prepare(batch *b, tides_error *error);

/* batch_job.c: the run itself, to be called in a process of its own. */
int batch_job(const batch *b, const batch_run *run);
/* batch_dataset.c: the dataset, and stats.json. */
tides_status batch_dataset(const batch *b, const batch_run *run, const char *stats, tides_error *error);
/* batch_command.c: TIDES_BAD_CONFIG where a batch has no such command; the output of a run in its folder; removal of that
 * output, or of another command's; and the command of a run that has one, run: its exit code. */
tides_status batch_check_command(const batch *b, const char *name, tides_error *error);
/* An item of "options": what it writes must stay in the run's folder. */
tides_status batch_check_option(const batch *b, const cJSON *option, tides_error *error);
const char *batch_output(const batch_run *run);
tides_status batch_clear(const batch_run *run, tides_error *error);
int batch_command(const batch *b, const batch_run *run);
/* Removes a file, link or folder, with all that is in it; a missing one is fine. */
tides_status batch_remove(const char *path, tides_error *error);
/* A line of the tool without its name; the last one that the run's process said. Allocated; NULL: out of memory. */
char *batch_words(const char *line);
char *batch_last_words(const batch_run *run);

/* batch_run_file.c: the run file with every value, as run.json in the folder: as it stands it gives the same run. */
tides_status batch_write_run(const batch_run *run, tides_error *error);

/* batch_folder.c: what a run's folder says. The run as JSON (name, hash, file, set), NULL: out of memory; whether a JSON file
 * carries the run's hash; whether what it makes is there, and the result of that. */
cJSON *batch_describe(const batch_run *run);
int32_t batch_has_hash(const char *path, const batch_run *run);
int32_t batch_is_made(const batch_run *run);
int32_t batch_is_finished(const batch_run *run);
/* Leaves run->error in failure.json, so that a later --summary knows it: as well as that goes, for the disk may be full. */
void batch_leave_failure(const batch_run *run);
/* Takes the runs' states from their folders. */
tides_status batch_look(batch *b, tides_error *error);

/* batch_parent.c: from now on this process is killed when its parent, which must be `parent`, ends. */
tides_status batch_end_with(pid_t parent, tides_error *error);

/* batch_pool.c: runs what isn't finished, several at a time, within memory; says a line for each. */
tides_status batch_work(batch *b, tides_error *error);

/* batch_summary.c: summary.json and summary.csv in the batch's folder, of this shard where there are several; none where only
 * some runs are meant. The JSON is printed with --json. */
int batch_summary(const batch *b);

/* batch_text.c: small helpers. A formatted string, allocated, NULL where memory ran out; a JSON file, NULL where there is
 * none. */
char *batch_text(const char *format, ...) CLI_PRINTF(1, 2);
cJSON *batch_read_json(const char *path);
tides_status batch_write_json(const char *path, const cJSON *json, tides_error *error);
tides_status batch_no_memory(tides_error *error);

#endif
