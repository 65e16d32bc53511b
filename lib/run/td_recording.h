/* Internal: writes events to a file during a simulation, with checkpoints of the simulator. */
#ifndef TD_RECORDING_H
#define TD_RECORDING_H

#include "tides/session.h"

typedef struct td_record {
    const char *path;
    const tides_event_file *facts;
    tides_recording how;
    char *checkpoint;           /* PATH.checkpoint; NULL: the format can't be resumed */
    double due;                 /* time of the next checkpoint, by td_now */
    tides_simulator *simulator; /* NULL: a method on frames, which has no checkpoints */
    tides_event_writer *writer;
    tides_recorded *done; /* the caller's struct, or `own` */
    tides_recorded own;
    tides_progress progress; /* the caller's, may be NULL */
    void *user;
    int32_t stopped;   /* 1: the caller stopped the run, not a checkpoint */
    int32_t whole;     /* 1: a packet came after the last call of progress, so the simulator is between steps */
    tides_error cause; /* first failure of the file */
} td_record;

/* Checks `how` and zeroes `done` (may be NULL). Call td_record_end in any case. */
tides_status td_record_begin(td_record *record, const char *path, const tides_event_file *facts, const tides_recording *how,
                             tides_progress progress, void *user, tides_recorded *done, tides_error *error);

/* Begins a new file. It removes the files of an earlier run, the checkpoint first. */
tides_status td_record_anew(td_record *record, tides_error *error);

/* Resumes the file and record->simulator, which must be new, at the checkpoint. */
tides_status td_record_again(td_record *record, tides_error *error);

/* A tides_event_sink that writes to the file. */
int td_record_take(void *record, const tides_event *events, size_t count);

/* The final status: `status`, or the reason of the sink's failure if it had failed. */
tides_status td_record_judge(const td_record *record, tides_status status, tides_error *error);

/* Simulates up to `stop`, with stops for checkpoints. */
tides_status td_record_simulate(td_record *record, double stop, tides_error *error);

/* Completes the file, and removes the checkpoint unless it is to be kept. */
tides_status td_record_finish(td_record *record, tides_error *error);

void td_record_end(td_record *record); /* an incomplete file stays as PATH.part */

#endif
