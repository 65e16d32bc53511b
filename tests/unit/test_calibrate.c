/* A simulated sensor is measured again from its events and the light. Recordings that don't match the light are refused, with
 * the reason. The result is a preset. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/scene_folder.h"
#include "tides.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 40, HEIGHT = 30, SPLATS = 40 };

/* Splats of many brightnesses; `shift` makes another scene of them. */
static void write_splats(void *folder, const char *name, int shift) {
    static const char head[] =
        "ply\nformat ascii 1.0\ncomment ColourTransfer: linear\nelement vertex 40\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\nproperty float opacity\n"
        "property float scale_0\nproperty float scale_1\nproperty float scale_2\n"
        "property float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\nend_header\n";
    char text[16384];
    size_t used = (size_t)snprintf(text, sizeof text, "%s", head);
    for (int i = 0; i < SPLATS; i++) {
        const double light = 1.6 * ((i * 7 + 5 * shift) % 11) / 11.0 - 1.2;
        used += (size_t)snprintf(text + used, sizeof text - used, "%g %g %g %g %g %g 3 %g %g -2 1 0 0 0\n",
                                 0.35 * (i % 8) - 1.2 + 0.17 * shift, 0.5 * (i / 8) - 1.0 + 0.07 * (i % 3) + 0.2 * shift,
                                 4 + 0.05 * i, light, light, light, -2.2 + 0.1 * (i % 5), -2.2);
    }
    scene_file_write(scene_in_folder(folder, name), text, used);
}

/* A camera that swings before them, on a clock of its own. */
static void write_world(void *folder) {
    char text[16384];
    size_t used = 0;
    write_splats(folder, "s.ply", 0);
    for (int i = 0; i <= 60; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%.3f %.6f %.6f 0 0 0 0 1\n", 10 + 0.01 * i,
                                 0.5 * sin(0.3 * i) + 0.3 * sin(0.11 * i), 0.25 * sin(0.23 * i));
    scene_file_write(scene_in_folder(folder, "p.txt"), text, used);
    static const char run[] = "{\"scene\": {\"file\": \"s.ply\", \"background\": [0.1, 0.1, 0.1]},"
                              "\"camera\": {\"file\": \"p.txt\", \"width\": 40, \"height\": 30, \"fx\": 44},"
                              "\"time\": {\"start\": 10.05, \"stop\": 10.25}, \"device\": \"reference\"}";
    scene_file_write(scene_in_folder(folder, "run.json"), run, sizeof run - 1);
}

static tides_session *opened(void *folder, const char *const *sets, size_t count) {
    tides_error error = {0, ""};
    tides_session *session = NULL;
    scene_expect_ok(tides_session_load(scene_in_folder(folder, "run.json"), sets, count, NULL, &session, &error), &error);
    return session;
}

/* A recording of the world through a sensor, and how many events it has. */
static uint64_t record(void *folder, const char *name, const char *const *sets, size_t count) {
    tides_error error = {0, ""};
    tides_session *session = opened(folder, sets, count);
    tides_recorded done;
    scene_expect_ok(tides_session_write(session, scene_in_folder(folder, name), NULL, NULL, NULL, &done, NULL, &error), &error);
    tides_session_close(session);
    return done.events;
}

static tides_calibration calibrated(void *folder, const char *name, const tides_calibrate_options *options) {
    tides_error error = {0, ""};
    tides_session *session = opened(folder, NULL, 0);
    tides_calibrate_options defaults;
    tides_calibration found;
    tides_calibrate_options_defaults(&defaults);
    scene_expect_ok(tides_calibrate(scene_in_folder(folder, name), session, options ? options : &defaults, NULL, NULL, &found,
                                    &error),
                    &error);
    tides_session_close(session);
    return found;
}

static void near_to(const tides_calibration *found, int32_t index, double truth, double tolerance) {
    tides_calibrated_row row;
    assert_int_equal(tides_calibrated_at(index, &row), 1);
    print_message("%s %.5g +- %.2g, truth %g\n", row.name, found->values[index].value, found->values[index].error, truth);
    assert_true(fabs(found->values[index].value - truth) <= tolerance);
}

static const char *const plain[] = {"sensor.threshold_on=0.2", "sensor.threshold_off=0.16", "image.log_eps=0.03",
                                    "frontend.photoreceptor_cutoff_hz=53.05"};

