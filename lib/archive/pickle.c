/* A stack machine for Python's pickle, protocol 2 (pickletools.py documents every instruction). It has the instructions that
 * torch.save writes, without those that could run code. */
#include "archive/td_pickle.h"
#include "archive/td_numbers.h"
#include "archive/td_pickle_parts.h"
#include "td_base.h"
#include "td_endian.h"

#include <stdlib.h>
#include <string.h>

enum { PICKLE_BYTES_MAX = 1 << 24 }; /* the tensors' data lies outside the pickle, and an optimizer's pickle is below 1 MiB */

enum { /* clang-format off */
    OP_MARK = '(', OP_STOP = '.', OP_NONE = 'N', OP_TRUE = 0x88, OP_FALSE = 0x89, OP_BININT = 'J', OP_BININT1 = 'K',
    OP_BININT2 = 'M', OP_LONG1 = 0x8a, OP_BINFLOAT = 'G', OP_BINUNICODE = 'X', OP_EMPTY_LIST = ']', OP_EMPTY_DICT = '}',
    OP_EMPTY_TUPLE = ')', OP_TUPLE = 't', OP_TUPLE1 = 0x85, OP_TUPLE2 = 0x86, OP_TUPLE3 = 0x87, OP_APPEND = 'a',
    OP_APPENDS = 'e', OP_SETITEM = 's', OP_SETITEMS = 'u', OP_BINPUT = 'q', OP_LONG_BINPUT = 'r', OP_BINGET = 'h',
    OP_LONG_BINGET = 'j', OP_GLOBAL = 'c', OP_REDUCE = 'R', OP_BUILD = 'b', OP_BINPERSID = 'Q', OP_PROTO = 0x80
}; /* clang-format on */

static tides_status damaged(const td_pickle *p, const char *what) {
    td_fail(p->error, TIDES_BAD_FILE, "%s: the pickle is damaged at byte %zu: %s", p->path, p->at, what);
    return TIDES_BAD_FILE;
}

/* The next `count` bytes as a little-endian number. */
static tides_status read_number(td_pickle *p, size_t count, uint64_t *value) {
    if (p->size - p->at < count) return damaged(p, "it ends within an instruction");
    *value = td_le_number(p->bytes + p->at, count);
    p->at += count;
    return TIDES_OK;
}

/* Pushes a value, or a mark for NULL. */
static tides_status put(td_pickle *p, td_value *value) {
    void *stack = p->stack;
    tides_status status = td_reserve(&stack, &p->stack_capacity, p->depth + 1, sizeof *p->stack, p->error);
    p->stack = stack;
    if (!status && p->stack) p->stack[p->depth++] = value;
    return status;
}

/* Pushes a new value; NULL means that its allocation failed. */
static tides_status push(td_pickle *p, td_value *value) { return value ? put(p, value) : TIDES_NO_MEMORY; }

/* Takes the top value off the stack. */
static tides_status pop(td_pickle *p, td_value **value) {
    if (p->depth == 0 || !p->stack[p->depth - 1]) return damaged(p, "a value is missing");
    *value = p->stack[--p->depth];
    return TIDES_OK;
}

/* Counts the values above the newest mark. */
static tides_status count_to_mark(td_pickle *p, size_t *count) {
    *count = 0;
    while (*count < p->depth && p->stack[p->depth - 1 - *count]) ++*count;
    return *count < p->depth ? TIDES_OK : damaged(p, "a mark is missing");
}

/* The container of kind `kind` below the top `above` values (and, if `marked`, the mark). */
static tides_status below(td_pickle *p, size_t above, int kind, td_value **container) {
    td_value *found = p->depth > above ? p->stack[p->depth - 1 - above] : NULL;
    if (!found || found->kind != kind) return damaged(p, "items go to something that can't hold them");
    *container = found;
    return TIDES_OK;
}

static tides_status make_tuple(td_pickle *p, size_t count, size_t dropped) {
    td_value *tuple = td_tree_value(p->tree, TD_VALUE_TUPLE, p->error);
    tides_status status = tuple ? TIDES_OK : TIDES_NO_MEMORY;
    if (p->depth < count + dropped) return damaged(p, "a value is missing");
    for (size_t i = p->depth - count; i < p->depth && !status; i++)
        status = p->stack[i] ? td_tree_append(p->tree, tuple, p->stack[i], p->error) : damaged(p, "a value is missing");
    if (status) return status;
    p->depth -= count + dropped;
    return push(p, tuple);
}

