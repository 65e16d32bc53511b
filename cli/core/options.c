/* The option parser of all commands: --name VALUE, --name=VALUE, -n VALUE, -nVALUE, -qv; "--" ends options; options and
 * operands may be mixed. */
#include "cli.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { NAMES_MAX = 32 };

typedef struct parser {
    const cli_command *command;
    const cli_option *own;
    cli_option common[CLI_COMMON_OPTIONS];
    char **argv;
    int argc, at;
} parser;

/* The option called `name` (its first `length` characters), or by its letter where name is NULL. */
static const cli_option *find(const parser *p, const char *name, size_t length, char letter) {
    for (const cli_option *o = p->own; o->name; o++)
        if (name ? strlen(o->name) == length && memcmp(o->name, name, length) == 0 : o->letter == letter) return o;
    for (const cli_option *o = p->common; o < p->common + CLI_COMMON_OPTIONS; o++)
        if (name ? strlen(o->name) == length && memcmp(o->name, name, length) == 0 : o->letter == letter) return o;
    return NULL;
}

static int unknown(const parser *p, const char *name, size_t length) {
    const char *names[NAMES_MAX + 1] = {NULL};
    size_t count = 0;
    for (const cli_option *o = p->own; o->name && count < NAMES_MAX - CLI_COMMON_OPTIONS; o++) names[count++] = o->name;
    for (size_t i = 0; i < CLI_COMMON_OPTIONS; i++) names[count++] = p->common[i].name;
    char given[64];
    snprintf(given, sizeof given, "%.*s", (int)(length < sizeof given ? length : sizeof given - 1), name);
    const char *nearest = given[1] == '-' ? tides_nearest_name(given, names) : NULL;
    if (nearest) return cli_usage(p->command, "unknown option %s; did you mean %s?", given, nearest);
    return cli_usage(p->command, "unknown option %s", given);
}

static const char *ending_of(const char *path, const char *const *endings) {
    while (*endings && !cli_ends_in(path, *endings)) endings++;
    return *endings;
}

/* Refuses a folder that would be made with a file's name: -o frames.mp4 asks for a video. An existing folder may have any name,
 * and so may NAME.mp4/. */
static int check_folder(const cli_command *command, const char *path) {
    static const char *const videos[] = {".mp4", ".m4v", ".mov", ".avi", ".mkv", ".webm", ".gif", ".apng", ".y4m", NULL};
    static const char *const files[] = {".png",  ".jpg",  ".jpeg", ".exr", ".tif", ".tiff", ".svg", ".pdf",
                                        ".html", ".h5",   ".hdf5", ".npy", ".npz", ".csv",  ".txt", ".json",
                                        ".bag",  ".mcap", ".zip",  ".tar", ".gz",  ".zst",  NULL};
    const char *video = ending_of(path, videos), *ending = video ? video : ending_of(path, files);
    struct stat found;
    if (!ending || (stat(path, &found) == 0 && S_ISDIR(found.st_mode))) return CLI_GO;
    const int stem = (int)(strlen(path) - strlen(ending));
    if (!video) return cli_usage(command, "-o %s: a folder is made, not a file: give -o %.*s", path, stem, path);
    return cli_usage(command,
                     "-o %s: a folder is made, not a video: give -o %.*s; frames in it become one by "
                     "ffmpeg -framerate HZ -i %.*s/frame_%%06d.png %s",
                     path, stem, path, stem, path, path);
}

/* Stores a value, or sets a switch if `value` is NULL. */
static int store(const parser *p, const cli_option *option, const char *value) {
    const int folder = value && option->argument && strcmp(option->argument, "DIR") == 0;
    const int named = folder ? check_folder(p->command, value) : CLI_GO;
    if (named != CLI_GO) return named;
    if (option->flag)
        *option->flag = 1;
    else if (option->text && *option->text)
        return cli_usage(p->command, "%s is given twice", option->name);
    else if (option->text)
        *option->text = value;
    else if (option->list->count == CLI_LIST_MAX)
        return cli_usage(p->command, "%s is given over %d times", option->name, CLI_LIST_MAX);
    else
        option->list->items[option->list->count++] = value;
    return CLI_GO;
}

