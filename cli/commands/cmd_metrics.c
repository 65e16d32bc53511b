/* tides metrics: compares a simulated stream with a reference. */
#include "metrics_report.h"
#include "recording.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The families of the library's table, each once, in its order. */
enum { FAMILIES_MAX = 32 };
typedef struct families {
    const tides_metric *first[FAMILIES_MAX]; /* first row of each */
    size_t count;
    char list[256]; /* "counts,isi,..." */
} families;

static void find_families(families *f) {
    size_t count, used = 0;
    const tides_metric *table = tides_metrics_table(&count);
    *f = (families){.count = 0};
    for (uint32_t bit = 1; bit && bit <= TIDES_METRICS_ALL; bit <<= 1)
        for (const tides_metric *row = table; row < table + count && f->count < FAMILIES_MAX; row++) {
            if (row->wanted != bit) continue;
            f->first[f->count++] = row;
            used += (size_t)snprintf(f->list + used, sizeof f->list - used, "%s%s", used ? "," : "", row->family);
            break;
        }
}

/* Texts of options; NULL where not given. */
typedef struct arguments {
    const char *files[2];
    const char *only, *roi, *window, *from, *to, *speed, *clock;
    cli_reading reading;
    int32_t exact;
} arguments;

/* ---- the command line ---- */

static int unknown_family(const cli_command *command, const families *f, const char *name) {
    const char *names[FAMILIES_MAX + 1] = {NULL};
    for (size_t i = 0; i < f->count; i++) names[i] = f->first[i]->family;
    const char *nearest = tides_nearest_name(name, names);
    if (nearest) return cli_usage(command, "--only: no metric is called %s; did you mean %s?", name, nearest);
    return cli_usage(command, "--only: no metric is called %s: there are %s", name, f->list);
}

/* Parses "isi,chamfer". */
static int parse_only(const cli_command *command, const char *text, uint32_t *wanted) {
    families f;
    find_families(&f);
    *wanted = 0;
    for (;;) {
        char name[32];
        const size_t length = strcspn(text, ",");
        size_t i = 0;
        snprintf(name, sizeof name, "%.*s", (int)(length < sizeof name ? length : sizeof name - 1), text);
        while (i < f.count && strcmp(f.first[i]->family, name) != 0) i++;
        if (i == f.count) return unknown_family(command, &f, name);
        *wanted |= f.first[i]->wanted;
        if (!text[length]) return CLI_GO;
        text += length + 1;
    }
}

/* Parses "x,y,width,height". */
static int parse_roi(const cli_command *command, const char *text, int32_t roi[4]) {
    const char *at = text;
    for (int i = 0; i < 4; i++) {
        char *end = NULL;
        errno = 0;
        const long value = strtol(at, &end, 10);
        if (end == at || errno || value < (i < 2 ? 0 : 1) || value > 65536 || *end != (i < 3 ? ',' : '\0'))
            return cli_usage(command, "--roi %s: should be x,y,width,height in pixels", text);
        roi[i] = (int32_t)value;
        at = end + 1;
    }
    return CLI_GO;
}

/* Parses a number above 0; keeps `value` where the option isn't given. */
static int parse_positive(const cli_command *command, const char *name, const char *text, double *value) {
    if (!text) return CLI_GO;
    const int code = cli_number(command, name, text, value);
    if (code != CLI_GO || *value > 0) return code;
    return cli_usage(command, "%s %s: should be above 0", name, text);
}

static int parse_time(const cli_command *command, const char *name, const char *text, int64_t *ns) {
    const int64_t most = INT64_C(2000000000000000000);
    if (!text) return CLI_GO;
    const int code = cli_time(command, name, text, ns);
    if (code != CLI_GO) return code;
    return *ns > most || *ns < -most ? cli_usage(command, "%s %s: is beyond 63 years", name, text) : CLI_GO;
}

