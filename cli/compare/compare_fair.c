/* Chooses the part of a recording and of the streams that is compared, and runs methods for that part alone. Time: the
 * stretch that both have, or the one that was asked for. Pixels: neither masked nor hot. Events: none in bursts that the
 * readout of frames makes. */
#include "compare.h"

#include <stdlib.h>
#include <string.h>

void compare_interval(const comparison *c, int32_t reference, int64_t *start_ns, int64_t *stop_ns) {
    *start_ns = reference == COMPARE_RECORDING ? c->fair.start_ns : cli_nanoseconds(c->session.values.start);
    *stop_ns = reference == COMPARE_RECORDING ? c->fair.stop_ns : cli_nanoseconds(c->session.values.stop) + 1;
}

static int32_t counts(const comparison *c, const tides_event *e) {
    const compare_fair *f = &c->fair;
    if (e->t < f->start_ns || e->t >= f->stop_ns) return 0;
    return !f->mask || f->mask[(size_t)e->y * (size_t)c->session.intrinsics.width + e->x];
}

tides_status compare_fair_events(const comparison *c, const cli_stream *stream, cli_stream *kept, tides_error *error) {
    *kept = (cli_stream){.events = malloc((stream->count + 1) * sizeof *kept->events)};
    if (!kept->events) return cli_error(error, TIDES_NO_MEMORY, "out of memory: events that are compared");
    for (size_t i = 0; i < stream->count; i++)
        if (counts(c, &stream->events[i])) kept->events[kept->count++] = stream->events[i];
    kept->count = tides_blemishes_leave_out(&c->fair.blemishes, kept->events, kept->count);
    return TIDES_OK;
}

tides_status compare_run_fair(comparison *c, const compare_row *row, const cli_list *more, cli_stream *kept,
                              tides_error *error) {
    cli_stream stream = {.events = NULL};
    tides_session *session = NULL;
    tides_status status = compare_configure(c, row->name, compare_ideal(c), more, NULL, &session, error);
    if (status == TIDES_OK)
        status = tides_session_run(session, cli_keep, &stream, cli_progress_step, &c->progress, NULL, error);
    cli_progress_end(&c->progress);
    tides_session_close(session);
    if (status == TIDES_OK) status = compare_fair_events(c, &stream, kept, error);
    free(stream.events);
    return status;
}

/* -- the recording ------------------------------------------------------------------------------------------------------ */

static tides_status check_size(const comparison *c, tides_error *error) {
    const cli_window *w = &c->recording;
    const tides_intrinsics *size = &c->session.intrinsics;
    const int32_t said = w->facts.width > 0; /* otherwise the size comes from the events */
    if (w->width > size->width || w->height > size->height)
        return cli_error(error, TIDES_BAD_ARGUMENT, "%s: is %dx%d px and the run %dx%d px: tides cut --roi makes it as small",
                         c->recording_file, w->width, w->height, size->width, size->height);
    if (said && (w->width < size->width || w->height < size->height))
        return cli_error(error, TIDES_BAD_ARGUMENT,
                         "%s: is %dx%d px and the run %dx%d px: camera.width and height are the sensor's", c->recording_file,
                         w->width, w->height, size->width, size->height);
    return TIDES_OK;
}

/* The recording's own interval: that of the file, or else that of its events. */
static void set_interval(comparison *c) {
    compare_fair *f = &c->fair;
    const cli_window *w = &c->recording;
    const int32_t known = w->run_start_ns < w->run_stop_ns;
    const int64_t first = known ? w->run_start_ns : w->events[0].t;
    const int64_t stop = known ? w->run_stop_ns : w->events[w->count - 1].t + 1;
    if (!f->start && first > f->start_ns) f->start_ns = first;
    if (!f->stop && stop < f->stop_ns) f->stop_ns = stop;
}

static tides_status no_events(const comparison *c, tides_error *error) {
    const cli_window *w = &c->recording;
    const int32_t asked = c->fair.start || c->fair.stop;
    return cli_error(error, TIDES_BAD_ARGUMENT,
                     "%s: lasts from %.15g to %.15g s and has no events from %.15g to %.15g s, %s: tides "
                     "convert --rebase counts from its zero, --offset shifts it",
                     c->recording_file, 1e-9 * (double)w->seen_ns, 1e-9 * (double)w->seen_stop_ns, 1e-9 * (double)w->first_ns,
                     1e-9 * (double)(w->stop_ns - !c->fair.stop), asked ? "which is what is asked for" : "the run's time");
}

/* Limits the interval to --start and --stop, and to the run's time. */
static tides_status set_asked(comparison *c, tides_error *error) {
    compare_fair *f = &c->fair;
    int64_t first, stop;
    compare_interval(c, COMPARE_EXACT, &first, &stop);
    if (!f->start) f->start_ns = first;
    if (!f->stop) f->stop_ns = stop;
    if (f->start_ns >= first && f->stop_ns <= stop && f->start_ns < f->stop_ns) return TIDES_OK;
    return cli_error(error, TIDES_BAD_ARGUMENT, "--start and --stop: %.15g to %.15g s isn't within the run's %.15g to %.15g s",
                     1e-9 * (double)f->start_ns, 1e-9 * (double)f->stop_ns, c->session.values.start, c->session.values.stop);
}

/* Removes events of masked pixels, before bursts and hot pixels are looked for. */
static void leave_masked(comparison *c) {
    cli_window *w = &c->recording;
    size_t kept = 0;
    for (size_t i = 0; i < w->count; i++)
        if (counts(c, &w->events[i])) w->events[kept++] = w->events[i];
    c->fair.masked = w->count - kept;
    w->count = kept;
}

tides_status compare_read(comparison *c, tides_error *error) {
    cli_window *w = &c->recording;
    compare_fair *f = &c->fair;
    if (!c->recording_file) return TIDES_OK;
    tides_status status = set_asked(c, error);
    w->first_ns = f->start_ns;
    w->stop_ns = f->stop_ns;
    w->how = &f->how;
    if (status == TIDES_OK) status = cli_window_read(c->recording_file, w, error);
    if (status == TIDES_OK) status = cli_window_ordered(c->recording_file, w, error);
    if (status == TIDES_OK && w->count == 0) return no_events(c, error);
    if (status == TIDES_OK) status = check_size(c, error);
    if (status == TIDES_OK) status = compare_mask_read(f, c->session.intrinsics.width, c->session.intrinsics.height, error);
    if (status != TIDES_OK) return status;
    set_interval(c);
    leave_masked(c);
    if (f->all) return TIDES_OK;
    status = tides_blemishes_find(w->events, w->count, c->session.intrinsics.width, c->session.intrinsics.height, &f->blemishes,
                                  error);
    if (status == TIDES_OK) w->count = tides_blemishes_leave_out(&f->blemishes, w->events, w->count);
    if (status == TIDES_OK && w->count == 0)
        return cli_error(error, TIDES_BAD_ARGUMENT, "%s: nothing is left of it without bursts, hot and masked pixels",
                         c->recording_file);
    return status;
}
