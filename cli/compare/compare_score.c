/* Compares streams: the metrics of each row, and the floors, the scores that a perfect simulator could reach. */
#include "compare.h"

#include <stdlib.h>
#include <string.h>

enum { WANTED = TIDES_METRICS_DEFAULT | TIDES_METRIC_MATCH };

static tides_metrics_options options_of(const comparison *c, const compare_pair *pair) {
    tides_metrics_options options;
    tides_metrics_options_defaults(&options);
    options.wanted = pair->wanted;
    options.width = c->session.intrinsics.width;
    options.height = c->session.intrinsics.height;
    options.match_limit_s = pair->reference == COMPARE_EXACT ? TIDES_MATCH_LIMIT_S : c->fair.tolerance_s;
    compare_interval(c, pair->reference, &options.start_ns, &options.stop_ns);
    return options;
}

tides_status compare_measure(comparison *c, const compare_pair *pair, tides_metrics *metrics, tides_error *error) {
    const tides_metrics_options options = options_of(c, pair);
    return tides_metrics_compare(pair->events, pair->count, pair->stream->events, pair->stream->count, &options,
                                 cli_progress_step, &c->progress, metrics, error);
}

/* The metrics as the report has them. */
static tides_status report(comparison *c, const compare_pair *pair, cJSON **json, tides_error *error) {
    tides_metrics metrics;
    const tides_metrics_options options = options_of(c, pair);
    tides_status status = compare_measure(c, pair, &metrics, error);
    if (status != TIDES_OK) return status;
    *json = cli_metrics_json(&metrics, &options);
    return *json ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: metrics");
}

tides_status compare_score(comparison *c, compare_row *row, tides_error *error) {
    tides_status status = TIDES_OK;
    cli_stream kept;
    const compare_pair with_exact = {c->exact.events, c->exact.count, &row->stream, COMPARE_EXACT, WANTED};
    const compare_pair with_recording = {c->recording.events, c->recording.count, &kept, COMPARE_RECORDING, WANTED};
    /* On frames the exact stream is TIDES' own straight lines, so that TIDES isn't compared with it. */
    if (c->with_exact && !(c->session.frames && strcmp(row->name, "tides") == 0))
        status = report(c, &with_exact, &row->against[COMPARE_EXACT], error);
    if (status != TIDES_OK || !c->recording_file) return status;
    status = compare_fair_events(c, &row->stream, &kept, error);
    if (status == TIDES_OK) status = report(c, &with_recording, &row->against[COMPARE_RECORDING], error);
    free(kept.events);
    return status;
}

/* -- floors ---------------------------------------------------------------------------------------------------------------- */

/* Runs TIDES again, from references anywhere between the levels: those of the recording's pixels aren't known. */
static tides_status run_again(comparison *c, const compare_row *row, uint64_t seed, cli_stream *kept, tides_error *error) {
    char text[COMPARE_SETTING];
    cli_list more = row->found;
    snprintf(text, sizeof text, "seed=\"%llu\"", (unsigned long long)seed);
    more.items[more.count++] = text;
    if (!tides_run_gives(c->session.run, "sensor.initial")) more.items[more.count++] = "sensor.initial=random";
    c->progress.label = "floor";
    return compare_run_fair(c, row, &more, kept, error);
}

static tides_status of_seeds(comparison *c, const compare_row *row, tides_error *error) {
    cli_stream one = {.events = NULL}, other = {.events = NULL};
    const uint64_t seed = strtoull(c->session.values.seed, NULL, 10);
    tides_status status = run_again(c, row, seed, &one, error);
    if (status == TIDES_OK) status = run_again(c, row, seed + 1, &other, error);
    const compare_pair seeds = {one.events, one.count, &other, COMPARE_RECORDING, WANTED};
    if (status == TIDES_OK) status = report(c, &seeds, &c->floors[COMPARE_SEEDS], error);
    free(one.events);
    free(other.events);
    return status;
}

/* Compares the recording's even columns with its odd ones, which see nearly the same light. Scores by single pixels have no
 * floor here, since neighbours see an edge at different times; distributions, counts and rates have. */
static tides_status of_pixels(comparison *c, tides_error *error) {
    const cli_window *w = &c->recording;
    cli_stream halves[2] = {{.events = malloc((w->count + 1) * sizeof *w->events)},
                            {.events = malloc((w->count + 1) * sizeof *w->events)}};
    tides_status status = halves[0].events && halves[1].events ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory");
    for (size_t i = 0; status == TIDES_OK && i < w->count; i++) {
        cli_stream *half = &halves[w->events[i].x % 2];
        half->events[half->count] = w->events[i];
        half->events[half->count++].x /= 2;
    }
    const compare_pair pixels = {halves[0].events, halves[0].count, &halves[1], COMPARE_RECORDING,
                                 TIDES_METRIC_COUNTS | TIDES_METRIC_ISI | TIDES_METRIC_FANO};
    if (status == TIDES_OK) status = report(c, &pixels, &c->floors[COMPARE_PIXELS], error);
    for (int i = 0; i < 2; i++) free(halves[i].events);
    return status;
}

tides_status compare_floors(comparison *c, tides_error *error) {
    tides_status status = TIDES_OK;
    if (!c->recording_file) return status;
    for (int32_t i = 0; i < c->count && status == TIDES_OK; i++)
        if (strcmp(c->rows[i].name, "tides") == 0 && c->rows[i].error.status == TIDES_OK)
            status = of_seeds(c, &c->rows[i], error);
    if (status == TIDES_OK) status = of_pixels(c, error);
    cli_progress_end(&c->progress);
    return status;
}
