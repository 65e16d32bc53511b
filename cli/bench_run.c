/* Measured runs of a benchmark, and the exact streams that they are measured against. */
#include "bench.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Runs shorter than this [s] are repeated. */
#define SHORT_RUN_S 1.0

/* The exact stream is found by doubling the steps per second until the 99th percentile of the events moves by no more than the
 * unit that they are counted in. It is at least twice as fine as the finest method (LEAST); beyond that, doubling ends at LAST,
 * or where a run takes LONG_RUN_S, so that the next would take twice that. Two things keep streams from settling: jumps in the
 * image are placed as well as the steps are short, and single precision moves the events of slow pixels. */
#define TRUTH_FIRST_RATE 64000.0
#define TRUTH_LEAST_RATE 128000.0
#define TRUTH_LAST_RATE 512000.0
#define TRUTH_SETTLED_US 1e-3
#define LONG_RUN_S 4.0
/* With --quick, whose finest method has 32000 frames per second, from a half of this to this. */
#define TRUTH_QUICK_RATE 64000.0

/* -- talk --------------------------------------------------------------------------------------------------------------- */

void bench_say(const bench *b, const char *format, ...) {
    if (b->common->quiet) return;
    va_list arguments;
    fputs("tides: ", stderr);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

void bench_say_row(const bench *b, const bench_row *row) {
    bench_say(b, "%-13s %-12s %9.6g %-11s %8.3g s %8.5g renders  median %8.3g  p95 %8.3g us  mismatch %.3g %%", row->scene,
              row->method, row->setting, row->unit, row->run_time_s, row->stats.renders_full_frame_equivalent,
              row->match.dt_median_us, row->match.dt_p95_us, row->match.mismatch_percent);
}

const char *bench_rules_name(int32_t rules) { return rules == TIDES_RULES_INRIA ? "inria" : "smooth"; }

/* -- rows ---------------------------------------------------------------------------------------------------------------- */

bench_row *bench_rows_add(bench_rows *rows, tides_error *error) {
    if (rows->count == rows->capacity) {
        size_t capacity = rows->capacity ? 2 * rows->capacity : 64;
        bench_row *grown = realloc(rows->rows, capacity * sizeof *grown);
        if (!grown) {
            cli_error(error, TIDES_NO_MEMORY, "out of memory: rows of results");
            return NULL;
        }
        rows->rows = grown;
        rows->capacity = capacity;
    }
    bench_row *row = &rows->rows[rows->count++];
    memset(row, 0, sizeof *row);
    return row;
}

/* -- runs ---------------------------------------------------------------------------------------------------------------- */

/* A sink that keeps everything. Its own status stops the run: out of memory. */
static int keep(void *user, const tides_event *events, size_t count) {
    bench_stream *stream = user;
    if (!stream || count == 0) return 0;
    if (stream->count + count > stream->capacity) {
        size_t capacity = 2 * (stream->count + count);
        tides_event *grown = realloc(stream->events, capacity * sizeof *grown);
        if (!grown) return TIDES_NO_MEMORY;
        stream->events = grown;
        stream->capacity = capacity;
    }
    memcpy(stream->events + stream->count, events, count * sizeof *events);
    stream->count += count;
    return 0;
}

tides_status bench_simulate(bench *b, const bench_scene *scene, int32_t rules, const tides_sensor *sensor,
                            const tides_stepping *stepping, bench_stream *stream, bench_row *row, tides_error *error) {
    tides_image_params image = scene->image;
    tides_simulator *simulator = NULL;
    tides_stats before;
    image.rules = rules;
    if (stream) stream->count = 0;
    tides_status status =
        tides_simulator_create(b->device, scene->scene, scene->camera, &scene->intrinsics, &image, sensor, stepping,
                               scene->start, scene->stop, cli_progress_step, &b->progress, &simulator, error);
    if (status != TIDES_OK) return status;
    tides_simulator_stats(simulator, &before);
    const double began = cli_now();
    status = tides_simulator_run(simulator, scene->stop, keep, stream, cli_progress_step, &b->progress, error);
    const double elapsed = cli_now() - began;
    tides_simulator_stats(simulator, &row->stats);
    tides_simulator_destroy(simulator);
    const double seconds = elapsed - (row->stats.render.time_build_s - before.render.time_build_s);
    if (row->runs == 0 || seconds < row->run_time_s) row->run_time_s = seconds;
    row->runs++;
    cli_note(b->common, "%s, %s image: %.5g renders in %.3g s", scene->name, bench_rules_name(rules),
             row->stats.renders_full_frame_equivalent, seconds);
    return status;
}

tides_status bench_measure(bench *b, const bench_scene *scene, int32_t rules, const tides_sensor *sensor,
                           const tides_stepping *stepping, bench_row *row, tides_error *error) {
    if (row->runs > 0 && row->run_time_s > SHORT_RUN_S) return TIDES_OK;
    const int32_t again = row->runs > 0;
    const bench_truth *truth = &scene->truth[rules];
    bench_stream stream = {.events = NULL};
    snprintf(row->scene, sizeof row->scene, "%s", scene->name);
    row->image = bench_rules_name(rules);
    tides_status status = bench_simulate(b, scene, rules, sensor, stepping, &stream, row, error);
    if (status == TIDES_OK && !again)
        status = tides_match_events(truth->stream.events, truth->stream.count, stream.events, stream.count, BENCH_MATCH_LIMIT_S,
                                    &row->match, error);
    free(stream.events);
    if (status == TIDES_OK && !again) bench_say_row(b, row);
    return status;
}

/* -- truth --------------------------------------------------------------------------------------------------------------- */

static tides_status simulate_exact(bench *b, const bench_scene *scene, int32_t rules, double rate, bench_stream *stream,
                                   double *seconds, tides_error *error) {
    bench_row run;
    tides_stepping stepping;
    memset(&run, 0, sizeof run);
    tides_stepping_defaults(&stepping);
    stepping.mode = TIDES_STEPPING_FIXED;
    stepping.model = TIDES_MODEL_HERMITE;
    stepping.step_s = 1 / rate;
    tides_status status = bench_simulate(b, scene, rules, &scene->sensor, &stepping, stream, &run, error);
    *seconds = run.run_time_s;
    return status;
}

tides_status bench_find_truth(bench *b, bench_scene *scene, int32_t rules, tides_error *error) {
    bench_truth *truth = &scene->truth[rules];
    bench_stream coarse = {.events = NULL}, fine = {.events = NULL};
    const double least = b->quick ? TRUTH_QUICK_RATE : TRUTH_LEAST_RATE, last = b->quick ? TRUTH_QUICK_RATE : TRUTH_LAST_RATE;
    double rate = b->quick ? 0.5 * TRUTH_QUICK_RATE : TRUTH_FIRST_RATE, seconds = 0;
    int32_t settled = 0;
    tides_match moved = {.matched = 0};
    tides_status status = simulate_exact(b, scene, rules, rate, &fine, &seconds, error);
    while (status == TIDES_OK && rate < last && (rate < least || (!settled && seconds < LONG_RUN_S))) {
        bench_stream spare = coarse;
        coarse = fine;
        fine = spare;
        rate *= 2;
        status = simulate_exact(b, scene, rules, rate, &fine, &seconds, error);
        if (status == TIDES_OK)
            status =
                tides_match_events(fine.events, fine.count, coarse.events, coarse.count, BENCH_MATCH_LIMIT_S, &moved, error);
        settled = moved.mismatch_percent == 0 && moved.dt_p99_us <= TRUTH_SETTLED_US;
    }
    free(coarse.events);
    if (status == TIDES_OK && fine.count == 0)
        status = cli_error(error, TIDES_BAD_ARGUMENT, "scene %s: nothing fires, so nothing can be measured", scene->name);
    if (status != TIDES_OK) {
        free(fine.events);
        return status;
    }
    *truth = (bench_truth){fine, rate, moved.dt_p99_us, moved.mismatch_percent};
    bench_say(b,
              "%-13s exact stream of the %s image: %zu events at %.6g steps/s; halving them moves p99 by %.3g us, %.3g %% "
              "mismatched",
              scene->name, bench_rules_name(rules), fine.count, rate, truth->shift_p99_us, truth->shift_mismatch_percent);
    return TIDES_OK;
}

/* -- scenes -------------------------------------------------------------------------------------------------------------- */

static int32_t is_built_in(const char *name) {
    for (const char *const *known = bench_scene_names(); *known; known++)
        if (strcmp(*known, name) == 0) return 1;
    return 0;
}

tides_status bench_each_scene(bench *b, const cli_list *names, bench_visit visit, void *user, tides_error *error) {
    /* The others take too long for a look; --scene has them. */
    static const char *const quick_names[] = {"fan", "occluder", "nearly_static", "playbot", NULL};
    const char *const *all = b->quick ? quick_names : bench_scene_names();
    tides_status status = TIDES_OK;
    size_t visited = 0;
    for (size_t i = 0; status == TIDES_OK && (names->count ? i < names->count : all[i] != NULL); i++) {
        const char *name = names->count ? names->items[i] : all[i];
        bench_scene scene;
        status = bench_scene_make(name, b->quick, &scene, error);
        if (status == TIDES_FILE_NOT_FOUND && is_built_in(name)) {
            bench_say(b, "%s: skipped: %s", name, error->text);
            status = TIDES_OK;
            continue;
        }
        if (status != TIDES_OK) break;
        bench_say(b, "%s: %s; %lld Gaussians, %dx%d px, %g ms", scene.name, scene.sentence,
                  (long long)tides_scene_count(scene.scene), scene.intrinsics.width, scene.intrinsics.height,
                  1e3 * (scene.stop - scene.start));
        status = visit(user, b, &scene, error);
        bench_scene_free(&scene);
        visited++;
    }
    if (status == TIDES_OK && visited == 0)
        return cli_error(error, TIDES_FILE_NOT_FOUND, "none of the scenes is there; set TIDES_SHARED to the folder with data/");
    return status;
}
