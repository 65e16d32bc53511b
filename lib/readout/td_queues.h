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

/* Makes room in the pool for one more event. */
tides_status td_queues_grow(td_queues *queues, tides_error *error);

/* The three calls that every event takes are inline: a function call each would double their time. */

/* Appends; `*full` becomes 1 where the queue has no room, and nothing is appended. */
static inline tides_status td_queues_append(td_queues *queues, int32_t queue, const tides_event *event, int32_t tile, int *full,
                                            tides_error *error) {
    *full = queues->length[queue] == queues->capacity;
    if (*full) return TIDES_OK;
    int32_t node = queues->unused;
    if (node >= 0)
        queues->unused = queues->pool[node].next;
    else {
        if ((size_t)queues->used == queues->pool_capacity) {
            tides_status status = td_queues_grow(queues, error);
            if (status != TIDES_OK) return status;
        }
        node = queues->used++;
    }
    queues->pool[node] = (td_waiting){*event, -1, tile};
    if (queues->length[queue]++)
        queues->pool[queues->last[queue]].next = node;
    else {
        queues->first[queue] = node;
        queues->some[queue / 64] |= (uint64_t)1 << (queue % 64);
    }
    queues->last[queue] = node;
    queues->waiting++;
    return TIDES_OK;
}

/* The first of a queue that isn't empty. */
static inline const td_waiting *td_queues_head(const td_queues *queues, int32_t queue) {
    return &queues->pool[queues->first[queue]];
}

/* Takes that one out. */
static inline void td_queues_take(td_queues *queues, int32_t queue) {
    int32_t node = queues->first[queue];
    queues->first[queue] = queues->pool[node].next;
    queues->pool[node].next = queues->unused;
    queues->unused = node;
    if (--queues->length[queue] == 0) queues->some[queue / 64] &= ~((uint64_t)1 << (queue % 64));
    queues->waiting--;
}

/* The first queue at or after `from`, going round, that isn't empty; -1 where all are. */
int32_t td_queues_next(const td_queues *queues, int32_t from);

#endif
