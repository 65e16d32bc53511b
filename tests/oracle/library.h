/* Runs an oracle's scene in the library, through its public interface, and keeps the events in memory. Settings are
 * defaults, except those that the scene has. */
#ifndef TESTS_ORACLE_LIBRARY_H
#define TESTS_ORACLE_LIBRARY_H

#include "tests/oracle/scene.h"
#include "tides/simulate.h"

typedef struct library_run {
    tides_event *event; /* in order of time; owned: library_run_free */
    size_t count, capacity;
    tides_stats stats;
} library_run;

/* Returns 1, or 0 with the library's error in `said`. stepping: step control of the run. */
int library_simulate(const oracle_scene *scene, const char *device, const tides_stepping *stepping, library_run *run,
                     tides_error *said);
void library_run_free(library_run *run);

/* The largest difference in L between the oracle and the library's double reference, with all splats blended, over all
 * pixels at `times` times; and its time [s] and pixel. */
typedef struct library_difference {
    double most, time;
    int x, y;
} library_difference;
int library_compare_images(const oracle_scene *scene, int times, library_difference *difference, tides_error *said);

#endif
