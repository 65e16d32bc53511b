/* Projection, SH and tiles against independent renderers: every file of $TIDES_SHARED/golden/render (its own texts say where
 * the numbers come from), in double and in single precision. Images are in test_render_images.c.
 *
 * Values and rates agree to 1e-10 relative in double and 1e-5 in single precision wherever the file's renderer keeps the
 * Gaussian. "Relative" is to a size that belongs to the quantity:
 *   LARGEST   the largest norm in the file: one component or one Gaussian may be near 0 by cancellation (a mean on the optical
 *             axis, a Gaussian seen edge on), and then has no digits of its own
 *   OWN       this Gaussian's norm, for covariances and what follows from them: they differ by orders of magnitude. A rate that
 *             is small because its terms cancel is measured by the relative rate that is usual in the file.
 * The antialiasing factor is sqrt(det0 / det). Its rate is the difference of two relative rates of covariances, so that it is
 * measured by the relative rate that is usual for covariances. (One Gaussian a few pixels wide has a factor near 1 whose rate
 * is 50 times below those two.) In single precision 1e-6 of the condition number of a covariance on the screen is allowed if
 * that is more than 1e-5: for long Gaussians seen end on, near the camera. tests/property/test_projection_precision.c derives
 * it. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_renderer.h"

#include "tests/support/golden_render.h"
#include "tests/support/golden_folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { OWN, LARGEST };

typedef struct quantity {
    const char *name;
    int at, reals, size;
    int usual; /* OWN: whose usual relative rate, as a place in the table */
} quantity;
enum { COV3 = 3, COV2 = 7, CONIC = 8, QUANTITIES = 12 };
static const quantity quantities[QUANTITIES] = {
    {"scale", SPLAT_SCALE, 3, LARGEST, 0},
    {"rotation", SPLAT_ROTATION, 9, LARGEST, 0},
    {"opacity", SPLAT_OPACITY, 1, LARGEST, 0},
    {"cov3", SPLAT_COV3, 6, OWN, COV3},
    {"pc", SPLAT_PC, 3, LARGEST, 0},
    {"u", SPLAT_U, 2, LARGEST, 0},
    {"depth", SPLAT_DEPTH, 1, LARGEST, 0},
    {"cov2", SPLAT_COV2, 3, OWN, COV2},
    {"conic", SPLAT_CONIC, 3, OWN, CONIC},
    {"color", SPLAT_COLOUR, 3, LARGEST, 0},
    {"opacity_eff", SPLAT_OPACITY_EFF, 1, LARGEST, 0},
    {"comp", SPLAT_COMP, 1, OWN, COV2},
};

/* Precisions, and what each must reach. */
typedef struct precision {
    const char *name;
    double tolerance;
    void (*project)(const td_image_numbers *image, const double *view, const td_store *store, int gaussian,
                    golden_splat *splat);
    int (*tile)(const td_image_numbers *image, const double *view, const td_store *store, int gaussian, int x, int y);
    double per_condition; /* likewise for what follows from covariances, times their condition number where that is more */
    int border_share;     /* one (Gaussian, tile) pair in so many may come out differently; 0: none */
} precision;
enum { PRECISIONS = 2 };
static const precision precisions[PRECISIONS] = {
    {"double", 1e-10, golden_project_f64, golden_tile_f64, 0, 0},
    /* A radius is rounded up to whole pixels and a border is compared exactly, so rounding may decide either. */
    {"single", 1e-5, golden_project_f32, golden_tile_f32, 1e-6, 10000},
};

static double norm(const double *x, int count) {
    double sum = 0;
    for (int i = 0; i < count; i++) sum += x[i] * x[i];
    return sqrt(sum);
}

static double distance(const double *x, const double *y, int count) {
    double sum = 0;
    for (int i = 0; i < count; i++) sum += (x[i] - y[i]) * (x[i] - y[i]);
    return sqrt(sum);
}

