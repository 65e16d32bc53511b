/* Single pixels at single times in C: the twin of the OpenCL kernels in double precision, to the bit, and what reference
 * devices have. */
#define TD_REAL_DOUBLE
#define TD_EXACT
#include "kernels/path_node.h"
#include "kernels/points.h"
#include "td_base.h"
#include "td_points.h"

#include <float.h>
#include <stdlib.h>

/* A splat's place in its tile's list. */
typedef struct twin_key {
    double depth, power;
    int gaussian, blocks;
} twin_key;

typedef struct twin {
    td_points_engine base;
    td_image image;
    td_points_interval interval;
    double *rows, *curves;
    int *gaussian, *blocks; /* (candidate_count) the lists */
    double *power;
    int *count; /* (tile_count) splats of each */
    twin_key *keys;
    double *entries; /* td_point_room */
    int *order, *found;
    size_t list_capacity[4], curve_capacity, rows_capacity, key_capacity, room_capacity[3];
} twin;

typedef char td_point_tile_is_as_here[sizeof(td_point_tile) == sizeof(td_points_tile) ? 1 : -1];
typedef char td_point_chunk_is_as_here[sizeof(td_point_chunk) == sizeof(td_points_chunk) ? 1 : -1];

static int key_order(const void *a, const void *b) {
    const twin_key *x = a, *y = b;
    if (x->depth != y->depth) return x->depth < y->depth ? -1 : 1;
    return x->gaussian < y->gaussian ? -1 : x->gaussian > y->gaussian;
}

static td_point_paths paths_of(const twin *t) {
    const td_point_paths paths = {t->interval.path, t->curves, t->interval.pieces};
    return paths;
}

static tides_status take_rows(twin *t, td_exact *exact, int count, tides_error *error) {
    const size_t reals = (size_t)count * TD_PATH_STRIDE;
    tides_status status = td_reserve((void **)&t->rows, &t->rows_capacity, reals, sizeof *t->rows, error);
    return status == TIDES_OK ? td_exact_rows(exact, count, t->rows, error) : status;
}

static tides_status misfits(td_points_engine *engine, const td_points_misfits *request, float *out, tides_error *error) {
    twin *t = (twin *)engine;
    const td_path_terms terms = {request->target, 0, DBL_EPSILON / 2, 0};
    double *lengths = td_alloc((size_t)request->pieces, sizeof *lengths, error);
    if (!lengths) return TIDES_NO_MEMORY;
    for (int i = 0; i < request->pieces; i++) lengths[i] = request->knot[i + 1] - request->knot[i];
    tides_status status = take_rows(t, request->exact, request->row_count, error);
    for (int i = 0; i < request->count && status == TIDES_OK; i++)
        out[i] = (float)td_path_worst(t->rows, request->first[i], request->level, request->pieces, lengths, &terms, &t->image);
    free(lengths);
    return status;
}

static tides_status begin(td_points_engine *engine, const td_points_interval *interval, tides_error *error) {
    twin *t = (twin *)engine;
    size_t candidates = (size_t)interval->candidate_count, tiles = (size_t)interval->tile_count;
    t->interval = *interval;
    tides_status status = td_reserve((void **)&t->gaussian, &t->list_capacity[0], candidates, sizeof *t->gaussian, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&t->blocks, &t->list_capacity[1], candidates, sizeof *t->blocks, error);
    if (status == TIDES_OK) status = td_reserve((void **)&t->power, &t->list_capacity[3], candidates, sizeof *t->power, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&t->curves, &t->curve_capacity, (size_t)interval->curves * TD_CURVE_REALS,
                            sizeof *t->curves, error);
    if (status == TIDES_OK) status = take_rows(t, interval->exact, interval->row_count, error);
    for (int i = 0; i < interval->curves && status == TIDES_OK; i++)
        td_point_curve(t->rows + (size_t)interval->row[2 * i] * TD_PATH_STRIDE,
                       t->rows + (size_t)interval->row[2 * i + 1] * TD_PATH_STRIDE, interval->lengths[i],
                       t->curves + (size_t)i * TD_CURVE_REALS);
    if (status == TIDES_OK) status = td_reserve((void **)&t->count, &t->list_capacity[2], tiles, sizeof *t->count, error);
    return status;
}

static void make_list(twin *t, int tile) {
    const td_points_tile *job = &t->interval.tiles[tile];
    const td_point_tile place = {job->x, job->y, job->first, job->count};
    const td_point_paths paths = paths_of(t);
    int count = 0;
    for (int i = job->first; i < job->first + job->count; i++) {
        twin_key key;
        key.gaussian = t->interval.candidates[i];
        key.blocks = td_point_candidates(&paths, &t->image, &place, key.gaussian, &key.depth, &key.power);
        if (key.blocks) t->keys[count++] = key;
    }
    qsort(t->keys, (size_t)count, sizeof *t->keys, key_order);
    for (int i = 0; i < count; i++) {
        t->gaussian[job->first + i] = t->keys[i].gaussian;
        t->blocks[job->first + i] = t->keys[i].blocks;
        t->power[job->first + i] = t->keys[i].power;
    }
    t->count[tile] = count;
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

/* Room for a list of `count` splats. */
static tides_status reserve_room(twin *t, size_t count, tides_error *error) {
    size_t *capacity = t->room_capacity;
    tides_status status =
        td_reserve((void **)&t->entries, &capacity[0], (count + 1) * TD_POINT_ENTRY, sizeof *t->entries, error);
    if (status == TIDES_OK) status = td_reserve((void **)&t->order, &capacity[1], count + 1, sizeof *t->order, error);
    if (status == TIDES_OK) status = td_reserve((void **)&t->found, &capacity[2], count + 1, sizeof *t->found, error);
    return status;
}

static tides_status values(td_points_engine *engine, const td_points_batch *batch, double *out, tides_error *error) {
    twin *t = (twin *)engine;
    const td_point_paths paths = paths_of(t);
    const td_point_lists all = {t->gaussian, t->blocks, t->power};
    const td_point_arrays points = {batch->column[0], batch->column[1], batch->column[2], batch->column[3], batch->piece};
    for (int i = 0; i < batch->chunk_count; i++) {
        const td_points_chunk *given = &batch->chunks[i];
        const td_points_tile *job = &t->interval.tiles[given->tile];
        const td_point_tile tile = {job->x, job->y, job->first, t->count[given->tile]};
        const td_point_chunk chunk = {given->tile, given->first, given->count, given->blocks};
        tides_status status = reserve_room(t, (size_t)tile.count, error);
        if (status != TIDES_OK) return status;
        const td_point_room room = {t->entries, t->order, t->found};
        td_point_chunk_values(&chunk, &tile, &paths, &all, &points, &t->image, &room, batch->backdrop, batch->backdrop_dot,
                              out);
    }
    return TIDES_OK;
}

static void destroy(td_points_engine *engine) {
    twin *t = (twin *)engine;
    free(t->gaussian);
    free(t->blocks);
    free(t->power);
    free(t->rows);
    free(t->curves);
    free(t->count);
    free(t->keys);
    free(t->entries);
    free(t->order);
    free(t->found);
    free(t);
}

static const td_points_class twin_class = {misfits, begin, lists, values, destroy};

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
