/* Progress of a renderer's work, and requests to stop, which are checked before each launch. Launches are short if somebody
 * may stop the work. */
#include "td_renderer.h"

tides_status tides_renderer_set_progress(tides_renderer *renderer, tides_progress progress, void *user, tides_error *error) {
    if (!renderer) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_renderer_set_progress: renderer must be given");
    renderer->control.share.progress = progress;
    renderer->control.share.user = user;
    return renderer->beside ? tides_renderer_set_progress(renderer->beside, progress, user, error) : TIDES_OK;
}

/* With a colour filter, the three channels are rendered one after the other, so each is a third of the work. */
void td_renderer_set_part(tides_renderer *renderer, double from, double width) {
    const double each = renderer->colour_filter ? width / 3 : width;
    for (tides_renderer *one = renderer; one; one = one->beside, from += each) {
        one->control.share.from = from;
        one->control.share.width = each;
    }
}

int td_renderer_record_limit(const tides_renderer *renderer) {
    const td_renderer_control *control = &renderer->control;
    const int waited_for = control->share.progress || control->interrupt;
    return waited_for && control->record_limit < renderer->record_limit ? control->record_limit : renderer->record_limit;
}

tides_status td_renderer_check_stop(const tides_renderer *renderer, double done, tides_error *error) {
    const td_renderer_control *control = &renderer->control;
    td_share share = control->share;
    const int stop = (control->interrupt && control->interrupt(control->user)) || td_share_step(&share, done, NULL);
    return stop ? td_fail(error, TIDES_CANCELLED, "stopped on request") : TIDES_OK;
}
