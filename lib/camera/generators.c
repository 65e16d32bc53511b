/* Paths from a formula: orbit, dolly, handheld.
 *
 * Each path samples its formula evenly, with the formula's own rates, and a quintic spline runs through the samples. With
 * step h, a motion of angular frequency w is then off by about (w h)^6 / 46080 in the middle of a path, and (w h)^5 / 1000 at
 * its ends. The steps below keep both under 1e-6 of the motion's size (measured in test_trajectory_generators.c). */
#include "tides/trajectory.h"

#include "camera/td_rotation.h"
#include "td_base.h"
#include "td_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TD_STEP_ANGLE 0.1         /* [rad] of the fastest motion per sample: 63 samples per turn */
#define TD_FEWEST_SAMPLES 9       /* keeps the less accurate ends of the spline apart on short paths */
#define TD_MOST_SAMPLES 1000000.0 /* 0.5 GB, 16 000 turns */

/* Fills position, quaternion and rates of `sample` at its time; returns 0 if the formula has no value there. */
typedef int (*formula)(const void *parameters, tides_pose_sample *sample);

/* Samples a formula over [start, stop]; `angular_rate` is that of its fastest motion [rad/s]. */
static tides_status sample_formula(formula formula_at, const void *parameters, const char *name, double start, double stop,
                                   double angular_rate, tides_trajectory **trajectory, tides_error *error) {
    if (!isfinite(start) || !isfinite(stop) || !(stop > start))
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: stop (%g s) must come after start (%g s)", name, stop, start);
    double steps = ceil((stop - start) * angular_rate / TD_STEP_ANGLE);
    if (!(steps < TD_MOST_SAMPLES))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "%s: %g s at up to %g rad/s would need %g samples, more than %g: make it shorter or slower", name,
                       stop - start, angular_rate, steps, TD_MOST_SAMPLES);
    size_t count = steps < TD_FEWEST_SAMPLES ? TD_FEWEST_SAMPLES : (size_t)steps + 1;
    tides_pose_sample *samples = td_alloc(count, sizeof *samples, error);
    if (!samples) return TIDES_NO_MEMORY;
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        double fraction = (double)i / (double)(count - 1);
        samples[i].time = i + 1 < count ? start + (stop - start) * fraction : stop;
        samples[i].has_rates = 1;
        if (!formula_at(parameters, samples + i))
            status = td_fail(error, TIDES_BAD_ARGUMENT,
                             "%s: at %g s the camera is at its target, or looks along `up`: its orientation isn't determined; "
                             "choose another `up` or keep away from the target",
                             name, samples[i].time);
    }
    if (status == TIDES_OK) {
        status = tides_trajectory_create(samples, count, trajectory, error);
        if (status != TIDES_OK) td_fail_within(error, status, "%s", name);
    }
    free(samples);
    return status;
}

/* Unit vector along `up`; returns 0 if `up` is zero or not finite. */
static int unit_up(const double up[3], double unit[3]) {
    double length = td_length3(up);
    if (!isfinite(length) || !(length > 0.0)) return 0;
    for (int k = 0; k < 3; k++) unit[k] = up[k] / length;
    return 1;
}

static tides_status bad_up(const char *name, tides_error *error) {
    return td_fail(error, TIDES_BAD_ARGUMENT, "%s: `up` must be a finite vector that isn't zero", name);
}

/* -- orbit ------------------------------------------------------------------------------------------------------------ */

/* Angles count from the world's x axis (y if `up` is near x), projected onto the plane normal to `up`. They turn about `up`
 * by the right hand. */
typedef struct orbit_frame {
    const tides_orbit *orbit;
    double up[3], ahead[3], aside[3];
} orbit_frame;

static int orbit_at(const void *parameters, tides_pose_sample *sample) {
    const orbit_frame *frame = parameters;
    const tides_orbit *orbit = frame->orbit;
    double angle = orbit->start_angle + orbit->angular_speed * (sample->time - orbit->start), rotation[9];
    for (int k = 0; k < 3; k++) {
        double out = td_cos(angle) * frame->ahead[k] + td_sin(angle) * frame->aside[k];
        double along = td_cos(angle) * frame->aside[k] - td_sin(angle) * frame->ahead[k];
        sample->position[k] = orbit->target[k] + orbit->radius * out + orbit->height * frame->up[k];
        sample->velocity[k] = orbit->radius * orbit->angular_speed * along;
    }
    if (!td_look_at(sample->position, sample->velocity, orbit->target, frame->up, rotation, sample->angular_velocity)) return 0;
    td_quaternion_from_rotation(rotation, sample->quaternion);
    return 1;
}

