/* The main function of a benchmark program, whose benchmarks are in a table. It parses the command line, runs the benchmarks
 * that were chosen, and writes a page of all results. `tides bench` and the tests' own program (tests/bench/own) use it. */
#include "bench_main.h"
#include "bench_page.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const bench_entry everything = {"all", "", NULL, 0, NULL, 0};

static const bench_entry *find_benchmark(const bench_list *all, const char *name) {
    for (size_t i = 0; i < all->count; i++)
        if (strcmp(all->entry[i].name, name) == 0) return &all->entry[i];
    return strcmp(name, everything.name) == 0 ? &everything : NULL;
}

static int unknown_benchmark(const cli_command *command, const bench_list *all, const char *name) {
    const char *names[BENCH_ENTRIES + 2] = {NULL};
    char known[400] = "";
    for (size_t i = 0; i < all->count; i++) {
        names[i] = all->entry[i].name;
        snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i ? ", " : "", names[i]);
    }
    names[all->count] = everything.name;
    const char *nearest = tides_nearest_name(name, names);
    if (nearest) return cli_usage(command, "no benchmark is called %s; did you mean %s?", name, nearest);
    return cli_usage(command, "no benchmark is called %s; there are %s and all", name, known);
}

/* -- checks of --scene and --row ------------------------------------------------------------------------------------------ */

static int32_t is_one_of(const char *name, const char *const *names) {
    for (; *names; names++)
        if (strcmp(*names, name) == 0) return 1;
    return 0;
}

/* The name of a scene must be that of a built-in one, or the path of a file that exists. */
static int check_scene(const cli_command *command, const bench_entry *of, const char *name) {
    struct stat found;
    if (is_one_of(name, of->names()) || stat(name, &found) == 0) return CLI_GO;
    const char *nearest = tides_nearest_name(name, of->names());
    if (nearest) return cli_usage(command, "--scene %s: neither a scene nor a file; did you mean %s?", name, nearest);
    return cli_usage(command, "--scene %s: neither a scene nor a file", name);
}

static int check_number(const cli_command *command, const bench_entry *of, const char *text) {
    char *end;
    const long number = strtol(text, &end, 10);
    if (end != text && !*end && number >= 0 && number < of->numbered) return CLI_GO;
    return cli_usage(command, "--row %s: rows of %s are 0 to %d", text, of->name, (int)of->numbered - 1);
}

static int check_row(const cli_command *command, const bench_entry *of, const char *name) {
    if (of->numbered) return check_number(command, of, name);
    if (is_one_of(name, of->names())) return CLI_GO;
    const char *nearest = tides_nearest_name(name, of->names());
    if (nearest) return cli_usage(command, "--row %s: there is no such row; did you mean %s?", name, nearest);
    return cli_usage(command,
                     "--row %s: there is no such row; a misspelt one gets the nearest name, and %s.csv of a run has all", name,
                     of->name);
}

/* Checks the names of --scene and --row. A benchmark that opens devices by itself (own_devices) has rows; all others have
 * scenes. */
static int check_names(const cli_command *command, const bench_entry *of, const cli_list *scenes, const cli_list *rows) {
    int code = CLI_GO;
    if (of == &everything && scenes->count + rows->count) return cli_usage(command, "all takes neither --scene nor --row");
    if (of->own_devices && scenes->count) return cli_usage(command, "--scene: %s has rows; --row chooses one", of->name);
    if (!of->own_devices && !of->numbered && rows->count)
        return cli_usage(command, "--row: %s has no rows; --scene chooses a scene", of->name);
    for (size_t i = 0; i < scenes->count && code == CLI_GO; i++) code = check_scene(command, of, scenes->items[i]);
    for (size_t i = 0; i < rows->count && code == CLI_GO; i++) code = check_row(command, of, rows->items[i]);
    return code;
}

/* -- runs ----------------------------------------------------------------------------------------------------------------- */

/* Runs one benchmark, then writes the page of all results in its folder, those of earlier runs included. */
static tides_status run(bench *b, const bench_list *all, const bench_entry *of, const cli_list *names, tides_error *error) {
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
    return status == TIDES_OK ? bench_page(b, all, error) : status;
}

/* Runs all benchmarks. Benchmarks with own_devices come first, because some of them fork: a process that forks must have no
 * threads, and an open device has threads. */
static tides_status run_all(bench *b, const bench_list *all, tides_error *error) {
    static const cli_list none = {.count = 0};
    tides_status status = TIDES_OK;
    for (int32_t own = 1; own >= 0; own--)
        for (size_t i = 0; i < all->count && status == TIDES_OK; i++) {
            if (all->entry[i].own_devices != own) continue;
            bench_say(b, "%s", all->entry[i].name);
            b->float_truth = 0;
            status = run(b, all, &all->entry[i], &none, error);
        }
    return status;
}

int bench_main(const cli_command *command, const bench_list *all, int argc, char **argv) {
    cli_common common;
    const char *name = NULL, *directory = NULL, *theme = NULL, *pictures = NULL;
    canvas_style style = {0};
    int32_t quick = 0;
    cli_list scenes = {.count = 0}, rows = {.count = 0};
    const cli_option options[] = {
        {"--output", 'o', "DIR", "where results go (tides-bench)", NULL, &directory, NULL},
        {"--quick", 0, NULL, "small scenes and few settings: a look, not a measurement", &quick, NULL, NULL},
        {"--scene", 0, "NAME", "only this scene, or a trained .ply file; may be repeated", NULL, NULL, &scenes},
        {"--row", 0, "NAME", "of benchmarks that have rows: only this one (of calibrate: a sensor, 0 to 39); may be repeated",
         NULL, NULL, &rows},
        {"--theme", 0, "THEME", CANVAS_THEME_HELP, NULL, &theme, NULL},
        {"--pictures", 0, "FORMAT", CANVAS_PICTURES_HELP, NULL, &pictures, NULL},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &name);
    if (code != CLI_GO) return code;
    const bench_entry *of = find_benchmark(all, name);
    if (!of) return unknown_benchmark(command, all, name);
    if ((code = check_names(command, of, &scenes, &rows)) != CLI_GO) return code;
    if ((code = canvas_parse_theme(command, theme, &style)) != CLI_GO) return code;
    if ((code = canvas_parse_pictures(command, pictures, &style)) != CLI_GO) return code;

    tides_error error = {TIDES_OK, ""};
    bench b = {.common = &common,
               .directory = directory ? directory : "tides-bench",
               .style = style,
               .quick = quick,
               .rows = &rows,
               .progress = {.quiet = 1}};
    cli_catch_interrupt();
    const tides_status status =
        of == &everything ? run_all(&b, all, &error) : run(&b, all, of, of->own_devices ? &rows : &scenes, &error);
    if (status == TIDES_CANCELLED && of == &everything)
        return cli_failed("stopped on request; %s has the benchmarks that were finished", b.directory);
    if (status == TIDES_CANCELLED) return cli_failed("stopped on request; nothing was written");
    if (status != TIDES_OK) return cli_fail(&error);
    if (b.failed && of == &everything) return cli_failed("%d rows fail; the tables in %s say why", (int)b.failed, b.directory);
    if (b.failed) return cli_failed("%d rows fail; %s/%s.json says why", (int)b.failed, b.directory, of->name);
    return CLI_OK;
}
