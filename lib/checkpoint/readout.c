/* Saves and restores the state of the readout arbiter: a dataset /readout of i8, which the arbiter packs and unpacks. */
#include "td_checkpoint.h"

#include <stdlib.h>

tides_status td_readout_write(const tides_simulator *s, const td_place *root) {
    int64_t *numbers = NULL;
    size_t count = 0;
    const tides_arbiter *arbiter = td_simulator_saved(s).arbiter;
    if (!arbiter) return TIDES_OK;
    tides_status status = td_arbiter_pack(arbiter, &numbers, &count, root->error);
    if (status != TIDES_OK) return status;
    const uint64_t shape[] = {count};
    status = td_place_write(root, "readout", H5T_STD_I64LE, H5T_NATIVE_INT64, 1, shape, numbers);
    free(numbers);
    return status;
}

/* Number of values; the dataset is contiguous, so the file must have the bytes. -1: there is none, or it is of another kind. */
static hssize_t length_of(hid_t set) {
    hid_t space = H5Dget_space(set), creation = H5Dget_create_plist(set);
    int fits =
        space >= 0 && creation >= 0 && H5Sget_simple_extent_ndims(space) == 1 && H5Pget_layout(creation) == H5D_CONTIGUOUS;
    hssize_t count = fits ? H5Sget_simple_extent_npoints(space) : -1;
    if (count >= 0 && H5Dget_storage_size(set) != (hsize_t)count * sizeof(int64_t)) count = -1;
    if (creation >= 0) H5Pclose(creation);
    if (space >= 0) H5Sclose(space);
    return count;
}

static tides_status read_numbers(const td_place *root, int64_t **numbers, size_t *count) {
    hid_t set = td_place_has(root, "readout") ? H5Dopen2(root->id, "readout", H5P_DEFAULT) : H5I_INVALID_HID;
    hssize_t length = set >= 0 ? length_of(set) : -1;
    tides_status status = TIDES_OK;
    if (length <= 0)
        status = td_fail(root->error, TIDES_BAD_FILE, "%s: dataset readout is missing or damaged", root->file);
    else if (!(*numbers = td_alloc((size_t)length, sizeof **numbers, root->error)))
        status = TIDES_NO_MEMORY;
    else if (H5Dread(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, *numbers) < 0)
        status = td_fail(root->error, TIDES_BAD_FILE, "%s: dataset readout can't be read", root->file);
    if (set >= 0) H5Dclose(set);
    *count = length > 0 ? (size_t)length : 0;
    return status;
}

/* Reads into a new arbiter, so that a bad file leaves the simulator unchanged. */
tides_status td_readout_read(const tides_simulator *s, const td_place *root, tides_arbiter **arbiter) {
    const td_saved_run run = td_simulator_saved(s);
    int64_t *numbers = NULL;
    size_t count = 0;
    if (!run.arbiter) return TIDES_OK;
    tides_status status = read_numbers(root, &numbers, &count);
    if (status == TIDES_OK)
        status = tides_arbiter_create(run.readout, run.width, run.height, run.sensor->seed, arbiter, root->error);
    if (status == TIDES_OK) tides_arbiter_start(*arbiter, run.arbiter->start_ns);
    if (status == TIDES_OK) status = td_arbiter_unpack(*arbiter, numbers, count, root->error);
    if (status == TIDES_BAD_FILE) status = td_fail_within(root->error, status, "%s", root->file);
    free(numbers);
    return status;
}
