/* Places of many crossings at once, in loops that vectorise: Newton's steps are the same number for all, and what they have
 * come to is then proven, place by place, to have the nanosecond that a search to the last bit would give. What can't be proven
 * so, near ends of nanoseconds and of pieces and where the model turns sharply, is searched for as it always was. */
#include "td_crossing_list.h"

#include "td_wide.h"

static inline td_model model_of(const td_crossing_list *list, int k) {
    return (td_model){{list->control[0][k], list->control[1][k], list->control[2][k], list->control[3][k]}};
}

static inline double newton(const td_level *at, double s) { return s - td_level_excess(at, s) / td_level_slope(at, s); }

/* floor, in additions that vectorise with any vectors; of numbers in [0, 2^51). */
static inline double whole(double x) {
    const double nearest = (x + 0x1p52) - 0x1p52;
    return nearest - (nearest > x ? 1.0 : 0.0);
}

/* solve_near of crossing.c, but that what lies between two crossings of a piece is no bound: levels of one direction are in
 * order, and the nearer end only begins the search. Four steps from the chord are enough where the piece is nearly straight, or
 * a nanosecond not much of it. */
TD_WIDE static void solve_all(td_crossing_list *restrict list, const td_step *step) {
    const double side = TD_NEAR_ENOUGH_NS / step->length_ns, length = step->length_ns, begin = step->start_fraction;
    const int count = list->count;
    for (int k = 0; k < count; k++) {
        const td_model model = model_of(list, k);
        const td_level at = {&model, list->reference[k], list->rise[k]};
        const double low = list->low[k], high = list->high[k], from = list->value_low[k];
        double place = low + (high - low) * ((at.reference - from + at.rise) / (list->value_high[k] - from));
        place = newton(&at, place);
        place = newton(&at, place);
        place = newton(&at, place);
        place = newton(&at, place);
        const double before = place - side, after = place + side, least = td_level_rounding(&at);
        const double sign = at.rise > 0.0 ? 1.0 : -1.0;
        const double short_of = sign * td_level_excess(&at, before), beyond = sign * td_level_excess(&at, after);
        double flag = before - side > low ? 1.0 : 0.0;
        flag = after + side < high ? flag : 0.0;
        flag = whole(begin + (before - side) * length) == whole(begin + (after + side) * length) ? flag : 0.0;
        flag = short_of < -least ? flag : 0.0;
        flag = beyond > least ? flag : 0.0;
        list->place[k] = place;
        list->known[k] = flag;
    }
}

/* Longer steps [ns] have times that `whole` can't floor. */
#define LONGEST_NS 0x1p50

void td_crossing_list_solve(td_crossing_list *list, const td_step *step) {
    if (step->length_ns < LONGEST_NS)
        solve_all(list, step);
    else
        for (int k = 0; k < list->count; k++) list->known[k] = 0;
}

int64_t td_crossing_list_search(const td_crossing_list *list, const td_step *step, int first, int k) {
    double s = list->low[k];
    for (int i = first; i <= k; i++) { /* each search begins where the last one ended */
        const td_model model = model_of(list, i);
        const td_level at = {&model, list->reference[i], list->rise[i]};
        s = td_level_solve(&at, s, list->high[i], list->value_high[i]);
    }
    return td_step_time(step, s);
}
