/* Internal: the response of a filter whose rates go with the light, piece by piece: within a piece the rates stand still, in a
 * time of the piece's own or because what they would have changed is put into the input instead (pieces.c). */
#ifndef TD_PIECES_H
#define TD_PIECES_H

#include "td_frontend.h"
#include "td_time_map.h"

/* A walk along the pieces of one step. The same step always has the same pieces. */
typedef struct td_pieces {
    const td_drive *drive;
    double state[TD_FRONTEND_STATE]; /* at `to` */
    double from, to;                 /* the piece, in s of the step */
    double length;                   /* to try for the next one */
    int tried;
    td_warp warp; /* from the piece's time to the path's */
    td_path path; /* the piece's own, over [0, 1] */
} td_pieces;

/* From a stretch of the drive on, to the step's end. */
void td_pieces_begin(td_pieces *pieces, const td_drive *drive, int stretch);

/* The next piece; 0 where the last one ended the step. */
int td_pieces_next(td_pieces *pieces);

/* A stretch from here on, without bounds yet. */
void td_pieces_mark(const td_pieces *pieces, td_stretch *stretch);

/* From the step's s to the piece's path and back; d path / ds. */
double td_pieces_place(const td_pieces *pieces, double s);
double td_pieces_time(const td_pieces *pieces, double v);
double td_pieces_speed(const td_pieces *pieces, double s);

/* The piece's path with a cubic of the step's s added. */
void td_pieces_with(const td_pieces *pieces, const td_model *cubic, td_path *path);

#endif
