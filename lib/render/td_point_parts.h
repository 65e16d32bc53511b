/* Internal to lib/render: the parts of an interval that points are asked for of (points.c), each with rows of its own. Most
 * intervals are one. */
#ifndef TD_POINT_PARTS_H
#define TD_POINT_PARTS_H

#include "td_point_nodes.h"

typedef struct td_point_part {
    double start, stop; /* [s after the epoch] */
} td_point_part;

typedef struct td_point_parts {
    td_point_part *part; /* (count) in order of time */
    int count;
    uint64_t serial; /* of the interval */
    size_t capacity;
} td_point_parts;

void td_point_parts_release(td_point_parts *parts);

/* Are these of another interval than `span`? */
static inline int td_point_parts_are_others(const td_point_parts *parts, const td_point_span *span) {
    return parts->count == 0 || parts->serial != span->serial;
}

/* A new interval is one part, until that has turned out not to do; then part k is two, which meet at a time within it. */
tides_status td_point_parts_begin(td_point_parts *parts, const td_point_span *span, tides_error *error);
tides_status td_point_parts_halve(td_point_parts *parts, int k, double at, tides_error *error);

/* The part that a time is in: where one ends, that one. */
int td_point_parts_of(const td_point_parts *parts, double time);

#endif