/* Moves the top `count` values into the list or dict below them, and drops `dropped` marks in between. */
static tides_status fill(td_pickle *p, int kind, size_t count, size_t dropped) {
    td_value *into = NULL;
    size_t step = kind == TD_VALUE_DICT ? 2 : 1;
    tides_status status = below(p, count + dropped, kind, &into);
    if (!status && count % step) status = damaged(p, "a key has no value");
    for (size_t i = p->depth - count; i < p->depth && !status; i += step) {
        td_value *first = p->stack[i], *second = step == 2 ? p->stack[i + 1] : NULL;
        if (!first || (step == 2 && !second)) return damaged(p, "a value is missing");
        status =
            step == 2 ? td_tree_put(p->tree, into, first, second, p->error) : td_tree_append(p->tree, into, first, p->error);
    }
    if (!status) p->depth -= count + dropped;
    return status;
}

static tides_status with_mark(td_pickle *p, int op) {
    size_t count = 0;
    tides_status status = count_to_mark(p, &count);
    if (status) return status;
    if (op == OP_TUPLE) return make_tuple(p, count, 1);
    return fill(p, op == OP_SETITEMS ? TD_VALUE_DICT : TD_VALUE_LIST, count, 1);
}

/* -- memo -- */

static tides_status memo_put(td_pickle *p, size_t width) {
    uint64_t index = 0;
    tides_status status = read_number(p, width, &index);
    if (status) return status;
    /* each entry takes an instruction, so the memo can't be larger than the pickle */
    if (index >= p->size) return damaged(p, "its memo is larger than itself");
    if (p->depth == 0 || !p->stack[p->depth - 1]) return damaged(p, "a value is missing");
    size_t had = p->memo_count;
    void *memo = p->memo;
    status = td_reserve(&memo, &p->memo_count, (size_t)index + 1, sizeof *p->memo, p->error);
    p->memo = memo;
    if (status) return status;
    for (size_t i = had; i < p->memo_count; i++) p->memo[i] = NULL;
    p->memo[index] = p->stack[p->depth - 1];
    return TIDES_OK;
}

static tides_status memo_get(td_pickle *p, size_t width) {
    uint64_t index = 0;
    tides_status status = read_number(p, width, &index);
    if (status) return status;
    if (index >= p->memo_count || !p->memo[index]) return damaged(p, "its memo has no such entry");
    return push(p, p->memo[index]);
}

/* -- plain values -- */

/* Sign-extends a number of `bytes` bytes. */
static int64_t with_sign(uint64_t bits, unsigned bytes) {
    uint64_t sign = bytes ? UINT64_C(1) << (8 * bytes - 1) : 0;
    return (int64_t)((bits ^ sign) - sign);
}

static tides_status push_integer(td_pickle *p, unsigned bytes, int has_sign) {
    uint64_t bits = 0;
    tides_status status = read_number(p, bytes, &bits);
    if (status) return status;
    int64_t value = has_sign ? with_sign(bits, bytes) : (int64_t)bits;
    return push(p, td_tree_integer(p->tree, TD_VALUE_INT, value, p->error));
}

static tides_status push_long(td_pickle *p) {
    uint64_t bytes = 0;
    tides_status status = read_number(p, 1, &bytes);
    if (!status && bytes > 8) return damaged(p, "an integer has more than 64 bits");
    return status ? status : push_integer(p, (unsigned)bytes, 1);
}

/* Floats are big-endian in protocol 2; all other numbers are little-endian. */
static tides_status push_float(td_pickle *p) {
    if (p->size - p->at < 8) return damaged(p, "it ends within an instruction");
    const uint64_t bits = td_be64(p->bytes + p->at);
    p->at += 8;
    return push(p, td_tree_number(p->tree, td_float_bits(bits, 8), p->error));
}

static tides_status push_text(td_pickle *p) {
    uint64_t length = 0;
    tides_status status = read_number(p, 4, &length);
    if (!status && length > p->size - p->at) return damaged(p, "a text is longer than what is left");
    if (status) return status;
    td_value *text = td_tree_text(p->tree, (const char *)p->bytes + p->at, (size_t)length, p->error);
    p->at += (size_t)length;
    return push(p, text);
}

/* -- names of functions and their calls -- */

/* Reads a line; `length` is without the line end. */
static tides_status read_line(td_pickle *p, const char **line, size_t *length) {
    const unsigned char *start = p->bytes + p->at, *end = memchr(start, '\n', p->size - p->at);
    if (!end) return damaged(p, "a name has no end");
    *line = (const char *)start;
    *length = (size_t)(end - start);
    p->at += *length + 1;
    return TIDES_OK;
}

