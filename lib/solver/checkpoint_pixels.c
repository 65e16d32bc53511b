/* A checkpoint's pixels: between the simulator's tiles and the file's images. */
#include "td_checkpoint.h"

#include <stdlib.h>

/* -- pixels ---------------------------------------------------------------------------------------------------------------- */

void td_planes_free(td_planes *p) {
    free(p->signal);
    free(p->signal_dot);
    free(p->initial);
    free(p->count_on);
    free(p->count_off);
    free(p->tile_risk);
    for (int k = 0; k < TD_OPTIONAL_REALS; k++) free(p->real[k]);
    for (int k = 0; k < TD_OPTIONAL_COUNTS; k++) free(p->count[k]);
}

tides_status td_planes_create(td_planes *p, const tides_simulator *s, tides_error *error) {
    size_t pixels = s->first_pixel[s->tiles];
    memset(p, 0, sizeof *p);
    int ok = (p->signal = td_alloc(pixels, sizeof *p->signal, error)) != NULL;
    ok = ok && (p->signal_dot = td_alloc(pixels, sizeof *p->signal_dot, error)) != NULL;
    ok = ok && (p->initial = td_alloc(pixels, sizeof *p->initial, error)) != NULL;
    ok = ok && (p->count_on = td_alloc(pixels, sizeof *p->count_on, error)) != NULL;
    ok = ok && (p->count_off = td_alloc(pixels, sizeof *p->count_off, error)) != NULL;
    ok = ok && (p->tile_risk = td_alloc((size_t)s->tiles, sizeof *p->tile_risk, error)) != NULL;
    for (int k = 0; k < TD_OPTIONAL_REALS && ok; k++)
        ok = !td_optional_real(s, k) || (p->real[k] = td_alloc(pixels, sizeof *p->real[k], error)) != NULL;
    for (int k = 0; k < TD_OPTIONAL_COUNTS && ok; k++)
        ok = !td_optional_count(s, k) || (p->count[k] = td_alloc(pixels, sizeof *p->count[k], error)) != NULL;
    if (ok) return TIDES_OK;
    td_planes_free(p);
    return TIDES_NO_MEMORY;
}

/* The optional state of one pixel. */
static void exchange_optional(const tides_simulator *s, const td_planes *p, size_t in, size_t out, int into_simulator) {
    for (int k = 0; k < TD_OPTIONAL_REALS; k++) {
        double *own = td_optional_real(s, k);
        if (own && into_simulator) own[in] = p->real[k][out];
        if (own && !into_simulator) p->real[k][out] = own[in];
    }
    for (int k = 0; k < TD_OPTIONAL_COUNTS; k++) {
        uint32_t *own = td_optional_count(s, k);
        if (own && into_simulator) own[in] = p->count[k][out];
        if (own && !into_simulator) p->count[k][out] = own[in];
    }
}

/* Copies between the tiles' order and the image's. */
static void exchange(const tides_simulator *s, const td_planes *p, int into_simulator) {
    for (int t = 0; t < s->tiles; t++) {
        const td_tile *tile = &s->tile[t];
        for (int i = 0; i < tile->count; i++) {
            size_t in = s->first_pixel[t] + (size_t)i;
            size_t out = (size_t)(tile->y0 + i / tile->width) * (size_t)s->width + (size_t)(tile->x0 + i % tile->width);
            exchange_optional(s, p, in, out, into_simulator);
            if (into_simulator) {
                s->now.plane[TD_KEPT_S][in] = p->signal[out];
                s->now.plane[TD_KEPT_S_DOT][in] = p->signal_dot[out];
                s->pixels.initial[in] = p->initial[out];
                s->pixels.count_on[in] = p->count_on[out];
                s->pixels.count_off[in] = p->count_off[out];
            } else {
                p->signal[out] = s->now.plane[TD_KEPT_S][in];
                p->signal_dot[out] = s->now.plane[TD_KEPT_S_DOT][in];
                p->initial[out] = s->pixels.initial[in];
                p->count_on[out] = s->pixels.count_on[in];
                p->count_off[out] = s->pixels.count_off[in];
            }
        }
    }
}

void td_planes_take(td_planes *p, const tides_simulator *s) {
    exchange(s, p, 0);
    memcpy(p->timing, s->timing.weight, sizeof p->timing);
    memcpy(p->tile_risk, s->tile_risk, (size_t)s->tiles * sizeof *p->tile_risk);
}

void td_planes_give(const td_planes *p, tides_simulator *s) {
    exchange(s, p, 1);
    memcpy(s->timing.weight, p->timing, sizeof p->timing);
    memcpy(s->tile_risk, p->tile_risk, (size_t)s->tiles * sizeof *p->tile_risk);
    td_sensor_resume(&s->sensor);
    if (s->surround.surround.on) td_surround_steps_resume(s);
}

