/* Pictures of data: known values have known colours, special values stand out, and nothing is drawn outside the picture. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "image/td_font.h"
#include "tides/image.h"

static void assert_colour(const uint8_t *rgb, int r, int g, int b) {
    if (rgb[0] != r || rgb[1] != g || rgb[2] != b) fail_msg("%d %d %d, expected %d %d %d", rgb[0], rgb[1], rgb[2], r, g, b);
}

static void test_grey(void **state) {
    (void)state;
    /* 0.2158605 is the linear value of sRGB 128; 0.002 lies on the transfer's straight part. */
    const double values[] = {0.0, 2.0, 0.431721, 0.004, -1.0, INFINITY, -INFINITY, NAN};
    const int expected[] = {0, 255, 128, 7, 0, 255, 0};
    uint8_t rgb[24];
    tides_picture_grey(values, 4, 2, 2.0, rgb);
    for (int i = 0; i < 7; i++) assert_colour(rgb + 3 * i, expected[i], expected[i], expected[i]);
    assert_colour(rgb + 21, 255, 0, 255);
    tides_picture_grey((const double[]){1.0}, 1, 1, 0.0, rgb); /* no white: 1 */
    assert_colour(rgb, 255, 255, 255);
}

static void test_rgb(void **state) {
    (void)state;
    const double r[] = {1.0, 0.0, NAN}, g[] = {0.0, 0.2158605, 0.0}, b[] = {0.5, 5.0, 0.0};
    uint8_t rgb[9];
    tides_picture_rgb(r, g, b, 3, 1, rgb);
    assert_colour(rgb, 255, 0, 188);
    assert_colour(rgb + 3, 0, 128, 255);
    assert_colour(rgb + 6, 255, 0, 255);
}

static int lightness(const uint8_t *rgb) { return 2 * rgb[0] + 7 * rgb[1] + rgb[2]; }

static void test_signed(void **state) {
    (void)state;
    enum { N = 201 };
    double values[N];
    uint8_t rgb[3 * N];
    for (int i = 0; i < N; i++) values[i] = (i - 100) * 0.02; /* -2 to 2 */
    tides_picture_signed(values, N, 1, 2.0, rgb);
    assert_colour(rgb + 3 * 100, 246, 246, 246);
    for (int i = 1; i < N; i++) /* darker towards both ends, step by step */
        if (i <= 100)
            assert_true(lightness(rgb + 3 * i) >= lightness(rgb + 3 * i - 3));
        else
            assert_true(lightness(rgb + 3 * i) <= lightness(rgb + 3 * i - 3));
    assert_true(rgb[2] > rgb[0] + 100);                        /* -2 is blue */
    assert_true(rgb[3 * (N - 1)] > rgb[3 * (N - 1) + 2] + 50); /* 2 is red */
    uint8_t far[9];
    tides_picture_signed((const double[]){-1e300, INFINITY, NAN}, 3, 1, 2.0, far);
    assert_memory_equal(far, rgb, 3);
    assert_memory_equal(far + 3, rgb + 3 * (N - 1), 3);
    assert_colour(far + 6, 255, 0, 255);
}

static void test_flow(void **state) {
    (void)state;
    const double u[] = {2, 0, -2, 1, 0, 4, NAN}, v[] = {0, 2, 0, 0, 0, 0, 1};
    uint8_t rgb[21], automatic[3];
    tides_picture_flow(u, v, 7, 1, 2, rgb);
    assert_colour(rgb, 255, 0, 0);
    assert_colour(rgb + 3, 128, 255, 0);
    assert_colour(rgb + 6, 0, 255, 255);
    assert_colour(rgb + 9, 255, 128, 128);
    assert_colour(rgb + 12, 255, 255, 255);
    assert_colour(rgb + 15, 191, 0, 0);
    assert_colour(rgb + 18, 255, 0, 255);
    tides_picture_flow(u + 5, v + 5, 1, 1, 0, automatic);
    assert_colour(automatic, 255, 0, 0);
    tides_picture_flow(u + 4, v + 4, 1, 1, 0, automatic); /* nothing moves */
    assert_colour(automatic, 255, 255, 255);
}

