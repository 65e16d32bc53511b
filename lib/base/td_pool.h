/* Internal: a few threads that share out a piece of work. The calling thread is one of them: a pool of one starts none, and
 * none is started before there is something to share. Parts are taken in order, by whoever is free, so that which thread does
 * what isn't known; what comes of them must not depend on it.
 *
 * A pool is used by one thread at a time. In a process that was forked from its own the threads are missing: there the caller
 * does all parts, and releasing the pool lets them be. */
#ifndef TD_POOL_H
#define TD_POOL_H

#include "td_base.h"

enum { TD_POOL_MOST = 256 }; /* threads: what is asked for beyond that isn't started */

typedef struct td_pool td_pool;

/* The processors that this process may run on, 1 at least. */
int td_processors(void);

/* With so many threads, the caller's included; below 1: as many as there are processors. */
TIDES_MUST_CHECK tides_status td_pool_create(int threads, td_pool **pool, tides_error *error);

/* Waits for the threads' end. NULL is fine. */
void td_pool_release(td_pool *pool);

/* How many share the work: 1 for NULL, and where no other thread can be had. */
int td_pool_threads(const td_pool *pool);

/* part(user, k) for each k below `parts`; returns when all are done. */
typedef void (*td_pool_part)(void *user, int k);
void td_pool_run(td_pool *pool, int parts, td_pool_part part, void *user);

#endif
