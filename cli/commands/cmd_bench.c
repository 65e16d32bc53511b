/* tides bench: what accuracy costs, what the parts of the sensor do, and what breaks. */
#include "bench_stability.h"
#include "bench_worlds.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* One that opens devices by itself goes through rows, the others through scenes: built-in ones, or files. */
typedef struct benchmark {
    const char *name;
    tides_status (*run)(bench *b, const cli_list *names, tides_error *error);
    int32_t own_devices;
    const char *const *(*scenes)(void);
} benchmark;
static const benchmark benchmarks[] = {{"accuracy", bench_accuracy, 0, bench_scene_names},
                                       {"ablation", bench_ablation, 0, bench_scene_names},
                                       {"blocks", bench_blocks, 0, bench_scene_names},
                                       {"image", bench_image, 0, bench_scene_names},
                                       {"stability", bench_stability, 1, NULL},
                                       {"throughput", bench_throughput, 0, bench_world_names}};
enum { BENCHMARKS = sizeof benchmarks / sizeof benchmarks[0] };

static const benchmark *find_benchmark(const char *name) {
    for (size_t i = 0; i < BENCHMARKS; i++)
        if (strcmp(benchmarks[i].name, name) == 0) return &benchmarks[i];
    return NULL;
}

static int unknown_benchmark(const cli_command *command, const char *name) {
    const char *names[BENCHMARKS + 1] = {NULL};
    for (size_t i = 0; i < BENCHMARKS; i++) names[i] = benchmarks[i].name;
    const char *nearest = tides_nearest_name(name, names);
    if (nearest) return cli_usage(command, "no benchmark is called %s; did you mean %s?", name, nearest);
    return cli_usage(command,
                     "no benchmark is called %s; there are accuracy, ablation, blocks, image, stability and throughput", name);
}

/* A built-in scene, or a file. */
static int check_scene(const cli_command *command, const benchmark *of, const char *name) {
    struct stat found;
    for (const char *const *known = of->scenes(); *known; known++)
        if (strcmp(*known, name) == 0) return CLI_GO;
    if (stat(name, &found) == 0) return CLI_GO;
    const char *nearest = tides_nearest_name(name, of->scenes());
    if (nearest) return cli_usage(command, "--scene %s: neither a scene nor a file; did you mean %s?", name, nearest);
    return cli_usage(command, "--scene %s: neither a scene nor a file", name);
}

static int check_row(const cli_command *command, const char *name) {
    if (stability_find(name)) return CLI_GO;
    const char **names = stability_names();
    const char *nearest = names ? tides_nearest_name(name, names) : NULL;
    const int code = nearest ? cli_usage(command, "--row %s: there is no such row; did you mean %s?", name, nearest)
                             : cli_usage(command,
                                         "--row %s: there is no such row; a misspelt one gets the nearest name, and "
                                         "stability.csv of a run has all",
                                         name);
    free(names);
    return code;
}

/* Scenes and rows, each of the benchmarks that have them. */
static int check_names(const cli_command *command, const benchmark *of, const cli_list *scenes, const cli_list *rows) {
    int code = CLI_GO;
    if (of->own_devices && scenes->count) return cli_usage(command, "--scene: %s has rows; --row chooses one", of->name);
    if (!of->own_devices && rows->count) return cli_usage(command, "--row: only stability has rows; --scene chooses a scene");
    for (size_t i = 0; i < scenes->count && code == CLI_GO; i++) code = check_scene(command, of, scenes->items[i]);
    for (size_t i = 0; i < rows->count && code == CLI_GO; i++) code = check_row(command, rows->items[i]);
    return code;
}

static tides_status run(bench *b, const benchmark *of, const cli_list *names, tides_error *error) {
    tides_status status = cli_make_directory(b->directory, error);
    if (status == TIDES_OK && !of->own_devices) status = tides_device_open(b->common->device, &b->device, error);
    if (status != TIDES_OK) return status;
    if (b->device) {
        tides_device_describe(b->device, &b->info);
        cli_note(b->common, "device %s (%s)", b->info.name, b->info.platform);
    }
    cli_catch_interrupt();
    status = of->run(b, names, error);
    tides_device_close(b->device);
    return status;
}

int cmd_bench(const cli_command *command, int argc, char **argv) {
    cli_common common;
    const char *name = NULL, *directory = NULL;
    int32_t quick = 0;
    cli_list scenes = {.count = 0}, rows = {.count = 0};
    const cli_option options[] = {
        {"--output", 'o', "DIR", "where results go (tides-bench)", NULL, &directory, NULL},
        {"--quick", 0, NULL, "small scenes and few settings: a look, not a measurement", &quick, NULL, NULL},
        {"--scene", 0, "NAME", "only this scene, or a trained .ply file; may be repeated", NULL, NULL, &scenes},
        {"--row", 0, "NAME", "of stability: only this row; may be repeated", NULL, NULL, &rows},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &name);
    if (code != CLI_GO) return code;
    const benchmark *of = find_benchmark(name);
    if (!of) return unknown_benchmark(command, name);
    if ((code = check_names(command, of, &scenes, &rows)) != CLI_GO) return code;

    tides_error error = {TIDES_OK, ""};
    bench b = {.common = &common, .directory = directory ? directory : "tides-bench", .quick = quick, .progress = {.quiet = 1}};
    const tides_status status = run(&b, of, of->own_devices ? &rows : &scenes, &error);
    if (status == TIDES_CANCELLED) return cli_failed("stopped on request; nothing was written");
    if (status != TIDES_OK) return cli_fail(&error);
    if (b.failed) return cli_failed("%d rows fail; %s/%s.json says why", (int)b.failed, b.directory, of->name);
    return CLI_OK;
}
