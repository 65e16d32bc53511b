/* Cuts an HDF5 dataset of whole chunks back. A killed process may have left chunks beyond the dataset's rows: these are
 * removed, too. */
#include "td_event_store.h"

#include "archive/td_h5_driver.h"

/* Number of rows of a one-dimensional dataset with chunks of `chunk`; -1 if it is another kind. */
hssize_t td_event_rows_of(hid_t dataset, hsize_t chunk) {
    hsize_t found = 0;
    hid_t creation = H5Dget_create_plist(dataset), space = H5Dget_space(dataset);
    int fits = creation >= 0 && space >= 0 && H5Pget_layout(creation) == H5D_CHUNKED &&
               H5Pget_chunk(creation, 1, &found) == 1 && found == chunk && H5Sget_simple_extent_ndims(space) == 1;
    hssize_t rows = fits ? H5Sget_simple_extent_npoints(space) : -1;
    td_h5_close(space);
    td_h5_close(creation);
    return rows;
}

/* Number of rows up to the end of the last stored chunk. It exceeds the dataset's rows if the process died while a cut was
 * written. */
static hsize_t rows_of_chunks(hid_t dataset, hsize_t chunk) {
    hsize_t rows = 0;
#if H5_VERSION_GE(1, 10, 5)
    hsize_t chunks = 0, last = 0;
    hid_t space = H5Dget_space(dataset);
    if (H5Dget_num_chunks(dataset, space, &chunks) >= 0 && chunks > 0 &&
        H5Dget_chunk_info(dataset, space, chunks - 1, &last, NULL, NULL, NULL) >= 0)
        rows = last + chunk;
    td_h5_close(space);
#else
    (void)dataset, (void)chunk;
#endif
    return rows;
}

/* Cuts to `rows`. HDF5 frees only chunks between the old and the new extent, so the extent first grows to include all stored
 * chunks. */
herr_t td_event_cut_rows(hid_t dataset, hsize_t rows, hsize_t chunk) {
    const hsize_t there = rows_of_chunks(dataset, chunk);
    if ((hssize_t)there > td_event_rows_of(dataset, chunk) && H5Dset_extent(dataset, &there) < 0) return -1;
    return H5Dset_extent(dataset, &rows);
}
