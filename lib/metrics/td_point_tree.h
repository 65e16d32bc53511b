/* Internal: the nearest of many points in space, exactly (a k-d tree: Friedman, Bentley & Finkel 1977). */
#ifndef TD_POINT_TREE_H
#define TD_POINT_TREE_H

#include <stddef.h>
#include <stdint.h>

typedef struct td_point {
    double at[3];
} td_point;

/* Points in the order of the tree: the middle of each range splits it. The arrays are the caller's. */
typedef struct td_point_tree {
    const td_point *points;
    const uint8_t *axes; /* (count) the axis along which each middle point splits */
    size_t count;
} td_point_tree;

/* Builds a tree, in n log n. Reorders `points`; neighbours in the new order are near in space. */
td_point_tree td_point_tree_build(td_point *points, uint8_t *axes, size_t count);

/* The squared distance from `query` to the nearest point, at most `bound`. */
double td_point_tree_nearest(const td_point_tree *tree, const td_point *query, double bound);

#endif
