/* The centre-surround against closed forms and against a direct integration of its equation. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "sensor/surround/td_surround.h"
#include "tests/support/scene_make.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t SEED = 812;
static const double pi = 3.14159265358979323846;
enum { WIDTH = 13, HEIGHT = 10, PIXELS = WIDTH * HEIGHT };

static void expect_close(double found, double wanted, double off) {
    if (!(fabs(found - wanted) <= off)) fail_msg("%.17g is not within %g of %.17g", found, off, wanted);
}

static td_surround make(double lambda, double tau, double tolerance) {
    td_surround s;
    tides_sensor sensor;
    tides_error error;
    tides_sensor_defaults(&sensor);
    sensor.surround_lambda_px = lambda;
    sensor.surround_tau_s = tau;
    scene_expect_ok(td_surround_create(&sensor, WIDTH, HEIGHT, tolerance, &s, &error), &error);
    return s;
}

static void begin(td_surround *s, double length, const double *from_dot, const double *p, const double *p_dot) {
    double *next, *next_dot;
    td_surround_next_input(s, &next, &next_dot);
    memcpy(next, p, PIXELS * sizeof *next);
    memcpy(next_dot, p_dot, PIXELS * sizeof *next);
    td_surround_begin(s, length, from_dot);
}

static void random_image(uint64_t *seed, double scale, double *image) {
    for (int i = 0; i < PIXELS; i++) image[i] = scale * scene_between(seed, -1, 1);
}

/* -- the transform --------------------------------------------------------------------------------------------------------- */

/* There and back, energy kept, and the Laplacian is diagonal: sizes that divide nothing. */
static void test_cosine(void **state) {
    static const int sizes[][2] = {{1, 1}, {1, 7}, {5, 1}, {17, 19}, {64, 33}};
    uint64_t seed = SEED;
    (void)state;
    for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++) {
        td_dct c;
        int count = sizes[n][0] * sizes[n][1];
        double *image = calloc(3 * (size_t)count, sizeof *image), *modes = image + count, *again = modes + count, energy = 0;
        assert_non_null(image);
        assert_int_equal(td_dct_create(sizes[n][0], sizes[n][1], &c, NULL), TIDES_OK);
        for (int i = 0; i < count; i++) image[i] = scene_between(&seed, -1, 1);
        td_dct_forward(&c, image, modes);
        td_dct_back(&c, modes, again);
        for (int i = 0; i < count; i++) {
            expect_close(again[i], image[i], 1e-13);
            energy += image[i] * image[i] - modes[i] * modes[i];
        }
        expect_close(energy, 0, 1e-11);
        td_dct_release(&c);
        free(image);
    }
}

/* -- closed forms ---------------------------------------------------------------------------------------------------------- */

/* One mode of the image, j along y and k along x; its rate is 1 + lambda^2 mu. */
static double one_mode(int j, int k, double *image) {
    for (int i = 0; i < PIXELS; i++) {
        const int row = i / WIDTH, column = i % WIDTH;
        image[i] = cos(pi * j * (row + 0.5) / HEIGHT) * cos(pi * k * (column + 0.5) / WIDTH);
    }
    return 4 - 2 * cos(pi * j / HEIGHT) - 2 * cos(pi * k / WIDTH);
}

