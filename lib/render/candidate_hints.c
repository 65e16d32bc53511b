/* Hints of depth order: a tile's job leaves its order to the tile's next job in the same sweep, whose list is nearly in that
 * order and so is sorted faster. */
#include "td_renderer.h"

/* State of a tile's hint in this sweep. */
enum {
    HINT_WANTED, /* none yet: the next job will leave its order */
    HINT_ASKED,  /* a job that is running will leave it */
    HINT_THERE,  /* the order is available */
    HINT_USED,   /* a job has taken it */
    HINT_UNFIT   /* useless: orders change within the sweep, or there is no second job */
};

/* Leaving an order costs more than it saves if the next list is in another order (under a moving camera, or frame by frame).
 * A tile where that happened is tried again only every 16 sweeps, which keeps a sixteenth of the cost. */
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
