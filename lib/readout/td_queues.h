/* Internal: the FIFO queues of a readout, as lists of small blocks of events in one pool. A block rather than an event at a
 * time: where millions wait, each list is all over memory. */
#ifndef TD_QUEUES_H
#define TD_QUEUES_H

#include "tides/events.h"

enum { TD_BLOCK_EVENTS = 7 }; /* two cache lines with the link */

typedef struct td_queue_block {
    int32_t next, reserved[3]; /* in the queue, or in the list of free blocks; -1: the last */
    tides_event events[TD_BLOCK_EVENTS];
} td_queue_block;

typedef struct td_queue {
    int32_t first, last; /* blocks, where it isn't empty */
    int32_t length;      /* events */
    uint8_t head, tail;  /* place of its first event in the first block, of the next to come in the last */
} td_queue;

typedef struct td_queues {
    td_queue_block *pool;
    size_t pool_capacity;
    int32_t used, unused;    /* blocks of the pool so far; first of the freed ones, or -1 */
    td_queue *queues;        /* (count) */
    uint64_t *some;          /* a bit per queue: it isn't empty */
    int32_t count, capacity; /* queues; events in one at most */
    uint64_t waiting;        /* in all */
} td_queues;

tides_status td_queues_create(td_queues *queues, int32_t count, int32_t capacity, tides_error *error);
void td_queues_release(td_queues *queues);

/* Gives the queue a block for its next event. */
tides_status td_queues_extend(td_queues *queues, td_queue *queue, tides_error *error);

/* Inline, as every event takes it: a function call would double its time. Appends; `*full` becomes 1 where the queue has no
 * room, and nothing is appended. */
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

/* Takes the first `count` out, at most its length, to `events`. */
void td_queues_take(td_queues *queues, int32_t index, int32_t count, tides_event *events);

/* Copies all of them to `events` (length) and leaves them there. */
void td_queues_copy(const td_queues *queues, int32_t index, tides_event *events);

/* The first queue at or after `from`, going round, that isn't empty; -1 where all are. */
int32_t td_queues_next(const td_queues *queues, int32_t from);

#endif
