/* One Gaussian that passes in front of a backdrop, against the formula.
 *
 * A round Gaussian of standard deviation s at (X, 0, z) with X = X0 + v t is seen along +z from the origin. With
 * k = (f s / z)^2 and p = X / z its splat is axis-aligned, lies at (u, cy) with u = f p + cx, and has variances
 * a = k (1 + p^2) + dilation and c = k + dilation, so
 *   alpha     = o exp(-dx^2 / 2a - dy^2 / 2c)
 *   alpha_dot = alpha (dx u_dot / a + dx^2 a_dot / 2a^2),   u_dot = f v / z,   a_dot = 2 k p v / z
 *   Y         = B + alpha (l - B)                           for a splat of luminance l and a backdrop of luminance B
 * The same motion comes in three ways: the Gaussian's mean moves, its object does, or the camera goes the other way. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_renderer.h"

#include "tests/support/render_frame.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>

enum { WIDTH = 40, HEIGHT = 24 };
static const double focal = 50, centre_x = 20.5, centre_y = 11.25;
static const double start_x = -0.3, speed = 1.5, depth = 4, sigma = 0.25, opacity = 0.8, dilation = 0.3, time_now = 0.25;
static const double sh_constant = 0.28209479177387814, grey = 1.2, log_eps = 1e-3;
static const double backdrop_colour[3] = {0.2, 0.3, 0.1}, luminance_weight[3] = {0.2126, 0.7152, 0.0722};

enum { MEAN_MOVES, OBJECT_MOVES, CAMERA_MOVES, WAYS };

/* A straight path along x from `x`: splines reproduce straight lines. */
static tides_trajectory *straight(double x, double velocity) {
    tides_pose_sample samples[3] = {{0}};
    tides_trajectory *path = NULL;
    tides_error error;
    for (int i = 0; i < 3; i++) {
        samples[i].time = 0.5 * i;
        samples[i].position[0] = x + velocity * samples[i].time;
        samples[i].quaternion[0] = 1;
    }
    scene_expect_ok(tides_trajectory_create(samples, 3, &path, &error), &error);
    return path;
}

static tides_scene *make_scene(int way) {
    const float mean[3] = {0, 0, (float)depth}, quaternion[4] = {0.5F, 0.5F, -0.5F, 0.5F};
    const float log_sigma = (float)log(sigma), log_scale[3] = {log_sigma, log_sigma, log_sigma};
    const float logit = (float)log(opacity / (1 - opacity)), sh[3] = {(float)grey, (float)grey, (float)grey};
    tides_gaussians gaussian =
        {.count = 1, .mean = mean, .log_scale = log_scale, .quaternion = quaternion, .opacity_logit = &logit, .sh = sh};
    tides_trajectory *path = straight(start_x, way == OBJECT_MOVES ? speed : 0);
    tides_scene *scene = NULL;
    tides_error error;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    scene_expect_ok(tides_scene_add(scene, &gaussian, path, 1, NULL, NULL, &error), &error);
    tides_trajectory_destroy(path);
    return scene;
}

/* The scene's store; for a moving mean at its place now, with its rate. */
static td_store make_store(const tides_scene *scene, int way) {
    td_store store;
    tides_error error;
    scene_expect_ok(td_store_create(scene, NULL, 1, 0, &store, &error), &error);
    if (way != MEAN_MOVES) return store;
    store.rates = calloc((size_t)store.count * TD_GEOMETRY_STRIDE, sizeof *store.rates);
    store.sh_rates = calloc((size_t)store.count * (size_t)store.sh_stride, sizeof *store.sh_rates);
    assert_true(store.rates && store.sh_rates);
    store.geometry[TD_G_MEAN] += speed * time_now;
    store.rates[TD_G_MEAN] = speed;
    return store;
}

/* Inria's image without its cut, so that the formula holds at every pixel. */
static td_image make_image(void) {
    tides_intrinsics camera = {WIDTH, HEIGHT, focal, focal, centre_x, centre_y, {0}};
    tides_image_params params;
    td_image image;
    tides_error error;
    tides_image_params_defaults(&params);
    params.rules = TIDES_RULES_INRIA;
    params.dilation = dilation;
    params.log_eps = log_eps;
    scene_expect_ok(td_image_resolve(&params, &camera, 0, &image, &error), &error);
    image.cut = image.cut_full = 0;
    image.cut_rule = TD_CUT_NONE;
    image.extent_rule = TD_EXTENT_ELLIPSE;
    image.objects = 1;
    return image;
}

