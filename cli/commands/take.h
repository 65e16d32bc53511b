/* Parts that tides frames, imu and tracks share: a run file, one output, and counts of what was written. */
#ifndef CLI_TAKE_H
#define CLI_TAKE_H

#include "session.h"

typedef tides_status (*cli_taker)(tides_session *session, const char *path, tides_progress progress, void *user,
                                  tides_session_taken *taken, tides_error *error);

/* `output` and `help` are of its option -o; `report` (nullable) adds to the facts. The exit code. */
typedef struct cli_take {
    const char *output, *help, *count; /* "DIR"; its meaning; "frames" */
    cli_taker take;
    void (*report)(cJSON *facts, const tides_session_taken *taken);
    int32_t renders; /* 1: taken.pairs says whether anything was in view */
} cli_take;
int cli_take_run(const cli_command *command, int argc, char **argv, const cli_take *what);

#endif
