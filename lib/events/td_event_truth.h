/* Internal: columns of ground truth beside the events of a finished file. */
#ifndef TD_EVENT_TRUTH_H
#define TD_EVENT_TRUTH_H

#include "tides/truth.h"

/* Computes the truth of some events, in the file's order. `fired`: times at which they fired; NULL: their own t. */
typedef tides_status (*td_truth_source)(void *user, const tides_event *events, const int64_t *fired, size_t count,
                                        tides_event_truth *truth, tides_error *error);

/* Columns that are wanted, and the unit of depths. */
typedef struct td_truth_columns {
    uint32_t columns;       /* bits 0 to 4: flow_u, flow_v, depth, alpha, instance */
    double metres_per_unit; /* depths become metres; 0: they stay in scene units */
} td_truth_columns;

/* Parses "flow,depth,alpha,instance", or some of these. TIDES_BAD_CONFIG names an unknown one. */
tides_status td_truth_columns_parse(const char *names, uint32_t *columns, tides_error *error);

/* Adds the wanted columns to an HDF5 file of TIDES, or replaces them; other truth columns in the file are removed:
 *
 *   /events/flow_u, flow_v  f4  [px/s]
 *   /events/depth           f4  [scene units], or [m]: its attribute `unit` says "scene units" or "m"
 *   /events/alpha           f4
 *   /events/instance        i4  the scene's object; -1: nothing is seen
 *
 * Written to a copy and renamed: after a failure the file is unchanged. */
tides_status td_events_add_truth(const char *path, const td_truth_columns *wanted, td_truth_source source, void *user,
                                 tides_error *error);

/* "/events/flow_u" .., in the order above. */
enum { TD_EVENT_TRUTHS = 5 };
extern const char *const td_event_truth_columns[TD_EVENT_TRUTHS];

#endif
