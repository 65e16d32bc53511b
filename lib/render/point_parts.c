/* Parts of an interval, each with rows of its own (td_point_parts.h). */
#include "td_point_parts.h"

#include <stdlib.h>

void td_point_parts_release(td_point_parts *parts) { free(parts->part); }

static tides_status reserve(td_point_parts *parts, int count, tides_error *error) {
    return td_reserve((void **)&parts->part, &parts->capacity, (size_t)count, sizeof *parts->part, error);
}

tides_status td_point_parts_begin(td_point_parts *parts, const td_point_span *span, tides_error *error) {
    tides_status status = reserve(parts, 1, error);
    if (status != TIDES_OK) return status;
    parts->part[0] = (td_point_part){.start = span->start, .stop = span->stop};
    parts->count = 1;
    parts->serial = span->serial;
    return status;
}

tides_status td_point_parts_halve(td_point_parts *parts, int k, double at, tides_error *error) {
    tides_status status = reserve(parts, parts->count + 1, error);
    if (status != TIDES_OK) return status;
    memmove(parts->part + k + 1, parts->part + k, (size_t)(parts->count - k) * sizeof *parts->part);
    parts->part[k].stop = parts->part[k + 1].start = at;
    parts->count++;
    return status;
}

int td_point_parts_of(const td_point_parts *parts, double time) {
    int low = 0, high = parts->count - 1;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (time <= parts->part[middle].stop)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}
