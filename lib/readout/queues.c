/* FIFO queues as lists of blocks in one pool, with a bit per queue that says whether it is empty. */
#include "td_queues.h"
#include "td_base.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

tides_status td_queues_create(td_queues *queues, int32_t count, int32_t capacity, tides_error *error) {
    memset(queues, 0, sizeof *queues);
    queues->count = count;
    queues->capacity = capacity;
    queues->unused = -1;
    queues->queues = td_alloc((size_t)count, sizeof *queues->queues, error);
    queues->some = td_alloc(((size_t)count + 63) / 64, sizeof *queues->some, error);
    if (queues->queues && queues->some) return TIDES_OK;
    td_queues_release(queues);
    return TIDES_NO_MEMORY;
}

void td_queues_release(td_queues *queues) {
    free(queues->pool);
    free(queues->queues);
    free(queues->some);
    memset(queues, 0, sizeof *queues);
}

static tides_status grow(td_queues *queues, tides_error *error) {
    if (queues->used == INT32_MAX)
        return td_fail(error, TIDES_NO_MEMORY, "readout: %d blocks of events wait: raise k0 or lower queue_capacity",
                       INT32_MAX);
    void *pool = queues->pool;
    tides_status status = td_reserve(&pool, &queues->pool_capacity, (size_t)queues->used + 1, sizeof *queues->pool, error);
    queues->pool = pool;
    return status;
}

tides_status td_queues_extend(td_queues *queues, td_queue *queue, tides_error *error) {
    int32_t block = queues->unused;
    if (block >= 0)
        queues->unused = queues->pool[block].next;
    else {
        if ((size_t)queues->used == queues->pool_capacity) {
            tides_status status = grow(queues, error);
            if (status != TIDES_OK) return status;
        }
        block = queues->used++;
    }
    queues->pool[block].next = -1;
    if (queue->length)
        queues->pool[queue->last].next = block;
    else {
        queue->first = block;
        queue->head = 0;
    }
    queue->last = block;
    queue->tail = 0;
    return TIDES_OK;
}

static void free_block(td_queues *queues, int32_t block) {
    queues->pool[block].next = queues->unused;
    queues->unused = block;
}

void td_queues_take(td_queues *queues, int32_t index, int32_t count, tides_event *events) {
    td_queue *queue = &queues->queues[index];
    queue->length -= count;
    queues->waiting -= (uint64_t)count;
    while (count > 0) {
        const int32_t block = queue->first, left = TD_BLOCK_EVENTS - queue->head, here = count < left ? count : left;
        const tides_event *from = queues->pool[block].events + queue->head;
        for (int32_t k = 0; k < TD_BLOCK_EVENTS; k++) /* faster than memcpy for so few */
            if (k < here) events[k] = from[k];
        events += here;
        count -= here;
        queue->head = (uint8_t)(queue->head + here);
        if (queue->head < TD_BLOCK_EVENTS && queue->length > 0) break; /* the rest of the block stays */
        queue->first = queues->pool[block].next;
        queue->head = 0;
        free_block(queues, block);
    }
    if (queue->length == 0) queues->some[index / 64] &= ~((uint64_t)1 << (index % 64));
}

void td_queues_copy(const td_queues *queues, int32_t index, tides_event *events) {
    const td_queue *queue = &queues->queues[index];
    int32_t block = queue->first, place = queue->head;
    for (int32_t k = 0; k < queue->length; k++) {
        if (place == TD_BLOCK_EVENTS) {
            block = queues->pool[block].next;
            place = 0;
        }
        events[k] = queues->pool[block].events[place++];
    }
}

/* Place of the lowest set bit of a number that isn't 0. */
static int lowest_bit(uint64_t x) {
#if defined(__GNUC__)
    return __builtin_ctzll(x);
#else
    int place = 0;
    for (; (x & 1) == 0; x >>= 1) place++;
    return place;
#endif
}

int32_t td_queues_next(const td_queues *queues, int32_t from) {
    int32_t words = (queues->count + 63) / 64;
    if (queues->waiting == 0) return -1;
    if (from >= queues->count) from = 0;
    /* The first word is visited twice: first its bits from `from` on, last those before. */
    for (int32_t k = 0; k <= words; k++) {
        int32_t word = (from / 64 + k) % words;
        uint64_t bits = queues->some[word];
        if (k == 0) bits &= ~(uint64_t)0 << (from % 64);
        if (bits) return 64 * word + lowest_bit(bits);
    }
    return -1;
}
