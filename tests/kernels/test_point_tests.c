/* Points leave out splats by a quick test in single precision (kernels/point_tests.h). The test of its slice must pass every
 * splat that a point sees, with any number of slices, of one piece or of groups of several, for splats of any level and any
 * path. And it must reject others, or it would be useless. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#define TD_REAL_DOUBLE
#include "kernels/point_splats.h"
#include "tests/support/scene_make.h"

#include <stdlib.h>

enum { LEVELS = 6, PIECES_MOST = 11, SPLATS = 160, LOOKS = 300, ROW = 2 * TD_PATH_NUMBERS };
enum { CURVES_MOST = PIECES_MOST << (LEVELS - 1), SLICES_MOST = 8 };
static const double LENGTH = 0.01; /* of the interval [s] */

/* A number that goes and swings: a + b t + c sin(w t + p). */
typedef struct swing {
    double a, b, c, w, p;
} swing;

static swing any_swing(uint64_t *state, double low, double high, double way, double swings) {
    return (swing){scene_between(state, low, high), scene_between(state, -way, way) / LENGTH, scene_between(state, 0, swings),
                   scene_between(state, 0, 12) / LENGTH, scene_between(state, 0, 6.28)};
}

/* The numbers of a splat, of which b goes by the correlation and the determinant by what that leaves. */
typedef struct splat {
    swing u, v, a, c, correlation, opacity;
} splat;

static splat any_splat(uint64_t *state) {
    return (splat){any_swing(state, -12, 28, 12, 3),        any_swing(state, -12, 28, 12, 3),
                   any_swing(state, 2, 30, 0.7, 1),         any_swing(state, 2, 30, 0.7, 1),
                   any_swing(state, -0.9, 0.9, 0.03, 0.04), any_swing(state, 0.05, 0.9, 0.01, 0.03)};
}

static double at(const swing *s, double t) { return s->a + s->b * t + s->c * sin(s->w * t + s->p); }

static void values_at(const splat *s, double t, double value[TD_PATH_NUMBERS]) {
    const double a = at(&s->a, t), c = at(&s->c, t), b = at(&s->correlation, t) * sqrt(a * c);
    value[TD_P_U] = at(&s->u, t), value[TD_P_V] = at(&s->v, t);
    value[TD_P_B] = b, value[TD_P_C] = c, value[TD_P_DET] = a * c - b * b;
    value[TD_P_OPACITY] = at(&s->opacity, t);
    value[TD_P_LUMINANCE] = 1, value[TD_P_DEPTH] = 3 + at(&s->u, t) / 20;
}

/* Values, and rates by differences: whatever they are, the curves are the truth. */
static void row_at(const splat *s, double t, double row[ROW]) {
    const double step = LENGTH * 1e-5;
    double before[TD_PATH_NUMBERS], after[TD_PATH_NUMBERS];
    values_at(s, t, row);
    values_at(s, t - step, before);
    values_at(s, t + step, after);
    for (int k = 0; k < TD_PATH_NUMBERS; k++) row[TD_PATH_NUMBERS + k] = (after[k] - before[k]) / (2 * step);
}

/* Curves of an interval in `pieces` of one length. */
static void lay_curves(const splat *s, int pieces, int level, double *curves) {
    const int count = pieces << level;
    double from[ROW], to[ROW];
    for (int i = 0; i < count; i++) {
        row_at(s, LENGTH * i / count, from);
        row_at(s, LENGTH * (i + 1) / count, to);
        td_point_curve(from, to, LENGTH / count, curves + (size_t)i * TD_CURVE_REALS);
    }
}

static td_image plain_image(void) {
    td_image image;
    memset(&image, 0, sizeof image);
    image.width = image.height = 96;
    image.near = image.near_full = 0.1;
    image.alpha_max = 0.99;
    image.cut_rule = TD_CUT_TAPER;
    image.cut = 0.1 / 255;
    image.cut_full = 1.0 / 255;
    return image;
}

