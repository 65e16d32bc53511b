/* tides scene: makes a scene file, and on request the camera path and run file that go with it. */
#include "scene_run.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The texts of the options, as given. */
typedef struct scene_texts {
    const char *output, *run, *count, *gaussians, *duration, *speed, *seed, *size;
} scene_texts;

/* -- options ------------------------------------------------------------------------------------------------------------ */

/* Parses a whole number of at least `least`; CLI_GO or CLI_USAGE. */
static int whole_number(const cli_command *command, const char *option, const char *text, double least, double *number) {
    const int code = cli_number(command, option, text, number);
    if (code != CLI_GO) return code;
    if (*number >= least && *number <= 2e9 && *number == (double)(int64_t)*number) return CLI_GO;
    return cli_usage(command, "%s %s: must be a whole number from %.0f to 2000000000", option, text, least);
}

static int seed_number(const cli_command *command, const char *text, uint64_t *seed) {
    char *end = NULL;
    errno = 0;
    *seed = strtoull(text, &end, 10);
    if (errno || end == text || *end || text[0] < '0' || text[0] > '9')
        return cli_usage(command, "--seed %s: must be a whole number from 0 to 2^64 - 1", text);
    return CLI_GO;
}

static int image_size(const cli_command *command, const char *text, tides_generate_options *options) {
    char rest;
    int width, height;
    if (sscanf(text, "%5dx%5d%c", &width, &height, &rest) != 2 || width < 1 || height < 1)
        return cli_usage(command, "--size %s: must be WIDTHxHEIGHT in pixels, as 346x260", text);
    options->width = width;
    options->height = height;
    return CLI_GO;
}

static int positive(const cli_command *command, const char *option, const char *text, double *number) {
    const int code = cli_number(command, option, text, number);
    if (code != CLI_GO) return code;
    return *number > 0 ? CLI_GO : cli_usage(command, "%s %s: must be above 0", option, text);
}

static int read_options(const cli_command *command, const scene_texts *texts, tides_generate_options *options) {
    double count = 0, gaussians = 0;
    int code = CLI_GO;
    tides_generate_options_defaults(options);
    if (texts->count) code = whole_number(command, "--count", texts->count, 1, &count);
    if (code == CLI_GO && texts->gaussians) code = whole_number(command, "--gaussians", texts->gaussians, 1, &gaussians);
    if (code == CLI_GO && texts->duration) code = positive(command, "--duration", texts->duration, &options->duration_s);
    if (code == CLI_GO && texts->speed) code = positive(command, "--speed", texts->speed, &options->speed);
    if (code == CLI_GO && texts->seed) code = seed_number(command, texts->seed, &options->seed);
    if (code == CLI_GO && texts->size) code = image_size(command, texts->size, options);
    options->count = (int32_t)count;
    options->gaussians = (int64_t)gaussians;
    return code;
}

/* -- list ----------------------------------------------------------------------------------------------------------------- */

static cJSON *kind_json(const tides_generator *g) {
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "name", g->name);
    cJSON_AddStringToObject(json, "sentence", g->sentence);
    if (g->counted) cJSON_AddStringToObject(json, "counted", g->counted);
    if (g->counted) cJSON_AddNumberToObject(json, "count", g->count);
    if (g->counted) cJSON_AddNumberToObject(json, "count_most", g->count_most);
    if (g->gaussians) cJSON_AddNumberToObject(json, "gaussians", (double)g->gaussians);
    cJSON_AddNumberToObject(json, "duration_s", g->duration_s);
    return json;
}

static void print_kinds(void) {
    size_t kinds;
    const tides_generator *g = tides_generators(&kinds);
    for (size_t i = 0; i < kinds; i++, g++) {
        printf("  %-10s %s", g->name, g->sentence);
        if (g->counted) printf(" [%d %s]", (int)g->count, g->counted);
        putchar('\n');
    }
}

static int list_kinds(const cli_common *common) {
    if (!common->json) {
        if (!common->quiet) print_kinds();
        return CLI_OK;
    }
    size_t kinds;
    const tides_generator *g = tides_generators(&kinds);
    cJSON *json = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(json, "kinds");
    for (size_t i = 0; i < kinds; i++) cJSON_AddItemToArray(list, kind_json(&g[i]));
    return cli_print_facts(json, 1);
}

/* -- files ---------------------------------------------------------------------------------------------------------------- */

/* The name of `file` for the run file `run`, whose paths are relative to its own folder: without a folder if both are in one,
 * unchanged where that means the same, else absolute. NULL: out of memory. The caller frees it. */
static char *name_for_run(const char *file, const char *run) {
    const char *file_slash = strrchr(file, '/'), *run_slash = strrchr(run, '/');
    const size_t file_folder = file_slash ? (size_t)(file_slash - file) + 1 : 0,
                 run_folder = run_slash ? (size_t)(run_slash - run) + 1 : 0;
    const int32_t together = file_folder == run_folder && memcmp(file, run, file_folder) == 0;
    char here[4096] = "";
    if (together)
        file += file_folder;
    else if (file[0] != '/' && run_folder > 0 && !getcwd(here, sizeof here))
        return NULL;
    const size_t room = strlen(here) + strlen(file) + 2;
    char *name = malloc(room);
    if (name) snprintf(name, room, "%s%s%s", here, here[0] ? "/" : "", file);
    return name;
}

