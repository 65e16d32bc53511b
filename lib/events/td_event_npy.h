/* Internal: writing event files as numpy's arrays, and the numbers of the columns, which the reader uses, too. */
#ifndef TD_EVENT_NPY_H
#define TD_EVENT_NPY_H

#include "td_event_format.h"

enum { TD_NPY_T, TD_NPY_X, TD_NPY_Y, TD_NPY_P, TD_NPY_COLUMNS };

tides_status td_event_npy_create(td_event_sink *sink, tides_error *error);
tides_status td_event_npy_write(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error);
tides_status td_event_npy_complete(td_event_sink *sink, int64_t stop_ns, tides_error *error);
tides_status td_event_npz_create(td_event_sink *sink, tides_error *error);
tides_status td_event_npz_write(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error);
tides_status td_event_npz_complete(td_event_sink *sink, int64_t stop_ns, tides_error *error);
void td_event_npy_discard(td_event_sink *sink);

#endif
