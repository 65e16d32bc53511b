/* The times of a scene's frames at one size, stage by stage. The image rules and the limit render them in turns. */
#ifndef CLI_BENCH_FRAMES_H
#define CLI_BENCH_FRAMES_H

#include "bench_limit.h"

enum { FRAME_ROUNDS = 9, FRAME_ROUNDS_QUICK = 3 };

/* The stages of a frame, and the whole frame. The limit has no motion, no transfer and no other work. It finds its lists after
 * the projection; the renderer finds them in the sweep before it. */
typedef enum frame_stage {
    STAGE_MOTION,
    STAGE_SWEEP,
    STAGE_PROJECT,
    STAGE_SORT,
    STAGE_COMPOSITE,
    STAGE_TRANSFER,
    STAGE_OTHER,
    STAGE_FRAME,
    STAGE_PROCESSOR, /* processor time of all threads for the whole frame */
    STAGES
} frame_stage;
const char *frame_stage_name(frame_stage stage);

/* Makers of frames: the limit and the rules. Each stands here with L_dot; the next number is the same maker without it. */
typedef enum frame_maker { LIMIT, INRIA = 2, GSPLAT = 4, SMOOTH = 6, MAKERS = 8 } frame_maker;
const char *frame_maker_name(int32_t maker); /* "inria", "inria Y" */

typedef struct frame_times {
    double s[MAKERS][STAGES][FRAME_ROUNDS]; /* of a frame [s] */
    int32_t rounds, limited;                /* 1: there is a limit */
    int64_t frames;                         /* of each maker */
    tides_render_stats done[MAKERS];        /* of all its frames */
    limit_counts counted[2];                /* of the last frame */
    /* Difference between inria and the limit in the last frame: mean |difference| of L, and of L_dot over the mean of L_dot. */
    double L_apart, L_dot_apart;
    char why[256]; /* the reason why there is no limit */
} frame_times;

tides_status frames_measure(bench *b, const bench_scene *scene, frame_times *times, tides_error *error);

#endif
