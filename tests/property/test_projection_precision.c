/* Precision of the rates of projected covariances in single precision, for gsplat's rules with principal points anywhere,
 * inside the picture or out of it.
 *
 * The limits. Inputs are rounded to e = 2^-24 of themselves, and sums likewise. p = R m + t is then good to a few e
 * (|m| + |t|), and 1 / z to a few e kappa of itself, with kappa = (|m| + |t|) / z. The covariance is A A^T with A = T M, each
 * entry good to a few e kappa |T| |M|. Relative to A that is a few e kappa beam, with beam = |T| |M| / sqrt(|cov|). beam is
 * large for long Gaussians seen end on: their length is in M, and hardly in A. Covariance and rate are of second order in A,
 * and 1 / z enters the rate up to three times. So 16 e kappa beam, 1e-6 kappa beam, bounds the sum of a few of each. It is the
 * inputs' rounding more than the arithmetic's: in the worst cases found, the double kernel with inputs rounded to single has
 * two thirds of the single one's error, so that no order of operations would help. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "motion/td_activate.h"
#include "render/td_renderer.h"
#include "td_random.h"

#include "tests/support/golden_render.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t SEED = 20261;
enum { CAMERAS = 4000, COUNT = 25, WIDTH = 64, HEIGHT = 48, MARGIN = 30 };

/* -- random numbers -------------------------------------------------------------------------------------------------------- */

static uint64_t drawn;

static double uniform(double low, double high) {
    td_random_bits bits = td_random(SEED, 0, drawn++, 0);
    return low + (high - low) * td_random_uniform(&bits, 0);
}

static void normals(double *x, int count, double size) {
    for (int i = 0; i < count; i++) {
        double pair[2];
        td_random_bits bits = td_random(SEED, 0, drawn++, 0);
        td_random_normals(&bits, pair);
        x[i] = size * pair[0];
    }
}

static double norm(const double *x, int count) {
    double sum = 0;
    for (int i = 0; i < count; i++) sum += x[i] * x[i];
    return sqrt(sum);
}

/* -- a world --------------------------------------------------------------------------------------------------------------- */

typedef struct world {
    tides_intrinsics camera;
    td_image_numbers image;
    td_view view;
    td_store store;
} world;

static void draw_camera(world *w) {
    tides_image_params params;
    td_image image;
    tides_error error;
    double focal = uniform(30, 120);
    tides_image_params_defaults(&params);
    params.rules = TIDES_RULES_GSPLAT;
    w->camera = (tides_intrinsics){WIDTH, HEIGHT, focal, focal * uniform(0.9, 1.1), 0, 0, {0}};
    w->camera.cx = uniform(-20, WIDTH + 20);
    w->camera.cy = uniform(-20, HEIGHT + 20);
    scene_expect_ok(td_image_resolve(&params, &w->camera, 0, &image, &error), &error);
    image.objects = image.moving = 1;
    w->image = td_image_pack(&image);
}

/* Looks at the origin from 2 to 6 away, turned and moved at random. */
static void draw_view(world *w) {
    double q[4], spin[3], eye[3], eye_dot[3], distance = uniform(2, 6);
    td_view *v = &w->view;
    normals(q, 4, 1);
    normals(spin, 3, 1);
    normals(eye, 3, 0.3);
    normals(eye_dot, 3, 1);
    memset(v, 0, sizeof *v);
    double size = norm(q, 4), a = q[0] / size, x = q[1] / size, y = q[2] / size, z = q[3] / size;
    const double R[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - a * z),     2 * (x * z + a * y),
                         2 * (x * y + a * z),     1 - 2 * (x * x + z * z), 2 * (y * z - a * x),
                         2 * (x * z - a * y),     2 * (y * z + a * x),     1 - 2 * (x * x + y * y)};
    const double W[9] = {0, -spin[2], spin[1], spin[2], 0, -spin[0], -spin[1], spin[0], 0};
    for (int j = 0; j < 3; j++) eye[j] -= R[6 + j] * distance;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            v->r[3 * i + j] = R[3 * i + j];
            v->r_dot[3 * i + j] = W[3 * i] * R[j] + W[3 * i + 1] * R[3 + j] + W[3 * i + 2] * R[6 + j];
            v->t[i] -= v->r[3 * i + j] * eye[j];
            v->t_dot[i] -= v->r_dot[3 * i + j] * eye[j] + v->r[3 * i + j] * eye_dot[j];
        }
        v->eye[i] = eye[i];
        v->eye_dot[i] = eye_dot[i];
    }
}

