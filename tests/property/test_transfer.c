/* Light of coded colours: the reference's image is w . f(c) of the colours c that it composites, with its rates. f is written
 * here from IEC 61966-2-1 and the meaning of an exponent. A backdrop is light. Above 1 and below 0 f continues, with its
 * slope. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#define TD_REAL_DOUBLE
#include "kernels/transfer.h"
#include "renderer_of.h"
#include "render/td_transfer.h"

#include <math.h>
#include <stdlib.h>

static const double weight[3] = {0.2126, 0.7152, 0.0722};
static const double log_eps = 1e-3, when = 0.37;

typedef struct coding {
    const char *name;
    int32_t transfer;
    double gamma;
} coding;

static const coding codings[] = {{"srgb", TIDES_TRANSFER_SRGB, 0}, {"gamma 2.2", TIDES_TRANSFER_GAMMA, 2.2}};

/* IEC 61966-2-1 or a power; below 0 the tangent in 0. */
static double light_of(const coding *c, double x) {
    if (c->transfer == TIDES_TRANSFER_SRGB) return x > 0.04045 ? pow((x + 0.055) / 1.055, 2.4) : x / 12.92;
    return x > 0 ? pow(x, c->gamma) : 0;
}

static double growth_of(const coding *c, double x) {
    if (c->transfer == TIDES_TRANSFER_SRGB) return x > 0.04045 ? 2.4 / 1.055 * pow((x + 0.055) / 1.055, 1.4) : 1 / 12.92;
    return x > 0 ? c->gamma * pow(x, c->gamma - 1) : 0;
}

static double colour_of(const coding *c, double light) {
    if (c->transfer == TIDES_TRANSFER_SRGB) return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
    return pow(light, 1 / c->gamma);
}

/* -- f --------------------------------------------------------------------------------------------------------------------- */

static td_image image_of(const coding *c) {
    td_image image = {.log_eps = log_eps, .luminance = {0.2126, 0.7152, 0.0722}};
    td_image_set_transfer(c->transfer, c->gamma, &image);
    return image;
}

static void test_f_and_its_slope(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof codings / sizeof *codings; k++) {
        const td_image image = image_of(&codings[k]);
        for (double x = -3; x < 20; x += 0.0137) {
            double growth;
            const double light = td_light_of(&image, x, &growth), wanted = light_of(&codings[k], x);
            const double slope = growth_of(&codings[k], x);
            if (fabs(light - wanted) > 1e-14 * (1 + fabs(wanted)) || fabs(growth - slope) > 1e-14 * (1 + slope))
                fail_msg("%s: f(%g) = %.17g, slope %.17g, where %.17g and %.17g are right", codings[k].name, x, light, growth,
                         wanted, slope);
        }
    }
}

/* f and its slope are continuous in 0 and 1, and the slope never falls; sRGB's own joint is off by what the standard's numbers
 * are. */
static void test_joints(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof codings / sizeof *codings; k++) {
        const td_image image = image_of(&codings[k]);
        for (int joint = 0; joint <= 1; joint++) {
            double before, after;
            const double below = td_light_of(&image, joint - 1e-9, &before), above = td_light_of(&image, joint + 1e-9, &after);
            assert_true(fabs(above - below) < 1e-8 && fabs(after - before) < 1e-7);
        }
        double last = 0, growth;
        for (double x = -1; x < 3; x += 1e-4) {
            (void)td_light_of(&image, x, &growth);
            assert_true(growth >= last);
            last = growth;
        }
        for (double light = 0; light < 5; light += 0.001) {
            double unused;
            const double back = td_light_of(&image, td_transfer_colour(&image.transfer, light), &unused);
            assert_true(fabs(back - light) < 1e-7 * (1 + light));
        }
    }
}

/* -- images ---------------------------------------------------------------------------------------------------------------- */

enum { WIDTH = 48, HEIGHT = 32, PIXELS = WIDTH * HEIGHT };
typedef double planes[TIDES_CHANNELS][PIXELS];

static void render(const random_scene *s, int rules, int32_t transfer, double gamma, const double background[3], planes out) {
    tides_renderer *renderer = NULL;
    tides_image_params params;
    tides_device *device = open_device("reference");
    tides_frame frame = {{NULL}};
    tides_error error;
    tides_image_params_defaults(&params);
    params.rules = rules;
    params.transfer = transfer;
    params.gamma = gamma;
    params.log_eps = log_eps;
    params.smoothing.stop_change = 1e-13;
    memcpy(params.background, background, sizeof params.background);
    scene_expect_ok(tides_renderer_create(device, s->scene, &s->camera, &params, NULL, NULL, &renderer, &error), &error);
    for (int c = 0; c < TIDES_CHANNELS; c++) frame.plane[c] = out[c];
    scene_expect_ok(tides_renderer_frame(renderer, s->path, when, &frame, &error), &error);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
}