static int parse_options(const cli_command *command, const arguments *given, tides_metrics_options *options) {
    int code = given->only ? parse_only(command, given->only, &options->wanted) : CLI_GO;
    if (given->exact) options->wanted |= TIDES_METRIC_MATCH;
    if (code == CLI_GO && given->roi) code = parse_roi(command, given->roi, options->roi);
    if (code == CLI_GO) code = parse_positive(command, "--window", given->window, &options->window_s);
    if (code == CLI_GO) code = parse_positive(command, "--speed", given->speed, &options->speed_px_per_s);
    if (code == CLI_GO) code = parse_positive(command, "--clock", given->clock, &options->clock_s);
    if (code != CLI_GO || (!given->from && !given->to)) return code;
    /* An end that isn't given is 2^61 ns (73 years) from 0, the limit of times. */
    options->start_ns = INT64_C(-2305843009213693952);
    options->stop_ns = INT64_C(2305843009213693952);
    code = parse_time(command, "--from", given->from, &options->start_ns);
    if (code == CLI_GO) code = parse_time(command, "--to", given->to, &options->stop_ns);
    if (code == CLI_GO && options->start_ns >= options->stop_ns) return cli_usage(command, "--from must come before --to");
    return code;
}

/* ---- the streams ---- */

/* Reads all events in order of time. */
static tides_status read_stream(const char *file, const tides_event_reading *how, cli_window *s, tides_error *error) {
    *s = (cli_window){.first_ns = INT64_MIN, .stop_ns = INT64_MAX, .how = how};
    return cli_window_read(file, s, error);
}

/* Sets the sensor's size: that of the files, where they have one and agree. */
static tides_status set_sensor(const char *const files[2], const cli_window s[2], tides_metrics_options *o,
                               tides_error *error) {
    const tides_event_facts *a = &s[0].facts, *b = &s[1].facts;
    if (a->width && b->width && (a->width != b->width || a->height != b->height))
        return cli_error(error, TIDES_BAD_ARGUMENT, "%s is %dx%d px and %s %dx%d px: streams of one size can be compared",
                         files[0], a->width, a->height, files[1], b->width, b->height);
    const tides_event_facts *known = a->width && a->height ? a : b;
    if (known->width && known->height) {
        o->width = known->width;
        o->height = known->height;
    }
    return TIDES_OK;
}

/* Checks that a given interval belongs to both recordings; an end that isn't given comes from the streams. */
static tides_status set_interval(const char *const files[2], const cli_window s[2], tides_metrics_options *o,
                                 tides_error *error) {
    const int64_t open = INT64_C(2305843009213693952);
    int64_t first = 0, stop = 0;
    int32_t any = 0;
    for (int i = 0; i < 2; i++) {
        tides_status status = cli_window_check(files[i], &s[i], o->start_ns == -open ? INT64_MIN : o->start_ns,
                                               o->stop_ns == open ? INT64_MAX : o->stop_ns, error);
        if (status != TIDES_OK) return status;
        if (s[i].count == 0) continue;
        if (!any || s[i].seen_ns < first) first = s[i].seen_ns;
        if (!any || s[i].seen_stop_ns > stop) stop = s[i].seen_stop_ns;
        any = 1;
    }
    if (o->start_ns == -open) o->start_ns = first < o->stop_ns ? first : o->stop_ns - 1;
    if (o->stop_ns == open) o->stop_ns = stop > o->start_ns ? stop : o->start_ns + 1;
    return TIDES_OK;
}

/* ---- the work ---- */

/* A progress bar, shown after a second of work. */
typedef struct waiting {
    cli_progress bar;
    int32_t quiet;
    double began;
} waiting;

static int step(void *user, double fraction, const char *stage) {
    waiting *w = user;
    w->bar.quiet = w->quiet || cli_now() - w->began < 1.0;
    return cli_progress_step(&w->bar, fraction, stage);
}

