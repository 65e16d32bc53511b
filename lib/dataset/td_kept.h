/* Internal: the events of a dataset's cameras, kept in FOLDER.part/.events while the dataset is being made: what took longest
 * is there again when a dataset that was stopped, or that died, is asked for once more. Pictures and truth are made anew. */
#ifndef TD_KEPT_H
#define TD_KEPT_H

#include "td_dataset.h"
#include "tides/inputs.h"

typedef struct td_kept {
    char *folder;
    int lock; /* a descriptor; -1: none */
    tides_fingerprints *prints;
} td_kept;

/* Makes `part`, or takes over one that a dataset left, of which all but its events goes. TIDES_WRITE_FAILED: it belongs to
 * another user, or another process is writing it. */
TIDES_MUST_CHECK tides_status td_kept_open(td_kept *kept, const char *part, tides_error *error);

/* All events of a camera to the sink, from the file that is there of the same run, or simulated into one first, from where its
 * checkpoint is. `*unseeing` gets 1 where it had nothing in view. TIDES_CANCELLED by the sink, too. */
TIDES_MUST_CHECK tides_status td_kept_events(td_kept *kept, const td_member *camera, tides_progress progress, void *user,
                                             tides_event_sink sink, void *sink_user, int32_t *unseeing, tides_error *error);

/* 1 where there are events, or a checkpoint to go on from. */
int td_kept_any(const td_kept *kept);

/* The events have been given: they go, or, where `stays`, wait for another try. */
void td_kept_close(td_kept *kept, int stays);

#endif
