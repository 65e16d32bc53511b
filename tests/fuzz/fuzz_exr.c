/* Any bytes as an OpenEXR file: channels with names and all their pixels, or a refusal in one line. */
#include "fuzz.h"

#include "tides/image.h"

/* All bytes are looked at, so that what wasn't written is seen by the sanitiser. */
static volatile float sum;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[FUZZ_PATH];
    tides_exr *exr = NULL;
    tides_error error = {TIDES_OK, ""};
    fuzz_put("0.exr", data, size);
    tides_status status = tides_exr_read(fuzz_path(path, "0.exr"), &exr, &error);
    if (status != TIDES_OK) {
        fuzz_refusal(status, &error);
        if (exr) abort();
        return 0;
    }
    int32_t width, height, channels;
    tides_exr_size(exr, &width, &height, &channels);
    if (width < 1 || height < 1 || channels < 1) abort();
    for (int32_t c = 0; c < channels; c++) {
        const float *pixels = tides_exr_pixels(exr, c);
        if (!tides_exr_name(exr, c)) abort();
        for (size_t i = 0; i < (size_t)width * (size_t)height; i++) sum = pixels[i];
    }
    tides_exr_destroy(exr);
    return 0;
}
