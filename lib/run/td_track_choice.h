/* Internal to lib/run: the choice of points to follow on a run's surfaces. */
#ifndef TD_TRACK_CHOICE_H
#define TD_TRACK_CHOICE_H

#include "tides/session.h"
#include "tides/truth.h"

/* Room for a choice of points, and the points. */
typedef struct td_track_choice {
    size_t most, count;           /* room, and how many there are */
    double *xy;                   /* (most x 2) [px] */
    tides_material_point *points; /* (most) */
} td_track_choice;

/* Adds up to `most` points at `time` to an empty choice, the `number`-th of the run (TIDES_TRACKS_*). It depends on the run's
 * seed and `number` only. */
tides_status td_tracks_choose(tides_renderer *renderer, const tides_session_facts *facts, double time, uint32_t number,
                              td_track_choice *choice, tides_error *error);

/* Number of such choices, at times evenly spaced from the run's start to its stop. */
uint32_t td_tracks_choices(const tides_session_facts *facts);

#endif
