/* Internal to lib/render: which splats single pixels may see, by the splats' boxes. The pool's threads share the points. */
#ifndef TD_POINTS_NEAR_H
#define TD_POINTS_NEAR_H

#include "td_point_nodes.h"
#include "td_render.h"

struct tides_renderer;

/* Some of the points that are asked for: those numbered which[0 .. count). Their values go to the same numbers. */
typedef struct td_points_some {
    const td_point *points;
    td_point_value *values;
    const int *which;
    int count;
} td_points_some;

/* Points that one thread looks at, one after the other. */
typedef struct td_near_portion {
    int tile;         /* whose list it has; -1: none */
    int *gaussian;    /* (count) the list without its padding, */
    float *side[4];   /* (count) their boxes' sides, */
    uint8_t *touches; /* (count) and 1 for those that touch the last point's pixel */
    int count;
    int *found; /* (found_count) what its points may see, point by point */
    size_t found_count, capacity[6], found_capacity;
    tides_status status;
    tides_error error;
} td_near_portion;

typedef struct td_points_near {
    td_near_portion *portion;
    size_t portions;
    int *count;       /* (points) how many splats each point may see, */
    const int **seen; /* (points) and which */
    size_t count_capacity, seen_capacity;
} td_points_near;

void td_points_near_release(td_points_near *near);

/* Finds what the points may see: near->count, near->seen. */
tides_status td_points_near_find(const struct tides_renderer *renderer, td_points_near *near, const td_point_span *span,
                                 const td_points_some *some, tides_error *error);

#endif