/* Takes the argument that follows an option. */
static int store_next(parser *p, const cli_option *option) {
    if (p->at + 1 >= p->argc)
        return cli_usage(p->command, "%s needs a value: %s %s", option->name, option->name, option->argument);
    return store(p, option, p->argv[++p->at]);
}

static int parse_long(parser *p, const char *text) {
    size_t length = strcspn(text, "=");
    const cli_option *option = find(p, text, length, 0);
    if (!option) return unknown(p, text, length);
    if (text[length] && !option->argument) return cli_usage(p->command, "%s takes no value", option->name);
    if (text[length]) return store(p, option, text + length + 1);
    return option->argument ? store_next(p, option) : store(p, option, NULL);
}

static int parse_letters(parser *p, const char *text) {
    for (const char *letter = text + 1; *letter; letter++) {
        const cli_option *option = find(p, NULL, 0, *letter);
        if (!option) return unknown(p, (const char[]){'-', *letter, '\0'}, 2);
        if (option->argument) return letter[1] ? store(p, option, letter + 1) : store_next(p, option);
        int code = store(p, option, NULL);
        if (code != CLI_GO) return code;
    }
    return CLI_GO;
}

/* Sets the number of threads for the library, and for PoCL, which reads variables when it is loaded (version 3 and 4 have
 * different ones). */
static int take_threads(const cli_command *command, const char *text) {
    enum { MOST = 256 };
    char *end = NULL;
    const long threads = strtol(text, &end, 10);
    if (end == text || *end || threads < 0 || threads > MOST)
        return cli_usage(command, "--threads %s: give a number from 0 (all processors) to %d", text, (int)MOST);
    setenv("TIDES_THREADS", text, 1);
    if (threads == 0) return CLI_GO;
    setenv("POCL_MAX_PTHREAD_COUNT", text, 1);
    setenv("POCL_CPU_MAX_CU_COUNT", text, 1);
    return CLI_GO;
}

int cli_parse(const cli_command *command, const cli_option *options, int argc, char **argv, cli_common *common,
              const char **positional) {
    parser p = {.command = command, .own = options, .argv = argv, .argc = argc};
    memset(common, 0, sizeof *common);
    cli_common_options(p.common, common);
    int32_t given = 0, ended = 0;
    if (argc == 2 && strncmp(argv[1], "--help=", 7) == 0) return cli_describe(argv[1] + 7, command, options);
    for (p.at = 1; p.at < argc; p.at++) {
        const char *text = argv[p.at];
        int code = CLI_GO;
        if (!ended && strcmp(text, "--") == 0)
            ended = 1;
        else if (!ended && text[0] == '-' && text[1] == '-')
            code = parse_long(&p, text);
        else if (!ended && text[0] == '-' && text[1])
            code = parse_letters(&p, text);
        else if (given == abs(command->positionals))
            code = cli_usage(command, "\"%s\" is one argument too many", text);
        else
            positional[given++] = text;
        if (code != CLI_GO) return code;
    }
    if (common->help) {
        cli_help_command(command, options);
        return CLI_OK;
    }
    if (common->device && command->no_device && !common->quiet)
        fprintf(stderr, "tides: --device %s changes nothing: tides %s uses no device\n", common->device, command->name);
    const int code = common->threads ? take_threads(command, common->threads) : CLI_GO;
    if (code != CLI_GO) return code;
    if (given < command->positionals)
        return cli_usage(command, "too few arguments: tides %s %s", command->name, command->arguments);
    return CLI_GO;
}

int cli_number(const cli_command *command, const char *option, const char *text, double *number) {
    char *end = NULL;
    double value = strtod(text, &end);
    if (end == text || *end || !isfinite(value)) return cli_usage(command, "%s %s: not a number", option, text);
    *number = value;
    return CLI_GO;
}
