/* Any bytes as a camera chain of Kalibr's: read, or refused in one line. Numbers read are finite, sizes and focal lengths above
 * 0, and poses have rotations. */
#include "tests/fuzz/fuzz.h"

#include "camera/td_camchain.h"

#include <math.h>

static void check_camera(const td_camchain_camera *camera) {
    const tides_intrinsics *k = &camera->intrinsics;
    const double numbers[] = {k->fx,      k->fy,      k->cx,      k->cy,      k->lens.k1,
                              k->lens.k2, k->lens.k3, k->lens.k4, k->lens.p1, k->lens.p2};
    if (k->width < 1 || k->height < 1 || !(k->fx > 0) || !(k->fy > 0)) abort();
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (!isfinite(numbers[i])) abort();
    for (int i = 0; i < 16; i++)
        if (!isfinite(camera->T_B_C[i]) || (i % 4 < 3 && !(fabs(camera->T_B_C[i]) <= 1 + 1e-9))) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static td_camchain chain;
    tides_error error = {TIDES_OK, ""};
    char *text = malloc(size + 1);
    if (!text) return 0;
    memcpy(text, data, size);
    text[size] = '\0';
    const tides_status status = td_camchain_parse("file", text, &chain, &error);
    if (status != TIDES_OK) fuzz_refusal(status, &error);
    for (int i = 0; i < chain.count && status == TIDES_OK; i++) check_camera(&chain.camera[i]);
    if (status == TIDES_OK && (chain.count < 1 || chain.count > TD_CAMCHAIN_MOST)) abort();
    free(text);
    return 0;
}
