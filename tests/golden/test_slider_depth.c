/* A real recording and a scene fitted to its frames: events simulated with a preset from documents alone, beside the camera's.
 * Events in the bursts that a frame's readout makes (0.7 ms before to 1.7 ms after its time) aren't counted. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/opencl.h"
#include "tests/support/shared.h"
#include "tides.h"

#include <stdio.h>
#include <stdlib.h>

static const int64_t first_ns = 3800000, last_ns = 174200000, burst_before = 700000, burst_after = 1700000;
enum { FRAMES = 8, EVENTS = 50000 };

typedef struct counted {
    int64_t frame[FRAMES];
    size_t frames, events;
} counted;

static void read_frames(counted *c) {
    char path[1024];
    double seconds;
    assert_int_equal(shared_path(path, sizeof path, "data/real/slider_depth/images.txt"), 0);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (c->frames < FRAMES && fscanf(file, "%lf %*s", &seconds) == 1) c->frame[c->frames++] = (int64_t)(1e9 * seconds);
    fclose(file);
    assert_int_equal(c->frames, FRAMES);
}

static int count(void *user, const tides_event *events, size_t some) {
    counted *c = user;
    for (size_t i = 0; i < some; i++) {
        int counts = events[i].t >= first_ns && events[i].t <= last_ns;
        for (size_t f = 0; f < c->frames; f++)
            counts = counts && !(events[i].t > c->frame[f] - burst_before && events[i].t < c->frame[f] + burst_after);
        c->events += (size_t)counts;
    }
    return 0;
}

static void run_with(const char *path, const char *preset, counted *out) {
    const char *const sets[] = {preset};
    tides_session *session = NULL;
    tides_error error = {TIDES_OK, ""};
    if (tides_session_load(path, sets, 1, NULL, &session, &error) != TIDES_OK) fail_msg("%s", error.text);
    if (tides_session_run(session, count, out, NULL, NULL, NULL, &error) != TIDES_OK) fail_msg("%s", error.text);
    tides_session_close(session);
}

static void test_davis240(void **state) {
    (void)state;
    char run[1024], events[1024];
    if (shared_path(run, sizeof run, "data/real/slider_depth/run.json") != 0 ||
        shared_path(events, sizeof events, "data/events/ecd_slider_depth_davis240_50k.txt") != 0)
        skip();
    skip_without_opencl(); /* the run wants device auto */
    counted recorded = {{0}, 0, 0}, simulated;
    read_frames(&recorded);
    simulated = recorded;
    size_t got = 0;
    tides_error error = {TIDES_OK, ""};
    tides_event *list = calloc(EVENTS, sizeof *list);
    assert_non_null(list);
    assert_int_equal(tides_events_read(events, 0, EVENTS, list, &got, &error), TIDES_OK);
    count(&recorded, list, got);
    free(list);
    assert_in_range(recorded.events, 42000, 45000);
    run_with(run, "sensor.preset=davis240", &simulated);
    const double ratio = (double)simulated.events / (double)recorded.events;
    printf("davis240: %zu events to the recording's %zu: %.3f\n", simulated.events, recorded.events, ratio);
    assert_true(ratio < 1.7 && ratio > 1 / 1.7);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_davis240)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
