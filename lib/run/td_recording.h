/* Internal: events on their way into a file, with checkpoints of the simulator that they come from. */
#ifndef TD_RECORDING_H
#define TD_RECORDING_H

#include "tides/session.h"

typedef struct td_record {
    const char *path;
    const tides_event_file *facts;
    tides_recording how;
    char *checkpoint;           /* PATH.checkpoint; NULL: the format can't be gone on with */
    double due;                 /* when the next one is, as td_now */
    tides_simulator *simulator; /* NULL: a method that sees frames, which keeps no checkpoints */
    tides_event_writer *writer;
    tides_recorded *done; /* the caller's, or `own` */
    tides_recorded own;
    tides_progress progress; /* the caller's, nullable */
    void *user;
    int32_t stopped;   /* the last stop was the caller's */
    int32_t whole;     /* a packet has come since progress was last called: the simulator is between steps */
    tides_error cause; /* of the first failure of the file */
} td_record;

/* Checks `how` and empties `done` (nullable). td_record_end in any case. */
tides_status td_record_begin(td_record *record, const char *path, const tides_event_file *facts, const tides_recording *how,
                             tides_progress progress, void *user, tides_recorded *done, tides_error *error);

/* A new file; the files that an earlier run left are removed, its checkpoint first. */
tides_status td_record_anew(td_record *record, tides_error *error);

/* The file and record->simulator, which is new, where the checkpoint was made. */
tides_status td_record_again(td_record *record, tides_error *error);

/* A tides_event_sink. */
int td_record_take(void *record, const tides_event *events, size_t count);

/* `status` of what gave the sink its events; where the sink had failed, its reason. */
tides_status td_record_judge(const td_record *record, tides_status status, tides_error *error);

/* record->simulator to `stop`, with a stop wherever a checkpoint is due. */
tides_status td_record_simulate(td_record *record, double stop, tides_error *error);

/* Completes the file. The checkpoint isn't needed then, unless it is to be kept. */
tides_status td_record_finish(td_record *record, tides_error *error);

void td_record_end(td_record *record); /* leaves what isn't complete as PATH.part */

#endif
