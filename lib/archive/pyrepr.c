/* Parses Python literals as repr() writes them (cfg_args files, .npy headers) into a tree of values, by recursive descent.
 * Nothing is executed: a name that isn't part of a literal is an error. */
#include "archive/td_pyrepr.h"
#include "archive/td_tree.h"
#include "td_base.h"
#include "td_text.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A cfg_args file is far below a megabyte, and its numbers are far below 64 characters. */
enum { FILE_BYTES_MAX = 1 << 20, NUMBER_MAX = 64 };

typedef struct parser {
    const char *path, *start, *at, *end; /* a NUL follows `end` */
    td_tree *tree;
    int depth;
    tides_status status; /* of the failure, after a function returned NULL */
    tides_error *error;
} parser;

static td_value *parse_value(parser *p);

/* Fails with the column, which counts from 1 as in editors. The files have one line only. */
static td_value *refuse(parser *p, const char *what) {
    p->status = td_fail(p->error, TIDES_BAD_FILE, "%s: column %zu: %s, not '%.*s': this isn't what Python's repr() writes",
                        p->path, (size_t)(p->at - p->start) + 1, what, p->end - p->at > 16 ? 16 : (int)(p->end - p->at), p->at);
    return NULL;
}

static td_value *no_memory(parser *p) {
    p->status = TIDES_NO_MEMORY;
    return NULL;
}

static td_value *made(parser *p, td_value *value) { return value ? value : no_memory(p); }

static int is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
static int is_digit(char c) { return c >= '0' && c <= '9'; }

static void skip_space(parser *p) {
    while (p->at < p->end && (*p->at == ' ' || *p->at == '\n' || *p->at == '\r' || *p->at == '\t')) p->at++;
}

/* Skips `c` if it comes next; returns 1 if it did. */
static int take(parser *p, char c) {
    skip_space(p);
    if (p->at == p->end || *p->at != c) return 0;
    p->at++;
    return 1;
}

/* Length of the identifier that comes next. */
static size_t word_length(const parser *p) {
    const char *c = p->at;
    while (c < p->end && (is_letter(*c) || (c > p->at && is_digit(*c)))) c++;
    return (size_t)(c - p->at);
}

static int word_is(const char *word, size_t length, const char *text) {
    return strlen(text) == length && memcmp(word, text, length) == 0;
}

/* -- texts -- */

