/* Splats that motion models move, for the search of swaps of depth (td_swaps.h): their places and rates at its samples, and
 * their shapes in the middle. On the host, in double. Networks are left out, whose rows cost more than the rest of a step, and
 * callbacks, which are the caller's. */
#include "motion/td_motion.h"
#include "scene/td_scene.h"
#include "td_swaps.h"

#include <stdlib.h>
#include <string.h>

/* Rows that a motion is asked for at once. */
enum { ROWS = 128, SH_STRIDE = 3 * (TIDES_SH_DEGREE_MAX + 1) * (TIDES_SH_DEGREE_MAX + 1) };

typedef struct batch {
    int count, splat[ROWS]; /* rows of the store */
    int32_t index[ROWS];    /* of the motion */
    double geometry[ROWS * TD_GEOMETRY_STRIDE], rates[ROWS * TD_GEOMETRY_STRIDE];
    double sh[ROWS * SH_STRIDE], sh_rates[ROWS * SH_STRIDE];
} batch;

/* An object that a motion moves, and what the motion's rows are made of. */
typedef struct moving {
    tides_object of;
    td_mover_numbers numbers;
} moving;

/* 1 where the store's object `i` is one whose rows are worked out here. */
static int find_moving(const tides_renderer *renderer, int i, moving *to, tides_status *status, tides_error *error) {
    const td_store *store = &renderer->store;
    if (store->mover[i] < 0) return 0;
    *status = tides_scene_object(renderer->scene, store->scene_object[i], &to->of, error);
    if (*status != TIDES_OK) return 0;
    const td_motion_class *type = to->of.motion->type;
    if (type->expensive || type->code == TD_MOTION_HOST) return 0;
    const td_mover_row *row = &store->movers.row[store->mover[i]];
    memset(&to->numbers, 0, sizeof to->numbers);
    memcpy(to->numbers.real, row->real, sizeof to->numbers.real);
    memcpy(to->numbers.own, row->whole, sizeof to->numbers.own);
    to->numbers.data = store->movers.data + row->whole[TD_MOVER_INTS + 1]; /* td_mover's members behind `own`: model, first */
    to->numbers.moves_sh = row->whole[TD_MOVER_INTS + 3];
    return 1;
}

/* A splat at sample k: its shape is that of the middle, and its opacity the largest. */
static void put(struct td_swaps *swaps, const td_swap_samples *at, int splat, int k, const double *geometry,
                const double *rates) {
    const size_t n = (size_t)swaps->mover[splat];
    td_swap_move *move = swaps->move + n * (size_t)(at->parts + 1) + k;
    double *shape = swaps->shape + n * TD_GEOMETRY_STRIDE, opacity = geometry[TD_G_OPACITY];
    memcpy(move->mean, geometry + TD_G_MEAN, sizeof move->mean);
    memcpy(move->rate, rates + TD_G_MEAN, sizeof move->rate);
    if (k > 0 && shape[TD_G_OPACITY] > opacity) opacity = shape[TD_G_OPACITY];
    if (k == 0 || k == at->parts / 2) memcpy(shape, geometry, TD_GEOMETRY_STRIDE * sizeof *shape);
    shape[TD_G_OPACITY] = opacity;
}

/* 1 if a splat keeps its place at all samples, as where a lamp changes its light. */
static int keeps_place(const struct td_swaps *swaps, const td_swap_samples *at, int splat) {
    const td_swap_move *move = swaps->move + (size_t)swaps->mover[splat] * (size_t)(at->parts + 1);
    int keeps = 1;
    for (int k = 0; k <= at->parts; k++)
        for (int i = 0; i < 3; i++) keeps &= move[k].mean[i] == move[0].mean[i] && move[k].rate[i] == 0;
    return keeps;
}

static tides_status move_batch(struct td_swaps *swaps, const td_swap_samples *at, const moving *object, batch *b,
                               tides_error *error) {
    const tides_object *of = &object->of;
    const td_motion_sink sink = {b->geometry, b->rates, b->sh, b->sh_rates, SH_STRIDE};
    tides_status status = TIDES_OK;
    for (int k = 0; k <= at->parts && status == TIDES_OK; k++) {
        double tau = 0, tau_dot = 0;
        status = td_motion_time(of->motion, of->duration_s, at->time[k], &tau, &tau_dot, error);
        const td_motion_asked asked = {tau, tau_dot, k < at->parts ? 1 : -1, 0, b->index, b->count};
        if (status == TIDES_OK) status = td_motion_rows(of->motion, &of->gaussians, &object->numbers, &asked, &sink, error);
        for (int i = 0; i < b->count && status == TIDES_OK; i++)
            put(swaps, at, b->splat[i], k, b->geometry + i * TD_GEOMETRY_STRIDE, b->rates + i * TD_GEOMETRY_STRIDE);
    }
    for (int i = 0; i < b->count && status == TIDES_OK; i++)
        swaps->rest += swaps->rests[swaps->mover[b->splat[i]]] = (uint8_t)keeps_place(swaps, at, b->splat[i]);
    b->count = 0;
    return status;
}

static tides_status move_object(const tides_renderer *renderer, struct td_swaps *swaps, const td_swap_samples *at, int object,
                                const moving *of, batch *b, tides_error *error) {
    const td_store *store = &renderer->store;
    tides_status status = TIDES_OK;
    b->count = 0;
    for (int g = 0; g < store->count && status == TIDES_OK; g++) {
        const float *box = renderer->sweep.boxes + 4 * (size_t)g;
        if (store->object[g] != object || !(box[0] <= box[2])) continue;
        swaps->mover[g] = swaps->moves++;
        const size_t moves = (size_t)swaps->moves, samples = (size_t)at->parts + 1;
        status = td_reserve((void **)&swaps->move, &swaps->move_capacity, moves * samples, sizeof *swaps->move, error);
        if (status == TIDES_OK)
            status = td_reserve((void **)&swaps->shape, &swaps->shape_capacity, moves * TD_GEOMETRY_STRIDE,
                                sizeof *swaps->shape, error);
        if (status == TIDES_OK)
            status = td_reserve((void **)&swaps->rests, &swaps->rests_capacity, moves, sizeof *swaps->rests, error);
        b->splat[b->count] = g;
        b->index[b->count++] = store->number[g];
        if (status == TIDES_OK && b->count == ROWS) status = move_batch(swaps, at, of, b, error);
    }
    if (status == TIDES_OK && b->count > 0) status = move_batch(swaps, at, of, b, error);
    return status;
}

tides_status td_swaps_move(const tides_renderer *renderer, struct td_swaps *swaps, const td_swap_samples *at,
                           tides_error *error) {
    tides_status status = TIDES_OK;
    batch *b = NULL;
    moving object;
    swaps->moves = swaps->rest = 0;
    for (int g = 0; g < renderer->store.count; g++) swaps->mover[g] = -1;
    for (int i = 0; i < renderer->store.objects && status == TIDES_OK; i++) {
        if (!find_moving(renderer, i, &object, &status, error)) continue;
        if (!b && !(b = td_alloc(1, sizeof *b, error))) return TIDES_NO_MEMORY;
        swaps->group[i] = td_object_travels(&object.of) ? i + 1 : 0;
        status = move_object(renderer, swaps, at, i, &object, b, error);
    }
    free(b);
    return status;
}
