/* A motion by a function: parameters are sums of sines. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/pulsing_callback.h"

#include "tests/support/scene_folder.h"

#include <math.h>

/* Adds `value` to `rows` values, and `rate` to their rates. */
static void add(double value, double rate, double *values, double *rates, int rows) {
    for (int k = 0; k < rows; k++) {
        values[k] += value;
        rates[k] += rate;
    }
}

/* q becomes (cos(angle / 2), 0, 0, sin(angle / 2)) q. */
static void turn_about_z(double angle, double angle_dot, double *q, double *q_dot) {
    const double c = cos(0.5 * angle), s = sin(0.5 * angle), w = 0.5 * angle_dot;
    const double own[4] = {q[0], q[1], q[2], q[3]}, ahead[4] = {-own[3], -own[2], own[1], own[0]};
    for (int k = 0; k < 4; k++) {
        q[k] = c * own[k] + s * ahead[k];
        q_dot[k] = w * (c * ahead[k] - s * own[k]);
    }
}

static tides_status pulse(void *user, double time, int32_t side, const int32_t *index, int64_t count, const tides_theta *theta,
                          tides_error *error) {
    const pulsing *p = user;
    double rate[5];
    const double logit = waves_at(&p->logit, time, &rate[0]), size = waves_at(&p->log_size, time, &rate[1]);
    const double turn = waves_at(&p->turn, time, &rate[2]), light = waves_at(&p->light, time, &rate[3]);
    (void)side, (void)index, (void)error;
    for (int64_t i = 0; i < count; i++) {
        add(logit, rate[0], theta->opacity_logit + i, theta->opacity_logit_dot + i, 1);
        add(size, rate[1], theta->log_scale + 3 * i, theta->log_scale_dot + 3 * i, 3);
        turn_about_z(turn, rate[2], theta->quaternion + 4 * i, theta->quaternion_dot + 4 * i);
        for (int k = 0; k < 2; k++) {
            const double shift = waves_at(&p->shift[k], time, &rate[4]);
            add(shift, rate[4], theta->mean + 3 * i + k, theta->mean_dot + 3 * i + k, 1);
        }
        for (int k = 0; k < 3; k++) { /* colour = 1/2 + SH0 sh */
            const double colour = 0.5 + WORLD_SH0 * theta->sh[3 * i + k];
            add(light * colour / WORLD_SH0, rate[3] * colour / WORLD_SH0, theta->sh + 3 * i + k, theta->sh_dot + 3 * i + k, 1);
        }
    }
    return TIDES_OK;
}

tides_motion *pulsing_callback(const splat_set *set, const pulsing *p, double duration_s, double time_scale) {
    const tides_callback_motion callback = {.count = set->count,
                                            .stop = duration_s,
                                            .function = pulse,
                                            .user = (void *)(uintptr_t)p,
                                            .moves_sh = 1,
                                            .time_scale = time_scale};
    tides_motion *motion = NULL;
    tides_error error;
    scene_expect_ok(tides_motion_create_callback(&callback, &motion, &error), &error);
    return motion;
}