/* A file's sizes, per quantity, over the Gaussians that its renderer keeps. */
typedef struct sizes {
    double value[QUANTITIES], rate[QUANTITIES]; /* largest norms */
    double usual[QUANTITIES];                   /* mean of |rate| / |value| */
    int kept;
} sizes;

static sizes find_sizes(const golden_file *file) {
    const uint8_t *keep = golden_bytes(file, "keep");
    sizes found = {{0}, {0}, {0}, 0};
    for (int i = 0; i < file->times * file->gaussians; i++) {
        golden_splat splat;
        if (!keep[i]) continue;
        found.kept++;
        golden_expected(file, i / file->gaussians, i % file->gaussians, &splat);
        for (int q = 0; q < QUANTITIES; q++) {
            double value = norm(splat.value + quantities[q].at, quantities[q].reals);
            double rate = norm(splat.rate + quantities[q].at, quantities[q].reals);
            found.value[q] = fmax(found.value[q], value);
            found.rate[q] = fmax(found.rate[q], rate);
            found.usual[q] += value > 0 ? rate / value : 0;
        }
    }
    for (int q = 0; q < QUANTITIES; q++) found.usual[q] /= found.kept ? found.kept : 1;
    return found;
}

typedef struct worst {
    double error; /* relative */
    const char *name;
    int rate, time, gaussian;
} worst;

/* Keeps the larger error; no size and no error is 0 error, NaN is infinite. */
static void note(worst *w, double error, double size, const worst *where) {
    double relative = error == 0 ? 0 : error / size;
    if (relative <= w->error) return;
    *w = *where;
    w->error = isnan(relative) ? INFINITY : relative;
}

/* kappa times beam of test_projection_precision.c. */
static double condition_of(const golden_file *file, int time, int gaussian, const golden_splat *want) {
    const double *k = golden_reals(file, "K"), *matrix = golden_reals(file, "viewmat") + 16 * time;
    const double t[3] = {matrix[3], matrix[7], matrix[11]};
    double z = want->value[SPLAT_DEPTH], slope = norm(want->value + SPLAT_PC, 2) / z;
    double kappa = (norm(golden_reals(file, "means") + 3 * (time * file->gaussians + gaussian), 3) + norm(t, 3)) / z;
    double T = fmax(k[0], k[4]) / z * sqrt(1 + slope * slope);
    return kappa * T * norm(want->value + SPLAT_SCALE, 3) / sqrt(norm(want->value + SPLAT_COV2, 3));
}

/* `slack`: how many times the tolerance covariances on the screen are allowed, and what follows from them. */
static void compare_splat(const golden_splat *got, const golden_splat *want, const sizes *s, double slack, int time,
                          int gaussian, worst *w) {
    for (int i = 0; i < QUANTITIES; i++) {
        const quantity *q = &quantities[i];
        double own = norm(want->value + q->at, q->reals);
        double own_rate = fmax(norm(want->rate + q->at, q->reals), own * s->usual[q->usual]);
        worst where = {0, q->name, 0, time, gaussian};
        if (q->usual == COV2 || q->usual == CONIC) {
            own *= slack;
            own_rate *= slack;
        }
        note(w, distance(got->value + q->at, want->value + q->at, q->reals), q->size == OWN ? own : s->value[i], &where);
        where.rate = 1;
        note(w, distance(got->rate + q->at, want->rate + q->at, q->reals), q->size == OWN ? own_rate : s->rate[i], &where);
    }
}

static worst compare_splats(const golden_file *file, const precision *p) {
    const uint8_t *keep = golden_bytes(file, "keep");
    td_image_numbers image = golden_image(file, file->sh_degree, TD_OUT_COLOUR);
    sizes s = find_sizes(file);
    worst w = {0, "", 0, 0, 0};
    for (int t = 0; t < file->times; t++) {
        td_store store = golden_store(file, t, file->sh_degree);
        double view[TD_VIEW_REALS];
        golden_view(file, t, view);
        for (int i = 0; i < file->gaussians; i++) {
            golden_splat got, want;
            if (!keep[t * file->gaussians + i]) continue;
            p->project(&image, view, &store, i, &got);
            golden_expected(file, t, i, &want);
            double slack = fmax(1, p->per_condition / p->tolerance * condition_of(file, t, i, &want));
            compare_splat(&got, &want, &s, slack, t, i, &w);
        }
        td_store_release(&store);
    }
    return w;
}

