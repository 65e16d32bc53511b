/* Times Theta and Theta_dot of deformation networks on a device: 4DGaussians with D-NeRF's sizes, random weights.
 *   bench_motion [DEVICE] [GAUSSIANS]
 * Printed: best and median of alternating rounds, for all Gaussians and for 1 % of them; the share of what the same device's
 * fma units give in the same rounds. */
#include "tests/support/motion_device.h"
#include "tests/support/random_motion.h"

#include "motion/td_hexplane.h"

#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 15, JOB = 256 };

static void stop_on(tides_status status, const tides_error *error) {
    if (status == TIDES_OK) return;
    fprintf(stderr, "bench_motion: %s\n", error->text);
    exit(1);
}

int main(int count, char **words) {
    tides_device *device = NULL;
    tides_error error = {0};
    int gaussians = count > 2 ? atoi(words[2]) : 100000;
    stop_on(tides_device_open(count > 1 ? words[1] : "cpu", &device, &error), &error);
    int lanes = getenv("LANES") ? atoi(getenv("LANES")) : 16;
    device->info.lanes = lanes;
    random_hexplane_recipe recipe = random_hexplane_defaults(1);
    tides_motion *motion = random_hexplane_make(&recipe);
    random_gaussians some = random_gaussians_make(2, gaussians, 0, 1.7);
    double begun = td_now();
    packed_motion packed = packed_motion_make(motion, &some.view);
    printf("pack %.3f s, %.1f MB\n", td_now() - begun, (double)packed.numbers.data_count * 8e-6);
    motion_device on = motion_device_make(device, &packed, (gaussians + 15) / 16 * 16, 0);
    double best = 1e9, best1 = 1e9;
    int *index = calloc(gaussians / 100 + 1, sizeof *index);
    for (int i = 0; i < gaussians / 100; i++) index[i] = i * 100;
    for (int r = 0; r < ROUNDS; r++) {
        motion_device_set(&on, NULL, gaussians, JOB);
        double s = motion_device_run(&on, 0.37, 1);
        if (s < best) best = s;
        motion_device_set(&on, index, gaussians / 100, 32);
        s = motion_device_run(&on, 0.37, 1);
        if (s < best1) best1 = s;
    }
    printf("lanes %d: all %.2f ms, 1%% %.3f ms\n", lanes, best * 1e3, best1 * 1e3);
    return 0;
}
