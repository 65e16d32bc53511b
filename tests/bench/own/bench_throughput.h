/* Rows of `own_bench throughput`: stages of frames, events into files, and parts of runs. */
#ifndef CLI_BENCH_THROUGHPUT_H
#define CLI_BENCH_THROUGHPUT_H

#include "bench_frames.h"

/* One stage of a frame, of a run, or of the writing of events. `maker` names the measured code. Times are those of one frame,
 * or of the whole run. NaN stands where a number doesn't exist. */
typedef struct bench_stage {
    char scene[64];
    int32_t width, height;
    double gaussians;
    const char *maker; /* "inria", "limit L", "run"; or a sink: "HDF5" */
    const char *stage; /* "composite" */
    int32_t of_frame;  /* 1: a stage of a frame, or the whole frame */
    int32_t runs;
    double time_s, low_s, high_s; /* median and quartiles */
    double share;                 /* of the whole */
    double calls, items;
    const char *unit; /* of items */
    double pairs, bytes;
    double limit_s;                                     /* time of the limit (bench_limit.h) in this stage */
    double over_limit, over_limit_low, over_limit_high; /* time over the limit's: median and quartiles */
    double over_inria, over_without_rates;              /* time over inria's, and over the maker's own without L_dot */
} bench_stage;

typedef struct bench_stages {
    bench_stage *rows;
    size_t count;
    cJSON *header, *targets;
} bench_stages;

/* Appends a row of a scene, with NaN for all numbers. Returns NULL if there is no memory. */
bench_stage *bench_stages_add(bench_stages *stages, const bench_scene *scene, const char *maker, const char *stage,
                              tides_error *error);

/* bench_frame_rows.c: the rows and the targets of a scene's frames. */
tides_status bench_frame_rows(bench_stages *stages, const bench_scene *scene, const frame_times *times, tides_error *error);

/* bench_run_rows.c: the rows of a run that finds exact events, stage by stage. */
tides_status bench_run_rows(bench *b, bench_stages *stages, const bench_scene *scene, tides_error *error);
/* bench_sink_rows.c: the rows and the targets of events that go to no sink, and to files. */
tides_status bench_sink_rows(bench *b, bench_stages *stages, tides_error *error);

/* bench_throughput_figure.c: throughput.png. */
tides_status bench_figure_stages(const bench *b, const bench_stages *stages, tides_error *error);

tides_status bench_throughput(bench *b, const cli_list *scenes, tides_error *error);

#endif
