/* The sensor of a real recording, a DAVIS240C's (slider_depth of the Event Camera Dataset, in the shared data), against
 * measurements by independent code: thresholds 0.573 and 0.371, black level 0.051, pole 4.5 ms, refractory period below 0.3 ms,
 * leak at most 0.06 Hz, mismatch below 7 % of a threshold. Halves of the recording agreed within 3 %. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/opencl.h"
#include "tests/support/scene_folder.h"
#include "tests/support/shared.h"
#include "tides.h"

#include <math.h>
#include <string.h>

static void near_to(const tides_calibration *found, int32_t index, double truth, double tolerance) {
    tides_calibrated_row row;
    assert_int_equal(tides_calibrated_at(index, &row), 1);
    const tides_calibrated *v = &found->values[index];
    print_message("%s %.5g +- %.2g, measured otherwise %g\n", row.name, v->value, v->error, truth);
    assert_true(fabs(v->value - truth) <= tolerance);
}

static void a_real_sensor_is_what_others_measured(void **state) {
    char run[1024], events[1024];
    tides_error error = {0, ""};
    tides_session *session = NULL;
    tides_calibrate_options options;
    tides_calibration found;
    (void)state;
    if (shared_path(run, sizeof run, "data/real/slider_depth/run.json") ||
        shared_path(events, sizeof events, "data/events/ecd_slider_depth_davis240_50k.txt"))
        skip();
    skip_without_opencl();
    scene_expect_ok(tides_session_load(run, NULL, 0, NULL, &session, &error), &error);
    tides_calibrate_options_defaults(&options);
    scene_expect_ok(tides_calibrate(events, session, &options, NULL, NULL, &found, &error), &error);
    tides_session_close(session);
    assert_int_equal(found.refused, 0);
    near_to(&found, TIDES_CALIBRATED_ON, 0.573, 0.03 * 0.573);
    near_to(&found, TIDES_CALIBRATED_OFF, 0.371, 0.03 * 0.371);
    near_to(&found, TIDES_CALIBRATED_EPS, 0.051, 0.006);
    near_to(&found, TIDES_CALIBRATED_POLE, 4.5e-3, 0.7e-3);
    near_to(&found, TIDES_CALIBRATED_REFRACTORY, 0, 0.3e-3);
    near_to(&found, TIDES_CALIBRATED_LEAK, 0, 0.06);
    near_to(&found, TIDES_CALIBRATED_SIGMA, 0, 0.07 * 0.371);
    assert_int_equal(found.law, TIDES_PHOTORECEPTOR_CONSTANT);
    assert_int_equal(found.bursts, 4); /* of the frames at 0.0388, 0.0775, 0.1163 and 0.1551 s */
    assert_true(found.burst_events > 6000 && found.burst_events < 9000);
    assert_int_equal(found.initial, TIDES_INITIAL_STEADY);
    for (int32_t i = 0; i < 4; i++) assert_true(fabs(found.transitions[i] - 1) < 0.05);
    tides_calibration_free(&found);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_real_sensor_is_what_others_measured)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
