/* Slopes of S without derivatives: what a renderer that knows none could do. */
#include "td_simulator.h"

void td_difference_slopes(tides_simulator *s, double h) {
    for (size_t i = 0; i < s->first_pixel[s->tiles]; i++) {
        double slope = (s->next.S[i] - s->now.S[i]) / h;
        s->next.S_dot[i] = slope;
        if (s->step == 0) s->now.S_dot[i] = slope;
    }
}
