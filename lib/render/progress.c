/* Progress of a renderer's work, and requests to stop, which are checked before each launch. Launches are short if somebody
 * may stop the work. */
#include "td_renderer.h"

tides_status tides_renderer_set_progress(tides_renderer *renderer, tides_progress progress, void *user, tides_error *error) {
    if (!renderer) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_renderer_set_progress: renderer must be given");
    renderer->told.progress = progress;
    renderer->told.user = user;
    return renderer->beside ? tides_renderer_set_progress(renderer->beside, progress, user, error) : TIDES_OK;
}

/* With a colour filter, the three channels are rendered one after the other, so each is a third of the work. */
void td_renderer_set_part(tides_renderer *renderer, double from, double width) {
    const double each = renderer->colour_filter ? width / 3 : width;
    for (tides_renderer *one = renderer; one; one = one->beside, from += each) {
        one->told.from = from;
        one->told.width = each;
    }
}

int td_renderer_record_limit(const tides_renderer *renderer) {
    const int waited_for = renderer->told.progress || renderer->heed, told = renderer->record_limit_told;
    return waited_for && told < renderer->record_limit ? told : renderer->record_limit;
}

tides_status td_renderer_heed(const tides_renderer *renderer, double done, tides_error *error) {
    td_share told = renderer->told;
    const int stop = (renderer->heed && renderer->heed(renderer->heed_user)) || td_share_step(&told, done, NULL);
    return stop ? td_fail(error, TIDES_CANCELLED, "stopped on request") : TIDES_OK;
}
