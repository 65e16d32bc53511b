/* Internal: finds the exact nearest of many points in space (k-d tree: Friedman, Bentley & Finkel 1977). */
#ifndef TD_POINT_TREE_H
#define TD_POINT_TREE_H

#include <stddef.h>
#include <stdint.h>

typedef struct td_point {
    double at[3];
} td_point;

/* Points in the order of the tree: the middle of each range splits it. Both arrays are borrowed. */
typedef struct td_point_tree {
    const td_point *points;
    const uint8_t *axes; /* (count): axis along which each middle point splits */
    size_t count;
} td_point_tree;

/* Reorders `points`, so that neighbours in the array are near in space. O(n log n). */
td_point_tree td_point_tree_build(td_point *points, uint8_t *axes, size_t count);

/* The squared distance from `query` to the nearest point; `bound` if none is nearer than that. */
double td_point_tree_nearest(const td_point_tree *tree, const td_point *query, double bound);

#endif
