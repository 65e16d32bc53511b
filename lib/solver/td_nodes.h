/* Internal: the model of a pixel in a step where events are looked up: nodes at the places that were looked up, and how far
 * each piece between them is trusted. */
#ifndef TD_NODES_H
#define TD_NODES_H

#include "signal/td_pieces.h"
#include "signal/td_signals.h"
#include "td_refine.h"

struct td_solve;

/* Trust in a piece of a pixel's model. `error` is the model's error in the middle [log units]. Elsewhere it is 16 u^2 (1 - u)^2
 * of that for a smooth signal, and 4 u (1 - u) for one with a kink somewhere. `unseen` is a further error in the middle, by
 * bends that no look may have met, a kink above all. It decides where events may be, not how accurate the times of found ones
 * are. */
typedef struct td_trust {
    double error;
    int is_smooth;
    double unseen;
} td_trust;

/* A node, trust in the piece that begins there, and the pixel's next node in the step, or -1. */
typedef struct td_found {
    td_node node;
    td_trust trust;
    int32_t next;
} td_found;

/* A pixel in a step in which it may do something. All data that each round reads are side by side, because the samples of a
 * macro step don't fit in caches. */
typedef struct td_looked {
    td_ends ends;
    td_trust trust;       /* of the first piece */
    uint64_t state;       /* the pixel's state at the step's start, when something was looked up */
    int32_t step;         /* in the macro step */
    int32_t first;        /* first node, or -1 */
    int16_t nodes, looks; /* number of nodes, and of rounds of look-ups */
    int32_t known_ends;   /* TD_KNOWS_*: ends that were looked up */
} td_looked;
enum { TD_KNOWS_START = 1, TD_KNOWS_END = 2 };

/* Least distance of nodes, in steps: far below a nanosecond, and enough for slopes from differences. */
#define TD_SOLVE_APART 1e-8

/* The error that is possible in the middle of a step before anything is looked up. A kink may leave a little more than the
 * probe saw (1.16 of that in check_lost, harmonics 1110), so that half as much again is allowed for. It takes 1.3 % more
 * looks. */
static inline double td_solve_first_doubt(const td_trust *trust) { return 1.5 * trust->error; }

/* Trust in the models of pixels [first, first + count) of a unit, on a step of h seconds, before anything is looked up:
 * (count). */
void td_solve_first_trust(const tides_simulator *s, const td_refine_step *refined, double h, int32_t first, int32_t count,
                          td_trust *trust);

/* The model of a pixel in a step, and its errors. */
typedef struct td_trusted {
    td_pieces pieces; /* with the leak's ramp added */
    td_trust trust[TD_PIECES_MAX];
    double swapped[TD_PIECES_MAX]; /* what swaps of depth may hide within each piece [log units] */
    double start, end;             /* additional errors of the signal at the step's ends */
    double floor;                  /* error of any value that is looked up */
} td_trusted;

/* The model's error at u of piece k, without the floor. */
double td_trusted_error(const td_trusted *model, int k, double u);

/* The model's error at u of piece k that may decide whether a level is reached, without those of the step's ends. */
double td_trusted_doubt(const td_trusted *model, int k, double u);

/* The pixel's nodes, and the trust of each piece. Returns the number of nodes. */
int td_solve_nodes(const struct td_solve *solve, const td_looked *looked, td_node *nodes, td_trust *trust);

/* Makes the value at s a node, number `number` of solve->found. If s has a node already, nothing changes. */
void td_solve_insert(const struct td_solve *solve, td_looked *looked, int32_t number, double s, const td_point_value *value);

#endif
