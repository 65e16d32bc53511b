/* Answers `--help=man`, `--help=bash` and `--help=zsh` of a command, and `tides help --man` and so on for the tool. */
#include "describe.h"

#include <stdio.h>
#include <string.h>

/* Asks each command about its options, for `tides help --KIND`. */
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
