/* Batches in turns. One is being filled, the one before is with the device, and for the one before that the values are back:
 * its pixels are run, and may request more points.
 *
 * The choice of points for a batch affects only the time. Pixels don't depend on one another, and all points that a pixel
 * requests at once are in one batch. */
#include "solver/td_simulator.h"
#include "td_wide.h"

/* Steps of a macro step don't fit in caches, so they are prefetched so many pixels ahead. */
enum { AHEAD = 6 };

/* Fewest points and pixels that are worth a thread of their own. */
enum { FEWEST_POINTS = 512, FEWEST_PIXELS = 64 };

/* -- what comes back ------------------------------------------------------------------------------------------------------- */

static void prefetch(const td_looked *looked) {
    TD_PREFETCH(looked);
    TD_PREFETCH((const char *)(looked + 1) - 1);
}

/* Puts a value that was looked up at an end of a step in the sample's place. If it is the macro step's end, the next macro step
 * begins with this value. */
static void take_end(const tides_simulator *s, const td_asked *asked, const td_point_value *value) {
    td_looked *looked = &s->done.solve.looked[asked->looked];
    const td_refine_step *step = &s->refine.step[looked->step];
    if (asked->s > 0) {
        looked->ends.S1 = value->L, looked->ends.S1_dot = value->L_dot;
        looked->known_ends |= TD_KNOWS_END;
    } else {
        looked->ends.S0 = value->L, looked->ends.S0_dot = value->L_dot;
        looked->known_ends |= TD_KNOWS_START;
    }
    if (!(asked->s > 0) || step->next >= 0) return;
    double *sample = td_sample_at(&s->refine.samples, step->end) + asked->local;
    sample[TD_PLANE_S * s->refine.samples.pixels] = value->L;
    sample[TD_PLANE_S_DOT * s->refine.samples.pixels] = value->L_dot;
}

/* The first point, from number k on, that isn't of the same pixel and step as the point before it. All points of a pixel in a
 * step make one list of nodes, and are handled by one thread. */
static int whole(const td_solve_batch *back, int k) {
    while (k > 0 && (size_t)k < back->points && back->asked[k].looked == back->asked[k - 1].looked) k++;
    return k;
}

/* Turns the values of some of the points into nodes. */
static tides_status take_some(const tides_simulator *s, td_portion *portion, int first, int end, const void *user,
                              tides_error *error) {
    const td_solve_batch *back = user;
    const td_solve *solve = &s->solve;
    td_looked *looked = s->done.solve.looked;
    const int32_t number = (int32_t)(solve->found_count - back->points);
    (void)portion, (void)error;
    for (int k = whole(back, first), stop = whole(back, end); k < stop; k++) {
        if (k + AHEAD < stop) prefetch(&looked[back->asked[k + AHEAD].looked]);
        const td_asked *asked = &back->asked[k];
        if (asked->s > 0 && asked->s < 1)
            td_solve_insert(solve, &looked[asked->looked], number + k, asked->s, &back->value[k]);
        else
            take_end(s, asked, &back->value[k]);
    }
    return TIDES_OK;
}

/* Turns all values into nodes. Node k of the new ones is point k's, so that threads needn't agree on places. */
static tides_status take(tides_simulator *s, const td_solve_batch *back, tides_error *error) {
    td_solve *solve = &s->solve;
    const size_t count = solve->found_count + back->points;
    tides_status status = td_reserve((void **)&solve->found, &solve->found_capacity, count, sizeof *solve->found, error);
    if (status != TIDES_OK) return status;
    solve->found_count = count;
    return td_share_out(s, (int)back->points, FEWEST_POINTS, take_some, back, error);
}

/* The pixels to run. */
typedef struct running {
    td_solving *pixel;
    int waited;
} running;

static tides_status run_some(const tides_simulator *s, td_portion *portion, int first, int end, const void *user,
                             tides_error *error) {
    const running *all = user;
    td_looked *looked = s->done.solve.looked;
    td_solve_batch *asks = portion->solve.asks;
    tides_status status = td_reserve((void **)&asks->pixel, &asks->pixel_capacity, asks->pixels + (size_t)(end - first),
                                     sizeof *asks->pixel, error);
    for (int k = first; k < end && status == TIDES_OK; k++) {
        td_solving *pixel = &all->pixel[k];
        if (k + AHEAD < end) prefetch(&looked[all->pixel[k + AHEAD].next]);
        if (pixel->waits == all->waited) status = td_solve_run(s, portion, looked, pixel, error);
        pixel->waits = 0;
        if (pixel->next < pixel->end) asks->pixel[asks->pixels++] = *pixel;
    }
    return status;
}

/* Runs pixels of a batch: with `waited` those that waited for their references, else the others. All that aren't settled then
 * move to the batch that is being filled, with the points that they request. The two batches may be the same. */
static tides_status run_pixels(tides_simulator *s, td_solve_batch *from, int waited, tides_error *error) {
    td_solve_batch *filling = td_solve_filling(&s->solve);
    const size_t count = from->pixels;
    from->pixels = 0;
    tides_status status =
        td_reserve((void **)&filling->pixel, &filling->pixel_capacity, filling->pixels + count, sizeof *filling->pixel, error);
    const running all = {from->pixel, waited};
    return status == TIDES_OK ? td_share_out(s, (int)count, FEWEST_PIXELS, run_some, &all, error) : status;
}

/* -- taking turns ---------------------------------------------------------------------------------------------------------- */

tides_status td_solve_turn(tides_simulator *s, tides_error *error) {
    td_solve *solve = &s->solve;
    td_solve_batch *full = td_solve_filling(solve),
                   *back = &solve->batch[(solve->filling + TD_SOLVE_BATCHES - 1) % TD_SOLVE_BATCHES];
    tides_status status = td_solve_receive(s, error);
    if (status == TIDES_OK && s->done.solve.refer.count > 0) { /* no batch is with the device now */
        status = td_solve_refer(s, error);
        if (status == TIDES_OK) status = run_pixels(s, full, 1, error);
    }
    if (status == TIDES_OK) status = td_solve_send(s, full, error);
    solve->filling = (solve->filling + 1) % TD_SOLVE_BATCHES;
    solve->enough_now = 2 * solve->enough_now < solve->enough ? 2 * solve->enough_now : solve->enough;
    if (status == TIDES_OK) status = take(s, back, error);
    back->points = 0;
    return status == TIDES_OK ? run_pixels(s, back, 0, error) : status;
}
