/* Internal: the FIFO queues of a readout, in one pool of nodes. */
#ifndef TD_QUEUES_H
#define TD_QUEUES_H

#include "tides/events.h"

typedef struct td_waiting {
    tides_event event;
    int32_t next; /* in the queue, or in the list of free nodes; -1: the last */
    int32_t tile; /* whose activity it came under */
} td_waiting;

typedef struct td_queues {
    td_waiting *pool;
    size_t pool_capacity;
    int32_t used, unused;    /* nodes of the pool so far; first of the freed ones, or -1 */
    int32_t *first, *last;   /* (count) */
    int32_t *length;         /* (count) */
    uint64_t *some;          /* a bit per queue: it isn't empty */
    int32_t count, capacity; /* queues; events in one at most */
    uint64_t waiting;        /* in all */
} td_queues;

tides_status td_queues_create(td_queues *queues, int32_t count, int32_t capacity, tides_error *error);
void td_queues_release(td_queues *queues);

/* Appends; `*full` becomes 1 where the queue has no room, and nothing is appended. */
tides_status td_queues_append(td_queues *queues, int32_t queue, const tides_event *event, int32_t tile, int *full,
                              tides_error *error);

/* The first of a queue that isn't empty, and taking it out. */
const td_waiting *td_queues_head(const td_queues *queues, int32_t queue);
void td_queues_take(td_queues *queues, int32_t queue);

/* The first queue at or after `from`, going round, that isn't empty; -1 where all are. */
int32_t td_queues_next(const td_queues *queues, int32_t from);

#endif
