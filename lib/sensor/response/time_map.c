/* Time as the integral of a rate that goes with the light. */
#include "td_time_map.h"
#include "td_extremes.h"
#include "signal/td_root.h"

#include <math.h>

static const double one_by[TD_TIME_MAP_TERMS] = {0,       1,       1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5,
                                                 1.0 / 6, 1.0 / 7, 1.0 / 8, 1.0 / 9, 1.0 / 10};

/* Taylor series of e^L for the cubic L = l0 + l1 x + l2 x^2 + l3 x^3 about x = 0: E' = L' E. */
static void exponential(const td_model *L, double E[TD_TIME_MAP_TERMS]) {
    const double *b = L->control;
    double d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2];
    double l[4] = {0.125 * (b[0] + 3 * b[1] + 3 * b[2] + b[3]), 0.375 * (d0 + 2 * d1 + d2), 0.375 * (d2 - d0),
                   0.125 * (d2 - 2 * d1 + d0)};
    const double slope[3] = {l[1], 2 * l[2], 3 * l[3]};
    E[0] = exp(l[0]);
    E[1] = slope[0] * E[0];
    E[2] = (slope[0] * E[1] + slope[1] * E[0]) * one_by[2];
    for (int n = 3; n < TD_TIME_MAP_TERMS; n++)
        E[n] = (slope[0] * E[n - 1] + slope[1] * E[n - 2] + slope[2] * E[n - 3]) * one_by[n];
}

double td_time_map_make(td_time_map *map, const td_model *L, double log_eps, double light, double dark, double *error) {
    double rate[TD_TIME_MAP_TERMS], total = 0, start = 0, least;
    exponential(L, rate); /* the last one is the error */
    for (int k = 0; k < TD_TIME_MAP_TERMS; k++) rate[k] *= light;
    rate[0] += dark - light * log_eps;
    map->on = 1;
    for (int k = 0; k < TD_TIME_MAP_TERMS - 1; k++) {
        double integral = rate[k] * one_by[k + 1];
        map->term[k + 1] = integral;
        start += k % 2 ? integral : -integral; /* x^(k + 1) at -1 */
        if (k % 2 == 0) total += 2 * integral;
    }
    map->term[0] = -start;
    const double by = 1 / total;
    for (int k = 0; k < TD_TIME_MAP_TERMS; k++) map->term[k] *= by;
    least = light * (exp(td_lesser(L->control[0], L->control[3])) - log_eps) + dark;
    *error = 2 * fabs(rate[TD_TIME_MAP_TERMS - 1]) / least;
    return 0.5 * total;
}

static double within(double v) { return td_lesser(td_greater(v, 0), 1); }

double td_time_map_place(const td_time_map *map, double u) {
    if (!map->on || u <= 0 || u >= 1) return within(u);
    double x = 2 * u - 1, sum = 0;
    for (int k = TD_TIME_MAP_TERMS - 1; k >= 0; k--) sum = sum * x + map->term[k];
    return within(sum);
}

/* Side by side, because one sum waits for its products. */
void td_time_map_quarters(const td_time_map *map, double v[3]) {
    double sum[3] = {0, 0, 0};
    for (int k = TD_TIME_MAP_TERMS - 1; k >= 0; k--)
        for (int i = 0; i < 3; i++) sum[i] = sum[i] * (0.5 * i - 0.5) + map->term[k];
    for (int i = 0; i < 3; i++) v[i] = map->on ? within(sum[i]) : 0.25 * (i + 1);
}

double td_time_map_speed(const td_time_map *map, double u) {
    if (!map->on) return 1;
    double x = 2 * u - 1, sum = 0;
    for (int k = TD_TIME_MAP_TERMS - 1; k >= 1; k--) sum = sum * x + k * map->term[k];
    return 2 * sum;
}

/* The place that a time is to be found for. */
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
    const double *b = model->control;
    if (!map->on) return *model;
    double begin = 0, end = 0; /* half the speeds there, summed as td_time_map_speed does */
    for (int k = TD_TIME_MAP_TERMS - 1; k >= 1; k--) {
        begin = k * map->term[k] - begin;
        end = end + k * map->term[k];
    }
    double first = (b[1] - b[0]) / (2 * begin), last = (b[3] - b[2]) / (2 * end);
    return (td_model){{b[0], b[0] + first, b[3] - last, b[3]}};
}
