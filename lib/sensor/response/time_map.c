/* A substep's time as the integral of a filter's rate that goes with the light: the map, its inverse and its slope. */
#include "td_time_map.h"
#include "td_extremes.h"
#include "td_light_step.h"
#include "signal/td_root.h"

#include <math.h>

static double within(double v) { return td_lesser(td_greater(v, 0), 1); }

double td_time_map_place(const td_time_map *map, double u) {
    if (!map->on || u <= 0 || u >= 1) return within(u);
    return td_light_place(map->term, 2 * u - 1);
}

double td_time_map_speed(const td_time_map *map, double u) {
    if (!map->on) return 1;
    double x = 2 * u - 1, sum = 0;
    for (int k = TD_TIME_MAP_TERMS - 1; k >= 1; k--) sum = sum * x + k * map->term[k];
    return 2 * sum;
}

/* The place for which a time is sought. */
typedef struct sought {
    const td_time_map *map;
    double v;
} sought;

static double excess_of(const void *of, double u) {
    const sought *at = of;
    return td_time_map_place(at->map, u) - at->v;
}

static double speed_of(const void *of, double u) { return td_time_map_speed(((const sought *)of)->map, u); }

double td_time_map_time(const td_time_map *map, double v) {
    const sought at = {map, v};
    if (!map->on || v <= 0 || v >= 1) return fmin(fmax(v, 0), 1);
    return td_root(excess_of, speed_of, &at, 1, 0, 1, v);
}

td_model td_time_map_model(const td_time_map *map, const td_model *model) {
    td_model mapped = *model;
    if (map->on) td_light_mapped(model->control, map->term, mapped.control);
    return mapped;
}
