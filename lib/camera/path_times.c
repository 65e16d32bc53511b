/* Finds the unit of a path file's times. A unit in the options or the file decides. Otherwise it is the format's own unit if
 * the times are plausible in it, or the only unit in which they are. Several plausible units, or numbers that aren't times,
 * are refused: a path a thousand times too fast would look right. */
#include "camera/td_path_reader.h"

#include "td_columns.h"
#include "td_math.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Times and steps from pose to pose that are plausible. */
#define TD_LARGEST_TIME 1e11  /* [s] counted from 1970, the year 5138 */
#define TD_SHORTEST_STEP 2e-4 /* [s] 5 kHz */
#define TD_LONGEST_STEP 100.0 /* [s] */

/* Facts about the numbers in the column of times. */
typedef struct numbers {
    double last, step; /* the largest number, and the median step */
    int whole;         /* 1: none has a fraction */
    int bare;          /* 1: none has a decimal point; "1.0" is a time, and so is "40000000.0" in ESIM's own files */
    int counts;        /* 1: they are 0, 1, 2 .. or 1, 2, 3 .., even written "1.0" (DROID-SLAM, DPVO) */
} numbers;

static int is_bare(const td_path_sample *sample) { return !sample->word || !memchr(sample->word, '.', sample->length); }

static tides_status look(const td_path_reader *reader, numbers *n) {
    const td_path_sample *s = reader->samples;
    const size_t count = reader->count;
    double *steps = td_alloc(count, sizeof *steps, reader->error);
    if (!steps) return TIDES_NO_MEMORY;
    *n = (numbers){.last = fabs(s[0].time), .whole = 1, .bare = 1, .counts = s[0].time == 0 || s[0].time == 1};
    for (size_t i = 0; i < count; i++) {
        n->last = fmax(n->last, fabs(s[i].time));
        n->whole &= s[i].time == floor(s[i].time);
        n->bare &= is_bare(s + i);
        n->counts &= s[i].time == s[0].time + (double)i;
        if (i > 0) steps[i - 1] = fabs(td_path_since(s + i, s + i - 1));
    }
    n->bare = n->counts || (n->bare && n->whole);
    if (count > 1) qsort(steps, count - 1, sizeof *steps, td_ascending);
    if (count > 1) n->step = steps[(count - 1) / 2];
    free(steps);
    return TIDES_OK;
}

static const char *name_of(int digits) {
    return digits == 9 ? "seconds" : digits == 6 ? "milliseconds" : digits == 3 ? "microseconds" : "nanoseconds";
}

static tides_status refuse(td_path_reader *reader, const char *what) {
    return td_fail(reader->error, TIDES_BAD_FILE,
                   "%s: its times are %s: say what they are: set camera.time_unit (an object's: time_unit) to s, ms, us, ns or "
                   "index%s",
                   reader->file, what, reader->list ? "" : ", or name the columns in a first line: # t[us] x y z qx qy qz qw");
}

/* 1 if the numbers are plausible times in this unit. */
static int is_plausible(const numbers *n, int digits) {
    const double second = td_pow(10, 9 - digits);
    const double last = n->last / second, step = n->step / second;
    return last < TD_LARGEST_TIME && (n->step <= 0 || (step >= TD_SHORTEST_STEP && step <= TD_LONGEST_STEP));
}

/* 1 if the numbers are plausible times in the format's own unit. They aren't if poses then came faster than 1 kHz, while in
 * another unit the times would be dates after 1970. */
static int is_usual(const numbers *n, int usual) {
    const int likely = td_likely_digits(n->last, n->step);
    if (!is_plausible(n, usual)) return 0;
    return likely == usual || n->step / td_pow(10, 9 - usual) >= 1e-3 || !td_counts_from_1970(n->last / td_pow(10, 9 - likely));
}

/* Guesses the unit when neither options nor file give it. */
static tides_status guess(td_path_reader *reader, int usual, int *digits) {
    numbers n;
    tides_status status = look(reader, &n);
    if (status != TIDES_OK) return status;
    const int recent = n.last < 1e8, few = reader->count < 3; /* recent: as seconds, these don't count from 1970 */
    *digits = usual;
    if (!n.whole && is_plausible(&n, 9)) {
        *digits = 9;
    } else if (usual == 9 ? !is_plausible(&n, 9) || (n.bare && recent && !few) : !is_usual(&n, usual)) {
        if (recent && n.bare && n.step <= 1000)
            return refuse(reader, "whole numbers, which may be seconds, milliseconds or numbers of poses");
        *digits = recent && n.step <= TD_LONGEST_STEP ? 9 : td_likely_digits(n.last, n.step);
    }
    if (*digits != usual)
        td_path_note(reader, "its times are taken as %s: camera.time_unit (an object's: time_unit) can say otherwise",
                     name_of(*digits));
    return TIDES_OK;
}

tides_status td_path_find_unit(td_path_reader *reader, int told, int usual, int *digits) {
    static const int units[] =
        {[TIDES_TIME_S] = 9, [TIDES_TIME_MS] = 6, [TIDES_TIME_US] = 3, [TIDES_TIME_NS] = 0, [TIDES_TIME_INDEX] = -1};
    const int32_t unit = reader->options->time_unit;
    *digits = unit != TIDES_TIME_AUTO ? units[unit] : told;
    if (unit != TIDES_TIME_AUTO || told >= 0 || reader->count == 0) return TIDES_OK;
    return guess(reader, usual, digits);
}

tides_status td_path_take_times(td_path_reader *reader, int told, int usual) {
    int digits = -1;
    tides_status status = td_path_find_unit(reader, told, usual, &digits);
    if (status != TIDES_OK) return status;
    for (size_t i = 0; i < reader->count; i++) {
        const char *end;
        if (digits >= 0) td_text_time(reader->samples[i].word, 9 - digits, reader->samples + i, &end);
        reader->samples[i].word = NULL;
    }
    if (digits < 0) td_path_spread(reader);
    return TIDES_OK;
}
