/* Internal to lib/render: what record paths do to the pixels that are looked up on them, as a law: nobody knows which splats a
 * pixel sees where its event is, but what all of them are off by, and for how long. */
#ifndef TD_PATH_LAW_H
#define TD_PATH_LAW_H

#include "td_render.h"

/* Splats that move, by what their paths are off by: from 2^-40 on, a quarter of an octave each. */
enum { TD_TALLY_PARTS = 4, TD_TALLY_BINS = 48 * TD_TALLY_PARTS };

typedef struct td_path_tally {
    double splats;
    double smooth[TD_TALLY_BINS]; /* how many, */
    double bent[TD_TALLY_BINS];   /* and times the share of the time in which they are bent */
} td_path_tally;

/* A splat whose path is off by `off` where it is bent, the share `bent` of the time, and by `smooth` else [log_luminance]. */
void td_path_tally_add(td_path_tally *tally, double smooth, double off, double bent);

td_path_law td_path_tally_law(const td_path_tally *tally);

#endif