tides_status tides_trajectory_create_orbit(const tides_orbit *orbit, tides_trajectory **trajectory, tides_error *error) {
    if (!orbit || !trajectory) return td_fail(error, TIDES_BAD_ARGUMENT, "orbit: needs parameters and a place for the result");
    const double numbers[] = {orbit->target[0], orbit->target[1],   orbit->target[2],    orbit->radius,
                              orbit->height,    orbit->start_angle, orbit->angular_speed};
    if (!td_all_finite(numbers, sizeof numbers / sizeof *numbers) || !(orbit->radius > 0.0))
        return td_fail(error, TIDES_BAD_ARGUMENT, "orbit: radius must be above 0 and all values finite");
    orbit_frame frame = {.orbit = orbit};
    if (!unit_up(orbit->up, frame.up)) return bad_up("orbit", error);
    double axis[3] = {0};
    axis[fabs(frame.up[0]) < 0.9 ? 0 : 1] = 1.0;
    double along = td_dot3(axis, frame.up);
    for (int k = 0; k < 3; k++) frame.ahead[k] = axis[k] - along * frame.up[k];
    if (!unit_up(frame.ahead, frame.ahead)) return bad_up("orbit", error);
    td_cross3(frame.up, frame.ahead, frame.aside);
    return sample_formula(orbit_at, &frame, "orbit", orbit->start, orbit->stop, fabs(orbit->angular_speed), trajectory, error);
}

/* -- dolly ------------------------------------------------------------------------------------------------------------ */

static int dolly_at(const void *parameters, tides_pose_sample *sample) {
    const tides_dolly *dolly = parameters;
    double fraction = (sample->time - dolly->start) / (dolly->stop - dolly->start), rotation[9];
    for (int k = 0; k < 3; k++) {
        sample->position[k] = dolly->from[k] + fraction * (dolly->to[k] - dolly->from[k]);
        sample->velocity[k] = (dolly->to[k] - dolly->from[k]) / (dolly->stop - dolly->start);
    }
    if (!td_look_at(sample->position, sample->velocity, dolly->target, dolly->up, rotation, sample->angular_velocity)) return 0;
    td_quaternion_from_rotation(rotation, sample->quaternion);
    return 1;
}

/* Least distance between the line `from`-`to` and the line through the target along `up`. The nearer, the faster the view
 * turns. */
static double distance_from_axis(const tides_dolly *dolly, const double up[3]) {
    double from[3], move[3], from_up = 0.0, move_up = 0.0;
    for (int k = 0; k < 3; k++) {
        from[k] = dolly->from[k] - dolly->target[k];
        move[k] = dolly->to[k] - dolly->from[k];
        from_up += from[k] * up[k];
        move_up += move[k] * up[k];
    }
    for (int k = 0; k < 3; k++) { /* keep the components normal to `up` */
        from[k] -= from_up * up[k];
        move[k] -= move_up * up[k];
    }
    double square = td_dot3(move, move);
    double nearest = square > 0.0 ? fmin(fmax(-td_dot3(from, move) / square, 0.0), 1.0) : 0.0;
    for (int k = 0; k < 3; k++) from[k] += nearest * move[k];
    return td_length3(from);
}

tides_status tides_trajectory_create_dolly(const tides_dolly *dolly, tides_trajectory **trajectory, tides_error *error) {
    if (!dolly || !trajectory) return td_fail(error, TIDES_BAD_ARGUMENT, "dolly: needs parameters and a place for the result");
    if (!td_all_finite(dolly->from, 3) || !td_all_finite(dolly->to, 3) || !td_all_finite(dolly->target, 3))
        return td_fail(error, TIDES_BAD_ARGUMENT, "dolly: from, to and target must be finite");
    double up[3], move[3], distance;
    if (!unit_up(dolly->up, up)) return bad_up("dolly", error);
    for (int k = 0; k < 3; k++) move[k] = dolly->to[k] - dolly->from[k];
    distance = distance_from_axis(dolly, up);
    if (!(distance > 1e-6 * td_length3(move)))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "dolly: the way from `from` to `to` leads through the target, or straight over it along `up`, where the "
                       "camera's orientation isn't determined; keep away from it or choose another `up`");
    double angular_rate = td_length3(move) / distance / fabs(dolly->stop - dolly->start);
    if (!(dolly->stop > dolly->start)) angular_rate = 0.0; /* sample_formula reports it as an error */
    return sample_formula(dolly_at, dolly, "dolly", dolly->start, dolly->stop, angular_rate, trajectory, error);
}

/* -- handheld --------------------------------------------------------------------------------------------------------- */

/* Hand tremor has most of its power at low frequencies. The shake is a sum of sines at f, 1.71 f, 2.92 f and 5 f, with
 * amplitudes falling as 1/f. The ratio 5^(1/3) makes it take long to repeat. */
#define TD_SINES 4
#define TD_AXES 6 /* three of position, then three of rotation */

typedef struct shake {
    const tides_handheld *handheld;
    double rotation[9];                              /* the rotation without shake */
    double amplitude[TD_SINES], pulsation[TD_SINES]; /* amplitudes for 1 rms in total; [rad/s] */
    double phase[TD_AXES][TD_SINES];                 /* [rad] */
} shake;

/* A uniform number in [0, 1) from seed and index, by the finaliser of splitmix64 (Steele, Lea, Flood 2014). A phase depends
 * on these two alone. */