/* Tiles whose splats differ between us and the file at one time: in both it takes a kept Gaussian, one whose opacity is above
 * the cut (INRIA keeps others too, for nothing), and a rectangle that holds the tile. */
static int compare_tiles_at(const golden_file *file, const precision *p, int time, int *pairs) {
    const uint8_t *keep = golden_bytes(file, "keep");
    const int32_t *rectangle = golden_ints(file, "rect");
    td_image_numbers image = golden_image(file, file->sh_degree, TD_OUT_COLOUR);
    td_store store = golden_store(file, time, file->sh_degree);
    double view[TD_VIEW_REALS];
    int differing = 0;
    golden_view(file, time, view);
    for (int i = 0; i < file->gaussians; i++) {
        const int32_t *r = rectangle + 4 * (time * file->gaussians + i);
        golden_splat got, want;
        p->project(&image, view, &store, i, &got);
        golden_expected(file, time, i, &want);
        int kept = keep[time * file->gaussians + i] && want.value[SPLAT_OPACITY_EFF] > 1.0 / 255.0;
        for (int y = 0; y < file->height; y += TD_TILE)
            for (int x = 0; x < file->width; x += TD_TILE) {
                int inside = x / TD_TILE >= r[0] && x / TD_TILE < r[2] && y / TD_TILE >= r[1] && y / TD_TILE < r[3];
                int ours = got.visible && p->tile(&image, view, &store, i, x, y);
                differing += ours != (kept && inside);
                ++*pairs;
            }
    }
    td_store_release(&store);
    return differing;
}

typedef struct tally {
    int failures;
} tally;

static int visit_splats(void *user, const char *path, const char *name) {
    tally *total = user;
    golden_file file = golden_open(path);
    for (int k = 0; k < PRECISIONS; k++) {
        const precision *p = &precisions[k];
        worst w = compare_splats(&file, p);
        int wrong = !(w.error <= p->tolerance);
        print_message("    %-32s %s  %.1e (%s%s, time %d, Gaussian %d)%s\n", name, p->name, w.error, w.name,
                      w.rate ? "_dot" : "", w.time, w.gaussian, wrong ? "  TOO LARGE" : "");
        total->failures += wrong;
    }
    golden_close(&file);
    return 0;
}

static int visit_tiles(void *user, const char *path, const char *name) {
    tally *total = user;
    golden_file file = golden_open(path);
    for (int k = 0; k < PRECISIONS && file.has_tiles; k++) {
        const precision *p = &precisions[k];
        int pairs = 0, differing = 0;
        for (int t = 0; t < file.times; t++) differing += compare_tiles_at(&file, p, t, &pairs);
        int wrong = differing > (p->border_share ? pairs / p->border_share : 0);
        if (differing)
            print_message("    %-32s %s  %d of %d (Gaussian, tile) pairs differ%s\n", name, p->name, differing, pairs,
                          wrong ? ": TOO MANY" : "");
        total->failures += wrong;
    }
    golden_close(&file);
    return 0;
}

/* Every file, so that one report says all that is wrong. */
static void every_file(shared_visit visit) {
    tally total = {0};
    golden_folder("golden/render", ".npz", visit, &total);
    if (total.failures) fail_msg("%d comparisons failed: see the lines above", total.failures);
}

static void splats_and_their_rates(void **state) {
    (void)state;
    every_file(visit_splats);
}

static void tiles_that_see_a_splat(void **state) {
    (void)state;
    every_file(visit_tiles);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(splats_and_their_rates),
        cmocka_unit_test(tiles_that_see_a_splat),
    };
    return cmocka_run_group_tests_name("golden render: splats", tests, NULL, NULL);
}
