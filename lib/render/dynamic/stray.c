/* Finds strays: how far an object's view strays in an interval from the cubic through its ends, and from cubics after cutting
 * the interval into 2, 4, 8 .. pieces. It samples the paths at their knots, and between these. The sweep widens boxes by the
 * stray, and uses as many pieces as needed; kernels convert it to pixels.
 *
 * With errors dt and dR of a view, a point p of the object is off by |(dt + dR o) + dR (p - o)| for any origin o, so by at
 * most |dt + dR o| + |dR| |p - o|. If the camera shakes, dR is large, but dt + dR o is 0 for the camera's centre as o; if the
 * object shakes, it is 0 for the object's centre. The better of these two origins is used. */
#include "render/dynamic/td_stray.h"

#include "camera/td_rotation.h"
#include "camera/td_trajectory.h"
#include "render/td_renderer.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>

/* Samples between two neighbouring knots of the paths, which are cubics, quintics or rotations of such there; and the largest
 * factor by which the error between samples exceeds the sampled one. */
enum { POINTS_BETWEEN = 3 };
static const double missed = 1.25;

/* A smaller stray counts as 0: even a splat 20 times nearer than the object's middle stays within its box's margin, 0.01 px. */
static const double least_px = 1e-4;
/* With less than this, finer levels aren't computed: an error of fourth order falls by 16 from level to level. */
static const double enough_px = 2e-3;
static const double order = 16;
/* If boxes are wider than needed by more than this, the interval is swept in pieces; it is the width of a tile. */
static const double most_px = 16;
/* A turn of more than this in a piece [rad] needs more pieces, too: up to it, widths at start, middle and end are enough. */
static const double most_turn = 0.5;

tides_status td_strays_create(const td_store *store, td_strays *strays, tides_error *error) {
    size_t objects = (size_t)store->objects;
    memset(strays, 0, sizeof *strays);
    strays->objects = store->objects;
    strays->bound = td_alloc(objects * TD_STRAY_REALS, sizeof *strays->bound, error);
    strays->level = td_alloc(objects, sizeof *strays->level, error);
    strays->px = td_alloc(objects * TD_STRAY_LEVELS, sizeof *strays->px, error);
    strays->middle = td_alloc(4 * objects, sizeof *strays->middle, error);
    if (!strays->bound || !strays->level || !strays->px || !strays->middle) return TIDES_NO_MEMORY;
    for (int g = 0; g < store->count;) {
        int object = store->object[g], first = g;
        double *middle = strays->middle + 4 * (size_t)object, square = 0;
        for (; g < store->count && store->object[g] == object; g++)
            for (int k = 0; k < 3; k++) middle[k] += store->geometry[(size_t)g * TD_GEOMETRY_STRIDE + TD_G_MEAN + k];
        for (int k = 0; k < 3; k++) middle[k] /= g - first;
        for (int i = first; i < g; i++)
            for (int k = 0; k < 3; k++) {
                double x = store->geometry[(size_t)i * TD_GEOMETRY_STRIDE + TD_G_MEAN + k] - middle[k];
                square += x * x;
            }
        middle[3] = sqrt(square / (g - first));
    }
    return TIDES_OK;
}

void td_strays_release(td_strays *strays) {
    free(strays->bound);
    free(strays->level);
    free(strays->px);
    free(strays->middle);
    free(strays->share);
    free(strays->view);
    memset(strays, 0, sizeof *strays);
}

/* -- samples -------------------------------------------------------------------------------------------------- */

/* A path as seen by the camera. */
typedef struct seen_path {
    const tides_scene *scene;
    int32_t object;                       /* index in the scene */
    const tides_trajectory *camera, *own; /* own: the object's path; NULL: at rest */
    double epoch, start, stop;            /* start and stop are after the epoch */
} seen_path;

static tides_status look(const seen_path *path, double share, td_view *view, tides_error *error) {
    double time = share >= 1 ? path->stop : path->start + share * (path->stop - path->start);
    return td_view_at(path->scene, path->object, path->camera, path->epoch, time, view, error);
}

static tides_status add_share(td_strays *strays, double share, tides_error *error) {
    tides_status status =
        td_reserve((void **)&strays->share, &strays->share_capacity, (size_t)strays->samples + 1, sizeof *strays->share, error);
    if (status == TIDES_OK) strays->share[strays->samples++] = share;
    return status;
}

/* Adds the samples of a path within the interval. */
static tides_status add_knots(td_strays *strays, const seen_path *seen, const tides_trajectory *path, tides_error *error) {
    tides_status status = TIDES_OK;
    tides_pose_sample sample;
    if (!path || tides_trajectory_is_static(path)) return status;
    for (size_t i = td_trajectory_find(path, seen->epoch, seen->start); i < tides_trajectory_count(path) && status == TIDES_OK;
         i++) {
        status = tides_trajectory_sample(path, i, &sample, error);
        double share = ((sample.time - seen->epoch) - seen->start) / (seen->stop - seen->start);
        if (status != TIDES_OK || share >= 1) break;
        if (share > 0) status = add_share(strays, share, error);
    }
    return status;
}

