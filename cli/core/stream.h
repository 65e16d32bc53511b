/* Events of a run in memory, for comparisons. */
#ifndef CLI_STREAM_H
#define CLI_STREAM_H

#include "cli.h"

typedef struct cli_stream {
    tides_event *events;
    size_t count, capacity;
} cli_stream;

/* A sink that keeps all events in a cli_stream; none if that is NULL. It stops the run if memory runs out. */
int cli_keep(void *stream, const tides_event *events, size_t count);

#endif