static void test_depth(void **state) {
    (void)state;
    const double depth[] = {1, 3, 2, 0, NAN};
    uint8_t rgb[15], ranged[15];
    tides_picture_depth(depth, 5, 1, 0, 0, rgb);
    assert_colour(rgb, 255, 242, 160);
    assert_colour(rgb + 3, 30, 19, 104);
    assert_colour(rgb + 6, 3, 145, 151);
    assert_colour(rgb + 9, 0, 0, 0);
    assert_colour(rgb + 12, 255, 0, 255);
    tides_picture_depth(depth, 5, 1, 1, 3, ranged);
    assert_memory_equal(ranged, rgb, sizeof rgb);
    tides_picture_depth(depth, 1, 1, 0, 0, ranged); /* a single depth */
    assert_colour(ranged, 255, 242, 160);
}

/* A key says what its picture's colours are: the wheel's as tides_picture_flow draws that way and speed, the ramp's as depths
 * from near to far; the rest stays, and small pictures are left alone. */
static void test_keys(void **state) {
    (void)state;
    enum { WIDTH = 120, HEIGHT = 90, SIZE = 15, LEFT = WIDTH - SIZE - 3, TOP = HEIGHT - SIZE - 3 };
    static uint8_t rgb[3 * WIDTH * HEIGHT], before[3 * WIDTH * HEIGHT];
    memset(before, 77, sizeof before);
    memcpy(rgb, before, sizeof rgb);
    tides_picture_flow_key(rgb, WIDTH, HEIGHT);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const double u = x + 0.5 - (LEFT + 7.5), v = y + 0.5 - (TOP + 7.5), far = hypot(u, v) / 7.5;
            const uint8_t *here = rgb + 3 * (y * WIDTH + x);
            uint8_t expected[3];
            tides_picture_flow(&u, &v, 1, 1, 7.5, expected);
            if (far < 0.8) assert_memory_equal(here, expected, 3);
            if (far > 1.01) assert_memory_equal(here, before, 3);
        }
    memcpy(rgb, before, sizeof rgb);
    tides_picture_depth_key(rgb, WIDTH, HEIGHT);
    const uint8_t *row = rgb + 3 * ((HEIGHT - 4) * WIDTH); /* the ramp is 30 x 3 px: its middle row */
    uint8_t ends[6];
    tides_picture_depth((const double[]){1 + 1.0 / 29, 1 + 28.0 / 29}, 2, 1, 1, 2, ends);
    assert_memory_equal(row - 3 * WIDTH + 3 * (WIDTH - 33 + 1), ends, 3);
    assert_memory_equal(row - 3 * WIDTH + 3 * (WIDTH - 33 + 28), ends + 3, 3);
    assert_memory_equal(rgb, before, 3 * WIDTH * (HEIGHT - 8));
    memcpy(rgb, before, sizeof rgb);
    tides_picture_flow_key(rgb, 63, 90);
    tides_picture_depth_key(rgb, 90, 63);
    assert_memory_equal(rgb, before, sizeof rgb);
}

static void test_labels(void **state) {
    (void)state;
    const double labels[] = {0, 1, 0, -1, NAN, 1e6};
    uint8_t rgb[18];
    tides_picture_labels(labels, 6, 1, rgb);
    assert_memory_equal(rgb, rgb + 6, 3);
    assert_true(memcmp(rgb, rgb + 3, 3) != 0 && memcmp(rgb, rgb + 15, 3) != 0);
    assert_colour(rgb + 9, 0, 0, 0);
    assert_colour(rgb + 12, 255, 0, 255);
}

static int by_magnitude(const void *a, const void *b) {
    double x = fabs(*(const double *)a), y = fabs(*(const double *)b);
    return x < y ? -1 : x > y;
}

