/* Rows of events that go from the comparator to no sink, and to files. They time the host's part of a run in which many pixels
 * fire often: the comparator, the sink, and the opening and finishing of a file. Rendering doesn't count. The time in which
 * the operating system writes the file to its disk doesn't count either. */
#include "bench_targets.h"
#include "bench_throughput.h"
#include "bench_worlds.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { RUNS = 9, RUNS_QUICK = 3 };
#define THRESHOLD 0.01   /* [log units] most pixels fire some events in a step */
#define STEP_S 0.002     /* [s] of equal steps */
#define NOTHING_LEAST 30 /* target without a sink [million events/s] */
#define HDF5_LEAST 8     /* target for compressed HDF5 */

/* A sink of events. A NULL `ending` stands for none. */
typedef struct sink {
    const char *name, *ending;
    double least; /* its target; 0: none */
} sink;
static const sink sinks[] = {{"nothing", NULL, NOTHING_LEAST},
                             {"HDF5", ".h5", HDF5_LEAST},
                             {"RAW", ".raw", 0},
                             {"npy", ".npy", 0}};
enum { SINKS = sizeof sinks / sizeof sinks[0] };

typedef struct sink_times {
    double compare[RUNS], into[RUNS], both[RUNS];
    double events, bytes;
} sink_times;

static tides_status run_into(const bench *b, tides_simulator *simulator, const bench_scene *scene, const sink *to,
                             double *outside, sink_times *times, tides_error *error) {
    char path[4200];
    struct stat found;
    const tides_event_file facts = {.width = scene->intrinsics.width, .height = scene->intrinsics.height};
    *outside = 0;
    if (!to->ending) return tides_simulator_run(simulator, scene->stop, cli_keep, NULL, NULL, NULL, error);
    tides_status status = bench_path(b, "throughput_events", to->ending, path, sizeof path, error);
    if (status != TIDES_OK) return status;
    const double began = cli_now();
    tides_recording how;
    tides_recording_defaults(&how);
    how.checkpoint_s = 0;
    status = tides_simulator_write(simulator, scene->stop, path, &facts, &how, NULL, NULL, NULL, error);
    *outside = cli_now() - began;
    if (stat(path, &found) == 0) times->bytes = (double)found.st_size;
    unlink(path);
    return status;
}

static tides_status measure(const bench *b, const bench_scene *scene, const sink *to, int32_t run, sink_times *times,
                            tides_error *error) {
    tides_simulator *simulator = NULL;
    tides_stepping stepping;
    tides_stats stats;
    double elapsed;
    tides_stepping_defaults(&stepping);
    stepping.mode = TIDES_STEPPING_FIXED;
    stepping.step_s = STEP_S;
    tides_status status =
        tides_simulator_create(b->device, scene->scene, scene->camera, &scene->intrinsics, &scene->image, &scene->sensor,
                               &stepping, scene->start, scene->stop, NULL, NULL, &simulator, error);
    if (status == TIDES_OK) status = run_into(b, simulator, scene, to, &elapsed, times, error);
    if (status == TIDES_OK) {
        tides_simulator_stats(simulator, &stats);
        times->compare[run] = stats.time_compare_s;
        times->into[run] = stats.time_sink_s + (to->ending ? fmax(0, elapsed - stats.run_time_s) : 0);
        times->both[run] = times->compare[run] + times->into[run];
        times->events = (double)stats.events;
    }
    tides_simulator_destroy(simulator);
    return status;
}

/* -- rows ----------------------------------------------------------------------------------------------------------------- */

static tides_status add_row(bench_stages *stages, const bench_scene *scene, const sink *to, const char *stage, double *seconds,
                            int32_t runs, double share, const sink_times *times, double *median, tides_error *error) {
    bench_stage *row = bench_stages_add(stages, scene, to->name, stage, error);
    if (!row) return TIDES_NO_MEMORY;
    bench_quartiles(seconds, runs, &row->low_s, &row->time_s, &row->high_s);
    row->runs = runs;
    row->share = share > 0 ? row->time_s / share : 1;
    row->calls = 1;
    row->items = times->events;
    row->unit = "event";
    if (to->ending && strcmp(stage, "compare") != 0) row->bytes = times->bytes;
    *median = row->time_s;
    return TIDES_OK;
}

static tides_status add_rows(const bench *b, bench_stages *stages, const bench_scene *scene, const sink *to, sink_times *times,
                             int32_t runs, tides_error *error) {
    double both, part;
    tides_status status = add_row(stages, scene, to, "compare to sink", times->both, runs, 0, times, &both, error);
    if (status == TIDES_OK) status = add_row(stages, scene, to, "compare", times->compare, runs, both, times, &part, error);
    if (status == TIDES_OK) status = add_row(stages, scene, to, "sink", times->into, runs, both, times, &part, error);
    if (status != TIDES_OK) return status;
    bench_say(b, "%-9s %4dx%-4d into %-8s %7.3g M events/s of %.3g M events; the sink alone %.3g M/s", scene->name,
              (int)scene->intrinsics.width, (int)scene->intrinsics.height, to->name, 1e-6 * times->events / both,
              1e-6 * times->events, 1e-6 * times->events / part);
    const bench_target target = {.name = "comparator to sink",
                                 .subject = to->name,
                                 .unit = "million events/s",
                                 .measured = 1e-6 * times->events / both,
                                 .bound = to->least,
                                 .least = 1};
    return to->least > 0 ? bench_add_target(stages->targets, &target, error) : TIDES_OK;
}

tides_status bench_sink_rows(bench *b, bench_stages *stages, tides_error *error) {
    const int32_t runs = b->quick ? RUNS_QUICK : RUNS;
    sink_times times[SINKS];
    bench_scene scene;
    memset(times, 0, sizeof times);
    tides_status status = bench_world_make("random", 1, &scene, error); /* few splats, because rendering isn't measured */
    if (status != TIDES_OK) return status;
    bench_resize(&scene, b->quick ? 96 : 346, b->quick ? 72 : 260);
    scene.stop = b->quick ? 0.01 : 0.03; /* short, because there are forty runs, most of whose time is rendering */
    scene.sensor.threshold_on = scene.sensor.threshold_off = THRESHOLD;
    scene.sensor.max_events_per_step = 1000;
    for (int32_t run = -1; run < runs; run++) /* the first run builds kernels */
        for (int32_t i = 0; i < SINKS && status == TIDES_OK; i++)
            status = measure(b, &scene, &sinks[i], run < 0 ? 0 : run, &times[i], error);
    for (int32_t i = 0; i < SINKS && status == TIDES_OK; i++)
        status = add_rows(b, stages, &scene, &sinks[i], &times[i], runs, error);
    bench_scene_free(&scene);
    return status;
}
