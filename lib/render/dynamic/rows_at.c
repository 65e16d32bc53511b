/* Rows of some dynamic Gaussians at some times, for the nodes of record paths. */
#include "render/dynamic/td_dynamic.h"

static void take_cached(const td_dynamic *dynamic, const td_row_cache *cached, const int *gaussians, int count, int *rows) {
    for (int i = 0; i < count; i++) {
        const td_dynamic_object *object = td_dynamic_object_of(dynamic, gaussians[i]);
        rows[i] = object ? cached->row + gaussians[i] - object->first + object->base : gaussians[i];
    }
}

void td_dynamic_rows_open(td_dynamic *dynamic) { td_rows_begin(dynamic, dynamic->store->count + dynamic->cached_rows); }

tides_status td_dynamic_rows_ask(td_dynamic *dynamic, const int *gaussians, int count, double time, int side, int *rows,
                                 tides_error *error) {
    const td_row_cache *cached = dynamic->cached_rows ? td_dynamic_find_cached(dynamic, time, side) : NULL;
    tides_status status = TIDES_OK;
    if (cached) {
        take_cached(dynamic, cached, gaussians, count, rows);
        return status;
    }
    for (int i = 0; i < count && status == TIDES_OK;) {
        const td_dynamic_object *object = td_dynamic_object_of(dynamic, gaussians[i]);
        int first = dynamic->rows.count;
        if (object) status = td_rows_reserve(dynamic, count - i + TD_PAD, error);
        for (; i < count && td_dynamic_object_of(dynamic, gaussians[i]) == object && status == TIDES_OK; i++) {
            rows[i] = object ? dynamic->rows.row + dynamic->rows.count : gaussians[i];
            if (object) td_rows_add(dynamic, object, gaussians[i]);
        }
        if (object && status == TIDES_OK) status = td_rows_end_run(dynamic, object, first, time, side, error);
    }
    return status;
}

tides_status td_dynamic_rows_at(td_dynamic *dynamic, td_backend *backend, const int *gaussians, int count, double time,
                                int side, int *rows, tides_error *error) {
    td_dynamic_rows_open(dynamic);
    tides_status status = td_dynamic_rows_ask(dynamic, gaussians, count, time, side, rows, error);
    return status == TIDES_OK ? td_rows_send(dynamic, backend, error) : status;
}
