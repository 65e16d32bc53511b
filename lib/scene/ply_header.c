/* Parses the header of any PLY file: text lines from "ply" to "end_header".
 *
 *     ply
 *     format binary_little_endian 1.0
 *     comment anything
 *     element vertex 3
 *     property float x
 *     property list uchar int vertex_indices
 *     end_header
 *
 * Lines end in LF or CR LF. All is checked, and each message names the line. */
#include "td_base.h"
#include "td_ply.h"
#include "td_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { WORDS_MAX = 7 }; /* one more than in the longest line, "comment Vertical axis: x y z" */

/* One line, split at blanks. */
typedef struct td_ply_line {
    td_ply_word whole, words[WORDS_MAX];
    size_t count;
} td_ply_line;

typedef struct parser {
    const td_ply_file *file;
    td_ply_header *header;
    size_t at, number; /* byte and line to be read next */
    td_ply_line line;  /* the current line, number - 1 */
    tides_error *error;
} parser;

int td_ply_word_is(td_ply_word word, const char *text) {
    return strlen(text) == word.length && memcmp(word.text, text, word.length) == 0;
}

const char *td_ply_quote(td_ply_word word, char text[TD_PLY_QUOTE_BYTES]) {
    enum { SHOWN = 40 }; /* characters */
    size_t n = word.length < SHOWN ? word.length : SHOWN;
    for (size_t i = 0; i < n; i++) text[i] = (char)(word.text[i] >= ' ' && word.text[i] <= '~' ? word.text[i] : '?');
    memcpy(text + n, word.length > SHOWN ? "..." : "", word.length > SHOWN ? 4 : 1);
    return text;
}

size_t td_ply_type_bytes(int type) {
    static const size_t bytes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
    return bytes[type];
}

const td_ply_element *td_ply_find_element(const td_ply_header *header, const char *name) {
    for (size_t i = 0; i < header->element_count; i++)
        if (td_ply_word_is(header->elements[i].name, name)) return &header->elements[i];
    return NULL;
}

void td_ply_header_free(td_ply_header *header) {
    free(header->elements);
    free(header->properties);
    memset(header, 0, sizeof *header);
}

static tides_status fail_at(const parser *p, const char *what, td_ply_word word) {
    return td_fail(p->error, TIDES_BAD_FILE, "%s: line %zu: %s: '%s'", p->file->path, p->number - 1, what, TD_PLY_QUOTE(word));
}

static void split(td_ply_line *line) {
    const char *at = line->whole.text, *end = at + line->whole.length;
    line->count = 0;
    while (line->count < WORDS_MAX) {
        while (at < end && (*at == ' ' || *at == '\t')) at++;
        if (at == end) break;
        const char *start = at;
        while (at < end && *at != ' ' && *at != '\t') at++;
        line->words[line->count++] = (td_ply_word){start, (size_t)(at - start)};
    }
}

static tides_status next_line(parser *p) {
    const char *start = (const char *)p->file->data + p->at;
    size_t left = p->file->size - p->at;
    const char *end = memchr(start, '\n', left);
    if (!end)
        return td_fail(p->error, TIDES_BAD_FILE,
                       "%s: the header breaks off in line %zu, at byte %zu, without an end_header line: is the file truncated?",
                       p->file->path, p->number, p->file->size);
    size_t length = (size_t)(end - start);
    p->at += length + 1;
    p->number++;
    if (length > 0 && start[length - 1] == '\r') length--;
    p->line.whole = (td_ply_word){start, length};
    split(&p->line);
    return TIDES_OK;
}

/* Each type has two names in use; 0 if `word` is none of them. */
static int type_of(td_ply_word word) {
    static const struct {
        const char *name;
        int type;
    } types[] = {{"char", TD_PLY_INT8},      {"int8", TD_PLY_INT8},       {"uchar", TD_PLY_UINT8},
                 {"uint8", TD_PLY_UINT8},    {"short", TD_PLY_INT16},     {"int16", TD_PLY_INT16},
                 {"ushort", TD_PLY_UINT16},  {"uint16", TD_PLY_UINT16},   {"int", TD_PLY_INT32},
                 {"int32", TD_PLY_INT32},    {"uint", TD_PLY_UINT32},     {"uint32", TD_PLY_UINT32},
                 {"float", TD_PLY_FLOAT32},  {"float32", TD_PLY_FLOAT32}, {"double", TD_PLY_FLOAT64},
                 {"float64", TD_PLY_FLOAT64}};
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (td_ply_word_is(word, types[i].name)) return types[i].type;
    return TD_PLY_NONE;
}

