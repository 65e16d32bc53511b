/* Leaves out Gaussians that can't be rendered, for files with a few broken rows. Each is checked alone, by the same rules as
 * whole sets. */
#include "td_base.h"
#include "td_scene.h"

#include <string.h>

/* A view of Gaussian i only. */
static td_gaussians one_of(const td_gaussians *g, size_t i) {
    td_gaussians one = *g;
    one.count = 1;
    one.mean += 3 * i;
    one.log_scale += 3 * i;
    one.quaternion += 4 * i;
    one.opacity_logit += i;
    one.sh += 3 * td_sh_coefficients(g->sh_degree) * i;
    if (one.mean_double) one.mean_double += 3 * i;
    return one;
}

void td_gaussians_move(const td_gaussians *g, size_t to, size_t from) {
    const size_t width = 3 * td_sh_coefficients(g->sh_degree);
    memmove(g->mean + 3 * to, g->mean + 3 * from, 3 * sizeof *g->mean);
    memmove(g->log_scale + 3 * to, g->log_scale + 3 * from, 3 * sizeof *g->log_scale);
    memmove(g->quaternion + 4 * to, g->quaternion + 4 * from, 4 * sizeof *g->quaternion);
    g->opacity_logit[to] = g->opacity_logit[from];
    memmove(g->sh + width * to, g->sh + width * from, width * sizeof *g->sh);
    if (g->mean_double) memmove(g->mean_double + 3 * to, g->mean_double + 3 * from, 3 * sizeof *g->mean_double);
}

tides_status td_gaussians_drop(td_gaussians *gaussians, double scale, int64_t *dropped, tides_error *error) {
    tides_error first = {TIDES_OK, ""};
    size_t kept = 0;
    const size_t count = (size_t)gaussians->count;
    tides_status status = td_gaussians_check(gaussians, scale, TIDES_BAD_FILE, &first);
    *dropped = 0;
    if (status == TIDES_OK) return status;
    for (size_t i = 0; i < count; i++) {
        const td_gaussians one = one_of(gaussians, i);
        if (td_gaussians_check(&one, scale, TIDES_BAD_FILE, NULL) != TIDES_OK) continue;
        if (kept != i) td_gaussians_move(gaussians, kept, i);
        kept++;
    }
    if (kept == 0) return td_fail(error, TIDES_BAD_FILE, "none of its %zu Gaussians can be rendered: %s", count, first.text);
    gaussians->count = (int64_t)kept;
    *dropped = (int64_t)(count - kept);
    return td_note(&gaussians->notes, error, "%lld of %zu Gaussians are left out (scene.invalid = drop), such as this: %.250s",
                   (long long)*dropped, count, first.text);
}
