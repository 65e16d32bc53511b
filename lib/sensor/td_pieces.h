/* Internal: the response of a filter whose rates go with the light, piece by piece: within a piece the rates stand still and
 * what they would have changed is put into the input instead (pieces.c). */
#ifndef TD_PIECES_H
#define TD_PIECES_H

#include "td_frontend.h"

/* A walk along the pieces of one step. The same step always has the same pieces. */
typedef struct td_pieces {
    const td_drive *drive;
    double state[TD_FRONTEND_STATE]; /* at `to` */
    double from, to;                 /* the piece, in s of the step */
    double length;                   /* to try for the next one */
    int tried;
    td_path path; /* the piece's own, over [0, 1] */
} td_pieces;

void td_pieces_begin(td_pieces *pieces, const td_drive *drive);

/* The next piece; 0 where the last one ended the step. */
int td_pieces_next(td_pieces *pieces);

#endif
