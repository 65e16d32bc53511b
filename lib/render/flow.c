/* The fastest motion in the image [px/s]. Adaptive sampling by motion, as in ESIM (TIDES_ESIM_MOTION), needs it to bound the
 * displacement between two renders. */
#include "camera/td_trajectory.h"
#include "td_renderer.h"

#include "kernels/lens.h"
#include "td_math.h"

#include <math.h>
#include <stdlib.h>

/* Longest time between the two instants at which the places of a moving splat are compared [s]. Its speed then has two errors.
 * A shorter time increases the error by rounding: boxes in single precision, 3e-5 px at 300 px, make 0.06 px/s. A longer time
 * increases the error by acceleration: 1000 px/s^2 makes 0.5 px/s. */
static const double probe_s = 1e-3;

/* Speed [px/s] on the screen of the point, at rest in the world, that pixel (x, y) shows. In the camera's coordinates the point
 * (X, Y, Z) lies on the ray through the pixel's centre, at the depth Z that was rendered there.
 *
 * With the point at p in the world, (X, Y, Z) = R p + t, so that p = R^T ((X, Y, Z) - t). It moves in the camera's coordinates
 * at R_dot p + t_dot. Its place on the screen is u = fx X/Z + cx, and moves at u_dot = fx (X_dot - (X/Z) Z_dot) / Z; v is
 * alike. Through a lens with distortion d the velocity is K Dd K^-1 (u_dot, v_dot), where K is diag(fx, fy), and Dd the
 * derivative of d. */
static double pixel_flow(const td_image *image, const td_view *view, int x, int y, double Z) {
    double ray[3] = {0, 0, 1.0}, p[3], moved[3];
    td_ray_of(image, x + 0.5, y + 0.5, &ray[0], &ray[1]);
    for (int i = 0; i < 3; i++) {
        p[i] = 0;
        for (int j = 0; j < 3; j++) p[i] += view->r[3 * j + i] * (Z * ray[j] - view->t[j]);
    }
    for (int i = 0; i < 3; i++)
        moved[i] = view->r_dot[3 * i] * p[0] + view->r_dot[3 * i + 1] * p[1] + view->r_dot[3 * i + 2] * p[2] + view->t_dot[i];
    double u = moved[0] - ray[0] * moved[2], v = moved[1] - ray[1] * moved[2];
    if (image->lens_model) {
        const td_bent bent = td_bend(image, td_still(ray[0]), td_still(ray[1]));
        const double across = u;
        u = bent.xx.v * across + bent.xy.v * v, v = bent.yx.v * across + bent.yy.v * v;
    }
    return td_hypot(image->fx * u, image->fy * v) / Z;
}

/* Raises *fastest to the fastest motion that the camera alone causes, as if all objects were at rest. Pixels without depth show
 * no splat, and are skipped. */
static tides_status camera_flow(const tides_renderer *renderer, const tides_trajectory *camera, double time, const double *Z,
                                double *fastest, tides_error *error) {
    const td_image *image = &renderer->image;
    tides_pose pose;
    td_view view;
    if (tides_trajectory_is_static(camera)) return TIDES_OK;
    tides_status status = td_trajectory_at(camera, renderer->epoch, time, &pose, error);
    if (status != TIDES_OK) return status;
    td_view_make(&pose, NULL, 1.0, &view);
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++) {
            double depth = Z[(size_t)y * image->width + x];
            if (depth > 0) *fastest = fmax(*fastest, pixel_flow(image, &view, x, y, depth));
        }
    return TIDES_OK;
}

/* Whether an object of the store moves in the world, as a whole or in its Gaussians. */
static tides_status moves_itself(const tides_renderer *renderer, int object, int *moves, tides_error *error) {
    tides_object facts;
    tides_status status = tides_scene_object(renderer->scene, renderer->store.scene_object[object], &facts, error);
    if (status == TIDES_OK) *moves = renderer->store.mover[object] >= 0 || td_object_travels(&facts);
    return status;
}

/* Distance between the centres of two boxes of one splat, at two times [px]. It is 0 if either box is outside the screen. It is
 * also 0 if either box is the whole image, which the sweep gives to splats that cross the near plane. */
static double displacement(const td_image *image, const float *from, const float *to) {
    const float width = (float)image->width, height = (float)image->height;
    for (int k = 0; k < 2; k++) {
        const float *box = k ? to : from;
        if (!(box[0] <= box[2] && box[0] < width && box[2] > 0 && box[1] < height && box[3] > 0)) return 0;
        if (box[0] == 0 && box[1] == 0 && box[2] == width && box[3] == height) return 0;
    }
    return 0.5 * td_hypot((double)to[0] + to[2] - from[0] - from[2], (double)to[1] + to[3] - from[1] - from[3]);
}

/* Raises *fastest to the fastest motion of splats in objects that move, with the camera's motion included. The speed of a splat
 * is the displacement of its box between `time` and `other`, divided by the time between them. */
static tides_status own_flow(tides_renderer *renderer, const tides_trajectory *camera, double time, double other,
                             double *fastest, tides_error *error) {
    const td_store *store = &renderer->store;
    size_t values = 4 * (size_t)store->count;
    int any = 0, moves = 0;
    tides_status status = TIDES_OK;
    for (int i = 0; i < store->objects && status == TIDES_OK; i++) {
        status = moves_itself(renderer, i, &moves, error);
        any |= moves;
    }
    if (status != TIDES_OK || !any) return status;
    float *from = td_alloc(values, sizeof *from, error);
    status = from ? td_renderer_sweep_alone(renderer, camera, time, time, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) memcpy(from, renderer->sweep.boxes, values * sizeof *from);
    if (status == TIDES_OK) status = td_renderer_sweep_alone(renderer, camera, other, other, error);
    for (int i = 0; i < store->objects && status == TIDES_OK; i++) {
        status = moves_itself(renderer, i, &moves, error);
        for (int g = renderer->object_first[i]; moves && g < renderer->object_first[i + 1] && status == TIDES_OK; g++) {
            double way = displacement(&renderer->image, from + 4 * (size_t)g, renderer->sweep.boxes + 4 * (size_t)g);
            *fastest = fmax(*fastest, way / fabs(other - time));
        }
    }
    free(from);
    return status;
}

tides_status td_renderer_flow(tides_renderer *renderer, const tides_trajectory *camera, double time, double start, double stop,
                              const double *Z, double *fastest, tides_error *error) {
    double probe = fmin(probe_s, 0.5 * (stop - start));
    *fastest = 0;
    tides_status status = camera_flow(renderer, camera, time, Z, fastest, error);
    if (status != TIDES_OK) return status;
    return own_flow(renderer, camera, time, time + probe <= stop ? time + probe : time - probe, fastest, error);
}
