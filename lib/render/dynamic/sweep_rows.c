/* Swept boxes of Gaussians that move by themselves: their rows at an interval's start, middle and end. Those rows are kept
 * where memory allows: the next interval begins where this one ended, and its first samples lie there and in the middle. */
#include "render/dynamic/td_dynamic.h"

/* The rows kept for a time, or NULL. Where rates don't jump either side will do. */
static td_kept *find_kept(td_moved *moved, double time, int side) {
    for (int k = 0; k < TD_KEPT; k++) {
        td_kept *kept = &moved->kept[k];
        if (kept->is_there && !(kept->time < time || kept->time > time) &&
            (kept->side == side || !td_moved_is_knot(moved, time)))
            return kept;
    }
    return NULL;
}

static tides_status work_out(td_moved *moved, td_backend *backend, td_kept *kept, double time, int side, tides_error *error) {
    tides_status status = TIDES_OK;
    kept->is_there = 0;
    td_rows_begin(moved, kept->row);
    for (int p = 0; p < moved->parts && status == TIDES_OK; p++) {
        const td_moved_part *part = &moved->part[p];
        int first = moved->rows.count;
        status = td_rows_reserve(moved, part->count, error);
        for (int i = 0; i < part->count && status == TIDES_OK; i++) td_rows_add(moved, part, part->first + i);
        if (status == TIDES_OK) status = td_rows_end_run(moved, part, first, time, side, error);
    }
    if (status == TIDES_OK) status = td_rows_send(moved, backend, error);
    kept->is_there = status == TIDES_OK;
    kept->time = time;
    kept->side = side;
    return status;
}

/* Rows that none of the three uses: at most two are in use where a third is asked for. */
static td_kept *find_spare(td_moved *moved, td_kept *const used[3]) {
    td_kept *spare = moved->kept;
    while (spare == used[0] || spare == used[1] || spare == used[2]) spare++;
    return spare;
}

/* Rows of the three times, of which those that are needed already aren't given up for another. */
static tides_status keep(td_moved *moved, td_backend *backend, const double time[3], const int side[3], const td_kept *kept[3],
                         tides_error *error) {
    td_kept *used[3] = {NULL, NULL, NULL};
    tides_status status = TIDES_OK;
    for (int i = 0; i < 3; i++) used[i] = find_kept(moved, time[i], side[i]);
    for (int i = 0; i < 3 && status == TIDES_OK; i++) {
        if (!used[i]) used[i] = find_kept(moved, time[i], side[i]); /* worked out for another of the three */
        if (!used[i]) {
            used[i] = find_spare(moved, used);
            status = work_out(moved, backend, used[i], time[i], side[i], error);
        }
        kept[i] = used[i];
    }
    return status;
}

static int padded(int count) { return (count + TD_PAD - 1) / TD_PAD * TD_PAD; }

/* Padding repeats the last Gaussian: no tile may list it twice. */
static void empty_padding(const td_moved_part *part, float *boxes) {
    for (int i = part->count; i < padded(part->count); i++) {
        float *box = boxes + 4 * (size_t)(part->first + i);
        box[0] = box[1] = 0;
        box[2] = box[3] = -1;
    }
}

/* Gaussians [from, from + count) of a part: rows at the three times one after the other, used up at once. */
static tides_status sweep_chunk(td_moved *moved, td_backend *backend, const td_moved_part *part, int from, int count,
                                const double *views, const double *strays, const double time[3], const int side[3],
                                float *boxes, float *travel, tides_error *error) {
    int row[3], length = padded(count);
    tides_status status = td_rows_reserve(moved, 3 * length, error);
    td_rows_begin(moved, moved->store->count);
    if (status == TIDES_OK) status = td_rows_reserve(moved, 3 * length, error);
    for (int i = 0; i < 3 && status == TIDES_OK; i++) {
        int first = moved->rows.count;
        row[i] = moved->rows.row + first;
        for (int k = 0; k < count; k++) td_rows_add(moved, part, part->first + from + k);
        status = td_rows_end_run(moved, part, first, time[i], side[i], error);
    }
    if (status == TIDES_OK) status = td_rows_send(moved, backend, error);
    if (status != TIDES_OK) return status;
    int begin = part->first + from;
    const td_sweep_request request = {views, strays, time[2] - time[0], 0, begin, begin + length, row};
    return backend->type->sweep(backend, &request, boxes, travel, error);
}

tides_status td_moved_sweep(td_moved *moved, td_backend *backend, const double *views, const double *strays, double start,
                            double stop, int side, int row_limit, float *boxes, float *travel, tides_error *error) {
    const double time[3] = {start, start + 0.5 * (stop - start), stop}; /* as steps are halved: its rows are found again */
    const int instant = !(start < stop), sides[3] = {instant ? side : 1, instant ? side : 1, instant ? side : -1};
    const td_kept *kept[3] = {&moved->kept[0], &moved->kept[1], &moved->kept[2]};
    int chunk = row_limit / 3 / TD_PAD * TD_PAD;
    tides_status status = TIDES_OK;
    if (chunk < TD_PAD) chunk = TD_PAD;
    if (moved->kept_rows) status = keep(moved, backend, time, sides, kept, error);
    if (moved->kept_rows && status == TIDES_OK) status = td_moved_measure(moved, backend, views, kept, error);
    for (int p = 0; p < moved->parts; p++) {
        const td_moved_part *part = &moved->part[p];
        int rows[3] = {kept[0]->row + part->base, kept[1]->row + part->base, kept[2]->row + part->base};
        for (int from = 0; from < part->count && !moved->kept_rows && status == TIDES_OK; from += chunk)
            status = sweep_chunk(moved, backend, part, from, part->count - from < chunk ? part->count - from : chunk, views,
                                 strays, time, sides, boxes, travel, error);
        const td_sweep_request request = {views, strays, stop - start, 0, part->first, part->first + padded(part->count), rows};
        if (moved->kept_rows && status == TIDES_OK) status = backend->type->sweep(backend, &request, boxes, travel, error);
        empty_padding(part, boxes);
    }
    return status;
}
