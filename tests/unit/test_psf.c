/* The PSF against closed forms, on images by a backend of the test: blurs of a Gaussian and of an edge, rates against central
 * differences, borders. On real scenes a tile's blur is equal to the bit whatever other tiles are asked for. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/renderer_of.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 51;
enum { WIDTH = 61, HEIGHT = 43, OUTPUTS = TD_OUT_DIAGNOSTICS };

static void expect_close(double found, double wanted, double off) {
    if (!(fabs(found - wanted) <= off)) fail_msg("%.17g is not within %g of %.17g", found, off, wanted);
}

/* -- images by formula ----------------------------------------------------------------------------------------------------- */

/* L and L_dot at a pixel centre and a slot. */
typedef void (*image_at)(double x, double y, int slot, double *L, double *L_dot);

typedef struct formula_backend {
    td_backend backend;
    image_at image;
} formula_backend;

static tides_status formula_render(td_backend *backend, const td_batch *batch, double *planes, tides_error *error) {
    (void)error;
    for (int j = 0; j < batch->job_count; j++) {
        const td_job *job = &batch->jobs[j];
        double *tile = planes + (size_t)job->out * (size_t)batch->outputs * TD_TILE_PIXELS;
        for (int i = 0; i < TD_TILE_PIXELS; i++) {
            int x = i % TD_TILE, y = i / TD_TILE, at = td_tile_pixel(x, y);
            ((formula_backend *)backend)
                ->image(job->x + x + 0.5, job->y + y + 0.5, job->slot, &tile[TD_OUT_L * TD_TILE_PIXELS + at],
                        &tile[TD_OUT_L_DOT * TD_TILE_PIXELS + at]);
        }
    }
    return TIDES_OK;
}

/* A renderer whose every tile is drawn by `image`. */
typedef struct drawn {
    tides_device *device;
    tides_renderer *renderer;
    random_scene scene;
    td_backend *real;
    td_backend_class type;
    formula_backend formula;
} drawn;

static void draw_with(drawn *d, image_at image, double sigma, int domain) {
    tides_error error;
    random_recipe recipe = recipe_of(SEED);
    recipe.size = 3; /* so that no tile is without Gaussians */
    d->scene = random_scene_make(&recipe);
    d->device = open_device("reference");
    d->renderer = make_renderer(d->device, d->scene.scene, &d->scene.camera, TIDES_RULES_SMOOTH);
    scene_expect_ok(td_renderer_sweep(d->renderer, d->scene.path, 0, 0, &error), &error);
    scene_expect_ok(tides_renderer_set_psf(d->renderer, sigma, domain, &error), &error);
    d->real = d->renderer->backend;
    d->type = *d->real->type;
    d->type.render = formula_render;
    d->formula.backend = *d->real;
    d->formula.backend.type = &d->type;
    d->formula.image = image;
    d->renderer->backend = &d->formula.backend;
}

static void draw_end(drawn *d) {
    d->renderer->backend = d->real;
    tides_renderer_destroy(d->renderer);
    random_scene_free(&d->scene);
    tides_device_close(d->device);
}

/* Every tile at `slots` slots. */
static double *tiles_of(tides_renderer *renderer, const tides_trajectory *path, const double *times, int slots, int outputs) {
    const int tiles = renderer->stats.tiles, asked = slots * tiles;
    double *planes = calloc((size_t)asked * (size_t)outputs * TD_TILE_PIXELS, sizeof *planes);
    td_request *requests = calloc((size_t)asked, sizeof *requests);
    tides_error error;
    assert_true(planes && requests);
    for (int i = 0; i < asked; i++) requests[i] = (td_request){i % tiles, i / tiles, 0};
    scene_expect_ok(td_renderer_tiles(renderer, path, &(td_tile_batch){times, slots, TD_SIDE_BEGINS, requests, asked, outputs},
                                      planes, &error),
                    &error);
    free(requests);
    return planes;
}

static double pixel_of(const tides_renderer *renderer, const double *planes, int outputs, int slot, int plane, int x, int y) {
    int tile = y / TD_TILE * renderer->candidates.tiles_x + x / TD_TILE;
    size_t at = (size_t)((slot * renderer->stats.tiles + tile) * outputs + plane) * TD_TILE_PIXELS;
    return planes[at + (size_t)td_tile_pixel(x % TD_TILE, y % TD_TILE)];
}

static const double no_times[3] = {0, 0, 0};

/* -- closed forms ---------------------------------------------------------------------------------------------------------- */

static const double spot = 2.5, spot_x = 29.3, spot_y = 20.9; /* on no tile border, and reaching over some */

