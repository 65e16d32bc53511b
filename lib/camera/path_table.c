/* Texts with a pose in each row. A header line may name the columns. Otherwise the format does: TUM `t tx ty tz qx qy qz qw`
 * (seconds, blanks), ESIM `t, x, y, z, qx, qy, qz, qw` (nanoseconds, commas), EuRoC `t, x, y, z, qw, qx, qy, qz ...` (17 or
 * more columns, commas). All poses are body to world; '#' starts a comment. */
#include "camera/td_path_reader.h"

#include "camera/td_rotation.h"
#include "td_columns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TIME, POSITION, QUATERNION = 4, NEEDED = 8, EUROC_COLUMNS = 17 };

static const char *const plain_names[NEEDED] = {"time", "x", "y", "z", "qx", "qy", "qz", "qw"};

/* Names of each column, the most specific first. '*' stands for any letters. */
#define TD_PLACES(k) "t" k "|p" k "|" k "|*position" k "|*translation" k "|*location" k "|*pos" k "|p*" k "|t*" k
#define TD_TURNS(k) "q" k "|*orientation" k "|*quaternion" k "|*quat" k "|*rotation" k "|q*" k "|rot" k "|r" k
static const char *const names[NEEDED] = {"*headerstamp|t|ts|time|timestamp|timestamps|times|stamp|*timestamp|*stamp",
                                          TD_PLACES("x"),
                                          TD_PLACES("y"),
                                          TD_PLACES("z"),
                                          TD_TURNS("x"),
                                          TD_TURNS("y"),
                                          TD_TURNS("z"),
                                          TD_TURNS("w") "|w"};
/* Columns of these names count poses. They are accepted in place of times. */
static const char numbers_of_poses[] = "frame|frameid|framenumber|index|idx|id|i|n|seq|number|image|imageid";

/* -- which columns ------------------------------------------------------------------------------------------------------- */

/* Counts the fields of the row at `c`. */
static int count_fields(const char *c, int commas) {
    int count = 0;
    for (; !td_text_ends(c); count++) {
        if (commas) {
            c += strcspn(c, ",;#\n");
            c += *c == ',' || *c == ';';
        } else {
            c += strcspn(c, " \t\r#\n");
        }
        c = td_text_skip(c);
    }
    return count;
}

/* Metres in the positions' unit; 0 if it is no unit of length, or the columns' units differ. */
static double metres_of(const td_columns *c, const int place[NEEDED]) {
    double metres[3];
    for (int k = 0; k < 3; k++) {
        const char *unit = c->column[place[POSITION + k]].unit;
        metres[k] = *unit ? td_unit_metres(unit) : 1;
    }
    return metres[0] == metres[1] && metres[1] == metres[2] ? metres[0] : 0;
}

/* Finds the columns named in a header line. Returns how many of the 8 were found; 7 are all but the time. */
static int match(const td_columns *c, td_path_table *table, int *timed) {
    int found = 0;
    table->place[TIME] = td_columns_time(c, names[TIME], &table->digits);
    for (int k = POSITION; k < NEEDED; k++) found += (table->place[k] = td_columns_find(c, names[k])) >= 0;
    *timed = table->place[TIME] >= 0;
    return found;
}

static tides_status fail_names(td_path_reader *reader, const td_columns *c, const td_path_table *table, size_t line) {
    for (int k = POSITION; k < NEEDED; k++)
        if (table->place[k] < 0)
            return td_fail(reader->error, TIDES_BAD_FILE,
                           "%s:%zu: names its columns, and %s are %s: call them t x y z qx qy qz qw, in any order; turns "
                           "are unit quaternions here",
                           reader->file, line, plain_names[k], table->place[k] == TD_COLUMN_TWICE ? "several" : "none of them");
    if (table->place[TIME] == TD_COLUMN_TWICE)
        return td_fail(reader->error, TIDES_BAD_FILE,
                       "%s:%zu: names several columns of times: write one, seconds and nanoseconds together", reader->file,
                       line);
    for (int k = 0; k < c->count && k < TD_COLUMNS_MAX; k++)
        if (c->column[k].unit[0] && td_unit_digits(c->column[k].unit) < 0 && strncmp(c->column[k].name, "t", 1) == 0)
            return td_fail(reader->error, TIDES_BAD_FILE, "%s:%zu: its times are in [%s]: only s, ms, us and ns are known",
                           reader->file, line, c->column[k].unit);
    return td_fail(reader->error, TIDES_BAD_FILE,
                   "%s:%zu: names its columns, and none is the time: call it t[s], t[us] ..., or frame where there is none",
                   reader->file, line);
}

