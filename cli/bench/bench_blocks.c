/* tides bench blocks: what each block of the sensor and the readout costs, alone. A row is
 * one line of the table below; its settings are what a user would give with --set.
 *
 * All rows take the same equal steps over the same scene, so that they render the same frames. Each run of a row follows a run
 * with all blocks off, and the figures are medians over these pairs. Costs are in processor time, which other programs hardly
 * lengthen: the ratio in that of all threads, the nanoseconds in that of the thread which runs the sensor and the readout, as
 * rendering, which is done by others but on the reference device, would drown them. "off" is measured so too, as the first row
 * and as the last: how far its ratio is from 1 is how good the others are. */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STEPS_PER_S 2000.0 /* [1/s] */
/* Pairs of runs for each row; no more once they took so long [s], but two. */
enum { PAIRS = 9, PAIRS_QUICK = 3, PAIRS_LEAST = 2 };
#define LONG_S 4.0
#define LONG_QUICK_S 0.5

enum { SETTINGS_MAX = 4 };
typedef struct block_case {
    const char *name, *group;
    const char *settings[SETTINGS_MAX];
} block_case;

/* Sizes where the block acts on what fires here: mismatch and leak as in v2e, rates and periods as in its noisy preset. */
static const block_case blocks[] = {
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
    {"davis240", "preset", {"sensor.preset=davis240"}},
    {"davis346", "preset", {"sensor.preset=davis346"}},
    {"gen3", "preset", {"sensor.preset=gen3"}},
    {"gen4", "preset", {"sensor.preset=gen4"}},
    {"imx636", "preset", {"sensor.preset=imx636"}},
    {"v2e-clean", "preset", {"sensor.preset=v2e-clean"}},
    {"v2e-noisy", "preset", {"sensor.preset=v2e-noisy"}},
    {"inria", "image", {"image.rules=inria"}},
    {"off again", "base", {NULL}},
};
enum { BLOCKS = sizeof blocks / sizeof blocks[0] };

/* One run [s]. */
typedef struct timed {
    double run, all_threads, own_thread;
} timed;

/* A row's runs, and those without its block. */
typedef struct pairs {
    timed with[PAIRS], without[PAIRS];
} pairs;

typedef struct job {
    bench_cost *costs;
    size_t count;
    cJSON *header;
} job;

/* -- one row ------------------------------------------------------------------------------------------------------------- */

/* The scene with a block's settings. */
static tides_status set_block(const block_case *block, bench_scene *scene, int32_t *rules, tides_error *error) {
    static const char least[] = "{\"scene\": {\"file\": \"-\"}, \"camera\": {\"file\": \"-\"}}";
    size_t count = 0;
    while (count < SETTINGS_MAX && block->settings[count]) count++;
    tides_run *run = NULL;
    tides_run_values values;
    tides_status status = tides_run_parse(least, "", block->settings, count, &run, error);
    if (status != TIDES_OK) return status;
    tides_run_get(run, &values);
    scene->sensor = values.sensor;
    scene->readout = values.readout;
    *rules = values.image.rules;
    tides_run_destroy(run);
    return TIDES_OK;
}

static tides_status simulate(bench *b, const bench_scene *scene, const block_case *block, timed *took, bench_row *row,
                             tides_error *error) {
    bench_scene with = *scene;
    int32_t rules;
    tides_stepping stepping;
    tides_stepping_defaults(&stepping);
    stepping.mode = TIDES_STEPPING_FIXED;
    stepping.step_s = 1 / STEPS_PER_S;
    memset(row, 0, sizeof *row);
    tides_status status = set_block(block, &with, &rules, error);
    if (status == TIDES_OK) status = bench_simulate(b, &with, rules, &with.sensor, &stepping, NULL, row, error);
    *took = (timed){row->run_time_s, row->all_threads_s, row->own_thread_s};
    return status;
}

