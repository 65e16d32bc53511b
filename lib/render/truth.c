/* Ground truth of whole images (kernels/truth.h), and what its planes are called. */
#include "td_renderer.h"
#include "tides/truth.h"

/* Each plane's name, and where it is among a backend's: the one table of both. */
static const struct truth {
    const char *name;
    int plane;
} truths[TIDES_TRUTHS] = {{"flow_u", TD_TRUTH_U},    {"flow_v", TD_TRUTH_V},
                          {"depth", TD_TRUTH_DEPTH}, {"depth_median", TD_TRUTH_MEDIAN},
                          {"alpha", TD_TRUTH_ALPHA}, {"instance", TD_TRUTH_INSTANCE},
                          {"normal_x", TD_TRUTH_NX}, {"normal_y", TD_TRUTH_NY},
                          {"normal_z", TD_TRUTH_NZ}};

const char *tides_truth_name(int32_t truth) { return truth >= 0 && truth < TIDES_TRUTHS ? truths[truth].name : NULL; }

const char *td_truth_name(int plane) {
    for (int i = 0; i < TIDES_TRUTHS; i++)
        if (truths[i].plane == plane) return truths[i].name;
    return "splat";
}

void td_truth_of_nothing(double *planes) {
    memset(planes, 0, TD_OUT_TRUTH * sizeof *planes);
    planes[TD_TRUTH_INSTANCE] = planes[TD_TRUTH_SPLAT] = -1;
}

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
        if (truth->plane[i]) td_renderer_assemble(renderer, planes, truths[i].plane, TD_OUT_TRUTH, truth->plane[i]);
    return status;
}
