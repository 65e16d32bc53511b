/* The motions of a scene in its store. Gaussians that move get a mover. Rows of Gaussians that rest in spite of a motion are
 * computed here, once. */
#include "motion/td_motion.h"
#include "td_renderer.h"

#include <limits.h>
#include <stdlib.h>

enum { DATA_ALIGN = 16 }; /* reals: alignment for a device's vector loads */

/* Computes the rows of Gaussians that the motion leaves at rest. */
static tides_status rest(const tides_object *object, const td_mover_numbers *numbers, const td_resting *resting, int fades,
                         td_store *store, tides_error *error) {
    size_t count = (size_t)resting->count, first = (size_t)resting->first,
           sh = numbers->moves_sh ? (size_t)store->sh_stride : 0;
    if (count == 0) return TIDES_OK;
    double *rates = td_alloc(count * TD_GEOMETRY_STRIDE, sizeof *rates, error);
    double *wide = td_alloc(2 * count * sh + 1, sizeof *wide, error);
    tides_status status = rates && wide ? TIDES_OK : TIDES_NO_MEMORY;
    td_motion_sink sink = {store->geometry + first * TD_GEOMETRY_STRIDE, rates, wide, wide + count * sh, store->sh_stride};
    const td_motion_asked asked = {object->motion->start, 1, 1, fades, store->number + first, resting->count};
    if (status == TIDES_OK) status = td_motion_rows(object->motion, &object->gaussians, numbers, &asked, &sink, error);
    for (size_t i = 0; i < count * sh && status == TIDES_OK; i++) store->sh[first * sh + i] = (float)wide[i];
    free(rates);
    free(wide);
    return status;
}

/* The number of a kind of kernel; a new one if no equal kind exists. */
static tides_status find_kind(td_movers *movers, int model, const char *defines, int *kind, tides_error *error) {
    for (*kind = 0; *kind < movers->kinds; (*kind)++)
        if (movers->kinds_of[*kind].model == model && strcmp(movers->kinds_of[*kind].defines, defines) == 0) return TIDES_OK;
    td_move_kind *grown = realloc(movers->kinds_of, ((size_t)movers->kinds + 1) * sizeof *grown);
    if (!grown) return td_fail(error, TIDES_NO_MEMORY, "out of memory for a motion");
    movers->kinds_of = grown;
    memset(&grown[movers->kinds], 0, sizeof *grown);
    grown[movers->kinds].model = model;
    snprintf(grown[movers->kinds].defines, sizeof grown->defines, "%s", defines);
    movers->kinds++;
    return TIDES_OK;
}

/* Appends a motion's data, aligned to DATA_ALIGN. */
static tides_status add_data(td_movers *movers, const td_mover_numbers *numbers, int *first, tides_error *error) {
    size_t from = (movers->data_count + DATA_ALIGN - 1) / DATA_ALIGN * DATA_ALIGN, count = from + numbers->data_count;
    if (count > INT_MAX) return td_fail(error, TIDES_UNSUPPORTED, "%zu numbers are more than 32-bit indices reach", count);
    double *grown = realloc(movers->data, (count + 1) * sizeof *grown);
    if (!grown) return td_fail(error, TIDES_NO_MEMORY, "out of memory: %zu numbers of a motion", count);
    for (size_t i = movers->data_count; i < from; i++) grown[i] = 0;
    if (numbers->data_count) memcpy(grown + from, numbers->data, numbers->data_count * sizeof *grown);
    grown[count] = 0; /* a device needs at least one number */
    movers->data = grown;
    movers->data_count = count;
    *first = (int)from;
    return TIDES_OK;
}

static tides_status grow_movers(td_movers *movers, tides_error *error) {
    size_t count = (size_t)movers->count + 1;
    td_mover_row *rows = realloc(movers->row, count * sizeof *rows);
    if (rows) movers->row = rows;
    int *kinds = realloc(movers->kind, count * sizeof *kinds);
    if (kinds) movers->kind = kinds;
    return rows && kinds ? TIDES_OK : td_fail(error, TIDES_NO_MEMORY, "out of memory for a motion");
}

static tides_status add_mover(const tides_object *object, const td_mover_numbers *numbers, int fades, td_movers *movers,
                              tides_error *error) {
    int kind = 0, first = 0, model = object->motion->type->code;
    tides_status status = grow_movers(movers, error);
    if (status == TIDES_OK) status = find_kind(movers, model, numbers->defines, &kind, error);
    if (status == TIDES_OK) status = add_data(movers, numbers, &first, error);
    if (status != TIDES_OK) return status;
    /* members of td_mover behind `own`, in its order */
    const int facts[] = {model, first, (int)object->gaussians.count, numbers->moves_sh != 0, fades};
    td_mover_row *row = &movers->row[movers->count];
    memset(row, 0, sizeof *row);
    memcpy(row->real, numbers->real, sizeof row->real);
    memcpy(row->whole, numbers->own, sizeof numbers->own);
    memcpy(row->whole + TD_MOVER_INTS, facts, sizeof facts);
    movers->kind[movers->count++] = kind;
    if (numbers->moves_sh) movers->moves_sh = 1;
    return TIDES_OK;
}

tides_status td_store_add_motion(const tides_object *object, const td_resting *resting, int moving_part, int fades,
                                 td_store *store, tides_error *error) {
    td_mover_numbers numbers;
    memset(&numbers, 0, sizeof numbers);
    tides_status status = object->motion->type->pack(object->motion, &object->gaussians, &numbers, error);
    if (status == TIDES_OK) status = rest(object, &numbers, resting, fades, store, error);
    if (status == TIDES_OK && moving_part >= 0) {
        status = add_mover(object, &numbers, fades, &store->movers, error);
        if (status == TIDES_OK) store->mover[moving_part] = store->movers.count - 1;
    }
    td_mover_release(&numbers);
    return status;
}
