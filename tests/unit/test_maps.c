/* Maps of a sensor's pixels: a file's values become the pixels', missing ones are drawn as without a file; maps are written,
 * read and drawn again; wrong files are refused. */
#include "sensor_rig.h"
#include "sensor/td_between.h"

#include "archive/td_npy.h"
#include "sensor/td_maps.h"

#include <stdio.h>
#include <unistd.h>

enum { TILES = 2, WIDTH = TILES * RIG_WIDTH, HEIGHT = RIG_WIDTH, COUNT = WIDTH * HEIGHT };

static char folder[] = "/tmp/tides_maps_XXXXXX", path[64];

static int make_folder(void **state) {
    (void)state;
    return !mkdtemp(folder);
}

static int remove_folder(void **state) {
    (void)state;
    const char *const names[] = {"maps.h5", "maps.npz", "maps.npy"};
    for (size_t i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        remove(path);
    }
    return rmdir(folder);
}

static const char *named(const char *name) {
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void still(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    (void)i;
    (void)t;
    *S = -1;
    *S_dot = 0;
}

/* A value of each map that tells its pixel; every seventh isn't known. */
static double value_of(int m, int i) {
    if (i % 7 == 3) return NAN;
    if (m == TD_MAP_DEAD) return i % 11 == 0;
    if (m == TD_MAP_ON || m == TD_MAP_OFF) return 0.1 + 0.0005 * i + 0.01 * m;
    return i % 5 == 0 ? 0 : 0.5 * m + 0.01 * i;
}

static tides_sensor noisy(const char *maps) {
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.threshold_sigma = 0.03;
    sensor.threshold_min = 0.05;
    sensor.leak_rate_hz = 3;
    sensor.leak_sigma = 0.2;
    sensor.shot_noise_hz = 4;
    sensor.hot_pixel_fraction = 0.1;
    sensor.hot_pixel_rate_hz = 20;
    sensor.initial = TIDES_INITIAL_STEADY;
    sensor.seed = 99;
    sensor.maps = maps;
    return sensor;
}

/* Sizes of additive noise, which varies with such a map alone too. */
static void expect_sizes(const char *file) {
    for (int spread = 0; spread < 2; spread++) {
        tides_sensor with = noisy(file), without = noisy(NULL);
        with.noise_rms = without.noise_rms = 0.02;
        with.noise_sigma = without.noise_sigma = 0.1 * spread;
        rig *a = rig_make(&with, TILES, 0, still, NULL), *b = rig_make(&without, TILES, 0, still, NULL);
        for (size_t k = 0; k < a->pixels; k++) {
            const uint32_t i = a->sensor.segment.pixel[k];
            const double own = td_sensor_noise_segment(&a->sensor, k).own;
            const double drawn = td_sensor_noise_segment(&b->sensor, k).own;
            assert_true(own == (i % 7 == 3 ? drawn : value_of(TD_MAP_SIZE, (int)i)));
            assert_true((drawn != 1) == spread);
        }
        rig_run(a, 0.1, 7);
        rig_check(a);
        rig_free(a);
        rig_free(b);
    }
}

static void expect_pixels(const char *file) {
    expect_sizes(file);
    const tides_sensor with = noisy(file), without = noisy(NULL);
    rig *a = rig_make(&with, TILES, 0, still, NULL), *b = rig_make(&without, TILES, 0, still, NULL);
    for (size_t k = 0; k < a->pixels; k++) {
        const int x = (int)(k / RIG_PIXELS) * RIG_WIDTH + (int)(k % RIG_WIDTH), y = (int)(k % RIG_PIXELS) / RIG_WIDTH;
        const int i = y * WIDTH + x;
        const td_sensor *s = &a->sensor, *drawn = &b->sensor;
        if (i % 7 == 3) { /* not known: as if there were no file */
            assert_true(s->threshold_on[k] == drawn->threshold_on[k] && s->threshold_off[k] == drawn->threshold_off[k]);
            assert_true(s->leak[k] == drawn->leak[k]);
            for (int n = 0; n < TD_NOISES; n++) assert_true(s->noise.due[n][k] == drawn->noise.due[n][k]);
            continue;
        }
        if (i % 11 == 0) {
            assert_true(s->threshold_on[k] >= TD_OUT_OF_REACH && s->leak[k] == 0);
            continue;
        }
        assert_true(s->threshold_on[k] == value_of(TD_MAP_ON, i) && s->threshold_off[k] == value_of(TD_MAP_OFF, i));
        assert_true(fabs(1e9 * s->leak[k] - value_of(TD_MAP_LEAK, i) * s->threshold_on[k]) < 1e-12);
        const double shot =
            td_shot_noise_rate(&s->noise, TD_NOISE_SHOT_ON, k) + td_shot_noise_rate(&s->noise, TD_NOISE_SHOT_OFF, k);
        assert_true(fabs(1e9 * shot - value_of(TD_MAP_NOISE, i)) < 1e-12);
        assert_true(fabs(1e9 * td_shot_noise_rate(&s->noise, TD_NOISE_HOT, k) - value_of(TD_MAP_HOT, i)) < 1e-12);
    }
    assert_true(a->sensor.maps_checksum != 0 && a->sensor.sensor.maps == NULL && b->sensor.maps_checksum == 0);
    rig_free(a);
    rig_free(b);
}

static void fill(td_maps *maps) {
    memset(maps, 0, sizeof *maps);
    for (int m = 0; m < TD_MAPS; m++) {
        maps->map[m] = rig_alloc(COUNT, sizeof(double));
        for (int i = 0; i < COUNT; i++) maps->map[m][i] = value_of(m, i);
    }
}

static void test_pixels(void **state) {
    (void)state;
    td_maps maps;
    tides_error error = {TIDES_OK, ""};
    fill(&maps);
    assert_int_equal(td_maps_write(named("maps.h5"), WIDTH, HEIGHT, &maps, &error), TIDES_OK);
    expect_pixels(path);
    td_npy_writer *writer = NULL;
    const size_t inner = WIDTH;
    assert_int_equal(td_npy_writer_open(named("maps.npz"), 1, &writer, &error), TIDES_OK);
    for (int m = 0; m < TD_MAPS; m++)
        assert_int_equal(td_npy_writer_put(writer, &(td_npy_form){td_map_names[m], "'<f8'", 8, 2, &inner}, maps.map[m], HEIGHT,
                                           &error),
                         TIDES_OK);
    assert_int_equal(td_npy_writer_close(writer, &error), TIDES_OK);
    expect_pixels(path);
    static const char structured[] = "[('threshold_on', '<f8'), ('threshold_off', '<f8'), ('leak', '<f8'), ('noise', '<f8'), "
                                     "('hot', '<f8'), ('dead', '<f8'), ('noise_size', '<f8')]";
    double *rows = rig_alloc(COUNT * TD_MAPS, sizeof *rows);
    for (int i = 0; i < COUNT * TD_MAPS; i++) rows[i] = maps.map[i % TD_MAPS][i / TD_MAPS];
    assert_int_equal(td_npy_writer_open(named("maps.npy"), 0, &writer, &error), TIDES_OK);
    assert_int_equal(td_npy_writer_put(writer, &(td_npy_form){"data", structured, sizeof(double) * TD_MAPS, 2, &inner}, rows,
                                       HEIGHT, &error),
                     TIDES_OK);
    assert_int_equal(td_npy_writer_close(writer, &error), TIDES_OK);
    expect_pixels(path);
    free(rows);
    td_maps_release(&maps);
}

/* Rates measured: pixels fire as often as their maps say. */
static void test_rates(void **state) {
    (void)state;
    td_maps maps;
    tides_error error = {TIDES_OK, ""};
    memset(&maps, 0, sizeof maps);
    maps.map[TD_MAP_HOT] = rig_alloc(COUNT, sizeof(double));
    maps.map[TD_MAP_NOISE] = rig_alloc(COUNT, sizeof(double));
    for (int i = 0; i < COUNT; i++) {
        maps.map[TD_MAP_HOT][i] = i % 2 ? 8 : 0;
        maps.map[TD_MAP_NOISE][i] = i % 2 ? 0 : 20;
    }
    assert_int_equal(td_maps_write(named("maps.h5"), WIDTH, HEIGHT, &maps, &error), TIDES_OK);
    td_maps_release(&maps);
    tides_sensor sensor; /* ideal but for the maps */
    tides_sensor_defaults(&sensor);
    sensor.maps = path;
    rig *r = rig_make(&sensor, TILES, 0, still, NULL);
    rig_run(r, 20, 200);
    const double share = td_shot_noise_share(exp(-1) - 1e-3), hot = 8 * 20 * COUNT / 2, shot = 20 * 20 * COUNT / 2 * share;
    double found[2] = {0, 0}, on[2] = {0, 0};
    for (size_t k = 0; k < r->work.events.count; k++) {
        const tides_event *e = &r->work.events.events[k];
        const int odd = (e->y * WIDTH + e->x) % 2;
        found[odd]++;
        on[odd] += e->polarity > 0;
    }
    assert_true(fabs(found[1] - hot) < 4 * sqrt(hot) && on[1] == found[1]);
    assert_true(fabs(found[0] - shot) < 4 * sqrt(shot) && fabs(on[0] - shot / 2) < 4 * sqrt(shot / 2));
    rig_free(r);
}

static void refuse(const char *file, int32_t width, const char *text) {
    td_maps maps;
    tides_error error = {TIDES_OK, ""};
    assert_int_not_equal(td_maps_read(file, width, HEIGHT, &maps, &error), TIDES_OK);
    if (!strstr(error.text, text)) fail_msg("%s, not %s", error.text, text);
    for (int m = 0; m < TD_MAPS; m++) assert_null(maps.map[m]);
}

static void test_refused(void **state) {
    (void)state;
    td_maps maps;
    tides_error error = {TIDES_OK, ""};
    fill(&maps);
    maps.map[TD_MAP_LEAK][3 * WIDTH + 5] = -1;
    assert_int_equal(td_maps_write(named("maps.h5"), WIDTH, HEIGHT, &maps, &error), TIDES_OK);
    refuse(path, WIDTH, "leak at x 5, y 3 is -1; it must be in [0, 1e6]");
    maps.map[TD_MAP_OFF][0] = 0;
    assert_int_equal(td_maps_write(path, WIDTH, HEIGHT, &maps, &error), TIDES_OK);
    refuse(path, WIDTH, "threshold_off at x 0, y 0 is 0; it must be above 0");
    refuse(path, WIDTH + 1, "threshold_on isn't an array of 16 x 33 numbers");
    td_maps_release(&maps);
    memset(&maps, 0, sizeof maps);
    assert_int_equal(td_maps_write(path, WIDTH, HEIGHT, &maps, &error), TIDES_OK);
    refuse(path, WIDTH, "has none of threshold_on");
    FILE *file = fopen(path, "wb");
    fputs("not HDF5", file);
    fclose(file);
    refuse(path, WIDTH, "isn't an HDF5 file");
    refuse("/nowhere/maps.npz", WIDTH, "maps.npz");
    const tides_sensor sensor = noisy("/nowhere/maps.h5");
    const td_tile tile = {0, 0, WIDTH, COUNT};
    td_sensor made;
    assert_int_not_equal(td_sensor_create(&sensor, TIDES_MODEL_HERMITE, 1e-3, 0, &(const td_sensor_tiles){&tile, 1, WIDTH},
                                          &made, &error),
                         TIDES_OK);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_pixels), cmocka_unit_test(test_rates),
                                       cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
