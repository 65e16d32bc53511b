/* State of pixels that only some runs have: where it is, and what the file calls it. */
#include "td_checkpoint.h"

const char *const td_optional_real_name[TD_OPTIONAL_REALS] = {"held_until",     "last_event", "shot_on_due", "shot_off_due",
                                                              "hot_due",        "coverage",   "alpha_dot",   "contributors",
                                                              "filter_0",       "filter_1",   "filter_2",    "filter_3",
                                                              "surround_modes", "noise_line", "noise_value"};

double *td_optional_real(const tides_simulator *s, int which) {
    double *const all[TD_OPTIONAL_REALS] = {s->sensor.held_until,
                                            s->sensor.since,
                                            s->sensor.noise.due[TD_NOISE_SHOT_ON],
                                            s->sensor.noise.due[TD_NOISE_SHOT_OFF],
                                            s->sensor.noise.due[TD_NOISE_HOT],
                                            s->now.plane[TD_KEPT_ALPHA],
                                            s->now.plane[TD_KEPT_ALPHA_DOT],
                                            s->now.plane[TD_KEPT_CONTRIBUTORS],
                                            s->sensor.filter[0],
                                            s->sensor.filter[1],
                                            s->sensor.filter[2],
                                            s->sensor.filter[3],
                                            s->surround.modes,
                                            s->sensor.noise_segment,
                                            s->sensor.noise_value};
    return all[which];
}

const char *const td_optional_count_name[TD_OPTIONAL_COUNTS] = {"shot_on_drawn", "shot_off_drawn", "hot_drawn"};

uint32_t *td_optional_count(const tides_simulator *s, int which) {
    uint32_t *const all[TD_OPTIONAL_COUNTS] = {s->sensor.noise.drawn[TD_NOISE_SHOT_ON],
                                               s->sensor.noise.drawn[TD_NOISE_SHOT_OFF], s->sensor.noise.drawn[TD_NOISE_HOT]};
    return all[which];
}
