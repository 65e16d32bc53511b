/* A pool of threads that share the parts of a piece of work. One lock guards all shared fields. That is cheap enough: there
 * are only a few parts for each thread. */
#define _GNU_SOURCE /* for sched_getaffinity: a container or taskset allows fewer processors than the machine has */
#include "td_pool.h"

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

struct td_pool {
    pthread_t thread[TD_POOL_MOST];
    int threads; /* threads asked for, with the caller's own */
    int started; /* threads started besides the caller's */
    int tried;   /* 1 after the attempt to start them, of which some may have failed */
    pid_t process;
    double shared_time; /* the callers' [s] */
    pthread_mutex_t lock;
    pthread_cond_t begun, ended;
    /* guarded by the lock: */
    uint64_t round; /* number of the current or last piece of work */
    td_pool_part part;
    void *user;
    int parts, next, left; /* of this work: all parts, parts taken so far, parts not finished */
    int stops;
};

int td_processors(void) {
#ifdef CPU_COUNT
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0) return CPU_COUNT(&set);
#endif
    const long online = sysconf(_SC_NPROCESSORS_ONLN);
    return online > 1 ? (int)(online < TD_POOL_MOST ? online : TD_POOL_MOST) : 1;
}

tides_status td_pool_create(int threads, td_pool **pool, tides_error *error) {
    td_pool *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    made->threads = threads < 1 ? td_processors() : threads;
    if (made->threads > TD_POOL_MOST) made->threads = TD_POOL_MOST;
    made->process = getpid();
    if (pthread_mutex_init(&made->lock, NULL)) goto no_lock;
    if (pthread_cond_init(&made->begun, NULL)) goto no_begun;
    if (pthread_cond_init(&made->ended, NULL)) goto no_ended;
    *pool = made;
    return TIDES_OK;
no_ended:
    pthread_cond_destroy(&made->begun);
no_begun:
    pthread_mutex_destroy(&made->lock);
no_lock:
    free(made);
    return td_fail(error, TIDES_NO_MEMORY, "no lock can be had for the threads that share the work");
}

static int is_forked(const td_pool *pool) { return getpid() != pool->process; }

void td_pool_release(td_pool *pool) {
    if (!pool) return;
    if (!is_forked(pool)) { /* a forked process lacks the threads, and one of them may have held the lock */
        pthread_mutex_lock(&pool->lock);
        pool->stops = 1;
        pthread_cond_broadcast(&pool->begun);
        pthread_mutex_unlock(&pool->lock);
        for (int k = 0; k < pool->started; k++) pthread_join(pool->thread[k], NULL);
        pthread_cond_destroy(&pool->ended);
        pthread_cond_destroy(&pool->begun);
        pthread_mutex_destroy(&pool->lock);
    }
    free(pool);
}

int td_pool_threads(const td_pool *pool) {
    if (!pool || is_forked(pool)) return 1;
    return pool->tried ? pool->started + 1 : pool->threads;
}

/* Does parts of the current work until none is left. Called with the lock held; it is released during each part. */
static void do_parts(td_pool *pool) {
    while (pool->next < pool->parts) {
        const int k = pool->next++;
        const td_pool_part part = pool->part;
        void *user = pool->user;
        pthread_mutex_unlock(&pool->lock);
        part(user, k);
        pthread_mutex_lock(&pool->lock);
        if (--pool->left == 0) pthread_cond_signal(&pool->ended);
    }
}

static void *work(void *of) {
    td_pool *pool = of;
    uint64_t seen = 0;
    pthread_mutex_lock(&pool->lock);
    while (!pool->stops) {
        if (pool->round == seen) {
            pthread_cond_wait(&pool->begun, &pool->lock);
            continue;
        }
        seen = pool->round;
        do_parts(pool);
    }
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

/* Starts the threads. They block all signals, which are for the program's own threads. If a thread can't be started, the
 * others do its work. */
static void start(td_pool *pool) {
    sigset_t all, before;
    pool->tried = 1;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (pool->started < pool->threads - 1) {
        if (pthread_create(&pool->thread[pool->started], NULL, work, pool)) break;
        pool->started++;
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

void td_pool_run(td_pool *pool, int parts, td_pool_part part, void *user) {
    if (parts > 1 && td_pool_threads(pool) > 1 && !pool->tried) start(pool);
    if (parts < 2 || td_pool_threads(pool) < 2) {
        for (int k = 0; k < parts; k++) part(user, k);
        return;
    }
    const double begun = td_own_time();
    pthread_mutex_lock(&pool->lock);
    pool->part = part;
    pool->user = user;
    pool->parts = pool->left = parts;
    pool->next = 0;
    pool->round++;
    pthread_cond_broadcast(&pool->begun);
    do_parts(pool);
    while (pool->left > 0) pthread_cond_wait(&pool->ended, &pool->lock);
    pthread_mutex_unlock(&pool->lock);
    pool->shared_time += td_own_time() - begun;
}

double td_pool_shared_time(const td_pool *pool) { return pool ? pool->shared_time : 0; }

int td_pool_portions(const td_pool *pool, int count, int fewest) {
    const int threads = td_pool_threads(pool), worth = count / fewest, most = TD_POOL_EACH * threads;
    if (threads < 2 || worth < 2) return 1;
    return worth < most ? worth : most;
}