static void a_sensor_is_found_again(void **state) {
    tides_calibration found = calibrated(*state, "e.h5", NULL);
    assert_int_equal(found.refused, 0);
    assert_int_equal(found.law, TIDES_PHOTORECEPTOR_CONSTANT);
    near_to(&found, TIDES_CALIBRATED_ON, 0.2, 0.004);
    near_to(&found, TIDES_CALIBRATED_OFF, 0.16, 0.0032);
    near_to(&found, TIDES_CALIBRATED_EPS, 0.03, 0.002);
    near_to(&found, TIDES_CALIBRATED_POLE, 0.003, 0.0002);
    near_to(&found, TIDES_CALIBRATED_REFRACTORY, 0, 1e-4);
    near_to(&found, TIDES_CALIBRATED_OFFSET, 0, 3e-4);
    for (int32_t i = 0; i < 4; i++) assert_true(fabs(found.transitions[i] - 1) < 0.02);
    assert_true(found.agreement > 0.99 && found.deviation < 0.05 && found.dead_share < 0.05);
    assert_int_equal(found.bursts, 0);
    tides_calibration again = calibrated(*state, "e.h5", NULL);
    assert_memory_equal(again.values, found.values, sizeof found.values);
    tides_calibration_free(&again);
    tides_calibration_free(&found);
    tides_calibration_free(NULL);
}

static void so_is_one_with_spread_and_a_refractory_period(void **state) {
    static const char *const sets[] = {"sensor.threshold_on=0.18", "sensor.threshold_off=0.24", "image.log_eps=0.08",
                                       "sensor.threshold_sigma=0.02", "sensor.refractory_s=0.002"};
    record(*state, "s.h5", sets, 5);
    tides_calibration found = calibrated(*state, "s.h5", NULL);
    assert_int_equal(found.refused, 0);
    near_to(&found, TIDES_CALIBRATED_ON, 0.18, 0.0054);
    near_to(&found, TIDES_CALIBRATED_OFF, 0.24, 0.0072);
    near_to(&found, TIDES_CALIBRATED_SIGMA, 0.02, 0.002);
    near_to(&found, TIDES_CALIBRATED_REFRACTORY, 0.002, 3e-4);
    tides_calibration_free(&found);
}

/* A pair that ends with a noise event is off by anything up to two thresholds, and mustn't lead the fit. Every fourth event
 * here is noise, and nothing tells its rate. With a clip of 1.5 threshold_on is 2.2 % low. */
static void noise_moves_nothing(void **state) {
    const char *const sets[] = {plain[0], plain[1], plain[2], plain[3], "frontend.shot_noise_hz=12"};
    const uint64_t noisy = record(*state, "n.h5", sets, 5), clean = record(*state, "c.h5", sets, 4);
    print_message("%llu and %llu events\n", (unsigned long long)noisy, (unsigned long long)clean);
    assert_true(4 * (noisy - clean) > clean);
    tides_calibration found = calibrated(*state, "n.h5", NULL);
    assert_int_equal(found.refused, 0);
    near_to(&found, TIDES_CALIBRATED_ON, 0.2, 0.004);
    near_to(&found, TIDES_CALIBRATED_OFF, 0.16, 0.0032);
    near_to(&found, TIDES_CALIBRATED_EPS, 0.03, 0.002);
    near_to(&found, TIDES_CALIBRATED_POLE, 0.003, 0.0002);
    tides_calibration_free(&found);
}

/* Frames of the world, and what the recording is by their light. */
static tides_calibration by_frames(void *folder, const char *name, const char *const *sets, size_t count) {
    tides_error error = {0, ""};
    char file[300];
    tides_calibrate_options options;
    tides_calibration found;
    tides_session *session = opened(folder, sets, count);
    scene_expect_ok(tides_session_frames(session, scene_in_folder(folder, name), NULL, NULL, NULL, &error), &error);
    tides_session_close(session);
    snprintf(file, sizeof file, "frames.file=%s", scene_in_folder(folder, name));
    const char *light[] = {file};
    scene_file_write(scene_in_folder(folder, "empty.json"), "{}", 2);
    scene_expect_ok(tides_session_load(scene_in_folder(folder, "empty.json"), light, 1, NULL, &session, &error), &error);
    tides_calibrate_options_defaults(&options);
    scene_expect_ok(tides_calibrate(scene_in_folder(folder, "e.h5"), session, &options, NULL, NULL, &found, &error), &error);
    tides_session_close(session);
    return found;
}