/* -- datasets -------------------------------------------------------------------------------------------------------------- */

/* A dataset of the layout; its memory is of the same type. */
typedef struct dataset {
    const char *name;
    int is_count;      /* u4, else double */
    hsize_t extent[2]; /* the second 0: one dimension */
    void *values;
} dataset;

enum { ALWAYS = 7, DATASETS = ALWAYS + TD_OPTIONAL_REALS + TD_OPTIONAL_COUNTS };

/* How many there are. */
static int list_datasets(const tides_simulator *s, td_planes *p, dataset list[DATASETS]) {
    const hsize_t width = (hsize_t)s->width, height = (hsize_t)s->renderer->image.height;
    const dataset all[ALWAYS] = {
        {"signal", 0, {height, width}, p->signal},
        {"signal_dot", 0, {height, width}, p->signal_dot},
        {"initial", 0, {height, width}, p->initial},
        {"count_on", 1, {height, width}, p->count_on},
        {"count_off", 1, {height, width}, p->count_off},
        {"timing_errors", 0, {TD_TIMING_BINS, 0}, p->timing},
        {"tile_risk", 0, {(hsize_t)s->tiles, 0}, p->tile_risk},
    };
    memcpy(list, all, sizeof all);
    int count = ALWAYS;
    for (int k = 0; k < TD_OPTIONAL_REALS; k++)
        if (p->real[k]) list[count++] = (dataset){td_optional_real_name[k], 0, {height, width}, p->real[k]};
    for (int k = 0; k < TD_OPTIONAL_COUNTS; k++)
        if (p->count[k]) list[count++] = (dataset){td_optional_count_name[k], 1, {height, width}, p->count[k]};
    return count;
}

static int rank_of(const dataset *d) { return d->extent[1] ? 2 : 1; }

enum { CHUNK_BYTES = 1 << 18 };

/* Some rows at a time: HDF5 filters chunks in its cache. */
static void chunk_of(const dataset *d, hsize_t chunk[2]) {
    hsize_t row = d->extent[1] ? d->extent[1] : 1, rows = CHUNK_BYTES / (row * sizeof(double));
    chunk[0] = rows < 1 ? 1 : rows > d->extent[0] ? d->extent[0] : rows;
    chunk[1] = d->extent[1];
}

static tides_status write_dataset(const td_place *root, const dataset *d) {
    hsize_t chunk[2];
    chunk_of(d, chunk);
    hid_t space = H5Screate_simple(rank_of(d), d->extent, NULL), creation = H5Pcreate(H5P_DATASET_CREATE);
    int ready = space >= 0 && creation >= 0 && H5Pset_chunk(creation, rank_of(d), chunk) >= 0 &&
                H5Pset_shuffle(creation) >= 0 && H5Pset_deflate(creation, 1) >= 0 && H5Pset_obj_track_times(creation, 0) >= 0;
    hid_t set = ready ? H5Dcreate2(root->id, d->name, d->is_count ? H5T_STD_U32LE : H5T_IEEE_F64LE, space, H5P_DEFAULT,
                                   creation, H5P_DEFAULT)
                      : H5I_INVALID_HID;
    hid_t memory = d->is_count ? H5T_NATIVE_UINT32 : H5T_NATIVE_DOUBLE;
    int done = set >= 0 && H5Dwrite(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, d->values) >= 0;
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
    hid_t memory = d->is_count ? H5T_NATIVE_UINT32 : H5T_NATIVE_DOUBLE;
    int done = set >= 0 && has_shape(set, d) && H5Dread(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, d->values) >= 0;
    if (set >= 0) H5Dclose(set);
    if (done) return TIDES_OK;
    return td_fail(root->error, TIDES_BAD_FILE, "%s: dataset %s is missing, damaged or of another size", root->file, d->name);
}

tides_status td_planes_write(td_planes *p, const tides_simulator *s, const td_place *root) {
    dataset list[DATASETS];
    int count = list_datasets(s, p, list);
    tides_status status = TIDES_OK;
    for (int i = 0; i < count && status == TIDES_OK; i++) status = write_dataset(root, &list[i]);
    return status;
}

tides_status td_planes_read(td_planes *p, const tides_simulator *s, const td_place *root) {
    dataset list[DATASETS];
    int count = list_datasets(s, p, list);
    tides_status status = TIDES_OK;
    for (int i = 0; i < count && status == TIDES_OK; i++) status = read_dataset(root, &list[i]);
    return status;
}
