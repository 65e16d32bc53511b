/* Internal to lib/run: which points of a run's surfaces are followed. */
#ifndef TD_TRACK_CHOICE_H
#define TD_TRACK_CHOICE_H

#include "tides/session.h"
#include "tides/truth.h"

/* A choice of up to `count` points at `time`, the `number`-th of the run (TIDES_TRACKS_*): xy (count x 2) [px], points, and how
 * many there are. By the run's seed and `number` alone. */
tides_status td_tracks_choose(tides_renderer *renderer, const tides_session_facts *facts, double time, uint32_t number,
                              size_t count, double *xy, tides_material_point *points, size_t *chosen, tides_error *error);

/* At how many times, evenly from the run's start to its stop, such choices are made. */
uint32_t td_tracks_choices(const tides_session_facts *facts);

#endif