/* Frames don't say what light does between them. Error bars say how much that is: fewer frames have wider ones, and all truths
 * are within two. With straight lines between 100 frames a second, thresholds are 5.6 % low, and the pole is 1.65 ms. */
static void frames_say_how_little_they_tell(void **state) {
    static const char *const dense[] = {"exposure.frames_per_second=200", "exposure.exposure_s=0.00125"};
    static const char *const sparse[] = {"exposure.frames_per_second=100", "exposure.exposure_s=0.0025"};
    static const double truth[] = {0.2, 0.16, 0, 0.03, 0.003, 0};
    tides_calibration found = by_frames(*state, "f200", dense, 2), fewer = by_frames(*state, "f100", sparse, 2);
    assert_int_equal(found.refused + fewer.refused, 0);
    near_to(&found, TIDES_CALIBRATED_ON, 0.2, 0.006);
    near_to(&found, TIDES_CALIBRATED_OFF, 0.16, 0.0048);
    for (int32_t i = 0; i <= TIDES_CALIBRATED_REFRACTORY; i++) {
        near_to(&found, i, truth[i], 2 * found.values[i].error);
        near_to(&fewer, i, truth[i], 2 * fewer.values[i].error);
    }
    near_to(&fewer, TIDES_CALIBRATED_ON, 0.2, 0.008);
    near_to(&fewer, TIDES_CALIBRATED_OFF, 0.16, 0.0064);
    near_to(&fewer, TIDES_CALIBRATED_POLE, 0.003, 0.0003);
    for (int32_t i = 0; i < 2; i++) assert_true(fewer.values[i].error > found.values[i].error);
    tides_calibration_free(&found);
    tides_calibration_free(&fewer);
}

/* The preset is read as one, and has what was measured. */
static void it_becomes_a_preset(void **state) {
    tides_error error = {0, ""};
    char *text = NULL, set[300];
    tides_run_values values;
    tides_run *run = NULL;
    tides_calibration found = calibrated(*state, "e.h5", NULL);
    scene_expect_ok(tides_calibration_preset(&found, "a test", &text, &error), &error);
    scene_file_write(scene_in_folder(*state, "mine.json"), text, strlen(text));
    snprintf(set, sizeof set, "sensor.preset=%s", scene_in_folder(*state, "mine.json"));
    const char *sets[] = {set};
    scene_expect_ok(tides_run_load(scene_in_folder(*state, "run.json"), sets, 1, &run, &error), &error);
    tides_run_get(run, &values);
    assert_true(fabs(values.sensor.threshold_on - found.values[TIDES_CALIBRATED_ON].value) < 1e-6);
    assert_true(fabs(values.image.log_eps - found.values[TIDES_CALIBRATED_EPS].value) < 1e-6);
    assert_true(fabs(values.sensor.photoreceptor_cutoff_hz - 53.05) < 4);
    assert_true(values.sensor.refractory_s == 0 && values.sensor.leak_rate_hz == 0); /* it can't tell them from none */
    tides_run_destroy(run);
    tides_free(text);
    found.refused = 1;
    scene_expect_error(tides_calibration_preset(&found, NULL, &text, &error), TIDES_BAD_ARGUMENT, &error, "no preset");
    tides_calibration_free(&found);
}

static void what_is_given_stays(void **state) {
    tides_calibrate_options options;
    tides_calibrate_options_defaults(&options);
    options.given[TIDES_CALIBRATED_EPS] = 0.03;
    options.given[TIDES_CALIBRATED_POLE] = 0.003;
    options.given[TIDES_CALIBRATED_OFFSET] = 0;
    tides_calibration found = calibrated(*state, "e.h5", &options);
    assert_true(found.values[TIDES_CALIBRATED_EPS].value == 0.03);
    assert_int_equal(found.values[TIDES_CALIBRATED_EPS].state, TIDES_CALIBRATED_GIVEN);
    near_to(&found, TIDES_CALIBRATED_ON, 0.2, 0.002);
    near_to(&found, TIDES_CALIBRATED_OFF, 0.16, 0.0016);
    tides_calibration_free(&found);
}

/* -- recordings that don't fit ------------------------------------------------------------------------------------------- */

typedef struct events {
    tides_event *list;
    size_t count;
} events;

