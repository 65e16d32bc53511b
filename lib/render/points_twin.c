/* Points in C: a twin of the OpenCL kernels in double, equal to the bit. References use it, and devices without double
 * precision. */
#define TD_REAL_DOUBLE
#include "kernels/path_node.h"
#include "kernels/point_instants.h"
#include "kernels/points.h"
#include "td_base.h"
#include "td_points.h"

#include <float.h>
#include <stdlib.h>

/* A splat's place in its tile's list. */
typedef struct twin_key {
    int depth, place, path, gaussian;
} twin_key;

typedef struct twin {
    td_points_engine base;
    td_image image;
    td_points_interval interval;
    double *rows, *curves;
    double *rows_beside, *beside; /* green and blue of these, where paths are by channels */
    int *path;                    /* (gaussians) first curve * TD_PATH_LEVELS + level; below 0: none */
    int *sights;                  /* (2 x gaussians) pixels that may see each */
    float *records;               /* (gaussians x slices x TD_TEST_REALS) tests of each */
    int *places;                  /* (candidate_count x TD_LIST_INTS) the lists */
    float *tests;                 /* (candidate_count x slices x TD_TEST_REALS) */
    int *count;                   /* (tile_count) number of splats in each list */
    twin_key *keys;
    double *entries; /* of a point */
    size_t list_capacity[6], curve_capacity, rows_capacity, rows_beside_capacity, beside_capacity, key_capacity, entry_capacity;
} twin;

typedef char td_point_tile_is_as_here[sizeof(td_point_tile) == sizeof(td_points_tile) ? 1 : -1];
typedef char td_point_chunk_is_as_here[sizeof(td_point_chunk) == sizeof(td_points_chunk) ? 1 : -1];

static int key_order(const void *a, const void *b) {
    const twin_key *x = a, *y = b;
    if (x->depth != y->depth) return x->depth < y->depth ? -1 : 1;
    return x->place < y->place ? -1 : x->place > y->place;
}

static td_point_paths paths_of(const twin *t) {
    const td_points_slices *s = &t->interval.slices;
    const td_point_paths paths = {t->curves, {s->pieces, s->count, s->split, s->group}, t->beside};
    return paths;
}

static tides_status take_rows(twin *t, td_exact *exact, int count, tides_error *error) {
    const size_t reals = (size_t)count * TD_PATH_STRIDE;
    tides_status status = td_reserve((void **)&t->rows, &t->rows_capacity, reals, sizeof *t->rows, error);
    if (status == TIDES_OK && td_paths_by_channels(&t->image))
        status = td_reserve((void **)&t->rows_beside, &t->rows_beside_capacity, (size_t)count * TD_BESIDE_STRIDE,
                            sizeof *t->rows_beside, error);
    return status == TIDES_OK
               ? td_exact_rows(exact, count, t->rows, td_paths_by_channels(&t->image) ? t->rows_beside : NULL, error)
               : status;
}

static tides_status misfits(td_points_engine *engine, const td_points_misfits *request, const td_points_fit *fit,
                            tides_error *error) {
    twin *t = (twin *)engine;
    const td_path_terms terms = {request->target, DBL_EPSILON / 2, request->place};
    const size_t count = (size_t)request->count, tried = td_points_tried(request);
    double *each = td_alloc(tried, sizeof *each, error);
    if (!each) return TIDES_NO_MEMORY;
    tides_status status = take_rows(t, request->exact, request->row_count, error);
    for (int i = 0; i < request->count && status == TIDES_OK; i++) {
        const double worst = td_path_try_each(t->rows, t->rows_beside, request->first[i], request->level, request->pieces,
                                              request->lengths, &terms, &t->image, each, 1);
        fit->worst[i] = (float)worst;
        for (size_t curve = 0; curve < tried && fit->each; curve++) fit->each[curve * count + (size_t)i] = (float)each[curve];
    }
    free(each);
    return status;
}

/* Curve i of a group. */
static void make_curve(const twin *t, const td_points_group *added, int i) {
    const size_t curve = (size_t)added->first + (size_t)i;
    const size_t from = (size_t)added->row[2 * i], to = (size_t)added->row[2 * i + 1];
    const double h = added->lengths[i];
    td_point_curve(t->rows + from * TD_PATH_STRIDE, t->rows + to * TD_PATH_STRIDE, h, t->curves + curve * TD_CURVE_REALS);
    if (td_paths_by_channels(&t->image))
        td_point_curve_beside(t->rows_beside + from * TD_BESIDE_STRIDE, t->rows_beside + to * TD_BESIDE_STRIDE, h,
                              t->beside + curve * TD_BESIDE_REALS);
}

