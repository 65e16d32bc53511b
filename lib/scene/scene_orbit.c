/* Finds an orbit for a scene without a camera path: around an object, or inside a place.
 *
 * A trained scene has strays far out, so bounding boxes and means are useless here. Distances from the median tell an object
 * from a place. An object ends: of guitar, playbot and a plant, 99 % lie within 1.2 to 1.3 times the radius of 90 %. The
 * background of a capture of a place goes on: 1.5 for garden, even after its publisher removed far points.
 *
 * Of an object, 99 % of the Gaussians are shown, from the least distance at which all these fit into the image from every side.
 * A formula gives each Gaussian's least distance. With one radius for all instead, a guitar's neck was left
 * out, and half of the image was empty.
 *
 * In a place the camera goes where the photographer went, because there space is free. For garden that was 1.05 to 1.23 from
 * the median, and half of its points are nearer than 1.22. A distance at which all fits into the image would show the place
 * from outside; at twice this distance the camera is inside a hedge. */
#include "camera/td_rotation.h"
#include "td_base.h"
#include "td_math.h"
#include "td_scene.h"
#include "td_sort.h"

#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 65536 };               /* Gaussians that are sampled; quantiles are then good to half a percent */
static const double faint_logit = -3.0; /* opacity 0.05: fainter ones are haze, which is everywhere */
static const double all = 0.99, most = 0.9, half = 0.5; /* quantiles of the distance */
static const double ends = 1.45;   /* largest ratio of `all` to `most` for an object; a normal distribution has 1.35 */
static const double margin = 1.05; /* factor of the distance, since Gaussians extend beyond their means */
static const double raised = 0.35; /* the camera's height over the orbit's radius: 19 degrees above the middle */
static const double turn_s = 12.0; /* [s] for one turn */
static const double flat = 0.5;    /* z is up if the scene's height is below this part of its smaller width */
typedef struct survey {
    double *at[3], *distance; /* SAMPLES each; one allocation */
    size_t count;
} survey;

/* Adds the means of every step-th Gaussian of an object, in world coordinates, without those of faint Gaussians. */
static tides_status add_object(survey *s, const td_object *object, int64_t step, tides_error *error) {
    const td_gaussians *g = &object->gaussians;
    tides_pose pose = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    double start = 0, stop;
    if (object->trajectory) tides_trajectory_range(object->trajectory, &start, &stop);
    if (object->trajectory) {
        tides_status status = tides_trajectory_at(object->trajectory, isfinite(start) ? start : 0, &pose, error);
        if (status != TIDES_OK) return status;
    }
    for (int64_t i = 0; i < g->count && s->count < SAMPLES; i += step) {
        if (g->opacity_logit[i] < faint_logit) continue;
        const double mean[3] = {td_gaussians_mean(g, i, 0), td_gaussians_mean(g, i, 1), td_gaussians_mean(g, i, 2)};
        for (int row = 0; row < 3; row++) {
            const double *r = pose.rotation + 3 * row;
            s->at[row][s->count] = object->scale * (r[0] * mean[0] + r[1] * mean[1] + r[2] * mean[2]) + pose.position[row];
        }
        s->count++;
    }
    return TIDES_OK;
}

static tides_status take_survey(const tides_scene *scene, survey *s, tides_error *error) {
    const int64_t step = tides_scene_count(scene) / SAMPLES + 1;
    double *room = td_alloc((size_t)4 * SAMPLES, sizeof *room, error);
    *s = (survey){.count = 0};
    if (!room) return TIDES_NO_MEMORY;
    *s = (survey){{room, room + SAMPLES, room + 2 * SAMPLES}, room + 3 * SAMPLES, 0};
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < scene->count && status == TIDES_OK; i++) status = add_object(s, &scene->objects[i], step, error);
    if (status == TIDES_OK && s->count == 0)
        status = td_fail(error, TIDES_BAD_ARGUMENT, "tides_scene_orbit: the scene holds nothing that can be seen");
    return status;
}

static double quantile(const double *sorted, size_t count, double fraction) {
    return sorted[(size_t)(fraction * (double)(count - 1) + 0.5)];
}

/* Guesses where up is. Trainers on photographs have y down, as in their cameras. If the scene is wide in x and y but flat in
 * z, z is up, as in nerfstudio's scenes. */
static void guess_up(const double width[3], double up[3]) {
    const double narrower = fmin(width[0], width[1]);
    const int z_up = width[2] < flat * narrower && fmax(width[0], width[1]) < narrower / flat;
    up[0] = 0;
    up[1] = z_up ? 0 : -1;
    up[2] = z_up ? 1 : 0;
}

/* The median, and the widths [scene units] that hold 80 % along each axis. Overwrites s->distance. */
static void find_middle(survey *s, double width[3], double middle[3]) {
    for (int axis = 0; axis < 3; axis++) {
        memcpy(s->distance, s->at[axis], s->count * sizeof *s->distance);
        qsort(s->distance, s->count, sizeof *s->distance, td_ascending);
        middle[axis] = quantile(s->distance, s->count, 0.5);
        width[axis] = quantile(s->distance, s->count, 0.9) - quantile(s->distance, s->count, 0.1);
    }
}

static double distance_from(const survey *s, const double middle[3], size_t i) {
    const double away[3] = {s->at[0][i] - middle[0], s->at[1][i] - middle[1], s->at[2][i] - middle[2]};
    return td_length3(away);
}

