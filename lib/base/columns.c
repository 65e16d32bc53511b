/* Parses the line of a text table that names its columns and their units. A reader asks for a column by all the names that
 * it knows for it. The order of the columns, the spelling and further columns may be any. */
#include "td_columns.h"

#include <stddef.h>
#include <string.h>

/* Words that files use for a unit, and the unit that each means. After a name's last '_' or within brackets any of these
 * words counts. Glued to a name ("timestampus") only words of two letters and more count. */
static const struct {
    const char *word, *unit;
    int digits;
    double metres;
} units[] = {
    {"s", "s", 9, 0},       {"sec", "s", 9, 0},           {"secs", "s", 9, 0},          {"second", "s", 9, 0},
    {"seconds", "s", 9, 0}, {"ms", "ms", 6, 0},           {"msec", "ms", 6, 0},         {"msecs", "ms", 6, 0},
    {"millis", "ms", 6, 0}, {"millisecond", "ms", 6, 0},  {"milliseconds", "ms", 6, 0}, {"us", "us", 3, 0},
    {"usec", "us", 3, 0},   {"usecs", "us", 3, 0},        {"micros", "us", 3, 0},       {"microsecond", "us", 3, 0},
    {"ns", "ns", 0, 0},     {"microseconds", "us", 3, 0}, {"nsec", "ns", 0, 0},         {"nsecs", "ns", 0, 0},
    {"nanos", "ns", 0, 0},  {"nanosecond", "ns", 0, 0},   {"nanoseconds", "ns", 0, 0},  {"nanosec", "ns", 0, 0},
    {"px", "px", -1, 0},    {"pixel", "px", -1, 0},       {"pixels", "px", -1, 0},      {"m", "m", -1, 1},
    {"cm", "cm", -1, 1e-2}, {"mm", "mm", -1, 1e-3},       {"meters", "m", -1, 1},       {"metres", "m", -1, 1},
};
enum { UNITS = sizeof units / sizeof *units };

/* -- letters: ASCII only, independent of the locale ---------------------------------------------------------------------- */

static char small(char c) { return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c; }
static int is_digit(char c) { return c >= '0' && c <= '9'; }
static int is_word(char c) { return (c >= 'a' && c <= 'z') || is_digit(c); }
static int is_blank(char c) { return c == ' ' || c == '\t'; }
static int ends_line(char c) { return c == '\0' || c == '\r' || c == '\n'; }

/* Bytes of the micro sign at `c`: the sign itself or Greek's mu in UTF-8, or Latin-1's byte; 0: none. */
static size_t micro(const char *c, const char *end) {
    const unsigned char first = (unsigned char)*c, second = end - c > 1 ? (unsigned char)c[1] : 0;
    if ((first == 0xC2 && second == 0xB5) || (first == 0xCE && second == 0xBC)) return 2;
    return first == 0xB5;
}

/* Copies the letters and digits from `c` on in lower case, and leaves other characters out. */
static void plain(const char *c, const char *end, char *out, size_t size) {
    size_t length = 0;
    while (c < end && length + 1 < size) {
        const size_t sign = micro(c, end);
        const char letter = sign ? 'u' : small(*c);
        if (is_word(letter)) out[length++] = letter;
        c += sign ? sign : 1;
    }
    out[length] = '\0';
}

static int find_unit(const char *word) {
    for (int k = 0; k < UNITS; k++)
        if (strcmp(units[k].word, word) == 0) return k;
    return -1;
}

int td_unit_digits(const char *unit) {
    const int k = find_unit(unit);
    return k < 0 ? -1 : units[k].digits;
}

double td_unit_metres(const char *unit) {
    const int k = find_unit(unit);
    return k < 0 ? 0 : units[k].metres;
}

/* -- one field ----------------------------------------------------------------------------------------------------------- */

static int is_number(const char *c, const char *end) {
    while (c < end && strchr("+-.", *c)) c++;
    return c < end && is_digit(*c);
}

/* Takes blanks and quotes off both ends. */
static void trim(const char **c, const char **end) {
    while (*c < *end && strchr(" \t\"'", **c)) ++*c;
    while (*end > *c && strchr(" \t\"'", (*end)[-1])) --*end;
}

static void set_unit(const char *c, const char *end, td_column *column) {
    plain(c, end, column->unit, sizeof column->unit);
    const int known = find_unit(column->unit);
    if (known >= 0) memcpy(column->unit, units[known].unit, strlen(units[known].unit) + 1);
}

