/* Ground truth of whole images, by a pass of its own over the splats. */
#include "td_renderer.h"
#include "tides/truth.h"

tides_status tides_renderer_truth(tides_renderer *renderer, const tides_trajectory *camera, double time,
                                  const tides_truth *truth, tides_error *error) {
    if (!renderer || !camera || !truth)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_renderer_truth: renderer, camera and truth must be given");
    const double *planes = NULL;
    int wanted = 0;
    for (int i = 0; i < TIDES_TRUTHS; i++) wanted |= truth->plane[i] != NULL;
    if (!wanted) return TIDES_OK;
    tides_status status = td_renderer_all_tiles(renderer, camera, time - renderer->epoch, TD_OUT_TRUTH, &planes, error);
    for (int i = 0; i < TIDES_TRUTHS && status == TIDES_OK; i++)
        if (truth->plane[i]) td_renderer_assemble(renderer, planes, td_plane_of_truth(i), TD_OUT_TRUTH, truth->plane[i]);
    return status;
}
