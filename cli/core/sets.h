/* --set's texts on their way to the library: paths that the shell's folder has become whole ones. */
#ifndef CLI_SETS_H
#define CLI_SETS_H

#include "cli.h"

typedef struct cli_placed {
    cli_list list; /* what the library is given */
    char *own[CLI_LIST_MAX];
    size_t owned;
} cli_placed;

/* `run`: the run file. Where its folder has another file of that name, a line says which is taken. */
void cli_sets_place(const cli_list *sets, const char *run, const cli_common *common, cli_placed *placed);
void cli_sets_free(cli_placed *placed);

/* From now on sets are those of a file, whose paths are relative to the run file alone. */
void cli_sets_of_manifest(void);

#endif
