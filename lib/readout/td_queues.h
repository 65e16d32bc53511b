/* Internal: the FIFO queues of a readout, as lists of blocks of events in one pool. With blocks of one event, lists of
 * millions would be spread all over memory. */
#ifndef TD_QUEUES_H
#define TD_QUEUES_H

#include "tides/events.h"

enum { TD_BLOCK_EVENTS = 7 }; /* with the link, a block fills two cache lines */

typedef struct td_queue_block {
    int32_t next, reserved[3]; /* the next block in the queue, or among free blocks; -1: none */
    tides_event events[TD_BLOCK_EVENTS];
} td_queue_block;

typedef struct td_queue {
    int32_t first, last; /* blocks; undefined if the queue is empty */
    int32_t length;      /* events */
    uint8_t head, tail;  /* index of the first event in the first block; index after the last event in the last */
} td_queue;

typedef struct td_queues {
    td_queue_block *pool;
    size_t pool_capacity;
    int32_t used, unused;    /* blocks of the pool used so far; the first free one, or -1 */
    td_queue *queues;        /* (count) */
    uint64_t *some;          /* a bit per queue: it isn't empty */
    int32_t count, capacity; /* queues; most events in one */
    uint64_t waiting;        /* events in all queues */
} td_queues;

tides_status td_queues_create(td_queues *queues, int32_t count, int32_t capacity, tides_error *error);
void td_queues_release(td_queues *queues);

/* Gives the queue a block for its next event. */
tides_status td_queues_extend(td_queues *queues, td_queue *queue, tides_error *error);

/* Appends an event. If the queue has no room, `*full` becomes 1 and nothing is appended. Inline, because a function call
 * would double its time. */
static inline tides_status td_queues_append(td_queues *queues, int32_t index, const tides_event *event, int *full,
                                            tides_error *error) {
    td_queue *queue = &queues->queues[index];
    *full = queue->length == queues->capacity;
    if (*full) return TIDES_OK;
    if (queue->length == 0 || queue->tail == TD_BLOCK_EVENTS) {
        tides_status status = td_queues_extend(queues, queue, error);
        if (status != TIDES_OK) return status;
        queues->some[index / 64] |= (uint64_t)1 << (index % 64);
    }
    queues->pool[queue->last].events[queue->tail++] = *event;
    queue->length++;
    queues->waiting++;
    return TIDES_OK;
}

/* Moves the first `count` events, at most the queue's length, to `events`. */
void td_queues_take(td_queues *queues, int32_t index, int32_t count, tides_event *events);

/* Copies the queue's events to `events` (length). */
void td_queues_copy(const td_queues *queues, int32_t index, tides_event *events);

/* The first queue at or after `from`, cyclically, that isn't empty; -1 if all are. */
int32_t td_queues_next(const td_queues *queues, int32_t from);

#endif