/* A mode that rested at 1 ramps up by 20/s for 30 ms: h = 1/r + 20/r (t - tau/r (1 - e^(-r t / tau))). */
static void check_ramp(int j, int k, double lambda, double tau) {
    static const double slope = 20, length = 0.03;
    double mode[PIXELS], rates[PIXELS], end[PIXELS], zero[PIXELS] = {0}, from, to;
    double r = 1 + lambda * lambda * one_mode(j, k, mode);
    double rounding = 1e-10 + 5e-16 * (1 + 8 * lambda * lambda) / (tau > 0 ? tau : 1);
    td_surround s = make(lambda, tau, 1e-3);
    td_surround_sample a, b;
    td_surround_rest(&s, mode, zero);
    a = s.end;
    for (int i = 0; i < PIXELS; i++) {
        expect_close(a.S[i], mode[i] * (1 - 1 / r), 1e-13);
        rates[i] = slope * mode[i];
        end[i] = mode[i] * (1 + slope * length);
    }
    begin(&s, length, rates, end, rates);
    double reached = 0;
    while (td_surround_next(&s, &from, &to, &a, &b)) {
        assert_true(from == reached && to > from);
        reached = to;
        double t = to * length, lag = tau > 0 ? -expm1(-r * t / tau) : 0;
        double h = 1 / r + slope / r * (t - tau / r * lag), h_dot = slope / r * (tau > 0 ? lag : 1);
        for (int i = 0; i < PIXELS; i++) {
            expect_close(b.S[i], mode[i] * (1 + slope * t - h), 1e-12);
            expect_close(b.S_dot[i], mode[i] * (slope - h_dot), rounding);
            expect_close(b.p[i], mode[i] * (1 + slope * t), 1e-12);
        }
        if (from == 0)
            for (int i = 0; i < PIXELS; i++) expect_close(a.S_dot[i], mode[i] * slope * (tau > 0 ? 1 : 1 - 1 / r), rounding);
    }
    assert_true(reached == 1);
    td_surround_release(&s);
}

static void test_modes(void **state) {
    static const double taus[] = {0, 1e-9, 1e-5, 2e-3, 0.05, 10};
    (void)state;
    for (size_t n = 0; n < sizeof taus / sizeof *taus; n++) {
        check_ramp(0, 0, 3, taus[n]);
        check_ramp(2, 5, 1.5, taus[n]);
        check_ramp(HEIGHT - 1, WIDTH - 1, 8, taus[n]);
    }
}

/* -- any image ------------------------------------------------------------------------------------------------------------- */

/* h' of the equation, written out pixel by pixel. */
static void rate_of(const double *p, const double *h, double lambda, double tau, double *h_dot) {
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            int i = y * WIDTH + x;
            double sum = 0;
            if (x > 0) sum += h[i - 1] - h[i];
            if (x < WIDTH - 1) sum += h[i + 1] - h[i];
            if (y > 0) sum += h[i - WIDTH] - h[i];
            if (y < HEIGHT - 1) sum += h[i + WIDTH] - h[i];
            h_dot[i] = (p[i] - h[i] + lambda * lambda * sum) / tau;
        }
}

typedef struct cubic_image {
    double p0[PIXELS], p0_dot[PIXELS], p1[PIXELS], p1_dot[PIXELS], length;
} cubic_image;

static void image_at(const cubic_image *c, double t, double *p) {
    double s = t / c->length, r = 1 - s;
    for (int i = 0; i < PIXELS; i++)
        p[i] = r * r * (1 + 2 * s) * c->p0[i] + s * s * (1 + 2 * r) * c->p1[i] +
               c->length * (s * r * r * c->p0_dot[i] - s * s * r * c->p1_dot[i]);
}

/* The classical Runge-Kutta method over [from, to]. */
static void integrate(const cubic_image *c, double from, double to, double lambda, double tau, double *h) {
    enum { STEPS = 400 };
    static double p[3][PIXELS], k[4][PIXELS], at[PIXELS];
    double step = (to - from) / STEPS;
    for (int n = 0; n < STEPS; n++) {
        for (int m = 0; m < 3; m++) image_at(c, from + (n + 0.5 * m) * step, p[m]);
        rate_of(p[0], h, lambda, tau, k[0]);
        for (int i = 0; i < PIXELS; i++) at[i] = h[i] + step / 2 * k[0][i];
        rate_of(p[1], at, lambda, tau, k[1]);
        for (int i = 0; i < PIXELS; i++) at[i] = h[i] + step / 2 * k[1][i];
        rate_of(p[1], at, lambda, tau, k[2]);
        for (int i = 0; i < PIXELS; i++) at[i] = h[i] + step * k[2][i];
        rate_of(p[2], at, lambda, tau, k[3]);
        for (int i = 0; i < PIXELS; i++) h[i] += step / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
    }
}

static cubic_image random_cubic(uint64_t *seed) {
    cubic_image c = {.length = 0.01};
    random_image(seed, 1, c.p0);
    random_image(seed, 100, c.p0_dot);
    random_image(seed, 1, c.p1);
    random_image(seed, 100, c.p1_dot);
    return c;
}