static tides_status parse_format(parser *p) {
    const td_ply_line *line = &p->line;
    if (p->header->format) return fail_at(p, "a second format line", line->whole);
    if (line->count != 3) return fail_at(p, "should be 'format ENCODING 1.0'", line->whole);
    if (!td_ply_word_is(line->words[2], "1.0")) return fail_at(p, "PLY version should be 1.0", line->words[2]);
    if (td_ply_word_is(line->words[1], "ascii"))
        p->header->format = TD_PLY_ASCII;
    else if (td_ply_word_is(line->words[1], "binary_little_endian"))
        p->header->format = TD_PLY_LITTLE_ENDIAN;
    else if (td_ply_word_is(line->words[1], "binary_big_endian"))
        p->header->format = TD_PLY_BIG_ENDIAN;
    else
        return fail_at(p, "encoding should be ascii, binary_little_endian or binary_big_endian", line->words[1]);
    return TIDES_OK;
}

/* Reads decimal digits only: strtoull would take "-1" as a very large number. */
static int parse_count(td_ply_word word, uint64_t *count) {
    uint64_t value = 0;
    for (size_t i = 0; i < word.length; i++) {
        if (word.text[i] < '0' || word.text[i] > '9') return 0;
        uint64_t digit = (uint64_t)(word.text[i] - '0');
        if (value > (UINT64_MAX - digit) / 10) return 0;
        value = value * 10 + digit;
    }
    *count = value;
    return word.length > 0;
}

static tides_status parse_element(parser *p) {
    const td_ply_line *line = &p->line;
    td_ply_header *h = p->header;
    if (line->count != 3) return fail_at(p, "should be 'element NAME COUNT'", line->whole);
    td_ply_element element = {.name = line->words[1], .first_property = h->property_count, .line = p->number - 1};
    if (!parse_count(line->words[2], &element.count))
        return fail_at(p, "the element's count should be a whole number from 0 to 2^64 - 1", line->words[2]);
    for (size_t i = 0; i < h->element_count; i++)
        if (h->elements[i].name.length == element.name.length &&
            memcmp(h->elements[i].name.text, element.name.text, element.name.length) == 0)
            return fail_at(p, "a second element of this name", element.name);
    void *grown = h->elements;
    tides_status status = td_reserve(&grown, &h->element_capacity, h->element_count + 1, sizeof *h->elements, p->error);
    h->elements = grown;
    if (!status) h->elements[h->element_count++] = element;
    return status;
}

static tides_status parse_property(parser *p) {
    const td_ply_line *line = &p->line;
    td_ply_header *h = p->header;
    if (h->element_count == 0) return fail_at(p, "a property before any element", line->whole);
    int list = line->count > 1 && td_ply_word_is(line->words[1], "list");
    if (line->count != (list ? 5u : 3u))
        return fail_at(p, "should be 'property TYPE NAME' or 'property list TYPE TYPE NAME'", line->whole);
    td_ply_property property = {.name = line->words[line->count - 1], .type = type_of(line->words[line->count - 2])};
    if (!property.type) return fail_at(p, "unknown type", line->words[line->count - 2]);
    if (list) {
        property.count_type = type_of(line->words[2]);
        if (!property.count_type || property.count_type >= TD_PLY_FLOAT32)
            return fail_at(p, "a list's count should have an integer type", line->words[2]);
    }
    void *grown = h->properties;
    tides_status status = td_reserve(&grown, &h->property_capacity, h->property_count + 1, sizeof *h->properties, p->error);
    h->properties = grown;
    if (status) return status;
    h->properties[h->property_count++] = property;
    h->elements[h->element_count - 1].properties++;
    return TIDES_OK;
}

static void take_up(const td_ply_word words[3], double up[3]) {
    double found[3];
    for (int axis = 0; axis < 3; axis++)
        if (!td_ply_number(words[axis], &found[axis]) || !isfinite(found[axis])) return;
    memcpy(up, found, sizeof found);
}

int td_ply_word_reads(td_ply_word word, const char *text) {
    return strlen(text) == word.length && strncasecmp(word.text, text, word.length) == 0;
}

/* 1 if the line's words from the second on begin with `names` (NULL-terminated), in any case. */
static int comment_is(const td_ply_line *line, const char *const *names) {
    size_t i = 1;
    for (; names[i - 1]; i++)
        if (i >= line->count || !td_ply_word_reads(line->words[i], names[i - 1])) return 0;
    return 1;
}