static events read_all(void *folder, const char *name) {
    tides_error error = {0, ""};
    tides_event_summary s;
    events e = {NULL, 0};
    scene_expect_ok(tides_events_summary(scene_in_folder(folder, name), &s, &error), &error);
    e.list = calloc(2 * s.count, sizeof *e.list);
    scene_expect_ok(tides_events_read(scene_in_folder(folder, name), 0, s.count, e.list, &e.count, &error), &error);
    return e;
}

static int by_time(const void *a, const void *b) {
    const tides_event *p = a, *q = b;
    if (p->t != q->t) return p->t < q->t ? -1 : 1;
    if (p->y != q->y) return p->y < q->y ? -1 : 1;
    return p->x != q->x ? (p->x < q->x ? -1 : 1) : p->polarity - q->polarity;
}

static void write_all(void *folder, const char *name, events *e) {
    tides_error error = {0, ""};
    tides_event_writer *writer = NULL;
    const tides_event_file facts = {.width = WIDTH, .height = HEIGHT};
    qsort(e->list, e->count, sizeof *e->list, by_time);
    scene_expect_ok(tides_event_writer_open(scene_in_folder(folder, name), NULL, &facts, &writer, &error), &error);
    scene_expect_ok(tides_event_writer_append(writer, e->list, NULL, e->count, &error), &error);
    scene_expect_ok(tides_event_writer_finish(writer, e->list[e->count - 1].t + 1, &error), &error);
}

/* The recording after `change`, calibrated; the notes have the words. */
static void changed(void *folder, void (*change)(events *), int32_t refused, const char *words) {
    events e = read_all(folder, "e.h5");
    change(&e);
    write_all(folder, "x.h5", &e);
    free(e.list);
    tides_calibration found = calibrated(folder, "x.h5", NULL);
    print_message("%s\n", found.notes);
    assert_int_equal(found.refused, refused);
    assert_non_null(strstr(found.notes, words));
    tides_calibration_free(&found);
}

static void shuffle(events *e) {
    uint64_t seed = 1;
    for (size_t i = e->count - 1; i > 0; i--) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        const size_t k = (size_t)((seed >> 33) % (i + 1));
        const int8_t polarity = e->list[i].polarity;
        e->list[i].polarity = e->list[k].polarity;
        e->list[k].polarity = polarity;
    }
}
static void exchange(events *e) {
    for (size_t i = 0; i < e->count; i++) e->list[i].polarity = (int8_t)-e->list[i].polarity;
}
static void mirror(events *e) {
    for (size_t i = 0; i < e->count; i++) e->list[i].x = (uint16_t)(WIDTH - 1 - e->list[i].x);
}
static void be_late(events *e) {
    for (size_t i = 0; i < e->count; i++) e->list[i].t += 40000000;
}
static void keep_hundred(events *e) { e->count = 100; }
static void lose_half(events *e) {
    size_t count = 0;
    for (size_t i = 0; i < e->count; i++)
        if ((e->list[i].x * 7 + e->list[i].y * 5) % 2) e->list[count++] = e->list[i];
    e->count = count;
}
/* As the readout of a frame does: a tenth of the pixels, both polarities, within 0.5 ms, four times. */
static void burst(events *e) {
    const size_t before = e->count;
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 500 && e->count < 2 * before; i++)
            e->list[e->count++] = (tides_event){.t = 10080000000 + 40000000 * (int64_t)k + 800 * i,
                                                .x = (uint16_t)((i * 37 + k) % WIDTH),
                                                .y = (uint16_t)((i * 11) % HEIGHT),
                                                .polarity = i & 1 ? 1 : -1};
}

/* Another scene from the same path. */
static void another_scene_is_known(void **state) {
    static const char *const sets[] = {"sensor.threshold_on=0.2", "scene.file=s2.ply"};
    write_splats(*state, "s2.ply", 1);
    record(*state, "o.h5", sets, 2);
    tides_calibration found = calibrated(*state, "o.h5", NULL);
    print_message("%s\n", found.notes);
    assert_int_equal(found.refused, 1);
    assert_non_null(strstr(found.notes, "don't belong together"));
    tides_calibration_free(&found);
}

static void wrong_recordings_are_known(void **state) {
    changed(*state, shuffle, 1, "don't belong together");
    changed(*state, exchange, 1, "exchanged");
    changed(*state, mirror, 1, "don't belong together");
    changed(*state, keep_hundred, 1, "pairs of events");
    changed(*state, be_late, 0, "later than their light");
    changed(*state, lose_half, 0, "have no event");
    changed(*state, burst, 0, "4 bursts");
}

