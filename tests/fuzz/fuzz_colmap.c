/* Any bytes as COLMAP's cameras or images, text or binary: the first byte chooses. Images refer to one camera, number 1. */
#include "fuzz.h"

#include "camera/td_colmap.h"
#include "camera/td_path_reader.h"

static void fuzz_cameras(const char *text, size_t bytes, int binary) {
    td_colmap_cameras cameras = {NULL, 0, 0};
    tides_error error = {0, ""};
    tides_status status = td_colmap_parse_cameras("file", text, bytes, binary, &cameras, &error);
    if (status != TIDES_OK) {
        fuzz_one_line(status, &error);
        if (cameras.list) abort();
        return;
    }
    for (size_t i = 0; i < cameras.count; i++)
        if (cameras.list[i].intrinsics.width < 1 || !(cameras.list[i].intrinsics.fx > 0)) abort();
    free(cameras.list);
}

static void fuzz_images(const char *text, size_t bytes, int binary) {
    td_colmap_camera camera = {.id = 1,
                               .intrinsics = {.width = 640, .height = 480, .fx = 500, .fy = 500, .cx = 320, .cy = 240}};
    const td_colmap_cameras cameras = {&camera, 1, 1};
    tides_path_options options;
    tides_path_options_defaults(&options);
    tides_error error = {0, ""};
    td_path_reader reader = {.file = "file", .text = text, .bytes = bytes, .options = &options, .error = &error};
    tides_status status = td_path_read_images(&reader, binary, &cameras);
    if (status != TIDES_OK) fuzz_one_line(status, &error);
    for (size_t i = 0; status == TIDES_OK && i < reader.count; i++)
        if (!(reader.samples[i].time >= 0 && reader.samples[i].time <= 1)) abort();
    free(reader.samples);
    free(reader.views);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (size == 0) return 0;
    char *text = malloc(size);
    if (!text) return 0;
    memcpy(text, data + 1, size - 1);
    text[size - 1] = '\0';
    if (data[0] & 2)
        fuzz_images(text, size - 1, data[0] & 1);
    else
        fuzz_cameras(text, size - 1, data[0] & 1);
    free(text);
    return 0;
}
