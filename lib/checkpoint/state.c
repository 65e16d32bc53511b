/* The arrays of a checkpoint. Each part of a run lists its arrays in a table; each becomes a dataset. Values are read into
 * copies first, so that a bad file leaves the simulator unchanged. */
#include "td_checkpoint.h"

#include <stdlib.h>

/* -- copies ---------------------------------------------------------------------------------------------------------------- */

void td_saved_free(td_saved *saved) {
    for (int i = 0; i < saved->state.rows; i++) free(saved->copy[i]);
}

tides_status td_saved_create(td_saved *saved, const tides_simulator *simulator, tides_error *error) {
    /* the table serves for both directions; only td_saved_give writes */
    tides_simulator *s = (tides_simulator *)(uintptr_t)simulator;
    memset(saved, 0, sizeof *saved);
    td_simulator_state(s, &saved->state);
    if (saved->state.lost)
        return td_fail(error, TIDES_UNSUPPORTED, "the run's state has %d arrays more than a checkpoint takes (TD_STATE_ROWS)",
                       saved->state.lost);
    for (int i = 0; i < saved->state.rows; i++) {
        const td_state_row *row = &saved->state.row[i];
        if ((saved->copy[i] = td_alloc(row->count, td_state_size(row->type), error))) continue;
        td_saved_free(saved);
        return TIDES_NO_MEMORY;
    }
    return TIDES_OK;
}

static void exchange(const tides_simulator *s, const td_saved *saved, int direction) {
    const int into_simulator = direction == TD_FROM_IMAGE;
    for (int i = 0; i < saved->state.rows; i++) {
        const td_state_row *row = &saved->state.row[i];
        if (row->order == TD_STATE_PIXELS)
            td_simulator_copy_pixels(s, direction, td_state_size(row->type), row->values, saved->copy[i]);
        else
            memcpy(into_simulator ? row->values : saved->copy[i], into_simulator ? saved->copy[i] : row->values,
                   row->count * td_state_size(row->type));
    }
}

void td_saved_take(td_saved *saved, const tides_simulator *s) { exchange(s, saved, TD_TO_IMAGE); }

void td_saved_give(const td_saved *saved, tides_simulator *s) { exchange(s, saved, TD_FROM_IMAGE); }

/* -- datasets -------------------------------------------------------------------------------------------------------------- */

/* A dataset, whose type in memory is that in the file. */
typedef struct dataset {
    const char *name;
    td_state_type type;
    hsize_t extent[2]; /* extent[1] 0: one dimension */
    void *values;
} dataset;

static dataset dataset_of(const tides_simulator *s, const td_saved *saved, int i) {
    const td_state_row *row = &saved->state.row[i];
    const td_saved_run run = td_simulator_saved(s);
    dataset d = {row->name, row->type, {row->count, 0}, saved->copy[i]};
    if (row->order == TD_STATE_PIXELS) d.extent[0] = (hsize_t)run.height, d.extent[1] = (hsize_t)run.width;
    return d;
}

static int rank_of(const dataset *d) { return d->extent[1] ? 2 : 1; }

enum { CHUNK_BYTES = 1 << 18 };

/* Sets the size of chunks: some rows, since HDF5 filters a chunk in its cache. */
static void chunk_of(const dataset *d, hsize_t chunk[2]) {
    hsize_t row = d->extent[1] ? d->extent[1] : 1, rows = CHUNK_BYTES / (row * sizeof(double));
    chunk[0] = rows < 1 ? 1 : rows > d->extent[0] ? d->extent[0] : rows;
    chunk[1] = d->extent[1];
}

/* Writes a dataset whose chunks are packed here. HDF5's own filters took four times as long, a second for 1.2 million pixels,
 * and the user who stops a run waits for it. */
static tides_status write_dataset(const td_place *root, const dataset *d) {
    hsize_t chunk[2];
    chunk_of(d, chunk);
    hid_t space = H5Screate_simple(rank_of(d), d->extent, NULL), creation = H5Pcreate(H5P_DATASET_CREATE);
    int ready = space >= 0 && creation >= 0 && H5Pset_chunk(creation, rank_of(d), chunk) >= 0 &&
                H5Pset_shuffle(creation) >= 0 && H5Pset_deflate(creation, 1) >= 0 && H5Pset_obj_track_times(creation, 0) >= 0;
    const hid_t types[] =
        {[TD_STATE_REAL] = H5T_IEEE_F64LE, [TD_STATE_COUNT] = H5T_STD_U32LE, [TD_STATE_WHOLE] = H5T_STD_I64LE};
    hid_t set =
        ready ? H5Dcreate2(root->id, d->name, types[d->type], space, H5P_DEFAULT, creation, H5P_DEFAULT) : H5I_INVALID_HID;
    const size_t size = td_state_size(d->type);
    int done = set >= 0 && td_h5_write_chunks(set, d->extent, chunk[0], size, d->values) >= 0;
    if (set >= 0 && H5Dclose(set) < 0) done = 0;
    if (creation >= 0) H5Pclose(creation);
    if (space >= 0) H5Sclose(space);
    if (done) return TIDES_OK;
    return td_fail(root->error, TIDES_NO_MEMORY, "%s: dataset %s can't be added: out of memory?", root->file, d->name);
}

static int has_shape(hid_t set, const dataset *d) {
    hsize_t extent[2] = {0, 0};
    hid_t space = H5Dget_space(set);
    int fits = space >= 0 && H5Sget_simple_extent_ndims(space) == rank_of(d) &&
               H5Sget_simple_extent_dims(space, extent, NULL) == rank_of(d) && extent[0] == d->extent[0] &&
               extent[1] == d->extent[1];
    if (space >= 0) H5Sclose(space);
    return fits;
}

static tides_status read_dataset(const td_place *root, const dataset *d) {
    hid_t set = td_place_has(root, d->name) ? H5Dopen2(root->id, d->name, H5P_DEFAULT) : H5I_INVALID_HID;
    const hid_t types[] =
        {[TD_STATE_REAL] = H5T_NATIVE_DOUBLE, [TD_STATE_COUNT] = H5T_NATIVE_UINT32, [TD_STATE_WHOLE] = H5T_NATIVE_INT64};
    int done = set >= 0 && has_shape(set, d) && H5Dread(set, types[d->type], H5S_ALL, H5S_ALL, H5P_DEFAULT, d->values) >= 0;
    if (set >= 0) H5Dclose(set);
    if (done) return TIDES_OK;
    return td_fail(root->error, TIDES_BAD_FILE, "%s: dataset %s is missing, damaged or of another size", root->file, d->name);
}

tides_status td_saved_write(const td_saved *saved, const tides_simulator *s, const td_place *root) {
    tides_status status = TIDES_OK;
    for (int i = 0; i < saved->state.rows && status == TIDES_OK; i++) {
        const dataset d = dataset_of(s, saved, i);
        status = write_dataset(root, &d);
    }
    return status;
}

tides_status td_saved_read(td_saved *saved, const tides_simulator *s, const td_place *root) {
    tides_status status = TIDES_OK;
    for (int i = 0; i < saved->state.rows && status == TIDES_OK; i++) {
        const dataset d = dataset_of(s, saved, i);
        status = read_dataset(root, &d);
    }
    return status;
}