/* Collects the places of samples in order (both ends, all samples of the paths, and points in between), and then the views
 * there. */
static tides_status find_samples(td_strays *strays, const seen_path *path, tides_error *error) {
    strays->samples = 0;
    tides_status status = add_share(strays, 0, error);
    if (status == TIDES_OK) status = add_share(strays, 1, error);
    if (status == TIDES_OK) status = add_knots(strays, path, path->camera, error);
    if (status == TIDES_OK) status = add_knots(strays, path, path->own, error);
    if (status != TIDES_OK) return status;
    int knots = strays->samples;
    qsort(strays->share, (size_t)knots, sizeof *strays->share, td_ascending);
    for (int i = 0; i + 1 < knots && status == TIDES_OK; i++) {
        double from = strays->share[i], to = strays->share[i + 1];
        for (int k = 1; k <= POINTS_BETWEEN && from < to && status == TIDES_OK; k++)
            status = add_share(strays, from + (to - from) * k / (POINTS_BETWEEN + 1), error);
    }
    if (status == TIDES_OK)
        status =
            td_reserve((void **)&strays->view, &strays->view_capacity, (size_t)strays->samples, sizeof *strays->view, error);
    if (status != TIDES_OK) return status;
    qsort(strays->share, (size_t)strays->samples, sizeof *strays->share, td_ascending);
    for (int i = 0; i < strays->samples && status == TIDES_OK; i++)
        status = look(path, strays->share[i], &strays->view[i], error);
    return status;
}

/* -- deviations ---------------------------------------------------------------------------------------------------- */

/* Largest |dt + dR o|, for two origins, and largest |dR|. */
typedef struct most_off {
    double position[2], rotation;
} most_off;

static double cubic(double x0, double r0, double x1, double r1, double h, double s) {
    double rest = 1 - s;
    return x0 + s * s * (3 - 2 * s) * (x1 - x0) + h * s * rest * (rest * r0 - s * r1);
}

/* Compares a view with the cubic through two others, which are `h` seconds apart, at share s of the interval. */
static void compare(const td_view *from, const td_view *to, double h, double s, const td_view *view, double origin[2][3],
                    most_off *most) {
    double dr[9], dt[3], sum = 0;
    for (int k = 0; k < 9; k++) {
        dr[k] = view->r[k] - cubic(from->r[k], from->r_dot[k], to->r[k], to->r_dot[k], h, s);
        sum += dr[k] * dr[k];
    }
    for (int k = 0; k < 3; k++) dt[k] = view->t[k] - cubic(from->t[k], from->t_dot[k], to->t[k], to->t_dot[k], h, s);
    most->rotation = fmax(most->rotation, sqrt(sum));
    for (int o = 0; o < 2; o++) {
        double off[3];
        for (int k = 0; k < 3; k++)
            off[k] = dt[k] + dr[3 * k] * origin[o][0] + dr[3 * k + 1] * origin[o][1] + dr[3 * k + 2] * origin[o][2];
        most->position[o] = fmax(most->position[o], td_length3(off));
    }
}

/* Compares all samples with the cubics of 2^level pieces. */
static tides_status compare_pieces(const td_strays *strays, const seen_path *path, int level, double origin[2][3],
                                   most_off *most, tides_error *error) {
    double pieces = (double)(1 << level), h = (path->stop - path->start) / pieces;
    td_view from = strays->view[0], to, between;
    tides_status status = TIDES_OK;
    memset(most, 0, sizeof *most);
    for (int k = 0, i = 0; k < 1 << level && status == TIDES_OK; k++, from = to) {
        status = look(path, (k + 1) / pieces, &to, error);
        for (; i < strays->samples && strays->share[i] * pieces <= k + 1 && status == TIDES_OK; i++)
            compare(&from, &to, h, fmax(strays->share[i] * pieces - k, 0), &strays->view[i], origin, most);
        for (int q = 1; q <= POINTS_BETWEEN && level > 0 && status == TIDES_OK; q++) {
            double s = q / (POINTS_BETWEEN + 1.0);
            status = look(path, (k + s) / pieces, &between, error);
            if (status == TIDES_OK) compare(&from, &to, h, s, &between, origin, most);
        }
    }
    return status;
}

/* Turn in the interval at the fastest sampled rate [rad]. */
static double turn_of(const td_strays *strays, double length) {
    double most = 0;
    for (int i = 0; i < strays->samples; i++) {
        const td_view *view = &strays->view[i];
        double rate = 0, scale = 0;
        for (int k = 0; k < 9; k++) rate += view->r_dot[k] * view->r_dot[k];
        for (int k = 0; k < 3; k++) scale += view->r[k] * view->r[k];
        most = fmax(most, sqrt(0.5 * rate / scale));
    }
    return most * length;
}

