/* Internal: columns of ground truth beside the events of a file that is complete. */
#ifndef TD_EVENT_TRUTH_H
#define TD_EVENT_TRUTH_H

#include "tides/truth.h"

/* Gives the truth of some events of the file, in their order; `fired` as in tides_renderer_event_truth. */
typedef tides_status (*td_truth_source)(void *user, const tides_event *events, const int64_t *fired, size_t count,
                                        tides_event_truth *truth, tides_error *error);

/* Adds to an HDF5 file of ours, or replaces in it:
 *
 *   /events/flow_u, flow_v  f4  [px/s]
 *   /events/depth           f4  [scene units]
 *   /events/alpha           f4
 *   /events/instance        i4  the scene's object; -1: nothing is seen
 *
 * Written beside, from a copy, and renamed: a failure leaves the file as it was. */
/* "/events/flow_u" .., in the order of the list. */
enum { TD_EVENT_TRUTHS = 5 };
extern const char *const td_event_truth_columns[TD_EVENT_TRUTHS];

tides_status td_events_add_truth(const char *path, td_truth_source source, void *user, tides_error *error);

#endif