/* Takes the line at `c` as the header of rows with `table->columns` fields. A comment may be any prose: it counts only if it
 * has as many words, and they name a pose's columns. */
static tides_status take_names(td_path_reader *reader, const char *c, size_t line, int comment, td_path_table *table) {
    td_columns columns;
    td_path_table made = *table;
    int timed;
    if (!td_columns_parse(c, &columns) || (comment && columns.count != table->columns)) return TIDES_OK;
    const int found = match(&columns, &made, &timed);
    if (found < (comment ? 4 : 2) && (made.place[TIME] < 0 || (comment && made.place[TIME] > 0))) return TIDES_OK;
    if (td_columns_find(&columns, "cameraid") >= 0) return TIDES_OK; /* a header of COLMAP's images.txt */
    const int numbered = !timed && made.place[TIME] == TD_COLUMN_NONE && td_columns_find(&columns, numbers_of_poses) >= 0;
    if (found < NEEDED - 1 || !(timed || numbered)) return fail_names(reader, &columns, &made, line);
    if (columns.count != table->columns)
        return td_fail(reader->error, TIDES_BAD_FILE, "%s:%zu: names %d columns, but the rows have %d", reader->file, line,
                       columns.count, table->columns);
    made.metres = metres_of(&columns, made.place);
    if (!(made.metres > 0))
        return td_fail(reader->error, TIDES_BAD_FILE, "%s:%zu: its positions are in [%s]: only m, cm and mm are known",
                       reader->file, line, columns.column[made.place[POSITION]].unit);
    made.named = 1;
    made.line = line;
    made.is_euroc = td_columns_find(&columns, "qrsw") >= 0;
    *table = made;
    return TIDES_OK;
}

static const char *next_line(const char *c) {
    c += strcspn(c, "\n");
    return c + (*c == '\n');
}

static int is_comment(const char *c) { return *c == '#' || *c == '%' || (c[0] == '/' && c[1] == '/'); }

/* The first row of numbers. `*header`: the last line before it that isn't a comment, or NULL. */
static const char *first_row(const char *text, const char **header) {
    td_columns columns;
    *header = NULL;
    for (const char *c = text; *c; c = next_line(c)) {
        const char *data = td_text_skip(c);
        if (*data == '\n' || *data == '\0' || is_comment(data)) continue;
        if (*header || !td_columns_parse(data, &columns)) return data;
        *header = data;
    }
    return NULL;
}

static void take_order(td_path_table *table) {
    static const int euroc[NEEDED] = {0, 1, 2, 3, 5, 6, 7, 4};
    for (int k = 0; k < NEEDED; k++) table->place[k] = table->is_euroc ? euroc[k] : k;
}

tides_status td_path_find_table(td_path_reader *reader, td_path_table *table) {
    const char *header, *row = first_row(reader->text, &header);
    size_t line = 1;
    *table = (td_path_table){.digits = -1, .usual = 9, .metres = 1};
    if (!row) return TIDES_OK;
    table->commas = strcspn(row, ",;") < strcspn(row, "#\n");
    table->columns = count_fields(row, table->commas);
    table->usual = table->commas ? 0 : 9;
    tides_status status = TIDES_OK;
    for (const char *c = reader->text; c <= row && *c && status == TIDES_OK; c = next_line(c), line++) {
        const char *data = td_text_skip(c);
        if (is_comment(data) && !header) status = take_names(reader, data, line, 1, table);
        if (header && data == header) status = take_names(reader, data, line, 0, table);
    }
    if (status != TIDES_OK || table->named) return status;
    const char *euroc = strstr(reader->text, "q_RS_w");
    const int told = euroc && (size_t)(euroc - reader->text) < strcspn(reader->text, "\n");
    table->is_euroc = table->commas && (table->columns >= EUROC_COLUMNS || told);
    if (table->columns < NEEDED || !table->is_euroc) table->columns = NEEDED;
    take_order(table);
    return TIDES_OK;
}

/* -- rows ---------------------------------------------------------------------------------------------------------------- */

