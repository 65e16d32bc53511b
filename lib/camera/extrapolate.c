/* Extends a path before its first and after its last sample, straight on and turning evenly, as it moves over its first
 * (last) few samples. This is for recordings whose poses begin after their events. */
#include "camera/td_rotation.h"
#include "td_math.h"
#include "camera/td_trajectory.h"
#include "camera/td_trajectory_parts.h"
#include "td_base.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FEW = 3 /* segments at an end that give its velocity */, ADDED_MOST = 1000000 };

/* How a path moves from one sample to another one: velocity, angular velocity (world axes). */
typedef struct motion {
    double velocity[3], omega[3];
} motion;

static motion between(const tides_pose_sample *a, const tides_pose_sample *b) {
    const double span = b->time - a->time,
                 back[4] = {a->quaternion[0], -a->quaternion[1], -a->quaternion[2], -a->quaternion[3]};
    double turn[4];
    motion m;
    td_quaternion_product(b->quaternion, back, turn);
    const double sign = turn[0] < 0 ? -1 : 1;
    const double sine = sqrt(turn[1] * turn[1] + turn[2] * turn[2] + turn[3] * turn[3]);
    const double rate = sine > 0 ? sign * 2 * td_atan2(sine, sign * turn[0]) / (sine * span) : 0;
    for (int k = 0; k < 3; k++) {
        m.velocity[k] = (b->position[k] - a->position[k]) / span;
        m.omega[k] = rate * turn[k + 1];
    }
    return m;
}

/* The sample moved on evenly to `time`. */
static tides_pose_sample moved(const tides_pose_sample *sample, const motion *m, double time) {
    const double span = time - sample->time;
    const double speed = sqrt(m->omega[0] * m->omega[0] + m->omega[1] * m->omega[1] + m->omega[2] * m->omega[2]);
    const double half = 0.5 * speed * span, share = speed > 0 ? td_sin(half) / speed : 0;
    const double turn[4] = {td_cos(half), share * m->omega[0], share * m->omega[1], share * m->omega[2]};
    tides_pose_sample made = *sample;
    made.time = time;
    td_quaternion_product(turn, sample->quaternion, made.quaternion);
    for (int k = 0; k < 3; k++) {
        made.position[k] += m->velocity[k] * span;
        if (made.has_rates) made.velocity[k] = m->velocity[k];
        if (made.has_rates) made.angular_velocity[k] = m->omega[k];
    }
    return made;
}

/* The least number of samples, `step` apart, that reach over `gap`. */
static size_t needed(double gap, double step) { return gap > 0 ? (size_t)ceil(gap / step) : 0; }

static tides_status extend(const tides_trajectory *t, double start, double stop, tides_trajectory **extended,
                           tides_error *error) {
    const size_t count = t->count, few = count > FEW ? FEW : count - 1;
    const tides_pose_sample *s = t->samples, *last = s + count - 1;
    const motion head = between(s, s + few), tail = between(last - few, last);
    const double before = (s[few].time - s->time) / (double)few,
                 after = (last->time - last[-(ptrdiff_t)few].time) / (double)few;
    if ((s->time - start) / before > ADDED_MOST || (stop - last->time) / after > ADDED_MOST)
        return td_fail(error, TIDES_OUT_OF_RANGE,
                       "the path covers [%.15g, %.15g] s, and [%.15g, %.15g] s is too far to go on to", s->time, last->time,
                       start, stop);
    const size_t first = needed(s->time - start, before), more = needed(stop - last->time, after), all = first + count + more;
    tides_pose_sample *samples = td_alloc(all, sizeof *samples, error);
    if (!samples) return TIDES_NO_MEMORY;
    for (size_t k = 0; k < first; k++) samples[k] = moved(s, &head, s->time - before * (double)(first - k));
    memcpy(samples + first, s, count * sizeof *s);
    for (size_t k = 0; k < more; k++) samples[first + count + k] = moved(last, &tail, last->time + after * (double)(k + 1));
    const tides_status status = tides_trajectory_create(samples, all, extended, error);
    free(samples);
    return status;
}

tides_status td_trajectory_extend(const tides_trajectory *trajectory, double start, double stop, tides_trajectory **extended,
                                  tides_error *error) {
    if (trajectory->is_open || trajectory->mounted)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "an open or mounted path doesn't go on by itself: append to it, or extend the body's");
    if (tides_trajectory_is_static(trajectory)) return td_trajectory_copy(trajectory, extended, error);
    return extend(trajectory, start, stop, extended, error);
}
