/* Ideal pixels of a block together. The levels that a pixel crosses in a step follow from its values where the model turns,
 * without solving an equation. Pixels of the block that need something are gathered. Loops that vectorise compute their models,
 * turns and numbers of levels. The levels are listed, their places are solved all at once (signal/crossing_list.c), and then
 * the events are written. The number of levels of a pixel is unpredictable, so that loops avoid branches on it. Unusual pixels
 * are handled one by one in td_ideal.h: signals that aren't finite, or beyond a level at the step's start; more events than a
 * step may have; an end that asks for more events than the model fired. */
#include "td_ideal_block.h"
#include "td_between.h"

#include "signal/td_crossing_list.h"
#include "signal/td_turns.h"
#include "td_extremes.h"
#include "td_ideal.h"
#include "td_wide.h"

#include <string.h>

enum { EACH = TD_CROSSING_LIST_EACH };

/* The block's pixels that need something, side by side: their inputs and the results of loops over them. */
typedef struct busy {
    int count;
    int k[TD_IDEAL_BLOCK];    /* number in the block */
    double j[TD_IDEAL_BLOCK]; /* number in the tile */
    double S0[TD_IDEAL_BLOCK], S0_dot[TD_IDEAL_BLOCK], S1[TD_IDEAL_BLOCK], S1_dot[TD_IDEAL_BLOCK];
    double initial[TD_IDEAL_BLOCK], reference[TD_IDEAL_BLOCK], on[TD_IDEAL_BLOCK], off[TD_IDEAL_BLOCK]; /* counts */
    double control[4][TD_IDEAL_BLOCK];
    double is_plain[TD_IDEAL_BLOCK];                                            /* 0: must be handled by td_ideal.h */
    double bends[TD_IDEAL_BLOCK];                                               /* 0: its model only rises, or only falls */
    double easy[TD_IDEAL_BLOCK];                                                /* 1: plain, and doesn't bend */
    double rises[TD_IDEAL_BLOCK], falls[TD_IDEAL_BLOCK], after[TD_IDEAL_BLOCK]; /* levels crossed; reference then */
    double first[TD_IDEAL_BLOCK][EACH], guess[TD_IDEAL_BLOCK][EACH]; /* an easy one's first levels: references, places */
    double rise[TD_IDEAL_BLOCK];                                     /* the threshold from their references, with its sign */
    int64_t rest[TD_IDEAL_BLOCK];                                    /* the fields of its events except the time */
} busy;

/* Numbers of the sensor and the step, the same for all pixels. */
typedef struct levels {
    double h, on, off; /* [s] the step; thresholds */
    double most;       /* most events of a plain pixel in a step */
} levels;

typedef struct run {
    td_pixel_job *job;
    const td_ideal_block *block;
    levels levels;
    busy busy;
    int begun;      /* the first busy pixel whose levels are listed */
    td_turns turns; /* turns of the pixels that bend, in their order */
    td_crossing_list list;
    int64_t rest[TD_CROSSING_LIST_ALL]; /* of each level's event: its fields except the time */
} run;

/* -- all at once ----------------------------------------------------------------------------------------------------------- */

/* Lists the marked pixels without a branch on the mark, which would often be mispredicted. */
static int pick(const double *mark, size_t count, int *k) {
    int n = 0;
    if (td_next_mark(mark, 0, count) == count) return 0;
    for (size_t i = 0; i < count; i++) {
        k[n] = (int)i;
        n += mark[i] != 0.0;
    }
    return n;
}

