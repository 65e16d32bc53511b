/* Arrays in HDF5 files that grow along their first extent: layouts append images, times and events as they are made. Chunks
 * are shuffled and deflated. */
#include "td_arrays.h"

#include "archive/td_h5.h"
#include "archive/td_h5_driver.h"
#include "td_base.h"

#include <stdlib.h>
#include <string.h>

static tides_status write_failed(const td_arrays *arrays, tides_error *error) {
    td_h5_reason reason;
    return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", arrays->path,
                   arrays->failed ? strerror(arrays->failed) : td_h5_reason_text(&reason));
}

tides_status td_arrays_open(td_arrays *arrays, char *path, tides_error *error) {
    *arrays = (td_arrays){.path = path};
    if (!path) return TIDES_NO_MEMORY;
    td_h5_quiet saved;
    td_h5_quiet_begin(&saved);
    const hid_t access = td_h5_write_access(&arrays->failed);
    arrays->file = access < 0 ? -1 : H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    td_h5_close(access);
    const tides_status status = arrays->file < 0 || arrays->failed ? write_failed(arrays, error) : TIDES_OK;
    td_h5_quiet_end(&saved);
    return status;
}

static hid_t create(td_arrays *arrays, const char *name, hid_t stored, size_t chunk, const td_array *array) {
    hsize_t none[4], most[4], chunks[4];
    memcpy(none, array->shape, sizeof none);
    memcpy(most, array->shape, sizeof most);
    memcpy(chunks, array->shape, sizeof chunks);
    none[0] = 0;
    most[0] = H5S_UNLIMITED;
    chunks[0] = chunk;
    hid_t dataset = -1, space = H5Screate_simple(array->ndim, none, most), made = H5Pcreate(H5P_DATASET_CREATE);
    const hid_t links = H5Pcreate(H5P_LINK_CREATE);
    if (space >= 0 && made >= 0 && links >= 0 && H5Pset_create_intermediate_group(links, 1) >= 0 &&
        H5Pset_chunk(made, array->ndim, chunks) >= 0 && H5Pset_shuffle(made) >= 0 && H5Pset_deflate(made, 1) >= 0 &&
        H5Pset_obj_track_times(made, 0) >= 0)
        dataset = H5Dcreate2(arrays->file, name, stored, space, links, made, H5P_DEFAULT);
    td_h5_close(links);
    td_h5_close(made);
    td_h5_close(space);
    return dataset;
}

tides_status td_array_begin(td_arrays *arrays, const char *name, const td_array_form *form, td_array *array,
                            tides_error *error) {
    *array = (td_array){.memory = form->memory, .ndim = form->ndim, .shape = {1, 1, 1, 1}};
    for (int d = 1; d < form->ndim; d++) array->shape[d] = form->inner[d - 1];
    td_h5_quiet saved;
    td_h5_quiet_begin(&saved);
    array->dataset = create(arrays, name, form->stored, form->chunk, array);
    const tides_status status = array->dataset < 0 || arrays->failed ? write_failed(arrays, error) : TIDES_OK;
    td_h5_quiet_end(&saved);
    return status;
}

/* Reads to `to` or writes from `from`; the other one is NULL. */
static herr_t transfer(td_array *array, size_t first, size_t rows, const void *from, void *to) {
    hsize_t start[4] = {first}, count[4];
    memcpy(count, array->shape, sizeof count);
    count[0] = rows;
    hid_t memory = H5Screate_simple(array->ndim, count, NULL), file = H5Dget_space(array->dataset);
    herr_t failed = -1;
    if (memory >= 0 && file >= 0 && H5Sselect_hyperslab(file, H5S_SELECT_SET, start, NULL, count, NULL) >= 0)
        failed = to ? H5Dread(array->dataset, array->memory, memory, file, H5P_DEFAULT, to)
                    : H5Dwrite(array->dataset, array->memory, memory, file, H5P_DEFAULT, from);
    td_h5_close(file);
    td_h5_close(memory);
    return failed;
}

static herr_t append(td_array *array, size_t rows, const void *values) {
    hsize_t all[4];
    memcpy(all, array->shape, sizeof all);
    all[0] = array->rows + rows;
    if (H5Dset_extent(array->dataset, all) < 0 || transfer(array, array->rows, rows, values, NULL) < 0) return -1;
    array->rows += rows;
    return 0;
}

tides_status td_array_read(td_arrays *arrays, td_array *array, size_t row, void *values, tides_error *error) {
    td_h5_quiet saved;
    td_h5_quiet_begin(&saved);
    const tides_status status = transfer(array, row, 1, NULL, values) < 0 ? write_failed(arrays, error) : TIDES_OK;
    td_h5_quiet_end(&saved);
    return status;
}

tides_status td_array_append(td_arrays *arrays, td_array *array, size_t rows, const void *values, tides_error *error) {
    if (rows == 0) return TIDES_OK;
    td_h5_quiet saved;
    td_h5_quiet_begin(&saved);
    const tides_status status = append(array, rows, values) < 0 || arrays->failed ? write_failed(arrays, error) : TIDES_OK;
    td_h5_quiet_end(&saved);
    return status;
}

void td_array_end(td_array *array) {
    if (array->dataset > 0) td_h5_close(array->dataset);
    array->dataset = 0;
}

tides_status td_arrays_close(td_arrays *arrays, tides_error *error) {
    if (!arrays->path) return TIDES_OK;
    td_h5_quiet saved;
    td_h5_quiet_begin(&saved);
    const herr_t closed = arrays->file > 0 ? H5Fclose(arrays->file) : 0;
    const tides_status status = closed < 0 || arrays->failed ? write_failed(arrays, error) : TIDES_OK;
    td_h5_quiet_end(&saved);
    free(arrays->path);
    *arrays = (td_arrays){.path = NULL};
    return status;
}

void td_arrays_drop(td_arrays *arrays) { (void)!td_arrays_close(arrays, NULL); }
