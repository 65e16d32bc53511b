/* tides bench blocks: the cost of each block of the sensor and the readout. tides bench sensors: run time with presets of real
 * sensors over that with the ideal one. A row is one line of the tables below; its settings are written as for --set.
 *
 * Each run of a row follows a run of the table's first row, and results are medians over these pairs. Costs are in processor
 * time, which other programs hardly affect. Ratios are of all threads' time. Nanoseconds are of the thread that runs the sensor
 * and the readout, since rendering by other threads would hide them; on the reference device this thread renders too.
 *
 * All rows of blocks take equal steps over the same scene, so that they render the same frames. "off" is measured likewise, as
 * the first row and as the last: the distance of its ratio from 1 is the error of the others. Sensors run with the run file's
 * default stepping, which chooses the steps for each of them. Their scene is the first 50 ms of the demo's world. */
#include "bench.h"
#include "bench_worlds.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STEPS_PER_S 2000.0 /* of blocks [1/s] */
#define LENGTH_S 0.05      /* of the demo's world, for sensors */
#define LENGTH_QUICK_S 0.003
#define LOG_EPS 0.01 /* that of the demo's run */

/* Each block has a size at which it affects the events here: mismatch and leak as in v2e, rates and periods as in its noisy
 * preset. */
static const bench_case blocks[] = {
    {"off", "base", {NULL}},
    {"mismatch", "comparator", {"sensor.threshold_sigma=0.03"}},
    {"refractory hold", "comparator", {"sensor.refractory_s=0.0005", "sensor.refractory_law=hold"}},
    {"refractory drop_keep", "comparator", {"sensor.refractory_s=0.0005", "sensor.refractory_law=drop_keep"}},
    {"refractory drop_consume", "comparator", {"sensor.refractory_s=0.0005", "sensor.refractory_law=drop_consume"}},
    {"leak", "comparator", {"sensor.leak_rate_hz=0.1", "sensor.leak_sigma=0.1"}},
    {"b_min", "comparator", {"sensor.b_min=0.1"}},
    {"shot noise", "comparator", {"frontend.shot_noise_hz=5"}},
    {"hot pixels", "comparator", {"frontend.hot_pixel_fraction=0.001"}},
    {"dead pixels", "comparator", {"sensor.dead_pixel_fraction=0.001"}},
    {"PSF log", "front end", {"frontend.psf_sigma_px=1"}},
    {"PSF linear", "front end", {"frontend.psf_sigma_px=1", "frontend.psf_domain=linear"}},
    {"low-pass", "front end", {"frontend.photoreceptor_cutoff_hz=300"}},
    {"low-pass by light", "front end", {"frontend.photoreceptor_cutoff_hz=300", "frontend.photoreceptor_law=intensity"}},
    {"circuit", "front end", {"frontend.bandwidth=circuit"}},
    {"centre-surround", "front end", {"frontend.center_surround=[2,0.001]"}},
    {"additive noise", "front end", {"frontend.noise_rms=0.02"}},
    {"readout tiles", "readout", {"readout.enabled=true", "readout.kind=tiles"}},
    {"readout rows", "readout", {"readout.enabled=true", "readout.kind=rows"}},
    {"readout bottleneck", "readout", {"readout.enabled=true", "readout.kind=bottleneck"}},
    {"readout requested", "readout", {"readout.enabled=true", "readout.kind=requested", "readout.event_s=1e-8"}},
    {"readout scanned", "readout", {"readout.enabled=true", "readout.kind=scanned"}},
    {"filters", "readout", {"filters.background_s=0.01", "filters.afk=band_stop", "filters.trail=stc_keep"}},
    {"ideal", "preset", {"sensor.preset=ideal"}},
    {"dvs128", "preset", {"sensor.preset=dvs128"}},
    {"dvs128-lowlight", "preset", {"sensor.preset=dvs128-lowlight"}},
    {"davis240", "preset", {"sensor.preset=davis240"}},
    {"davis240-frames", "preset", {"sensor.preset=davis240-frames"}},
    {"davis346", "preset", {"sensor.preset=davis346"}},
    {"davis346-frames", "preset", {"sensor.preset=davis346-frames"}},
    {"dvxplorer", "preset", {"sensor.preset=dvxplorer"}},
    {"gen3", "preset", {"sensor.preset=gen3"}},
    {"gen4", "preset", {"sensor.preset=gen4"}},
    {"imx636", "preset", {"sensor.preset=imx636"}},
    {"imx636-lowlight", "preset", {"sensor.preset=imx636-lowlight"}},
    {"genx320", "preset", {"sensor.preset=genx320"}},
    {"v2e-clean", "preset", {"sensor.preset=v2e-clean"}},
    {"v2e-noisy", "preset", {"sensor.preset=v2e-noisy"}},
    {"inria", "image", {"image.rules=inria"}},
    {"off again", "base", {NULL}},
};
enum { BLOCKS = sizeof blocks / sizeof blocks[0] };

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