/* Facts about an object: pixels per unit at its middle, and distance of its Gaussians from each origin. */
typedef struct stray_measure {
    double origin[2][3], reach[2], px_per_unit;
} stray_measure;

static stray_measure measure_object(const td_strays *strays, int object, const td_image *image, const td_view *view) {
    const double *middle = strays->middle + 4 * (size_t)object;
    double away[3], seen[3], scale = td_length3(view->r);
    stray_measure measure;
    for (int k = 0; k < 3; k++) {
        measure.origin[0][k] = middle[k];
        measure.origin[1][k] = view->eye[k];
        away[k] = middle[k] - view->eye[k];
        seen[k] = view->r[3 * k] * middle[0] + view->r[3 * k + 1] * middle[1] + view->r[3 * k + 2] * middle[2] + view->t[k];
    }
    measure.reach[0] = middle[3];
    measure.reach[1] = sqrt(td_length3(away) * td_length3(away) + middle[3] * middle[3]);
    double distance = fmax(td_length3(seen), fmax(0.1 * scale * middle[3], image->near));
    measure.px_per_unit = fmax(image->fx, image->fy) * (image->lens_model ? image->lens.stretch : 1) / distance;
    return measure;
}

static double px_of(const stray_measure *measure, const most_off *most, int which) {
    return measure->px_per_unit * (most->position[which] + most->rotation * measure->reach[which]);
}

static void set_level(td_stray *stray, int level, const most_off *most, int which) {
    stray->position[level] = missed * most->position[which];
    stray->rotation[level] = missed * most->rotation;
}

static tides_status find_one(td_strays *strays, int object, const seen_path *path, const td_image *image, tides_error *error) {
    td_stray *stray = (td_stray *)(void *)(strays->bound + (size_t)object * TD_STRAY_REALS);
    most_off most;
    tides_status status = find_samples(strays, path, error);
    if (status != TIDES_OK) return status;
    stray_measure measure = measure_object(strays, object, image, &strays->view[strays->samples / 2]);
    double turn = turn_of(strays, path->stop - path->start), px = 0;
    double *seen_px = strays->px + (size_t)object * TD_STRAY_LEVELS;
    int which = 0, level = 0, narrow = -1;
    for (; level < TD_STRAY_LEVELS; level++) {
        status = compare_pieces(strays, path, level, measure.origin, &most, error);
        if (status != TIDES_OK) return status;
        if (level == 0) which = px_of(&measure, &most, 1) < px_of(&measure, &most, 0);
        px = px_of(&measure, &most, which);
        seen_px[level] = missed * px;
        if (level == 0 && px < least_px) break;
        set_level(stray, level, &most, which);
        if (narrow < 0 && px <= most_px) narrow = level;
        if (px < enough_px) break;
    }
    for (int k = level + 1; k < TD_STRAY_LEVELS; k++) seen_px[k] = seen_px[k - 1] / order;
    memcpy(stray->origin, measure.origin[which], sizeof stray->origin);
    for (int k = level + 1; k < TD_STRAY_LEVELS && px >= least_px; k++) {
        stray->position[k] = stray->position[k - 1] / order;
        stray->rotation[k] = stray->rotation[k - 1] / order;
    }
    narrow = narrow >= 0 ? narrow : px < least_px ? 0 : TD_STRAY_LEVELS - 1;
    while (narrow < TD_STRAY_LEVELS - 1 && turn / (1 << narrow) > most_turn) narrow++;
    strays->level[object] = narrow;
    return TIDES_OK;
}

tides_status td_strays_find(td_strays *strays, const td_store *store, const td_image *image, const td_stray_interval *interval,
                            tides_error *error) {
    const double start = interval->start, stop = interval->stop;
    int camera_rests = tides_trajectory_is_static(interval->camera);
    memset(strays->bound, 0, (size_t)strays->objects * TD_STRAY_REALS * sizeof *strays->bound);
    memset(strays->level, 0, (size_t)strays->objects * sizeof *strays->level);
    memset(strays->px, 0, (size_t)strays->objects * TD_STRAY_LEVELS * sizeof *strays->px);
    if (!(start < stop)) return TIDES_OK;
    for (int i = 0; i < strays->objects; i++) {
        tides_object facts;
        tides_status status = tides_scene_object(interval->scene, store->scene_object[i], &facts, error);
        int own = status == TIDES_OK && facts.trajectory && !tides_trajectory_is_static(facts.trajectory);
        const tides_trajectory *path_own = own ? facts.trajectory : NULL;
        const seen_path path =
            {interval->scene, store->scene_object[i], interval->camera, path_own, interval->epoch, start, stop};
        if (status == TIDES_OK && interval->moves[i] && (own || !camera_rests))
            status = find_one(strays, i, &path, image, error);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}
