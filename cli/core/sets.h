/* --set's texts on their way to the library: paths found in the shell's folder become absolute. */
#ifndef CLI_SETS_H
#define CLI_SETS_H

#include "cli.h"

typedef struct cli_placed {
    cli_list list; /* for the library */
    char *own[CLI_LIST_MAX];
    size_t owned;
} cli_placed;

/* `run`: the run file. If its folder has another file of the same name, a message says which one is used. */
void cli_sets_place(const cli_list *sets, const char *run, const cli_common *common, cli_placed *placed);
void cli_sets_free(cli_placed *placed);

/* From now on sets come from a file, and paths are relative to the run file. */
void cli_sets_of_manifest(void);

#endif