/* The costs of all scenes so far, and how each is measured. */
typedef struct job {
    const char *name;
    bench_plan plan;
    double steps_per_s; /* 0: as many as the run takes */
    bench_cost *costs;
    size_t count;
    cJSON *header;
} job;

/* -- one scene ----------------------------------------------------------------------------------------------------------- */

static void finish_cost(const bench *b, const job *j, const bench_scene *scene, const bench_pairs *pairs, bench_cost *cost) {
    const double renders = cost->stats.renders_full_frame_equivalent;
    cost->steps = j->steps_per_s > 0 ? round(j->steps_per_s * (scene->stop - scene->start)) : renders;
    cost->pixel_steps = cost->steps * scene->intrinsics.width * scene->intrinsics.height;
    bench_pairs_judge(pairs, cost);
    bench_say(b, "%-10s %-24s %8.3g s  x %.4g (%.4g to %.4g)  %.3g ns per pixel and step", cost->scene, cost->block,
              cost->run_time_s, cost->ratio, cost->ratio_low, cost->ratio_high, cost->ns);
}

static tides_status visit(void *user, bench *b, bench_scene *scene, tides_error *error) {
    job *j = user;
    const size_t rows = j->plan.count;
    bench_cost *grown = realloc(j->costs, (j->count + rows) * sizeof *grown);
    bench_pairs *p = calloc(rows, sizeof *p);
    tides_status status = grown && p ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    if (grown) j->costs = grown;
    bench_cost *costs = j->costs + j->count;
    for (size_t i = 0; i < rows && status == TIDES_OK; i++) bench_pairs_begin(scene, &j->plan.cases[i], &costs[i]);
    if (status == TIDES_OK) status = bench_pairs_measure(b, scene, &j->plan, p, costs, error);
    for (size_t i = 0; i < rows && status == TIDES_OK; i++, j->count++) finish_cost(b, j, scene, &p[i], &costs[i]);
    free(p);
    if (status == TIDES_OK && !bench_header_scene(j->header, scene, NULL))
        status = cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    return status;
}

static tides_status visit_world(job *j, bench *b, const char *name, tides_error *error) {
    bench_scene scene = {.scene = NULL};
    const int demo = strcmp(name, "demo") == 0;
    tides_status status = demo ? bench_make_demo(0, &scene, error) : bench_world_make(name, b->quick, &scene, error);
    if (demo) scene.stop = b->quick ? LENGTH_QUICK_S : LENGTH_S;
    if (demo) scene.image.log_eps = LOG_EPS;
    if (status == TIDES_OK) status = visit(j, b, &scene, error);
    bench_scene_free(&scene);
    return status;
}

/* -- results ------------------------------------------------------------------------------------------------------------- */

