/* The time that a user waits: from opening the device to the first event of a small scene. With kernels in the driver's cache
 * it is measured in several processes, the first of which may fill it. Without, it is measured once, with PoCL's cache in a
 * folder that is removed afterwards. The time in which the operating system loads the tool isn't included. */
#include "bench_scaling.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The time of the first event. */
static int note_first(void *user, const tides_event *events, size_t count) {
    double *first = user;
    (void)events;
    if (count && *first < 0) *first = cli_now();
    return count != 0; /* the first event stops the run */
}

static tides_status start_once(bench *b, const scaling_world *w, double *took, tides_error *error) {
    const bench_scene *s = &w->scene;
    tides_device *device = NULL;
    tides_simulator *simulator = NULL;
    double first = -1;
    const double began = cli_now();
    tides_status status = tides_device_open(b->common->device, &device, error);
    if (status == TIDES_OK)
        status = tides_simulator_create(device, s->scene, s->camera, &s->intrinsics, &s->image, &s->sensor, &w->stepping,
                                        s->start, s->stop, NULL, NULL, &simulator, error);
    if (status == TIDES_OK) status = tides_simulator_run(simulator, s->stop, note_first, &first, NULL, NULL, error);
    if (status == TIDES_CANCELLED && first >= 0) status = TIDES_OK;
    if (status == TIDES_OK && first < 0) status = cli_error(error, TIDES_BAD_ARGUMENT, "no event came: nothing to wait for");
    *took = first - began;
    tides_simulator_destroy(simulator);
    tides_device_close(device);
    return status;
}

/* Removes a folder with all that is in it. A file that can't be removed stays. */
static void remove_folder(const char *path) {
    DIR *folder = opendir(path);
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;) {
        char inner[4500];
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
        const int length = snprintf(inner, sizeof inner, "%s/%s", path, entry->d_name);
        if (length > 0 && (size_t)length < sizeof inner && unlink(inner) != 0) remove_folder(inner);
    }
    if (folder) closedir(folder);
    rmdir(path);
}

static tides_status start_without_kernels(bench *b, const scaling_world *w, scaling_result *r, tides_error *error) {
    char cache[4300];
    tides_status status = bench_path(b, "scaling_kernels", "", cache, sizeof cache, error);
    if (status == TIDES_OK) status = cli_make_directory(cache, error);
    if (status != TIDES_OK) return status;
    setenv("POCL_CACHE_DIR", cache, 1);
    status = start_once(b, w, &r->time_s, error);
    remove_folder(cache);
    return status;
}

tides_status scaling_start(bench *b, const scaling_world *w, scaling_result *r, tides_error *error) {
    const double processor = bench_processor_s(1), own = bench_processor_s(0);
    tides_status status = w->kernels ? start_without_kernels(b, w, r, error) : start_once(b, w, &r->time_s, error);
    r->processor_s = bench_processor_s(1) - processor;
    r->host_s = bench_processor_s(0) - own;
    r->runs = 1;
    return status;
}
