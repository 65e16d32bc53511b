/* Measured runs of a benchmark, scene by scene. */
#include "bench.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Runs shorter than this [s] are repeated. */
#define SHORT_RUN_S 1.0

/* -- talk --------------------------------------------------------------------------------------------------------------- */

void bench_say(const bench *b, const char *format, ...) {
    if (b->common->quiet) return;
    va_list arguments;
    va_start(arguments, format);
    cli_say(format, arguments, "\n");
    va_end(arguments);
}

void bench_say_row(const bench *b, const bench_row *row) {
    bench_say(b, "%-13s %-12s %9.6g %-11s %8.3g s %8.5g renders  median %8.3g  p95 %8.3g us  mismatch %.3g %%", row->scene,
              row->method, row->setting, row->unit, row->run_time_s, row->stats.renders_full_frame_equivalent,
              row->match.dt_median_us, row->match.dt_p95_us, row->match.mismatch_percent);
}

void bench_choose_parts(tides_stepping *stepping, int32_t parts) {
    stepping->solve = parts & BENCH_SOLVED ? TIDES_SOLVE_DOUBLE : TIDES_SOLVE_OFF;
    stepping->unit = parts & BENCH_BLOCKS ? TIDES_UNIT_BLOCK : TIDES_UNIT_TILE;
}

/* -- figures -------------------------------------------------------------------------------------------------------------- */

static double quantile(const double *sorted, int32_t count, double share) {
    const double at = share * (count - 1);
    const int32_t below = (int32_t)at;
    if (below + 1 >= count) return sorted[count - 1];
    return sorted[below] + (at - below) * (sorted[below + 1] - sorted[below]);
}

void bench_quartiles(double *values, int32_t count, double *low, double *median, double *high) {
    cli_sort(values, (size_t)count);
    *low = quantile(values, count, 0.25);
    *median = quantile(values, count, 0.5);
    *high = quantile(values, count, 0.75);
}

double bench_processor_s(int32_t all_threads) {
    struct timespec now;
    clock_gettime(all_threads ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

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

tides_status bench_simulate(bench *b, const bench_scene *scene, int32_t rules, const tides_sensor *sensor,
                            const tides_stepping *stepping, cli_stream *stream, bench_row *row, tides_error *error) {
    tides_image_params image = scene->image;
    tides_simulator *simulator = NULL;
    tides_stats before;
    image.rules = rules;
    if (stream) stream->count = 0;
    tides_status status =
        tides_simulator_create(b->device, scene->scene, scene->camera, &scene->intrinsics, &image, sensor, stepping,
                               scene->start, scene->stop, cli_progress_step, &b->progress, &simulator, error);
    if (status == TIDES_OK) status = tides_simulator_readout(simulator, &scene->readout, error);
    if (status == TIDES_OK) status = tides_simulator_filters(simulator, &scene->filters, error);
    if (status != TIDES_OK) {
        tides_simulator_destroy(simulator);
        return status;
    }
    tides_simulator_stats(simulator, &before);
    const double began = cli_now(), all_began = bench_processor_s(1), own_began = bench_processor_s(0);
    status = tides_simulator_run(simulator, scene->stop, cli_keep, stream, cli_progress_step, &b->progress, error);
    const double elapsed = cli_now() - began;
    row->all_threads_s = bench_processor_s(1) - all_began;
    row->own_thread_s = bench_processor_s(0) - own_began;
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
    if (row->refused || (row->runs > 0 && row->run_time_s > SHORT_RUN_S)) return TIDES_OK;
    const int32_t again = row->runs > 0;
    const tides_exact *truth = &scene->truth[rules];
    cli_stream stream = {.events = NULL};
    snprintf(row->scene, sizeof row->scene, "%s", scene->name);
    row->image = scene->image_name ? scene->image_name : bench_rules_name(rules);
    tides_error reason = {TIDES_OK, ""};
    tides_status status = bench_simulate(b, scene, rules, sensor, stepping, &stream, row, &reason);
    row->refused = status == TIDES_UNSUPPORTED && stepping->solve == TIDES_SOLVE_DOUBLE;
    if (row->refused) bench_say(b, "%-13s %s is left out: %s", scene->name, row->method, reason.text);
    if (row->refused) return TIDES_OK;
    if (status != TIDES_OK) *error = reason;
    if (status == TIDES_OK && !again)
        status = tides_match_events(truth->events, truth->count, stream.events, stream.count, TIDES_MATCH_LIMIT_S, &row->match,
                                    error);
    free(stream.events);
    if (status != TIDES_OK || again) return status;
    row->exact_share = bench_exact_share(truth, &row->match);
    bench_say_row(b, row);
    return status;
}

/* -- scenes -------------------------------------------------------------------------------------------------------------- */

static int32_t is_built_in(const char *name) {
    for (const char *const *known = bench_scene_names(); *known; known++)
        if (strcmp(*known, name) == 0) return 1;
    return 0;
}

tides_status bench_each_scene(bench *b, const cli_list *names, bench_visit visit, void *user, tides_error *error) {
    /* Scenes of --quick; the others take too long, and --scene can name them. */
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

/* -- a benchmark of rows ------------------------------------------------------------------------------------------------- */

static void drop_refused(bench_rows *rows) {
    size_t kept = 0;
    for (size_t i = 0; i < rows->count; i++)
        if (!rows->rows[i].refused) rows->rows[kept++] = rows->rows[i];
    rows->count = kept;
}

tides_status bench_fill_sheet(bench *b, const bench_kind *kind, const cli_list *scenes, tides_error *error) {
    bench_sheet sheet = {.header = bench_header(b, kind->name)};
    if (!sheet.header) return cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    tides_status status = bench_each_scene(b, scenes, kind->visit, &sheet, error);
    drop_refused(&sheet.rows);
    if (status == TIDES_OK) status = bench_write(b, kind->name, sheet.header, &sheet.rows, error);
    if (status == TIDES_OK) status = kind->figure(b, &sheet.rows, error);
    if (status == TIDES_OK && !b->common->quiet && !b->common->json) kind->print(&sheet.rows);
    cJSON_Delete(sheet.header);
    free(sheet.rows.rows);
    return status;
}