/* Bursts cost pairs, and no accuracy. */
static void bursts_change_nothing(void **state) {
    events e = read_all(*state, "e.h5");
    burst(&e);
    write_all(*state, "x.h5", &e);
    free(e.list);
    tides_calibration found = calibrated(*state, "x.h5", NULL);
    assert_int_equal(found.bursts, 4);
    near_to(&found, TIDES_CALIBRATED_ON, 0.2, 0.004);
    near_to(&found, TIDES_CALIBRATED_OFF, 0.16, 0.0032);
    tides_calibration_free(&found);
}

/* A scene at rest: pixels of noise alone. */
static void nothing_moves(void **state) {
    tides_error error = {0, ""};
    static const char rest[] = "10 0 0 0 0 0 0 1\n10.6 0 0 0 0 0 0 1\n";
    static const char *const noisy[] = {"camera.file=rest.txt", "frontend.shot_noise_hz=40", "sensor.threshold_on=0.2"};
    tides_calibrate_options options;
    tides_calibration found;
    scene_file_write(scene_in_folder(*state, "rest.txt"), rest, sizeof rest - 1);
    record(*state, "r.h5", noisy, 3);
    tides_session *session = opened(*state, noisy, 1);
    tides_calibrate_options_defaults(&options);
    scene_expect_ok(tides_calibrate(scene_in_folder(*state, "r.h5"), session, &options, NULL, NULL, &found, &error), &error);
    assert_int_equal(found.refused, 1);
    assert_non_null(strstr(found.notes, "nothing moves"));
    tides_calibration_free(&found);
    /* Beside a recording of motion it says what noise there is: 40 Hz in the dark, fewer at this light, which isn't known. */
    options.still = scene_in_folder(*state, "r.h5");
    found = calibrated(*state, "e.h5", &options);
    print_message("%g Hz\n", found.values[TIDES_CALIBRATED_SHOT].value);
    assert_true(found.values[TIDES_CALIBRATED_SHOT].value > 25 && found.values[TIDES_CALIBRATED_SHOT].value < 42);
    tides_calibration_free(&found);
    tides_session_close(session);
}

/* The path of write_world, behind a rest. */
static void write_late(void *folder) {
    char text[8192];
    size_t used = 0;
    for (int i = 0; i <= 60; i++) {
        const double k = i > 8 ? i - 8 : 0;
        used += (size_t)snprintf(text + used, sizeof text - used, "%.3f %.6f %.6f 0 0 0 0 1\n", 10 + 0.01 * i,
                                 0.5 * sin(0.3 * k) + 0.3 * sin(0.11 * k), 0.25 * sin(0.23 * k));
    }
    scene_file_write(scene_in_folder(folder, "late.txt"), text, used);
}

/* Pixels that begin at rest, anywhere between the levels, or as leak leaves them; the leak is of a still recording. */
static void it_is_known_where_pixels_began(void **state) {
    static const char *const starts[] = {"sensor.initial=rest", "sensor.initial=random", "sensor.initial=steady"};
    static const char *const still[] = {"camera.file=rest.txt", "sensor.leak_rate_hz=1", "sensor.threshold_on=0.2",
                                        "sensor.initial=steady"};
    static const char *const late[] = {"camera.file=late.txt"};
    tides_calibrate_options options;
    tides_error error = {0, ""};
    write_late(*state);
    record(*state, "l.h5", still, 4);
    tides_calibrate_options_defaults(&options);
    for (int32_t i = TIDES_INITIAL_REST; i <= TIDES_INITIAL_STEADY; i++) {
        const char *const sets[] = {plain[0], plain[1], plain[2], plain[3], late[0], "sensor.leak_rate_hz=1", starts[i]};
        tides_session *session = opened(*state, late, 1);
        tides_calibration found;
        char *preset = NULL;
        record(*state, "f.h5", sets, 7);
        options.still = scene_in_folder(*state, "l.h5");
        scene_expect_ok(tides_calibrate(scene_in_folder(*state, "f.h5"), session, &options, NULL, NULL, &found, &error),
                        &error);
        for (int32_t k = 0; k < 4; k++) print_message("%.3f %.3f\n", found.starts[k][0], found.starts[k][1]);
        near_to(&found, TIDES_CALIBRATED_LEAK, 1, 0.3);
        assert_int_equal(found.initial, i);
        scene_expect_ok(tides_calibration_preset(&found, NULL, &preset, &error), &error);
        assert_true((strstr(preset, "initial") != NULL) == (i == TIDES_INITIAL_STEADY));
        tides_free(preset);
        tides_calibration_free(&found);
        tides_session_close(session);
    }
}

