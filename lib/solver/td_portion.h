/* Internal: a portion of a run's work: some of its units, worked on by one thread. Its results stay in it until they are joined
 * to the run's (td_simulator.done), portion after portion in the order of units. So the run is the same for any number of
 * portions and threads. A run that isn't shared out is one portion, the run's own. */
#ifndef TD_PORTION_H
#define TD_PORTION_H

#include "sensor/td_sensor.h"
#include "td_pool.h"
#include "td_solve_portion.h"
#include "td_timing.h"

/* Counts of accepted steps (tides_stats). */
typedef struct td_step_counts {
    uint64_t steps, probed, at_minimum, at_rounding;
    double worst_error, worst_deviation;
} td_step_counts;

typedef struct td_portion {
    td_work work;
    td_timing timing;
    td_step_counts steps;
    td_solve_portion solve;
    tides_status status; /* of its worker */
    tides_error error;   /* the reason of a failure */
} td_portion;

/* Portions of the work under way. They are kept, with their memory, for the next work. */
typedef struct td_sharing {
    td_pool *pool; /* NULL: nothing is shared out */
    td_portion *portion;
    int count; /* number of portions */
} td_sharing;

/* The work is shared by `threads` threads; 0: as many as processors. */
TIDES_MUST_CHECK tides_status td_sharing_create(td_sharing *sharing, int threads, tides_error *error);
void td_sharing_release(td_sharing *sharing);

/* Works on units [first, end) of the shared work. The simulator is const: settings, counts and lists of steps stay as they are.
 * A worker changes its portion, and in arrays the pixels, samples and steps of its units. */
typedef tides_status (*td_portion_worker)(const tides_simulator *s, td_portion *portion, int first, int end, const void *user,
                                          tides_error *error);

/* Units per portion at least, where units are compared. */
enum { TD_FEWEST_UNITS = 4 };

/* Shares out `count` units, at least `fewest` to a portion, and joins the results to the run's. Where portions fail, the first
 * in order of units gives the error, and the results before it are joined. */
TIDES_MUST_CHECK tides_status td_share_out(tides_simulator *s, int count, int fewest, td_portion_worker worker,
                                           const void *user, tides_error *error);

/* Processor time of the calling thread outside works that the pool's threads share, and beside no launch on a device [s]. */
double td_alone_time(const tides_simulator *s);

#endif
