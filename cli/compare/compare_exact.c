/* The exact stream of a comparison: that of the ideal pixel with the run's thresholds (tides_session_exact).
 *
 * On a scene, the cubic under error control is refined until halving the steps no longer moves events, or up to the limit of
 * single precision or of 500 full renders per level. The results report how far the last halving moved events. Rounding to
 * single precision moves events of slow pixels by a fraction of a microsecond, in methods and exact stream alike; --double
 * computes the exact stream in double. On frames, the exact stream is that of straight lines in log luminance from frame to
 * frame, in double precision, since the light between frames isn't known. */
#include "compare.h"

const char *compare_exact_what(const comparison *c) {
    if (c->session.frames) return "straight lines in log luminance between the frames";
    return c->exact.tolerance > 0 ? "cubic under error control, its steps halved" : "cubic on equal steps, halved";
}

const char *compare_exact_name(const comparison *c) { return c->session.frames ? "lines" : "exact"; }

tides_status compare_exact(comparison *c, tides_error *error) {
    tides_exact_options how;
    tides_error reason = {TIDES_OK, ""};
    tides_session *ideal = NULL; /* for the file's facts alone */
    tides_session_facts facts;
    if (!c->with_exact) return TIDES_OK;
    c->progress.label = "exact";
    tides_exact_options_defaults(&how);
    how.in_double = c->in_double;
    tides_status status = tides_session_exact(c->open, &how, cli_progress_step, &c->progress, &c->exact, &reason);
    cli_progress_end(&c->progress);
    if (status != TIDES_OK) return cli_error(error, status, "%s: %s", c->run, reason.text);
    if (!c->keep) return TIDES_OK;
    status = compare_configure(c, "tides", TIDES_IDEAL_PIXEL, NULL, NULL, &ideal, error);
    if (status != TIDES_OK) return status;
    tides_session_get(ideal, &facts);
    status = compare_keep_events(c, compare_exact_name(c), &facts, c->exact.events, c->exact.count, error);
    tides_session_close(ideal);
    return status;
}
