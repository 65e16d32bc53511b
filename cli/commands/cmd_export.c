/* tides export: writes events as arrays for networks: a voxel grid, event frame or time surface per window. */
#include "recording.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum kind { VOXEL, FRAME, SURFACE };
static const char *const kinds[] = {"voxel", "frame", "surface", NULL};
static const char *const styles[] = {"e2vid", "dsec", "timelens", NULL};
static const char *const normalisations[] = {"none", "population", "sample", NULL};

/* float32 has no number between 0 and exp(-103.98), so that events older than this many decays have no effect. */
#define DECAYS_SEEN 104.0

typedef struct job {
    const cli_common *common;
    cli_stretch stretch;
    const char *out;
    int kind, style;
    tides_voxel_options voxel;
    double decay_s;
    size_t events_each; /* 0: windows have a length of time */
    int32_t partial;    /* 1: the last window may be shorter */

    cli_window recording;
    double *array;
    uint64_t windows, left_out; /* left_out: events after the last window */
} job;

/* ---- the command line ---- */

static int unknown(const cli_command *command, const char *option, const char *text, const char *const *names) {
    const char *nearest = tides_nearest_name(text, names);
    char list[128] = "";
    for (size_t i = 0; names[i]; i++)
        snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s", i ? ", " : "", names[i]);
    if (nearest) return cli_usage(command, "%s %s: did you mean %s?", option, text, nearest);
    return cli_usage(command, "%s %s: should be one of %s", option, text, list);
}

static int choose(const cli_command *command, const char *option, const char *text, const char *const *names, int *choice) {
    for (int i = 0; text && names[i]; i++) {
        if (strcmp(text, names[i]) != 0) continue;
        *choice = i;
        return CLI_GO;
    }
    return text ? unknown(command, option, text, names) : CLI_GO;
}

static int whole(const cli_command *command, const char *option, const char *text, long limit, long *number) {
    if (!text) return CLI_GO;
    char *end = NULL;
    errno = 0;
    *number = strtol(text, &end, 10);
    if (end != text && !*end && !errno && *number >= 1 && *number <= limit) return CLI_GO;
    return cli_usage(command, "%s %s: should be a whole number from 1 to %ld", option, text, limit);
}

/* Texts of options; NULL where not given. */
typedef struct arguments {
    const char *kind, *style, *bins, *normalise, *decay, *events;
} arguments;

static int parse_voxel(const cli_command *command, const arguments *given, job *j) {
    long bins = 0;
    int normalise = -1;
    int code = choose(command, "--style", given->style, styles, &j->style);
    if (code == CLI_GO) code = whole(command, "--bins", given->bins, 4096, &bins);
    if (code == CLI_GO) code = choose(command, "--normalise", given->normalise, normalisations, &normalise);
    if (code != CLI_GO) return code;
    tides_voxel_options_defaults(&j->voxel, (int32_t[]){TIDES_VOXEL_E2VID, TIDES_VOXEL_DSEC, TIDES_VOXEL_TIMELENS}[j->style]);
    if (bins) j->voxel.bins = (int32_t)bins;
    if (normalise >= 0) /* numbers of the names */
        j->voxel.normalise = (int32_t[]){TIDES_NORMALISE_NONE, TIDES_NORMALISE_POPULATION, TIDES_NORMALISE_SAMPLE}[normalise];
    return CLI_GO;
}

static int parse_kind(const cli_command *command, const arguments *given, job *j) {
    const int code = choose(command, "--as", given->kind, kinds, &j->kind);
    if (code != CLI_GO) return code;
    if (j->kind != VOXEL && (given->style || given->bins || given->normalise))
        return cli_usage(command, "--style, --bins and --normalise are for --as voxel");
    if (j->kind != SURFACE && given->decay) return cli_usage(command, "--decay is for --as surface");
    return CLI_GO;
}

static int parse(const cli_command *command, const arguments *given, job *j) {
    long events = 0;
    int code = parse_kind(command, given, j);
    if (code == CLI_GO) code = parse_voxel(command, given, j);
    if (code == CLI_GO) code = whole(command, "--events", given->events, 1000000000, &events);
    if (code == CLI_GO && given->decay) code = cli_number(command, "--decay", given->decay, &j->decay_s);
    if (code == CLI_GO) code = cli_stretch_parse(command, &j->stretch);
    if (code != CLI_GO) return code;
    if (!(j->decay_s > 0 && j->decay_s <= 1e6))
        return cli_usage(command, "--decay %s: should be above 0, and at most a million seconds", given->decay);
    if (events && j->stretch.window_ns) return cli_usage(command, "give --window or --events, not both");
    if (j->stretch.step_text && !j->stretch.window_ns) return cli_usage(command, "--step needs --window");
    if (!j->out) return cli_usage(command, "say where the arrays go: -o OUT.npy, .npz, .h5 or .exr");
    j->events_each = (size_t)events;
    if (j->kind == SURFACE) j->stretch.before_ns = (int64_t)ceil(DECAYS_SEEN * 1e9 * j->decay_s);
    return CLI_GO;
}

