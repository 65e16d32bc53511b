/* Paths of cameras and objects in generated worlds, sampled from formulas that also give exact rates. Objects that swing or
 * fall have no closed formula: a small integrator computes their motion. */
#include "generate/td_generate.h"
#include "td_base.h"
#include "td_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A path is a quintic spline through samples, with its largest errors in the first and last segment. This number of samples
 * keeps the two segments apart on short paths. */
#define FEWEST_SAMPLES 9
#define MOST_SAMPLES 5e6 /* 2.3 GB with the path that is made of them */
/* Longest step of the integrator [s]. The fastest motion is a ball's bounce, a half period of 15 ms: 60 steps. A step of
 * fourth order within it has an error of 3e-9 of its amplitude, (pi / 60)^5 / 120. */
#define STEP_S 0.00025

tides_status td_sample_path(td_pose_at pose, void *shape, const tides_generate_options *options, double step,
                            tides_trajectory **path, tides_error *error) {
    const double steps = ceil(options->duration_s * options->speed / step);
    if (!(steps < MOST_SAMPLES))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "duration_s %g at speed %g would need %g samples per path, more than %g: make it shorter or slower",
                       options->duration_s, options->speed, steps, MOST_SAMPLES);
    const size_t count = steps < FEWEST_SAMPLES ? FEWEST_SAMPLES : (size_t)steps + 1;
    tides_pose_sample *samples = td_alloc(count, sizeof *samples, error);
    if (!samples) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < count; i++) {
        tides_pose_sample *s = &samples[i];
        const double time = i + 1 < count ? options->duration_s * (double)i / (double)(count - 1) : options->duration_s;
        s->time = time * options->speed;
        pose(shape, s);
        s->time = time;
        s->has_rates = 1;
        for (int k = 0; k < 3; k++) {
            s->velocity[k] *= options->speed;
            s->angular_velocity[k] *= options->speed;
        }
    }
    tides_status status = tides_trajectory_create(samples, count, path, error);
    free(samples);
    return status;
}

void td_quaternion_about(const double axis[3], double angle, double q[4]) {
    q[0] = td_cos(0.5 * angle);
    for (int k = 0; k < 3; k++) q[k + 1] = td_sin(0.5 * angle) * axis[k];
}

static void turned(void *shape, tides_pose_sample *sample) {
    const td_turning *t = shape;
    const double *q = t->rest, *a = t->axis;
    double turn[4], t2[3];
    td_quaternion_about(a, t->rate * sample->time, turn);
    td_quaternion_product(q, turn, sample->quaternion);
    memcpy(sample->position, t->centre, sizeof sample->position);
    /* The angular velocity lies along the axis a, turned into the world by q = (w, v). That is a + 2 w (v x a) + 2 v x (v x a),
     * and t2 is 2 (v x a). */
    for (int k = 0; k < 3; k++) t2[k] = 2 * (q[1 + (k + 1) % 3] * a[(k + 2) % 3] - q[1 + (k + 2) % 3] * a[(k + 1) % 3]);
    for (int k = 0; k < 3; k++)
        sample->angular_velocity[k] =
            t->rate * (a[k] + q[0] * t2[k] + q[1 + (k + 1) % 3] * t2[(k + 2) % 3] - q[1 + (k + 2) % 3] * t2[(k + 1) % 3]);
}

tides_status td_path_turning(const td_turning *turning, const tides_generate_options *options, tides_trajectory **path,
                             tides_error *error) {
    td_turning own = *turning;
    return td_sample_path(turned, &own, options, 0.1 / fmax(fabs(own.rate), 1), path, error);
}

void td_integrate(td_acceleration acceleration, const void *body, double step, double *x, double *x_dot) {
    const int64_t pieces = (int64_t)ceil(step / STEP_S);
    const double h = pieces > 0 ? step / (double)pieces : 0;
    for (int64_t piece = 0; piece < pieces; piece++) {
        const double v1 = *x_dot, a1 = acceleration(body, *x, v1);
        const double v2 = *x_dot + 0.5 * h * a1, a2 = acceleration(body, *x + 0.5 * h * v1, v2);
        const double v3 = *x_dot + 0.5 * h * a2, a3 = acceleration(body, *x + 0.5 * h * v2, v3);
        const double v4 = *x_dot + h * a3, a4 = acceleration(body, *x + h * v3, v4);
        *x += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
        *x_dot += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
}

tides_status td_path_camera(const double position[3], const double target[3], const tides_generate_options *options,
                            tides_trajectory **path, tides_error *error) {
    tides_handheld hand = {
        .up = {0, 1, 0},
        .position_amplitude = 0.012,
        .rotation_amplitude = 0.006,
        .frequency = 1.5,
        .seed = options->seed,
        .stop = options->duration_s,
    };
    memcpy(hand.position, position, sizeof hand.position);
    memcpy(hand.target, target, sizeof hand.target);
    return tides_trajectory_create_handheld(&hand, path, error);
}

tides_status td_path_still_camera(tides_trajectory **path, tides_error *error) {
    static const double position[3] = {0, 0.1, 3.05}, along_minus_z[4] = {0, 1, 0, 0}; /* half a turn about x */
    return tides_trajectory_create_static(position, along_minus_z, path, error);
}
