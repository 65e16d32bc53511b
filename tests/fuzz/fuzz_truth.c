/* Any bytes as a file of ground truth: planes with names and all their pixels, or a refusal in one line. The first byte chooses
 * the file's name, whose ending and folder decide what the values are. */
#include "fuzz.h"

#include "tides/image.h"
#include "tides/truth.h"

/* All bytes are looked at, so that what wasn't written is seen by the sanitiser. */
static volatile float sum;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const files[] = {"truth.npy", "truth.png", "disparity/truth.png", "truth.exr"};
    char path[FUZZ_PATH];
    tides_exr *planes = NULL;
    tides_error error = {TIDES_OK, ""};
    if (size < 1) return 0;
    const char *name = files[data[0] % 4];
    fuzz_put(name, data + 1, size - 1);
    tides_status status = tides_truth_read(fuzz_path(path, name), &planes, &error);
    if (status != TIDES_OK) {
        fuzz_refusal(status, &error);
        if (planes) abort();
        return 0;
    }
    int32_t width, height, count;
    tides_exr_size(planes, &width, &height, &count);
    if (width < 1 || height < 1 || count < 1) abort();
    for (int32_t c = 0; c < count; c++) {
        const float *pixels = tides_exr_pixels(planes, c);
        if (!tides_exr_name(planes, c)) abort();
        for (size_t i = 0; i < (size_t)width * (size_t)height; i++) sum = pixels[i];
    }
    tides_exr_destroy(planes);
    return 0;
}