/* Gathers the numbers of the pixels that need something. Rates that the model doesn't use may be anything. */
static void gather(run *r) {
    busy *restrict b = &r->busy;
    const size_t first = r->block->begin, i = r->block->first + first;
    const td_signals *from = r->block->signals;
    const td_pixels *pixels = &r->job->sensor->pixels;
    const double *S0 = from->S0 + first, *S0_dot = from->S0_dot ? from->S0_dot + first : S0;
    const double *S1 = from->S1 + first, *S1_dot = from->S1_dot ? from->S1_dot + first : S1;
    const double *initial = pixels->initial + i, *reference = pixels->reference + i;
    const uint32_t *on = pixels->count_on + i, *off = pixels->count_off + i;
    const int count = td_whole_vectors(b->count);
    for (int n = b->count; n < count; n++) b->k[n] = b->k[n - 1];
    for (int n = 0; n < count; n++) {
        /* NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): clang doesn't follow td_whole_vectors, here and below */
        const int k = b->k[n];
        b->j[n] = (double)first + k;
        b->S0[n] = S0[k];
        b->S0_dot[n] = S0_dot[k];
        b->S1[n] = S1[k];
        b->S1_dot[n] = S1_dot[k];
        b->initial[n] = initial[k];
        b->reference[n] = reference[k];
        b->on[n] = on[k];
        b->off[n] = off[k];
    }
}

/* 1 where the control values only rise or only fall, so that the model has no turn, else 0. Flags are doubles, set by one
 * comparison at a time: gcc 12 doesn't vectorise others. */
static inline double is_straight(const double *c) {
    double up = c[1] > c[0] ? 1.0 : 0.0, down = c[1] < c[0] ? 1.0 : 0.0;
    up = c[2] > c[1] ? up : 0.0;
    up = c[3] > c[2] ? up : 0.0;
    down = c[2] < c[1] ? down : 0.0;
    down = c[3] < c[2] ? down : 0.0;
    return up + down;
}

/* Where thresholds are at least this share of the signal, neighbouring references differ, whatever was rounded in them. */
#define TELLS_APART 0x1p-30

/* How many levels a straight model crosses, guessed by a multiplication. It is proven if the last level is reached and the next
 * one isn't; else 0 is returned. */
static inline double count_levels(const levels *l, double end, int n, busy *restrict b) {
    const double initial = b->initial[n], residual = end - b->reference[n];
    double rises = td_greater(td_whole(residual * (1 / l->on)), 1), falls = td_greater(td_whole(residual * (-1 / l->off)), 1);
    rises = residual >= l->on ? rises : 0.0;
    falls = residual <= -l->off ? falls : 0.0;
    const double on = b->on[n] + rises, off = b->off[n] + falls, after = td_reference_at(l->on, l->off, initial, on, off);
    const double last_on = td_lesser(rises, 1), last_off = td_lesser(falls, 1);
    const double before = end - td_reference_at(l->on, l->off, initial, on - last_on, off - last_off);
    double proven = end - after < l->on ? 1.0 : 0.0;
    proven = end - after > -l->off ? proven : 0.0;
    proven = last_on * (before - l->on) >= 0.0 ? proven : 0.0;
    proven = last_off * (before + l->off) <= 0.0 ? proven : 0.0;
    proven = rises + falls <= l->most ? proven : 0.0;
    proven = (fabs(end) + fabs(initial)) * TELLS_APART < td_lesser(l->on, l->off) ? proven : 0.0;
    b->rises[n] = rises;
    b->falls[n] = falls;
    b->after[n] = after;
    return proven;
}

static inline void fit(int32_t kind, const levels *given, busy *restrict b) {
    const levels l = *given;
    const int count = td_whole_vectors(b->count);
    for (int n = 0; n < count; n++) {
        const double S0_dot = kind == TIDES_MODEL_SECANT ? 0.0 : b->S0_dot[n], S1 = b->S1[n];
        const double S1_dot = kind == TIDES_MODEL_HERMITE ? b->S1_dot[n] : 0.0;
        const td_model model = td_model_fit(kind, l.h, b->S0[n], S0_dot, S1, S1_dot);
        const double *c = model.control, reference = b->reference[n], residual = c[0] - reference;
        /* A difference from itself is 0, or NaN where the number isn't finite. */
        const double lost = (c[0] - c[0]) + (c[1] - c[1]) + (c[2] - c[2]) + (c[3] - c[3]) + (reference - reference);
        const double straight = is_straight(c), proven = count_levels(&l, c[3], n, b), last = S1 - b->after[n];
        double counted = last < l.on ? proven : 0.0;
        counted = last > -l.off ? counted : 0.0;
        double plain = straight > 0.0 ? counted : 1.0;
        plain = residual < l.on ? plain : 0.0;
        plain = residual > -l.off ? plain : 0.0;
        plain = lost == 0.0 ? plain : 0.0;
        for (int i = 0; i < 4; i++) b->control[i][n] = c[i];
        b->is_plain[n] = plain;
        b->bends[n] = 1.0 - straight;
        b->easy[n] = plain * straight;
    }
}

