/* Internal: the extrema of many local models, found together, equal to those of td_model_extrema. */
#ifndef TD_TURNS_H
#define TD_TURNS_H

#include "td_model.h"

enum { TD_TURNS_ROOM = 64 };

/* `count` finite models. Each is monotone between 0, its two places and 1; places that it doesn't need are 1. */
typedef struct td_turns {
    int count;
    double control[4][TD_TURNS_ROOM];
    double place[2][TD_TURNS_ROOM], value[2][TD_TURNS_ROOM]; /* value: S there, within the range of the control values */
} td_turns;

void td_turns_find(td_turns *turns);

#endif
