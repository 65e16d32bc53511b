/* Rows of record paths in double precision: OpenCL's have the bits of the double reference's, at every width. Scenes are at
 * rest and moving, around the camera, with needles and with splats wider than the image, by every rule. Gaussians that a motion
 * moves come from the backend. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/renderer_of.h" /* before others: in double */
#include "render/td_exact.h"
#include "tests/support/moving_scene.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 2214;
enum { NODES = 3, KINDS = 2 }; /* OpenCL, twin */
static const double node_times[NODES] = {0.4, 0.405, 0.41};

/* Opens the OpenCL CPU device for kernels of `lanes`; skips the test where there's none. */
static tides_device *open_cpu(int lanes) {
    tides_device *device = NULL;
    tides_error error;
    tides_status status = tides_device_open("cpu", &device, &error);
    if (status == TIDES_NO_DEVICE) {
        print_message("skipped: %s\n", error.text);
        skip();
    }
    scene_expect_ok(status, &error);
    device->info.lanes = lanes;
    device->double_lanes = lanes < 8 ? lanes : 8;
    return device;
}

/* A row for each of `count` neighbouring rows of Gaussians from `first` on, at each node, in jobs of `job_size`; and one, the
 * first, for padding. */
typedef struct asked {
    int *gaussians, *rows; /* (NODES x count) */
    td_node_job *jobs;
    td_node_request request;
    int by_channels; /* rows have green and blue beside them (td_paths_by_channels) */
} asked;

static asked ask(const double *views, int first, int count, int real_count, int job_size) {
    asked a = {0};
    size_t all = (size_t)NODES * (size_t)count;
    a.gaussians = calloc(all, sizeof *a.gaussians);
    a.rows = calloc(all, sizeof *a.rows);
    a.jobs = calloc(all / TD_PAD, sizeof *a.jobs);
    assert_true(a.gaussians && a.rows && a.jobs);
    int jobs = 0;
    for (int node = 0; node < NODES; node++)
        for (int i = 0; i < count; i++) {
            int at = node * count + i, none = i >= real_count && i % TD_PAD;
            a.gaussians[at] = none ? TD_NO_GAUSSIAN : first + i;
            a.rows[at] = none ? 0 : 1 + i * NODES + node;
            if (i % job_size == 0) a.jobs[jobs++] = (td_node_job){node, at, count - i < job_size ? count - i : job_size, 0};
        }
    a.request = (td_node_request){views, NODES, a.jobs, jobs, a.gaussians, a.rows, (int)all, 1 + (int)all};
    return a;
}

static void asked_free(asked *a) {
    free(a->gaussians);
    free(a->rows);
    free(a->jobs);
}

/* Rows, and behind all of them what is beside them. */
static double *rows_of(td_exact *exact, td_backend *backend, const asked *a) {
    const size_t count = (size_t)a->request.row_count;
    double *rows = calloc(count * (TD_PATH_STRIDE + TD_BESIDE_STRIDE), sizeof *rows), *beside = rows + count * TD_PATH_STRIDE;
    tides_error error;
    assert_non_null(rows);
    scene_expect_ok(td_exact_nodes(exact, backend, &a->request, &error), &error);
    scene_expect_ok(td_exact_rows(exact, a->request.row_count, rows, a->by_channels ? beside : NULL, &error), &error);
    return rows;
}

/* Bit for bit, but for what isn't a number; rows that can be used and those that can't are counted. */
static void compare(const char *name, const asked *a, const double *found, const double *expected, int used[2]) {
    for (int row = 1; row < a->request.row_count; row++) {
        const double *f = found + (size_t)row * TD_PATH_STRIDE, *e = expected + (size_t)row * TD_PATH_STRIDE;
        for (int k = 0; k < TD_PATH_STRIDE; k++)
            if (memcmp(&f[k], &e[k], sizeof *f) != 0 && !(isnan(f[k]) && isnan(e[k])))
                fail_msg("%s: row %d, entry %d: %.17g on the device, %.17g in the reference", name, row, k, f[k], e[k]);
        used[e[TD_P_DET] > 0]++;
    }
    if (!a->by_channels) return;
    const size_t first = (size_t)a->request.row_count * TD_PATH_STRIDE, count = (size_t)a->request.row_count * TD_BESIDE_STRIDE;
    for (size_t i = first + TD_BESIDE_STRIDE; i < first + count; i++)
        if (memcmp(&found[i], &expected[i], sizeof *found) != 0 && !(isnan(found[i]) && isnan(expected[i])))
            fail_msg("%s: number %d beside rows: %.17g on the device, %.17g in the reference", name, (int)(i - first), found[i],
                     expected[i]);
}

/* -- Gaussians at rest, or with rates ------------------------------------------------------------------------------ */

