/* Any bytes as .npz or .npy: every array can be read in all its elements, or is refused in one line. */
#include "fuzz.h"

#include "archive/td_npy.h"

static void read_all(const td_npy_array *array, size_t size) {
    /* Deflate's best ratio bounds what a file can become. */
    if (array->item && array->count > size * 1032 / array->item) abort();
    for (size_t f = 0; f < array->field_count; f++) {
        double value = 0;
        int64_t integer = 0;
        if (array->fields[f].offset + array->fields[f].bytes > array->item) abort();
        for (size_t i = 0; i < array->count && array->item; i++) {
            (void)td_npy_number(array, &array->fields[f], i, &value);
            (void)td_npy_integer(array, &array->fields[f], i, &integer);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    td_npz *npz = NULL;
    tides_error error = {0, ""};
    tides_status status = td_npz_parse("fuzz", data, size, &npz, &error);
    if (status != TIDES_OK) {
        fuzz_refusal(status, &error);
        if (npz) abort();
        return 0;
    }
    for (size_t i = 0; i < td_npz_count(npz); i++) {
        const td_npy_array *array = NULL;
        status = td_npz_get(npz, td_npz_name(npz, i), &array, &error);
        if (status != TIDES_OK)
            fuzz_refusal(status, &error);
        else
            read_all(array, size);
    }
    td_npz_close(npz);
    return 0;
}