static void gaussian_spot(double x, double y, int slot, double *L, double *L_dot) {
    double r2 = (x - spot_x) * (x - spot_x) + (y - spot_y) * (y - spot_y);
    *L = exp(-0.5 * r2 / (spot * spot));
    *L_dot = -3 * *L;
    (void)slot;
}

/* A Gaussian's blur is a wider one. What is cut off at 4 sigma weighs less than 3e-5, and sampling at whole pixels leaves
 * aliases of relative weight 2 exp(-2 pi^2 sigma^2), along both axes. */
static void test_gaussian(void **state) {
    static const double sigmas[] = {0.7, 1.0, 2.0, 5.0};
    (void)state;
    for (size_t k = 0; k < sizeof sigmas / sizeof *sigmas; k++) {
        drawn d;
        double sigma = sigmas[k], wide = spot * spot + sigma * sigma, worst = 0;
        draw_with(&d, gaussian_spot, sigma, TIDES_PSF_LOG);
        double *planes = tiles_of(d.renderer, d.scene.path, no_times, 1, TD_OUT_SIGNAL);
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                double r2 = (x + 0.5 - spot_x) * (x + 0.5 - spot_x) + (y + 0.5 - spot_y) * (y + 0.5 - spot_y);
                double wanted = spot * spot / wide * exp(-0.5 * r2 / wide);
                double L = pixel_of(d.renderer, planes, TD_OUT_SIGNAL, 0, TD_OUT_L, x, y);
                worst = fmax(worst, fabs(L - wanted));
                expect_close(pixel_of(d.renderer, planes, TD_OUT_SIGNAL, 0, TD_OUT_L_DOT, x, y), -3 * L, 1e-14);
            }
        print_message("sigma %g px: off by %.2g at most\n", sigma, worst);
        assert_true(worst < 3e-5 + 4 * exp(-2 * 9.8696 * sigma * sigma));
        free(planes);
        draw_end(&d);
    }
}

static const double edge = 24; /* between two columns */

static void log_edge(double x, double y, int slot, double *L, double *L_dot) {
    *L = log(x > edge ? 2.0 : 0.5);
    *L_dot = 0;
    (void)y, (void)slot;
}

/* An edge's blur is the normal distribution, in the linear domain that of luminance, to the error of the midpoint rule: a
 * 24th of the Gaussian's largest slope, 0.242 / sigma^2, times the edge's height. */
static void check_edge(int domain) {
    drawn d;
    const double sigma = 3;
    double worst = 0;
    draw_with(&d, log_edge, sigma, domain);
    double *planes = tiles_of(d.renderer, d.scene.path, no_times, 1, TD_OUT_SIGNAL);
    for (int x = 0; x < WIDTH; x++) {
        double share = 0.5 * erfc(-(x + 0.5 - edge) / (sigma * sqrt(2.0)));
        double wanted = domain == TIDES_PSF_LOG ? log(0.5) + share * log(4.0) : log(0.5 + share * 1.5);
        double L = pixel_of(d.renderer, planes, TD_OUT_SIGNAL, 0, TD_OUT_L, x, 17);
        worst = fmax(worst, fabs(L - wanted));
    }
    print_message("edge, domain %d: off by %.2g at most\n", domain, worst);
    assert_true(worst < 0.242 / (24 * sigma * sigma) * (domain == TIDES_PSF_LOG ? log(4.0) : 1.5 / 0.5));
    free(planes);
    draw_end(&d);
}

static void test_edge(void **state) {
    (void)state;
    check_edge(TIDES_PSF_LOG);
    check_edge(TIDES_PSF_LINEAR);
}

static void uniform(double x, double y, int slot, double *L, double *L_dot) {
    *L = -1.25;
    *L_dot = 7;
    (void)x, (void)y, (void)slot;
}

/* What is uniform stays so up to the borders, and with a blur that is wider than the image. */
static void test_uniform(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        drawn d;
        draw_with(&d, uniform, k < 2 ? 1.5 : 30, k % 2);
        double *planes = tiles_of(d.renderer, d.scene.path, no_times, 1, TD_OUT_SIGNAL);
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                expect_close(pixel_of(d.renderer, planes, TD_OUT_SIGNAL, 0, TD_OUT_L, x, y), -1.25, 1e-13);
                expect_close(pixel_of(d.renderer, planes, TD_OUT_SIGNAL, 0, TD_OUT_L_DOT, x, y), 7, 1e-12);
            }
        free(planes);
        draw_end(&d);
    }
}

/* -- rates ----------------------------------------------------------------------------------------------------------------- */

static const double slot_s = 1e-5; /* between two slots */