/* Tests of a group. */
static void make_records(twin *t, const td_points_group *added) {
    const td_point_paths paths = paths_of(t);
    for (int i = 0; i < added->seen_count; i++)
        for (int slice = 0; slice < paths.slices.count; slice++) {
            const size_t at = ((size_t)added->seen[i] * (size_t)paths.slices.count + (size_t)slice) * TD_TEST_REALS;
            td_point_make_tests(&paths, &t->image, slice, &added->path[i], t->records, &at);
        }
}

static tides_status begin(td_points_engine *engine, const td_points_interval *interval, tides_error *error) {
    twin *t = (twin *)engine;
    size_t candidates = (size_t)interval->candidate_count, tiles = (size_t)interval->tile_count;
    size_t each = (size_t)interval->slices.count * TD_TEST_REALS, *capacity = t->list_capacity;
    size_t gaussians = (size_t)interval->gaussians;
    t->interval = *interval;
    tides_status status = td_reserve((void **)&t->places, &capacity[0], candidates * TD_LIST_INTS, sizeof *t->places, error);
    if (status == TIDES_OK) status = td_reserve((void **)&t->tests, &capacity[1], candidates * each, sizeof *t->tests, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&t->records, &capacity[3], gaussians * each, sizeof *t->records, error);
    if (status == TIDES_OK) status = td_reserve((void **)&t->sights, &capacity[4], 2 * gaussians, sizeof *t->sights, error);
    if (status == TIDES_OK) status = td_reserve((void **)&t->path, &capacity[5], gaussians, sizeof *t->path, error);
    if (status == TIDES_OK) status = td_reserve((void **)&t->count, &capacity[2], tiles, sizeof *t->count, error);
    for (size_t i = 0; i < gaussians && status == TIDES_OK; i++) t->path[i] = TD_PATH_UNSEEN;
    return status;
}

static tides_status add(td_points_engine *engine, const td_points_group *added, tides_error *error) {
    twin *t = (twin *)engine;
    const size_t curves = (size_t)added->first + (size_t)added->curves;
    tides_status status =
        td_reserve((void **)&t->curves, &t->curve_capacity, curves * TD_CURVE_REALS, sizeof *t->curves, error);
    if (status == TIDES_OK && td_paths_by_channels(&t->image))
        status = td_reserve((void **)&t->beside, &t->beside_capacity, curves * TD_BESIDE_REALS, sizeof *t->beside, error);
    if (status == TIDES_OK) status = take_rows(t, added->exact, added->row_count, error);
    for (int i = 0; i < added->curves && status == TIDES_OK; i++) make_curve(t, added, i);
    for (int i = 0; i < added->seen_count && status == TIDES_OK; i++) {
        t->path[added->seen[i]] = added->path[i];
        memcpy(t->sights + 2 * (size_t)added->seen[i], added->sights + 2 * i, 2 * sizeof *t->sights);
    }
    if (status == TIDES_OK) make_records(t, added);
    return status;
}

static td_point_tile tile_of(const twin *t, int tile) {
    const td_points_tile *job = &t->interval.tiles[tile];
    const td_point_tile place = {job->x, job->y, job->first, job->count};
    return place;
}

static void make_list(twin *t, int number) {
    const td_point_tile tile = tile_of(t, number);
    const td_point_paths paths = paths_of(t);
    int count = 0;
    for (int i = tile.first; i < tile.first + tile.count; i++) {
        const int gaussian = t->interval.candidates[i], path = gaussian < 0 ? -1 : t->path[gaussian];
        if (path >= 0) t->keys[count++] = (twin_key){td_point_depth_key(&paths, path), i, path, gaussian};
    }
    t->count[number] = count;
    if (count == 0) return; /* keys and tests may be NULL */
    qsort(t->keys, (size_t)count, sizeof *t->keys, key_order);
    for (int i = 0; i < count; i++) {
        int *place = t->places + (size_t)(tile.first + i) * TD_LIST_INTS;
        const int *sight = t->sights + 2 * (size_t)t->keys[i].gaussian;
        place[TD_L_PATH] = t->keys[i].path, place[TD_L_NUMBER] = t->keys[i].gaussian;
        place[TD_L_COLUMNS] = sight[0], place[TD_L_ROWS] = sight[1];
    }
    const int groups = (count + TD_PAD - 1) / TD_PAD;
    for (int slice = 0; slice < paths.slices.count; slice++) {
        float *tests = t->tests + td_point_tests_at(&tile, paths.slices.count, slice);
        for (int i = 0; i < count; i++) {
            const size_t at = (size_t)t->keys[i].gaussian * (size_t)paths.slices.count + (size_t)slice;
            td_point_place_test(t->records + at * TD_TEST_REALS, &tile, tests + td_point_test_of(i));
        }
        for (int i = count; i < groups * TD_PAD; i++) td_point_place_nobody(tests + td_point_test_of(i));
        td_point_find_fronts(tests, groups);
    }
}

