/* An orbit that shows a scene nobody has a camera path for: round the middle of what is there, from where most of it is seen.
 *
 * A trained scene has strays far out, so that nothing here is a box or a mean: the middle is the median of each coordinate,
 * the size the radius about it that holds 90 % of the Gaussians. Captures with a background have that far out, too: two and a
 * half times the radius of the nearer half is then the size, which looks at what the photographer went round. */
#include "td_base.h"
#include "td_scene.h"
#include "td_sort.h"

#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 65536 };               /* Gaussians that are looked at; quantiles of so many are good to half a percent */
static const double faint_logit = -3.0; /* opacity 0.05: haze, which is everywhere */
static const double background = 2.5;   /* see above; 1.2 for a ball full of Gaussians, 1 for a shell */
static const double margin = 1.15;      /* room round it */
static const double raised = 0.35;      /* the camera stands 20 degrees above the middle */
static const double turn_s = 12.0;      /* [s] */
static const double flat = 0.5;         /* of the narrower of the other two: the ground of a scene with z up */
static const double two_pi = 6.28318530717958647692;

typedef struct survey {
    double *at[3], *distance; /* SAMPLES each; one allocation */
    size_t count;
} survey;

/* Every step-th Gaussian of an object that isn't faint, in the world. */
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
    return sorted[(size_t)(fraction * (double)(count - 1))];
}

/* What trainers on photographs have: y down, as their cameras; with a floor across z, and far less along it, z up, as
 * nerfstudio turns scenes. */
static void guess_up(const double width[3], double up[3]) {
    const double narrower = fmin(width[0], width[1]);
    const int z_up = width[2] < flat * narrower && fmax(width[0], width[1]) < narrower / flat;
    up[0] = 0;
    up[1] = z_up ? 0 : -1;
    up[2] = z_up ? 1 : 0;
}

/* The middle to orbit->target, and the widths [scene units] that hold 80 % along each axis. Sorts each axis. */
static void find_middle(survey *s, double width[3], tides_orbit *orbit) {
    for (int axis = 0; axis < 3; axis++) {
        memcpy(s->distance, s->at[axis], s->count * sizeof *s->distance);
        qsort(s->distance, s->count, sizeof *s->distance, td_ascending);
        orbit->target[axis] = quantile(s->distance, s->count, 0.5);
        width[axis] = quantile(s->distance, s->count, 0.9) - quantile(s->distance, s->count, 0.1);
    }
}

static double find_size(survey *s, const double middle[3]) {
    for (size_t i = 0; i < s->count; i++) {
        const double x = s->at[0][i] - middle[0], y = s->at[1][i] - middle[1], z = s->at[2][i] - middle[2];
        s->distance[i] = sqrt(x * x + y * y + z * z);
    }
    qsort(s->distance, s->count, sizeof *s->distance, td_ascending);
    return fmin(quantile(s->distance, s->count, 0.9), background * quantile(s->distance, s->count, 0.5));
}

tides_status tides_scene_orbit(const tides_scene *scene, const double up[3], double field_of_view, tides_orbit *orbit,
                               tides_error *error) {
    if (!scene || !orbit || !(field_of_view > 0) || !(field_of_view < 0.5 * two_pi))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "tides_scene_orbit: needs a scene, a place for the orbit, and a field of view in "
                       "(0, pi)");
    survey s;
    double width[3];
    tides_status status = take_survey(scene, &s, error);
    if (status == TIDES_OK) {
        *orbit = (tides_orbit){.angular_speed = two_pi / turn_s, .stop = turn_s};
        find_middle(&s, width, orbit);
        guess_up(width, orbit->up);
        if (up) memcpy(orbit->up, up, sizeof orbit->up);
        const double size = find_size(&s, orbit->target),
                     distance = margin * (size > 0 ? size : 1.0) / sin(0.5 * field_of_view);
        orbit->radius = distance / sqrt(1 + raised * raised);
        orbit->height = raised * orbit->radius;
    }
    free(s.at[0]);
    return status;
}