static void moving_waves(double x, double y, int slot, double *L, double *L_dot) {
    double t = (slot - 1) * slot_s, phase = 0.3 * x - 0.2 * y + 40 * t;
    *L = 1.5 * sin(phase) + 0.5 * cos(0.11 * x * y / 8 + 25 * t);
    *L_dot = 60 * cos(phase) - 12.5 * sin(0.11 * x * y / 8 + 25 * t);
}

/* The blurred rate is the rate of the blurred image, borders included. */
static void test_rates(void **state) {
    (void)state;
    for (int domain = 0; domain < 2; domain++) {
        drawn d;
        double worst = 0;
        draw_with(&d, moving_waves, 1.2, domain);
        double *planes = tiles_of(d.renderer, d.scene.path, no_times, 3, TD_OUT_SIGNAL);
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                double before = pixel_of(d.renderer, planes, TD_OUT_SIGNAL, 0, TD_OUT_L, x, y);
                double after = pixel_of(d.renderer, planes, TD_OUT_SIGNAL, 2, TD_OUT_L, x, y);
                double rate = pixel_of(d.renderer, planes, TD_OUT_SIGNAL, 1, TD_OUT_L_DOT, x, y);
                worst = fmax(worst, fabs((after - before) / (2 * slot_s) - rate));
            }
        print_message("domain %d: rates of up to 70/s off central differences by %.2g/s\n", domain, worst);
        assert_true(worst < 1e-4); /* slot_s^2 / 6 times the third derivative, 1e5/s^3 */
        free(planes);
        draw_end(&d);
    }
}

/* -- tiles ----------------------------------------------------------------------------------------------------------------- */

/* A real scene, whole frames at three times in one call, against tiles asked for one by one, and in odd company. */
static void check_tiles(tides_renderer *renderer, const random_scene *s) {
    enum { SLOTS = 3 };
    static const double times[SLOTS] = {0.2, 0.201, 0.203};
    tides_error error;
    int tiles = renderer->stats.tiles, size = OUTPUTS * TD_TILE_PIXELS;
    scene_expect_ok(td_renderer_sweep(renderer, s->path, times[0], times[SLOTS - 1], &error), &error);
    uint64_t before = renderer->backend->stats.tile_jobs + renderer->stats.tile_jobs_skipped;
    double *whole = tiles_of(renderer, s->path, times, SLOTS, OUTPUTS);
    assert_int_equal(renderer->backend->stats.tile_jobs + renderer->stats.tile_jobs_skipped - before, SLOTS * tiles);
    double *some = calloc((size_t)size * 4, sizeof *some);
    assert_non_null(some);
    for (int i = 0; i < SLOTS * tiles; i++) {
        td_request alone = {i % tiles, 0, 0};
        scene_expect_ok(td_renderer_tiles(renderer, s->path,
                                          &(td_tile_batch){&times[i / tiles], 1, TD_SIDE_BEGINS, &alone, 1, OUTPUTS}, some,
                                          &error),
                        &error);
        assert_memory_equal(some, whole + (size_t)i * size, (size_t)size * sizeof *some);
        int other = (7 * i + 3) % (SLOTS * tiles);
        td_request company[4] = {{other % tiles, other / tiles, 0},
                                 {i % tiles, i / tiles, 0},
                                 {0, 2, 0},
                                 {i % tiles, i / tiles, 0}};
        scene_expect_ok(td_renderer_tiles(renderer, s->path,
                                          &(td_tile_batch){times, SLOTS, TD_SIDE_BEGINS, company, 4, OUTPUTS}, some, &error),
                        &error);
        assert_memory_equal(some, whole + (size_t)other * size, (size_t)size * sizeof *some);
        assert_memory_equal(some + size, whole + (size_t)i * size, (size_t)size * sizeof *some);
        assert_memory_equal(some + 3 * size, whole + (size_t)i * size, (size_t)size * sizeof *some);
    }
    free(some);
    free(whole);
}

static void test_tiles_alone(void **state) {
    static const double sigmas[] = {0.4, 1.5, 6.0};
    (void)state;
    tides_device *device = open_fast_device();
    for (int k = 0; k < 6; k++) {
        random_recipe recipe = recipe_of(SEED + (uint64_t)k);
        random_scene s = random_scene_make(&recipe);
        tides_renderer *renderer = make_renderer(device, s.scene, &s.camera, TIDES_RULES_SMOOTH);
        assert_int_equal(tides_renderer_set_psf(renderer, sigmas[k % 3], k / 3, NULL), TIDES_OK);
        check_tiles(renderer, &s);
        tides_renderer_destroy(renderer);
        random_scene_free(&s);
    }
    tides_device_close(device);
}

