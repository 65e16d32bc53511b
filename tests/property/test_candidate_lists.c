/* Lists from boxes equal those by the definition, Gaussian by Gaussian and tile by tile: for boxes of any size and place,
 * inverted, infinite and NaN; objects at rest and moving; images with partial tiles; lists made again. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_renderer.h"
#include "tests/support/event_stream.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { TRIALS = 400, MOST = 40 * TD_PAD, OBJECTS_MOST = 6 };

typedef struct boxes {
    int width, height, count, objects, by_blocks;
    int some, groups[MOST / TD_PAD], group_count; /* some: only these count */
    float box[4 * MOST], travel[MOST];
    int object[MOST];
    uint8_t moves[OBJECTS_MOST];
} boxes;

static int below(uint64_t *random, int limit) { return (int)(random_uniform(random) * limit) % limit; }

/* A number that a box may hold in place of one of its own. */
static float odd_number(uint64_t *random, int side) {
    const float edge = (float)side;
    const float odd[] = {NAN, INFINITY, -INFINITY, 3e38f, -3e38f, 0, -0.0f, edge, nextafterf(edge, 0), 16, 15.999999f};
    return odd[below(random, (int)(sizeof odd / sizeof *odd))];
}

static void make_box(boxes *b, int i, double size, uint64_t *random) {
    const double x = (1.6 * random_uniform(random) - 0.3) * b->width, y = (1.6 * random_uniform(random) - 0.3) * b->height;
    const double rx = size * (random_uniform(random) - 0.02),
                 ry = size * (random_uniform(random) - 0.02); /* some are inverted */
    float *box = b->box + 4 * i;
    box[0] = (float)(x - rx), box[1] = (float)(y - ry), box[2] = (float)(x + rx), box[3] = (float)(y + ry);
    for (int k = 0; k < 4; k++)
        if (below(random, 40) == 0) box[k] = odd_number(random, k & 1 ? b->height : b->width);
    b->travel[i] = below(random, 20) ? (float)random_uniform(random) : odd_number(random, 1);
}

static void make_boxes(boxes *b, uint64_t *random) {
    static const double sizes[] = {0.3, 3, 9, 40, 300};
    const double size = sizes[below(random, 5)];
    int groups = 0;
    memset(b, 0, sizeof *b);
    b->width = 1 + below(random, 150), b->height = 1 + below(random, 90);
    b->objects = 1 + below(random, OBJECTS_MOST);
    b->by_blocks = below(random, 2);
    for (int o = 0; o < b->objects; o++) {
        b->moves[o] = (uint8_t)below(random, 2);
        for (int left = 1 + below(random, 6); left > 0; left--, groups++)
            for (int i = 0; i < TD_PAD; i++) b->object[groups * TD_PAD + i] = o;
    }
    b->count = groups * TD_PAD;
    for (int i = 0; i < b->count; i++) make_box(b, i, size, random);
    b->some = below(random, 2);
    for (int g = 0; g < groups; g++)
        if (!b->some || below(random, 3)) b->groups[b->group_count++] = g;
}

/* Whether a box touches squares of `side` pixels at (x, y), with nothing of how that is found. */
static int touches(const float *box, int x, int y, int side) {
    const double left = x * side, top = y * side;
    return box[0] < left + side && box[1] < top + side && box[2] >= left && box[3] >= top;
}

/* A box of which a tile may be asked. */
static int is_box(const float *box) { return !isnan(box[0]) && !isnan(box[1]) && !isnan(box[2]) && !isnan(box[3]); }

static int counts(const boxes *b, int i) {
    for (int g = 0; g < b->group_count; g++)
        if (b->groups[g] == i / TD_PAD) return 1;
    return 0;
}

/* Inverted boxes touch a tile that holds both ends. */
static int touches_tile(const boxes *b, int i, int x, int y) {
    const float *box = b->box + 4 * i;
    return counts(b, i) && is_box(box) && touches(box, x, y, TD_TILE) && floorf(box[0] / TD_TILE) <= floorf(box[2] / TD_TILE) &&
           floorf(box[1] / TD_TILE) <= floorf(box[3] / TD_TILE);
}