/* Reads a unit in brackets ("t [us]", "t(us)"); returns the end of the name in front of it. */
static const char *take_brackets(const char *c, const char *end, td_column *column) {
    const char *open = c;
    while (open < end && *open != '[' && *open != '(') open++;
    const char *close = open;
    while (close < end && *close != ']' && *close != ')') close++;
    if (open < end) set_unit(open + 1, close, column);
    return open;
}

/* Reads a unit behind the name ("t_us", "time in us"); returns the end of the name. A name that consists of a unit's word
 * only stays a name. */
static const char *take_suffix(const char *c, const char *end, td_column *column) {
    const char *word = end;
    while (word > c && !strchr("_ -./", word[-1])) word--;
    if (word == c) return end;
    char text[TD_COLUMN_UNIT];
    plain(word, end, text, sizeof text);
    if (find_unit(text) < 0) return end;
    set_unit(word, end, column);
    for (end = word; end > c && strchr("_ -./", end[-1]);) end--;
    if (end - c > 3 && strchr("_ ", end[-3]) && small(end[-2]) == 'i' && small(end[-1]) == 'n') end -= 3;
    return end;
}

/* Reads a size behind the name ("x@1280"); returns the end of the name. */
static const char *take_size(const char *c, const char *end, td_column *column) {
    const char *at = memchr(c, '@', (size_t)(end - c));
    if (!at) return end;
    int32_t size = 0;
    for (const char *digit = at + 1; digit < end && is_digit(*digit); digit++) {
        size = 10 * size + (*digit - '0');
        if (size > 65536) return at; /* larger than any sensor: no size */
    }
    column->size = size;
    return at;
}

static void parse_field(const char *c, const char *end, td_column *column) {
    memset(column, 0, sizeof *column);
    trim(&c, &end);
    end = take_size(c, end, column);
    const char *name = take_brackets(c, end, column);
    if (!column->unit[0]) name = take_suffix(c, name, column);
    plain(c, name, column->name, sizeof column->name);
}

/* -- the line ------------------------------------------------------------------------------------------------------------ */

/* Returns the place behind the end of a quoted field, which may hold separators. */
static const char *skip_quotes(const char *c) {
    const char quote = *c++;
    while (!ends_line(*c) && *c != quote) c++;
    return *c == quote ? c + 1 : c;
}

static char find_separator(const char *c) {
    static const char kinds[] = ",;\t";
    int seen[3] = {0};
    while (!ends_line(*c)) {
        const char *kind = strchr(kinds, *c);
        if (kind) seen[kind - kinds] = 1;
        c = *c == '"' ? skip_quotes(c) : c + 1;
    }
    for (int k = 0; k < 3; k++)
        if (seen[k]) return kinds[k];
    return ' ';
}

/* Returns the end of the field at `c`. If blanks separate the fields, "t [us]" is still one field. */
static const char *end_of_field(const char *c, char separator) {
    while (!ends_line(*c)) {
        if (*c == '"') {
            c = skip_quotes(c);
            continue;
        }
        if (*c == separator && separator != ' ') return c;
        if (separator == ' ' && is_blank(*c)) {
            const char *next = c;
            while (is_blank(*next)) next++;
            if (*next != '[' && *next != '(') return c;
            c = next;
        }
        c++;
    }
    return c;
}

static const char *skip_front(const char *c) {
    if (strncmp(c, "\xEF\xBB\xBF", 3) == 0) c += 3;
    for (;; c++) {
        if (is_blank(*c) || *c == '#' || *c == '%') continue;
        if (c[0] != '/' || c[1] != '/') return c;
        c++;
    }
}

/* Returns the place behind a label such as "Format:" in front of the names. */
static const char *skip_label(const char *c) {
    const char *end = c;
    while (is_word(small(*end))) end++;
    return end > c && *end == ':' && is_blank(end[1]) ? end + 1 + strspn(end + 1, " \t") : c;
}

