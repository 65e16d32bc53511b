/* Growth of cost (benchmark "scaling"). An axis is a property of a world that grows, such as its pixels. A point is one
 * value of it, at which frames or a run are measured. */
#ifndef CLI_BENCH_SCALING_H
#define CLI_BENCH_SCALING_H

#include "bench.h"

enum { POINTS_MAX = 8, AXES_MAX = 16 };

/* The world of a point. The stepping is for runs alone. */
typedef struct scaling_world {
    bench_scene scene;
    tides_stepping stepping;
    int32_t threads; /* of the device; 0: all that it has */
    int32_t quick;
    int32_t kernels; /* 1: the device's cache of kernels is empty */
} scaling_world;

typedef enum scaling_work { WORK_FRAMES, WORK_RUN, WORK_START /* to the first event */ } scaling_work;

typedef struct scaling_axis {
    const char *name, *unit, *sentence; /* "pixels", "px"; the sentence says what stays and what grows */
    scaling_work work;
    tides_status (*make)(double x, scaling_world *world, tides_error *error);
    double points[POINTS_MAX]; /* ascending, 0 behind the last; the first may be 0 too */
    double most;               /* greatest allowed exponent of the growth; 0: it is printed, but not judged */
    int32_t by_events;         /* 1: x becomes the number of events of the run */
    int32_t in_quick;          /* number of points that are measured with --quick */
} scaling_axis;

/* bench_scaling_axes.c: all axes, `*count` of them. */
const scaling_axis *scaling_axes(size_t *count);

/* The result of a point. It goes through a pipe, so it must have no pointers. */
typedef struct scaling_result {
    double x;
    double time_s, processor_s; /* of a frame, or of the run without kernel builds: the least of some */
    double host_s;              /* part of processor_s that the calling thread used; more threads don't divide it */
    int32_t runs, failed;
    tides_stats stats; /* of the last run; of frames, only the last one's projected Gaussians and pairs */
    uint64_t peak_bytes;
    char said[256]; /* the reason for a failure */
} scaling_result;

typedef struct scaling_line {
    const scaling_axis *axis;
    scaling_result points[POINTS_MAX];
    int32_t count;
    double exponent, exponent_end; /* fitted to all points, and to the last three; NaN: too few */
} scaling_line;

/* bench_scaling_run.c: measures a point in this process, on the device that `b` names. */
void scaling_measure(bench *b, const scaling_axis *axis, double x, scaling_result *result);

/* Names of the axes, NULL-terminated. */
const char *const *scaling_names(void);

/* bench_scaling_start.c: from opening the device to the first event. */
tides_status scaling_start(bench *b, const scaling_world *world, scaling_result *result, tides_error *error);

/* bench_scaling_figure.c: scaling.png. */
tides_status scaling_figure(const bench *b, const scaling_line *lines, size_t count, tides_error *error);

/* The benchmark. It opens devices in processes of its own. `axes`: names of the axes to measure, or none for all. */
tides_status bench_scaling(bench *b, const cli_list *axes, tides_error *error);

#endif