static double worst_cubic(const td_surround_sample *a, const td_surround_sample *b, double length, const double *S, double s) {
    double worst = 0, r = 1 - s;
    for (int i = 0; i < PIXELS; i++) {
        double cubic = r * r * ((1 + 2 * s) * a->S[i] + s * length * a->S_dot[i]) +
                       s * s * ((1 + 2 * r) * b->S[i] - r * length * b->S_dot[i]);
        worst = fmax(worst, fabs(cubic - S[i]));
    }
    return worst;
}

/* Values at pieces' ends are those of the equation, and between them cubics are as near as asked; a step that the modes' bound
 * lets pass as a whole is one piece, sixteen times as near. */
static void test_equation(void **state) {
    static const double tolerance = 1e-3;
    uint64_t seed = SEED;
    (void)state;
    for (int trial = 0; trial < 4; trial++) {
        static const double taus[] = {0.02, 2e-3, 4e-4, 0.02};
        cubic_image c = random_cubic(&seed);
        for (int i = 0; i < PIXELS && trial == 3; i++) { /* hardly anything changes */
            c.length = 1e-4;
            c.p1[i] = c.p0[i] + 1e-3 * c.p1[i];
            c.p0_dot[i] *= 0.1;
            c.p1_dot[i] *= 0.1;
        }
        double lambda = 1.7, tau = taus[trial], h[PIXELS], S[PIXELS], from, to, off = 0, missed = 0;
        td_surround s = make(lambda, tau, tolerance);
        td_surround_sample a, b;
        td_surround_rest(&s, c.p0, c.p0_dot);
        a = s.end;
        for (int i = 0; i < PIXELS; i++) h[i] = c.p0[i] - a.S[i];
        begin(&s, c.length, c.p0_dot, c.p1, c.p1_dot);
        int pieces = 0;
        for (; td_surround_next(&s, &from, &to, &a, &b); pieces++) {
            static const double parts[] = {0.25, 0.5, 0.8, 1};
            double at = from;
            for (int k = 0; k < 4; k++) {
                double next = from + (to - from) * parts[k], p[PIXELS];
                integrate(&c, at * c.length, next * c.length, lambda, tau, h);
                image_at(&c, next * c.length, p);
                for (int i = 0; i < PIXELS; i++) S[i] = p[i] - h[i];
                missed = fmax(missed, worst_cubic(&a, &b, (to - from) * c.length, S, parts[k]));
                at = next;
            }
            for (int i = 0; i < PIXELS; i++) off = fmax(off, fabs(S[i] - b.S[i]));
        }
        print_message("tau %g s: %d pieces, ends off by %.2g, cubics by %.2g\n", tau, pieces, off, missed);
        assert_true(off < 1e-9 && missed < tolerance);
        if (trial == 3) assert_true(pieces == 1 && missed < tolerance / 16);
        if (trial == 2) assert_true(pieces > 2);
        td_surround_release(&s);
    }
}

