/* Wide point spread functions, which are blurred on a coarse image: against the sampled Gaussian, pixel by pixel; at a cost
 * that doesn't grow with the width; single tiles and an image at once to the same bits; and stopped on request. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/renderer_of.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <stdlib.h>

enum { WIDTH = 173, HEIGHT = 131, PIXELS = WIDTH * HEIGHT };

/* -- against the sum ----------------------------------------------------------------------------------------------- */

static int clamp(int value, int last) { return value < 0 ? 0 : value > last ? last : value; }

/* The Gaussian sampled at whole pixels, cut at 6 sigma: farther than the kernels are, so that their cut counts too. */
static void blur_line(const double *in, int count, size_t stride, double sigma, double *out) {
    const int radius = (int)ceil(6 * sigma);
    double *weight = calloc((size_t)radius + 1, sizeof *weight);
    assert_non_null(weight);
    for (int k = 0; k <= radius; k++) weight[k] = exp(-0.5 * k * k / (sigma * sigma));
    for (int i = 0; i < count; i++) {
        double sum = 0, weights = 0;
        for (int k = -radius; k <= radius; k++) {
            sum += weight[abs(k)] * in[(size_t)clamp(i + k, count - 1) * stride];
            weights += weight[abs(k)];
        }
        out[(size_t)i * stride] = sum / weights;
    }
    free(weight);
}

static void blur(const double *image, double sigma, double *out) {
    double *rows = calloc(PIXELS, sizeof *rows);
    assert_non_null(rows);
    for (int y = 0; y < HEIGHT; y++) blur_line(image + y * WIDTH, WIDTH, 1, sigma, rows + y * WIDTH);
    for (int x = 0; x < WIDTH; x++) blur_line(rows + x, HEIGHT, WIDTH, sigma, out + x);
    free(rows);
}

/* Images that span [0, 1], or [-1, 1]: an edge off the cells, points, a chequered one (the finest there is), noise, a ramp. */
enum { IMAGES = 5 };
static double pixel(int image, int x, int y) {
    switch (image) {
        case 0: return x + 0.3 * y > 90.4;
        case 1: return 400.0 * ((x == 77 && y == 50) || (x == 2 && y == 129) || (x == 171 && y == 3));
        case 2: return (x + y) % 2 ? 1 : -1;
        case 3: return ldexp((double)((unsigned)(x * 73856093 ^ y * 19349663) * 2654435761u), -32);
        default: return (double)x / WIDTH;
    }
}

/* A point of 400 has a peak of 1 at 8 px, and less beyond. */
static void test_accurate(void **state) {
    static const double sigmas[] = {8.1, 11.9, 12, 23, 78, 300};
    double *image = calloc(PIXELS, sizeof *image), *wanted = calloc(PIXELS, sizeof *wanted);
    double worst = 0;
    tides_error error;
    (void)state;
    assert_true(image && wanted);
    for (size_t k = 0; k < sizeof sigmas / sizeof *sigmas; k++)
        for (int i = 0; i < IMAGES; i++) {
            td_psf psf = {0};
            double off = 0;
            for (int p = 0; p < PIXELS; p++) image[p] = pixel(i, p % WIDTH, p / WIDTH);
            blur(image, sigmas[k], wanted);
            scene_expect_ok(td_psf_set(&psf, sigmas[k], TIDES_PSF_LOG, &error), &error);
            assert_true(psf.wide.step > 0);
            scene_expect_ok(td_psf_image(&psf, WIDTH, HEIGHT, image, &error), &error);
            for (int p = 0; p < PIXELS; p++) off = fmax(off, fabs(image[p] - wanted[p]));
            print_message("sigma %g px, image %d: off by %.2g at most\n", sigmas[k], i, off);
            worst = fmax(worst, off);
            assert_true(i == 1 || off < 3e-5);
            td_psf_release(&psf);
        }
    assert_true(worst < 2e-4); /* of points; 3e-5 of all else */
    free(image);
    free(wanted);
}

/* -- cost ---------------------------------------------------------------------------------------------------------- */

/* The best of five, of an image that all kernels are smaller than. */
static double seconds_of(double sigma) {
    enum { SIDE = 512 };
    double *image = calloc((size_t)SIDE * SIDE, sizeof *image), best = INFINITY;
    td_psf psf = {0};
    tides_error error;
    assert_non_null(image);
    scene_expect_ok(td_psf_set(&psf, sigma, TIDES_PSF_LOG, &error), &error);
    for (int i = 0; i < 5; i++) {
        const double begun = td_now();
        scene_expect_ok(td_psf_image(&psf, SIDE, SIDE, image, &error), &error);
        best = fmin(best, td_now() - begun);
    }
    td_psf_release(&psf);
    free(image);
    return best;
}

/* The direct kernel takes 11 times as long for 90 px as for 8. */
static void test_cost(void **state) {
    (void)state;
    const double narrow = seconds_of(8.5), wide = seconds_of(90);
    print_message("%.3g s at 8.5 px, %.3g s at 90 px\n", narrow, wide);
    assert_true(wide < 2.5 * narrow);
}

/* -- in the renderer ----------------------------------------------------------------------------------------------- */

static tides_renderer *open_renderer(random_scene *scene, tides_device *device, double sigma, int domain) {
    random_recipe recipe = recipe_of(77);
    *scene = random_scene_make(&recipe);
    tides_renderer *renderer = make_renderer(device, scene->scene, &scene->camera, TIDES_RULES_SMOOTH);
    assert_int_equal(tides_renderer_set_psf(renderer, sigma, domain, NULL), TIDES_OK);
    return renderer;
}

