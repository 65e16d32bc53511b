/* Any bytes as a PNG picture of a frame sequence: values of the size that it tells, or a refusal in one line. */
#include "fuzz.h"

#include "frames/td_frames.h"

#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[FUZZ_PATH];
    td_picture_values picture = {.values = NULL};
    tides_error error = {TIDES_OK, ""};
    fuzz_put("0.png", data, size);
    tides_status status = td_frame_png(fuzz_path(path, "0.png"), &picture, &error);
    if (status != TIDES_OK) {
        fuzz_refusal(status, &error);
        if (picture.values) abort();
        return 0;
    }
    if (picture.channels != 1 && picture.channels != 3) abort();
    size_t count = (size_t)picture.width * (size_t)picture.height * (size_t)picture.channels;
    for (size_t i = 0; i < count; i++)
        if (!(picture.values[i] >= 0 && picture.values[i] <= 1)) abort();
    free(picture.values);
    return 0;
}
