/* FIFO queues as linked lists in one pool, and which of them hold something. */
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
    queues->first = td_alloc((size_t)count, sizeof *queues->first, error);
    queues->last = td_alloc((size_t)count, sizeof *queues->last, error);
    queues->length = td_alloc((size_t)count, sizeof *queues->length, error);
    queues->some = td_alloc(((size_t)count + 63) / 64, sizeof *queues->some, error);
    if (queues->first && queues->last && queues->length && queues->some) return TIDES_OK;
    td_queues_release(queues);
    return TIDES_NO_MEMORY;
}

void td_queues_release(td_queues *queues) {
    free(queues->pool);
    free(queues->first);
    free(queues->last);
    free(queues->length);
    free(queues->some);
    memset(queues, 0, sizeof *queues);
}

tides_status td_queues_grow(td_queues *queues, tides_error *error) {
    if (queues->used == INT32_MAX)
        return td_fail(error, TIDES_NO_MEMORY, "readout: more than %d events wait: raise k0 or lower queue_capacity",
                       INT32_MAX);
    void *pool = queues->pool;
    tides_status status = td_reserve(&pool, &queues->pool_capacity, (size_t)queues->used + 1, sizeof *queues->pool, error);
    queues->pool = pool;
    return status;
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
    /* The first word twice: from `from` on, and at the end what lies before it. */
    for (int32_t k = 0; k <= words; k++) {
        int32_t word = (from / 64 + k) % words;
        uint64_t bits = queues->some[word];
        if (k == 0) bits &= ~(uint64_t)0 << (from % 64);
        if (bits) return 64 * word + lowest_bit(bits);
    }
    return -1;
}
