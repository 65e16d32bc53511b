/* Internal: a few threads that share the parts of a piece of work. The calling thread is one of them, so a pool of one
 * starts no thread; others start only with the first work. Free threads take parts in order: which thread does a part isn't
 * known, and no result may depend on it.
 *
 * Only one thread at a time may use a pool. A process forked from the pool's own lacks the threads: there the caller does
 * all parts, and td_pool_release leaves the lock and the threads alone. */
#ifndef TD_POOL_H
#define TD_POOL_H

#include "td_base.h"

enum { TD_POOL_MOST = 256 }; /* threads; more are never started */

/* Portions per thread: they take different times, and a thread that has finished one takes the next. Most portions. */
enum { TD_POOL_EACH = 4, TD_POOL_PORTIONS = TD_POOL_EACH * TD_POOL_MOST };

typedef struct td_pool td_pool;

/* The processors that this process may run on, 1 at least. */
int td_processors(void);

/* Makes a pool of `threads` threads, with the caller; below 1: one for each processor. */
TIDES_MUST_CHECK tides_status td_pool_create(int threads, td_pool **pool, tides_error *error);

/* Waits for the threads' end. `pool` may be NULL. */
void td_pool_release(td_pool *pool);

/* The number of threads that share work: 1 for NULL, and if no other thread could be started. */
int td_pool_threads(const td_pool *pool);

/* Calls part(user, k) for each k below `parts`; returns when all are done. */
typedef void (*td_pool_part)(void *user, int k);
void td_pool_run(td_pool *pool, int parts, td_pool_part part, void *user);

/* Processor time of the callers within works that were shared with other threads, since the pool was made [s]. 0 for NULL. */
double td_pool_shared_time(const td_pool *pool);

/* Where portion k of `portions` begins, of `count` things that are shared out in order; portion `portions` is the end. */
static inline int td_pool_begin(int count, int portions, int k) { return (int)((int64_t)count * k / portions); }

/* The number of portions for `count` things of which `fewest` are worth a thread: several for each thread, since portions take
 * different times; 1 where nothing is to be shared. */
int td_pool_portions(const td_pool *pool, int count, int fewest);

#endif