/* Keeps only the samples within `reach` of the middle, and moves the middle to the centre of their box. */
static void keep_within(survey *s, double reach, double middle[3]) {
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    size_t kept = 0;
    for (size_t i = 0; i < s->count; i++) {
        if (distance_from(s, middle, i) > reach) continue;
        for (int axis = 0; axis < 3; axis++) {
            s->at[axis][kept] = s->at[axis][i];
            lower[axis] = fmin(lower[axis], s->at[axis][i]);
            upper[axis] = fmax(upper[axis], s->at[axis][i]);
        }
        kept++;
    }
    s->count = kept;
    for (int axis = 0; axis < 3; axis++) middle[axis] = 0.5 * (lower[axis] + upper[axis]);
}

/* Replaces the survey's first two coordinates by cylindrical ones about the axis through the target: height above it, and
 * distance from the axis. 0 if `up` is no direction, which the path's constructor reports. */
static int turn_upright(survey *s, const tides_orbit *orbit) {
    const double *up = orbit->up, length = td_length3(up);
    for (size_t i = 0; i < s->count && length > 0; i++) {
        const double r = distance_from(s, orbit->target, i);
        double high = 0;
        for (int axis = 0; axis < 3; axis++) high += (s->at[axis][i] - orbit->target[axis]) * up[axis] / length;
        s->at[0][i] = high;
        s->at[1][i] = sqrt(fmax(r * r - high * high, 0));
    }
    return length > 0;
}

/* nearest_in_rows and nearest_in_columns: least distance of the camera from the target at which a point stays within the
 * image's rows, or its columns, all the way round. The point is `high` above the target and `out` from the orbit's axis. When
 * it is at angle a from the camera's side, it lies out sin(a) beside the optical axis and high c - out cos(a) s above it. It is
 * then nearer than the target by high s + out cos(a) c. */
static double nearest_in_rows(double high, double out, double tangent) {
    const double c = 1 / sqrt(1 + raised * raised), s = raised * c;
    const double front = fabs(high * c - out * s) / tangent + out * c, back = fabs(high * c + out * s) / tangent - out * c;
    return high * s + fmax(front, back);
}

static double nearest_in_columns(double high, double out, double tangent) {
    const double c = 1 / sqrt(1 + raised * raised), s = raised * c;
    return high * s + out * sqrt(1 / (tangent * tangent) + c * c); /* maximised over the angle */
}

static double nearest(const survey *s, double (*one)(double, double, double), double shift, double tangent) {
    double most_of_all = 0;
    for (size_t i = 0; i < s->count; i++) most_of_all = fmax(most_of_all, one(s->at[0][i] - shift, s->at[1][i], tangent));
    return most_of_all;
}

/* The distance for an object. Nearer parts look larger, so the target is shifted along `up` until as much space is left above
 * the object as below. That shift is the minimum of nearest_in_rows, a convex function of the shift. */
static double find_distance(survey *s, tides_orbit *orbit, double tangent) {
    double low = 0, high = 0;
    if (!turn_upright(s, orbit)) return 1;
    for (size_t i = 0; i < s->count; i++) {
        low = fmin(low, s->at[0][i]);
        high = fmax(high, s->at[0][i]);
    }
    for (int i = 0; i < 24; i++) { /* to 1 / 20 000 of its height */
        const double third = (high - low) / 3;
        if (nearest(s, nearest_in_rows, low + third, tangent) < nearest(s, nearest_in_rows, high - third, tangent))
            high -= third;
        else
            low += third;
    }
    const double shift = 0.5 * (low + high), length = td_length3(orbit->up);
    for (int axis = 0; axis < 3; axis++) orbit->target[axis] += shift * orbit->up[axis] / length;
    const double distance = fmax(nearest(s, nearest_in_rows, shift, tangent), nearest(s, nearest_in_columns, shift, tangent));
    return margin * (distance > 0 ? distance : 1 / tangent); /* a single Gaussian has no size */
}

/* Chooses the camera's distance from the target, and for an object, the target's place. */
static double choose(survey *s, tides_orbit *orbit, double tangent) {
    for (size_t i = 0; i < s->count; i++) s->distance[i] = distance_from(s, orbit->target, i);
    qsort(s->distance, s->count, sizeof *s->distance, td_ascending);
    const double reach = quantile(s->distance, s->count, all), usual = quantile(s->distance, s->count, half);
    if (reach > ends * quantile(s->distance, s->count, most) && usual > 0) return usual;
    keep_within(s, reach, orbit->target);
    return find_distance(s, orbit, tangent);
}

tides_status tides_scene_orbit(const tides_scene *scene, const double up[3], double field_of_view, tides_orbit *orbit,
                               tides_error *error) {
    if (!scene || !orbit || !(field_of_view > 0) || !(field_of_view < TD_PI))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "tides_scene_orbit: needs a scene, a place for the orbit, and a field of view in "
                       "(0, pi)");
    survey s;
    double width[3];
    tides_status status = take_survey(scene, &s, error);
    if (status == TIDES_OK) {
        *orbit = (tides_orbit){.angular_speed = 2 * TD_PI / turn_s, .stop = turn_s};
        find_middle(&s, width, orbit->target);
        if (!tides_scene_up(scene, orbit->up)) guess_up(width, orbit->up);
        if (up) memcpy(orbit->up, up, sizeof orbit->up);
        const double distance = choose(&s, orbit, td_tan(0.5 * field_of_view));
        orbit->radius = distance / sqrt(1 + raised * raised);
        orbit->height = raised * orbit->radius;
    }
    free(s.at[0]);
    return status;
}