static void expect_near(const char *name, const char *what, int rules, double found, double wanted, double scale) {
    if (!(fabs(found - wanted) <= 1e-12 * scale))
        fail_msg("%s, rules %d: %s is %.17g, where %.17g is right", name, rules, what, found, wanted);
}

/* One pixel of coded light against the colours that it is made of. How many channels are above 1. */
static void check_pixel(const coding *c, int rules, planes colours, planes lights, int i, int *above) {
    double Y = 0, Y_dot = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        const double x = colours[TIDES_R + k][i], rate = colours[TIDES_R_DOT + k][i];
        const double light = light_of(c, x), light_dot = growth_of(c, x) * rate;
        expect_near(c->name, "a channel's light", rules, lights[TIDES_R + k][i], light, 1 + fabs(light));
        expect_near(c->name, "its rate", rules, lights[TIDES_R_DOT + k][i], light_dot, 10 + fabs(light_dot));
        Y += weight[k] * light;
        Y_dot += weight[k] * light_dot;
        size += fabs(light_dot);
        *above += x > 1;
    }
    if (Y < 0) Y = Y_dot = 0;
    expect_near(c->name, "Y", rules, lights[TIDES_Y][i], Y, 1 + Y);
    expect_near(c->name, "L", rules, lights[TIDES_L][i], log(Y + log_eps), 1 + 1 / (Y + log_eps));
    expect_near(c->name, "L_dot", rules, lights[TIDES_L_DOT][i], Y_dot / (Y + log_eps),
                (10 + size) / (Y + log_eps) * (1 + 1 / (Y + log_eps)));
}

/* Splats so large that most pixels see several, of colours up to 2 and more. */
static random_scene scene_of(uint64_t seed) {
    random_recipe recipe = random_recipe_defaults(seed);
    recipe.width = WIDTH;
    recipe.height = HEIGHT;
    recipe.size = 0.25;
    return random_scene_make(&recipe);
}

static void test_images_are_decoded(void **state) {
    static planes colours, lights;
    int above = 0;
    (void)state;
    for (size_t k = 0; k < sizeof codings / sizeof *codings; k++)
        for (int rules = TIDES_RULES_SMOOTH; rules <= TIDES_RULES_GSPLAT; rules++) {
            const coding *c = &codings[k];
            random_scene s = scene_of(77 + k);
            const double background[3] = {0.3, 0.001, 1.7};
            double coded[3];
            for (int i = 0; i < 3; i++) coded[i] = colour_of(c, background[i]);
            render(&s, rules, TIDES_TRANSFER_LINEAR, 0, coded, colours);
            render(&s, rules, c->transfer, c->gamma, background, lights);
            for (int i = 0; i < PIXELS; i++) {
                check_pixel(c, rules, colours, lights, i, &above);
                expect_near(c->name, "alpha", rules, lights[TIDES_ALPHA][i], colours[TIDES_ALPHA][i], 1);
                expect_near(c->name, "depth", rules, lights[TIDES_Z][i], colours[TIDES_Z][i], 10);
            }
            random_scene_free(&s);
        }
    assert_true(above > 100);
}

/* An exponent of 1 is linear light, to the bit, and so is a scene in memory that says nothing. */
static void test_linear_keeps_its_bits(void **state) {
    static planes one, other;
    static const double background[3] = {0.2, 0.3, 0.4};
    (void)state;
    random_scene s = scene_of(81);
    render(&s, TIDES_RULES_SMOOTH, TIDES_TRANSFER_LINEAR, 0, background, one);
    render(&s, TIDES_RULES_SMOOTH, TIDES_TRANSFER_GAMMA, 1, background, other);
    assert_memory_equal(one, other, sizeof one);
    render(&s, TIDES_RULES_SMOOTH, TIDES_TRANSFER_FILE, 0, background, other);
    assert_memory_equal(one, other, sizeof one);
    random_scene_free(&s);
}

/* What one key and one scene may not be. */
static void test_refused(void **state) {
    tides_renderer *renderer = NULL;
    tides_image_params params;
    tides_error error;
    (void)state;
    random_scene s = scene_of(82);
    tides_device *device = open_device("reference");
    tides_image_params_defaults(&params);
    const struct {
        int32_t transfer;
        double gamma;
        const char *word;
    } cases[] = {{TIDES_TRANSFER_GAMMA, 0.5, "image.gamma"},
                 {TIDES_TRANSFER_GAMMA, NAN, "image.gamma"},
                 {7, 1, "image.transfer"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        params.transfer = cases[i].transfer;
        params.gamma = cases[i].gamma;
        assert_int_equal(tides_renderer_create(device, s.scene, &s.camera, &params, NULL, NULL, &renderer, &error),
                         TIDES_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, cases[i].word));
    }
    tides_device_close(device);
    random_scene_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_f_and_its_slope), cmocka_unit_test(test_joints),
                                       cmocka_unit_test(test_images_are_decoded), cmocka_unit_test(test_linear_keeps_its_bits),
                                       cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