/* One axis in three is a thousandth of what it was. */
static void make_needles(td_store *store) {
    for (int i = 0; i < store->real_count; i++)
        for (int row = 0; row < 3; row++)
            store->geometry[(size_t)i * TD_GEOMETRY_STRIDE + TD_G_FACTOR + 3 * row + i % 3] *= 1e-3;
}

typedef struct setting {
    int rules, antialias, sh_degree, moving, lanes, job_size, lens, transfer;
} setting;

static void compare_store(const char *name, tides_device *device, const random_recipe *recipe, const setting *s,
                          void (*edit)(td_store *store), int used[2]) {
    random_scene scene = random_scene_make(recipe);
    td_store store = random_scene_store(&scene, node_times[0]);
    if (edit) edit(&store);
    td_image_numbers image = random_scene_image(&scene, s->rules, s->antialias, TD_OUT_SIGNAL);
    if (s->transfer) image = random_scene_coded(&image, s->transfer, 2.2);
    image.whole[3] = s->sh_degree; /* width, height, objects, sh_degree (layout.h) */
    double *views = random_scene_views(&scene, node_times, NODES), *rows[KINDS];
    asked a = ask(views, 0, store.count, store.count, s->job_size);
    a.by_channels = s->transfer != TIDES_TRANSFER_LINEAR || s->sh_degree > 0;
    tides_device *reference = open_device("reference"), *devices[KINDS] = {device, reference};
    tides_error error;
    for (int k = 0; k < KINDS; k++) {
        td_exact *exact = NULL;
        scene_expect_ok(td_exact_create(devices[k], &store, &image, &exact, &error), &error);
        assert_true((td_exact_row_buffer(exact) != NULL) == (k == 0));
        rows[k] = rows_of(exact, NULL, &a);
        td_exact_destroy(exact);
    }
    compare(name, &a, rows[0], rows[1], used);
    free(rows[0]);
    free(rows[1]);
    free(views);
    asked_free(&a);
    td_store_release(&store);
    random_scene_free(&scene);
    tides_device_close(reference);
}

static void test_opencl_equals_the_reference(void **state) {
    static const setting settings[] = {{TIDES_RULES_SMOOTH, 0, 3, 0, 16, 64, TIDES_LENS_EQUIDISTANT, 0},
                                       {TIDES_RULES_SMOOTH, 1, 2, 1, 8, 1 << 20, TIDES_LENS_NONE, 0},
                                       {TIDES_RULES_INRIA, 0, 1, 1, 4, TD_PAD, TIDES_LENS_RADTAN, 0},
                                       {TIDES_RULES_GSPLAT, 1, 4, 0, 1, 48, TIDES_LENS_NONE, 0},
                                       {TIDES_RULES_SMOOTH, 0, 0, 0, 16, 64, TIDES_LENS_NONE, 0},
                                       {TIDES_RULES_SMOOTH, 0, 2, 1, 16, 64, TIDES_LENS_NONE, TIDES_TRANSFER_SRGB}};
    int used[2] = {0, 0};
    (void)state;
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        tides_device *device = open_cpu(settings[i].lanes);
        const int own_builtins = device->own_builtins;
        random_recipe ordinary = random_recipe_defaults(SEED + i);
        ordinary.count = 300, ordinary.objects = 3, ordinary.sh_degree = settings[i].sh_degree;
        ordinary.moving = settings[i].moving, ordinary.lens = settings[i].lens;
        random_recipe around = ordinary, huge = ordinary;
        around.spread = 5, around.size = 0.3, around.camera_speed = 8;
        huge.size = 1e5;
        compare_store("ordinary", device, &ordinary, &settings[i], NULL, used);
        compare_store("needles", device, &ordinary, &settings[i], make_needles, used);
        compare_store("around the camera", device, &around, &settings[i], NULL, used);
        compare_store("huge", device, &huge, &settings[i], NULL, used);
        assert_int_equal(device->own_builtins, own_builtins); /* as in test_kernels.c */
        tides_device_close(device);
    }
    assert_true(used[0] > 0 && used[1] > 0);
}

/* -- Gaussians that a motion moves --------------------------------------------------------------------------------- */

/* The scene in double on a device, and rows of what a sweep has moved, in the precision of the renderer's backend. */
typedef struct moved {
    tides_device *backend; /* NULL: the device */
    tides_renderer *renderer;
    td_exact *exact;
    asked a;
} moved;

/* Whether light isn't linear in colours. */
static int coded = 0;

