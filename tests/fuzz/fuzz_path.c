/* Any bytes as a camera path file: read or refused in one line; what is read has finite poses throughout, and its rotations
 * are rotations. */
#include "tides/camera.h"

#include "camera/td_path_reader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_pose(const tides_trajectory *trajectory, double time) {
    tides_pose pose;
    if (tides_trajectory_at(trajectory, time, &pose, NULL) != TIDES_OK) abort();
    for (int k = 0; k < 9; k++)
        if (!isfinite(pose.rotation_dot[k]) || !(fabs(pose.rotation[k]) <= 1.0 + 1e-12)) abort();
    for (int k = 0; k < 3; k++)
        if (!isfinite(pose.position[k]) || !isfinite(pose.position_dot[k])) abort();
}

static void check_path(const tides_path *path) {
    double start, stop;
    tides_trajectory_range(path->trajectory, &start, &stop);
    if (tides_trajectory_is_static(path->trajectory)) start = stop = 0.0;
    for (int i = 0; i <= 16; i++) check_pose(path->trajectory, i < 16 ? start + (stop - start) * (i / 16.0) : stop);
    size_t count = tides_trajectory_count(path->trajectory);
    for (size_t i = 0; i < count && i < 64; i++) {
        tides_pose_sample sample;
        if (tides_trajectory_sample(path->trajectory, i, &sample, NULL) != TIDES_OK) abort();
        check_pose(path->trajectory, sample.time);
    }
    if (!memchr(path->format, 0, sizeof path->format)) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char *text = malloc(size + 1);
    if (!text) return 0;
    memcpy(text, data, size);
    text[size] = '\0';

    tides_path_options options;
    tides_path_options_defaults(&options);
    options.rebase = size & 1; /* both ways of placing the times */
    options.views = size & 2 ? "::2,-1" : NULL;
    tides_path path = {.trajectory = NULL};
    tides_error error = {0, ""};
    tides_status status = td_path_parse("file", text, size, &options, &path, &error);
    if (status == TIDES_OK) {
        check_path(&path);
        tides_trajectory_destroy(path.trajectory);
    } else if (path.trajectory || error.status != status || !error.text[0] || strchr(error.text, '\n')) {
        abort();
    }
    free(text);
    return 0;
}