TD_WIDE static void fit_all(int32_t kind, const levels *l, busy *b) {
    switch (kind) {
        case TIDES_MODEL_LINEAR: fit(TIDES_MODEL_LINEAR, l, b); break;
        case TIDES_MODEL_QUADRATIC: fit(TIDES_MODEL_QUADRATIC, l, b); break;
        case TIDES_MODEL_SECANT: fit(TIDES_MODEL_SECANT, l, b); break;
        default: fit(TIDES_MODEL_HERMITE, l, b); break;
    }
}

static void find_turns(run *r) {
    const busy *b = &r->busy;
    td_turns *turns = &r->turns;
    turns->count = 0;
    for (size_t n = 0, count = (size_t)b->count; (n = td_next_mark(b->bends, n, count)) < count; n++) {
        for (int i = 0; i < 4; i++) turns->control[i][turns->count] = b->control[i][n];
        turns->count++;
    }
    if (turns->count > 0) td_turns_find(turns);
}

/* Places of an event's fields, except the time, packed in a number: the first bits of each field. */
enum { AT_Y = 16, AT_POLARITY = 32, AT_CAUSE = 40 };
#define FIELD(bits) (1.0 * ((uint64_t)1 << (bits)))

/* The packed fields of an event of pixel j of the tile. Computed in doubles, since divisions of integers don't vectorise. */
static inline double rest_of(const td_tile *tile, double per_width, double j, int rises) {
    const double row = td_whole((j + 0.5) * per_width), x = tile->x0 + (j - row * tile->width), y = tile->y0 + row;
    return x + y * FIELD(AT_Y) + (rises ? 1.0 : 255.0) * FIELD(AT_POLARITY) + TIDES_CAUSE_SIGNAL * FIELD(AT_CAUSE);
}

/* The first levels of easy pixels, and where the chord of each model crosses them. */
TD_WIDE static void find_first(const levels *given, const td_ideal_block *block, busy *restrict b) {
    const levels l = *given;
    const td_tile tile = *block->tile;
    const double per_width = 1.0 / tile.width;
    const int count = td_whole_vectors(b->count);
    for (int n = 0; n < count; n++) {
        /* NOLINTNEXTLINE(clang-analyzer-core.CallAndMessage): clang doesn't follow td_whole_vectors */
        const double up = td_lesser(b->rises[n], 1), down = 1 - up, rise = up * l.on - down * l.off;
        const double from = b->control[0][n], per = 1 / (b->control[3][n] - from);
        for (int i = 0; i < EACH; i++) {
            const double reference = td_reference_at(l.on, l.off, b->initial[n], b->on[n] + up * i, b->off[n] + down * i);
            b->first[n][i] = reference;
            b->guess[n][i] = (reference - from + rise) * per;
        }
        b->rise[n] = rise;
        b->rest[n] = td_integer(rest_of(&tile, per_width, b->j[n], up > 0.0));
    }
}

static td_model model_of(const run *r, int n) {
    const busy *b = &r->busy;
    return (td_model){{b->control[0][n], b->control[1][n], b->control[2][n], b->control[3][n]}};
}

/* -- listing --------------------------------------------------------------------------------------------------------------- */

/* Lists levels k to k + EACH - 1, all of one piece. */
static inline void put(run *r, int k, const td_crossing_piece *piece, const double *reference, const double *guess, double rise,
                       int64_t rest) {
    const int64_t each[EACH] = {rest, rest, rest, rest};
    memcpy(&r->rest[k], each, sizeof each);
    td_crossing_list_put(&r->list, k, piece, reference, guess, rise);
}

