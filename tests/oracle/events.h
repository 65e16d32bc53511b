/* The oracle's events: every crossing of every pixel of a scene, to a tenth of a nanosecond.
 *
 * An ideal comparator: ON where S - reference reaches threshold_on, OFF where it falls to -threshold_off, S = L + leak; the
 * reference moves by the threshold. L is sampled on a grid of times; between two of them it is looked at again wherever a
 * level is within what the curve may do unseen: bend (second differences), swap splats in depth, meet a kink. */
#ifndef TESTS_ORACLE_EVENTS_H
#define TESTS_ORACLE_EVENTS_H

#include "tests/oracle/scene.h"

typedef struct oracle_event {
    double time; /* [s] */
    int pixel;   /* y width + x */
    int polarity;
} oracle_event;

/* Pixel by pixel, each one's in the order of time. Owned: oracle_events_free. */
typedef struct oracle_events {
    oracle_event *event;
    size_t count, capacity;
    size_t *first;         /* (pixels + 1) */
    size_t samples, looks; /* what it took: pixels on the grid, and single ones between */
} oracle_events;

/* `finer`: so many times as many samples, 1 for the usual. */
oracle_events oracle_find_events(const oracle_scene *scene, int finer);
void oracle_events_free(oracle_events *events);

#endif