/* The name of a camera file: "fan.json" gives "fan-camera.json" in the same folder. */
static char *camera_name(const char *run) {
    const size_t length = strlen(run), stem = length > 5 && strcmp(run + length - 5, ".json") == 0 ? length - 5 : length;
    char *name = malloc(stem + sizeof "-camera.json");
    if (name) snprintf(name, stem + sizeof "-camera.json", "%.*s-camera.json", (int)stem, run);
    return name;
}

static tides_status write_run(const scene_texts *texts, const tides_world *world, tides_error *error) {
    char *camera = camera_name(texts->run), *scene = name_for_run(texts->output, texts->run);
    tides_status status = TIDES_NO_MEMORY;
    if (!camera || !scene) {
        cli_error(error, status, "%s: its files can't be named: out of memory, or too deep a folder", texts->run);
        goto done;
    }
    status = tides_path_save(camera, world->camera, &world->intrinsics, error);
    if (status != TIDES_OK) goto done;
    const char *slash = strrchr(camera, '/');
    const scene_run run = {scene, slash ? slash + 1 : camera, NULL, NULL, texts->seed, world};
    status = scene_run_write(texts->run, &run, error);
done:
    free(camera);
    free(scene);
    return status;
}

static tides_status check_outputs(const scene_texts *texts, tides_error *error) {
    char *camera = texts->run ? camera_name(texts->run) : NULL;
    if (texts->run && !camera) return cli_error(error, TIDES_NO_MEMORY, "out of memory: %s", texts->run);
    const cli_output written[] = {{texts->output, NULL}, {texts->run, ".json"}, {camera, ".json"}};
    const tides_status status = cli_check_outputs(NULL, written, 3, error);
    free(camera);
    return status;
}

static tides_status make(const char *kind, const tides_generate_options *options, const scene_texts *texts, tides_world *world,
                         tides_error *error) {
    tides_status status = check_outputs(texts, error);
    if (status == TIDES_OK) status = tides_file_check(texts->output, 1, error);
    if (status == TIDES_OK && texts->run) status = tides_file_check(texts->run, 1, error);
    if (status == TIDES_OK) status = tides_generate(kind, options, world, error);
    if (status == TIDES_OK) status = tides_scene_save(world->scene, texts->output, error);
    return status == TIDES_OK && texts->run ? write_run(texts, world, error) : status;
}

static int report(const scene_texts *texts, const tides_world *world, const cli_common *common) {
    if (common->json) {
        cJSON *facts = cJSON_CreateObject();
        cJSON_AddStringToObject(facts, "file", texts->output);
        cJSON_AddNumberToObject(facts, "gaussians", (double)tides_scene_count(world->scene));
        cJSON_AddNumberToObject(facts, "objects", tides_scene_objects(world->scene));
        cJSON_AddNumberToObject(facts, "duration_s", world->duration_s);
        if (texts->run) cJSON_AddStringToObject(facts, "run", texts->run);
        return cli_print_facts(facts, 1);
    }
    if (common->quiet) return CLI_OK;
    printf("%s: %lld Gaussians, %d objects, %g s\n", texts->output, (long long)tides_scene_count(world->scene),
           (int)tides_scene_objects(world->scene), world->duration_s);
    if (texts->run) printf("next: tides simulate %s -o events.h5\n", texts->run);
    return CLI_OK;
}

int cmd_scene(const cli_command *command, int argc, char **argv) {
    cli_common common;
    scene_texts texts = {.output = NULL};
    const char *kind = NULL;
    int32_t list = 0;
    const cli_option options[] = {
        {"--output", 'o', "SCENE", "the scene: .h5, or .ply for one object at rest", NULL, &texts.output, NULL},
        {"--run", 0, "RUN.json", "write a run file too, and the camera's path beside it", NULL, &texts.run, NULL},
        {"--count", 'n', "N", "how many there are of what moves (--list: [default])", NULL, &texts.count, NULL},
        {"--gaussians", 0, "N", "about how many Gaussians each of them has", NULL, &texts.gaussians, NULL},
        {"--duration", 0, "SECONDS", "how long motions and the camera's path last", NULL, &texts.duration, NULL},
        {"--speed", 0, "FACTOR", "motion so many times as fast (1)", NULL, &texts.speed, NULL},
        {"--seed", 0, "N", "of places, colours and phases (1); where given, of the run too", NULL, &texts.seed, NULL},
        {"--size", 0, "WxH", "the camera's image [px] (346x260)", NULL, &texts.size, NULL},
        {"--list", 0, NULL, "what kinds there are", &list, NULL, NULL},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    cli_command own = *command;
    for (int i = 1; i < argc; i++)
        if (strcmp(argv[i], "--list") == 0) own.positionals = 0; /* --list needs no kind */
    int code = cli_parse(&own, options, argc, argv, &common, &kind);
    if (common.help && code == CLI_OK) {
        printf("\nkinds:\n");
        print_kinds();
    }
    if (code != CLI_GO) return code;
    if (list) return list_kinds(&common);
    if (!texts.output) return cli_usage(command, "-o SCENE is missing");
    tides_generate_options wanted;
    code = read_options(command, &texts, &wanted);
    if (code != CLI_GO) return code;
    tides_error error = {TIDES_OK, ""};
    tides_world world = {.scene = NULL};
    code = make(kind, &wanted, &texts, &world, &error) == TIDES_OK ? report(&texts, &world, &common) : cli_fail(&error);
    tides_world_release(&world);
    return code;
}
