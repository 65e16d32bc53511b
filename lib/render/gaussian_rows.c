/* Rows of single Gaussians at one time, on the host in double. Rows of Gaussians that move by themselves come from the
 * backend, others from the store. */
#include "td_renderer.h"

#include <stdlib.h>

enum { ROWS_AT_ONCE = 4096 };

/* Gaussian `gaussian` goes to row `place`. */
typedef struct wanted {
    int gaussian, place;
} wanted;

static int by_gaussian(const void *a, const void *b) {
    const wanted *x = a, *y = b;
    return x->gaussian < y->gaussian ? -1 : x->gaussian > y->gaussian;
}

/* Fetches rows of Gaussians that move by themselves; wants[0 .. count) is ascending. `lists` is scratch memory for
 * 2 x ROWS_AT_ONCE numbers. */
static tides_status take_moved(tides_renderer *r, const wanted *wants, int count, double time, int *lists, td_moved_rows *moved,
                               double *geometry, tides_error *error) {
    int *gaussians = lists, *rows = lists + ROWS_AT_ONCE;
    for (int i = 0; i < count; i++) gaussians[i] = wants[i].gaussian;
    tides_status status = td_dynamic_rows_at(&r->dynamic, r->backend, gaussians, count, time, TD_SIDE_BEGINS, rows, error);
    for (int i = 0; i < count && status == TIDES_OK;) {
        int last = i;
        while (last + 1 < count && rows[last + 1] - rows[i] < ROWS_AT_ONCE) last++;
        moved->row = rows[i];
        moved->count = rows[last] - rows[i] + 1;
        status = r->backend->type->moved_rows(r->backend, moved, error);
        for (; i <= last && status == TIDES_OK; i++)
            memcpy(geometry + (size_t)wants[i].place * TD_GEOMETRY_STRIDE,
                   moved->geometry + (size_t)(rows[i] - moved->row) * TD_GEOMETRY_STRIDE,
                   TD_GEOMETRY_STRIDE * sizeof *geometry);
    }
    return status;
}

tides_status td_renderer_rows_at(tides_renderer *r, const int *gaussians, size_t count, double time, double *geometry,
                                 tides_error *error) {
    const td_store *store = &r->store;
    wanted *wants = td_alloc(count + 1, sizeof *wants, error);
    int *lists = td_alloc(2 * ROWS_AT_ONCE, sizeof *lists, error);
    td_moved_rows moved = {0};
    tides_status status = wants && lists ? TIDES_OK : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = td_moved_rows_reserve(ROWS_AT_ONCE, (size_t)store->sh_stride, &moved, error);
    int moving = 0;
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        const int g = gaussians[i];
        if (g < 0) continue;
        if (store->mover[store->object[g]] >= 0)
            wants[moving++] = (wanted){g, (int)i};
        else
            memcpy(geometry + i * TD_GEOMETRY_STRIDE, store->geometry + (size_t)g * TD_GEOMETRY_STRIDE,
                   TD_GEOMETRY_STRIDE * sizeof *geometry);
    }
    if (moving) qsort(wants, (size_t)moving, sizeof *wants, by_gaussian);
    for (int from = 0; from < moving && status == TIDES_OK; from += ROWS_AT_ONCE)
        status = take_moved(r, wants + from, moving - from < ROWS_AT_ONCE ? moving - from : ROWS_AT_ONCE, time, lists, &moved,
                            geometry, error);
    td_moved_rows_release(&moved);
    free(wants);
    free(lists);
    return status;
}