/* Limit 0 must paint what the percentile, found by sorting, paints. */
static void test_percentile(void **state) {
    (void)state;
    enum { W = 61, H = 47, N = W * H };
    static double values[N], sorted[N];
    static uint8_t automatic[3 * N], explicit[3 * N];
    srand(12);
    for (int scale = -30; scale <= 30; scale += 10) {
        for (int i = 0; i < N; i++) {
            /* Floats, as renders are, so that the percentile is exact. */
            double uniform = rand() / (double)RAND_MAX - 0.4;
            values[i] = (double)(float)(uniform * uniform * uniform * pow(10.0, scale));
        }
        memcpy(sorted, values, sizeof sorted);
        qsort(sorted, N, sizeof *sorted, by_magnitude);
        double limit = fabs(sorted[(size_t)(0.995 * (N - 1))]);
        tides_picture_signed(values, W, H, limit, explicit);
        tides_picture_signed(values, W, H, 0.0, automatic);
        assert_memory_equal(automatic, explicit, sizeof automatic);
        tides_picture_signed(values, W, H, NAN, automatic);
        assert_memory_equal(automatic, explicit, sizeof automatic);
    }
}

static void test_percentile_of_odd_images(void **state) {
    (void)state;
    uint8_t rgb[3 * 1000];
    double values[1000] = {0};
    tides_picture_signed(values, 100, 10, 0.0, rgb); /* all 0: all white */
    for (int i = 0; i < 1000; i++) assert_colour(rgb + 3 * i, 246, 246, 246);
    values[7] = -3.0; /* one pixel moves: it must be seen */
    tides_picture_signed(values, 100, 10, 0.0, rgb);
    assert_true(rgb[23] > rgb[21] + 100);
    assert_colour(rgb + 24, 246, 246, 246);
    for (int i = 0; i < 1000; i++) values[i] = i % 2 ? NAN : -INFINITY;
    tides_picture_signed(values, 100, 10, 0.0, rgb); /* nothing finite */
    assert_true(rgb[2] > rgb[0] + 100);
    assert_colour(rgb + 3, 255, 0, 255);
    tides_picture_signed(values, 0, 10, 0.0, NULL);
}

static void test_events(void **state) {
    (void)state;
    tides_event events[600];
    size_t n = 0;
    for (int i = 0; i < 1; i++) events[n++] = (tides_event){.x = 0, .y = 0, .polarity = 1};
    for (int i = 0; i < 4; i++) events[n++] = (tides_event){.x = 1, .y = 0, .polarity = 1};
    for (int i = 0; i < 1; i++) events[n++] = (tides_event){.x = 0, .y = 1, .polarity = -1};
    for (int i = 0; i < 400; i++) events[n++] = (tides_event){.x = 1, .y = 1, .polarity = -1};
    for (int i = 0; i < 2; i++) events[n++] = (tides_event){.x = 2, .y = 0, .polarity = i ? 1 : -1};
    events[n++] = (tides_event){.x = 3, .y = 0, .polarity = 1}; /* outside */
    events[n++] = (tides_event){.x = 0, .y = 2, .polarity = 1};
    uint8_t rgb[3 * 6 + 3];
    memset(rgb, 7, sizeof rgb);
    tides_picture_events(events, n, NULL, 3, 2, rgb);
    const uint8_t *on = rgb, *on4 = rgb + 3, *both = rgb + 6, *off = rgb + 9, *off400 = rgb + 12, *none = rgb + 15;
    assert_true(on[0] > on[2] + 80);
    assert_true(on[0] > on[1] + 80);
    assert_true(on4[0] > on[0]);
    assert_true(off[2] > off[0] + 80);
    assert_true(off400[2] > off[2]);
    assert_true(off400[1] > off[1]);
    assert_true(both[0] > both[1] + 20);
    assert_true(both[2] > both[1] + 20); /* violet */
    assert_colour(none, 140, 140, 140);
    assert_colour(rgb + 18, 7, 7, 7);
    const double base[] = {0.0, 1.0, NAN, 0.0, 0.0, -4.0};
    tides_picture_events(events, 0, base, 3, 2, rgb);
    assert_colour(rgb, 120, 120, 120);
    assert_colour(rgb + 3, 180, 180, 180);
    assert_colour(rgb + 6, 140, 140, 140);
    assert_colour(rgb + 15, 120, 120, 120);
    /* An event alone, of either polarity, is darker than any ground: its luma, of Rec. 601, by 30 and more. */
    const tides_event single[] = {{.x = 0, .y = 0, .polarity = 1}, {.x = 1, .y = 0, .polarity = -1}};
    for (int ground = 0; ground < 3; ground++) {
        const double bases[] = {0.5 * ground, 0.5 * ground, 0.5 * ground, 0, 0, 0};
        tides_picture_events(single, 2, bases, 3, 2, rgb);
        for (int k = 0; k < 2; k++)
            assert_true(0.299 * rgb[3 * k] + 0.587 * rgb[3 * k + 1] + 0.114 * rgb[3 * k + 2] < rgb[6] - 30);
    }
}

