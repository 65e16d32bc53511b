/* Record paths on the OpenCL device equal those of the single-precision reference to the bit: rows at nodes, misfits, and the
 * records, masks and planes that batches take from them, of paths of several levels and of Gaussians without one, at every
 * width. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/kernels/backend_pair.h"

#include <math.h>

static const uint64_t SEED = 1414;

/* Nodes of two pieces: of unlike lengths, as between knots. */
enum { NODES = 9, PIECES = 2, COARSE = 5 };
static const double node_times[NODES] = {0.396, 0.398, 0.4, 0.402, 0.404, 0.406, 0.408, 0.41, 0.412};
static const double lengths[PIECES] = {0.008, 0.008};

typedef struct path_world {
    backend_pair pair;
    int *path_of; /* (gaussians) */
    int *gaussians, *rows, count, row_count;
    td_node_job jobs[NODES];
    double cubics[PAIR_SLOTS * TD_PATH_LEVELS * TD_PATH_CUBIC];
    int nodes[PAIR_SLOTS * TD_PATH_LEVELS];
} path_world;

/* Every third Gaussian is on a path of level 2, the others on one of level 1: whether it has a row at a node. */
static int level_of(int gaussian) { return gaussian % 3 == 1 ? 2 : 1; }
static int has_node(int gaussian, int node) { return level_of(gaussian) == 2 || node % 2 == 0; }
static int row_at(const path_world *w, int gaussian, int node) {
    return w->path_of[gaussian] / TD_PATH_LEVELS + (level_of(gaussian) == 2 ? node : node / 2);
}

/* Row 0 is that of padding. */
static void lay_rows(path_world *w) {
    const td_store *store = &w->pair.store;
    w->path_of = calloc((size_t)store->count, sizeof *w->path_of);
    w->gaussians = calloc((size_t)store->count * NODES, sizeof *w->gaussians);
    w->rows = calloc((size_t)store->count * NODES, sizeof *w->rows);
    assert_true(w->path_of && w->gaussians && w->rows);
    w->row_count = 1;
    for (int g = 0; g < store->count; g++) {
        w->path_of[g] = w->row_count * TD_PATH_LEVELS + level_of(g);
        w->row_count += level_of(g) == 2 ? NODES : COARSE;
    }
    for (int node = 0; node < NODES; node++) {
        w->jobs[node] = (td_node_job){node, w->count, store->count, 0};
        for (int g = 0; g < store->count; g++, w->count++) {
            w->gaussians[w->count] = has_node(g, node) ? g : TD_NO_GAUSSIAN;
            w->rows[w->count] = has_node(g, node) ? row_at(w, g, node) : 0;
        }
    }
    for (int group = 0; group < w->count; group += TD_PAD) /* a group begins with its leader */
        if (w->gaussians[group] == TD_NO_GAUSSIAN) {
            w->gaussians[group] = group % store->count;
            w->rows[group] = 0;
        }
}

/* What lib/render works out: the node before a time, and the cubic from there. */
static void lay_moments(path_world *w) {
    for (int slot = 0; slot < PAIR_SLOTS; slot++)
        for (int level = 1; level <= 2; level++) {
            int at = slot * TD_PATH_LEVELS + level, step = level == 2 ? 1 : 2, k = 0;
            double time = pair_times[slot] + 0.0007;
            while (k + 2 * step < NODES && node_times[k + step] <= time) k += step;
            w->nodes[at] = k / step;
            td_cubic_weights(node_times[k], node_times[k + step], time, w->cubics + at * TD_PATH_CUBIC);
        }
}

static void project_nodes(path_world *w) {
    double *views = random_scene_views(&w->pair.scene, node_times, NODES);
    const td_node_request request = {views, NODES, w->jobs, NODES, w->gaussians, w->rows, w->count, w->row_count};
    tides_error error;
    for (int k = 0; k < 2; k++) {
        td_backend *backend = w->pair.backend[k];
        scene_expect_ok(backend->type->prepare_paths(backend, &error), &error);
        scene_expect_ok(backend->type->nodes(backend, &request, &error), &error);
    }
    free(views);
}

/* Rows of all but padding, and whether some can be used and some can't is counted. */
static void compare_rows(const path_world *w, int used[2]) {
    size_t reals = (size_t)w->row_count * TD_PATH_STRIDE;
    double *rows[2], *low[2];
    tides_error error;
    for (int k = 0; k < 2; k++) {
        rows[k] = calloc(reals, sizeof *rows[k]);
        low[k] = calloc((size_t)w->row_count, sizeof *low[k]);
        assert_true(rows[k] && low[k]);
        td_backend *backend = w->pair.backend[k];
        scene_expect_ok(backend->type->path_rows(backend, w->row_count, rows[k], low[k], NULL, &error), &error);
    }
    for (int row = 1; row < w->row_count; row++) {
        assert_memory_equal(&low[0][row], &low[1][row], sizeof(double));
        for (int k = row * TD_PATH_STRIDE; k < (row + 1) * TD_PATH_STRIDE; k++)
            if (memcmp(&rows[0][k], &rows[1][k], sizeof(double)) != 0 && !(isnan(rows[0][k]) && isnan(rows[1][k])))
                fail_msg("%s: row %d, entry %d: %.9g on the device, %.9g in the reference", w->pair.name, row,
                         k % TD_PATH_STRIDE, rows[0][k], rows[1][k]);
        used[rows[0][row * TD_PATH_STRIDE + TD_P_DET] > 0]++;
    }
    for (int k = 0; k < 2; k++) {
        free(rows[k]);
        free(low[k]);
    }
}

