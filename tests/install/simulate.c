/* Simulates a run file and counts its events: the example of the README. usage: simulate RUN.json */
#include <stdio.h>
#include <tides.h>

static int count(void *total, const tides_event *events, size_t n) {
    for (size_t i = 0; i < n; i++) ((size_t *)total)[events[i].polarity > 0]++;
    return 0;
}

int main(int argc, char **argv) {
    tides_error error = {0};
    tides_run *run = NULL;
    tides_run_values v = {0};
    tides_scene *scene = NULL;
    tides_trajectory *camera = NULL;
    tides_intrinsics lens;
    tides_device *device = NULL;
    tides_simulator *simulator = NULL;
    size_t total[2] = {0, 0};
    int failed = argc != 2 || tides_run_load(argv[1], NULL, 0, &run, &error);
    if (!failed) tides_run_get(run, &v);
    failed = failed || tides_run_open(run, &scene, &camera, &lens, &error) || tides_device_open(v.device, &device, &error) ||
             tides_simulator_create(device, scene, camera, &lens, &v.image, &v.sensor, &v.stepping, v.start, v.stop, NULL, NULL,
                                    &simulator, &error) ||
             tides_simulator_run(simulator, v.stop, count, total, NULL, NULL, &error);
    if (failed)
        fprintf(stderr, "%s\n", error.text);
    else
        printf("%zu ON and %zu OFF events\n", total[1], total[0]);
    tides_simulator_destroy(simulator);
    tides_device_close(device);
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
    tides_run_destroy(run);
    return failed;
}
