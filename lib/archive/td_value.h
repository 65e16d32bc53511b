/* Internal: a tree of plain values that a Python program wrote, read from a pickle or from Python literals. All values belong
 * to the td_tree and live as long as it does. A value may be shared (pickles do that), but never contains itself. Several
 * threads may read a finished tree at once. */
#ifndef TD_VALUE_H
#define TD_VALUE_H

#include "tides/base.h"

enum {
    TD_VALUE_NONE,
    TD_VALUE_BOOL,
    TD_VALUE_INT,
    TD_VALUE_FLOAT,
    TD_VALUE_TEXT,
    TD_VALUE_LIST,
    TD_VALUE_TUPLE,
    TD_VALUE_DICT, /* keys are mostly texts; an optimizer's are ints */
    TD_VALUE_TENSOR
};

enum {
    TD_TENSOR_FLOAT32,
    TD_TENSOR_FLOAT64,
    TD_TENSOR_FLOAT16,
    TD_TENSOR_INT64,
    TD_TENSOR_INT32,
    TD_TENSOR_INT16,
    TD_TENSOR_INT8,
    TD_TENSOR_UINT8,
    TD_TENSOR_BOOL
};

/* Grids and convolutions need 4; the rest is room. */
enum { TD_TENSOR_DIMENSIONS_MAX = 8 };

/* A view of a storage: element (i, j, ..) is number offset + i stride[0] + j stride[1] + .. of `data`. All elements lie
 * within the storage, and there are no more elements than the storage has. */
typedef struct td_tensor {
    int dtype, ndim; /* ndim 0: a scalar */
    int64_t shape[TD_TENSOR_DIMENSIONS_MAX], stride[TD_TENSOR_DIMENSIONS_MAX];
    int64_t offset, count;     /* count: product of the extents */
    const unsigned char *data; /* the storage; little-endian, unaligned */
} td_tensor;

typedef struct td_value td_value;
struct td_value {
    int kind;
    int mark;     /* used by td_tree_check alone */
    size_t count; /* text: bytes; list, tuple: items; dict: pairs */
    union {
        int64_t integer;  /* TD_VALUE_BOOL (0 or 1), TD_VALUE_INT */
        double number;    /* TD_VALUE_FLOAT */
        char *text;       /* UTF-8, a NUL follows; may hold further NULs */
        td_value **items; /* dict: key 0, value 0, key 1, value 1 .. in the file's order */
        td_tensor *tensor;
    } as;
};

typedef struct td_tree td_tree;

const td_value *td_tree_root(const td_tree *tree);
void td_tree_free(td_tree *tree); /* NULL is fine */

/* -- look-ups: a NULL value is allowed, and gives nothing --------------------------------------------- */

/* A dict's value for a text key; of equal keys the last counts. NULL if the key is absent, or `dict` is no dict. */
const td_value *td_value_get(const td_value *dict, const char *key);

/* An item of a list or tuple; NULL if out of range, or neither. */
const td_value *td_value_item(const td_value *sequence, size_t index);

/* 1, and `*out` set, if the value is of that kind; otherwise 0, and `*out` unchanged. A number is an int, a float or a bool. */
int td_value_number(const td_value *value, double *out);
int td_value_integer(const td_value *value, int64_t *out);
int td_value_bool(const td_value *value, int *out);

/* The text; NULL if the value isn't a text, or contains a NUL. */
const char *td_value_text(const td_value *value);

/* "dict", "tensor" .., for messages; "nothing" for NULL. */
const char *td_value_kind(const td_value *value);

/* -- tensors ----------------------------------------------------------------------------------------------------------- */

/* The tensor with text key `key` in a dict, or TIDES_BAD_FILE naming it. */
tides_status td_value_tensor(const td_value *dict, const char *key, const td_tensor **tensor, tides_error *error);

/* TIDES_BAD_FILE naming the tensor as `name` unless it has `ndim` extents equal to `shape` (-1: any). */
tides_status td_tensor_check_shape(const td_tensor *tensor, const char *name, int ndim, const int64_t *shape,
                                   tides_error *error);

/* TIDES_BAD_FILE, naming the tensor and the element, unless all are finite after conversion to float. */
tides_status td_tensor_check_finite(const td_tensor *tensor, const char *name, tides_error *error);

/* Element `index` in C order, 0 <= index < count, of any dtype. */
double td_tensor_at(const td_tensor *tensor, int64_t index);

/* All elements in C order as floats, which the caller frees. Values may be NaN. Fails with TIDES_NO_MEMORY only. */
tides_status td_tensor_floats(const td_tensor *tensor, float **values, tides_error *error);

/* The tensor `key` of a dict as floats, which the caller frees, after checks of its shape and that all are finite. */
tides_status td_value_floats(const td_value *dict, const char *key, int ndim, const int64_t *shape, float **values,
                             tides_error *error);

#endif
