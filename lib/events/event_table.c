/* Finds the meaning of the columns of an event table from their values. Tools write t x y p, x y p t, x y t p and more, in
 * seconds, microseconds or nanoseconds, and most write no header.
 *   times       are the only column with decimals; or else never fall, and have values below 0 or above TD_TABLE_COORDINATE
 *   polarities  are 0 and 1, or -1 and 1
 *   coordinates are whole numbers of a sensor's size; x comes before y
 * One value in fifty may deviate: recordings have late and damaged events. If more than one order fits, the file is refused:
 * the user knows the order. */
#include "td_event_table.h"

#include "td_base.h"
#include "td_math.h"

#include <math.h>
#include <string.h>

enum {
    FAULTS = 50,   /* one deviating value in so many is allowed */
    ENOUGH = 64,   /* rows needed to judge a rate */
    SELDOM = 1000, /* events a second; noise alone gives even a sensor at rest more */
    DECIMALS = 5   /* a time written with so many decimals is in seconds */
};

void td_table_add(td_table_column *c, double value, int decimals) {
    if (c->rows == 0) {
        c->first = c->least = c->most = value;
        c->counting = value == 0 || value == 1;
    }
    c->counting = c->counting && value == c->first + (double)c->rows;
    c->falls += c->rows > 0 && value < c->last;
    if (c->rows > 0) c->fall = fmax(c->fall, c->last - value);
    c->least = fmin(c->least, value);
    c->most = fmax(c->most, value);
    c->last = value;
    c->rows++;
    c->dotted += decimals != 0;
    if (decimals > c->decimals) c->decimals = decimals;
    c->fractional += value != floor(value);
    c->beyond += value != floor(value) || value < 0 || value > TD_TABLE_COORDINATE;
    uint32_t *const kind = value == 0 ? &c->zeros : value == 1 ? &c->ones : value == -1 ? &c->minuses : &c->others;
    ++*kind;
}

/* ---- given by names ---- */

static const char *const field_names[TD_ROW_FIELDS] = {"t", "x", "y", "p"};
/* Names of columns in lower case without "_" and the like; '*' stands for any letters. */
static const char *const spellings[TD_ROW_FIELDS] =
    {"t|ts|time|timestamp|timestamps|times|stamp|*timestamp|*stamp|*time|eventt|eventst",
     "x|xs|xcoordinate|xcoord|xpos|xaddr|col|column|u|pixelx|xpixel|eventx|eventsx|addrx|posx|coordx",
     "y|ys|ycoordinate|ycoord|ypos|yaddr|row|v|pixely|ypixel|eventy|eventsy|addry|posy|coordy",
     "p|ps|pol|pols|polarity|polarities|on|sign|*polarity|ison|eventp|eventsp"};

static int find_field(const td_columns *named, int field, int *digits) {
    return field == TD_ROW_T ? td_columns_time(named, spellings[field], digits) : td_columns_find(named, spellings[field]);
}

tides_status td_table_named(const td_columns *named, td_table_meaning *meaning, tides_error *error) {
    int digits = -1;
    for (int f = 0; f < TD_ROW_FIELDS; f++) {
        meaning->column[f] = find_field(named, f, &digits);
        if (meaning->column[f] == TD_COLUMN_TWICE)
            return td_fail(error, TIDES_BAD_FILE, "names more than one column %s%s", field_names[f],
                           f == TD_ROW_T ? ": write one, seconds and nanoseconds together" : "");
        if (meaning->column[f] < 0 || meaning->column[f] >= TD_TABLE_COLUMNS_MAX)
            return td_fail(error, TIDES_BAD_FILE,
                           "names no column %s%s: --columns (columns) says what each is, as t,x,y,p with - for others",
                           field_names[f], f == TD_ROW_T ? " with a unit of time" : "");
    }
    meaning->digits = digits;
    return TIDES_OK;
}

int td_table_is_events(const td_columns *named) {
    int digits;
    for (int f = TD_ROW_T; f <= TD_ROW_Y; f++)
        if (find_field(named, f, &digits) == TD_COLUMN_NONE) return 0;
    return td_columns_find(named, "z|zs|tz|pz|qw|qx") == TD_COLUMN_NONE;
}

tides_status td_table_unit_named(const char *unit, int *digits, tides_error *error) {
    *digits = td_unit_digits(unit);
    if (*digits >= 0) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT, "unit \"%.20s\": times are in s, ms, us or ns", unit);
}

const char *td_table_unit_word(int digits) {
    return digits == 9 ? "seconds" : digits == 6 ? "milliseconds" : digits == 3 ? "microseconds" : "nanoseconds";
}

/* ---- found from values ---- */

static int few(uint32_t faults, const td_table_column *c) { return (uint64_t)faults * FAULTS <= c->rows; }
/* A late event is only a little late: a column that falls back by half of its range has no times. */
static int can_be_time(const td_table_column *c) { return few(c->falls, c) && 2 * c->fall <= c->most - c->least; }
static int can_be_polarity(const td_table_column *c) { return few(c->others, c) && (few(c->minuses, c) || few(c->zeros, c)); }
static int can_be_coordinate(const td_table_column *c) { return few(c->beyond, c); }

/* Orders that are recognised. For others the caller has to give the order. */
static const char *const orders[] = {"txyp", "xypt", "xytp"};

static void take_order(const char *order, const int *columns, td_table_meaning *meaning) {
    for (int f = 0; f < TD_ROW_FIELDS; f++) meaning->column[f] = columns[strchr(order, *field_names[f]) - order];
}

