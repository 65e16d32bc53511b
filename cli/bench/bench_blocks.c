/* tides bench blocks: the cost of each block of the sensor and the readout, alone. A row is one line of the table below; its
 * settings are written as for --set.
 *
 * All rows take equal steps over the same scene, so that they render the same frames. Each run of a row follows a run with all
 * blocks off, and results are medians over these pairs. Costs are in processor time, which other programs hardly affect. Ratios
 * are of all threads' time. Nanoseconds are of the thread that runs the sensor and the readout, since rendering by other
 * threads would hide them; on the reference device this thread renders too. "off" is measured likewise, as the first row and as
 * the last: the distance of its ratio from 1 is the error of the others. */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STEPS_PER_S 2000.0 /* [1/s] */
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

typedef struct job {
    bench_cost *costs;
    size_t count;
    cJSON *header;
} job;

/* -- one scene ----------------------------------------------------------------------------------------------------------- */

static void begin_cost(const bench_scene *scene, const bench_case *block, bench_cost *cost) {
    bench_pairs_begin(scene, block, cost);
    cost->steps = round(STEPS_PER_S * (scene->stop - scene->start));
    cost->pixel_steps = cost->steps * scene->intrinsics.width * scene->intrinsics.height;
}

static void say_cost(const bench *b, const bench_cost *cost) {
    bench_say(b, "%-10s %-24s %8.3g s  x %.4g (%.4g to %.4g)  %.3g ns per pixel and step", cost->scene, cost->block,
              cost->run_time_s, cost->ratio, cost->ratio_low, cost->ratio_high, cost->ns);
}

static tides_status visit(void *user, bench *b, bench_scene *scene, tides_error *error) {
    job *j = user;
    bench_plan plan = {blocks, BLOCKS, 4, 0.5, {0}};
    tides_stepping_defaults(&plan.stepping);
    plan.stepping.mode = TIDES_STEPPING_FIXED;
    plan.stepping.step_s = 1 / STEPS_PER_S;
    bench_cost *grown = realloc(j->costs, (j->count + BLOCKS) * sizeof *grown);
    bench_pairs *p = calloc(BLOCKS, sizeof *p);
    tides_status status = grown && p ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    if (grown) j->costs = grown;
    bench_cost *costs = j->costs + j->count;
    for (size_t i = 0; i < BLOCKS && status == TIDES_OK; i++) begin_cost(scene, &blocks[i], &costs[i]);
    if (status == TIDES_OK) status = bench_pairs_measure(b, scene, &plan, p, costs, error);
    for (size_t i = 0; i < BLOCKS && status == TIDES_OK; i++) {
        bench_pairs_judge(&p[i], &costs[i]);
        say_cost(b, &costs[i]);
        j->count++;
    }
    free(p);
    if (status == TIDES_OK && !bench_header_scene(j->header, scene, NULL))
        status = cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
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
        {"settings", c->settings, 0},
    };
    memcpy(cells, made, sizeof made);
    return sizeof made / sizeof made[0];
}

static void print_table(const job *j) {
    printf("%-10s %-24s %10s %7s %15s %10s %12s %11s %9s\n", "scene", "block", "run time s", "ratio", "quartiles", "ns/px step",
           "Mpx steps/s", "Mevents/s", "frames/s");
    for (size_t i = 0; i < j->count; i++) {
        const bench_cost *c = &j->costs[i];
        printf("%-10s %-24s %10.3g %7.3f %7.3f %7.3f %10.3g %12.4g %11.3g %9.3g\n", c->scene, c->block, c->run_time_s, c->ratio,
               c->ratio_low, c->ratio_high, c->ns, 1e-6 * c->pixel_steps / c->run_time_s,
               1e-6 * (double)c->stats.events_written / c->run_time_s, c->stats.renders_full_frame_equivalent / c->run_time_s);
    }
}

tides_status bench_blocks(bench *b, const cli_list *scenes, tides_error *error) {
    const cli_list moving = {.items = {"fan", "trained"}, .count = b->quick ? 1 : 2};
    job j = {.header = bench_header(b, "blocks")};
    if (!j.header) return cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    tides_status status = bench_each_scene(b, scenes->count ? scenes : &moving, visit, &j, error);
    const bench_table table = {j.costs, j.count, cells_of};
    if (status == TIDES_OK) status = bench_write_table(b, "blocks", j.header, &table, error);
    if (status == TIDES_OK) status = bench_figure_costs(b, j.costs, j.count, error);
    if (status == TIDES_OK && !b->common->quiet && !b->common->json) print_table(&j);
    cJSON_Delete(j.header);
    free(j.costs);
    return status;
}
