/* Internal: the time of a substep in which a first-order filter's rate is constant. S' = r(t) (L - S) is dS/dv = rate (L - S)
 * where v is the integral of r over its total. L as a function of v is no longer a cubic. */
#ifndef TD_TIME_MAP_H
#define TD_TIME_MAP_H

#include "td_response.h"

enum { TD_TIME_MAP_TERMS = 8 };

/* v = sum of term[k] x^k from 0 to 1, rising, where x = 2 u - 1 and u in [0, 1] is the substep's time. */
typedef struct td_time_map {
    int on; /* 0: v = u */
    double term[TD_TIME_MAP_TERMS];
} td_time_map;

double td_time_map_place(const td_time_map *map, double u); /* v at u */
double td_time_map_time(const td_time_map *map, double v);  /* u at v */
double td_time_map_speed(const td_time_map *map, double u); /* dv/du */

/* The cubic of v with the values and slopes at both ends of a cubic of u. */
td_model td_time_map_model(const td_time_map *map, const td_model *model);

#endif