/* The next place of a list, behind others of the object. */
static void expect_entry(const td_candidates *made, int *at, int end, int expected, uint64_t trial) {
    if (*at >= end || made->list[*at] != expected)
        fail_msg("trial %d: entry %d is %d, not %d", (int)trial, *at, *at < end ? made->list[*at] : -2, expected);
    ++*at;
}

static void expect_blocks(const td_candidates *made, const boxes *b, int tile, uint64_t trial) {
    const int x = tile % made->tiles_x, y = tile / made->tiles_x;
    for (int k = 0; k < TD_TILE_BLOCKS; k++) {
        const int bx = 4 * x + k % 4, by = 4 * y + k / 4;
        float far = 0;
        int moving = 0;
        for (int i = 0; i < b->count; i++) {
            const float *box = b->box + 4 * i;
            const int there = b->moves[b->object[i]] && touches_tile(b, i, x, y) && touches(box, bx, by, TD_BLOCK) &&
                              fmaxf(0, floorf(box[0] / TD_BLOCK)) <= floorf(box[2] / TD_BLOCK) &&
                              fmaxf(0, floorf(box[1] / TD_BLOCK)) <= floorf(box[3] / TD_BLOCK);
            moving |= there;
            if (there && b->travel[i] > far) far = b->travel[i];
        }
        if ((made->moving_blocks[tile] >> k & 1) != moving || made->block_travel[tile * TD_TILE_BLOCKS + k] != far)
            fail_msg("trial %d: tile %d, block %d: moves %d as far as %g, not %d and %g", (int)trial, tile, k,
                     made->moving_blocks[tile] >> k & 1, made->block_travel[tile * TD_TILE_BLOCKS + k], moving, far);
    }
}

static void expect_tile(const td_candidates *made, const boxes *b, int tile, uint8_t *listed, uint64_t trial) {
    int at = made->first[tile], moving = 0;
    const int end = made->first[tile + 1];
    float far = 0;
    for (int o = 0; o < b->objects; o++) {
        for (int i = 0; i < b->count; i++) {
            if (b->object[i] != o || !touches_tile(b, i, tile % made->tiles_x, tile / made->tiles_x)) continue;
            expect_entry(made, &at, end, i, trial);
            listed[i / TD_PAD] = 1;
            moving |= b->moves[o];
            if (b->moves[o] && b->travel[i] > far) far = b->travel[i];
        }
        while (at % TD_PAD) expect_entry(made, &at, end, TD_NO_GAUSSIAN, trial);
    }
    assert_int_equal(at, end);
    assert_int_equal(made->moving[tile], moving);
    assert_true(made->travel[tile] == far);
    if (b->by_blocks) expect_blocks(made, b, tile, trial);
}

static void expect_lists(const td_candidates *made, const boxes *b, uint64_t trial) {
    uint8_t listed[MOST / TD_PAD] = {0};
    int groups = 0;
    assert_int_equal(made->first[0], 0);
    for (int t = 0; t < made->tiles_x * made->tiles_y; t++) expect_tile(made, b, t, listed, trial);
    for (int g = 0; g < b->count / TD_PAD; g++) {
        if (!listed[g]) continue;
        assert_true(groups < made->group_count && made->groups[groups] == g);
        groups++;
    }
    assert_int_equal(groups, made->group_count);
}

static void test_lists_are_those_of_the_definition(void **state) {
    (void)state;
    static boxes b;
    uint64_t random = 20261127;
    tides_error error;
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        td_candidates made;
        make_boxes(&b, &random);
        const int width = b.width, height = b.height;
        assert_int_equal(td_candidates_create(width, height, &made, &error), TIDES_OK);
        for (int again = 0; again < 2; again++) { /* what the first has left doesn't matter to the second */
            const td_store store = {.count = b.count, .objects = b.objects, .object = b.object};
            made.by_blocks = b.by_blocks;
            const td_groups some = {b.groups, b.group_count};
            const td_boxes of = {b.box, b.travel, b.moves, b.some ? &some : NULL, NULL};
            if (td_candidates_build(&made, &store, &of, &error) != TIDES_OK) fail_msg("%s", error.text);
            expect_lists(&made, &b, trial);
            make_boxes(&b, &random);
            b.width = width, b.height = height;
        }
        td_candidates_release(&made);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_lists_are_those_of_the_definition)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