static double *render(int way) {
    tides_scene *scene = make_scene(way);
    tides_trajectory *camera = straight(0, way == CAMERA_MOVES ? -speed : 0);
    td_store store = make_store(scene, way);
    td_image image = make_image();
    image.moving = store.rates != NULL;
    td_image_numbers numbers = td_image_pack(&image);
    td_view view;
    td_backdrop backdrop = {{0}, 0, {0}, 0};
    td_backend *backend = NULL;
    tides_error error;
    scene_expect_ok(td_views_at(scene, camera, 0, time_now, &view, &error), &error);
    for (int c = 0; c < 3; c++) {
        backdrop.colour[c] = backdrop_colour[c];
        backdrop.luminance += luminance_weight[c] * backdrop_colour[c];
    }
    scene_expect_ok(td_backend_create_f64(&store, &numbers, &backend, &error), &error);
    frame_input input = {&store, &numbers, (const double *)&view, (const double *)&backdrop, WIDTH, HEIGHT, TD_OUT_COLOUR};
    double *frame = frame_render(backend, &input, FRAME_SWEPT);
    backend->type->destroy(backend);
    td_store_release(&store);
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
    return frame;
}

typedef struct formula {
    double alpha, alpha_dot, y, y_dot;
} formula;

/* The header's formula at one pixel, with the scene's numbers as the floats that the scene holds. */
static formula evaluate(int column, int row) {
    double p = (start_x + speed * time_now) / depth;
    double s = exp((double)(float)log(sigma)), o = 1 / (1 + exp(-(double)(float)log(opacity / (1 - opacity))));
    double k = focal * focal * s * s / (depth * depth), a = k * (1 + p * p) + dilation, c = k + dilation;
    double a_dot = 2 * k * p * speed / depth, u_dot = focal * speed / depth;
    double dx = column + 0.5 - (focal * p + centre_x), dy = row + 0.5 - centre_y;
    double luminance = 0.5 + sh_constant * (double)(float)grey, behind = 0;
    for (int i = 0; i < 3; i++) behind += luminance_weight[i] * backdrop_colour[i];
    formula f;
    f.alpha = o * exp(-0.5 * (dx * dx / a + dy * dy / c));
    f.alpha_dot = f.alpha * (dx * u_dot / a + 0.5 * dx * dx * a_dot / (a * a));
    f.y = behind + f.alpha * (luminance - behind);
    f.y_dot = f.alpha_dot * (luminance - behind);
    return f;
}

static void assert_close(const char *what, int way, int x, int y, double got, double want, double size) {
    if (!(fabs(got - want) <= 1e-13 * size))
        fail_msg("%s, way %d, pixel (%d, %d): %.17g, not %.17g", what, way, x, y, got, want);
}

static void one_gaussian_passing(void **state) {
    (void)state;
    const size_t pixels = (size_t)WIDTH * HEIGHT;
    for (int way = 0; way < WAYS; way++) {
        double *frame = render(way), most = 0;
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                const double *at = frame + (size_t)y * WIDTH + x;
                formula f = evaluate(x, y);
                double l_dot = f.y_dot / (f.y + log_eps);
                assert_close("L", way, x, y, at[TD_OUT_L * pixels], log(f.y + log_eps), 1);
                assert_close("alpha", way, x, y, at[TD_OUT_ALPHA * pixels], f.alpha, 1);
                assert_close("alpha_dot", way, x, y, at[TD_OUT_ALPHA_DOT * pixels], f.alpha_dot, 10);
                assert_close("L_dot", way, x, y, at[TD_OUT_L_DOT * pixels], l_dot, 10);
                most = fmax(most, fabs(l_dot));
            }
        assert_true(most > 3); /* per second: there was something to see */
        free(frame);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(one_gaussian_passing)};
    return cmocka_run_group_tests_name("render closed form", tests, NULL, NULL);
}