static tides_status fail_column(const td_path_reader *reader, size_t line, int column, int field, const char *at) {
    char word[TD_QUOTE];
    return td_fail(reader->error, TIDES_BAD_FILE, "%s:%zu: column %d (%s) must be a finite number, not \"%s\"", reader->file,
                   line, column + 1, plain_names[field], td_path_quote(at, strcspn(at, " \t\r\n,;"), word));
}

/* Reads the field at `*c` of column `column`: `*value`, and `*at`, where a time's digits begin. 0 if it is no number. */
static int take_number(const char **c, int commas, const char **at, double *value) {
    const int quoted = **c == '"';
    *at = *c + quoted;
    const char *end = td_text_number(*at, value);
    if (end == *at || (quoted && *end++ != '"')) return 0;
    const char *next = td_text_skip(end);
    if (!td_text_ends(next) && (commas ? *next != ',' && *next != ';' : next == end)) return 0;
    *c = commas && !td_text_ends(next) ? td_text_skip(next + 1) : next;
    return 1;
}

static const char *skip_field(const char *c, int commas) {
    c += strcspn(c, commas ? ",;#\n" : " \t\r#\n");
    return td_text_skip(c + (commas && (*c == ',' || *c == ';')));
}

static int field_at(const td_path_table *table, int column) {
    for (int k = 0; k < NEEDED; k++)
        if (table->place[k] == column) return k;
    return -1;
}

static tides_status fail_count(const td_path_reader *reader, size_t line, const td_path_table *table, int more) {
    if (table->named || table->is_euroc)
        return td_fail(reader->error, TIDES_BAD_FILE, "%s:%zu: %s than the %d columns of the other rows", reader->file, line,
                       more ? "more" : "fewer", table->columns);
    return td_fail(reader->error, TIDES_BAD_FILE, "%s:%zu: %s than 8 columns; %s has %s; name others in a first line",
                   reader->file, line, more ? "more" : "fewer", table->commas ? "an ESIM csv" : "a TUM file",
                   table->commas ? "t_ns, x, y, z, qx, qy, qz, qw" : "t tx ty tz qx qy qz qw");
}

/* Reads a row: its pose, and the position of its time in the text. */
static tides_status read_row(const td_path_reader *reader, const td_path_table *table, const char *c, td_path_sample *sample) {
    const int columns = table->columns;
    double v[NEEDED] = {0};
    const size_t line = sample->place;
    int column = 0;
    for (; !td_text_ends(c) && column < columns; column++) {
        const int field = field_at(table, column);
        const char *start = c, *at;
        if (field < 0)
            c = skip_field(c, table->commas);
        else if (!take_number(&c, table->commas, &at, v + field))
            return fail_column(reader, line, column, field, start);
        if (field == TIME) sample->word = at, sample->length = strcspn(at, " \t\r\n,;\"");
    }
    if (column < columns || !td_text_ends(c)) return fail_count(reader, line, table, column == columns);
    sample->time = v[TIME];
    for (int k = 0; k < 3; k++) sample->pose.position[k] = v[POSITION + k] * table->metres;
    sample->pose.quaternion[0] = v[QUATERNION + 3];
    memcpy(sample->pose.quaternion + 1, v + QUATERNION, 3 * sizeof *v);
    char where[32];
    snprintf(where, sizeof where, ":%zu", line);
    return td_path_check_quaternion(reader, where, sample->pose.quaternion, table->is_euroc ? "qw qx qy qz" : "qx qy qz qw");
}

static const char *format_of(const td_path_table *table) { return table->is_euroc ? "euroc" : table->commas ? "esim" : "tum"; }

tides_status td_path_read_table(td_path_reader *reader, const td_path_table *table) {
    size_t line = 1;
    td_text_lines lines = {0};
    snprintf(reader->path.format, sizeof reader->path.format, "%s", format_of(table));
    for (const char *c = reader->text; *c; line++, c = next_line(c)) {
        const char *data = td_text_skip(c);
        if (td_text_ends(data) || is_comment(data) || line == table->line) continue;
        td_path_sample *sample = td_path_append(reader, line);
        tides_status status = sample ? read_row(reader, table, data, sample) : TIDES_NO_MEMORY;
        if (status == TIDES_OK) status = td_text_take(&lines, reader, line, data);
        if (status != TIDES_OK) return status;
    }
    tides_status status = TIDES_OK;
    if (table->place[TIME] >= 0)
        status = td_path_take_times(reader, table->digits, table->usual);
    else
        td_path_spread(reader);
    return status == TIDES_OK && table->is_euroc ? td_path_mount_euroc(reader) : status;
}
