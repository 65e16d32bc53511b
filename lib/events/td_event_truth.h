/* Internal: columns of ground truth beside the events of a file that is complete. */
#ifndef TD_EVENT_TRUTH_H
#define TD_EVENT_TRUTH_H

#include "tides/truth.h"

/* Gives the truth of some events of the file, in their order; `fired` as in tides_renderer_event_truth. */
typedef tides_status (*td_truth_source)(void *user, const tides_event *events, const int64_t *fired, size_t count,
                                        tides_event_truth *truth, tides_error *error);

/* Which columns, and in what depths are. */
typedef struct td_truth_columns {
    uint32_t columns;       /* as td_truth_columns_parse finds them */
    double metres_per_unit; /* depths are in metres; 0: in scene units */
} td_truth_columns;

/* "flow,depth,alpha,instance", or some of these. TIDES_BAD_CONFIG names what is none of them. */
tides_status td_truth_columns_parse(const char *names, uint32_t *columns, tides_error *error);

/* Adds to an HDF5 file of ours, or replaces in it, those that are wanted; others that are there go:
 *
 *   /events/flow_u, flow_v  f4  [px/s]
 *   /events/depth           f4  [scene units], or [m]: its attribute `unit` says "scene units" or "m"
 *   /events/alpha           f4
 *   /events/instance        i4  the scene's object; -1: nothing is seen
 *
 * Written beside, from a copy, and renamed: a failure leaves the file as it was. */
tides_status td_events_add_truth(const char *path, const td_truth_columns *wanted, td_truth_source source, void *user,
                                 tides_error *error);

/* "/events/flow_u" .., in the order of the list. */
enum { TD_EVENT_TRUTHS = 5 };
extern const char *const td_event_truth_columns[TD_EVENT_TRUTHS];

#endif
