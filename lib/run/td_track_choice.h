/* Internal to lib/run: the choice of points to follow on a run's surfaces. */
#ifndef TD_TRACK_CHOICE_H
#define TD_TRACK_CHOICE_H

#include "tides/session.h"
#include "tides/truth.h"

/* Chooses up to `count` points at `time`, as the `number`-th choice of the run (TIDES_TRACKS_*): xy (count x 2) [px], points,
 * and their number. It depends on the run's seed and `number` only. */
tides_status td_tracks_choose(tides_renderer *renderer, const tides_session_facts *facts, double time, uint32_t number,
                              size_t count, double *xy, tides_material_point *points, size_t *chosen, tides_error *error);

/* Number of such choices, at times evenly spaced from the run's start to its stop. */
uint32_t td_tracks_choices(const tides_session_facts *facts);

#endif
