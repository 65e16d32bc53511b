/* Prints --help, from the tables that the parser and the run file reader use. */
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

static void print_key(const tides_param *row) {
    char left[96];
    snprintf(left, sizeof left, "%s [%s]", row->key, row->fallback ? row->fallback : "required");
    printf("  %-42s %s%s%s%s", left, row->sentence, row->unit[0] ? " [" : "", row->unit, row->unit[0] ? "]" : "");
    if (row->choices) printf(": %s", row->choices);
    putchar('\n');
}

void cli_help_keys(int32_t all) {
    size_t count;
    const tides_param *rows = tides_params(&count);
    printf("\nkeys of the run file, for --set key=value (default in brackets)%s:\n",
           all ? "" : "; --help-all lists all of them");
    for (size_t i = 0; i < count; i++) {
        const size_t group = strcspn(rows[i].key, ".");
        if (all && (i == 0 || strncmp(rows[i].key, rows[i - 1].key, group + 1) != 0)) putchar('\n');
        if (all || rows[i].common) print_key(&rows[i]);
    }
}
