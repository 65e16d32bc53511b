/* --help: made from the same tables that the parser and the run file reader use. */
#include "cli.h"

#include <stdio.h>
#include <string.h>

static void print_option(char letter, const char *name, const char *argument, const char *help) {
    char left[48];
    snprintf(left, sizeof left, "%c%c%s%s%s%s", letter ? '-' : ' ', letter ? letter : ' ', letter ? ", " : "  ", name,
             argument ? " " : "", argument ? argument : "");
    printf("  %-28s %s\n", left, help);
}

void cli_help_command(const cli_command *command, const cli_option *options) {
    cli_common common;
    cli_option shared[CLI_COMMON_OPTIONS];
    cli_common_options(shared, &common);
    printf("usage: tides %s %s\n\n%s\n\noptions:\n", command->name, command->arguments, command->summary);
    for (const cli_option *o = options; o->name; o++) print_option(o->letter, o->name, o->argument, o->help);
    for (size_t i = 0; i < CLI_COMMON_OPTIONS; i++)
        print_option(shared[i].letter, shared[i].name, shared[i].argument, shared[i].help);
    if (command->details) printf("\n%s\n", command->details);
}

void cli_help_keys(void) {
    size_t count;
    const tides_param *rows = tides_params(&count);
    printf("\nkeys of the run file, for --set key=value (default in brackets):\n");
    for (size_t i = 0; i < count; i++) {
        if (!rows[i].available) continue;
        char left[96];
        snprintf(left, sizeof left, "%s [%s]", rows[i].key, rows[i].fallback ? rows[i].fallback : "required");
        printf("  %-42s %s%s%s%s", left, rows[i].sentence, rows[i].unit[0] ? " [" : "", rows[i].unit,
               rows[i].unit[0] ? "]" : "");
        if (rows[i].choices) printf(": %s", rows[i].choices);
        putchar('\n');
    }
}
