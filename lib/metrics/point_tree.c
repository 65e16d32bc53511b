/* A k-d tree in an array. The middle point of a range splits it along its longest side. Ranges of a few points are searched
 * linearly. */
#include "td_point_tree.h"

#include <math.h>

/* Largest number of points in a range that isn't split. */
enum { LEAF = 8 };

static int longest_side(const td_point *points, size_t count) {
    double low[3], high[3];
    for (int k = 0; k < 3; k++) low[k] = high[k] = points[0].at[k];
    for (size_t i = 1; i < count; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = points[i].at[k] < low[k] ? points[i].at[k] : low[k];
            high[k] = points[i].at[k] > high[k] ? points[i].at[k] : high[k];
        }
    int axis = high[1] - low[1] > high[0] - low[0] ? 1 : 0;
    return high[2] - low[2] > high[axis] - low[axis] ? 2 : axis;
}

static void swap(td_point *a, td_point *b) {
    td_point held = *a;
    *a = *b;
    *b = held;
}

/* The median of three coordinates, so that sorted points split evenly. */
static double pivot_of(const td_point *points, size_t count, int axis) {
    const double a = points[0].at[axis], b = points[count / 2].at[axis], c = points[count - 1].at[axis];
    return fmax(fmin(a, b), fmin(fmax(a, b), c));
}

/* Reorders the points so that none before `rank` is above it along the axis, and none behind is below (Hoare's FIND). Both
 * scans stop at equal values, because many points share a coordinate. */
static void select_rank(td_point *points, ptrdiff_t count, ptrdiff_t rank, int axis) {
    ptrdiff_t low = 0, high = count - 1;
    while (low < high) {
        const double pivot = pivot_of(points + low, (size_t)(high - low + 1), axis);
        ptrdiff_t i = low, j = high;
        while (i <= j) {
            while (points[i].at[axis] < pivot) i++;
            while (points[j].at[axis] > pivot) j--;
            if (i <= j) swap(&points[i++], &points[j--]);
        }
        if (rank <= j)
            high = j;
        else if (rank >= i)
            low = i;
        else
            return;
    }
}

static void build(td_point *points, uint8_t *axes, size_t count) {
    while (count > LEAF) {
        const size_t middle = count / 2;
        const int axis = longest_side(points, count);
        select_rank(points, (ptrdiff_t)count, (ptrdiff_t)middle, axis);
        axes[middle] = (uint8_t)axis;
        build(points, axes, middle);
        points += middle + 1;
        axes += middle + 1;
        count -= middle + 1;
    }
}

td_point_tree td_point_tree_build(td_point *points, uint8_t *axes, size_t count) {
    build(points, axes, count);
    return (td_point_tree){points, axes, count};
}

static inline double square_distance(const td_point *a, const td_point *b) {
    const double x = a->at[0] - b->at[0], y = a->at[1] - b->at[1], z = a->at[2] - b->at[2];
    return x * x + y * y + z * z;
}

/* A search. `outside` is the query's distance from the range's box along each axis. No point in the range is nearer than the
 * root of `beyond`, the sum of their squares (Arya & Mount 1993). */
typedef struct search {
    const td_point *query;
    double outside[3];
    double best;
} search;

static void search_range(search *s, const td_point *points, const uint8_t *axes, size_t count, double beyond) {
    while (count > LEAF) {
        const size_t middle = count / 2;
        const int axis = axes[middle];
        const double across = s->query->at[axis] - points[middle].at[axis], here = square_distance(s->query, &points[middle]);
        if (here < s->best) s->best = here;
        const size_t after = count - middle - 1;
        const int upper = across > 0;
        search_range(s, upper ? points + middle + 1 : points, upper ? axes + middle + 1 : axes, upper ? after : middle, beyond);
        const double before = s->outside[axis];
        beyond += across * across - before * before;
        if (!(beyond < s->best)) return;
        s->outside[axis] = across;
        search_range(s, upper ? points : points + middle + 1, upper ? axes : axes + middle + 1, upper ? middle : after, beyond);
        s->outside[axis] = before;
        return;
    }
    for (size_t i = 0; i < count; i++) {
        const double here = square_distance(s->query, &points[i]);
        if (here < s->best) s->best = here;
    }
}

double td_point_tree_nearest(const td_point_tree *tree, const td_point *query, double bound) {
    search s = {query, {0, 0, 0}, bound};
    search_range(&s, tree->points, tree->axes, tree->count, 0.0);
    return s.best;
}