/* A step cut in two, and a run that was saved and goes on, end where the whole one does. */
static void test_cuts(void **state) {
    uint64_t seed = SEED + 1;
    cubic_image c = random_cubic(&seed);
    double half[PIXELS], half_dot[PIXELS], from, to;
    (void)state;
    image_at(&c, 0.3 * c.length, half);
    for (int i = 0; i < PIXELS; i++) { /* the cubic's own rate, exactly */
        double x = 0.3, y = 0.7;
        half_dot[i] =
            6 * x * y * (c.p1[i] - c.p0[i]) / c.length + y * (1 - 3 * x) * c.p0_dot[i] + x * (3 * x - 2) * c.p1_dot[i];
    }
    td_surround whole = make(2.5, 1e-3, 1e-4), cut = make(2.5, 1e-3, 1e-4), saved = make(2.5, 1e-3, 1e-4);
    td_surround_sample a, b, x, y;
    td_surround_rest(&whole, c.p0, c.p0_dot);
    td_surround_rest(&cut, c.p0, c.p0_dot);
    begin(&whole, c.length, c.p0_dot, c.p1, c.p1_dot);
    while (td_surround_next(&whole, &from, &to, &a, &b)) {
    }
    begin(&cut, 0.3 * c.length, c.p0_dot, half, half_dot);
    while (td_surround_next(&cut, &from, &to, &x, &y)) {
    }
    td_surround_resume(&saved, cut.surround, half, half_dot);
    x = saved.end;
    assert_memory_equal(x.S, y.S, sizeof half);
    assert_memory_equal(x.S_dot, y.S_dot, sizeof half);
    begin(&cut, 0.7 * c.length, half_dot, c.p1, c.p1_dot);
    begin(&saved, 0.7 * c.length, half_dot, c.p1, c.p1_dot);
    while (td_surround_next(&cut, &from, &to, &x, &y)) {
        double again[2];
        td_surround_sample p, q;
        assert_int_equal(td_surround_next(&saved, &again[0], &again[1], &p, &q), 1);
        assert_true(again[0] == from && again[1] == to);
        assert_memory_equal(p.S, x.S, sizeof half);
        assert_memory_equal(q.S, y.S, sizeof half);
        assert_memory_equal(q.S_dot, y.S_dot, sizeof half);
    }
    for (int i = 0; i < PIXELS; i++) {
        expect_close(y.S[i], b.S[i], 1e-12);
        expect_close(y.S_dot[i], b.S_dot[i], 1e-8);
    }
    td_surround_release(&whole);
    td_surround_release(&cut);
    td_surround_release(&saved);
}

/* -- on the image ---------------------------------------------------------------------------------------------------------- */

/* td_diffuse against a mode's closed form: the ramp of check_ramp, at the part's middle and end, with one panel or several. */
static void test_diffuse_modes(void **state) {
    static const double lengths[] = {1e-6, 1e-4, 1e-3, 3e-3, 1e-2}, slope = 20, tau = 2e-3, lambda = 2;
    td_diffusion d;
    (void)state;
    assert_int_equal(td_diffusion_create(WIDTH, HEIGHT, &d, NULL), TIDES_OK);
    for (int k = 0; k < 3; k++)
        for (size_t n = 0; n < sizeof lengths / sizeof *lengths; n++) {
            static const int orders[][2] = {{0, 0}, {2, 5}, {HEIGHT - 1, WIDTH - 1}};
            double mode[PIXELS], rates[PIXELS], to[PIXELS], from[PIXELS], half[PIXELS], end[PIXELS], spare[PIXELS];
            const double r = 1 + lambda * lambda * one_mode(orders[k][0], orders[k][1], mode), length = lengths[n];
            for (int i = 0; i < PIXELS; i++) {
                rates[i] = slope * mode[i];
                from[i] = mode[i] / r;
                to[i] = mode[i] * (1 + slope * length);
            }
            const td_diffuse_part part = {{mode, rates, to, rates}, length, 0, 1, tau, lambda * lambda};
            td_diffuse(&d, &part, from, half, end, spare);
            for (int m = 1; m <= 2; m++) {
                const double t = 0.5 * m * length, h = 1 / r + slope / r * (t + tau / r * expm1(-r * t / tau));
                for (int i = 0; i < PIXELS; i++) expect_close(m == 1 ? half[i] : end[i], mode[i] * h, 1e-13);
            }
        }
    td_diffusion_release(&d);
}

