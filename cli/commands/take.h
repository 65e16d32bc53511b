/* The common part of tides frames, imu and tracks: a run file, one output, and counts of what was written. */
#ifndef CLI_TAKE_H
#define CLI_TAKE_H

#include "session.h"

typedef tides_status (*cli_taker)(tides_session *session, const char *path, tides_progress progress, void *user,
                                  tides_session_taken *taken, tides_error *error);

/* `output` and `help` are for the option -o; `report` (nullable) adds facts. cli_take_run returns the exit code. */
typedef struct cli_take {
    const char *output, *help, *count; /* such as "DIR", its help, "frames" */
    cli_taker take;
    void (*report)(cJSON *facts, const tides_session_taken *taken);
    int32_t renders; /* 1: taken.pairs tells whether anything was in view */
} cli_take;
int cli_take_run(const cli_command *command, int argc, char **argv, const cli_take *what);

#endif
