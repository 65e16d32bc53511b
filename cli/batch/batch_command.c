/* A run of a batch that another command makes ("command": "frames"). Its output is DIR/NAME/OUTPUT. Its command line is what a
 * user would write: the run file, --set for each setting, -o, and the manifest's "options". */
#include "batch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Commands that take a run file and have one output, and the output's name in a run's folder. */
static const struct {
    cli_command command;
    const char *output;
} kinds[] = {{{"frames", "", "", NULL, 1, cmd_frames, 0}, "frames"},
             {{"render", "", "", NULL, 1, cmd_render, 0}, "render.exr"},
             {{"imu", "", "", NULL, 1, cmd_imu, 0}, "imu.csv"},
             {{"tracks", "", "", NULL, 1, cmd_tracks, 0}, "tracks.npz"},
             {{"compare", "", "", NULL, 1, cmd_compare, 0}, "compare"}};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

static size_t kind_of(const char *name) {
    size_t k = 0;
    while (k < KINDS && strcmp(kinds[k].command.name, name) != 0) k++;
    return k;
}

tides_status batch_check_command(const batch *b, const char *name, tides_error *error) {
    const char *names[KINDS + 2] = {"simulate"};
    char list[256] = "";
    for (size_t k = 0; k < KINDS; k++) names[k + 1] = kinds[k].command.name;
    if (strcmp(name, names[0]) == 0 || kind_of(name) < KINDS) return TIDES_OK;
    for (size_t k = 0, used = 0; names[k]; k++)
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", k ? ", " : "", names[k]);
    const char *nearest = tides_nearest_name(name, names);
    return cli_error(error, TIDES_BAD_CONFIG, "%s: command \"%.100s\" is none of %s%s%s%s", b->manifest, name, list,
                     nearest ? "; did you mean \"" : "", nearest ? nearest : "", nearest ? "\"?" : "");
}

/* Options of these commands that name a file to be written. */
static const char *const writes[] = {"--png", "--output", "-o"};
enum { WRITES = sizeof writes / sizeof writes[0] };

/* 1 where `option` is one of these, or begins with one ("--png=x.png"); *file is then the file's name, or NULL where the next
 * item has it. */
static int32_t names_output(const char *option, const char **file) {
    *file = NULL;
    for (size_t k = 0; k < WRITES; k++) {
        const size_t length = strlen(writes[k]);
        if (strncmp(option, writes[k], length) != 0) continue;
        const int32_t is_long = option[1] == '-';
        if (option[length] && (!is_long || option[length] == '=')) *file = option + length + is_long;
        if (!option[length] || *file) return 1;
    }
    return 0;
}

static int32_t leaves(const char *file) {
    return file[0] == '/' || strncmp(file, "../", 3) == 0 || strcmp(file, "..") == 0 || strstr(file, "/../") != NULL;
}

tides_status batch_check_option(const batch *b, const cJSON *option, tides_error *error) {
    const char *file, *before;
    const int32_t is_output = names_output(option->valuestring, &file);
    if (is_output && strncmp(option->valuestring, "--png", strlen("--png")) != 0)
        return cli_error(error, TIDES_BAD_CONFIG, "%s: options: %.100s: a batch says itself where a run's output goes",
                         b->manifest, option->valuestring);
    if (!is_output && option->prev && option->prev->next && names_output(option->prev->valuestring, &before) && !before)
        file = option->valuestring;
    if (!file || !leaves(file)) return TIDES_OK;
    return cli_error(error, TIDES_BAD_CONFIG, "%s: options: %.100s is outside of the run's folder, which its files go to",
                     b->manifest, file);
}

static const char dataset[] = "dataset", events[] = "events.h5";

const char *batch_output(const batch_run *run) {
    if (run->command) return kinds[kind_of(run->command)].output;
    return run->layouts ? dataset : events;
}

static tides_status clear(const batch_run *run, const char *name, const char *ending, tides_error *error) {
    char *path = batch_text("%s/%s%s", run->directory, name, ending);
    const tides_status status = path ? batch_remove(path, error) : batch_no_memory(error);
    free(path);
    return status;
}

/* 1: DIR/NAME/dataset.part has the events of a dataset that was stopped, and they are continued. */
static int32_t keeps_events(const batch_run *run) {
    char *path = batch_text("%s/%s.part/.events", run->directory, dataset);
    const int32_t kept = run->layouts && path && access(path, R_OK) == 0;
    free(path);
    return kept;
}

/* The checkpoint is removed before its events: without them it would be invalid. */
tides_status batch_clear(const batch_run *run, tides_error *error) {
    static const char *const endings[] = {".checkpoint", ".checkpoint.part", "", ".part", ".part.tail"};
    const int32_t kept = keeps_events(run);
    tides_status status = clear(run, "stats.json", "", error);
    for (size_t k = 0; k < KINDS + 2; k++)
        for (size_t e = 0; e < sizeof endings / sizeof endings[0] && status == TIDES_OK; e++)
            if (!(kept && k == KINDS && strcmp(endings[e], ".part") == 0))
                status = clear(run, k < KINDS ? kinds[k].output : k == KINDS ? dataset : events, endings[e], error);
    return status;
}

static int give_arguments(const batch *b, const batch_run *run, const char *output, char *const *options,
                          const char **arguments) {
    int count = 0;
    arguments[count++] = "tides";
    arguments[count++] = run->file;
    arguments[count++] = "-q";
    arguments[count++] = "-o";
    arguments[count++] = output;
    if (b->common->device) arguments[count++] = "--device", arguments[count++] = b->common->device;
    for (size_t i = 0; i < run->count; i++) arguments[count++] = "--set", arguments[count++] = run->sets[i];
    for (size_t i = 0; i < run->options; i++) arguments[count++] = options[i];
    return count;
}

/* Replaces files that the options name by paths in the run's own folder. 0: out of memory. */
static int32_t place_options(const batch_run *run, char **placed) {
    int32_t follows = 0;
    for (size_t i = 0; i < run->options; i++) {
        const char *file, *given = run->option[i];
        const int32_t is_output = names_output(given, &file);
        if (follows)
            placed[i] = batch_text("%s/%s", run->directory, given);
        else if (is_output && file)
            placed[i] = batch_text("%.*s%s/%s", (int)(file - given), given, run->directory, file);
        else
            placed[i] = batch_text("%s", given);
        if (!placed[i]) return 0;
        follows = is_output && !file;
    }
    return 1;
}

int batch_command(const batch *b, const batch_run *run) {
    const cli_command *command = &kinds[kind_of(run->command)].command;
    char *output = batch_text("%s/%s", run->directory, batch_output(run));
    const char **arguments = calloc(8 + 2 * run->count + run->options, sizeof *arguments);
    char **options = calloc(run->options + 1, sizeof *options);
    int code;
    if (output && arguments && options && place_options(run, options)) { /* commands don't change them */
        const int count = give_arguments(b, run, output, options, arguments);
        code = command->run(command, count, (char **)(uintptr_t)arguments);
    } else {
        code = cli_failed("out of memory");
    }
    for (size_t i = 0; options && i < run->options; i++) free(options[i]);
    free(options);
    free(arguments);
    free(output);
    return code;
}
