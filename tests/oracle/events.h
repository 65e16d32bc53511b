/* The oracle's events: every crossing of every pixel of a scene, to a tenth of a nanosecond.
 *
 * An ideal comparator: ON where S - reference reaches threshold_on, OFF where it falls to -threshold_off; S = L + leak. Each
 * event moves the reference by its threshold. L is sampled on a grid of times. Between two samples it is sampled again
 * wherever a level is within the change that they may hide: by the curve's bend (second differences), splats that swap in
 * depth, colours that meet their clamp. */
#ifndef TESTS_ORACLE_EVENTS_H
#define TESTS_ORACLE_EVENTS_H

#include "tests/oracle/scene.h"

typedef struct oracle_event {
    double time; /* [s] */
    int pixel;   /* y width + x */
    int polarity;
} oracle_event;

/* Events pixel by pixel, each pixel's in order of time. To be freed by oracle_events_free. */
typedef struct oracle_events {
    oracle_event *event;
    size_t count, capacity;
    size_t *first;         /* (pixels + 1) index of each pixel's first event */
    size_t samples, looks; /* effort: pixels rendered on the grid, and single ones between */
} oracle_events;

/* `finer`: factor on the number of samples; 1: those of the scene's `spacing`. */
oracle_events oracle_find_events(const oracle_scene *scene, int finer);
void oracle_events_free(oracle_events *events);

#endif
