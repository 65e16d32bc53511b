/* Checkpoints of a running job: EVENTS.h5.checkpoint beside EVENTS.h5.part. */
#include "session.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A checkpoint that takes long, of a large image on a slow disk, comes less often: this much simulation per second of saving.
 * */
static const double least_work = 50.0;

tides_status cli_checkpoint_begin(cli_checkpoint *c, const char *events, double every, cli_progress *progress,
                                  tides_error *error) {
    static const char ending[] = ".checkpoint";
    size_t bytes = strlen(events) + sizeof ending;
    memset(c, 0, sizeof *c);
    c->path = malloc(bytes);
    if (!c->path) return cli_error(error, TIDES_NO_MEMORY, "out of memory: %s", events);
    snprintf(c->path, bytes, "%s%s", events, ending);
    c->every = every;
    c->due = cli_now() + every;
    c->progress = progress;
    return TIDES_OK;
}

int cli_checkpoint_exists(const cli_checkpoint *c) { return access(c->path, F_OK) == 0; }

tides_status cli_checkpoint_remove(const cli_checkpoint *c, tides_error *error) {
    if (remove(c->path) == 0 || errno == ENOENT) return TIDES_OK;
    return cli_error(error, TIDES_WRITE_FAILED, "%s: can't be removed: %s", c->path, strerror(errno));
}

int cli_checkpoint_step(void *user, double fraction, const char *stage) {
    cli_checkpoint *c = user;
    c->interrupted = cli_progress_step(c->progress, fraction, stage);
    return c->interrupted || (c->every > 0 && cli_now() >= c->due);
}

/* First the events, then the state that follows them: whatever the process dies between leaves a pair that fits. */
void cli_checkpoint_save(cli_checkpoint *c, const tides_simulator *simulator, tides_event_writer *writer,
                         const cli_session *session) {
    if (!(c->every > 0)) return;
    tides_error error = {TIDES_OK, ""};
    double began = cli_now();
    tides_status status = tides_event_writer_flush(writer, &error);
    if (status == TIDES_OK) status = tides_simulator_save(simulator, session->values.json, c->path, &error);
    c->saved = status == TIDES_OK;
    if (!c->saved && !c->warned) { /* no reason to throw the run away */
        cli_progress_end(c->progress);
        cli_failed("no checkpoint, the run goes on: %s", error.text);
        c->warned = 1;
    }
    double ended = cli_now();
    c->due = ended + fmax(c->every, least_work * (ended - began));
}

void cli_checkpoint_end(cli_checkpoint *c) {
    free(c->path);
    memset(c, 0, sizeof *c);
}
