/* Internal: where many local models turn, found together: what td_crossing_begin finds of one. */
#ifndef TD_TURNS_H
#define TD_TURNS_H

#include "td_model.h"

enum { TD_TURNS_ROOM = 64 };

/* `count` finite models; each is monotone between 0, both places and 1, of which those that it doesn't need are 1. */
typedef struct td_turns {
    int count;
    double control[4][TD_TURNS_ROOM];
    double place[2][TD_TURNS_ROOM], value[2][TD_TURNS_ROOM]; /* of S there, within the range of the control values */
} td_turns;

void td_turns_find(td_turns *turns);

#endif
