/* The few functions that a pickle of tensors may call. Each is done here by hand, without Python, and only puts data
 * together. */
#include "archive/td_numbers.h"
#include "archive/td_pickle_parts.h"
#include "td_base.h"
#include "td_endian.h"

#include <stdlib.h>
#include <string.h>

enum { ORDERED_DICT, REBUILD_TENSOR, REBUILD_PARAMETER, SIZE, SCALAR, DTYPE, ENCODE, STORAGE }; /* STORAGE + dtype */

static const struct {
    const char *module, *name;
    int meaning;
} globals[] = {
    {"collections", "OrderedDict", ORDERED_DICT},
    {"torch._utils", "_rebuild_tensor_v2", REBUILD_TENSOR},
    {"torch._utils", "_rebuild_parameter", REBUILD_PARAMETER},
    {"torch", "Size", SIZE},
    {"numpy.core.multiarray", "scalar", SCALAR},
    {"numpy._core.multiarray", "scalar", SCALAR}, /* numpy 2 */
    {"numpy", "dtype", DTYPE},
    {"_codecs", "encode", ENCODE}, /* protocol 2 writes bytes as a call of encode(text, 'latin1') */
    {"torch", "FloatStorage", STORAGE + TD_TENSOR_FLOAT32},
    {"torch", "DoubleStorage", STORAGE + TD_TENSOR_FLOAT64},
    {"torch", "HalfStorage", STORAGE + TD_TENSOR_FLOAT16},
    {"torch", "LongStorage", STORAGE + TD_TENSOR_INT64},
    {"torch", "IntStorage", STORAGE + TD_TENSOR_INT32},
    {"torch", "ShortStorage", STORAGE + TD_TENSOR_INT16},
    {"torch", "CharStorage", STORAGE + TD_TENSOR_INT8},
    {"torch", "ByteStorage", STORAGE + TD_TENSOR_UINT8},
    {"torch", "BoolStorage", STORAGE + TD_TENSOR_BOOL},
};

static int is(const char *text, size_t length, const char *expected) {
    return strlen(expected) == length && memcmp(text, expected, length) == 0;
}

/* Letters of a name from the file that an error shows: a damaged file may have a name of any length. */
static int shown(size_t length) { return length > 80 ? 80 : (int)length; }

tides_status td_pickle_global(td_pickle *pickle, const char *module, size_t module_length, const char *name, size_t name_length,
                              td_value **made) {
    for (size_t i = 0; i < sizeof globals / sizeof globals[0]; i++) {
        if (!is(module, module_length, globals[i].module) || !is(name, name_length, globals[i].name)) continue;
        *made = td_tree_integer(pickle->tree, TD_PICKLE_GLOBAL, globals[i].meaning, pickle->error);
        return *made ? TIDES_OK : TIDES_NO_MEMORY;
    }
    return td_fail(pickle->error, TIDES_UNSUPPORTED,
                   "%s: its pickle asks for %.*s.%.*s: only plain values and tensors are read, and nothing is executed",
                   pickle->path, shown(module_length), module, shown(name_length), name);
}

int td_pickle_storage_dtype(const td_value *value) {
    return value && value->kind == TD_PICKLE_GLOBAL && value->as.integer >= STORAGE ? (int)value->as.integer - STORAGE : -1;
}

static tides_status damaged(const td_pickle *p, const char *what) {
    return td_fail(p->error, TIDES_BAD_FILE, "%s: the pickle is damaged before byte %zu: %s", p->path, p->at, what);
}

/* -- tensors -- */

static int read_extents(const td_value *tuple, int ndim, int64_t *extents) {
    for (int d = 0; d < ndim; d++)
        if (!td_value_integer(tuple->as.items[d], &extents[d]) || extents[d] < 0) return 0;
    return 1;
}

/* Product of the extents, or -1 if it is beyond `limit`. */
static int64_t count_elements(const td_tensor *t, int64_t limit) {
    int64_t count = 1;
    for (int d = 0; d < t->ndim; d++)
        if (t->shape[d] == 0) return 0;
    for (int d = 0; d < t->ndim; d++) {
        if (t->shape[d] > limit / count) return -1;
        count *= t->shape[d];
    }
    return count <= limit ? count : -1;
}