/* Misfits of one level; Gaussians that no cubic follows, and every 37th, lose their paths. */
static void compare_misfits(path_world *w, int level) {
    int gaussians = w->pair.store.count, *first = calloc((size_t)gaussians, sizeof *first);
    int *owner = calloc((size_t)gaussians, sizeof *owner), count = 0;
    float *misfits[2];
    tides_error error;
    assert_true(first && owner);
    for (int g = 0; g < gaussians; g++)
        if (level_of(g) == level) owner[count] = g, first[count++] = w->path_of[g] / TD_PATH_LEVELS;
    int padded = (count + TD_PAD - 1) / TD_PAD * TD_PAD;
    for (int i = count; i < padded; i++) first[i] = first[0];
    const td_path_request request = {first, padded, level, PIECES, lengths, 1e-4, 1e-6, 0x1p-22};
    for (int k = 0; k < 2; k++) {
        misfits[k] = calloc((size_t)padded + 1, sizeof *misfits[k]);
        assert_non_null(misfits[k]);
        td_backend *backend = w->pair.backend[k];
        scene_expect_ok(backend->type->path_misfits(backend, &request, misfits[k], &error), &error);
    }
    for (int i = 0; i < padded; i++)
        if (memcmp(&misfits[0][i], &misfits[1][i], sizeof(float)) != 0)
            fail_msg("%s: misfit %d of level %d: %.9g on the device, %.9g in the reference", w->pair.name, i, level,
                     (double)misfits[0][i], (double)misfits[1][i]);
    for (int i = 0; i < count; i++)
        if (misfits[0][i] >= TD_PATH_WILD || owner[i] % 37 == 5) w->path_of[owner[i]] = TD_PATH_DIRECT;
    free(misfits[0]);
    free(misfits[1]);
    free(first);
    free(owner);
}

static td_stages stages_of(path_world *w, int which, const td_job *job, const td_path_batch *paths) {
    td_job alone = *job;
    td_stages stages = pair_stages_make(job->count);
    td_backend *backend = w->pair.backend[which];
    double planes[TD_OUT_DIAGNOSTICS * TD_TILE_PIXELS];
    tides_error error;
    alone.records = alone.out = 0;
    td_batch batch = pair_batch(&w->pair, &alone, 1, alone.count, TD_OUT_DIAGNOSTICS);
    batch.paths = paths;
    scene_expect_ok(backend->type->render(backend, &batch, planes, &error), &error);
    scene_expect_ok(backend->type->inspect(backend, &stages, &error), &error);
    return stages;
}

static int compare_jobs(path_world *w, const td_path_batch *paths) {
    int splats = 0;
    for (int i = 0; i < w->pair.job_count; i += 3) {
        td_stages device = stages_of(w, PAIR_DEVICE, &w->pair.jobs[i], paths);
        td_stages reference = stages_of(w, PAIR_REFERENCE, &w->pair.jobs[i], paths);
        pair_compare_records(w->pair.name, &device, &reference);
        assert_int_equal(device.count, reference.count);
        assert_memory_equal(device.order, reference.order, (size_t)reference.count * sizeof *reference.order);
        splats += reference.count;
        pair_stages_free(&device);
        pair_stages_free(&reference);
    }
    return splats;
}

/* Planes of all jobs in one batch, whose tiles share what the paths are at each time; and those of each job by itself. */
static void compare_shared(path_world *w, const td_path_batch *paths) {
    const tides_render_stats *done = &w->pair.backend[PAIR_DEVICE]->stats;
    w->pair.paths = paths;
    const uint64_t before = done->gaussians_shared;
    free(pair_compare_planes(&w->pair, TD_OUT_DIAGNOSTICS));
    const uint64_t shared = done->gaussians_shared;
    assert_true(shared > before);
    w->pair.alone = 1;
    free(pair_compare_planes(&w->pair, TD_OUT_DIAGNOSTICS));
    assert_int_equal(done->gaussians_shared, shared);
}

static void compare_world(const char *name, tides_device *device, const random_recipe *recipe, const pair_setting *setting,
                          int used[2]) {
    path_world w = {0};
    w.pair = pair_make(name, device, recipe, setting, NULL);
    lay_rows(&w);
    lay_moments(&w);
    project_nodes(&w);
    compare_rows(&w, used);
    compare_misfits(&w, 1);
    compare_misfits(&w, 2);
    const td_path_batch paths = {w.path_of, 1, w.cubics, w.nodes};
    assert_true(compare_jobs(&w, &paths) > 0);
    compare_shared(&w, &paths);
    pair_free(&w.pair);
    free(w.path_of);
    free(w.gaussians);
    free(w.rows);
}

static void test_paths_equal_the_reference(void **state) {
    static const struct {
        pair_setting image;
        int moving, lanes;
    } settings[] = {{{TIDES_RULES_SMOOTH, 0, 3, 0}, 0, 16},
                    {{TIDES_RULES_SMOOTH, 1, 2, 0}, 1, 8},
                    {{TIDES_RULES_INRIA, 0, 1, 0}, 1, 4},
                    {{TIDES_RULES_GSPLAT, 1, 0, 0}, 0, 1}};
    int used[2] = {0, 0};
    (void)state;
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        tides_device *device = pair_device(settings[i].lanes);
        random_recipe ordinary = pair_ordinary(SEED), around = pair_ordinary(SEED + 1), huge = pair_ordinary(SEED + 2);
        around.spread = 5, around.size = 0.3, around.camera_speed = 8;
        huge.size = 6, huge.count = 60;
        ordinary.moving = around.moving = huge.moving = settings[i].moving;
        compare_world("ordinary", device, &ordinary, &settings[i].image, used);
        compare_world("around the camera", device, &around, &settings[i].image, used);
        compare_world("huge", device, &huge, &settings[i].image, used);
        tides_device_close(device);
    }
    assert_true(used[0] > 0 && used[1] > 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_paths_equal_the_reference)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