/* td_diffuse against a direct integration, for any image and part of a step. */
static void test_diffuse_images(void **state) {
    uint64_t seed = SEED + 2;
    td_diffusion d;
    (void)state;
    assert_int_equal(td_diffusion_create(WIDTH, HEIGHT, &d, NULL), TIDES_OK);
    for (int trial = 0; trial < 8; trial++) {
        const cubic_image c = random_cubic(&seed);
        const double lambda = scene_between(&seed, 0.3, 3), tau = scene_between(&seed, 0.5e-3, 2e-2);
        const double s0 = scene_between(&seed, 0, 0.5), s1 = s0 + scene_between(&seed, 0.01, 0.1);
        const td_diffuse_part part = {{c.p0, c.p0_dot, c.p1, c.p1_dot}, c.length, s0, s1, tau, lambda * lambda};
        double from[PIXELS], half[PIXELS], end[PIXELS], spare[PIXELS], h[PIXELS];
        random_image(&seed, 1, from);
        memcpy(h, from, sizeof h);
        td_diffuse(&d, &part, from, half, end, spare);
        integrate(&c, s0 * c.length, 0.5 * (s0 + s1) * c.length, lambda, tau, h);
        for (int i = 0; i < PIXELS; i++) expect_close(half[i], h[i], 1e-9);
        integrate(&c, 0.5 * (s0 + s1) * c.length, s1 * c.length, lambda, tau, h);
        for (int i = 0; i < PIXELS; i++) expect_close(end[i], h[i], 1e-9);
    }
    td_diffusion_release(&d);
}

/* Images of one row or column, whose borders all repeat: as a wide image that is constant along the other direction. NaN stays
 * near its pixel's rows, and everything ends. */
static void test_diffuse_borders(void **state) {
    enum { LONG = 40, WIDE = 5 };
    double wide[6][LONG * WIDE], narrow[6][LONG];
    uint64_t seed = SEED + 3;
    (void)state;
    for (int i = 0; i < LONG * WIDE; i++)
        for (int k = 0; k < 6; k++) narrow[k][i / WIDE] = wide[k][i] = i % WIDE ? wide[k][i - 1] : scene_between(&seed, -1, 1);
    const td_diffuse_part of_wide = {{wide[0], wide[1], wide[2], wide[3]}, 1e-3, 0, 1, 2e-3, 3};
    for (int turned = 0; turned < 2; turned++) {
        const td_diffuse_part part = {{narrow[0], narrow[1], narrow[2], narrow[3]}, 1e-3, 0, 1, 2e-3, 3};
        double half[2][LONG * WIDE], end[2][LONG * WIDE], spare[LONG * WIDE];
        td_diffusion d, e;
        assert_int_equal(td_diffusion_create(WIDE, LONG, &d, NULL), TIDES_OK);
        assert_int_equal(td_diffusion_create(turned ? LONG : 1, turned ? 1 : LONG, &e, NULL), TIDES_OK);
        td_diffuse(&d, &of_wide, wide[4], half[0], end[0], spare);
        td_diffuse(&e, &part, narrow[4], half[1], end[1], spare);
        for (int i = 0; i < LONG; i++) expect_close(end[1][i], end[0][i * WIDE], 1e-14);
        for (int i = 0; i < LONG; i++) expect_close(half[1][i], half[0][i * WIDE], 1e-14);
        narrow[5][0] = narrow[4][LONG / 2];
        narrow[4][LONG / 2] = NAN;
        td_diffuse(&e, &part, narrow[4], half[1], end[1], spare);
        narrow[4][LONG / 2] = narrow[5][0];
        assert_true(isnan(end[1][LONG / 2]) && isfinite(narrow[4][LONG / 2]));
        td_diffusion_release(&d);
        td_diffusion_release(&e);
    }
}

static void test_refused(void **state) {
    static const double bad[][3] = {{-1, 1, 1},       {NAN, 1, 1}, {1, -1, 1}, {1, 1e-12, 1},
                                    {1, INFINITY, 1}, {1, NAN, 1}, {1, 1, 0}};
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        td_surround s;
        tides_error error;
        tides_sensor sensor;
        tides_sensor_defaults(&sensor);
        sensor.surround_lambda_px = bad[i][0];
        sensor.surround_tau_s = bad[i][1];
        assert_int_equal(td_surround_create(&sensor, WIDTH, HEIGHT, bad[i][2], &s, &error), TIDES_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, i < 2 ? "surround_lambda_px" : i < 6 ? "surround_tau_s" : "tolerance"));
    }
}

int main(void) {
    print_message("seed %d\n", (int)SEED);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cosine),          cmocka_unit_test(test_modes),
        cmocka_unit_test(test_equation),        cmocka_unit_test(test_cuts),
        cmocka_unit_test(test_diffuse_modes),   cmocka_unit_test(test_diffuse_images),
        cmocka_unit_test(test_diffuse_borders), cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
