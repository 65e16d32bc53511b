/* Internal: the results of look-ups of a portion of the work, and how they are joined: pixels that may do something, requested
 * points, settled events and the sample of them that is measured. */
#ifndef TD_SOLVE_PORTION_H
#define TD_SOLVE_PORTION_H

#include "sensor/td_sensor.h"
#include "td_look_up.h"
#include "td_nodes.h"

struct td_portion;

/* An event of a macro step whose time is measured at the step's end. It has the model's slope and curvature there, towards the
 * event's side and per step of length_s; its rounding; and if it waited for coverage, how late it may be [steps]. */
typedef struct td_sampled {
    uint64_t order;
    td_point point;
    double L, slope, bend, floor, late, length_s;
    double rise; /* of the leak's ramp, likewise */
    int polarity;
} td_sampled;

/* The results of a portion of the work: pixels that may do something, requested points, settled events. */
typedef struct td_solve_portion {
    td_looked *looked; /* the run's: of all pixels that may do something; a portion's: of those that it listed */
    size_t looked_count, looked_capacity;
    td_solve_batch *asks; /* where points are requested: in the run's batch, or */
    td_solve_batch own;   /* in the portion's, which is joined to the run's */
    td_solve_refer_list refer;
    uint8_t *reaches; /* for each of a unit's steps (samples.pixels): 0 where a pixel has no level within reach */
    size_t reach_capacity;
    td_trust *trust; /* likewise: trust before anything is looked up */
    size_t trust_capacity;
    td_work ahead;       /* results of the pixel's current step; joined to the portion's when nothing in it must be looked up */
    td_sampled *sampled; /* of this macro step's events, the first in a random order */
    size_t sampled_count, sampled_capacity;
    int is_cut;      /* 1: there were more of them */
    size_t fired;    /* number of events of this macro step */
    uint64_t events; /* events found by look-ups */
    struct td_solve_begins {
        size_t looked, pixel, point, refer;
    } at; /* where its results begin among the run's */
} td_solve_portion;
typedef struct td_solve_begins td_solve_begins;
void td_solve_batch_release(td_solve_batch *batch);
void td_solve_portion_clear(td_solve_portion *portion);
void td_solve_portion_release(td_solve_portion *portion);

/* Joins a portion's results to the run's: portion after portion gets its places, and then each is put there, in any order and
 * by any thread. */
TIDES_MUST_CHECK tides_status td_solve_place(tides_simulator *s, td_solve_portion *portion, tides_error *error);
void td_solve_join(tides_simulator *s, const td_solve_portion *portion);

/* td_solve_sample offers a settled event to the measurement, and sets its `order`. td_solve_cut keeps the events to be
 * measured; `before`: the run's events before this macro step (chosen.c). */
TIDES_MUST_CHECK tides_status td_solve_sample(td_solve_portion *portion, const td_sampled *one, tides_error *error);

void td_solve_cut(td_solve_portion *portion, double before);

/* Joins a portion's sampled events to the run's. */
TIDES_MUST_CHECK tides_status td_solve_join_samples(tides_simulator *s, const td_solve_portion *portion, tides_error *error);

/* Runs a pixel from its first unsettled step to the first in which something must be looked up, and requests that. An ideal
 * pixel is run to its last step. Its steps are in `looked`. */
TIDES_MUST_CHECK tides_status td_solve_run(const tides_simulator *s, struct td_portion *portion, td_looked *looked,
                                           td_solving *pixel, tides_error *error);

#endif
