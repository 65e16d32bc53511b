/* Test support: exact events, with which a simulated stream is compared. They come from frames alone: L and L_dot of the
 * double reference at finely spaced times, a cubic per pixel between neighbours, and a comparator of ten lines. The solver
 * isn't used. A second stream, which leaves out every second frame, shows their accuracy. Errors fail the running cmocka
 * test. */
#ifndef TESTS_SUPPORT_JUDGED_RUN_H
#define TESTS_SUPPORT_JUDGED_RUN_H

#include "tides/metrics.h"
#include "tides/simulate.h"

/* A scene, camera, sensor and steps to simulate. To be freed by judged_free. */
typedef struct judged {
    char name[96];
    tides_scene *scene;
    tides_trajectory *camera;
    tides_intrinsics intrinsics;
    tides_image_params image;
    tides_sensor sensor;     /* thresholds and leak; all else off */
    tides_stepping stepping; /* model_steps.h's, unless a case changes them */
    double start, stop;      /* [s] */
    int frames;              /* intervals of the exact stream's first attempt; even */
    void *user;              /* for callbacks; freed by judged_free */
} judged;

/* An empty scene with defaults, except steps whose model decides event times (stepping.solve off, whole tiles, tolerance
 * 0.01). The camera rests at the origin; its focal length is 1.25 widths. */
judged judged_make(const char *name, int width, int height, double stop);
void judged_free(judged *j);
/* Sets steps with look-ups, as by default. */
void judged_look_up(judged *j);
/* Replaces the camera's path; takes it over. */
void judged_camera(judged *j, tides_trajectory *path);

typedef struct judged_stream {
    tides_event *events;
    size_t count, capacity;
} judged_stream;

/* Exact events from frames at every interval (fine) and at every second one (coarse), in no order. */
void judged_exact(const judged *j, int frames, judged_stream *fine, judged_stream *coarse);
/* Runs the library on a device ("reference", "reference-f32" or "cpu"); 0 if there is no such device. */
int judged_simulate(const judged *j, const char *device, judged_stream *stream, tides_stats *stats);

/* A run against the exact events. */
typedef struct judged_verdict {
    tides_match match;
    tides_match timing; /* of events that are the same in both streams. Where thresholds differ, a touch taken for a crossing
                         * (or a crossing taken for a touch) changes the pixel's reference, and with it the times of its
                         * later events. events_uncertain counts these; they are no timing errors */
    int wrong_pixels;   /* pixels with another number of events; their times count up to the first that differs */
    tides_stats stats;
    tides_match halved; /* the exact events against those of half as many frames */
    int frames;
} judged_verdict;

/* Events further apart than this [s] aren't matched. */
#define JUDGED_LIMIT_S 1e-3

/* Accuracy of exact events. The last halving of the frames' spacing moved p50, p95 and p99 by less than `share` of the
 * errors measured, or by at most the unit of event times, 1 ns. Events further apart than limit_s aren't matched. */
typedef struct judged_scale {
    double share, limit_s;
    int most_frames; /* halving ends at this number of frames */
} judged_scale;
/* Simulates, and doubles the exact stream's frames until they are accurate enough; *settled (nullable): 1 if they are.
 * `exact` (nullable) receives the exact events: free its array. */
judged_verdict judged_against_exact(const judged *j, const char *device, const judged_scale *scale, int *settled,
                                    judged_stream *exact);
/* Simulates, and compares with exact events that are given. */
judged_verdict judged_against(const judged *j, const char *device, double limit_s, const judged_stream *exact);

/* 1 if reported percentiles are no smaller than those measured (`timing`), less the possible error of the exact events
 * (`halved`). Errors below 1 ns count as 1 ns. */
int judged_honest(const judged_verdict *v);
void judged_print(const judged *j, const char *device, const judged_verdict *v);

#endif
