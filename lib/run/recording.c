/* Writes events to PATH.part during a simulation, with checkpoints in PATH.checkpoint. From these a run that was stopped or
 * killed continues; if the checkpoint is kept, so does a finished run with a later stop. */
#include "run/td_recording.h"

#include "events/td_event_format.h"
#include "solver/td_reached.h"
#include "td_base.h"
#include "td_folder.h"
#include "td_struct.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Least wall time between checkpoints, in units of the time that saving the last one took: a large checkpoint on a slow
 * disk is saved less often. */
static const double least_work = 50.0;

void tides_recording_defaults(tides_recording *recording) {
    *recording = (tides_recording){.size = sizeof *recording, .checkpoint_s = TIDES_CHECKPOINT_S};
}

/* -- begin  */

static tides_status check_how(const td_record *r, const char *path, tides_error *error) {
    if (!(r->how.checkpoint_s >= 0) || !isfinite(r->how.checkpoint_s))
        return td_fail(error, TIDES_BAD_ARGUMENT, "recording: checkpoint_s %g must be 0 or more", r->how.checkpoint_s);
    if ((r->how.resume || r->how.keep_checkpoint) && !r->checkpoint)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: only an HDF5 file (.h5) can be gone on with; leave %s at 0", path,
                       r->how.resume ? "resume" : "keep_checkpoint");
    return TIDES_OK;
}

/* Refuses a name that is so long that names of files beside it (.part, .checkpoint.part) would be too long for the file
 * system. */
static tides_status check_name(const td_record *r, const char *path, tides_error *error) {
    static const char longest[] = ".checkpoint.part", other[] = ".part";
    const size_t room = NAME_MAX - (r->checkpoint ? sizeof longest : sizeof other) + 1, length = strlen(td_base_name(path));
    if (length <= room) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT,
                   "%.40s...: the name has %zu bytes; give it at most %zu, for %s is added on the way", td_base_name(path),
                   length, room, r->checkpoint ? longest : other);
}

tides_status td_record_begin(td_record *r, const char *path, const tides_event_file *facts, const tides_recording *how,
                             tides_progress progress, void *user, tides_recorded *done, tides_error *error) {
    memset(r, 0, sizeof *r);
    r->path = path;
    r->facts = facts;
    r->progress = progress;
    r->user = user;
    r->done = done ? done : &r->own;
    memset(r->done, 0, sizeof *r->done);
    tides_recording_defaults(&r->how);
    tides_status status = how ? TD_TAKE_STRUCT(tides_recording, &r->how, how, error) : TIDES_OK;
    if (status != TIDES_OK) return status;
    if (!r->how.format && tides_event_writer_can_resume(path) && !(r->checkpoint = td_format(error, "%s.checkpoint", path)))
        return TIDES_NO_MEMORY;
    r->due = td_now() + r->how.checkpoint_s;
    status = check_name(r, path, error);
    return status == TIDES_OK ? check_how(r, path, error) : status;
}

static tides_status remove_checkpoint(const td_record *r, tides_error *error) {
    return r->checkpoint ? td_remove_file(r->checkpoint, error) : TIDES_OK;
}

tides_status td_record_anew(td_record *r, tides_error *error) {
    tides_status status = remove_checkpoint(r, error);
    if (status == TIDES_OK) status = tides_event_writer_open(r->path, r->how.format, r->facts, &r->writer, error);
    r->done->began = status == TIDES_OK;
    return status;
}

tides_status td_record_again(td_record *r, tides_error *error) {
    tides_status status = tides_simulator_restore(r->simulator, r->facts->run, r->checkpoint, error);
    if (status != TIDES_OK) return status;
    tides_stats stats;
    tides_simulator_stats(r->simulator, &stats);
    r->done->events = stats.events_written;
    r->done->resumed_s = stats.simulated_s;
    status = td_event_writer_resume(r->path, r->facts, r->done->events, td_simulator_last(r->simulator), &r->writer, error);
    r->done->began = status == TIDES_OK;
    return status;
}

/* -- during the run  */

