/* What man pages and completions have in common, and which of them a command is asked for. */
#include "describe.h"

#include <stdio.h>
#include <string.h>

int32_t describe_argument(const char *argument) {
    if (!argument) return DESCRIBE_NOTHING;
    if (strcmp(argument, "DIR") == 0) return DESCRIBE_FOLDER;
    if (strcmp(argument, "KEY=VALUE") == 0) return DESCRIBE_KEY;
    if (strcmp(argument, "SPEC") == 0) return DESCRIBE_DEVICE;
    if (strcmp(argument, "FORMAT") == 0) return DESCRIBE_FORMAT;
    if (strcmp(argument, "LIST") == 0) return DESCRIBE_LIST;
    if (strchr(argument, '|') || strcmp(argument, "LAYOUT") == 0) return DESCRIBE_WORDS;
    return strstr(argument, "FILE") || strchr(argument, '.') ? DESCRIBE_FILE : DESCRIBE_NOTHING;
}

/* `words` up to its end or to one of `stops`, with `between` in place of `divider`. */
static void put_words(const char *words, const char *stops, char divider, const char *between) {
    for (size_t i = 0, length = strcspn(words, stops); i < length; i++)
        words[i] == divider ? (void)fputs(between, stdout) : (void)putchar(words[i]);
}

void describe_words(const cli_option *option, const char *between) {
    if (describe_argument(option->argument) == DESCRIBE_LIST) {
        put_words(option->help, ": ", ',', between);
    } else if (strchr(option->argument, '|')) {
        put_words(option->argument, "", '|', between);
    } else {
        tides_dataset_layout layout;
        for (size_t i = 0; tides_dataset_layout_at(i, &layout); i++) printf("%s%s", i ? between : "", layout.name);
    }
}

void describe_presets(const char *between) {
    char name[TIDES_PRESET_NAME];
    for (size_t i = 0; tides_preset_at(i, name); i++) printf("%s%s", i ? between : "", name);
}

void describe_kinds(const char *between) {
    size_t count;
    const tides_generator *kinds = tides_generators(&count);
    for (size_t i = 0; i < count; i++) printf("%s%s", i ? between : "", kinds[i].name);
}

int describe_choice(const cli_command *command) {
    const int length = (int)strcspn(command->arguments, " ");
    return memchr(command->arguments, '|', (size_t)length) ? length : 0;
}

void describe_devices(const char *between) { printf("auto%scpu%sgpu%sreference", between, between, between); }

void describe_formats(const char *between) {
    tides_event_format format;
    for (size_t i = 0; tides_event_format_at(i, &format); i++) printf("%s%s", i ? between : "", format.name);
}

void describe_keys(const char *after, const char *between) {
    size_t count;
    const tides_param *rows = tides_params(&count);
    for (size_t i = 0; i < count; i++) printf("%s%s%s", i ? between : "", rows[i].key, after);
}

/* How `tides help --KIND` asks each command about its options. */
static int ask(const cli_command *command, char *kind) {
    char name[32];
    snprintf(name, sizeof name, "%s", command->name);
    char *again[] = {name, kind, NULL};
    return command->run(command, 2, again);
}

static int ask_all(const cli_command *commands, size_t count, char *kind) {
    for (size_t i = 0; i < count; i++) ask(&commands[i], kind);
    return CLI_OK;
}

int cli_describe(const char *kind, const cli_command *command, const cli_option *options) {
    if (strcmp(kind, "man") == 0)
        describe_man_command(command, options);
    else if (strcmp(kind, "bash") == 0)
        describe_bash_command(command, options);
    else if (strcmp(kind, "zsh") == 0)
        describe_zsh_command(command, options);
    else
        return cli_usage(command, "--help=%s: give man, bash or zsh", kind);
    return CLI_DESCRIBED;
}

static int man_page(const cli_command *commands, size_t count, const char *page) {
    char kind[] = "--help=man";
    const char *nearest;
    const char *names[64] = {"run"};
    if (!page) {
        describe_man_tool(commands, count);
        return CLI_OK;
    }
    if (strcmp(page, "run") == 0) {
        describe_man_run();
        return CLI_OK;
    }
    for (size_t i = 0; i < count && i + 2 < sizeof names / sizeof names[0]; i++) names[i + 1] = commands[i].name;
    for (size_t i = 0; i < count; i++)
        if (strcmp(commands[i].name, page) == 0) return ask(&commands[i], kind);
    nearest = tides_nearest_name(page, names);
    return nearest ? cli_usage(NULL, "there is no page on %s; did you mean %s?", page, nearest)
                   : cli_usage(NULL, "there is no page on %s", page);
}

int cli_help_pages(const cli_command *commands, size_t count, const char *what, const char *page) {
    char bash[] = "--help=bash", zsh[] = "--help=zsh";
    if (strcmp(what, "--man") == 0) return man_page(commands, count, page);
    if (page || (strcmp(what, "--bash") != 0 && strcmp(what, "--zsh") != 0))
        return cli_usage(NULL, "help takes a command's name, or --man [PAGE], --bash or --zsh");
    if (strcmp(what, "--bash") == 0) {
        describe_bash_begin(commands, count);
        ask_all(commands, count, bash);
        describe_bash_end();
    } else {
        describe_zsh_begin(commands, count);
        ask_all(commands, count, zsh);
        describe_zsh_end();
    }
    return CLI_OK;
}
