/* Events of a run in memory, for comparisons. */
#ifndef CLI_STREAM_H
#define CLI_STREAM_H

#include "cli.h"

typedef struct cli_stream {
    tides_event *events;
    size_t count, capacity;
} cli_stream;

/* A sink that keeps everything in a cli_stream, nothing where that is NULL. Its own status stops the run: out of memory. */
int cli_keep(void *stream, const tides_event *events, size_t count);

#endif
