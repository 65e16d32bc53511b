/* tides bench: what accuracy costs, what the parts of the sensor do, how fast it all is, what breaks, and that
 * nothing else changes an event. */
#include "bench_determinism.h"
#include "bench_page.h"
#include "bench_scaling.h"
#include "bench_stability.h"
#include "bench_worlds.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* What --scene or --row chooses from. */
typedef const char *const *(*name_list)(void);

/* One that opens devices by itself goes through rows, the others through scenes: built-in ones, or files. */
typedef struct benchmark {
    const char *name;
    tides_status (*run)(bench *b, const cli_list *names, tides_error *error);
    int32_t own_devices;
    name_list names; /* NULL: stability_names, which the caller frees */
} benchmark;
static const benchmark benchmarks[] = {
    {"accuracy", bench_accuracy, 0, bench_scene_names},     {"ablation", bench_ablation, 0, bench_scene_names},
    {"blocks", bench_blocks, 0, bench_scene_names},         {"determinism", bench_determinism, 1, determinism_names},
    {"image", bench_image, 0, bench_scene_names},           {"live", bench_live, 0, bench_world_names},
    {"scaling", bench_scaling, 1, scaling_names},           {"stability", bench_stability, 1, NULL},
    {"throughput", bench_throughput, 0, bench_world_names},
};
enum { BENCHMARKS = sizeof benchmarks / sizeof benchmarks[0] };
static const benchmark everything = {"all", NULL, 0, NULL};

static const benchmark *find_benchmark(const char *name) {
    for (size_t i = 0; i < BENCHMARKS; i++)
        if (strcmp(benchmarks[i].name, name) == 0) return &benchmarks[i];
    return strcmp(name, everything.name) == 0 ? &everything : NULL;
}

static int unknown_benchmark(const cli_command *command, const char *name) {
    const char *names[BENCHMARKS + 2] = {NULL};
    for (size_t i = 0; i < BENCHMARKS; i++) names[i] = benchmarks[i].name;
    names[BENCHMARKS] = everything.name;
    const char *nearest = tides_nearest_name(name, names);
    if (nearest) return cli_usage(command, "no benchmark is called %s; did you mean %s?", name, nearest);
    return cli_usage(command,
                     "no benchmark is called %s; there are accuracy, ablation, blocks, determinism, image, live, scaling, "
                     "stability, throughput and all",
                     name);
}

/* -- what is chosen ------------------------------------------------------------------------------------------------------- */

static int32_t is_one_of(const char *name, const char *const *names) {
    for (; *names; names++)
        if (strcmp(*names, name) == 0) return 1;
    return 0;
}

/* A built-in scene, or a file. */
static int check_scene(const cli_command *command, const benchmark *of, const char *name) {
    struct stat found;
    if (is_one_of(name, of->names()) || stat(name, &found) == 0) return CLI_GO;
    const char *nearest = tides_nearest_name(name, of->names());
    if (nearest) return cli_usage(command, "--scene %s: neither a scene nor a file; did you mean %s?", name, nearest);
    return cli_usage(command, "--scene %s: neither a scene nor a file", name);
}

static int check_row(const cli_command *command, const benchmark *of, const char *name) {
    if (of->names ? is_one_of(name, of->names()) : stability_find(name) != NULL) return CLI_GO;
    const char **owned = of->names ? NULL : stability_names();
    const char *const *names = of->names ? of->names() : (const char *const *)owned;
    const char *nearest = names ? tides_nearest_name(name, names) : NULL;
    const int code = nearest ? cli_usage(command, "--row %s: there is no such row; did you mean %s?", name, nearest)
                             : cli_usage(command,
                                         "--row %s: there is no such row; a misspelt one gets the nearest name, and "
                                         "%s.csv of a run has all",
                                         name, of->name);
    free(owned);
    return code;
}

/* Scenes and rows, each of the benchmarks that have them. */
static int check_names(const cli_command *command, const benchmark *of, const cli_list *scenes, const cli_list *rows) {
    int code = CLI_GO;
    if (of == &everything && scenes->count + rows->count) return cli_usage(command, "all takes neither --scene nor --row");
    if (of->own_devices && scenes->count) return cli_usage(command, "--scene: %s has rows; --row chooses one", of->name);
    if (!of->own_devices && rows->count)
        return cli_usage(command, "--row: only determinism, scaling and stability have rows; --scene chooses a scene");
    for (size_t i = 0; i < scenes->count && code == CLI_GO; i++) code = check_scene(command, of, scenes->items[i]);
    for (size_t i = 0; i < rows->count && code == CLI_GO; i++) code = check_row(command, of, rows->items[i]);
    return code;
}