static double uniform(uint64_t seed, uint64_t place) {
    uint64_t z = seed + (place + 1) * UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* Sum of sines of one axis with rms 1, and its rate. */
static void shake_axis(const shake *s, int axis, double time, double *value, double *rate) {
    *value = *rate = 0.0;
    for (int i = 0; i < TD_SINES; i++) {
        double angle = s->pulsation[i] * time + s->phase[axis][i];
        *value += s->amplitude[i] * td_sin(angle);
        *rate += s->amplitude[i] * s->pulsation[i] * td_cos(angle);
    }
}

/* Quaternion of the rotation vector v, and the angular velocity omega in body axes if v has the rate v_dot. By the right
 * Jacobian of SO(3), omega = v_dot - (1 - cos a)/a^2 v x v_dot + (a - sin a)/a^3 v x (v x v_dot), a = |v|. */
static void exponential(const double v[3], const double v_dot[3], double q[4], double omega[3]) {
    double a = td_length3(v), square = a * a, once[3], twice[3];
    int small = a < 1e-3; /* series: the next terms are below 1e-13 */
    double half_sinc = small ? 0.5 - square / 48.0 : td_sin(0.5 * a) / a;
    double first = small ? 0.5 - square / 24.0 : (1.0 - td_cos(a)) / square;
    double second = small ? 1.0 / 6.0 - square / 120.0 : (a - td_sin(a)) / (square * a);
    td_cross3(v, v_dot, once);
    td_cross3(v, once, twice);
    q[0] = td_cos(0.5 * a);
    for (int k = 0; k < 3; k++) {
        q[k + 1] = half_sinc * v[k];
        omega[k] = v_dot[k] - first * once[k] + second * twice[k];
    }
}

static int handheld_at(const void *parameters, tides_pose_sample *sample) {
    const shake *s = parameters;
    const tides_handheld *h = s->handheld;
    double v[3], v_dot[3], q[4], turn[9], omega[3], rotation[9], time = sample->time - h->start;
    for (int k = 0; k < 3; k++) {
        double value, rate;
        shake_axis(s, k, time, &value, &rate);
        sample->position[k] = h->position[k] + h->position_amplitude * value;
        sample->velocity[k] = h->position_amplitude * rate;
        shake_axis(s, k + 3, time, &value, &rate);
        v[k] = h->rotation_amplitude * value;
        v_dot[k] = h->rotation_amplitude * rate;
    }
    exponential(v, v_dot, q, omega);
    td_rotation_from_quaternion(q, turn);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            rotation[3 * i + j] =
                s->rotation[3 * i] * turn[j] + s->rotation[3 * i + 1] * turn[3 + j] + s->rotation[3 * i + 2] * turn[6 + j];
    td_quaternion_from_rotation(rotation, sample->quaternion);
    for (int i = 0; i < 3; i++) sample->angular_velocity[i] = td_dot3(rotation + 3 * i, omega); /* body to world axes */
    return 1;
}

static void prepare_shake(const tides_handheld *handheld, shake *s) {
    double power = 0.0;
    for (int i = 0; i < TD_SINES; i++) {
        double ratio = td_pow(5.0, (double)i / (TD_SINES - 1));
        s->pulsation[i] = 2.0 * TD_PI * handheld->frequency * ratio;
        s->amplitude[i] = 1.0 / ratio;
        power += 0.5 * s->amplitude[i] * s->amplitude[i];
    }
    for (int i = 0; i < TD_SINES; i++) s->amplitude[i] /= sqrt(power);
    for (int axis = 0; axis < TD_AXES; axis++)
        for (int i = 0; i < TD_SINES; i++)
            s->phase[axis][i] = 2.0 * TD_PI * uniform(handheld->seed, (uint64_t)axis * TD_SINES + (uint64_t)i);
}

tides_status tides_trajectory_create_handheld(const tides_handheld *handheld, tides_trajectory **trajectory,
                                              tides_error *error) {
    if (!handheld || !trajectory)
        return td_fail(error, TIDES_BAD_ARGUMENT, "handheld: needs parameters and a place for the result");
    const tides_handheld *h = handheld;
    const double numbers[] = {h->position[0], h->position[1], h->position[2], h->target[0],
                              h->target[1],   h->target[2],   h->frequency,   h->position_amplitude};
    if (!td_all_finite(numbers, sizeof numbers / sizeof *numbers) || !(h->frequency > 0.0) || !(h->position_amplitude >= 0.0))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "handheld: frequency must be above 0, amplitudes at least 0, all values finite");
    if (!(h->rotation_amplitude >= 0.0 &&
          h->rotation_amplitude <= 0.5)) /* the peaks of the rotation are three times as large */
        return td_fail(error, TIDES_BAD_ARGUMENT, "handheld: rotation_amplitude is %g rad; a hand's lies between 0 and 0.5",
                       h->rotation_amplitude);
    shake s = {.handheld = handheld};
    const double still[3] = {0};
    double up[3];
    if (!unit_up(h->up, up)) return bad_up("handheld", error);
    if (!td_look_at(h->position, still, h->target, up, s.rotation, NULL))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "handheld: the camera is at its target, or looks along `up`; choose another `up` or position");
    prepare_shake(handheld, &s);
    return sample_formula(handheld_at, &s, "handheld", h->start, h->stop, s.pulsation[TD_SINES - 1], trajectory, error);
}
