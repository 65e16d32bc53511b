/* Test support: exact events, with which a simulated stream is compared. They come from frames alone: L and L_dot of the double
 * reference at finely spaced times, a cubic per pixel between neighbours, and a comparator of ten lines. Nothing of the solver
 * is used. Leaving out every second frame shows their accuracy. Errors fail the running cmocka test. */
#ifndef TESTS_SUPPORT_JUDGED_RUN_H
#define TESTS_SUPPORT_JUDGED_RUN_H

#include "tides/metrics.h"
#include "tides/simulate.h"

/* What is simulated, owned: judged_free. */
typedef struct judged {
    char name[96];
    tides_scene *scene;
    tides_trajectory *camera;
    tides_intrinsics intrinsics;
    tides_image_params image;
    tides_sensor sensor;     /* thresholds and leak; all else off */
    tides_stepping stepping; /* the defaults, but for what a case says */
    double start, stop;      /* [s] */
    int frames;              /* intervals of the exact stream's first attempt; even */
    void *user;              /* of callbacks; freed */
} judged;

/* An empty scene, the defaults but for steps whose model says when events are (model_steps.h), a camera at rest in the origin,
 * a focal length of 1.25 widths. */
judged judged_make(const char *name, int width, int height, double stop);
void judged_free(judged *j);
/* Steps with events looked up, as they are by default. */
void judged_look_up(judged *j);
/* In place of the one at rest. */
void judged_camera(judged *j, tides_trajectory *path);

typedef struct judged_stream {
    tides_event *events;
    size_t count, capacity;
} judged_stream;

/* The events of frames at every (2 every) interval in `fine` (`coarse`), in no order. */
void judged_exact(const judged *j, int frames, judged_stream *fine, judged_stream *coarse);
/* One run of the library on `device`, "reference", "reference-f32" or "cpu"; 0 where there's no such device. */
int judged_simulate(const judged *j, const char *device, judged_stream *stream, tides_stats *stats);

/* A run against the exact events. */
typedef struct judged_verdict {
    tides_match match;
    tides_match timing; /* of events that are the same ones. Where a touch is taken for a crossing, or the other way round, and
                           thresholds differ, the reference is another one from there on, and the times of that pixel's later
                           events with it: that is what events_uncertain tells, and no timing error */
    int wrong_pixels;   /* those with another number of events, which count up to the first that differs */
    tides_stats stats;
    tides_match halved; /* how the last halving of the frames' spacing moved the exact events */
    int frames;
} judged_verdict;

/* Events that are further apart aren't taken for each other. */
#define JUDGED_LIMIT_S 1e-3

/* How good exact events must be: the last halving moved p50, p95 and p99 by less than this share of the errors measured, or by
 * no more than the unit of event times, a nanosecond; pairs further apart than limit_s aren't pairs. */
typedef struct judged_scale {
    double share, limit_s;
    int most_frames; /* it ends there, settled or not */
} judged_scale;
/* Simulates, and doubles the exact stream's frames until they are good enough; `settled` (nullable): whether that was reached.
 * `exact` (nullable) receives the exact events: free its array. */
judged_verdict judged_against_exact(const judged *j, const char *device, const judged_scale *scale, int *settled,
                                    judged_stream *exact);
/* The same against exact events that are known. */
judged_verdict judged_against(const judged *j, const char *device, double limit_s, const judged_stream *exact);

/* Percentiles reported are no smaller than those measured (`timing`), less what the exact events may be off by (`halved`); what
 * is below a nanosecond is nothing. */
int judged_honest(const judged_verdict *v);
void judged_print(const judged *j, const char *device, const judged_verdict *v);

#endif
