/* Light of coded colours against other people's renderers: every file of $TIDES_SHARED/golden/render (INRIA's rules, gsplat's,
 * and the ideal image), rendered by the double reference as sRGB and as a power. L, L_dot and Y are those of the file's own
 * colours and rates, decoded here from IEC 61966-2-1. Each file is taken before a second backdrop, too, whose colours are
 * below 0 and above 1: by the file's alpha, which says how much of the backdrop is seen.
 *
 * Excepted are pixels that the file marks as within rounding of a cutoff. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_renderer.h"

#include "tests/support/golden_render.h"
#include "tests/support/render_frame.h"
#include "tests/support/scene_folder.h"
#include "tests/support/shared.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define TOLERANCE 1e-12
#define MARGIN 1e-12

typedef struct coding {
    const char *name;
    int32_t transfer;
    double gamma;
} coding;
static const coding codings[] = {{"srgb", TIDES_TRANSFER_SRGB, 0}, {"gamma 2.2", TIDES_TRANSFER_GAMMA, 2.2}};
enum { CODINGS = sizeof codings / sizeof *codings };

/* Added to a file's backdrop: nothing, or colours below 0 and above 1. */
static const double further[][3] = {{0, 0, 0}, {-1.5, 0.4, 2}};
enum { BACKDROPS = sizeof further / sizeof *further };

/* IEC 61966-2-1, or a power; below 0 the tangent in 0. */
static double light_of(const coding *c, double x) {
    if (c->transfer == TIDES_TRANSFER_SRGB) return x > 0.04045 ? pow((x + 0.055) / 1.055, 2.4) : x / 12.92;
    return x > 0 ? pow(x, c->gamma) : 0;
}

static double growth_of(const coding *c, double x) {
    if (c->transfer == TIDES_TRANSFER_SRGB) return x > 0.04045 ? 2.4 / 1.055 * pow((x + 0.055) / 1.055, 1.4) : 1 / 12.92;
    return x > 0 ? c->gamma * pow(x, c->gamma - 1) : 0;
}

typedef struct tally {
    double worst;
    size_t compared, excepted, below, above;
    char where[96];
} tally;

static void note(tally *of, const char *name, const char *what, size_t pixel, double found, double wanted, double scale) {
    const double error = fabs(found - wanted) / scale;
    if (error <= of->worst) return;
    of->worst = isnan(error) ? INFINITY : error;
    snprintf(of->where, sizeof of->where, "%s, %s of pixel %zu: %.17g for %.17g", name, what, pixel, found, wanted);
}

static double *render(const golden_file *file, int time, const coding *c, const double add[3]) {
    td_store store = golden_store(file, time, file->sh_degree);
    td_image_numbers image = golden_coded_image(file, file->sh_degree, TD_OUT_COLOUR, c->transfer, c->gamma);
    double view[TD_VIEW_REALS], reals[TD_BACKDROP_REALS];
    td_backdrop backdrop;
    td_backend *backend = NULL;
    tides_error error;
    golden_view(file, time, view);
    golden_backdrop(file, time, reals);
    memcpy(&backdrop, reals, sizeof backdrop);
    backdrop.luminance = 0;
    for (int k = 0; k < 3; k++) {
        backdrop.colour[k] += add[k];
        backdrop.luminance = fmax(backdrop.luminance, backdrop.colour[k]);
    }
    memcpy(reals, &backdrop, sizeof backdrop);
    scene_expect_ok(td_backend_create_f64(&store, &image, &backend, &error), &error);
    const frame_input input = {&store, &image, view, reals, file->width, file->height, TD_OUT_COLOUR};
    double *frame = frame_render(backend, &input, FRAME_SWEPT);
    backend->type->destroy(backend);
    td_store_release(&store);
    return frame;
}

/* A pixel of the file in light, and as the frame has it. */
static void compare(const golden_file *file, const coding *c, const double add[3], const double *frame, size_t first, size_t i,
                    tally *of) {
    const size_t pixels = (size_t)file->width * (size_t)file->height, at = first + i;
    const double *weight = golden_reals(file, "lum_w"), eps = *golden_reals(file, "lum_eps");
    const double left = 1 - golden_reals(file, "alpha")[at], left_dot = -golden_reals(file, "alpha_dot")[at];
    double Y = 0, Y_dot = 0, growth = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        const double x = golden_reals(file, "image")[3 * at + (size_t)k] + left * add[k];
        const double rate = golden_reals(file, "image_dot")[3 * at + (size_t)k] + left_dot * add[k];
        Y += weight[k] * light_of(c, x);
        Y_dot += weight[k] * growth_of(c, x) * rate;
        growth = fmax(growth, growth_of(c, x));
        size += fabs(rate);
        of->below += x < 0;
        of->above += x > 1;
    }
    if (Y < 0) Y = Y_dot = 0;
    const double per = growth / (Y + eps);
    of->compared++;
    note(of, c->name, "Y", at, frame[TD_OUT_Y * pixels + i], Y, 1 + growth);
    note(of, c->name, "L", at, frame[TD_OUT_L * pixels + i], log(Y + eps), 1 + per);
    note(of, c->name, "L_dot", at, frame[TD_OUT_L_DOT * pixels + i], Y_dot / (Y + eps), (1 + size) * (1 + per) * (1 + per));
}

static int near_cutoff(const golden_file *file, size_t pixel) {
    return golden_reals(file, "margin_alpha")[pixel] < MARGIN || golden_reals(file, "margin_T")[pixel] < MARGIN ||
           golden_reals(file, "margin_sat")[pixel] < MARGIN;
}

static int visit(void *user, const char *path, const char *name) {
    tally *all = user, own = {0};
    golden_file file = golden_open(path);
    const size_t pixels = (size_t)file.width * (size_t)file.height;
    for (int t = 0; t < file.times; t++)
        for (int k = 0; k < CODINGS; k++)
            for (int b = 0; b < BACKDROPS; b++) {
                double *frame = render(&file, t, &codings[k], further[b]);
                for (size_t i = 0; i < pixels; i++)
                    if (near_cutoff(&file, (size_t)t * pixels + i))
                        own.excepted++;
                    else
                        compare(&file, &codings[k], further[b], frame, (size_t)t * pixels, i, &own);
                free(frame);
            }
    print_message("    %-32s %-12s %.1e (%s)\n", name, file.mode, own.worst, own.where);
    golden_close(&file);
    all->compared += own.compared;
    all->excepted += own.excepted;
    all->below += own.below;
    all->above += own.above;
    if (own.worst > all->worst) *all = (tally){own.worst, all->compared, all->excepted, all->below, all->above, ""};
    return 0;
}

static void coded_images(void **state) {
    (void)state;
    char folder[1024];
    tally all = {0};
    if (shared_path(folder, sizeof folder, "golden/render") != 0) skip();
    assert_true(shared_scan(folder, ".npz", visit, &all) > 0);
    print_message("    %zu pixels, %zu excepted; %zu colours below 0, %zu above 1\n", all.compared, all.excepted, all.below,
                  all.above);
    assert_true(all.below > 1000 && all.above > 1000);
    assert_true((double)all.excepted <= 1e-3 * (double)all.compared);
    if (!(all.worst <= TOLERANCE)) fail_msg("off by %g: see the lines above", all.worst);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(coded_images)};
    return cmocka_run_group_tests_name("golden render: coded images", tests, NULL, NULL);
}