/* A frame through the public call: Y goes with L, what isn't blurred is as without. */
static void test_frame(void **state) {
    (void)state;
    random_recipe recipe = recipe_of(SEED);
    random_scene s = random_scene_make(&recipe);
    tides_device *device = open_device("reference");
    tides_renderer *renderer = make_renderer(device, s.scene, &s.camera, TIDES_RULES_SMOOTH);
    enum { PIXELS = WIDTH * HEIGHT };
    static double Y[PIXELS], L[PIXELS], A[PIXELS], sharp_L[PIXELS], sharp_A[PIXELS];
    tides_frame sharp = {.plane = {[TIDES_L] = sharp_L, [TIDES_ALPHA] = sharp_A}};
    tides_frame blurred = {.plane = {[TIDES_Y] = Y, [TIDES_L] = L, [TIDES_ALPHA] = A}};
    assert_int_equal(tides_renderer_frame(renderer, s.path, 0.3, &sharp, NULL), TIDES_OK);
    for (int domain = 0; domain < 2; domain++) {
        double changed = 0;
        assert_int_equal(tides_renderer_set_psf(renderer, 1.5, domain, NULL), TIDES_OK);
        assert_int_equal(tides_renderer_frame(renderer, s.path, 0.3, &blurred, NULL), TIDES_OK);
        for (int i = 0; i < PIXELS; i++) {
            expect_close(L[i], log(Y[i] + 1e-3), 1e-9);
            changed = fmax(changed, fabs(L[i] - sharp_L[i]));
        }
        assert_true(changed > 0.1);
        assert_memory_equal(A, sharp_A, sizeof A);
    }
    assert_int_equal(tides_renderer_set_psf(renderer, 0, TIDES_PSF_LOG, NULL), TIDES_OK);
    assert_int_equal(tides_renderer_frame(renderer, s.path, 0.3, &blurred, NULL), TIDES_OK);
    assert_memory_equal(L, sharp_L, sizeof L);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    random_scene_free(&s);
}

/* A whole image at once is, to the bit, what its tiles are. */
static void test_whole_image(void **state) {
    (void)state;
    tides_error error;
    random_recipe recipe = recipe_of(SEED);
    random_scene s = random_scene_make(&recipe);
    tides_device *device = open_device("reference");
    tides_renderer *renderer = make_renderer(device, s.scene, &s.camera, TIDES_RULES_SMOOTH);
    double *whole = calloc(WIDTH * HEIGHT, sizeof *whole), *tiled = calloc(WIDTH * HEIGHT, sizeof *tiled);
    assert_true(whole && tiled);
    for (int i = 0; i < 2; i++) {
        const double sigma = i ? 12 : 0.7; /* one reaches beyond both borders at once */
        tides_frame sharp = {{NULL}}, blurred = {{NULL}};
        sharp.plane[TIDES_L] = whole;
        blurred.plane[TIDES_L] = tiled;
        scene_expect_ok(tides_renderer_set_psf(renderer, 0, TIDES_PSF_LOG, &error), &error);
        scene_expect_ok(tides_renderer_frame(renderer, s.path, 0.3, &sharp, &error), &error);
        scene_expect_ok(tides_renderer_set_psf(renderer, sigma, TIDES_PSF_LOG, &error), &error);
        scene_expect_ok(tides_renderer_frame(renderer, s.path, 0.3, &blurred, &error), &error);
        scene_expect_ok(td_psf_image(&renderer->psf, WIDTH, HEIGHT, whole, &error), &error);
        assert_memory_equal(whole, tiled, WIDTH * HEIGHT * sizeof *whole);
    }
    free(whole);
    free(tiled);
    tides_renderer_destroy(renderer);
    random_scene_free(&s);
    tides_device_close(device);
}

static void test_refused(void **state) {
    td_psf psf = {0};
    tides_error error;
    (void)state;
    assert_int_equal(td_psf_set(&psf, -1, TIDES_PSF_LOG, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(td_psf_set(&psf, NAN, TIDES_PSF_LOG, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "psf_sigma_px"));
    assert_int_equal(td_psf_set(&psf, 1, 2, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "psf_domain"));
    assert_int_equal(tides_renderer_set_psf(NULL, 1, TIDES_PSF_LOG, &error), TIDES_BAD_ARGUMENT);
}

int main(void) {
    print_message("seed %d\n", (int)SEED);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gaussian),    cmocka_unit_test(test_edge),        cmocka_unit_test(test_uniform),
        cmocka_unit_test(test_rates),       cmocka_unit_test(test_tiles_alone), cmocka_unit_test(test_frame),
        cmocka_unit_test(test_whole_image), cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
