/* Any bytes as IEBCS's noise histograms: a simulator whose noise has rates of its bins, or a refusal in one line. */
#include "fuzz.h"

#include "tides/baselines.h"

enum { SIDE = 3 };

static int take(void *user, const tides_event *events, size_t count) {
    (void)user;
    for (size_t i = 0; i < count; i++)
        if (events[i].cause != TIDES_CAUSE_SHOT || events[i].x >= SIDE || events[i].y >= SIDE || events[i].t < 0) abort();
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[FUZZ_PATH];
    tides_baseline_params params;
    tides_baseline *baseline = NULL;
    tides_error error = {TIDES_OK, ""};
    const double Y[SIDE * SIDE] = {0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5};
    fuzz_put("noise.npy", data, size);
    tides_baseline_params_defaults(&params);
    params.method = TIDES_METHOD_IEBCS;
    params.iebcs.noise_neg = fuzz_path(path, "noise.npy");
    params.iebcs.bgnp = 0;
    tides_status status = tides_baseline_create(&params, SIDE, SIDE, &baseline, &error);
    if (status != TIDES_OK) {
        fuzz_refusal(status, &error);
        if (baseline) abort();
        return 0;
    }
    for (int k = 0; k < 3; k++)
        if (tides_baseline_push(baseline, 0.05 * k, Y, take, NULL, &error) != TIDES_OK) abort();
    if (tides_baseline_finish(baseline, take, NULL, &error) != TIDES_OK) abort();
    tides_baseline_destroy(baseline);
    return 0;
}