/* ---- the arrays ---- */

static tides_status make_array(const job *j, const cli_window *w, tides_error *error) {
    const int32_t width = j->recording.width, height = j->recording.height;
    if (j->kind == FRAME) return tides_event_frame(w->events, w->count, width, height, j->array, error);
    if (j->kind == SURFACE) {
        const int64_t kept = j->stretch.before_ns;
        const cli_window seen = cli_window_slice(&j->recording, w->stop_ns - kept, w->stop_ns);
        return tides_time_surface(seen.events, seen.count, width, height, w->stop_ns, j->decay_s, j->array, error);
    }
    tides_voxel_options options = j->voxel;
    if (j->style == TIDES_VOXEL_TIMELENS) {
        options.start_ns = w->first_ns;
        options.stop_ns = w->stop_ns;
    }
    return tides_voxel_grid(w->events, w->count, width, height, &options, j->array, error);
}

static tides_status add_window(job *j, tides_array_writer *writer, const cli_window *w, tides_error *error) {
    tides_status status = make_array(j, w, error);
    if (status == TIDES_OK) status = tides_array_writer_append(writer, j->array, w->first_ns, w->stop_ns, w->count, error);
    j->windows++;
    return status;
}

/* Reports the share that is done, and returns TIDES_CANCELLED after Ctrl-C. */
static tides_status step(const job *j, cli_progress *progress, double share, tides_error *error) {
    if (cli_progress_step(progress, share, "exporting") == 0) return TIDES_OK;
    return cli_error(error, TIDES_CANCELLED, "%s: interrupted: nothing was written", j->out);
}

static tides_status export_times(job *j, tides_array_writer *writer, cli_progress *progress, tides_error *error) {
    const cli_stretch *s = &j->stretch;
    const int64_t length = s->window_ns ? s->window_ns : s->stop_ns - s->start_ns;
    int64_t start = s->start_ns, end = start;
    tides_status status = TIDES_OK;
    while (status == TIDES_OK && (start + length <= s->stop_ns || (j->partial && start < s->stop_ns))) {
        end = start + length < s->stop_ns ? start + length : s->stop_ns;
        const cli_window slice = cli_window_slice(&j->recording, start, end);
        status = add_window(j, writer, &slice, error);
        if (status == TIDES_OK)
            status = step(j, progress, (double)(end - s->start_ns) / ((double)(s->stop_ns - s->start_ns) + 1), error);
        if (s->window_ns == 0) break;
        start += s->step_ns;
    }
    j->left_out = cli_window_slice(&j->recording, end, s->stop_ns).count;
    return status;
}

static tides_status export_counts(job *j, tides_array_writer *writer, cli_progress *progress, tides_error *error) {
    const cli_window all = cli_window_slice(&j->recording, j->stretch.start_ns, j->stretch.stop_ns);
    size_t at = 0;
    tides_status status = TIDES_OK;
    while (status == TIDES_OK && (all.count - at >= j->events_each || (j->partial && at < all.count))) {
        cli_window slice = all;
        slice.events += at;
        slice.count = all.count - at < j->events_each ? all.count - at : j->events_each;
        slice.first_ns = slice.events[0].t;
        slice.stop_ns = slice.events[slice.count - 1].t + 1;
        at += slice.count;
        status = add_window(j, writer, &slice, error);
        if (status == TIDES_OK) status = step(j, progress, (double)at / (double)all.count, error);
    }
    j->left_out = all.count - at;
    return status;
}

static tides_status export_all(job *j, tides_array_writer *writer, tides_error *error) {
    cli_progress progress = {.quiet = j->common->quiet};
    tides_status status =
        j->events_each ? export_counts(j, writer, &progress, error) : export_times(j, writer, &progress, error);
    cli_progress_end(&progress);
    if (status == TIDES_OK && j->windows == 0)
        status = cli_error(error, TIDES_BAD_ARGUMENT,
                           "%s: is shorter than one window: give a shorter --window or fewer --events, or --partial",
                           j->stretch.file);
    return status;
}