/* -- runs ----------------------------------------------------------------------------------------------------------------- */

/* A benchmark, and the page of all that its folder has then. */
static tides_status run(bench *b, const benchmark *of, const cli_list *names, tides_error *error) {
    const char *known[BENCHMARKS + 1] = {NULL};
    for (size_t i = 0; i < BENCHMARKS; i++) known[i] = benchmarks[i].name;
    tides_status status = cli_make_directory(b->directory, error);
    if (status == TIDES_OK && !of->own_devices) status = tides_device_open(b->common->device, &b->device, error);
    if (status != TIDES_OK) return status;
    if (b->device) {
        tides_device_describe(b->device, &b->info);
        cli_note(b->common, "device %s (%s)", b->info.name, b->info.platform);
    }
    status = of->run(b, names, error);
    tides_device_close(b->device);
    b->device = NULL;
    return status == TIDES_OK ? bench_page(b, known, error) : status;
}

/* Those with processes of their own first: nothing that has threads may be open in the process that starts them. */
static tides_status run_all(bench *b, tides_error *error) {
    static const cli_list none = {.count = 0};
    tides_status status = TIDES_OK;
    for (int32_t own = 1; own >= 0; own--)
        for (size_t i = 0; i < BENCHMARKS && status == TIDES_OK; i++) {
            if (benchmarks[i].own_devices != own) continue;
            bench_say(b, "%s", benchmarks[i].name);
            b->float_truth = 0;
            status = run(b, &benchmarks[i], &none, error);
        }
    return status;
}

int cmd_bench(const cli_command *command, int argc, char **argv) {
    cli_common common;
    const char *name = NULL, *directory = NULL, *theme = NULL, *pictures = NULL;
    canvas_style style = {0};
    int32_t quick = 0;
    cli_list scenes = {.count = 0}, rows = {.count = 0};
    const cli_option options[] = {
        {"--output", 'o', "DIR", "where results go (tides-bench)", NULL, &directory, NULL},
        {"--quick", 0, NULL, "small scenes and few settings: a look, not a measurement", &quick, NULL, NULL},
        {"--scene", 0, "NAME", "only this scene, or a trained .ply file; may be repeated", NULL, NULL, &scenes},
        {"--row", 0, "NAME", "of determinism, scaling and stability: only this row; may be repeated", NULL, NULL, &rows},
        {"--theme", 0, "THEME", CANVAS_THEME_HELP, NULL, &theme, NULL},
        {"--pictures", 0, "FORMAT", CANVAS_PICTURES_HELP, NULL, &pictures, NULL},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &name);
    if (code != CLI_GO) return code;
    const benchmark *of = find_benchmark(name);
    if (!of) return unknown_benchmark(command, name);
    if ((code = check_names(command, of, &scenes, &rows)) != CLI_GO) return code;
    if ((code = canvas_parse_theme(command, theme, &style)) != CLI_GO) return code;
    if ((code = canvas_parse_pictures(command, pictures, &style)) != CLI_GO) return code;

    tides_error error = {TIDES_OK, ""};
    bench b = {.common = &common,
               .directory = directory ? directory : "tides-bench",
               .style = style,
               .quick = quick,
               .progress = {.quiet = 1}};
    cli_catch_interrupt();
    const tides_status status =
        of == &everything ? run_all(&b, &error) : run(&b, of, of->own_devices ? &rows : &scenes, &error);
    if (status == TIDES_CANCELLED) return cli_failed("stopped on request; nothing was written");
    if (status != TIDES_OK) return cli_fail(&error);
    if (b.failed && of == &everything)
        return cli_failed("%d rows fail; %s/stability.json and determinism.json say why", (int)b.failed, b.directory);
    if (b.failed) return cli_failed("%d rows fail; %s/%s.json says why", (int)b.failed, b.directory, of->name);
    return CLI_OK;
}