static tides_status push_global(td_pickle *p) {
    const char *module = NULL, *name = NULL;
    size_t module_length = 0, name_length = 0;
    td_value *made = NULL;
    tides_status status = read_line(p, &module, &module_length);
    if (!status) status = read_line(p, &name, &name_length);
    if (!status) status = td_pickle_global(p, module, module_length, name, name_length, &made);
    return status ? status : push(p, made);
}

static tides_status reduce(td_pickle *p) {
    td_value *callee = NULL, *arguments = NULL, *made = NULL;
    tides_status status = pop(p, &arguments);
    if (!status) status = pop(p, &callee);
    if (!status) status = td_pickle_call(p, callee, arguments, &made);
    return status ? status : push(p, made);
}

static tides_status build(td_pickle *p) {
    td_value *state = NULL, *object = NULL;
    tides_status status = pop(p, &state);
    if (!status) status = pop(p, &object);
    if (!status) status = td_pickle_build(p, object, state);
    return status ? status : push(p, object);
}

static tides_status persistent(td_pickle *p) {
    td_value *id = NULL, *made = NULL;
    tides_status status = pop(p, &id);
    if (!status) status = p->persistent(p, id, &made);
    return status ? status : push(p, made);
}

static tides_status check_protocol(td_pickle *p) {
    uint64_t protocol = 0;
    tides_status status = read_number(p, 1, &protocol);
    if (status || protocol == 2) return status;
    return td_fail(p->error, TIDES_UNSUPPORTED, "%s: is a pickle of protocol %u: 2, torch.save's default, is read", p->path,
                   (unsigned)protocol);
}

/* -- the machine -- */

static tides_status step(td_pickle *p, int op) {
    switch (op) {
        case OP_PROTO: return check_protocol(p);
        case OP_MARK: return put(p, NULL);
        case OP_NONE: return push(p, td_tree_value(p->tree, TD_VALUE_NONE, p->error));
        case OP_TRUE: return push(p, td_tree_integer(p->tree, TD_VALUE_BOOL, 1, p->error));
        case OP_FALSE: return push(p, td_tree_integer(p->tree, TD_VALUE_BOOL, 0, p->error));
        case OP_BININT: return push_integer(p, 4, 1);
        case OP_BININT1: return push_integer(p, 1, 0);
        case OP_BININT2: return push_integer(p, 2, 0);
        case OP_LONG1: return push_long(p);
        case OP_BINFLOAT: return push_float(p);
        case OP_BINUNICODE: return push_text(p);
        case OP_EMPTY_LIST: return push(p, td_tree_value(p->tree, TD_VALUE_LIST, p->error));
        case OP_EMPTY_DICT: return push(p, td_tree_value(p->tree, TD_VALUE_DICT, p->error));
        case OP_EMPTY_TUPLE: return push(p, td_tree_value(p->tree, TD_VALUE_TUPLE, p->error));
        case OP_TUPLE1: return make_tuple(p, 1, 0);
        case OP_TUPLE2: return make_tuple(p, 2, 0);
        case OP_TUPLE3: return make_tuple(p, 3, 0);
        case OP_TUPLE:
        case OP_APPENDS:
        case OP_SETITEMS: return with_mark(p, op);
        case OP_APPEND: return fill(p, TD_VALUE_LIST, 1, 0);
        case OP_SETITEM: return fill(p, TD_VALUE_DICT, 2, 0);
        case OP_BINPUT: return memo_put(p, 1);
        case OP_LONG_BINPUT: return memo_put(p, 4);
        case OP_BINGET: return memo_get(p, 1);
        case OP_LONG_BINGET: return memo_get(p, 4);
        case OP_GLOBAL: return push_global(p);
        case OP_REDUCE: return reduce(p);
        case OP_BUILD: return build(p);
        case OP_BINPERSID: return persistent(p);
        default:
            return td_fail(p->error, TIDES_UNSUPPORTED,
                           "%s: the pickle has instruction 0x%02x at byte %zu, which torch.save "
                           "doesn't write: it isn't obeyed",
                           p->path, (unsigned)op, p->at - 1);
    }
}

tides_status td_pickle_run(td_pickle *pickle, td_value **root) {
    if (pickle->size > PICKLE_BYTES_MAX)
        return td_fail(pickle->error, TIDES_UNSUPPORTED, "%s: its pickle has %zu bytes: %d are the most that is read",
                       pickle->path, pickle->size, PICKLE_BYTES_MAX);
    tides_status status = TIDES_OK;
    int op = 0;
    while (!status && pickle->at < pickle->size && (op = pickle->bytes[pickle->at++]) != OP_STOP) status = step(pickle, op);
    if (!status && op != OP_STOP) status = damaged(pickle, "it ends without its last instruction");
    if (!status) status = pop(pickle, root);
    free(pickle->stack);
    free(pickle->memo);
    return status;
}
