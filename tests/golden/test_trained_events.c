/* Events of a trained scene by default, against a run with steps of a tenth and a finer tolerance: playbot of
 * $TIDES_SHARED/data, a turn a second. A signal that dips beyond a level and comes back, 0.36 ms before it crosses that level
 * for good, was taken for one crossing. Its looks had found a kink, and the dip was larger than they told (solve_doubts.c). */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/event_list.h"
#include "tests/support/opencl.h"
#include "tests/support/scene_folder.h"
#include "tests/support/shared.h"
#include "tides/metrics.h"
#include "tides/session.h"

#include <stdio.h>
#include <stdlib.h>

/* [us]. Here and there a level is met at a thousandth of the usual slope, and looks are accurate to 5e-7 of log_luminance. */
#define FLATTEST_US 2.0

/* The events of a run of `scene`, with two more settings. */
static stream events_of(const char *scene, const char *first, const char *second) {
    char file[4096];
    snprintf(file, sizeof file, "scene.file=%s", scene);
    const char *words[] =
        {file,  "camera.orbit_s=1", "camera.width=240", "camera.height=180", "image.transfer=srgb", "time.stop=0.0155", first,
         second};
    stream out = {0};
    tides_run *run = NULL;
    tides_session *session = NULL;
    tides_error error;
    scene_expect_ok(tides_run_parse("{}", ".", words, sizeof words / sizeof *words, &run, &error), &error);
    scene_expect_ok(tides_session_open(run, NULL, &session, &error), &error);
    scene_expect_ok(tides_session_run(session, collect, &out, NULL, NULL, &out.stats, &error), &error);
    tides_session_close(session);
    tides_run_destroy(run);
    return out;
}

static void test_a_dip_before_a_crossing_is_found(void **state) {
    (void)state;
    char scene[2048];
    tides_match match;
    tides_error error;
    if (shared_path(scene, sizeof scene, "data/playcanvas/playbot_lod5_inria_sh2.ply")) skip();
    skip_without_opencl(); /* the reference would take minutes */
    stream found = events_of(scene, "stepping.tolerance=0.1", "stepping.step_s=0.01");
    stream wanted = events_of(scene, "stepping.tolerance=0.003", "stepping.step_s=0.001");
    scene_expect_ok(tides_match_events(wanted.events, wanted.count, found.events, found.count, 1e-3, &match, &error), &error);
    printf("%zu events, uncertain %llu, |dt| p99 %.3f, at most %.3f us\n", found.count,
           (unsigned long long)found.stats.events_uncertain, match.dt_p99_us, match.dt_max_us);
    assert_true(found.count > 10000);
    assert_int_equal(match.missing + match.spurious, 0);
    assert_true(match.dt_p99_us * 1e-6 <= found.stats.error_p99_s);
    assert_true(match.dt_max_us <= FLATTEST_US);
    free(found.events);
    free(wanted.events);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_a_dip_before_a_crossing_is_found)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