/* ---- text ---- */

static void test_font_is_complete(void **state) {
    (void)state;
    for (int c = 33; c < 127; c++) {
        int cells = 0;
        for (int row = 0; row < TD_GLYPH_HEIGHT; row++) {
            assert_true(td_glyph((char)c)[row] < 32);
            for (int bit = 0; bit < 5; bit++) cells += td_glyph((char)c)[row] >> bit & 1;
        }
        if (cells < 3) fail_msg("'%c' is empty", c);
        for (int other = 33; other < c; other++)
            if (memcmp(td_glyph((char)c), td_glyph((char)other), TD_GLYPH_HEIGHT) == 0) fail_msg("'%c' is '%c'", c, other);
    }
    assert_int_equal(td_glyph((char)200)[0], 0x1f);
    assert_int_equal(td_glyph('\x7f')[1], 0x11);
}

static void test_text(void **state) {
    (void)state;
    enum { W = 20, H = 20 };
    const uint8_t colour[] = {9, 8, 7};
    uint8_t rgb[3 * W * H] = {0};
    tides_picture_text(rgb, W, H, 1, 2, 1, colour, "LI\nL");
    for (int y = 0; y < 7; y++) assert_colour(rgb + 3 * ((2 + y) * W + 1), 9, 8, 7); /* the stem of L */
    assert_colour(rgb + 3 * (8 * W + 5), 9, 8, 7);                                   /* the end of its foot */
    assert_colour(rgb + 3 * (2 * W + 2), 0, 0, 0);
    assert_colour(rgb + 3 * (3 * W + 9), 9, 8, 7);  /* the stem of I, 6 cells on */
    assert_colour(rgb + 3 * (11 * W + 1), 9, 8, 7); /* the second line, 9 cells down */
    memset(rgb, 0, sizeof rgb);
    tides_picture_text(rgb, W, H, 0, 0, 2, colour, "L");
    assert_colour(rgb + 3 * (13 * W + 9), 9, 8, 7);
    assert_colour(rgb + 3 * (14 * W), 0, 0, 0);
}

/* Wherever the text lies and however large it is: inside the guards, and the sanitizer watches. */
static void test_text_is_clipped(void **state) {
    (void)state;
    enum { W = 9, H = 8, GUARD = 64 };
    const uint8_t colour[] = {1, 1, 1};
    uint8_t memory[GUARD + 3 * W * H + GUARD];
    const int32_t places[] = {INT32_MIN, -100, -7, -3, 0, 4, 8, 9, 100, INT32_MAX};
    for (size_t i = 0; i < 10; i++)
        for (size_t j = 0; j < 10; j++)
            for (int32_t scale = -1; scale < 4; scale++) {
                memset(memory, 0, sizeof memory);
                tides_picture_text(memory + GUARD, W, H, places[i], places[j], scale, colour, "W#\n\xc3\xa4");
                for (int g = 0; g < GUARD; g++) assert_true(memory[g] == 0 && memory[GUARD + 3 * W * H + g] == 0);
            }
    tides_picture_text(memory + GUARD, W, H, -1000, -1000, INT32_MAX, colour, "##"); /* one cell covers all, or none does */
    tides_picture_text(NULL, 0, 0, 0, 0, 1, colour, "text");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grey),
        cmocka_unit_test(test_rgb),
        cmocka_unit_test(test_signed),
        cmocka_unit_test(test_flow),
        cmocka_unit_test(test_depth),
        cmocka_unit_test(test_labels),
        cmocka_unit_test(test_keys),
        cmocka_unit_test(test_percentile),
        cmocka_unit_test(test_percentile_of_odd_images),
        cmocka_unit_test(test_events),
        cmocka_unit_test(test_font_is_complete),
        cmocka_unit_test(test_text),
        cmocka_unit_test(test_text_is_clipped),
    };
    return cmocka_run_group_tests_name("image: pictures", tests, NULL, NULL);
}
