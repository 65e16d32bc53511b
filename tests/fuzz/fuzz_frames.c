/* Any files as a frame sequence: a folder with its timestamps, .npy, .npz or .y4m. The frames have one size, are finite and not
 * negative, at ascending times; or there is a refusal in one line. The first byte chooses the path that is opened, the second
 * how values and times are read; the rest is a list of files. */
#include "fuzz.h"

#include "tides/frames.h"

#include <math.h>

static const char *const files[] =
    {"folder/0.png", "folder/1.png",   "folder/0.exr", "folder/timestamps.txt", "folder/image_timestamps.txt", "array.npy",
     "array.npz",    "timestamps.txt", "video.y4m"};
enum { FILES = sizeof files / sizeof *files, PIXELS_MAX = 1 << 20, FRAMES_READ = 4 };

static void read_all(tides_frames *frames) {
    tides_error error = {TIDES_OK, ""};
    int32_t width, height;
    size_t count = tides_frames_count(frames);
    tides_frames_size(frames, &width, &height);
    size_t pixels = (size_t)width * (size_t)height;
    if (count < 1 || width < 1 || height < 1) abort();
    for (size_t k = 0; k < count; k++)
        if (!isfinite(tides_frames_time(frames, k)) ||
            (k && !(tides_frames_time(frames, k) > tides_frames_time(frames, k - 1))))
            abort();
    double *Y = pixels <= PIXELS_MAX ? malloc(pixels * sizeof *Y) : NULL;
    for (size_t k = 0; Y && k < count && k < FRAMES_READ; k++) {
        tides_status status = tides_frames_read(frames, k, Y, &error);
        if (status != TIDES_OK) fuzz_refusal(status, &error);
        for (size_t i = 0; status == TIDES_OK && i < pixels; i++)
            if (!(Y[i] >= 0) || isinf(Y[i])) abort();
    }
    free(Y);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const opened[] = {"folder", "array.npy", "array.npz", "video.y4m"};
    char path[FUZZ_PATH], times[FUZZ_PATH];
    tides_frames *frames = NULL;
    tides_frames_options options;
    tides_error error = {TIDES_OK, ""};
    if (size < 2) return 0;
    tides_frames_options_defaults(&options);
    options.transfer = data[1] & 1;
    options.rebase = data[1] >> 1 & 1;
    options.unit = (data[1] >> 2 & 7) % (TIDES_TIME_NS + 1);
    fuzz_put_row(files, FILES, data + 2, size - 2);
    if (data[1] & 32) options.timestamps = fuzz_path(times, "timestamps.txt");
    if (data[1] & 64) options.frames_per_second = 30;
    tides_status status = tides_frames_open(fuzz_path(path, opened[data[0] % 4]), &options, &frames, &error);
    if (status == TIDES_OK) {
        read_all(frames);
    } else {
        if (frames) abort();
        if (status == TIDES_FILE_NOT_FOUND || status == TIDES_BAD_CONFIG) /* no such file; no times */
            fuzz_one_line(status, &error);
        else
            fuzz_refusal(status, &error);
    }
    tides_frames_close(frames);
    return 0;
}