/* Compares two streams. `how` is for both, except that only the simulated one is shifted. */
static tides_status compare(const char *const files[2], const tides_event_reading *how, cli_window s[2],
                            tides_metrics_options *options, const cli_common *common, tides_metrics *metrics,
                            tides_error *error) {
    tides_event_reading unshifted = *how;
    unshifted.offset_ns = 0;
    tides_status status = read_stream(files[0], &unshifted, &s[0], error);
    if (status == TIDES_OK) status = read_stream(files[1], how, &s[1], error);
    if (status == TIDES_OK) status = set_sensor(files, s, options, error);
    if (status == TIDES_OK && options->start_ns != options->stop_ns) status = set_interval(files, s, options, error);
    if (status != TIDES_OK) return status;
    for (int i = 0; i < 2; i++) cli_reading_tell(common, files[i], &s[i].facts, how->rebase);
    waiting w = {.quiet = common->quiet, .began = cli_now()};
    status = tides_metrics_compare(s[0].events, s[0].count, s[1].events, s[1].count, options, step, &w, metrics, error);
    cli_progress_end(&w.bar);
    return status;
}

static int report(const char *const files[2], const tides_metrics *metrics, const tides_metrics_options *options,
                  const cli_common *common) {
    cJSON *facts = cli_metrics_json(metrics, options);
    if (!facts) return cli_failed("out of memory");
    if (!common->json) {
        if (!common->quiet) cli_metrics_print(facts);
        cJSON_Delete(facts);
        return CLI_OK;
    }
    cJSON_AddStringToObject(facts, "reference_file", files[0]);
    cJSON_AddStringToObject(facts, "simulated_file", files[1]);
    return cli_print_facts(facts, 1);
}

int cmd_metrics(const cli_command *command, int argc, char **argv) {
    cli_common common;
    arguments given = {.files = {NULL, NULL}};
    families known;
    find_families(&known);
    const cli_option options[] = {
        {"--only", 0, "LIST", known.list, NULL, &given.only, NULL},
        {"--exact", 0, NULL, "the reference is exact: also match its events one by one", &given.exact, NULL, NULL},
        {"--window", 0, "S", "Chamfer: length of a window in seconds (0.05)", NULL, &given.window, NULL},
        {"--speed", 0, "PX_PER_S", "Chamfer: how fast the image moves (found from the reference)", NULL, &given.speed, NULL},
        {"--clock", 0, "S", "ISI spike: period of a clock in seconds (found from the intervals)", NULL, &given.clock, NULL},
        {"--roi", 0, "X,Y,W,H", "only events of this region", NULL, &given.roi, NULL},
        {"--from", 0, "S", "only events from this time on", NULL, &given.from, NULL},
        {"--to", 0, "S", "only events before this time", NULL, &given.to, NULL},
        {"--rebase", 0, NULL, "count each stream's times from its recording's zero", &given.reading.rebase, NULL, NULL},
        {"--offset", 0, "SECONDS", "add this to the simulated stream's times", NULL, &given.reading.offset, NULL},
        {"--drop-invalid", 0, NULL, "leave out events that can't be, and say how many", &given.reading.drop_invalid, NULL,
         NULL},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, given.files);
    if (code != CLI_GO) return code;
    tides_metrics_options wanted;
    tides_metrics_options_defaults(&wanted);
    tides_event_reading how;
    if ((code = parse_options(command, &given, &wanted)) != CLI_GO) return code;
    if ((code = cli_reading_parse(command, &given.reading, &how)) != CLI_GO) return code;

    tides_error error = {TIDES_OK, ""};
    tides_metrics metrics;
    cli_window streams[2] = {{.events = NULL}, {.events = NULL}};
    cli_catch_interrupt();
    const tides_status status = compare(given.files, &how, streams, &wanted, &common, &metrics, &error);
    code = status == TIDES_OK ? report(given.files, &metrics, &wanted, &common) : cli_fail(&error);
    free(streams[0].events);
    free(streams[1].events);
    return code;
}
