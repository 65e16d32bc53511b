/* Kicks of a frame's readout: their sum and bounds, and the events of pixels under them, against a plain search in small
 * steps on formulas of its own; cuts of steps don't show. */
#include "tests/unit/sensor_rig.h"

#include "td_random.h"
#include "tides/base.h"

#include <stdio.h>
#include <unistd.h>

enum { SEED = 4242, ROWS = 16 };

static const double start = 3.25, stop = 3.3, pole_hz = 70;

static tides_sensor kicked(double size) {
    tides_sensor s;
    tides_sensor_defaults(&s);
    s.threshold_on = 0.21;
    s.threshold_off = 0.17;
    s.kick = size;
    s.kick_rate_hz = 101;
    s.kick_first_s = 3.2501 + 0.3e-9; /* off whole nanoseconds, which both floor */
    return s;
}

/* Frames at no rate: the first is half before the run, two are close together, none is in its last 27 ms. Off whole
 * nanoseconds, as above. */
static const char listed[] = "# time file\n3.2465000003 a.png\n\n 3.2533000003 b.png\r\n3.2537000003,c.png\n%\n3.2689000003";
static const double at_s[] = {3.2465000003, 3.2533000003, 3.2537000003, 3.2689000003};
enum { LISTED = 4 };

/* Since the run's start [s]. */
static double plain_read(const tides_sensor *s, int y, int r, int k) {
    const double frame = s->kick_times ? k < LISTED ? at_s[k] : 1e9 : s->kick_first_s + k / s->kick_rate_hz;
    const double asked = frame + s->kick_reads_s[r] + y * s->kick_row_s;
    return 1e-9 * (floor(1e9 * (asked - start)) + 0.5);
}

/* The row's first read after t, or the run's end. */
static double plain_next(const tides_sensor *s, int y, double t) {
    double next = stop;
    for (int r = 0; r < 2; r++)
        for (int k = 0; k < 20; k++)
            if (start + plain_read(s, y, r, k) > t) next = fmin(next, start + plain_read(s, y, r, k));
    return next;
}

/* K of a row at absolute time t, from the header's sentence: reads strictly before t, none before the run. */
static double plain_kick(const tides_sensor *s, int y, double t) {
    double sum = 0;
    for (int r = 0; r < (s->kick_reads_s[0] == s->kick_reads_s[1] ? 1 : 2); r++)
        for (int k = 0; k < 20; k++) {
            const double read = plain_read(s, y, r, k), now = t - start;
            if (read >= 0 && read < now) sum += exp((read - now) / s->kick_recovery_s);
        }
    return s->kick * sum;
}

static char path[] = "/tmp/tides_kick_XXXXXX";

static int make_file(void **state) {
    (void)state;
    const int file = mkstemp(path);
    return file < 0 || close(file);
}

static int remove_file(void **state) {
    (void)state;
    return unlink(path);
}

static void write_times(const char *text) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

static double uniform(uint32_t number) {
    const td_random_bits bits = td_random(SEED, number, 0, TD_RANDOM_NOISE);
    return td_random_uniform(&bits, 0);
}

static void sums(void **state) {
    (void)state;
    tides_sensor s = kicked(0.04);
    write_times(listed);
    for (int one = 0; one < 4; one++) {
        td_kick kick;
        if (one == 1) s.kick_reads_s[1] = s.kick_reads_s[0] = 1e-3;
        if (one == 2) s.kick_first_s = start - 1.1e-3; /* reads of some rows are before the run */
        if (one == 3) s = kicked(0.04);
        if (one == 3) s.kick_times = path;
        assert_int_equal(td_kick_make(&s, start, &kick, NULL), TIDES_OK);
        assert_true(!kick.checksum == !s.kick_times);
        for (uint32_t i = 0; i < 3000; i++) {
            const int y = (int)(16 * uniform(3 * i));
            const double t = 5e7 * uniform(3 * i + 1), u = t + 2e7 * uniform(3 * i + 2), next = td_kick_next(&kick, y, t);
            double low, high;
            assert_true(fabs(td_kick_at(&kick, y, t) - plain_kick(&s, y, start + 1e-9 * t)) < 1e-6 * kick.most);
            assert_true(next >= t && td_kick_next(&kick, y, next) == next);
            assert_true(next < INFINITY || s.kick_times);
            if (next < INFINITY) assert_true(td_kick_at(&kick, y, next + 1e-3) - td_kick_at(&kick, y, next) > 0.99 * s.kick);
            td_kick_bounds(&kick, y, t, u, &low, &high);
            for (int k = 0; k <= 40; k++) {
                const double K = td_kick_at(&kick, y, t + (u - t) * k / 40);
                assert_true(K >= low && K <= high && high <= kick.most * (1 + 1e-12));
            }
        }
        td_kick_release(&kick);
    }
}

/* -- events -------------------------------------------------------------------------------------------------------------- */

/* Ramps, faster from pixel to pixel of a row, some falling, one at rest. */
static double slope_of(int i) { return (i % RIG_WIDTH - 5) * 4.0; }