static moved moved_open(tides_device *device, const moving_scene *s, const char *of) {
    moved m = {of ? open_device(of) : NULL, NULL, NULL, {0}};
    tides_error error;
    m.renderer = make_renderer(of ? m.backend : device, s->scene, &s->base.camera, TIDES_RULES_SMOOTH);
    td_image_numbers image = td_image_pack(&m.renderer->image);
    if (coded) image = random_scene_coded(&image, TIDES_TRANSFER_SRGB, 0);
    scene_expect_ok(td_renderer_sweep(m.renderer, s->base.path, node_times[0], node_times[NODES - 1], &error), &error);
    scene_expect_ok(td_renderer_views(m.renderer, s->base.path, node_times, NODES, &error), &error);
    assert_true(m.renderer->dynamic.gaussians > 2 * TD_PAD);
    m.a = ask((const double *)m.renderer->scratch.views, m.renderer->store.count + TD_PAD,
              m.renderer->dynamic.gaussians - TD_PAD, 1 << 20, 32);
    scene_expect_ok(td_exact_create(device, &m.renderer->store, &image, &m.exact, &error), &error);
    m.a.by_channels = coded || image.whole[3] > 0;
    return m;
}

/* All but what was asked for. */
static asked moved_close(moved *m) {
    td_exact_destroy(m->exact);
    tides_renderer_destroy(m->renderer);
    if (m->backend) tides_device_close(m->backend);
    return m->a;
}

/* The rows that a sweep worked out. */
static double *moved_rows(tides_device *device, const moving_scene *s, const char *of, asked *a) {
    moved m = moved_open(device, s, of);
    double *rows = rows_of(m.exact, m.renderer->backend, &m.a), *again = rows_of(m.exact, m.renderer->backend, &m.a);
    assert_memory_equal(rows, again, (size_t)m.a.request.row_count * TD_PATH_STRIDE * sizeof *rows);
    free(again);
    *a = moved_close(&m);
    return rows;
}

/* Of the reference in double they are its own, and OpenCL's backend moves what the reference in float does. */
static void test_moved_rows(void **state) {
    static const int widths[] = {16, 4, 1};
    (void)state;
    for (int i = 0; i < 3; i++) {
        tides_device *device = open_cpu(widths[i]), *reference = open_device("reference");
        random_recipe recipe = random_recipe_defaults(SEED + (uint64_t)i);
        recipe.count = 200, recipe.objects = 3, recipe.sh_degree = i;
        moving_scene s = moving_scene_make(&recipe, 0.6);
        int used[2] = {0, 0};
        asked a[4];
        double *own = moved_rows(device, &s, NULL, &a[0]), *single = moved_rows(reference, &s, "reference-f32", &a[1]);
        double *wide = moved_rows(device, &s, "reference", &a[2]), *twin = moved_rows(reference, &s, "reference", &a[3]);
        compare("rows of floats", &a[0], own, single, used);
        compare("rows of doubles", &a[2], wide, twin, used);
        assert_true(used[1] > 0);
        assert_memory_not_equal(own, wide, (size_t)a[0].request.row_count * TD_PATH_STRIDE * sizeof *own);
        double *all[] = {own, single, wide, twin};
        for (int k = 0; k < 4; k++) {
            free(all[k]);
            asked_free(&a[k]);
        }
        moving_scene_free(&s);
        tides_device_close(reference);
        tides_device_close(device);
    }
}

/* -- twice as many rows -------------------------------------------------------------------------------------------- */

enum { HALVED = 5 }; /* rows, of NODES */

/* Rows of the moved scene, and behind them those of every other path of twice as many: all of them, row_count in all. */
static double *halved_rows(tides_device *device, const moving_scene *s, int level, int pieces, const double *lengths,
                           int *row_count, int *paths) {
    moved m = moved_open(device, s, "reference");
    const int count = m.a.request.count / NODES / 2, given = m.a.request.row_count;
    int *from = calloc((size_t)count, sizeof *from), *to = calloc((size_t)count, sizeof *to);
    tides_error error;
    assert_true(from && to && count > TD_PAD);
    for (int i = 0; i < count; i++) from[i] = 1 + 2 * i * NODES, to[i] = given + i * HALVED;
    *row_count = given + count * HALVED;
    *paths = count;
    free(rows_of(m.exact, m.renderer->backend, &m.a));
    const td_halve_request request = {from, to, count, level, pieces, lengths, *row_count};
    const size_t all = (size_t)*row_count;
    double *rows = calloc(all * (TD_PATH_STRIDE + TD_BESIDE_STRIDE), sizeof *rows), *beside = rows + all * TD_PATH_STRIDE;
    assert_non_null(rows);
    scene_expect_ok(td_exact_halve(m.exact, &request, &error), &error);
    scene_expect_ok(td_exact_rows(m.exact, *row_count, rows, m.a.by_channels ? beside : NULL, &error), &error);
    free(from);
    free(to);
    asked a = moved_close(&m);
    asked_free(&a);
    return rows;
}