int td_record_take(void *user, const tides_event *events, size_t count) {
    td_record *r = user;
    r->whole = 1;
    const int64_t *fired = r->simulator ? tides_simulator_fired(r->simulator) : NULL;
    td_pool *pool = r->simulator ? td_simulator_pool(r->simulator) : NULL;
    tides_status status = td_event_writer_append(r->writer, events, fired, count, pool, &r->cause);
    if (status == TIDES_OK) r->done->events += count;
    return status;
}

tides_status td_record_judge(const td_record *r, tides_status status, tides_error *error) {
    if (r->cause.status == TIDES_OK) return status;
    if (error) *error = r->cause;
    return r->cause.status;
}

/* A tides_progress that also stops the simulator when a checkpoint is due; only between steps, since a step that is stopped
 * is lost. */
static int step(void *user, double fraction, const char *stage) {
    td_record *r = user;
    const int32_t whole = r->whole;
    r->whole = 0;
    r->stopped = r->progress ? r->progress(r->user, fraction, stage) : 0;
    return r->stopped || (whole && r->checkpoint && r->how.checkpoint_s > 0 && td_now() >= r->due);
}

/* Saves the events first and then the state, so that a matching pair exists whenever the process dies. A failure is reported
 * once, and doesn't end the run. */
static void save(td_record *r) {
    tides_error error = {TIDES_OK, ""};
    const double began = td_now();
    tides_status status = tides_event_writer_flush(r->writer, &error);
    if (status == TIDES_OK) status = tides_simulator_save(r->simulator, r->facts->run, r->checkpoint, &error);
    r->done->saved = status == TIDES_OK;
    if (!r->done->saved && r->done->unsaved.status == TIDES_OK) r->done->unsaved = error;
    const double ended = td_now();
    r->due = ended + fmax(r->how.checkpoint_s, least_work * (ended - began));
}

static tides_status simulate(td_record *r, double until, tides_error *error) {
    tides_status status = TIDES_CANCELLED;
    while (status == TIDES_CANCELLED && !r->stopped) {
        status = tides_simulator_run(r->simulator, until, td_record_take, r, step, r, error);
        status = td_record_judge(r, status, error);
        if (status == TIDES_CANCELLED && r->checkpoint && r->how.checkpoint_s > 0) save(r);
    }
    return status;
}

/* Simulates up to `stop`. The checkpoint to keep is made at the beginning of the last step. That step's end belongs to this
 * run only: `stop` may cut it short, its last nanosecond is included, and the readout gives out all that it holds. A longer
 * run has another end there. */
tides_status td_record_simulate(td_record *r, double stop, tides_error *error) {
    tides_status status = TIDES_OK;
    r->stopped = 0;
    if (r->how.keep_checkpoint) {
        status = simulate(r, td_simulator_extends_from(r->simulator, stop), error);
        if (status == TIDES_OK) save(r);
    }
    return status == TIDES_OK ? simulate(r, stop, error) : status;
}

/* -- the end  */

tides_status td_record_finish(td_record *r, tides_error *error) {
    tides_event_writer *writer = r->writer;
    r->done->collapsed = tides_event_writer_collapsed(writer);
    r->writer = NULL; /* tides_event_writer_finish frees it in any case */
    tides_status status = tides_event_writer_finish(writer, r->facts->stop_ns, error);
    r->done->complete = status == TIDES_OK;
    return status == TIDES_OK && !r->how.keep_checkpoint ? remove_checkpoint(r, error) : status;
}

void td_record_end(td_record *r) {
    tides_event_writer_abandon(r->writer);
    free(r->checkpoint);
    memset(r, 0, sizeof *r);
}

tides_status tides_simulator_write(tides_simulator *simulator, double stop, const char *path, const tides_event_file *facts,
                                   const tides_recording *how, tides_progress progress, void *user, tides_recorded *done,
                                   tides_error *error) {
    if (!simulator || !path || !facts)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_simulator_write: simulator, path or facts is NULL");
    td_record record;
    tides_status status = td_record_begin(&record, path, facts, how, progress, user, done, error);
    record.simulator = simulator;
    if (status == TIDES_OK) status = record.how.resume ? td_record_again(&record, error) : td_record_anew(&record, error);
    if (status == TIDES_OK) status = td_record_simulate(&record, stop, error);
    if (status == TIDES_OK) status = td_record_finish(&record, error);
    td_record_end(&record);
    return status;
}