/* The only column written with decimals; -1 if there is none. */
static int only_real(const td_table_column *columns, const int *used) {
    int fractional = -1, dotted = -1, fractions = 0, dots = 0;
    for (int i = 0; i < TD_ROW_FIELDS; i++) {
        if (!few(columns[used[i]].fractional, &columns[used[i]])) fractional = used[i], fractions++;
        if (!few(columns[used[i]].dotted, &columns[used[i]])) dotted = used[i], dots++;
    }
    return fractions == 1 ? fractional : dots == 1 ? dotted : -1;
}

static int fits(const td_table_column *columns, const td_table_meaning *m, int real) {
    const td_table_column *t = &columns[m->column[TD_ROW_T]];
    const int timely = real >= 0 ? m->column[TD_ROW_T] == real : can_be_time(t);
    return timely && can_be_polarity(&columns[m->column[TD_ROW_P]]) && can_be_coordinate(&columns[m->column[TD_ROW_X]]) &&
           can_be_coordinate(&columns[m->column[TD_ROW_Y]]);
}

/* Finds the four columns that aren't an index; returns their number. */
static int leave_out_index(const td_table_column *columns, int count, int used[TD_TABLE_COLUMNS_MAX]) {
    int kept = 0, spare = count - TD_ROW_FIELDS;
    for (int c = 0; c < count && c < TD_TABLE_COLUMNS_MAX; c++) {
        const int index = spare > 0 && columns[c].counting && columns[c].rows > 1;
        spare -= index;
        if (!index) used[kept++] = c;
    }
    return kept;
}

/* The error for a table that can't be events, with the reason if one column shows it. */
static tides_status why_none(const td_table_column *columns, const int *used, tides_error *error) {
    int times = 0, polarities = 0;
    for (int i = 0; i < TD_ROW_FIELDS; i++) {
        times += can_be_time(&columns[used[i]]);
        polarities += can_be_polarity(&columns[used[i]]);
    }
    const char *what = !times        ? "none of its columns ascends as times do"
                       : !polarities ? "none of its columns is all 0 and 1, or -1 and 1, as polarities are"
                                     : "no order of t, x, y and p fits the values of its columns";
    return td_fail(error, TIDES_BAD_FILE, "%s: --columns (columns) says what each is, --unit (unit) in what times are", what);
}

tides_status td_table_guess(const td_table_column *columns, int count, td_table_meaning *meaning, char order[16],
                            tides_error *error) {
    int used[TD_TABLE_COLUMNS_MAX], found = 0;
    if (count > TD_TABLE_COLUMNS_MAX || leave_out_index(columns, count, used) != TD_ROW_FIELDS)
        return td_fail(error, TIDES_BAD_FILE,
                       "has %d columns and no header that names them: --columns (columns) says what each is, as t,x,y,p with - "
                       "for others",
                       count);
    const int real = only_real(columns, used);
    char seen[2][16] = {"", ""};
    for (size_t i = 0; i < sizeof orders / sizeof *orders; i++) {
        td_table_meaning one = {.digits = -1};
        take_order(orders[i], used, &one);
        if (!fits(columns, &one, real)) continue;
        const char *o = orders[i];
        snprintf(seen[found > 0], sizeof seen[0], "%c %c %c %c", o[0], o[1], o[2], o[3]);
        if (found++ == 0) *meaning = one;
    }
    memcpy(order, seen[0], sizeof seen[0]);
    const int first = real == used[0] || !few(columns[used[0]].fractional, &columns[used[0]]);
    if (found == 0 && first) { /* the first column is certainly times; errors in the others are reported by row */
        take_order(orders[0], used, meaning);
        meaning->digits = -1;
        memcpy(order, "t x y p", sizeof "t x y p");
        return TIDES_OK;
    }
    if (found == 0) return why_none(columns, used, error);
    if (found == 1) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE,
                   "its columns can be %s as well as %s: --columns (columns) says which, --unit (unit) in what times are",
                   seen[0], seen[1]);
}

/* Events per second if times have this unit; 0 if there are too few to tell. */
static double rate_in(const td_table_column *times, int digits) {
    const double span = (times->most - times->least) / td_pow(10, 9 - digits);
    return times->rows >= ENOUGH && span > 0 ? (double)times->rows / span : 0;
}

void td_table_tell_unit(const td_table_column *times, int digits, int expected, char *told, size_t size) {
    const double rate = rate_in(times, digits);
    const size_t used = strlen(told);
    if (expected && digits && (digits == 9 ? times->decimals >= DECIMALS : rate <= 0 || rate >= SELDOM)) return;
    if (used + 1 >= size) return;
    snprintf(told + used, size - used, "%stimes taken as %s, %s: --unit says another", used ? "; " : "",
             td_table_unit_word(digits),
             digits == 9 ? "since they have decimals"
             : digits    ? "being whole numbers"
                         : "being beyond 10^17");
}

void td_table_tell_falls(const td_table_column *times, int digits, char *told, size_t size) {
    const size_t used = strlen(told);
    if (times->rows < ENOUGH || 2 * times->fall <= times->most - times->least || used + 1 >= size) return;
    snprintf(told + used, size - used, "%stimes go back by %.3g s, as of a clock that begins again", used ? "; " : "",
             times->fall / td_pow(10, 9 - digits));
}

tides_status td_table_unit(const td_table_column *times, int whole, int *digits, tides_error *error) {
    *digits = !few(times->fractional, times) || (times->dotted && !whole) ? 9
              : fmax(fabs(times->least), fabs(times->most)) >= 1e17       ? 0
                                                                          : 3;
    const double rate = rate_in(times, *digits);
    if (!(rate > 0) || (*digits == 9 && times->decimals >= DECIMALS) || (rate >= 1 && rate <= 1e9)) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE,
                   "its times would be %s%s, and there %.3g events a second: --unit (unit) says in what they are",
                   td_table_unit_word(*digits), *digits == 9 ? ", since they have decimals" : "", rate);
}