int td_columns_parse(const char *line, td_columns *columns) {
    const char *c = skip_label(skip_front(line));
    int named = 0, numbers = 0;
    columns->count = 0;
    columns->separator = find_separator(c);
    for (int more = !ends_line(*c); more;) {
        const char *end = end_of_field(c, columns->separator), *from = c, *to = end;
        trim(&from, &to);
        numbers += is_number(from, to);
        if (columns->count < TD_COLUMNS_MAX) {
            td_column *column = columns->column + columns->count;
            parse_field(c, end, column);
            named += column->name[0] != '\0';
        }
        columns->count++;
        more = !ends_line(*end);
        for (c = end + more; columns->separator == ' ' && is_blank(*c);) c++;
        if (columns->separator == ' ' && ends_line(*c)) more = 0;
    }
    return named > 0 && numbers == 0;
}

/* -- look-up by name --------------------------------------------------------------------------------------------------- */

/* 1 if the name matches `wanted` (`length` letters). One '*' in `wanted` stands for any letters or none. */
static int has_name(const char *name, const char *wanted, size_t length) {
    const size_t own = strlen(name);
    const char *star = memchr(wanted, '*', length);
    if (!star) return own == length && memcmp(name, wanted, length) == 0;
    const size_t front = (size_t)(star - wanted), back = length - front - 1;
    return own >= front + back && memcmp(name, wanted, front) == 0 && memcmp(name + own - back, star + 1, back) == 0;
}

/* If the name is `wanted` (`length` letters) with a unit's word of at least two letters behind: the unit's decimal digits
 * to nanoseconds. Otherwise -1. */
static int has_name_and_unit(const char *name, const char *wanted, size_t length) {
    if (memchr(wanted, '*', length) || strncmp(name, wanted, length) != 0 || strlen(name) < length + 2) return -1;
    return td_unit_digits(name + length);
}

static int find(const td_columns *columns, const char *names, int glued, int *digits) {
    const int count = columns->count < TD_COLUMNS_MAX ? columns->count : TD_COLUMNS_MAX;
    for (const char *wanted = names; *wanted;) {
        const size_t length = strcspn(wanted, "|");
        int found = TD_COLUMN_NONE;
        for (int i = 0; i < count; i++) {
            const td_column *column = columns->column + i;
            const int unit = glued ? has_name_and_unit(column->name, wanted, length) : -1;
            if (glued ? unit < 0 : !has_name(column->name, wanted, length)) continue;
            if (found >= 0) return TD_COLUMN_TWICE;
            found = i;
            *digits = unit;
        }
        if (found >= 0) return found;
        wanted += length + (wanted[length] == '|');
    }
    return TD_COLUMN_NONE;
}

int td_columns_find(const td_columns *columns, const char *names) {
    int digits;
    return find(columns, names, 0, &digits);
}

/* Finds a column that is named by its unit alone: "microseconds", "nsec". One letter doesn't count: "s" may be anything. */
static int find_unit_alone(const td_columns *columns, int *digits) {
    const int count = columns->count < TD_COLUMNS_MAX ? columns->count : TD_COLUMNS_MAX;
    int found = TD_COLUMN_NONE;
    for (int i = 0; i < count; i++) {
        const td_column *column = columns->column + i;
        const int unit = column->unit[0] || strlen(column->name) < 2 ? -1 : td_unit_digits(column->name);
        if (unit < 0) continue;
        if (found >= 0) return TD_COLUMN_TWICE;
        found = i;
        *digits = unit;
    }
    return found;
}

int td_columns_time(const td_columns *columns, const char *names, int *digits) {
    *digits = -1;
    int found = find(columns, names, 0, digits);
    if (found == TD_COLUMN_NONE) found = find(columns, names, 1, digits);
    if (found == TD_COLUMN_NONE) return find_unit_alone(columns, digits);
    if (*digits >= 0) return found;
    if (found < 0 || !columns->column[found].unit[0]) return found;
    *digits = td_unit_digits(columns->column[found].unit);
    return *digits < 0 ? TD_COLUMN_NONE : found;
}

/* -- units that no name gives ------------------------------------------------------------------------------------------ */

int td_counts_from_1970(double seconds) { return seconds >= 1e8 && seconds < 5e9; }

int td_likely_digits(double last, double step) {
    static const int digits[] = {9, 6, 3, 0};
    double unit = 1; /* units in a second */
    for (int k = 0; k < 4; k++, unit *= 1e3)
        if (td_counts_from_1970(last / unit) && step <= unit && step >= 1e-3 * unit) return digits[k];
    unit = 1;
    for (int k = 0; k < 3; k++, unit *= 1e3)
        if (step <= unit) return digits[k];
    return 0;
}