static void ramp(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    *S_dot = slope_of(i);
    *S = *S_dot * (t - start);
}

/* The ramp's signal before kicks; behind the pole, exactly. */
static double plain_signal(const tides_sensor *s, int i, double t) {
    const double tau = 1 / (2 * 3.14159265358979323846 * pole_hz), after = t - start;
    return slope_of(i) * (s->photoreceptor_cutoff_hz > 0 ? after + tau * expm1(-after / tau) : after);
}

/* Searches in steps of two microseconds, and on both sides of each read; the last digits by halving. */
static size_t plain_events(const tides_sensor *s, int i, tides_event *events, size_t room) {
    const int y = i / RIG_WIDTH;
    const double step = 2e-6;
    double reference = 0;
    size_t count = 0;
    int read = 0;
    double next = plain_next(s, y, start), high;
    for (double from = start; from < stop; from = high) {
        double low = from;
        high = fmin(from + (read ? 1e-13 : step), next);
        read = high == next;
        if (read) next = plain_next(s, y, high);
        for (;;) {
            const double S = plain_signal(s, i, high) + plain_kick(s, y, high) - reference;
            const int polarity = S >= s->threshold_on ? 1 : S <= -s->threshold_off ? -1 : 0;
            if (polarity == 0) break;
            double a = low, b = high;
            for (int k = 0; k < 40; k++) {
                const double middle = 0.5 * (a + b), at = plain_signal(s, i, middle) + plain_kick(s, y, middle) - reference;
                if (polarity > 0 ? at >= s->threshold_on : at <= -s->threshold_off)
                    b = middle;
                else
                    a = middle;
            }
            assert_true(count < room);
            events[count++] = (tides_event){.t = llround(1e9 * (b - start)), .polarity = (int8_t)polarity};
            reference += polarity > 0 ? s->threshold_on : -s->threshold_off;
            low = a;
        }
    }
    return count;
}

static void expect_plain(const char *name, const tides_sensor *s, int steps) {
    enum { ROOM = 400 };
    rig *r = rig_make(s, 1, start, ramp, NULL);
    size_t all = 0, on = 0;
    int64_t worst = 0;
    rig_run(r, stop, steps);
    for (int i = 0; i < RIG_PIXELS; i += i % RIG_WIDTH == 15 ? 49 : 1) { /* every fourth row */
        tides_event wanted[ROOM], got[ROOM];
        const size_t count = plain_events(s, i, wanted, ROOM);
        assert_int_equal(rig_events(r, i % RIG_WIDTH, i / RIG_WIDTH, got, ROOM), count);
        for (size_t k = 0; k < count; k++) {
            const int64_t off = llabs(got[k].t - (int64_t)llround(start * 1e9) - wanted[k].t);
            assert_int_equal(got[k].polarity, wanted[k].polarity);
            if (off > worst) worst = off;
            on += wanted[k].polarity > 0;
        }
        all += count;
    }
    print_message("%-24s %zu events (%zu on), off by %lld ns at most\n", name, all, on, (long long)worst);
    assert_true(all > 200);
    assert_true(worst <= 2); /* start + t in doubles is good to half a nanosecond, as reads are, and times are floored */
    rig_free(r);
}

/* A single frame, which has no distance to a next one. */
static void expect_one(const tides_sensor *s, int steps) {
    td_kick kick;
    assert_int_equal(td_kick_make(s, start, &kick, NULL), TIDES_OK);
    assert_true(kick.count == 1 && kick.most == 2 * fabs(s->kick));
    assert_true(td_kick_next(&kick, 0, 0) == floor(1e9 * (3.26 - start)) + 0.5);
    td_kick_release(&kick);
    rig *r = rig_make(s, 1, start, ramp, NULL);
    rig_run(r, stop, steps);
    rig_free(r);
}

static void events_of_ramps(void **state) {
    (void)state;
    static const int steps[] = {5, 7, 50};
    for (size_t k = 0; k < 3; k++) {
        tides_sensor s = kicked(0.04);
        expect_plain("0.04, as measured", &s, steps[k]);
        s = kicked(0.5);
        expect_plain("several thresholds", &s, steps[k]);
        s = kicked(-0.3);
        expect_plain("downwards", &s, steps[k]);
        s.photoreceptor_cutoff_hz = pole_hz;
        expect_plain("behind a pole", &s, steps[k]);
        s = kicked(0.5);
        s.kick_times = path;
        write_times(listed);
        expect_plain("frames of a list", &s, steps[k]);
        write_times("3.26 alone");
        expect_one(&s, steps[k]);
    }
}

/* Reads at the very ends of steps: frames of 100 Hz, steps of 10 ms, row 0. */
static void commensurate(void **state) {
    (void)state;
    tides_sensor s = kicked(0.3);
    s.kick_rate_hz = 100;
    s.kick_first_s = start + 0.3e-9;
    s.kick_row_s = 0;
    s.kick_reads_s[1] = 0;
    expect_plain("at steps' ends", &s, 5);
    expect_plain("and not there", &s, 7);
}

