/* Slopes of S without derivatives: what a renderer that knows none could do. */
#include "td_simulator.h"

void td_difference_slopes(tides_simulator *s, double h) {
    for (size_t i = 0; i < s->first_pixel[s->tiles]; i++) {
        double slope = (s->next.plane[TD_KEPT_S][i] - s->now.plane[TD_KEPT_S][i]) / h;
        s->next.plane[TD_KEPT_S_DOT][i] = slope;
        if (s->step == 0) s->now.plane[TD_KEPT_S_DOT][i] = slope;
    }
}
