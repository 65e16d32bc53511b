/* Whole HDF5 files with false content, as event file and as frame sequence: read within the sizes that the file tells, or
 * refused in one line. */
#include "hdf5_items.h"
#include "read_events.h"

#include "tides/frames.h"

#include <math.h>

enum { PIXELS_MAX = 1 << 16 };

static void read_frames(const char *path) {
    static double Y[PIXELS_MAX];
    tides_frames *frames = NULL;
    tides_frames_options options;
    tides_error error = {TIDES_OK, ""};
    int32_t width, height;
    tides_frames_options_defaults(&options);
    tides_status status = tides_frames_open(path, &options, &frames, &error);
    if (status == TIDES_BAD_CONFIG) {
        fuzz_one_line(status, &error); /* no times */
    } else if (status != TIDES_OK) {
        fuzz_refusal(status, &error);
    } else {
        tides_frames_size(frames, &width, &height);
        size_t pixels = (size_t)width * (size_t)height;
        for (size_t k = 0; pixels <= PIXELS_MAX && k < tides_frames_count(frames) && k < 4; k++) {
            status = tides_frames_read(frames, k, Y, &error);
            if (status != TIDES_OK) fuzz_refusal(status, &error);
            for (size_t i = 0; status == TIDES_OK && i < pixels; i++)
                if (!(Y[i] >= 0) || isinf(Y[i])) abort();
        }
    }
    tides_frames_close(frames);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[FUZZ_PATH];
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    h5_make_file(fuzz_path(path, "file.h5"), data, size);
    fuzz_read_events(path, NULL, 0);
    read_frames(path);
    return 0;
}
