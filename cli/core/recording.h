/* A stretch of a recording in memory, and the windows that it is shown or exported in. */
#ifndef CLI_RECORDING_H
#define CLI_RECORDING_H

#include "reading.h"
#include "session.h"

/* A day in windows of 10 ms. */
enum { CLI_WINDOWS_MOST = 10000000 };

/* Which stretch of which file. */
typedef struct cli_stretch {
    const char *file;
    cli_reading reading;                                          /* the options' texts */
    tides_event_reading how;                                      /* of them */
    const char *start_text, *stop_text, *window_text, *step_text; /* of the options; NULL where not given */
    int64_t start_ns, stop_ns;  /* [start, stop): of the texts, else once read of the events */
    int64_t window_ns, step_ns; /* 0 where not given; a step without one is the window */
    int32_t of_run;             /* 1: what isn't given is the recording's stretch where the file says it, not its events' */
    int64_t before_ns;          /* events up to this long before `start` are read too */
    uint64_t windows_most;      /* 0: any; else more than so many windows of a step are refused */
} cli_stretch;

/* Reads the texts; CLI_GO or CLI_USAGE. */
int cli_stretch_parse(const cli_command *command, cli_stretch *stretch);

/* Reads the events, in order of time, and sets what wasn't given: start to the first event, stop to just after the last one.
 * Without events the stretch is empty where it wasn't given. The caller frees the window's events. */
tides_status cli_stretch_read(cli_stretch *stretch, cli_window *recording, tides_error *error);

#endif