static tides_status tiles(tides_renderer *renderer, const random_scene *s, const td_request *requests, int count, int slots,
                          double *planes, tides_error *error) {
    static const double times[] = {0.2, 0.201};
    const td_tile_batch batch = {times, slots, TD_SIDE_BEGINS, requests, count, TD_OUT_DIAGNOSTICS};
    return td_renderer_tiles(renderer, s->path, &batch, planes, error);
}

/* A tile's L and L_dot are the same whatever else is asked for, and backwards. */
static void test_tiles_alone(void **state) {
    tides_error error;
    (void)state;
    for (int k = 0; k < 4; k++) {
        random_scene s;
        tides_device *device = open_device("reference");
        tides_renderer *renderer = open_renderer(&s, device, k < 2 ? 9 : 40, k % 2);
        scene_expect_ok(td_renderer_sweep(renderer, s.path, 0.2, 0.201, &error), &error);
        const int count = renderer->stats.tiles, size = TD_OUT_DIAGNOSTICS * TD_TILE_PIXELS;
        double *all = calloc((size_t)(2 * count) * size, sizeof *all), *one = calloc((size_t)size, sizeof *one);
        td_request *requests = calloc((size_t)(2 * count), sizeof *requests);
        assert_true(all && one && requests);
        for (int i = 0; i < 2 * count; i++) requests[i] = (td_request){count - 1 - i % count, i / count, 0};
        scene_expect_ok(tiles(renderer, &s, requests, 2 * count, 2, all, &error), &error);
        for (int i = 0; i < 2 * count; i++) {
            scene_expect_ok(tiles(renderer, &s, &requests[i], 1, 2, one, &error), &error);
            assert_memory_equal(one, all + (size_t)i * size, (size_t)size * sizeof *one);
        }
        free(all);
        free(one);
        free(requests);
        tides_renderer_destroy(renderer);
        random_scene_free(&s);
        tides_device_close(device);
    }
}

/* The rate is the blurred image's, to what differences over 1 ms leave of it: both go through the same cells. */
static void test_rates(void **state) {
    double *L = calloc(PIXELS, sizeof *L), *rate = calloc(PIXELS, sizeof *rate), *later = calloc(PIXELS, sizeof *later);
    td_psf psf = {0};
    tides_error error;
    (void)state;
    assert_true(L && rate && later);
    for (int p = 0; p < PIXELS; p++) {
        L[p] = pixel(0, p % WIDTH, p / WIDTH);
        rate[p] = pixel(3, p % WIDTH, p / WIDTH);
        later[p] = L[p] + 1e-3 * rate[p];
    }
    scene_expect_ok(td_psf_set(&psf, 20, TIDES_PSF_LOG, &error), &error);
    scene_expect_ok(td_psf_image(&psf, WIDTH, HEIGHT, L, &error), &error);
    scene_expect_ok(td_psf_image(&psf, WIDTH, HEIGHT, rate, &error), &error);
    scene_expect_ok(td_psf_image(&psf, WIDTH, HEIGHT, later, &error), &error);
    for (int p = 0; p < PIXELS; p++) assert_true(fabs((later[p] - L[p]) / 1e-3 - rate[p]) < 1e-11);
    td_psf_release(&psf);
    free(L);
    free(rate);
    free(later);
}

/* Asked between tiles, and stopped at the n-th time. */
typedef struct asked {
    int count, stop_at;
} asked;

static int interrupt(void *user) {
    asked *a = user;
    return ++a->count == a->stop_at;
}

static void test_stopped(void **state) {
    static const double sigmas[] = {7, 40};
    tides_error error;
    (void)state;
    for (int k = 0; k < 2; k++) {
        random_scene s;
        tides_device *device = open_device("reference");
        tides_renderer *renderer = open_renderer(&s, device, sigmas[k], TIDES_PSF_LOG);
        scene_expect_ok(td_renderer_sweep(renderer, s.path, 0.2, 0.201, &error), &error);
        const int count = renderer->stats.tiles;
        double *planes = calloc((size_t)count * TD_OUT_DIAGNOSTICS * TD_TILE_PIXELS, sizeof *planes);
        td_request *requests = calloc((size_t)count, sizeof *requests);
        assert_true(planes && requests);
        for (int i = 0; i < count; i++) requests[i] = (td_request){i, 0, 0};
        asked whole = {0, 0}, sharp = {0, 0};
        td_renderer_set_interrupt(renderer, interrupt, &whole);
        scene_expect_ok(tiles(renderer, &s, requests, count, 1, planes, &error), &error);
        assert_int_equal(tides_renderer_set_psf(renderer, 0, TIDES_PSF_LOG, NULL), TIDES_OK);
        td_renderer_set_interrupt(renderer, interrupt, &sharp);
        scene_expect_ok(tiles(renderer, &s, requests, count, 1, planes, &error), &error);
        print_message("%d tiles: asked %d times with a blur, %d without\n", count, whole.count, sharp.count);
        assert_true(whole.count >= sharp.count + count / 16);
        assert_int_equal(tides_renderer_set_psf(renderer, sigmas[k], TIDES_PSF_LOG, NULL), TIDES_OK);
        asked last = {0, whole.count};
        td_renderer_set_interrupt(renderer, interrupt, &last);
        assert_int_equal(tiles(renderer, &s, requests, count, 1, planes, &error), TIDES_CANCELLED);
        asked again = {0, 0};
        td_renderer_set_interrupt(renderer, interrupt, &again);
        scene_expect_ok(tiles(renderer, &s, requests, count, 1, planes, &error), &error); /* nothing is left behind */
        free(planes);
        free(requests);
        tides_renderer_destroy(renderer);
        random_scene_free(&s);
        tides_device_close(device);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_accurate), cmocka_unit_test(test_cost),
                                       cmocka_unit_test(test_tiles_alone), cmocka_unit_test(test_rates),
                                       cmocka_unit_test(test_stopped)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
