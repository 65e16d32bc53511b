/* A stretch of a recording in memory, and the windows in which it is shown or exported. */
#ifndef CLI_RECORDING_H
#define CLI_RECORDING_H

#include "reading.h"
#include "session.h"

/* Most windows: a day of 10 ms each. */
enum { CLI_WINDOWS_MOST = 10000000 };

/* A stretch of a file. */
typedef struct cli_stretch {
    const char *file;
    cli_reading reading;                                          /* texts of options */
    tides_event_reading how;                                      /* made of these */
    const char *start_text, *stop_text, *window_text, *step_text; /* of options; NULL where not given */
    int64_t start_ns, stop_ns;                                    /* [start, stop), from the texts or the events */
    int64_t window_ns, step_ns;                                   /* 0: not given; a window without a step has its own length */
    int32_t of_run;        /* 1: ends that aren't given are the file's interval, if it has one; 0: the events' */
    int64_t before_ns;     /* [ns] events before `start` that are read too */
    uint64_t windows_most; /* greatest number of windows; 0: any */
} cli_stretch;

/* Parses the texts; CLI_GO or CLI_USAGE. */
int cli_stretch_parse(const cli_command *command, cli_stretch *stretch);

/* Reads the events in order of time. Ends that weren't given become the first event and just after the last one; without events
 * the stretch is empty. The caller frees the window's events. */
tides_status cli_stretch_read(cli_stretch *stretch, cli_window *recording, tides_error *error);

#endif
