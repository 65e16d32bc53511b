/* tides bench sensors: run time with presets of real sensors over that with the ideal one, with the run file's default
 * stepping. The scene is the first 50 ms of the demo's world, or scenes that the user names. Step control chooses the steps
 * for each sensor, so that sensors may differ in renders too (`tides bench blocks` has equal steps for all). */
#include "bench.h"
#include "bench_worlds.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LENGTH_S 0.05
#define LENGTH_QUICK_S 0.003
#define LOG_EPS 0.01 /* that of the demo's run */

/* The sensors. Ratios are over the first one, `ideal`. Presets of chips run with the readout of their chip. A DAVIS also has
 * the background activity filter of 2 ms: its driver, libcaer, turns the filter on by default. The rows of group "front end"
 * have one block each, at the size that `tides bench blocks` uses too. */
#define WITH_READOUT(name, ...)                                                        \
    {                                                                                  \
        name, "preset", { "sensor.preset=" name, "readout.enabled=true", __VA_ARGS__ } \
    }
#define DAVIS(name) WITH_READOUT(name, "filters.background_s=0.002")
static const bench_case sensors[] = {
    {"ideal", "preset", {"sensor.preset=ideal"}},
    WITH_READOUT("dvs128", NULL),
    WITH_READOUT("dvs128-lowlight", NULL),
    DAVIS("davis240"),
    DAVIS("davis240-frames"),
    DAVIS("davis346"),
    DAVIS("davis346-frames"),
    WITH_READOUT("dvxplorer", NULL),
    WITH_READOUT("gen3", NULL),
    WITH_READOUT("gen4", NULL),
    WITH_READOUT("imx636", NULL),
    WITH_READOUT("imx636-lowlight", NULL),
    WITH_READOUT("genx320", NULL),
    {"v2e-noisy", "preset", {"sensor.preset=v2e-noisy"}},
    {"additive noise", "front end", {"frontend.noise_rms=0.02"}},
    {"circuit", "front end", {"frontend.bandwidth=circuit"}},
    {"centre-surround", "front end", {"frontend.center_surround=[2,0.001]"}},
};
enum { SENSORS = sizeof sensors / sizeof sensors[0] };

static tides_status make_scene(const bench *b, const char *name, bench_scene *scene, tides_error *error) {
    if (strcmp(name, "demo") != 0) return bench_world_make(name, b->quick, scene, error);
    tides_status status = bench_make_demo(0, scene, error);
    scene->stop = b->quick ? LENGTH_QUICK_S : LENGTH_S;
    scene->image.log_eps = LOG_EPS;
    return status;
}

static int32_t cells_of(const void *rows, size_t index, bench_cell cells[BENCH_CELLS_MAX]) {
    const bench_cost *c = (const bench_cost *)rows + index;
    const bench_cell made[] = {
        {"scene", c->scene, 0},
        {"sensor", c->block, 0},
        {"group", c->group, 0},
        {"runs", NULL, c->runs},
        {"run_time_s", NULL, c->run_time_s},
        {"run_time_ratio", NULL, c->run_ratio},
        {"processor_time_s", NULL, c->processor_s},
        {"ratio", NULL, c->ratio},
        {"ratio_low", NULL, c->ratio_low},
        {"ratio_high", NULL, c->ratio_high},
        {"compare_s", NULL, c->stats.time_compare_s},
        {"events", NULL, (double)c->stats.events_written},
        {"renders", NULL, c->stats.renders_full_frame_equivalent},
        {"error_p95_us", NULL, 1e6 * c->stats.error_p95_s},
        {"settings", c->settings, 0},
    };
    memcpy(cells, made, sizeof made);
    return sizeof made / sizeof made[0];
}

static void print_table(const bench_cost *costs, size_t count) {
    printf("%-10s %-16s %10s %7s %12s %7s %15s %10s\n", "scene", "sensor", "run time s", "ratio", "processor s", "ratio",
           "quartiles", "events");
    for (const bench_cost *c = costs; c < costs + count; c++)
        printf("%-10s %-16s %10.3g %7.3f %12.3g %7.3f %7.3f %7.3f %10.6g\n", c->scene, c->block, c->run_time_s, c->run_ratio,
               c->processor_s, c->ratio, c->ratio_low, c->ratio_high, (double)c->stats.events_written);
}

static tides_status measure_scene(bench *b, const char *name, bench_cost *costs, cJSON *header, tides_error *error) {
    bench_scene scene = {.scene = NULL};
    bench_pairs *p = calloc(SENSORS, sizeof *p);
    /* A sensor gets no more runs after 40 s of them (0.5 s with --quick), but at least two with their reference runs. */
    bench_plan plan = {sensors, SENSORS, 40, 0.5, {0}};
    tides_stepping_defaults(&plan.stepping);
    tides_status status = p ? make_scene(b, name, &scene, error) : cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    for (size_t i = 0; i < SENSORS && status == TIDES_OK; i++) bench_pairs_begin(&scene, &sensors[i], &costs[i]);
    if (status == TIDES_OK) status = bench_pairs_measure(b, &scene, &plan, p, costs, error);
    for (size_t i = 0; i < SENSORS && status == TIDES_OK; i++) {
        costs[i].pixel_steps = costs[i].stats.renders_full_frame_equivalent * scene.intrinsics.width * scene.intrinsics.height;
        bench_pairs_judge(&p[i], &costs[i]);
        bench_say(b, "%-10s %-16s %8.3g s  x %.4g (%.4g to %.4g)", costs[i].scene, costs[i].block, costs[i].run_time_s,
                  costs[i].ratio, costs[i].ratio_low, costs[i].ratio_high);
    }
    if (status == TIDES_OK && !bench_header_scene(header, &scene, NULL))
        status = cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    free(p);
    bench_scene_free(&scene);
    return status;
}

tides_status bench_sensors(bench *b, const cli_list *scenes, tides_error *error) {
    const cli_list demo = {.items = {"demo"}, .count = 1}, *asked = scenes->count ? scenes : &demo;
    bench_cost *costs = calloc(asked->count * SENSORS, sizeof *costs);
    cJSON *header = bench_header(b, "sensors");
    tides_status status = costs && header ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    for (size_t i = 0; i < asked->count && status == TIDES_OK; i++)
        status = measure_scene(b, asked->items[i], costs + i * SENSORS, header, error);
    const bench_table table = {costs, asked->count * SENSORS, cells_of};
    if (status == TIDES_OK) status = bench_write_table(b, "sensors", header, &table, error);
    if (status == TIDES_OK) status = bench_figure_ratios(b, costs, SENSORS, error);
    if (status == TIDES_OK && !b->common->quiet && !b->common->json) print_table(costs, table.count);
    cJSON_Delete(header);
    free(costs);
    return status;
}
