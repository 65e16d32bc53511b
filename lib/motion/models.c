/* Helpers of the motion models: checked fields with a row per Gaussian, and blocks of numbers for the kernels. */
#include "td_models.h"

#include "td_math.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

tides_status td_motion_copy_field(tides_motion *motion, const char *name, int rank, const uint64_t *shape, const float *value,
                                  tides_error *error) {
    uint64_t count = 1;
    if (!value) return td_fail(error, TIDES_BAD_ARGUMENT, "%s motion: array '%s' is missing (NULL)", motion->type->name, name);
    for (int i = 0; i < rank; i++) {
        if (shape[i] > 0 && count > SIZE_MAX / sizeof(float) / shape[i])
            return td_fail(error, TIDES_BAD_ARGUMENT, "%s motion: array '%s' is larger than memory can be", motion->type->name,
                           name);
        count *= shape[i];
    }
    float *copy = td_alloc((size_t)count, sizeof *copy, error);
    if (!copy) return TIDES_NO_MEMORY;
    memcpy(copy, value, (size_t)count * sizeof *copy);
    for (size_t i = 0; i < count; i++)
        if (!isfinite(value[i])) {
            free(copy);
            return td_fail(error, TIDES_BAD_ARGUMENT, "%s motion: value %zu of array '%s' is %g: must be finite",
                           motion->type->name, i, name, value[i]);
        }
    return td_motion_take_field(motion, name, rank, shape, copy, error);
}

tides_status td_motion_copy_rows(tides_motion *motion, const char *name, int64_t count, int width, const float *value,
                                 tides_error *error) {
    const uint64_t shape[2] = {(uint64_t)count, (uint64_t)width};
    return td_motion_copy_field(motion, name, width == 1 ? 1 : 2, shape, value, error);
}

tides_status td_motion_need_rows(const tides_motion *motion, const char *name, int64_t count, int width, const td_field **field,
                                 tides_error *error) {
    const uint64_t shape[2] = {(uint64_t)count, (uint64_t)width};
    return td_motion_need_field(motion, name, width == 1 ? 1 : 2, shape, field, error);
}

tides_status td_mover_create_rows(td_mover_numbers *numbers, const char *model, int64_t rows, int64_t stride,
                                  tides_error *error) {
    if (rows > INT_MAX / stride)
        return td_fail(error, TIDES_UNSUPPORTED, "%s motion: %lld rows of %lld numbers are more than 32-bit indices reach",
                       model, (long long)rows, (long long)stride);
    numbers->data = td_alloc((size_t)(rows * stride), sizeof *numbers->data, error);
    if (!numbers->data) return TIDES_NO_MEMORY;
    numbers->data_count = (size_t)(rows * stride);
    return TIDES_OK;
}

double td_sigmoid(double x) { return 1 / (1 + td_exp(-x)); }

tides_status td_motion_finish(tides_status status, tides_motion *made, tides_motion **motion) {
    if (status == TIDES_OK)
        *motion = made;
    else
        tides_motion_destroy(made);
    return status;
}