/* Lists levels i to i + EACH - 1 of an easy pixel. */
static void put_later(run *r, int n, int i, const td_crossing_piece *piece) {
    const levels *l = &r->levels;
    const busy *b = &r->busy;
    const double up = td_lesser(b->rises[n], 1), down = 1 - up, rise = b->rise[n];
    const double per = 1 / (piece->control[3] - piece->control[0]);
    double reference[EACH], guess[EACH];
    for (int j = 0; j < EACH; j++) {
        const double on = b->on[n] + up * (i + j), off = b->off[n] + down * (i + j);
        reference[j] = td_reference_at(l->on, l->off, b->initial[n], on, off);
        guess[j] = (reference[j] - piece->control[0] + rise) * per;
    }
    put(r, piece->first + i, piece, reference, guess, rise, b->rest[n]);
}

/* Lists the levels of busy pixels from n on, as long as these are easy and there is room. Returns the first pixel that isn't
 * listed. */
TD_WIDE static int list_easy(run *r, int n) {
    const busy *b = &r->busy;
    for (; n < b->count && b->easy[n] != 0.0; n++) {
        const int first = r->list.count, count = (int)(b->rises[n] + b->falls[n]);
        const td_crossing_piece piece = {{b->control[0][n], b->control[1][n], b->control[2][n], b->control[3][n]}, 0, 1, first};
        if (count > TD_CROSSING_LIST_ROOM - first) return n;
        put(r, first, &piece, b->first[n], b->guess[n], b->rise[n], b->rest[n]);
        for (int i = EACH; i < count; i += EACH) put_later(r, n, i, &piece);
        r->list.count = first + count;
    }
    return n;
}

/* Lists the levels on one monotone piece of busy pixel n. Returns 0 where they are too many. */
static int list_piece(run *r, int n, const td_model *model, const double end[2], const double value[2]) {
    const double on = r->levels.on, off = r->levels.off, per = (end[1] - end[0]) / (value[1] - value[0]);
    const double *c = model->control;
    busy *b = &r->busy;
    const td_crossing_piece piece = {{c[0], c[1], c[2], c[3]}, end[0], end[1], r->list.count};
    for (;;) {
        const double residual = value[1] - b->after[n];
        const int rises = residual >= on, falls = residual <= -off && !rises;
        if (!(rises || falls)) return 1;
        if (r->list.count == TD_CROSSING_LIST_ROOM || b->rises[n] + b->falls[n] >= r->levels.most) return 0;
        const double reference[EACH] = {b->after[n]};
        const double rise = rises ? on : -off, guess[EACH] = {end[0] + (b->after[n] - value[0] + rise) * per};
        const double width = r->block->tile->width;
        const int64_t rest = td_integer(rest_of(r->block->tile, 1 / width, b->j[n], rises));
        put(r, r->list.count++, &piece, reference, guess, rise, rest);
        b->rises[n] += rises;
        b->falls[n] += falls;
        b->after[n] = td_reference_at(on, off, b->initial[n], b->on[n] + b->rises[n], b->off[n] + b->falls[n]);
    }
}

/* Lists all levels of busy pixel n, which is number `turn` of those that bend. Returns 0, with none listed, where there is no
 * room or the pixel is unusual. */
static int list_bent(run *r, int n, int turn) {
    const td_turns *t = &r->turns;
    const td_model model = model_of(r, n);
    const double end[] = {0, t->place[0][turn], t->place[1][turn], 1};
    const double value[] = {model.control[0], t->value[0][turn], t->value[1][turn], model.control[3]};
    const int first = r->list.count;
    busy *b = &r->busy;
    b->rises[n] = b->falls[n] = 0;
    b->after[n] = b->reference[n];
    int listed = 1;
    for (int piece = 0; piece < 3 && listed; piece++) listed = list_piece(r, n, &model, end + piece, value + piece);
    const double residual = b->S1[n] - b->after[n];
    if (listed && residual < r->levels.on && residual > -r->levels.off) return 1;
    r->list.count = first;
    return 0;
}

/* -- firing ---------------------------------------------------------------------------------------------------------------- */

/* The events of the levels, whose times are known. */
static void write_events(const run *r, tides_event *restrict to) {
    const int count = r->list.count;
    for (int k = 0; k < count; k++) {
        const int64_t rest = r->rest[k];
        to[k].t = r->list.time[k];
        to[k].x = (uint16_t)rest;
        to[k].y = (uint16_t)(rest >> AT_Y);
        to[k].polarity = (int8_t)(rest >> AT_POLARITY);
        to[k].cause = (uint8_t)(rest >> AT_CAUSE);
        to[k].frontend = 0;
    }
}

