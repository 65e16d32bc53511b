/* Internal: keeps the events of a dataset's cameras in FOLDER.part/.events while the dataset is being made. Events take
 * longest, so if the dataset was stopped or killed, a second try reuses them. Pictures and truth are made again. */
#ifndef TD_KEPT_H
#define TD_KEPT_H

#include "td_dataset.h"
#include "tides/inputs.h"

typedef struct td_kept {
    char *folder;
    int lock; /* a descriptor; -1: none */
    tides_fingerprints *prints;
} td_kept;

/* Makes `part`, or takes over one that was left behind and empties it, except for its events. TIDES_WRITE_FAILED: it belongs
 * to another user, or another process is writing it. */
TIDES_MUST_CHECK tides_status td_kept_open(td_kept *kept, const char *part, tides_error *error);

/* Gives all events of a camera to the sink: from an existing file of the same run, or simulated into one first (continuing at
 * its checkpoint). `*unseeing` is 1 if the camera had nothing in view. TIDES_CANCELLED: `progress` or the sink asked to
 * stop. */
TIDES_MUST_CHECK tides_status td_kept_events(td_kept *kept, const td_member *camera, tides_progress progress, void *user,
                                             tides_event_sink sink, void *sink_user, int32_t *unseeing, tides_error *error);

/* 1 if there are events, or a checkpoint to continue from. */
int td_kept_any(const td_kept *kept);

/* Closes the folder; the events are removed unless `stays`. */
void td_kept_close(td_kept *kept, int stays);

#endif
