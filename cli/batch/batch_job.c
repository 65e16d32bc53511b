/* Makes one run of a batch, in a process of its own and in the run's folder: events (as `tides simulate`), a dataset, or the
 * output of the run's command. */
#include "batch.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* The files of a run's folder. */
typedef struct job_files {
    char *job, *events, *stats, *result, *failure;
} job_files;

static int32_t name_files(const batch_run *run, job_files *files) {
    files->job = batch_text("%s/job.json", run->directory);
    files->events = batch_text("%s/events.h5", run->directory);
    files->stats = batch_text("%s/stats.json", run->directory);
    files->result = batch_text("%s/result.json", run->directory);
    files->failure = batch_text("%s/failure.json", run->directory);
    return files->job && files->events && files->stats && files->result && files->failure;
}

static void free_files(job_files *files) {
    free(files->job);
    free(files->events);
    free(files->stats);
    free(files->result);
    free(files->failure);
}

/* Locks the folder, so that no other batch, and no process left over from a killed batch, works in it. It tries for 5 s,
 * because a process that was just killed holds its lock until the system has ended it. */
static tides_status lock_folder(const batch_run *run, tides_error *error) {
    enum { TRIES = 250 };
    static const struct timespec pause = {0, 20000000}; /* 20 ms between two tries */
    char *path = batch_text("%s/lock", run->directory);
    const int file = path ? open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666) : -1;
    free(path);
    if (file < 0) return cli_error(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", run->directory, strerror(errno));
    for (int i = 0; i < TRIES; i++) {
        struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
        if (fcntl(file, F_SETLK, &lock) == 0) return TIDES_OK; /* `file` stays open as long as the process lives */
        nanosleep(&pause, NULL);
    }
    close(file);
    return cli_error(error, TIDES_WRITE_FAILED, "%s: another process works on this run; wait for it, or stop it",
                     run->directory);
}

/* Writes result.json: the run's name, hash, file and sets (batch_describe), and the statistics that don't depend on the
 * machine's speed. A command's run has the version of TIDES in place of statistics. */
static tides_status write_result(const batch_run *run, const job_files *files, tides_error *error) {
    static const char *const of_events[] = {"events", "events_on", "events_off", "events_truncated", "simulated_s", "width",
                                            "height", "device",    "version",    "numerics",         "seed",        NULL};
    static const char *const of_dataset[] = {"layout", "cameras", "events", "pictures", "truths", "poses", "simulated_s",
                                             "width",  "height",  "device", "version",  "seed",   NULL};
    const char *const *kept = run->layouts ? of_dataset : of_events;
    cJSON *result = batch_describe(run), *stats = run->command ? NULL : batch_read_json(files->stats);
    int32_t ok = result && (stats || run->command);
    if (ok && run->command) ok = cJSON_AddStringToObject(result, "version", tides_version()) != NULL;
    for (size_t i = 0; ok && stats && kept[i]; i++) {
        cJSON *copy = cJSON_Duplicate(cJSON_GetObjectItemCaseSensitive(stats, kept[i]), 1);
        ok = copy && cJSON_AddItemToObject(result, kept[i], copy);
    }
    tides_status status = TIDES_OK;
    if (ok)
        status = batch_write_json(files->result, result, error);
    else if (!result || run->command)
        status = batch_no_memory(error);
    else
        status = cli_error(error, TIDES_BAD_FILE,
                           "%s: can't be read back, or lacks a statistic: remove it, and run the batch again", files->stats);
    cJSON_Delete(result);
    cJSON_Delete(stats);
    return status;
}

/* Removes an older result before anything else changes. `*resume` becomes 1 if job.json has the run's hash, and the folder
 * has a checkpoint or, for a dataset, the dataset and stats.json. Such a dataset is complete, because stats.json is written
 * last. If `*resume` is 0, older output is removed. */
static tides_status begin(const batch_run *run, const job_files *files, int32_t *resume, tides_error *error) {
    tides_status status = batch_remove(files->result, error);
    if (status == TIDES_OK) status = batch_remove(files->failure, error);
    if (status != TIDES_OK) return status;
    char *checkpoint = batch_text("%s.checkpoint", files->events);
    if (!checkpoint) return batch_no_memory(error);
    *resume =
        batch_has_hash(files->job, run) && !run->command && (run->layouts ? batch_is_made(run) : access(checkpoint, F_OK) == 0);
    free(checkpoint);
    if (!*resume) status = batch_clear(run, error);
    if (status != TIDES_OK) return status;
    cJSON *json = batch_describe(run);
    status = batch_write_json(files->job, json, error);
    cJSON_Delete(json);
    return status == TIDES_OK ? batch_write_run(run, error) : status;
}