/* What a point in the tile sees of the splat at s of a piece: its alpha and depth. */
static double alpha_at(const td_image *image, const double *curves, int level, int piece, double s, double h, double x,
                       double y, double *depth) {
    double way[TD_PATH_LEVELS], rate[TD_PATH_LEVELS];
    int curve[TD_PATH_LEVELS];
    td_point_eight value, slope;
    td_point_weights(s, h, piece, 0, way, rate, curve);
    td_point_numbers_together(curves + curve[level], way + level, &value, &slope);
    const td_point_view view = td_point_see(image, &value, &slope, rate[level], x, y);
    *depth = view.depth;
    return view.opacity * td_exp2(view.power);
}

/* How often points saw, and were turned away. */
typedef struct tally {
    int seen, turned_away;
} tally;

static void check_splat(uint64_t *state, const td_point_slices *slices, int level, tally *sum) {
    static double curves[CURVES_MOST * TD_CURVE_REALS];
    static float tests[SLICES_MOST * TD_PAD * TD_TEST_REALS], own[TD_TEST_REALS];
    static const size_t at_once = 0;
    const td_image image = plain_image();
    const td_point_tile tile = {32, 48, 0, TD_PAD};
    const td_point_paths paths = {curves, *slices, NULL};
    const splat s = any_splat(state);
    const double h = LENGTH / slices->pieces;
    lay_curves(&s, slices->pieces, level, curves);
    for (int i = 0; i < slices->pieces << level; i++) /* to where the tile is */
        curves[i * TD_CURVE_REALS + TD_P_U] += tile.x, curves[i * TD_CURVE_REALS + TD_P_V] += tile.y;
    for (int k = 0; k < slices->count; k++) {
        td_point_make_tests(&paths, &image, k, &level, own, &at_once);
        td_point_place_test(own, &tile, tests + td_point_tests_at(&tile, slices->count, k));
    }
    for (int i = 0; i < LOOKS; i++) {
        const double x = floor(scene_between(state, 0, TD_TILE)) + 0.5, y = floor(scene_between(state, 0, TD_TILE)) + 0.5;
        const double part = i == 0 ? 0 : i == 1 ? 1 : scene_between(state, 0, 1);
        const int piece = (int)scene_between(state, 0, slices->pieces);
        float w, across = (float)x, down = (float)y;
        double depth;
        const int slice = td_point_slice(slices, piece, part, &w), first = slice * tile.count * TD_TEST_REALS;
        const double alpha = alpha_at(&image, curves, level, piece, part, h, tile.x + x, tile.y + y, &depth);
        const int asked = td_point_ask(tests, &first, 1, 0, 1, &across, &down, &w) != 0;
        sum->seen += alpha >= image.cut;
        sum->turned_away += !asked;
        if (alpha < image.cut) continue;
        if (!asked || !(tests[first + TD_T_DEPTH * TD_PAD] <= depth * 1.000001))
            fail_msg("level %d, %d pieces, slice %d of %d: alpha %g at depth %g isn't let through", level, slices->pieces,
                     slice, slices->count, alpha, depth);
    }
}

/* `least`: the share of what isn't seen that is turned away. One slice of what bends this much turns away some 5 %. */
static void check_slices(const td_point_slices *slices, double least) {
    for (int level = 0; level < LEVELS; level++) {
        uint64_t state = 1500 + (uint64_t)level;
        tally sum = {0, 0};
        for (int i = 0; i < SPLATS; i++) check_splat(&state, slices, level, &sum);
        assert_true(sum.seen > SPLATS * LOOKS / 20);
        assert_true(sum.turned_away > least * (SPLATS * LOOKS - sum.seen));
    }
}

static void test_slices_of_one_piece(void **state) {
    (void)state;
    static const double least[] = {0.02, 0.1, 0.33, 0.67};
    for (int split = 0; split <= 3; split++) {
        const td_point_slices slices = {1, 1 << split, split, 1};
        check_slices(&slices, least[split]);
    }
}

static void test_groups_of_pieces(void **state) {
    (void)state;
    static const td_point_slices slices[] = {{2, 2, 0, 1}, {8, 8, 0, 1}, {PIECES_MOST, 6, 0, 2}};
    static const double least[] = {0.1, 0.67, 0.5};
    for (size_t i = 0; i < sizeof slices / sizeof *slices; i++) check_slices(&slices[i], least[i]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_slices_of_one_piece), cmocka_unit_test(test_groups_of_pieces)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