static void draw_gaussians(world *w) {
    const size_t count = (COUNT + TD_PAD - 1) / TD_PAD * TD_PAD;
    w->store = (td_store){.count = (int)count, .real_count = COUNT, .objects = 1, .sh_stride = 3};
    w->store.object = calloc(count, sizeof *w->store.object);
    w->store.geometry = calloc(count * TD_GEOMETRY_STRIDE, sizeof *w->store.geometry);
    w->store.rates = calloc(count * TD_GEOMETRY_STRIDE, sizeof *w->store.rates);
    w->store.sh_wide = calloc(count * 3, sizeof *w->store.sh_wide);
    w->store.sh_rates = calloc(count * 3, sizeof *w->store.sh_rates);
    assert_true(w->store.object && w->store.geometry && w->store.rates && w->store.sh_wide && w->store.sh_rates);
    for (size_t i = 0; i < COUNT; i++) {
        double mean[3], mean_dot[3], scale[3], scale_dot[3], turn[4], turn_dot[4], opacity_dot;
        normals(mean, 3, 1);
        normals(mean_dot, 3, 0.5);
        normals(scale_dot, 3, 0.3);
        normals(turn, 4, 1);
        normals(turn_dot, 4, 1);
        normals(&opacity_dot, 1, 1);
        for (int k = 0; k < 3; k++) scale[k] = uniform(-6, 0.3); /* logarithms: lengths differ by up to 500 */
        td_activate(mean, scale, turn, 1, w->store.geometry + i * TD_GEOMETRY_STRIDE);
        td_activate_rates(mean_dot, scale, scale_dot, turn, turn_dot, 1, opacity_dot, w->store.rates + i * TD_GEOMETRY_STRIDE);
    }
}

/* -- what is asked --------------------------------------------------------------------------------------------------------- */

static int is_seen(const golden_splat *splat) {
    const double *u = splat->value + SPLAT_U;
    return splat->visible && u[0] > -MARGIN && u[0] < WIDTH + MARGIN && u[1] > -MARGIN && u[1] < HEIGHT + MARGIN;
}

/* kappa times beam. */
static double condition_of(const world *w, int gaussian, const golden_splat *splat) {
    const double *mean = w->store.geometry + (size_t)gaussian * TD_GEOMETRY_STRIDE + TD_G_MEAN;
    double z = splat->value[SPLAT_DEPTH], kappa = (norm(mean, 3) + norm(w->view.t, 3)) / z;
    double slope = norm(splat->value + SPLAT_PC, 2) / z, T = fmax(w->camera.fx, w->camera.fy) / z * sqrt(1 + slope * slope);
    return kappa * T * norm(splat->value + SPLAT_SCALE, 3) / sqrt(norm(splat->value + SPLAT_COV2, 3));
}

/* Relative as in tests/golden/test_render.c: to the rate itself or, where its terms cancel, to the usual relative rate. */
static double error_of(const golden_splat *want, const golden_splat *got, double usual) {
    double off[3], own = norm(want->value + SPLAT_COV2, 3);
    for (int k = 0; k < 3; k++) off[k] = got->rate[SPLAT_COV2 + k] - want->rate[SPLAT_COV2 + k];
    return norm(off, 3) / fmax(norm(want->rate + SPLAT_COV2, 3), own * usual);
}

static void test_rates_of_covariance(void **state) {
    double worst = 0, worst_share = 0;
    int seen = 0, beyond = 0;
    (void)state;
    printf("seed %d\n", (int)SEED);
    for (int c = 0; c < CAMERAS; c++) {
        world w;
        golden_splat want[COUNT], got[COUNT];
        double view[TD_VIEW_REALS], usual = 0;
        int visible = 0;
        draw_camera(&w);
        draw_view(&w);
        draw_gaussians(&w);
        memcpy(view, &w.view, sizeof w.view);
        for (int i = 0; i < COUNT; i++) {
            golden_project_f64(&w.image, view, &w.store, i, &want[i]);
            golden_project_f32(&w.image, view, &w.store, i, &got[i]);
            if (!is_seen(&want[i])) continue;
            usual += norm(want[i].rate + SPLAT_COV2, 3) / norm(want[i].value + SPLAT_COV2, 3);
            visible++;
        }
        for (int i = 0; i < COUNT; i++) {
            if (!is_seen(&want[i]) || !got[i].visible) continue;
            double error = error_of(&want[i], &got[i], usual / visible), allowed = 1e-6 * condition_of(&w, i, &want[i]);
            seen++;
            beyond += error > 1e-5;
            worst = fmax(worst, error);
            worst_share = fmax(worst_share, error / fmax(allowed, 1e-5));
        }
        td_store_release(&w.store);
    }
    printf("%d Gaussians: largest error %.3g, %d above 1e-5; at most %.3f of what is allowed\n", seen, worst, beyond,
           worst_share);
    assert_true(seen > CAMERAS * COUNT / 2);
    assert_true(worst_share <= 1);
    assert_true(beyond <= seen / 10000);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rates_of_covariance)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