static tides_status run(job *j, tides_error *error) {
    static const char *const polarities[] = {"OFF", "ON"};
    const cli_output written = {j->out, NULL};
    tides_status status = cli_check_outputs(j->stretch.file, &written, 1, error);
    if (status == TIDES_OK) status = cli_stretch_read(&j->stretch, &j->recording, error);
    if (status != TIDES_OK) return status;
    cli_reading_tell(j->common, j->stretch.file, &j->recording.facts, j->stretch.how.rebase);
    const cli_window *r = &j->recording;
    const tides_array_shape shape = {kinds[j->kind], j->kind == VOXEL ? j->voxel.bins : 2, r->height, r->width,
                                     j->kind == VOXEL ? NULL : polarities};
    tides_array_writer *writer = NULL;
    status = tides_array_writer_open(j->out, &shape, &writer, error);
    if (status != TIDES_OK) return status;
    j->array = calloc((size_t)shape.planes * (size_t)shape.height * (size_t)shape.width, sizeof *j->array);
    status =
        j->array ? export_all(j, writer, error) : cli_error(error, TIDES_NO_MEMORY, "out of memory: an array of %s", j->out);
    if (status == TIDES_OK) return tides_array_writer_finish(writer, error);
    tides_array_writer_abandon(writer);
    return status;
}

/* ---- the command ---- */

static int report(const job *j) {
    const int32_t planes = j->kind == VOXEL ? j->voxel.bins : 2;
    if (j->common->json) {
        cJSON *facts = cJSON_CreateObject();
        cJSON_AddStringToObject(facts, "file", j->out);
        cJSON_AddStringToObject(facts, "as", kinds[j->kind]);
        cJSON_AddNumberToObject(facts, "windows", (double)j->windows);
        cJSON_AddNumberToObject(facts, "planes", planes);
        cJSON_AddNumberToObject(facts, "height", j->recording.height);
        cJSON_AddNumberToObject(facts, "width", j->recording.width);
        cJSON_AddNumberToObject(facts, "events_left_out", (double)j->left_out);
        cli_add_ns(facts, "start_ns", j->stretch.start_ns);
        cli_add_ns(facts, "stop_ns", j->stretch.stop_ns);
        return cli_print_facts(facts, 1);
    }
    if (j->common->quiet) return CLI_OK;
    printf("%s: %llu x %d x %d x %d float32 (windows, planes, height, width)\n", j->out, (unsigned long long)j->windows, planes,
           j->recording.height, j->recording.width);
    if (j->left_out)
        printf("%llu events after the last whole window are left out; --partial takes them in\n",
               (unsigned long long)j->left_out);
    return CLI_OK;
}

int cmd_export(const cli_command *command, int argc, char **argv) {
    cli_common common;
    arguments given = {NULL, NULL, NULL, NULL, NULL, NULL};
    job j = {.common = &common,
             .decay_s = 0.03,
             .stretch = {.of_run = 1, .windows_most = CLI_WINDOWS_MOST}}; /* HOTS's value, as in tonic's examples */
    const cli_option options[] = {
        {"--output", 'o', "FILE", "where the arrays go: .npy, .npz, .h5, .exr (one window)", NULL, &j.out, NULL},
        {"--as", 0, "voxel|frame|surface", "what to make (voxel)", NULL, &given.kind, NULL},
        {"--style", 0, "e2vid|dsec|timelens", "of voxel grids: whose (e2vid)", NULL, &given.style, NULL},
        {"--bins", 0, "N", "voxel: bins of time (5; dsec 15)", NULL, &given.bins, NULL},
        {"--normalise", 0, "HOW", "voxel: none, population, sample (the style's own)", NULL, &given.normalise, NULL},
        {"--decay", 0, "SECONDS", "surface: time constant (0.03)", NULL, &given.decay, NULL},
        {"--window", 0, "SECONDS", "an array for each window of this length (one for all)", NULL, &j.stretch.window_text, NULL},
        {"--step", 0, "SECONDS", "from the start of a window to that of the next (the window)", NULL, &j.stretch.step_text,
         NULL},
        {"--events", 0, "N", "an array for every N events", NULL, &given.events, NULL},
        {"--partial", 0, NULL, "keep the last window where it is shorter", &j.partial, NULL, NULL},
        {"--start", 0, "SECONDS", "the first window begins here (the recording's start, else the first event)", NULL,
         &j.stretch.start_text, NULL},
        {"--stop", 0, "SECONDS", "and the last one ends by here (the recording's end, else after the last event)", NULL,
         &j.stretch.stop_text, NULL},
        CLI_READING_FILE(j.stretch.reading),
        CLI_READING_CLOCK(j.stretch.reading),
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &j.stretch.file);
    if (code == CLI_GO) code = parse(command, &given, &j);
    if (code != CLI_GO) return code;
    tides_error error = {TIDES_OK, ""};
    cli_catch_interrupt();
    code = run(&j, &error) == TIDES_OK ? report(&j) : cli_fail(&error);
    free(j.array);
    free(j.recording.events);
    return code;
}
