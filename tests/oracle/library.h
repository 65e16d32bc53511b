/* The library's run of an oracle's scene: through its public interface, into memory, all settings the defaults but for what a
 * scene says. */
#ifndef TESTS_ORACLE_LIBRARY_H
#define TESTS_ORACLE_LIBRARY_H

#include "tests/oracle/scene.h"
#include "tides/simulate.h"

typedef struct library_run {
    tides_event *event; /* in order of time; owned: library_run_free */
    size_t count, capacity;
    tides_stats stats;
} library_run;

/* 1; 0 with a line in `said` where something fails. `stepping`: the defaults, or what is tried. */
int library_simulate(const oracle_scene *scene, const char *device, const tides_stepping *stepping, library_run *run,
                     tides_error *said);
void library_run_free(library_run *run);

/* The largest difference of the library's L, in double, with all splats blended, from the oracle's, over all pixels of `times`
 * times from a seed on; where it is. */
typedef struct library_difference {
    double most, time;
    int x, y;
} library_difference;
int library_compare_images(const oracle_scene *scene, int times, library_difference *difference, tides_error *said);

#endif