/* 1 if all elements lie in a storage of `limit` elements. */
static int lies_within(const td_tensor *t, int64_t limit) {
    if (t->count == 0) return 1;
    if (t->offset >= limit) return 0;
    int64_t left = limit - 1 - t->offset;
    for (int d = 0; d < t->ndim; d++) {
        if (t->shape[d] == 1 || t->stride[d] == 0) continue;
        if (t->shape[d] - 1 > left / t->stride[d]) return 0;
        left -= (t->shape[d] - 1) * t->stride[d];
    }
    return 1;
}

/* Makes a tensor from (storage, offset, shape, stride, requires_grad, hooks). */
static tides_status rebuild_tensor(td_pickle *p, const td_value *arguments, td_value **made) {
    const td_value *source = td_value_item(arguments, 0), *shape = td_value_item(arguments, 2),
                   *stride = td_value_item(arguments, 3);
    td_tensor t = {.ndim = 0};
    if (!source || source->kind != TD_PICKLE_STORAGE || !td_value_integer(td_value_item(arguments, 1), &t.offset) ||
        t.offset < 0 || !shape || !stride || shape->kind != TD_VALUE_TUPLE || stride->kind != TD_VALUE_TUPLE ||
        shape->count != stride->count)
        return damaged(p, "a tensor isn't made of a storage, an offset, a shape and strides");
    if (shape->count > TD_TENSOR_DIMENSIONS_MAX)
        return td_fail(p->error, TIDES_UNSUPPORTED, "%s: a tensor has %zu dimensions: %d are the most that is read", p->path,
                       shape->count, TD_TENSOR_DIMENSIONS_MAX);
    t.ndim = (int)shape->count;
    if (!read_extents(shape, t.ndim, t.shape) || !read_extents(stride, t.ndim, t.stride))
        return damaged(p, "a tensor's shape or stride holds something else than integers from 0");
    const td_storage *storage = (const td_storage *)(const void *)source->as.text;
    t.dtype = storage->dtype;
    t.data = storage->data;
    t.count = count_elements(&t, storage->count);
    if (t.count < 0 || !lies_within(&t, storage->count))
        return td_fail(p->error, TIDES_BAD_FILE,
                       "%s: a tensor of shape %s from element %lld on doesn't fit its storage of %lld", p->path,
                       TD_SHAPE_TEXT(t.ndim, t.shape), (long long)t.offset, (long long)storage->count);
    td_value *value = td_tree_value(p->tree, TD_VALUE_TENSOR, p->error);
    td_tensor *kept = value ? td_tree_alloc(p->tree, sizeof *kept, p->error) : NULL;
    if (!kept) return TIDES_NO_MEMORY;
    *kept = t;
    value->as.tensor = kept;
    *made = value;
    return TIDES_OK;
}

/* Makes a parameter from (tensor, requires_grad, hooks): it becomes its tensor. */
static tides_status rebuild_parameter(td_pickle *p, const td_value *arguments, td_value **made) {
    const td_value *tensor = td_value_item(arguments, 0);
    if (!tensor || tensor->kind != TD_VALUE_TENSOR) return damaged(p, "a parameter holds no tensor");
    *made = arguments->as.items[0];
    return TIDES_OK;
}

/* -- numpy's scalars: scalar(dtype('f8', False, True), bytes) -- */

