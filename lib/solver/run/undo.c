/* Stops a run in the middle of a step. A macro step of a large scene takes seconds, so that progress is asked before each of
 * its launches. A step that is stopped there is undone: only between steps is there a state to go on from, here or from a
 * checkpoint.
 *
 * The kept state is the table that checkpoints save, so that a new array needs no further code. Each step copies some 40 bytes
 * per ideal pixel, a thousandth of the time of its renders. */
#include "solver/td_simulator.h"

/* Launches assumed for the first step; for later steps, the number of the step before. */
static const int64_t usual_at_first = 16;

/* -- progress -------------------------------------------------------------------------------------------------------------- */

/* A td_interrupt, called before a launch; it asks only from a step's second launch on. The number of launches to come isn't
 * known. After as many as the last step took, half of this step counts as done, so that progress never goes back. */
static int ask(void *user) {
    const tides_simulator *s = user;
    td_run_progress *progress = &((tides_simulator *)user)->progress;
    if (progress->launches++ == 0) return 0;
    const double done = (double)progress->launches, part = done / (done + (double)progress->usual);
    progress->stopped = progress->call(progress->user, ((double)s->step + part) / (double)s->grid.steps, "simulating") != 0;
    return progress->stopped;
}

void td_progress_begin(tides_simulator *s, tides_progress progress, void *user) {
    s->progress = (td_run_progress){progress, user, 0, usual_at_first, 0};
    if (progress) td_renderer_set_interrupt(s->renderer, ask, s);
}

void td_progress_step(tides_simulator *s) {
    if (s->progress.launches > 0) s->progress.usual = s->progress.launches;
    s->progress.launches = 0;
}

void td_progress_end(tides_simulator *s) {
    s->progress.call = NULL;
    td_renderer_set_interrupt(s->renderer, NULL, NULL);
}

/* -- undoing --------------------------------------------------------------------------------------------------------------- */

static size_t bytes_of(const td_state_row *row) { return row->count * td_state_size(row->type); }

/* The table of arrays as they are now: some of them swap places during a run. */
static td_state table_of(tides_simulator *s) {
    td_state state = {.rows = 0};
    td_simulator_state(s, &state);
    return state;
}

tides_status td_undo_keep(tides_simulator *s, tides_error *error) {
    td_undo *undo = &s->undo;
    if (!s->progress.call) return TIDES_OK;
    const td_state state = table_of(s);
    size_t bytes = 0, at = 0;
    if (state.lost > 0) return td_fail(error, TIDES_NO_MEMORY, "the table of state has no room for %d rows", state.lost);
    for (int i = 0; i < state.rows; i++) bytes += bytes_of(&state.row[i]);
    tides_status status = td_renew((void **)&undo->bytes, &undo->capacity, bytes, 1, error);
    if (status != TIDES_OK) return status;
    for (int i = 0; i < state.rows; at += bytes_of(&state.row[i++]))
        memcpy(undo->bytes + at, state.row[i].values, bytes_of(&state.row[i]));
    td_stats_take(s, &undo->stats);
    undo->counts = s->done.work.counts;
    undo->render = td_renderer_counts(s->renderer);
    return TIDES_OK;
}

void td_undo_stopped(tides_simulator *s, tides_status status) {
    const td_undo *undo = &s->undo;
    if (status != TIDES_CANCELLED || !s->progress.call) return;
    const td_state state = table_of(s);
    size_t at = 0;
    for (int i = 0; i < state.rows; at += bytes_of(&state.row[i++]))
        memcpy(state.row[i].values, undo->bytes + at, bytes_of(&state.row[i]));
    td_sensor_resume(&s->sensor);
    td_surround_steps_resume(s);
    s->done.work.counts = undo->counts;
    td_stats_put(s, &undo->stats);
    td_renderer_put_counts(s->renderer, &undo->render);
    s->done.work.events.count = 0;
    s->broken = 0;
}
