/* Points that are computed together: each one is in exactly one group, and a group is close in pixels and in time. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/td_random.h"
#include "render/td_point_order.h"

#include <string.h>

enum { LANES = 8, MOST = 300 };

static void draw(uint64_t seed, td_point_place *places, int count) {
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < TD_PLACE_AXES; k++) {
            const td_random_bits bits = td_random(seed, (uint32_t)i, (uint64_t)k, 0);
            places[i].at[k] = (uint8_t)(TD_PLACE_STEPS * td_random_uniform(&bits, 0));
        }
        places[i].which = i;
    }
}

/* Pixels of the boxes about those that go together, in all. */
static int boxes(const td_point_place *places, int count) {
    int all = 0;
    for (int from = 0; from < count; from += LANES) {
        int low[2] = {TD_PLACE_STEPS, TD_PLACE_STEPS}, high[2] = {0, 0};
        for (int i = from; i < from + LANES && i < count; i++)
            for (int k = 0; k < 2; k++) {
                low[k] = places[i].at[k] < low[k] ? places[i].at[k] : low[k];
                high[k] = places[i].at[k] > high[k] ? places[i].at[k] : high[k];
            }
        all += (high[0] - low[0] + 1) * (high[1] - low[1] + 1);
    }
    return all;
}

static void test_each_goes_once(void **state) {
    (void)state;
    td_point_place places[MOST], room[MOST], drawn[MOST];
    for (int count = 0; count <= MOST; count += 1 + count / 7) {
        uint8_t seen[MOST] = {0};
        draw((uint64_t)count, drawn, count);
        memcpy(places, drawn, (size_t)count * sizeof *places);
        td_point_gather(places, room, count, LANES);
        for (int i = 0; i < count; i++) {
            assert_int_equal(seen[places[i].which]++, 0);
            assert_memory_equal(places[i].at, drawn[places[i].which].at, TD_PLACE_AXES);
        }
    }
}

/* A tile of 256 pixels, 30 groups of eight: boxes of 20 pixels are near what can be had, in the order drawn they have 180. */
static void test_neighbours_go_together(void **state) {
    (void)state;
    enum { COUNT = 30 * LANES };
    td_point_place places[COUNT], room[COUNT];
    draw(7, places, COUNT);
    assert_true(boxes(places, COUNT) > 30 * 120);
    td_point_gather(places, room, COUNT, LANES);
    assert_in_range(boxes(places, COUNT), 30 * 4, 30 * 20);
}

/* Tiles are ordered each by itself, with any number of threads. */
static void test_tiles_on_threads(void **state) {
    enum { TILES = 40, MANY = 9000 };
    static const int threads[] = {0, 1, 2, 7};
    static td_point_place drawn[MANY], places[MANY], room[MANY], expected[MANY];
    static int order[MANY];
    int end[TILES];
    (void)state;
    draw(9, drawn, MANY);
    for (int t = 0; t < TILES; t++) /* some have none, some few, the last ones many */
        end[t] = t % 5 == 1 ? end[t - 1] : t == TILES - 1 ? MANY : t * t * 5;
    memcpy(expected, drawn, sizeof expected);
    for (int t = 0, first = 0; t < TILES; first = end[t++]) td_point_gather(expected + first, room, end[t] - first, LANES);
    for (size_t i = 0; i < sizeof threads / sizeof *threads; i++) {
        td_pool *pool = NULL;
        const td_point_tiles all = {places, room, end, TILES, MANY, LANES};
        if (threads[i] > 0) assert_int_equal(td_pool_create(threads[i], &pool, NULL), TIDES_OK);
        memcpy(places, drawn, sizeof places);
        memset(order, -1, sizeof order);
        td_point_gather_all(pool, &all, order);
        for (int k = 0; k < MANY; k++) assert_int_equal(order[k], expected[k].which);
        td_pool_release(pool);
    }
}

/* Points of one pixel go by time. */
static void test_one_pixel_by_time(void **state) {
    (void)state;
    enum { COUNT = 4 * LANES };
    td_point_place places[COUNT], room[COUNT];
    for (int i = 0; i < COUNT; i++) places[i] = (td_point_place){{3, 5, (uint8_t)((7 * i) % TD_PLACE_STEPS)}, i};
    td_point_gather(places, room, COUNT, LANES);
    for (int i = 0; i < COUNT; i++) assert_int_equal(places[i].at[2] / 4, i / LANES);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_each_goes_once),
        cmocka_unit_test(test_neighbours_go_together),
        cmocka_unit_test(test_tiles_on_threads),
        cmocka_unit_test(test_one_pixel_by_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