static tides_status make_dtype(td_pickle *p, const td_value *arguments, td_value **made) {
    static const char *const known[] = {"f2", "f4", "f8", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", "b1"};
    const char *name = td_value_text(td_value_item(arguments, 0));
    size_t i = 0, count = sizeof known / sizeof known[0];
    while (i < count && !(name && strcmp(name, known[i]) == 0)) i++;
    if (i == count)
        return td_fail(p->error, TIDES_UNSUPPORTED, "%s: holds a numpy scalar of dtype %.40s: numbers are read", p->path,
                       name ? name : "of an unknown form");
    if (!(*made = td_tree_text(p->tree, name, 2, p->error))) return TIDES_NO_MEMORY;
    (*made)->kind = TD_PICKLE_DTYPE;
    return TIDES_OK;
}

/* Decodes (text, 'latin1') to bytes: each letter of the text is one byte. */
static tides_status encode(td_pickle *p, const td_value *arguments, td_value **made) {
    const td_value *text = td_value_item(arguments, 0);
    const char *codec = td_value_text(td_value_item(arguments, 1));
    if (!text || text->kind != TD_VALUE_TEXT || !codec || strcmp(codec, "latin1") != 0)
        return damaged(p, "bytes aren't written as latin1 text");
    td_value *bytes = td_tree_text(p->tree, text->as.text, text->count, p->error);
    if (!bytes) return TIDES_NO_MEMORY;
    const unsigned char *in = (const unsigned char *)text->as.text;
    size_t written = 0;
    for (size_t i = 0; i < text->count; i++, written++) {
        unsigned letter = in[i];
        if (letter >= 0x80) { /* U+0080 to U+00FF take two bytes, the first C2 or C3 */
            if ((letter & 0xfe) != 0xc2 || i + 1 == text->count) return damaged(p, "bytes hold a letter beyond latin1");
            letter = (letter & 3) << 6 | (in[++i] & 63u);
        }
        bytes->as.text[written] = (char)letter;
    }
    bytes->as.text[written] = 0;
    bytes->count = written;
    *made = bytes;
    return TIDES_OK;
}

static tides_status make_scalar(td_pickle *p, const td_value *arguments, td_value **made) {
    const td_value *dtype = td_value_item(arguments, 0), *bytes = td_value_item(arguments, 1);
    if (!dtype || dtype->kind != TD_PICKLE_DTYPE || !bytes || bytes->kind != TD_VALUE_TEXT)
        return damaged(p, "a numpy scalar isn't made of a dtype and bytes");
    char kind = dtype->as.text[0];
    size_t width = (size_t)(dtype->as.text[1] - '0');
    if (bytes->count != width) return damaged(p, "a numpy scalar has the wrong number of bytes");
    const uint64_t bits = td_le_number((const unsigned char *)bytes->as.text, width);
    uint64_t sign = UINT64_C(1) << (8 * width - 1);
    if (kind == 'f')
        *made = td_tree_number(p->tree, td_float_bits(bits, width), p->error);
    else if (kind == 'u' && bits > INT64_MAX)
        *made = td_tree_number(p->tree, (double)bits, p->error);
    else
        *made = td_tree_integer(p->tree, kind == 'b' ? TD_VALUE_BOOL : TD_VALUE_INT,
                                (int64_t)(kind == 'i' ? (bits ^ sign) - sign : bits), p->error);
    return *made ? TIDES_OK : TIDES_NO_MEMORY;
}

/* ------------------------------------------------------------------------------------------------------------------- */

static tides_status make_dict(td_pickle *p, const td_value *arguments, td_value **made) {
    if (arguments->count) return damaged(p, "an OrderedDict is made of something");
    *made = td_tree_value(p->tree, TD_VALUE_DICT, p->error);
    return *made ? TIDES_OK : TIDES_NO_MEMORY;
}

static tides_status make_size(td_pickle *p, const td_value *arguments, td_value **made) {
    const td_value *extents = td_value_item(arguments, 0);
    if (!extents || extents->kind != TD_VALUE_TUPLE) return damaged(p, "a torch.Size isn't made of a tuple");
    *made = arguments->as.items[0];
    return TIDES_OK;
}

tides_status td_pickle_call(td_pickle *pickle, const td_value *callee, const td_value *arguments, td_value **made) {
    static tides_status (*const calls[])(td_pickle *, const td_value *, td_value **) = {[ORDERED_DICT] = make_dict,
                                                                                        [REBUILD_TENSOR] = rebuild_tensor,
                                                                                        [REBUILD_PARAMETER] = rebuild_parameter,
                                                                                        [SIZE] = make_size,
                                                                                        [SCALAR] = make_scalar,
                                                                                        [DTYPE] = make_dtype,
                                                                                        [ENCODE] = encode};
    if (callee->kind != TD_PICKLE_GLOBAL || callee->as.integer >= STORAGE || arguments->kind != TD_VALUE_TUPLE)
        return damaged(pickle, "it calls something that isn't a function");
    return calls[callee->as.integer](pickle, arguments, made);
}

tides_status td_pickle_build(td_pickle *pickle, const td_value *object, const td_value *state) {
    if (object->kind == TD_VALUE_DICT || object->kind == TD_VALUE_TENSOR) return TIDES_OK;
    if (object->kind != TD_PICKLE_DTYPE) return damaged(pickle, "it sets attributes of something that has none");
    const char *order = td_value_text(td_value_item(state, 1)); /* state is (version, byte order, ...) */
    if (order && (strcmp(order, "<") == 0 || strcmp(order, "|") == 0)) return TIDES_OK;
    return td_fail(pickle->error, TIDES_UNSUPPORTED, "%s: holds a numpy scalar that isn't little-endian", pickle->path);
}
