/* Reads tensors of torch files, which are views of storages with strides: copies them in C order as float or double, and
 * checks shapes and values. */
#include "archive/td_numbers.h"
#include "archive/td_tree.h"
#include "td_base.h"
#include "td_endian.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const size_t widths[] =
    {[TD_TENSOR_FLOAT32] = 4, [TD_TENSOR_FLOAT64] = 8, [TD_TENSOR_FLOAT16] = 2, [TD_TENSOR_INT64] = 8, [TD_TENSOR_INT32] = 4,
     [TD_TENSOR_INT16] = 2,   [TD_TENSOR_INT8] = 1,    [TD_TENSOR_UINT8] = 1,   [TD_TENSOR_BOOL] = 1};

size_t td_tensor_width(int dtype) { return widths[dtype]; }

/* One element of a storage. */
static double load(const td_tensor *t, int64_t number) {
    size_t width = widths[t->dtype];
    const uint64_t bits = td_le_number(t->data + (size_t)number * width, width);
    switch (t->dtype) {
        case TD_TENSOR_FLOAT32:
        case TD_TENSOR_FLOAT64:
        case TD_TENSOR_FLOAT16: return td_float_bits(bits, width);
        case TD_TENSOR_INT64: return (double)(int64_t)bits;
        case TD_TENSOR_INT32: return (double)(int32_t)(uint32_t)bits;
        case TD_TENSOR_INT16: return (double)(int16_t)(uint16_t)bits;
        case TD_TENSOR_INT8: return (double)(int8_t)(uint8_t)bits;
        case TD_TENSOR_UINT8: return (double)bits;
        default: return bits != 0; /* bool */
    }
}

/* Index in the storage of the `index`-th element in C order. */
static int64_t place(const td_tensor *t, int64_t index) {
    int64_t number = t->offset;
    for (int d = t->ndim; d-- > 0; index /= t->shape[d]) number += index % t->shape[d] * t->stride[d];
    return number;
}

double td_tensor_at(const td_tensor *tensor, int64_t index) { return load(tensor, place(tensor, index)); }

static int is_contiguous(const td_tensor *t) {
    int64_t expected = 1;
    for (int d = t->ndim; d-- > 0; expected *= t->shape[d])
        if (t->shape[d] != 1 && t->stride[d] != expected) return 0;
    return 1;
}

static float to_float(double value) {
    return fabs(value) <= FLT_MAX || value != value ? (float)value : (float)copysign(INFINITY, value);
}

tides_status td_tensor_floats(const td_tensor *tensor, float **values, tides_error *error) {
    float *made = td_alloc((size_t)tensor->count, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    int contiguous = is_contiguous(tensor); /* the common case, without the divisions of place() */
    for (int64_t i = 0; i < tensor->count; i++)
        made[i] = to_float(load(tensor, contiguous ? tensor->offset + i : place(tensor, i)));
    *values = made;
    return TIDES_OK;
}

tides_status td_value_tensor(const td_value *dict, const char *key, const td_tensor **tensor, tides_error *error) {
    const td_value *value = td_value_get(dict, key);
    if (!value || value->kind != TD_VALUE_TENSOR) {
        if (value)
            td_fail(error, TIDES_BAD_FILE, "%s is a %s: a tensor was expected", key, td_value_kind(value));
        else
            td_fail(error, TIDES_BAD_FILE, "there is no tensor %s", key);
        return TIDES_BAD_FILE;
    }
    *tensor = value->as.tensor;
    return TIDES_OK;
}

tides_status td_tensor_check_shape(const td_tensor *tensor, const char *name, int ndim, const int64_t *shape,
                                   tides_error *error) {
    int fits = tensor->ndim == ndim;
    for (int d = 0; d < ndim && fits; d++) fits = shape[d] < 0 || shape[d] == tensor->shape[d];
    if (fits) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "tensor %s has shape %s: %s was expected", name,
                   TD_SHAPE_TEXT(tensor->ndim, tensor->shape), TD_SHAPE_TEXT(ndim, shape));
}

tides_status td_tensor_check_finite(const td_tensor *tensor, const char *name, tides_error *error) {
    for (int64_t i = 0; i < tensor->count; i++) {
        double value = td_tensor_at(tensor, i);
        if (!(fabs(value) <= FLT_MAX))
            return td_fail(error, TIDES_BAD_FILE, "tensor %s: element %lld is %g: it must be finite", name, (long long)i,
                           value);
    }
    return TIDES_OK;
}

tides_status td_value_floats(const td_value *dict, const char *key, int ndim, const int64_t *shape, float **values,
                             tides_error *error) {
    const td_tensor *tensor = NULL;
    tides_status status = td_value_tensor(dict, key, &tensor, error);
    if (!status) status = td_tensor_check_shape(tensor, key, ndim, shape, error);
    if (!status) status = td_tensor_check_finite(tensor, key, error);
    if (!status) status = td_tensor_floats(tensor, values, error);
    return status;
}