static int32_t cells_of(const void *rows, size_t index, bench_cell cells[BENCH_CELLS_MAX]) {
    const bench_cost *c = (const bench_cost *)rows + index;
    const bench_cell made[] = {
        {"scene", c->scene, 0},
        {"block", c->block, 0},
        {"group", c->group, 0},
        {"runs", NULL, c->runs},
        {"run_time_s", NULL, c->run_time_s},
        {"run_time_ratio", NULL, c->run_ratio},
        {"processor_time_s", NULL, c->processor_s},
        {"ratio", NULL, c->ratio},
        {"ratio_low", NULL, c->ratio_low},
        {"ratio_high", NULL, c->ratio_high},
        {"ns_per_pixel_step", NULL, c->ns},
        {"ns_low", NULL, c->ns_low},
        {"ns_high", NULL, c->ns_high},
        {"pixel_steps_per_s", NULL, c->pixel_steps / c->run_time_s},
        {"events_per_s", NULL, (double)c->stats.events_written / c->run_time_s},
        {"frames_per_s", NULL, c->stats.renders_full_frame_equivalent / c->run_time_s},
        {"real_time_factor", NULL, c->stats.simulated_s / c->run_time_s},
        {"events", NULL, (double)c->stats.events_written},
        {"renders", NULL, c->stats.renders_full_frame_equivalent},
        {"steps", NULL, c->steps},
        {"pixel_steps", NULL, c->pixel_steps},
        {"compare_s", NULL, c->stats.time_compare_s},
        {"error_p95_us", NULL, 1e6 * c->stats.error_p95_s},
        {"settings", c->settings, 0},
    };
    memcpy(cells, made, sizeof made);
    return sizeof made / sizeof made[0];
}

static void print_table(const job *j) {
    printf("%-10s %-24s %10s %7s %12s %7s %15s %10s %12s %11s %9s\n", "scene", "block", "run time s", "ratio", "processor s",
           "ratio", "quartiles", "ns/px step", "Mpx steps/s", "Mevents/s", "frames/s");
    for (const bench_cost *c = j->costs; c < j->costs + j->count; c++)
        printf("%-10s %-24s %10.3g %7.3f %12.3g %7.3f %7.3f %7.3f %10.3g %12.4g %11.3g %9.3g\n", c->scene, c->block,
               c->run_time_s, c->run_ratio, c->processor_s, c->ratio, c->ratio_low, c->ratio_high, c->ns,
               1e-6 * c->pixel_steps / c->run_time_s, 1e-6 * (double)c->stats.events_written / c->run_time_s,
               c->stats.renders_full_frame_equivalent / c->run_time_s);
}

/* Writes and prints what was measured, and frees it. */
static tides_status report(bench *b, job *j, tides_status status, tides_error *error) {
    const bench_table table = {j->costs, j->count, cells_of};
    if (status == TIDES_OK) status = bench_write_table(b, j->name, j->header, &table, error);
    if (status == TIDES_OK) status = bench_figure_costs(b, j->name, j->costs, j->count, error);
    if (status == TIDES_OK && !b->common->quiet && !b->common->json) print_table(j);
    cJSON_Delete(j->header);
    free(j->costs);
    return status;
}

tides_status bench_blocks(bench *b, const cli_list *scenes, tides_error *error) {
    const cli_list moving = {.items = {"fan", "trained"}, .count = b->quick ? 1 : 2};
    job j = {.name = "blocks",
             .plan = {blocks, BLOCKS, 4, 0.5, {0}},
             .steps_per_s = STEPS_PER_S,
             .header = bench_header(b, "blocks")};
    if (!j.header) return cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    tides_stepping_defaults(&j.plan.stepping);
    j.plan.stepping.mode = TIDES_STEPPING_FIXED;
    j.plan.stepping.step_s = 1 / STEPS_PER_S;
    return report(b, &j, bench_each_scene(b, scenes->count ? scenes : &moving, visit, &j, error), error);
}

tides_status bench_sensors(bench *b, const cli_list *scenes, tides_error *error) {
    /* A sensor gets no more runs after 40 s of them (0.5 s with --quick), but at least two with their reference runs. */
    job j = {.name = "sensors", .plan = {sensors, SENSORS, 40, 0.5, {0}}, .header = bench_header(b, "sensors")};
    const cli_list demo = {.items = {"demo"}, .count = 1}, *worlds = scenes->count ? scenes : &demo;
    tides_status status = TIDES_OK;
    if (!j.header) return cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    tides_stepping_defaults(&j.plan.stepping);
    for (size_t i = 0; i < worlds->count && status == TIDES_OK; i++) status = visit_world(&j, b, worlds->items[i], error);
    return report(b, &j, status, error);
}
