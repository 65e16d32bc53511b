/* Checks that a dataset's filters are available and safe, before HDF5 runs them. */
#include "td_h5.h"

#include "td_base.h"

/* Compressions of published data sets that HDF5 lacks. Numbers: the HDF Group's registry of filters. */
static const struct {
    H5Z_filter_t id;
    const char *name, *package;
} plugins[] = {
    {32000, "LZF", "hdf5-plugin-lzf"},    {32001, "Blosc", "hdf5-filter-plugin-blosc-serial"},
    {32004, "LZ4", "hdf5-filter-plugin"}, {32008, "Bitshuffle", "hdf5-filter-plugin"},
    {32015, "Zstandard", NULL},           {32026, "Blosc2", NULL},
};

static tides_status missing_filter(const char *path, const char *dataset, H5Z_filter_t id, tides_error *error) {
    const char *name = "an unknown filter", *package = NULL;
    for (size_t i = 0; i < sizeof plugins / sizeof *plugins; i++) {
        if (plugins[i].id != id) continue;
        name = plugins[i].name;
        package = plugins[i].package;
    }
    return td_fail(error, TIDES_UNSUPPORTED,
                   "%s: %s is compressed with %s (HDF5 filter %d), whose plugin is missing: %s%s%sset HDF5_PLUGIN_PATH to the "
                   "folder that python3 -c 'import hdf5plugin; print(hdf5plugin.PLUGIN_PATH)' prints",
                   path, dataset, name, (int)id, package ? "install the Debian package " : "", package ? package : "",
                   package ? ", or " : "");
}

/* The unpackers for n-bit and scale-offset data in HDF5 1.10.8 overrun their buffers if the data is damaged. No tool stores
 * events with them, so they are refused. */
static int is_trusted(H5Z_filter_t id) { return id != H5Z_FILTER_NBIT && id != H5Z_FILTER_SCALEOFFSET; }

/* HDF5 unpacks a chunk as a whole. A larger one than TIDES itself writes at most is refused, so that a damaged size can't
 * exhaust the memory. */
static tides_status check_chunk(const char *path, const char *name, hid_t dataset, hid_t creation, tides_error *error) {
    enum { CHUNK_MAX = 1 << 30 }; /* bytes */
    hsize_t chunk[H5S_MAX_RANK];
    int rank = H5Pget_layout(creation) == H5D_CHUNKED ? H5Pget_chunk(creation, H5S_MAX_RANK, chunk) : 0;
    hid_t type = H5Dget_type(dataset);
    size_t value = type < 0 ? 0 : H5Tget_size(type);
    uint64_t room = value ? CHUNK_MAX / value : 0;
    td_h5_close(type);
    for (int i = 0; i < rank; i++) room = chunk[i] ? room / chunk[i] : 0;
    if (room > 0) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: %s is stored in chunks of more than %d bytes", path, name, CHUNK_MAX);
}

tides_status td_h5_check_filters(const char *path, const char *name, hid_t dataset, tides_error *error) {
    hid_t creation = H5Dget_create_plist(dataset);
    int count = creation < 0 ? 0 : H5Pget_nfilters(creation);
    tides_status status = creation < 0 ? td_fail(error, TIDES_BAD_FILE, "%s: %s is damaged", path, name)
                                       : check_chunk(path, name, dataset, creation, error);
    for (int i = 0; i < count && status == TIDES_OK; i++) {
        unsigned flags, config;
        size_t values = 0;
        H5Z_filter_t filter = H5Pget_filter2(creation, (unsigned)i, &flags, &values, NULL, 0, NULL, &config);
        if (filter >= 0 && !is_trusted(filter))
            status = td_fail(error, TIDES_UNSUPPORTED,
                             "%s: %s is stored with HDF5's filter %d (n-bit or scale-offset), which isn't read: store it with "
                             "another, such as deflate",
                             path, name, (int)filter);
        else if (filter >= 0 && H5Zfilter_avail(filter) <= 0)
            status = missing_filter(path, name, filter, error);
    }
    td_h5_close(creation);
    return status;
}