/* Makes the log stdout and stderr, for appending. A link isn't followed, because batch_job empties the log later, and would
 * empty another file. */
static int32_t log_to(const char *path) {
    const int file = open(path, O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW, 0666);
    const int32_t ok = file >= 0 && dup2(file, STDERR_FILENO) >= 0 && dup2(file, STDOUT_FILENO) >= 0;
    if (file > STDERR_FILENO) close(file);
    return ok;
}

/* Appends stdout and stderr to log.txt. It isn't emptied yet, because another process may write it until the folder is
 * locked. */
static tides_status open_log(const batch_run *run, tides_error *error) {
    char *path = batch_text("%s/log.txt", run->directory);
    if (mkdir(run->directory, 0777) != 0 && errno != EEXIST)
        cli_error(error, TIDES_WRITE_FAILED, "%s: can't be made: %s", run->directory, strerror(errno));
    else if (!path || !log_to(path))
        cli_error(error, TIDES_WRITE_FAILED, "%s/log.txt: can't be written: %s", run->directory, strerror(errno));
    free(path);
    return error->status;
}

/* Simulates; errors become lines of the log. */
static int simulate(const batch *b, const batch_run *run, const job_files *files, int32_t resume) {
    cli_list sets = {.count = 0};
    if (run->count > CLI_LIST_MAX)
        return cli_failed("the run sets over %d keys: write some of them into its run file", CLI_LIST_MAX);
    for (size_t i = 0; i < run->count; i++) sets.items[sets.count++] = run->sets[i];
    const cli_common quiet = {.quiet = 1, .device = b->common->device};
    const cli_job job = {.run = run->file,
                         .events = files->events,
                         .stats = files->stats,
                         .sets = &sets,
                         .checkpoint_s = b->checkpoint_s,
                         .resume = resume};
    return cli_job_run(&job, &quiet);
}

int batch_job(const batch *b, const batch_run *run) {
    tides_error error = {TIDES_OK, ""};
    job_files files;
    int32_t resume = 0;
    tides_status status = open_log(run, &error);
    if (status != TIDES_OK) return cli_fail(&error);
    if (!name_files(run, &files)) return cli_failed("out of memory");
    int code = CLI_OK;
    if (lock_folder(run, &error) != TIDES_OK) {
        cli_fail(&error);
        free_files(&files);
        return BATCH_BUSY;
    }
    if (ftruncate(STDERR_FILENO, 0) != 0)
        status = cli_error(&error, TIDES_WRITE_FAILED, "%s/log.txt: can't be emptied: %s", run->directory, strerror(errno));
    if (status == TIDES_OK) status = begin(run, &files, &resume, &error);
    if (status == TIDES_OK && run->command) code = batch_command(b, run);
    if (status == TIDES_OK && !run->command && !run->layouts) code = simulate(b, run, &files, resume);
    if (status == TIDES_OK && run->layouts && !resume) status = batch_dataset(b, run, files.stats, &error);
    if (status == TIDES_OK && code == CLI_OK) status = write_result(run, &files, &error);
    free_files(&files);
    return status == TIDES_OK ? code : cli_fail(&error);
}

char *batch_words(const char *line) { return batch_text("%s", strncmp(line, "tides: ", 7) == 0 ? line + 7 : line); }

char *batch_last_words(const batch_run *run) {
    char line[1024], last[1024] = "";
    char *path = batch_text("%s/log.txt", run->directory);
    FILE *file = path ? fopen(path, "r") : NULL;
    while (file && fgets(line, sizeof line, file)) {
        line[strcspn(line, "\r\n")] = '\0';
        if (line[0]) memcpy(last, line, sizeof last);
    }
    if (file) fclose(file);
    char *words = last[0] ? batch_words(last) : batch_text("ended without a message; see %s", path ? path : run->directory);
    free(path);
    return words;
}