/* Row k of the made path: every other is one of the given, and between two is the middle of their cubic, h seconds long. */
static void check_halved(const double *given, const double *made, const double *h) {
    for (int k = 0; k < NODES; k++)
        assert_memory_equal(made + (size_t)(2 * k) * TD_PATH_STRIDE, given + (size_t)k * TD_PATH_STRIDE,
                            TD_PATH_STRIDE * sizeof *given);
    for (int k = 0; k + 1 < NODES; k++)
        for (int number = 0; number < TD_PATH_NUMBERS; number++) {
            const double *from = given + (size_t)k * TD_PATH_STRIDE + number, *to = from + TD_PATH_STRIDE;
            const double *middle = made + (size_t)(2 * k + 1) * TD_PATH_STRIDE + number;
            const long double a = from[0], b = to[0], c = from[TD_PATH_NUMBERS], d = to[TD_PATH_NUMBERS];
            const long double value = (a + b) / 2 + h[k] / 8 * (c - d), rate = 1.5L * (b - a) / h[k] - (c + d) / 4;
            const long double room = 4e-16L * (fabsl(a) + fabsl(b) + h[k] * (fabsl(c) + fabsl(d)));
            if (!isfinite(a + b + c + d)) continue;
            if (!(fabsl(middle[0] - value) <= room && fabsl(middle[TD_PATH_NUMBERS] - rate) <= 3 * room / h[k]))
                fail_msg("number %d between rows %d and %d: %.17g and %.17g, should be %.17Lg and %.17Lg", number, k, k + 1,
                         middle[0], middle[TD_PATH_NUMBERS], value, rate);
        }
}

/* One piece of two curves, and two pieces of one, which aren't equally long. */
static void test_twice_as_many_rows(void **state) {
    static const int widths[] = {16, 4, 1};
    static const struct {
        int level, pieces;
        double lengths[2], h[NODES - 1];
    } cuts[] = {{1, 1, {0.01, 0}, {0.005, 0.005}}, {0, 2, {0.004, 0.006}, {0.004, 0.006}}};
    (void)state;
    for (int i = 0; i < 8; i++) {
        const int cut = i % 2;
        coded = i >= 6;
        tides_device *device = open_cpu(widths[i / 2 % 3]), *reference = open_device("reference");
        random_recipe recipe = random_recipe_defaults(SEED + (uint64_t)i);
        recipe.count = 200, recipe.objects = 3;
        moving_scene s = moving_scene_make(&recipe, 0.6);
        int rows[2], paths[2], used[2] = {0, 0};
        double *own = halved_rows(device, &s, cuts[cut].level, cuts[cut].pieces, cuts[cut].lengths, &rows[0], &paths[0]);
        double *twin = halved_rows(reference, &s, cuts[cut].level, cuts[cut].pieces, cuts[cut].lengths, &rows[1], &paths[1]);
        const asked all = {.request = {.row_count = rows[0]}, .by_channels = coded || recipe.sh_degree > 0};
        assert_int_equal(rows[0], rows[1]);
        compare("rows made of rows", &all, own, twin, used);
        for (int k = 0; k < paths[0]; k++)
            check_halved(own + (size_t)(1 + 2 * k * NODES) * TD_PATH_STRIDE,
                         own + (size_t)(rows[0] - (paths[0] - k) * HALVED) * TD_PATH_STRIDE, cuts[cut].h);
        free(own);
        free(twin);
        moving_scene_free(&s);
        tides_device_close(reference);
        tides_device_close(device);
    }
    coded = 0;
}

/* A device without double precision leaves it to the twin. */
static void test_single_precision_has_the_twin(void **state) {
    (void)state;
    tides_device *device = open_cpu(16);
    random_recipe recipe = random_recipe_defaults(SEED);
    random_scene scene = random_scene_make(&recipe);
    td_store store = random_scene_store(&scene, 0);
    td_image_numbers image = random_scene_image(&scene, TIDES_RULES_SMOOTH, 0, TD_OUT_SIGNAL);
    td_exact *exact = NULL;
    tides_error error;
    device->has_double = 0;
    scene_expect_ok(td_exact_create(device, &store, &image, &exact, &error), &error);
    assert_null(td_exact_row_buffer(exact)); /* nothing of it is on the device */
    td_exact_destroy(exact);
    td_store_release(&store);
    random_scene_free(&scene);
    tides_device_close(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_opencl_equals_the_reference), cmocka_unit_test(test_moved_rows),
                                       cmocka_unit_test(test_twice_as_many_rows),
                                       cmocka_unit_test(test_single_precision_has_the_twin)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