/* -- errors -------------------------------------------------------------------------------------------------------------- */

static int stop_at(void *at, double fraction, const char *stage) {
    (void)stage;
    return fraction >= *(const double *)at;
}

static void it_can_be_stopped_anywhere(void **state) {
    tides_error error = {0, ""};
    tides_calibrate_options options;
    tides_calibration found;
    tides_session *session = opened(*state, NULL, 0);
    tides_calibrate_options_defaults(&options);
    for (double at = 0; at < 0.99; at += 0.33) {
        const tides_status status =
            tides_calibrate(scene_in_folder(*state, "e.h5"), session, &options, stop_at, &at, &found, &error);
        assert_int_equal(status, TIDES_CANCELLED);
    }
    tides_session_close(session);
}

static void what_cant_be_is_said(void **state) {
    tides_error error = {0, ""};
    tides_calibrate_options options;
    tides_calibration found;
    static const char *const small[] = {"camera.width=20"};
    const char *file = scene_in_folder(*state, "e.h5");
    tides_session *session = opened(*state, NULL, 0), *narrow = opened(*state, small, 1);
    tides_calibrate_options_defaults(&options);
    options.start_ns = 20000000000;
    scene_expect_error(tides_calibrate(file, session, &options, NULL, NULL, &found, &error), TIDES_BAD_ARGUMENT, &error,
                       "light is known");
    tides_calibrate_options_defaults(&options);
    options.stop_ns = 10020000000; /* before the first event */
    scene_expect_error(tides_calibrate(file, session, &options, NULL, NULL, &found, &error), TIDES_BAD_ARGUMENT, &error,
                       "no events|clocks");
    tides_calibrate_options_defaults(&options);
    scene_expect_error(tides_calibrate(file, narrow, &options, NULL, NULL, &found, &error), TIDES_BAD_ARGUMENT, &error,
                       "outside|20x30");
    options.given[TIDES_CALIBRATED_ON] = 0.2;
    scene_expect_error(tides_calibrate(file, session, &options, NULL, NULL, &found, &error), TIDES_BAD_ARGUMENT, &error,
                       "threshold_on|measured");
    options.given[TIDES_CALIBRATED_ON] = NAN;
    options.given[TIDES_CALIBRATED_REFRACTORY] = -1;
    scene_expect_error(tides_calibrate(file, session, &options, NULL, NULL, &found, &error), TIDES_BAD_ARGUMENT, &error,
                       "given refractory_s is -1; it must be finite and not negative");
    options.given[TIDES_CALIBRATED_REFRACTORY] = NAN;
    options.given[TIDES_CALIBRATED_OFFSET] = -INFINITY;
    scene_expect_error(tides_calibrate(file, session, &options, NULL, NULL, &found, &error), TIDES_BAD_ARGUMENT, &error,
                       "given offset_s is -inf; it must be finite");
    assert_null(strstr(error.text, "negative"));
    options.size = 4;
    scene_expect_error(tides_calibrate(file, session, &options, NULL, NULL, &found, &error), TIDES_BAD_ARGUMENT, &error,
                       "defaults");
    tides_session_close(session);
    tides_session_close(narrow);
}

/* One world and one recording for all. */
static int setup(void **state) {
    if (scene_folder_setup(state)) return -1;
    write_world(*state);
    return record(*state, "e.h5", plain, 4) > 2000 ? 0 : -1;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sensor_is_found_again),
        cmocka_unit_test(so_is_one_with_spread_and_a_refractory_period),
        cmocka_unit_test(noise_moves_nothing),
        cmocka_unit_test(frames_say_how_little_they_tell),
        cmocka_unit_test(it_becomes_a_preset),
        cmocka_unit_test(what_is_given_stays),
        cmocka_unit_test(wrong_recordings_are_known),
        cmocka_unit_test(another_scene_is_known),
        cmocka_unit_test(bursts_change_nothing),
        cmocka_unit_test(nothing_moves),
        cmocka_unit_test(it_is_known_where_pixels_began),
        cmocka_unit_test(it_can_be_stopped_anywhere),
        cmocka_unit_test(what_cant_be_is_said),
    };
    return cmocka_run_group_tests(tests, setup, scene_folder_teardown);
}
