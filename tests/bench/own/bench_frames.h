/* Frames of one scene at one size, stage by stage, by each of the image rules and by the limit in turns. */
#ifndef CLI_BENCH_FRAMES_H
#define CLI_BENCH_FRAMES_H

#include "bench_limit.h"

enum { FRAME_ROUNDS = 9, FRAME_ROUNDS_QUICK = 3 };

/* Parts of a frame, and the whole. The limit has no motion, no transfer, and nothing else; its lists are found after the
 * projection, the renderer's by the sweep before it. */
typedef enum frame_stage {
    STAGE_MOTION,
    STAGE_SWEEP,
    STAGE_PROJECT,
    STAGE_SORT,
    STAGE_COMPOSITE,
    STAGE_TRANSFER,
    STAGE_OTHER,
    STAGE_FRAME,
    STAGE_PROCESSOR, /* of all threads, in the whole frame */
    STAGES
} frame_stage;
const char *frame_stage_name(frame_stage stage);

/* What makes frames: the limit and the rules, each with L_dot and without, which is at the next place. */
typedef enum frame_maker { LIMIT, INRIA = 2, GSPLAT = 4, SMOOTH = 6, MAKERS = 8 } frame_maker;
const char *frame_maker_name(int32_t maker); /* "inria", "inria Y" */

typedef struct frame_times {
    double s[MAKERS][STAGES][FRAME_ROUNDS]; /* of a frame [s] */
    int32_t rounds, limited;                /* 1: there is a limit */
    int64_t frames;                         /* of each maker */
    tides_render_stats done[MAKERS];        /* in all of them */
    limit_counts counted[2];                /* in the last one */
    double L_apart, L_dot_apart; /* inria from the limit in the last frame: mean |difference| of L, of L_dot over its mean */
    char why[256];               /* there is no limit */
} frame_times;

tides_status frames_measure(bench *b, const bench_scene *scene, frame_times *times, tides_error *error);

#endif