/* With all that a pixel can have, how a run is cut into steps moves no event by more than a nanosecond's rounding. */
static void with_noise(void **state) {
    (void)state;
    enum { ROOM = 2000 };
    tides_sensor s = kicked(0.1);
    rig *r[2];
    s.noise_rms = 0.03;
    s.noise_cutoff_hz = 300;
    s.leak_rate_hz = 10;
    s.refractory_s = 1e-3;
    s.seed = SEED;
    for (int k = 0; k < 2; k++) {
        r[k] = rig_make(&s, 1, start, ramp, NULL);
        rig_run(r[k], stop, k ? 31 : 5);
    }
    size_t all = 0;
    for (int i = 0; i < RIG_PIXELS; i++) {
        tides_event a[ROOM], b[ROOM];
        const size_t count = rig_events(r[0], i % RIG_WIDTH, i / RIG_WIDTH, a, ROOM);
        assert_int_equal(rig_events(r[1], i % RIG_WIDTH, i / RIG_WIDTH, b, ROOM), count);
        for (size_t k = 0; k < count; k++) {
            assert_int_equal(a[k].polarity, b[k].polarity);
            assert_true(llabs(a[k].t - b[k].t) <= 1);
        }
        all += count;
    }
    print_message("%zu events\n", all);
    assert_true(all > 500);
    rig_free(r[0]);
    rig_free(r[1]);
}

static void refused(void **state) {
    (void)state;
    static const struct {
        const char *name;
        size_t at;
        double bad;
    } rows[] = {{"kick ", offsetof(tides_sensor, kick), NAN},
                {"kick_recovery_s", offsetof(tides_sensor, kick_recovery_s), 0},
                {"kick_recovery_s", offsetof(tides_sensor, kick_recovery_s), 0.5},
                {"kick_rate_hz", offsetof(tides_sensor, kick_rate_hz), 0},
                {"kick_first_s", offsetof(tides_sensor, kick_first_s), INFINITY},
                {"kick_row_s", offsetof(tides_sensor, kick_row_s), -1},
                {"kick_reads_s", offsetof(tides_sensor, kick_reads_s), -1}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        tides_sensor s = kicked(0.04);
        td_kick kick;
        tides_error error = {TIDES_OK, ""};
        memcpy((char *)&s + rows[i].at, &rows[i].bad, sizeof rows[i].bad);
        assert_int_equal(td_kick_make(&s, 0, &kick, &error), TIDES_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, rows[i].name));
    }
    static const struct {
        const char *text, *said;
    } files[] = {{"", "no times"},
                 {"# only this", "no times"},
                 {"1\n2 b\nb 3", ":3: "},
                 {"1\n\n1", ":3: 1 s isn't after"},
                 {"2\n1.5", ":2: 1.5 s isn't after"},
                 {"1x", ":1: "},
                 {"nan", ":1: "},
                 {"1e11", ":1: "},
                 {"1\n1.0001", "kick_recovery_s is 0.002, more than ten frames where those of kick_times are nearest"}};
    for (size_t i = 0; i <= sizeof files / sizeof files[0]; i++) {
        tides_sensor s = kicked(0.04);
        td_kick kick;
        tides_error error = {TIDES_OK, ""};
        const int absent = i == sizeof files / sizeof files[0];
        s.kick_times = absent ? "/nowhere/times" : path;
        if (!absent) write_times(files[i].text);
        const tides_status status = td_kick_make(&s, 0, &kick, &error);
        assert_int_equal(status, absent ? TIDES_FILE_NOT_FOUND : i == 8 ? TIDES_BAD_ARGUMENT : TIDES_BAD_FILE);
        assert_non_null(strstr(error.text, absent ? "/nowhere/times" : files[i].said));
        assert_null(kick.listed);
        s.kick = 0; /* the file is checked whether or not kicks are on; off, its times are compared with nothing */
        assert_int_equal(td_kick_make(&s, 0, &kick, &error), i == 8 ? TIDES_OK : status);
        assert_null(kick.listed);
    }
    tides_sensor s = kicked(0.04);
    td_sensor sensor;
    const td_tile tile = {0, 0, 1, 1};
    tides_error error = {TIDES_OK, ""};
    s.bandwidth = TIDES_BANDWIDTH_CIRCUIT;
    assert_int_equal(td_sensor_create(&s, TIDES_MODEL_HERMITE, 1e-3, 0, &(const td_sensor_tiles){&tile, 1, 1}, &sensor, &error),
                     TIDES_UNSUPPORTED);
    assert_non_null(strstr(error.text, "kick"));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(sums), cmocka_unit_test(events_of_ramps),
                                       cmocka_unit_test(commensurate), cmocka_unit_test(with_noise), cmocka_unit_test(refused)};
    return cmocka_run_group_tests(tests, make_file, remove_file);
}
