/* Lists the names of groups, datasets and attributes at a place in an HDF5 file, for readers of files whose contents vary. */
#include "td_base.h"
#include "td_h5_place.h"

size_t td_place_links(const td_place *place) {
    H5G_info_t info;
    return H5Gget_info(place->id, &info) >= 0 ? (size_t)info.nlinks : 0;
}

size_t td_place_attributes(const td_place *place) {
    int count = H5Aget_num_attrs(place->id);
    return count > 0 ? (size_t)count : 0;
}

static tides_status check_name(const td_place *place, ssize_t length, size_t size) {
    if (length > 0 && (size_t)length < size) return TIDES_OK;
    return td_fail(place->error, TIDES_BAD_FILE, "%s: a name in %s is empty, damaged or longer than %zu bytes", place->file,
                   place->where, size - 1);
}

tides_status td_place_link_name(const td_place *place, size_t i, char *name, size_t size) {
    ssize_t length = H5Lget_name_by_idx(place->id, ".", H5_INDEX_NAME, H5_ITER_INC, (hsize_t)i, name, size, H5P_DEFAULT);
    return check_name(place, length, size);
}

tides_status td_place_attribute_name(const td_place *place, size_t i, char *name, size_t size) {
    ssize_t length = H5Aget_name_by_idx(place->id, ".", H5_INDEX_NAME, H5_ITER_INC, (hsize_t)i, name, size, H5P_DEFAULT);
    return check_name(place, length, size);
}

tides_status td_place_rank(const td_place *place, const char *name, int *rank) {
    hid_t set = H5Dopen2(place->id, name, H5P_DEFAULT), space = set >= 0 ? H5Dget_space(set) : H5I_INVALID_HID;
    *rank = space >= 0 ? H5Sget_simple_extent_ndims(space) : -1;
    if (space >= 0) H5Sclose(space);
    if (set >= 0) H5Dclose(set);
    if (*rank >= 1 && *rank <= TD_PLACE_RANK_MAX) return TIDES_OK;
    return td_fail(place->error, TIDES_BAD_FILE, "%s: %s of %s isn't a dataset of 1 to %d dimensions", place->file, name,
                   place->where, TD_PLACE_RANK_MAX);
}