/* Reads where up is: "comment up x y z" (TIDES), "comment Vertical axis: x y z" (Brush), or "comment Vertical Axis: z"
 * (nerfstudio). Any other single axis is ignored, because Brush writes y if it doesn't know. */
static tides_status parse_up(parser *p) {
    static const char *const ours[] = {"up", NULL}, *const theirs[] = {"Vertical", "axis:", NULL};
    const td_ply_line *line = &p->line;
    const size_t first = comment_is(line, ours) ? 2 : comment_is(line, theirs) ? 3 : 0;
    td_plain_numbers numbers;
    if (first && line->count == first + 3) {
        tides_status status = td_plain_begin(&numbers, p->file->path, p->error);
        if (status) return status;
        take_up(line->words + first, p->header->up);
        td_plain_end(&numbers);
    } else if (first == 3 && line->count == 4 && td_ply_word_is(line->words[3], "z")) {
        memcpy(p->header->up, (const double[]){0, 0, 1}, sizeof p->header->up);
    }
    return TIDES_OK;
}

/* Reads the training mode: "comment SplatRenderMode: mip", "default" or "2dgs" (Brush, splat-transform), or "comment
 * antialiased 1" (Postshot). */
static void parse_mode(parser *p) {
    static const char *const mode[] = {"SplatRenderMode:", NULL}, *const flag[] = {"antialiased", NULL};
    static const char plain[] = "default", compensated[] = "mip";
    const td_ply_line *line = &p->line;
    if (line->count != 3) return;
    if (comment_is(line, mode)) p->header->mode = line->words[2];
    if (!comment_is(line, flag)) return;
    if (td_ply_word_is(line->words[2], "0")) p->header->mode = (td_ply_word){plain, strlen(plain)};
    if (td_ply_word_is(line->words[2], "1")) p->header->mode = (td_ply_word){compensated, strlen(compensated)};
}

/* Reads how colours code light: "comment ColourTransfer: linear", "srgb" or "gamma 2.2", as TIDES writes. */
static void parse_transfer(parser *p) {
    static const char *const name[] = {"ColourTransfer:", NULL};
    const td_ply_line *line = &p->line;
    if (!comment_is(line, name)) return;
    p->header->transfer = line->count > 2 ? line->words[2] : line->words[1];
    p->header->exponent = line->count > 3 ? line->words[3] : (td_ply_word){NULL, 0};
}

static tides_status parse_comment(parser *p) {
    parse_mode(p);
    parse_transfer(p);
    return parse_up(p);
}

/* `*ended` is set by the end_header line. */
static tides_status parse_line(parser *p, int *ended) {
    td_ply_word key = p->line.count ? p->line.words[0] : (td_ply_word){"", 0};
    if (key.length == 0 || td_ply_word_is(key, "obj_info")) return TIDES_OK;
    if (td_ply_word_is(key, "comment")) return parse_comment(p);
    if (td_ply_word_is(key, "format")) return parse_format(p);
    if (td_ply_word_is(key, "element")) return parse_element(p);
    if (td_ply_word_is(key, "property")) return parse_property(p);
    if (!td_ply_word_is(key, "end_header")) return fail_at(p, "not a PLY header line (is end_header missing?)", p->line.whole);
    *ended = 1;
    return p->header->format ? TIDES_OK : fail_at(p, "no format line before this one", key);
}

tides_status td_ply_header_parse(const td_ply_file *file, td_ply_header *header, tides_error *error) {
    memset(header, 0, sizeof *header);
    if (file->size == 0)
        return td_fail(error, TIDES_BAD_FILE, "%s: is empty: a PLY file begins with the line 'ply'", file->path);
    parser p = {.file = file, .header = header, .number = 1, .error = error};
    int ended = 0;
    tides_status status = next_line(&p);
    if (!status && !td_ply_word_is(p.line.whole, "ply")) status = fail_at(&p, "should be 'ply'", p.line.whole);
    while (!status && !ended) {
        status = next_line(&p);
        if (!status) status = parse_line(&p, &ended);
    }
    header->body = p.at;
    header->lines = p.number - 1;
    if (status) td_ply_header_free(header);
    return status;
}

/* Words of 128 characters or more count as no number: programs print shorter ones. */
int td_ply_number(td_ply_word word, double *value) {
    char text[128], *end;
    if (word.length == 0 || word.length >= sizeof text) return 0;
    memcpy(text, word.text, word.length);
    text[word.length] = '\0';
    *value = strtod(text, &end);
    return end == text + word.length;
}