static int hex_digit(char c) {
    if (is_digit(c)) return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* The code point written as `digits` hexadecimal digits at `at`, or -1. */
static int64_t hex(const parser *p, const char *at, int digits) {
    int64_t value = 0;
    if (p->end - at < digits) return -1;
    for (int i = 0; i < digits; i++) {
        int digit = hex_digit(at[i]);
        if (digit < 0) return -1;
        value = value << 4 | digit;
    }
    return value <= 0x10ffff ? value : -1;
}

/* Writes a code point as UTF-8, in no more bytes than its escape had characters. */
static size_t put_utf8(char *out, int64_t c) {
    size_t length = c < 0x80 ? 1 : c < 0x800 ? 2 : c < 0x10000 ? 3 : 4;
    static const unsigned char lead[5] = {0, 0, 0xc0, 0xe0, 0xf0};
    for (size_t i = length; i-- > 1; c >>= 6) out[i] = (char)(0x80 | (c & 0x3f));
    out[0] = (char)(lead[length] | c);
    return length;
}

/* Decodes the escape behind a backslash into `out`, and moves `p->at` past it. Returns the bytes written, 0 if it is no
 * escape. */
static size_t read_escape(parser *p, char *out) {
    static const char names[] = "\\'\"nrtabfv0", meanings[] = "\\'\"\n\r\t\a\b\f\v";
    char c = p->at < p->end ? *p->at : 0;
    const char *name = c ? strchr(names, c) : NULL;
    if (name) {
        *out = meanings[name - names]; /* for \0 this is the NUL at the end of `meanings` */
        p->at++;
        return 1;
    }
    int digits = c == 'x' ? 2 : c == 'u' ? 4 : c == 'U' ? 8 : 0;
    int64_t value = digits ? hex(p, p->at + 1, digits) : -1;
    if (value < 0) return 0;
    p->at += 1 + digits;
    return put_utf8(out, value);
}

static td_value *parse_text(parser *p) {
    char quote = *p->at++;
    td_value *value = td_tree_text(p->tree, p->at, 0, p->error);
    const char *stop = p->at; /* upper bound of the text's length */
    while (stop < p->end && *stop != quote) stop += *stop == '\\' && stop + 1 < p->end ? 2 : 1;
    char *out = value ? td_tree_alloc(p->tree, (size_t)(stop - p->at) + 1, p->error) : NULL;
    if (!out) return no_memory(p);
    value->as.text = out;
    while (p->at < p->end && *p->at != quote) {
        char c = *p->at++;
        size_t length = 1;
        if (c == '\\')
            length = read_escape(p, out);
        else
            *out = c;
        if (length == 0) return refuse(p, "an escape like \\n, \\x41 or \\u0041 was expected");
        out += length;
    }
    if (p->at == p->end) return refuse(p, "a closing quote was expected");
    p->at++;
    *out = 0;
    value->count = (size_t)(out - value->as.text);
    return value;
}

/* -- numbers and names -- */

static td_value *parse_number(parser *p) {
    char text[NUMBER_MAX + 1];
    size_t length = 0;
    int whole = 1;
    for (const char *c = p->at; c < p->end && length < NUMBER_MAX; c++) {
        int sign = (*c == '-' || *c == '+') && (c == p->at || c[-1] == 'e' || c[-1] == 'E');
        if (!is_digit(*c) && !sign && *c != '.' && *c != 'e' && *c != 'E') break;
        whole = whole && *c != '.' && *c != 'e' && *c != 'E';
        text[length++] = *c;
    }
    text[length] = 0;
    char *end = text;
    errno = 0;
    long long integer = whole ? strtoll(text, &end, 10) : 0;
    int overflow = errno == ERANGE;
    double number = whole && !overflow ? 0 : strtod(text, &end);
    if (length == 0 || length == NUMBER_MAX || *end || end == text) return refuse(p, "a number was expected");
    p->at += length;
    return made(p, whole && !overflow ? td_tree_integer(p->tree, TD_VALUE_INT, integer, p->error)
                                      : td_tree_number(p->tree, number, p->error));
}

/* Parses inf and nan, with or without a minus. */
static td_value *parse_unusual(parser *p, size_t length) {
    int minus = *p->at == '-';
    double value = word_is(p->at + minus, 3, "inf") ? INFINITY : NAN;
    p->at += length;
    return made(p, td_tree_number(p->tree, minus ? -value : value, p->error));
}

/* -- containers -- */

/* Parses items up to `close`, each by `add`. `*comma` is 1 if a comma precedes `close`. */
static td_value *parse_items(parser *p, td_value *into, char close, tides_status (*add)(parser *p, td_value *into),
                             int *comma) {
    if (!into) return no_memory(p);
    if (++p->depth > TD_VALUE_DEPTH_MAX) return refuse(p, "at most 64 levels of nesting are expected");
    *comma = 0;
    while (!take(p, close)) {
        if ((p->status = add(p, into))) return NULL;
        *comma = take(p, ',');
        if (*comma) continue;
        if (!take(p, close)) return refuse(p, "a comma or a closing bracket was expected");
        break;
    }
    p->depth--;
    return into;
}

static tides_status add_item(parser *p, td_value *into) {
    td_value *item = parse_value(p);
    return item ? td_tree_append(p->tree, into, item, p->error) : p->status;
}

static tides_status add_pair(parser *p, td_value *into) {
    td_value *key = parse_value(p);
    if (key && !take(p, ':')) key = refuse(p, "a colon was expected");
    td_value *value = key ? parse_value(p) : NULL;
    return value ? td_tree_put(p->tree, into, key, value, p->error) : p->status;
}

/* key=value */
static tides_status add_named(parser *p, td_value *into) {
    skip_space(p);
    size_t length = word_length(p);
    td_value *key = td_tree_text(p->tree, p->at, length, p->error);
    if (!key) return TIDES_NO_MEMORY;
    p->at += length;
    if (length == 0 || !take(p, '=')) {
        refuse(p, "key=value was expected");
        return p->status;
    }
    td_value *value = parse_value(p);
    return value ? td_tree_put(p->tree, into, key, value, p->error) : p->status;
}

static td_value *parse_word(parser *p) {
    static const struct {
        const char *word;
        int kind, value;
    } plain[] = {{"None", TD_VALUE_NONE, 0}, {"True", TD_VALUE_BOOL, 1}, {"False", TD_VALUE_BOOL, 0}};
    size_t length = word_length(p);
    for (size_t i = 0; i < sizeof plain / sizeof plain[0]; i++) {
        if (!word_is(p->at, length, plain[i].word)) continue;
        p->at += length;
        return made(p, td_tree_integer(p->tree, plain[i].kind, plain[i].value, p->error));
    }
    if (word_is(p->at, length, "inf") || word_is(p->at, length, "nan")) return parse_unusual(p, length);
    const char *name = p->at;
    int comma;
    if (!word_is(name, length, "Namespace")) return refuse(p, "a plain value was expected");
    p->at += length;
    if (!take(p, '(')) return refuse(p, "an opening bracket was expected");
    return parse_items(p, td_tree_value(p->tree, TD_VALUE_DICT, p->error), ')', add_named, &comma);
}

static td_value *parse_value(parser *p) {
    int comma = 0;
    skip_space(p);
    if (p->at == p->end) return refuse(p, "a value was expected");
    char c = *p->at;
    if (c == '\'' || c == '"') return parse_text(p);
    if (is_letter(c)) return parse_word(p);
    if (c == '-' && p->end - p->at >= 4 && memcmp(p->at, "-inf", 4) == 0) return parse_unusual(p, 4);
    if (take(p, '[')) return parse_items(p, td_tree_value(p->tree, TD_VALUE_LIST, p->error), ']', add_item, &comma);
    if (take(p, '{')) return parse_items(p, td_tree_value(p->tree, TD_VALUE_DICT, p->error), '}', add_pair, &comma);
    if (!take(p, '(')) return parse_number(p);
    td_value *tuple = parse_items(p, td_tree_value(p->tree, TD_VALUE_TUPLE, p->error), ')', add_item, &comma);
    /* (3) is 3 in brackets; a tuple of one item needs a comma. */
    return tuple && tuple->count == 1 && !comma ? tuple->as.items[0] : tuple;
}

static td_value *parse_in_c_locale(parser *p) {
    td_plain_numbers numbers;
    if (td_plain_begin(&numbers, p->path, p->error) != TIDES_OK) return no_memory(p);
    td_value *root = parse_value(p);
    td_plain_end(&numbers);
    skip_space(p);
    return root && p->at < p->end ? refuse(p, "nothing more was expected") : root;
}

tides_status td_pyrepr_parse(const char *path, const char *text, size_t size, td_tree **tree, tides_error *error) {
    parser p = {.path = path, .error = error};
    if (!(p.tree = td_tree_create(error))) return TIDES_NO_MEMORY;
    td_value *copy = td_tree_text(p.tree, text, size, error); /* copied so that a NUL follows, at which strtod stops */
    if (copy) p.start = p.at = copy->as.text;
    if (copy) p.end = p.start + size;
    td_value *root = copy ? parse_in_c_locale(&p) : no_memory(&p);
    if (!root) {
        td_tree_free(p.tree);
        return p.status;
    }
    td_tree_set_root(p.tree, root);
    *tree = p.tree;
    return TIDES_OK;
}

tides_status td_pyrepr_open(const char *path, td_tree **tree, tides_error *error) {
    char *text = NULL;
    size_t size = 0;
    tides_status status = td_read_file(path, FILE_BYTES_MAX, &text, &size, error);
    if (!status) status = td_pyrepr_parse(path, text, size, tree, error);
    free(text);
    return status;
}
