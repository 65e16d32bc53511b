/* tides bench: what accuracy costs, and what the parts of the sensor do. */
#include "bench.h"

#include <string.h>
#include <sys/stat.h>

typedef tides_status (*benchmark)(bench *b, const cli_list *scenes, tides_error *error);

static const struct {
    const char *name;
    benchmark run;
} benchmarks[] = {{"accuracy", bench_accuracy},
                  {"ablation", bench_ablation},
                  {"image", bench_image},
                  {"throughput", bench_throughput}};
enum { BENCHMARKS = sizeof benchmarks / sizeof benchmarks[0] };

static benchmark find_benchmark(const char *name) {
    for (size_t i = 0; i < BENCHMARKS; i++)
        if (strcmp(benchmarks[i].name, name) == 0) return benchmarks[i].run;
    return NULL;
}

static int unknown_benchmark(const cli_command *command, const char *name) {
    const char *names[BENCHMARKS + 1] = {NULL};
    for (size_t i = 0; i < BENCHMARKS; i++) names[i] = benchmarks[i].name;
    const char *nearest = cli_nearest(name, names);
    if (nearest) return cli_usage(command, "no benchmark is called %s; did you mean %s?", name, nearest);
    return cli_usage(command, "no benchmark is called %s; there are accuracy, ablation, image and throughput", name);
}

/* A built-in scene, or a file. */
static int check_scene(const cli_command *command, const char *name) {
    struct stat found;
    for (const char *const *known = bench_scene_names(); *known; known++)
        if (strcmp(*known, name) == 0) return CLI_GO;
    if (stat(name, &found) == 0) return CLI_GO;
    const char *nearest = cli_nearest(name, bench_scene_names());
    if (nearest) return cli_usage(command, "--scene %s: neither a scene nor a file; did you mean %s?", name, nearest);
    return cli_usage(command, "--scene %s: neither a scene nor a file", name);
}

int cmd_bench(const cli_command *command, int argc, char **argv) {
    cli_common common;
    const char *name = NULL, *directory = NULL;
    int32_t quick = 0;
    cli_list scenes = {.count = 0};
    const cli_option options[] = {
        {"--output", 'o', "DIR", "where results go (tides-bench)", NULL, &directory, NULL},
        {"--quick", 0, NULL, "small scenes and few settings: a look, not a measurement", &quick, NULL, NULL},
        {"--scene", 0, "NAME", "only this scene, or a trained .ply file; may be repeated", NULL, NULL, &scenes},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &name);
    if (code != CLI_GO) return code;
    const benchmark run = find_benchmark(name);
    if (!run) return unknown_benchmark(command, name);
    for (size_t i = 0; i < scenes.count; i++)
        if ((code = check_scene(command, scenes.items[i])) != CLI_GO) return code;

    tides_error error = {TIDES_OK, ""};
    bench b = {.common = &common, .directory = directory ? directory : "tides-bench", .quick = quick, .progress = {.quiet = 1}};
    tides_status status = cli_make_directory(b.directory, &error);
    if (status == TIDES_OK) status = tides_device_open(common.device, &b.device, &error);
    if (status == TIDES_OK) {
        tides_device_describe(b.device, &b.info);
        cli_note(&common, "device %s (%s)", b.info.name, b.info.platform);
        cli_catch_interrupt();
        status = run(&b, &scenes, &error);
    }
    tides_device_close(b.device);
    if (status == TIDES_CANCELLED) return cli_failed("stopped on request; nothing was written");
    return status == TIDES_OK ? CLI_OK : cli_fail(&error);
}
