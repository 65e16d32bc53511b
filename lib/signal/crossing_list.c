/* Places of many crossings at once, in loops that vectorise: Newton's steps are the same number for all, and what they have
 * come to is then proven, place by place, to have the nanosecond that a search to the last bit would give. What can't be proven
 * so, near ends of nanoseconds and of pieces and where the model turns sharply, is searched for as it always was. */
#include "td_crossing_list.h"

#include "td_wide.h"

static inline td_model model_of(const td_crossing_list *list, int k) {
    return (td_model){{list->control[0][k], list->control[1][k], list->control[2][k], list->control[3][k]}};
}

/* floor, in additions that vectorise with any vectors; of numbers in [0, 2^51). */
static inline double whole(double x) {
    const double nearest = (x + 0x1p52) - 0x1p52;
    return nearest - (nearest > x ? 1.0 : 0.0);
}

/* A Newton step from *place; to the middle of what is left between *low and *high where it would leave that. */
static inline void go_on(const td_level *at, double sign, double *place, double *low, double *high) {
    const double s = *place, excess = td_level_excess(at, s), next = s - excess / td_level_slope(at, s);
    *high = sign * excess > 0.0 ? s : *high;
    *low = sign * excess > 0.0 ? *low : s;
    double best = 0.5 * (*low + *high);
    best = next <= *high ? next : best;
    *place = next >= *low ? best : 0.5 * (*low + *high);
}

/* solve_near of crossing.c, but that what lies between two crossings of a piece is no bound: levels of one direction are in
 * order, and the nearer end only begins the search. Six steps, written out, or gcc 12 wouldn't vectorise: with four, a quarter
 * of the places on sharply bent pieces aren't near enough and are searched for, at ten times the price; with six, one in
 * sixty. */
TD_WIDE static void solve_all(td_crossing_list *restrict list, const td_step *step) {
    const double side = TD_NEAR_ENOUGH_NS / step->length_ns, length = step->length_ns, begin = step->start_fraction;
    const int count = list->count;
    for (int k = 0; k < count; k++) {
        const td_model model = model_of(list, k);
        const td_level at = {&model, list->reference[k], list->rise[k]};
        const double sign = at.rise > 0.0 ? 1.0 : -1.0, low = list->low[k], high = list->high[k], from = list->value_low[k];
        double place = low + (high - low) * ((at.reference - from + at.rise) / (list->value_high[k] - from));
        double left = low, right = high;
        go_on(&at, sign, &place, &left, &right);
        go_on(&at, sign, &place, &left, &right);
        go_on(&at, sign, &place, &left, &right);
        go_on(&at, sign, &place, &left, &right);
        go_on(&at, sign, &place, &left, &right);
        go_on(&at, sign, &place, &left, &right);
        const double before = place - side, after = place + side, least = td_level_rounding(&at);
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

/* Each search begins where the last one ended, whether anyone asked for that place or not. */
int64_t td_crossing_list_search(td_crossing_list *list, const td_step *step, int k) {
    const int first = list->first[k], from = list->searched >= first ? list->searched + 1 : first;
    double s = from > first ? list->at : list->low[k];
    for (int i = from; i <= k; i++) {
        const td_model model = model_of(list, i);
        const td_level at = {&model, list->reference[i], list->rise[i]};
        s = td_level_solve(&at, s, list->high[i], list->value_high[i]);
    }
    list->searched = k;
    list->at = s;
    return td_step_time(step, s);
}
