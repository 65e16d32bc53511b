/* Depth order that a tile's job leaves to the next of the same sweep, whose list is nearly in that order (kernels/sort.cl). */
#include "td_renderer.h"

/* States of a tile's hint in this sweep: its depth order, left by one job for the next. */
enum {
    HINT_WANTED, /* nothing yet: the next job leaves its order */
    HINT_ASKED,  /* a job at work leaves it */
    HINT_THERE,
    HINT_USED,
    HINT_UNFIT /* orders change within a sweep, or nothing asks for a second one */
};

/* Leaving an order costs more than it saves where it isn't found again (under a moving camera; frame by frame): tiles where
 * it wasn't are tried again only every so many sweeps, which makes a sixteenth of the cost. */
enum { SWEEPS_TO_RETRY = 16 };

void td_candidates_renew_hints(td_candidates *candidates) {
    int tiles = candidates->tiles_x * candidates->tiles_y, retry = candidates->serial % SWEEPS_TO_RETRY == 0;
    for (int t = 0; t < tiles; t++) {
        uint8_t *hint = &candidates->hint[t];
        int unfit = *hint == HINT_UNFIT || *hint == HINT_THERE;
        *hint = unfit && !retry ? HINT_UNFIT : HINT_WANTED;
    }
}

int td_candidates_hint_count(const td_candidates *candidates) {
    return 1 + candidates->first[candidates->tiles_x * candidates->tiles_y];
}

void td_candidates_give_hint(td_candidates *candidates, int tile, td_job *job) {
    uint8_t *hint = &candidates->hint[tile];
    int place = 1 + candidates->first[tile];
    if (candidates->instant) return;
    if (*hint == HINT_WANTED) {
        job->new_hint = place;
        *hint = HINT_ASKED;
    } else if (*hint == HINT_THERE || *hint == HINT_USED) {
        job->hint = place;
        *hint = HINT_USED;
    }
}

void td_candidates_take_hints(td_candidates *candidates, const td_job *jobs, int count, const uint8_t *in_order) {
    for (int i = 0; i < count; i++) {
        uint8_t *hint = &candidates->hint[jobs[i].y / TD_TILE * candidates->tiles_x + jobs[i].x / TD_TILE];
        if (jobs[i].new_hint)
            *hint = in_order ? HINT_THERE : HINT_WANTED;
        else if (jobs[i].hint && in_order && !in_order[jobs[i].out])
            *hint = HINT_UNFIT;
    }
}