static tides_status measure_pair(bench *b, const bench_scene *scene, const block_case *block, pairs *p, bench_cost *cost,
                                 tides_error *error) {
    bench_row row;
    tides_status status = simulate(b, scene, &blocks[0], &p->without[cost->runs], &row, error);
    if (status == TIDES_OK) status = simulate(b, scene, block, &p->with[cost->runs], &row, error);
    if (status != TIDES_OK) return status;
    cost->stats = row.stats;
    cost->spent_s += p->with[cost->runs].run + p->without[cost->runs].run;
    cost->runs++;
    return TIDES_OK;
}

static void judge_pairs(const pairs *p, bench_cost *cost) {
    double run[PAIRS] = {0}, processor[PAIRS] = {0}, ratio[PAIRS] = {0}, ns[PAIRS] = {0}, low, high;
    for (int32_t i = 0; i < cost->runs; i++) {
        run[i] = p->with[i].run;
        processor[i] = p->with[i].all_threads;
        ratio[i] = p->with[i].all_threads / p->without[i].all_threads;
        ns[i] = 1e9 * (p->with[i].own_thread - p->without[i].own_thread) / cost->pixel_steps;
    }
    bench_quartiles(ratio, cost->runs, &cost->ratio_low, &cost->ratio, &cost->ratio_high);
    bench_quartiles(ns, cost->runs, &cost->ns_low, &cost->ns, &cost->ns_high);
    bench_quartiles(processor, cost->runs, &low, &cost->processor_s, &high);
    bench_quartiles(run, cost->runs, &low, &cost->run_time_s, &high);
}

/* -- one scene ----------------------------------------------------------------------------------------------------------- */

static void begin_cost(const bench_scene *scene, const block_case *block, bench_cost *cost) {
    memset(cost, 0, sizeof *cost);
    snprintf(cost->scene, sizeof cost->scene, "%s", scene->name);
    cost->block = block->name;
    cost->group = block->group;
    for (size_t i = 0, used = 0; i < SETTINGS_MAX && block->settings[i] && used < sizeof cost->settings; i++)
        used += (size_t)snprintf(cost->settings + used, sizeof cost->settings - used, "%s%s", i ? " " : "", block->settings[i]);
    cost->steps = round(STEPS_PER_S * (scene->stop - scene->start));
    cost->pixel_steps = cost->steps * scene->intrinsics.width * scene->intrinsics.height;
}

static void say_cost(const bench *b, const bench_cost *cost) {
    bench_say(b, "%-10s %-24s %8.3g s  x %.4g (%.4g to %.4g)  %.3g ns per pixel and step", cost->scene, cost->block,
              cost->run_time_s, cost->ratio, cost->ratio_low, cost->ratio_high, cost->ns);
}

static tides_status visit(void *user, bench *b, bench_scene *scene, tides_error *error) {
    job *j = user;
    const int32_t rounds = b->quick ? PAIRS_QUICK : PAIRS;
    const double enough_s = b->quick ? LONG_QUICK_S : LONG_S;
    bench_cost *grown = realloc(j->costs, (j->count + BLOCKS) * sizeof *grown);
    pairs *p = calloc(BLOCKS, sizeof *p);
    tides_status status = grown && p ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    if (grown) j->costs = grown;
    bench_cost *costs = j->costs + j->count;
    for (size_t i = 0; i < BLOCKS && status == TIDES_OK; i++) begin_cost(scene, &blocks[i], &costs[i]);
    for (int32_t round = 0; round < rounds; round++)
        for (size_t i = 0; i < BLOCKS && status == TIDES_OK; i++) {
            if (round >= PAIRS_LEAST && costs[i].spent_s > enough_s) continue;
            status = measure_pair(b, scene, &blocks[i], &p[i], &costs[i], error);
        }
    for (size_t i = 0; i < BLOCKS && status == TIDES_OK; i++) {
        judge_pairs(&p[i], &costs[i]);
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
