/* Portions of work: shared out among the pool's threads, and joined. */
#include "td_extremes.h"
#include "solver/td_simulator.h"

#include <limits.h>
#include <stdlib.h>

tides_status td_sharing_create(td_sharing *sharing, int threads, tides_error *error) {
    tides_status status = td_pool_create(threads, &sharing->pool, error);
    if (status != TIDES_OK || td_pool_threads(sharing->pool) < 2) return status;
    sharing->count = td_pool_portions(sharing->pool, INT_MAX, 1);
    sharing->portion = td_alloc((size_t)sharing->count, sizeof *sharing->portion, error);
    return sharing->portion ? TIDES_OK : TIDES_NO_MEMORY;
}

void td_sharing_release(td_sharing *sharing) {
    for (int k = 0; k < sharing->count && sharing->portion; k++) {
        td_work_release(&sharing->portion[k].work);
        td_solve_portion_release(&sharing->portion[k].solve);
    }
    free(sharing->portion);
    td_pool_release(sharing->pool);
    *sharing = (td_sharing){.pool = NULL};
}

double td_alone_time(const tides_simulator *s) {
    return td_own_time() - td_pool_shared_time(s->sharing.pool) - s->solve.covered_s;
}

/* -- what came of a portion ------------------------------------------------------------------------------------------------ */

/* Adds timing weights. Estimated events count in 64ths, and measured ones aren't added where work is shared out. So sums are
 * exact in any order. */
static void join_timing(td_timing *to, td_timing *timing) {
    for (int k = 0; k < TD_TIMING_BINS; k++) to->weight[k] += timing->weight[k];
    memset(timing->weight, 0, sizeof timing->weight);
}

static void join_steps(td_step_counts *to, const td_step_counts *steps) {
    to->steps += steps->steps;
    to->probed += steps->probed;
    to->at_minimum += steps->at_minimum;
    to->at_rounding += steps->at_rounding;
    to->worst_error = td_greater(to->worst_error, steps->worst_error);
    to->worst_deviation = td_greater(to->worst_deviation, steps->worst_deviation);
}

/* Joins a portion. Results of look-ups only get their places. */
static tides_status join(tides_simulator *s, td_portion *portion, tides_error *error) {
    td_portion *done = &s->done;
    tides_status status = td_work_join(&done->work, &portion->work, error);
    if (portion->work.events.count > 0) join_timing(&done->timing, &portion->timing); /* else nothing was added */
    done->timing.uncertain += portion->timing.uncertain;
    join_steps(&done->steps, &portion->steps);
    return status == TIDES_OK ? td_solve_place(s, &portion->solve, error) : status;
}

/* -- sharing it out -------------------------------------------------------------------------------------------------------- */

/* Facts that the pool's parts share. */
typedef struct shared {
    tides_simulator *s;
    td_portion_worker worker;
    const void *user;
    int units, portions;
} shared;

static void clear(const tides_simulator *s, td_portion *portion) {
    const td_timing *known = &s->done.timing;
    td_work_clear(&portion->work);
    portion->timing.rounding = known->rounding;
    portion->timing.epsilon = known->epsilon;
    portion->timing.size = known->size;
    portion->timing.uncertain = 0;
    portion->steps = (td_step_counts){.steps = 0};
    td_solve_portion_clear(&portion->solve);
}

static void work_on(void *user, int k) {
    const shared *all = user;
    td_portion *portion = &all->s->sharing.portion[k];
    clear(all->s, portion);
    const int first = td_pool_begin(all->units, all->portions, k), end = td_pool_begin(all->units, all->portions, k + 1);
    portion->status = all->worker(all->s, portion, first, end, all->user, &portion->error);
}

static void put(void *user, int k) {
    const shared *all = user;
    td_solve_join(all->s, &all->s->sharing.portion[k].solve);
}

static tides_status run_alone(tides_simulator *s, int count, td_portion_worker worker, const void *user, tides_error *error) {
    s->done.solve.asks = td_solve_filling(&s->solve);
    return worker(s, &s->done, 0, count, user, error);
}

tides_status td_share_out(tides_simulator *s, int count, int fewest, td_portion_worker worker, const void *user,
                          tides_error *error) {
    td_sharing *sharing = &s->sharing;
    shared all = {s, worker, user, count, td_pool_portions(sharing->pool, count, fewest)};
    tides_status status = TIDES_OK;
    if (count <= 0) return status;
    if (all.portions < 2) return run_alone(s, count, worker, user, error);
    td_pool_run(sharing->pool, all.portions, work_on, &all);
    int joined = 0;
    while (joined < all.portions && status == TIDES_OK) {
        td_portion *portion = &sharing->portion[joined];
        status = join(s, portion, error);
        if (status != TIDES_OK) return status;
        joined++;
        if (portion->status == TIDES_OK) continue;
        if (error) *error = portion->error;
        status = portion->status;
    }
    td_pool_run(sharing->pool, s->solve.on ? joined : 0, put, &all);
    return status;
}