/* Stores the state of busy pixels [from, to), whose events have been fired. */
static void leave(run *r, int from, int to) {
    const busy *b = &r->busy;
    const td_pixels *pixels = &r->job->sensor->pixels;
    const size_t first = r->block->first + r->block->begin;
    double on = 0, off = 0;
    for (int n = from; n < to; n++) {
        const size_t i = first + (size_t)b->k[n];
        on += b->rises[n];
        off += b->falls[n];
        pixels->count_on[i] = (uint32_t)(b->on[n] + b->rises[n]);
        pixels->count_off[i] = (uint32_t)(b->off[n] + b->falls[n]);
        pixels->reference[i] = b->after[n];
    }
    r->job->counts.solved += (uint64_t)(to - from);
    r->job->counts.events_on += (uint64_t)on;
    r->job->counts.events_off += (uint64_t)off;
}

/* Fires the listed events, of the busy pixels before n. */
static tides_status fire(run *r, int n) {
    td_pixel_job *job = r->job;
    const size_t count = (size_t)r->list.count;
    td_event_buffer *buffer = job->buffer;
    if (buffer->capacity - buffer->count < count) {
        tides_status status = td_event_buffer_reserve(buffer, count + TD_EVENT_BUFFER_GROWTH, job->error);
        if (status != TIDES_OK) return status;
    }
    td_crossing_list_solve(&r->list, job->step);
    write_events(r, buffer->events + buffer->count);
    buffer->count += count;
    leave(r, r->begun, n);
    td_crossing_list_clear(&r->list);
    r->begun = n;
    return TIDES_OK;
}

static uint16_t column(const td_tile *tile, size_t j) { return (uint16_t)(tile->x0 + (int32_t)j % tile->width); }

static uint16_t row(const td_tile *tile, size_t j) { return (uint16_t)(tile->y0 + (int32_t)j / tile->width); }

static tides_status take_long_way(run *r, int n) {
    const td_model model = model_of(r, n);
    const td_ideal_block *b = r->block;
    const size_t j = b->begin + (size_t)r->busy.k[n];
    r->begun = n + 1;
    return td_ideal_advance(r->job, b->first + j, column(b->tile, j), row(b->tile, j), &model, NULL, b->signals->S1[j]);
}

/* Handles busy pixel *n, which isn't easy, or didn't find room and is tried with an empty list. *n becomes the next pixel. */
static tides_status take(run *r, int *n, int turn) {
    const busy *b = &r->busy;
    const int now = *n, bends = b->is_plain[now] != 0.0 && b->bends[now] != 0.0;
    *n = now + 1;
    if (bends && list_bent(r, now, turn)) return TIDES_OK;
    tides_status status = fire(r, now);
    if (status != TIDES_OK || (bends && list_bent(r, now, turn))) return status;
    const int next = list_easy(r, now);
    if (next == now) return take_long_way(r, now);
    *n = next;
    return TIDES_OK;
}

tides_status td_ideal_block_step(td_pixel_job *job, const td_ideal_block *block, const double *mark) {
    const tides_sensor *sensor = &job->sensor->sensor;
    run r;
    r.job = job;
    r.block = block;
    r.begun = 0;
    r.busy.count = pick(mark, block->count, r.busy.k);
    if (r.busy.count == 0) return TIDES_OK;
    gather(&r);
    r.levels = (levels){job->step->length_s, sensor->threshold_on, sensor->threshold_off, sensor->max_events_per_step};
    fit_all(job->sensor->model, &r.levels, &r.busy);
    find_first(&r.levels, block, &r.busy);
    find_turns(&r);
    td_crossing_list_clear(&r.list);
    tides_status status = TIDES_OK;
    for (int n = list_easy(&r, 0), turn = 0; n < r.busy.count && status == TIDES_OK; n = list_easy(&r, n)) {
        const int bends = r.busy.bends[n] != 0.0;
        status = take(&r, &n, turn);
        turn += bends;
    }
    return status == TIDES_OK ? fire(&r, r.busy.count) : status;
}
