/* Internal: points of the image that are looked up in batches, while the host goes on with the batch before; and references of
 * pixels, which are such points at the run's start. */
#ifndef TD_LOOK_UP_H
#define TD_LOOK_UP_H

#include "render/td_render.h"
#include "tides/simulate.h"

struct td_solve_portion;

/* A pixel that may do something, and how far it is settled. */
typedef struct td_solving {
    int32_t unit, local;
    int32_t next, end; /* its steps that aren't settled: td_looked, neighbours */
    int32_t waits;     /* for its reference */
} td_solving;

/* The asker of a point (td_looked; the unit's pixel), and the point's place in its step: 0 and 1 are the ends. */
typedef struct td_asked {
    int32_t looked, local;
    double s;
} td_asked;

/* Points that are looked up together. */
typedef struct td_solve_batch {
    td_solving *pixel; /* the pixels that requested the points, and aren't settled */
    size_t pixels, pixel_capacity;
    td_point *point;
    size_t points, point_capacity;
    td_asked *asked; /* (points) */
    size_t asked_capacity;
    td_point_value *value; /* (points) set when they are back */
    size_t value_capacity;
} td_solve_batch;
enum { TD_SOLVE_BATCHES = 3 };

/* Pixels whose references are to be looked up. */
typedef struct td_solve_refer_list {
    size_t *wanted;       /* (count) */
    td_point *start;      /* their places, at the run's start */
    td_point_value *rest; /* the values found there */
    size_t count, wanted_capacity, start_capacity, rest_capacity;
} td_solve_refer_list;

/* Requests a point for a pixel of a unit; `asked` is returned with the value. */
TIDES_MUST_CHECK tides_status td_solve_ask(td_solve_batch *batch, const td_tile *tile, int32_t local, double time,
                                           const td_asked *asked, tides_error *error);

/* Adds the time since `begun` [s] to that of look-ups. */
void td_solve_note_time(tides_simulator *s, double begun);

/* td_solve_send gives a batch to the renderer, and td_solve_receive waits for its values. td_solve_look_up does both for the
 * batch that is being filled. */
TIDES_MUST_CHECK tides_status td_solve_send(tides_simulator *s, td_solve_batch *batch, tides_error *error);
TIDES_MUST_CHECK tides_status td_solve_receive(tides_simulator *s, tides_error *error);
TIDES_MUST_CHECK tides_status td_solve_look_up(tides_simulator *s, tides_error *error);

/* td_solve_turn sends the filled batch to the device, and runs the pixels of the batch that is back, which may request more.
 * td_solve_has_enough: a full batch is there. td_solve_is_busy: points are requested or under way. td_solve_clear_batches drops
 * all. */
TIDES_MUST_CHECK tides_status td_solve_turn(tides_simulator *s, tides_error *error);
int td_solve_has_enough(const tides_simulator *s);
int td_solve_is_busy(const tides_simulator *s);
void td_solve_clear_batches(tides_simulator *s);

/* td_solve_doubt: error bounds of a unit's references, 0 where they were looked up (TD_TILE_PIXELS). td_solve_ask_reference
 * requests a pixel's reference, and td_solve_refer looks up all that were requested. */
void td_solve_doubt(const tides_simulator *s, int t, double *doubt);
TIDES_MUST_CHECK tides_status td_solve_ask_reference(const tides_simulator *s, struct td_solve_portion *portion, int t,
                                                     int32_t local, tides_error *error);
TIDES_MUST_CHECK tides_status td_solve_refer(tides_simulator *s, tides_error *error);

#endif
