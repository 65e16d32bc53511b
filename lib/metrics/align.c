/* The best order-preserving pairing of two sorted lists of times, by dynamic programming on a band.
 *
 * F(i, j) is the largest sum over pairings of the first i times of a and the first j of b:
 *     F(i, j) = max(F(i-1, j), F(i, j-1), F(i-1, j-1) + limit - |b_j - a_i|)
 * Row i needs only the columns with which a_i may be paired: a window of b that moves forwards with i. Columns left of it are
 * never needed again. Right of it, F stays at its value in the window's last column, since no time up to a_i reaches that
 * far. */
#include "td_align.h"

#include <stdlib.h>
#include <string.h>

enum { SKIP_A = 0, SKIP_B = 1, PAIR = 2 };

static int64_t distance(int64_t x, int64_t y) { return x > y ? x - y : y - x; }

static tides_status append(td_align *align, int64_t dt, tides_error *error) {
    tides_status status = td_reserve((void **)&align->dt, &align->dt_capacity, align->pairs + 1, sizeof *align->dt, error);
    if (status == TIDES_OK) align->dt[align->pairs++] = dt;
    return status;
}

/* 1 if pairing the k-th with the k-th time is best, because no time has a nearer counterpart. Then every pair adds the most
 * that it can. */
static int obvious(const int64_t *a, size_t count_a, const int64_t *b, size_t count_b, int64_t limit) {
    if (count_a != count_b) return 0;
    for (size_t i = 0; i < count_a; i++) {
        int64_t gap = distance(a[i], b[i]);
        if (gap > limit) return 0;
        if (i > 0 && distance(a[i], b[i - 1]) < gap) return 0;
        if (i + 1 < count_a && distance(a[i], b[i + 1]) < gap) return 0;
    }
    return 1;
}

/* Moves the window [low, high) of b for `time`: times within the limit, and of these the nearest TD_ALIGN_BAND. It never
 * moves backwards; on entry `low` and `high` are those of the last row. */
static void move_window(const int64_t *b, size_t count_b, int64_t time, int64_t limit, size_t *low, size_t *high) {
    while (*low < count_b && time - b[*low] > limit) ++*low;
    if (*high < *low) *high = *low;
    while (*high < count_b && b[*high] - time <= limit) {
        if (*high - *low == TD_ALIGN_BAND) {
            if (distance(b[*high], time) >= distance(b[*low], time)) break;
            ++*low;
        }
        ++*high;
    }
}

/* Fills the table row by row in align->score, and stores the choices. score[j - low] is F(i, j). */
static void fill(td_align *align, const int64_t *a, size_t count_a, const int64_t *b, size_t count_b, int64_t limit) {
    int64_t *score = align->score;
    size_t low = 0, high = 0;
    score[0] = 0;
    for (size_t i = 0; i < count_a; i++) {
        size_t old_low = low, old_high = high;
        move_window(b, count_b, a[i], limit, &low, &high);
        /* Shifts the previous row to start at column `low`; behind its last column it is constant. */
        size_t kept = old_high > low ? old_high - low : 0;
        int64_t level = score[old_high - old_low];
        if (kept) memmove(score, score + (low - old_low), kept * sizeof *score);
        for (size_t j = kept; j <= high - low; j++) score[j] = level;
        align->window[i].low = low;
        align->window[i].high = high;
        uint8_t *choice = align->choice + i * TD_ALIGN_BAND;
        int64_t before = score[0]; /* F(i-1, j-1) */
        for (size_t j = 0; j < high - low; j++) {
            int64_t pair = before + limit - distance(a[i], b[low + j]), best = score[j + 1];
            before = best;
            choice[j] = SKIP_A;
            if (pair >= best) {
                best = pair;
                choice[j] = PAIR;
            }
            if (score[j] > best) {
                best = score[j];
                choice[j] = SKIP_B;
            }
            score[j + 1] = best;
        }
    }
}

/* Walks back from the last cell of the table. Pairs come out in reverse order, which doesn't matter for percentiles. */
static tides_status trace(td_align *align, const int64_t *a, size_t count_a, const int64_t *b, size_t count_b,
                          tides_error *error) {
    size_t j = count_b;
    for (size_t i = count_a; i-- > 0;) {
        const uint8_t *choice = align->choice + i * TD_ALIGN_BAND;
        size_t low = align->window[i].low;
        if (j > align->window[i].high) j = align->window[i].high;
        while (j > low && choice[j - 1 - low] == SKIP_B) j--;
        if (j <= low || choice[j - 1 - low] != PAIR) continue;
        j--;
        tides_status status = append(align, b[j] - a[i], error);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

tides_status td_align_times(td_align *align, const int64_t *a, size_t count_a, const int64_t *b, size_t count_b, int64_t limit,
                            tides_error *error) {
    tides_status status = TIDES_OK;
    if (count_a == 0 || count_b == 0) return TIDES_OK;
    if (obvious(a, count_a, b, count_b, limit)) {
        for (size_t i = 0; i < count_a && status == TIDES_OK; i++) status = append(align, b[i] - a[i], error);
        return status;
    }
    status = td_reserve((void **)&align->score, &align->score_capacity, TD_ALIGN_BAND + 1, sizeof *align->score, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&align->choice, &align->choice_capacity, count_a * TD_ALIGN_BAND, 1, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&align->window, &align->window_capacity, count_a, sizeof *align->window, error);
    if (status != TIDES_OK) return status;
    fill(align, a, count_a, b, count_b, limit);
    return trace(align, a, count_a, b, count_b, error);
}

void td_align_release(td_align *align) {
    free(align->score);
    free(align->choice);
    free(align->window);
    free(align->dt);
    memset(align, 0, sizeof *align);
}