static tides_status lists(td_points_engine *engine, const int *tiles, int count, tides_error *error) {
    twin *t = (twin *)engine;
    for (int i = 0; i < count; i++) {
        size_t candidates = (size_t)t->interval.tiles[tiles[i]].count;
        tides_status status = td_reserve((void **)&t->keys, &t->key_capacity, candidates, sizeof *t->keys, error);
        if (status != TIDES_OK) return status;
        make_list(t, tiles[i]);
    }
    return TIDES_OK;
}

static td_point_backdrop backdrop_of(const td_points_backdrop *given) {
    const td_point_backdrop behind = {given->first, given->first_dot, given->green, given->blue};
    return behind;
}

static tides_status values(td_points_engine *engine, const td_points_batch *batch, double *out, tides_error *error) {
    twin *t = (twin *)engine;
    const td_point_paths paths = paths_of(t);
    const td_point_lists all = {t->places, t->tests};
    const td_point_backdrop behind = backdrop_of(&batch->backdrop);
    const td_point_arrays points = {batch->column[0], batch->column[1], batch->column[2], batch->column[3], batch->piece};
    for (int i = 0; i < batch->chunk_count; i++) {
        const td_points_chunk *given = &batch->chunks[i];
        const td_point_tile tile = tile_of(t, given->tile);
        const td_point_chunk chunk = {given->tile, given->first, given->count};
        const int taken = t->count[given->tile];
        const size_t room = (size_t)taken * (size_t)td_point_room(&t->image);
        tides_status status = td_reserve((void **)&t->entries, &t->entry_capacity, room, sizeof *t->entries, error);
        if (status != TIDES_OK) return status;
        td_point_chunk_values(&chunk, &tile, taken, &paths, &all, &points, &t->image, t->entries, &behind, out);
    }
    return TIDES_OK;
}

static tides_status finish(td_points_engine *engine, tides_error *error) {
    (void)engine, (void)error;
    return TIDES_OK;
}

static tides_status instants(td_points_engine *engine, const td_points_instants *points, double *out, tides_error *error) {
    twin *t = (twin *)engine;
    const td_point_backdrop behind = backdrop_of(&points->backdrop);
    const size_t room = TD_INSTANT_REALS(points->most, td_point_room(&t->image) / TD_LANES, TD_LANES);
    tides_status status = td_reserve((void **)&t->entries, &t->entry_capacity, room, sizeof *t->entries, error);
    if (status == TIDES_OK && points->count > 0) status = take_rows(t, points->exact, points->end[points->count - 1], error);
    const td_instants of = {t->rows, t->rows_beside, points->end, points->x, points->y, points->most};
    for (int i = 0; i < points->count && status == TIDES_OK; i++)
        td_instant_values(&of, i, 1, &t->image, t->entries, &behind, out);
    return status;
}

static void destroy(td_points_engine *engine) {
    twin *t = (twin *)engine;
    free(t->records);
    free(t->path);
    free(t->sights);
    free(t->places);
    free(t->tests);
    free(t->rows);
    free(t->curves);
    free(t->rows_beside);
    free(t->beside);
    free(t->count);
    free(t->keys);
    free(t->entries);
    free(t);
}

static const td_points_class twin_class = {misfits, begin, add, lists, values, finish, instants, destroy};

tides_status td_points_create_twin(const td_image_numbers *image, td_points_engine **engine, tides_error *error) {
    twin *t = td_alloc(1, sizeof *t, error);
    if (!t) return TIDES_NO_MEMORY;
    t->base.type = &twin_class;
    t->base.lanes = 1;
    memcpy(&t->image, image->real, sizeof image->real);
    memcpy((char *)&t->image + sizeof image->real, image->whole, sizeof image->whole);
    *engine = &t->base;
    return TIDES_OK;
}
