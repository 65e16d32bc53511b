/* HDF5 files that lie: datasets and attributes of any name, type, shape and values, as event file and as frame sequence: read
 * within what the file says, or refused in one line. The files are whole, made by HDF5 itself, because its library (1.10.8)
 * reads freed memory where a file's metadata are damaged.
 *
 * The input is a row of items: name, type, shape (how many extents, bit 7: times 65536), three extents, how it is stored,
 * number of bytes, bytes, which are repeated to fill it. */
#include "fuzz.h"

#include "tides/events.h"
#include "tides/frames.h"

#include <hdf5.h>
#include <math.h>

static const char *const names[] = {"events/p",
                                    "events/t",
                                    "events/x",
                                    "events/y",
                                    "events/t_ns",
                                    "events/height",
                                    "events/width",
                                    "events/ps",
                                    "events/ts",
                                    "events/xs",
                                    "events/ys",
                                    "p",
                                    "t",
                                    "x",
                                    "y",
                                    "events",
                                    "t_offset",
                                    "ms_to_idx",
                                    "CD/events",
                                    "prophesee/left/p",
                                    "prophesee/left/t",
                                    "prophesee/left/x",
                                    "prophesee/left/y",
                                    "prophesee/left/calib/resolution",
                                    "davis/left/events",
                                    "Y",
                                    "frames",
                                    "images",
                                    "timestamps",
                                    "@width",
                                    "@height",
                                    "@sensor_resolution",
                                    "@format",
                                    "@version",
                                    "@count",
                                    "@stop_ns",
                                    "@geometry"};
enum { NAMES = sizeof names / sizeof *names, TYPES = 13, HEAD = 7, ITEMS_MAX = 12, VALUES_MAX = 1 << 16 };
enum { CONTIGUOUS, CHUNKED, DEFLATED, SHUFFLED, CODEC, STORAGES };

/* Prophesee's x u16, y u16, p i16, t i64 (16 bytes). */
static hid_t make_record(void) {
    hid_t type = H5Tcreate(H5T_COMPOUND, 16);
    H5Tinsert(type, "x", 0, H5T_STD_U16LE);
    H5Tinsert(type, "y", 2, H5T_STD_U16LE);
    H5Tinsert(type, "p", 4, H5T_STD_I16LE);
    H5Tinsert(type, "t", 8, H5T_STD_I64LE);
    return type;
}

static hid_t make_boolean(void) {
    hid_t type = H5Tenum_create(H5T_STD_I8LE);
    for (int8_t v = 0; v < 2; v++) H5Tenum_insert(type, v ? "TRUE" : "FALSE", &v);
    return type;
}

static hid_t make_text(size_t bytes) {
    hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, bytes);
    return type;
}

/* Closed by the caller. */
static hid_t make_type(int kind) {
    const hid_t plain[] = {H5T_STD_U8LE,  H5T_STD_I8LE,  H5T_STD_U16LE, H5T_STD_I16LE,  H5T_STD_U32LE,
                           H5T_STD_I32LE, H5T_STD_U64LE, H5T_STD_I64BE, H5T_IEEE_F32LE, H5T_IEEE_F64LE};
    switch (kind) {
        case 10: return make_boolean();
        case 11: return make_text(12);
        case 12: return make_record();
        default: return H5Tcopy(plain[kind]);
    }
}

/* Values of the item's bytes, over and over. */
static uint8_t *fill(size_t bytes, const uint8_t *from, size_t count) {
    uint8_t *values = calloc(bytes ? bytes : 1, 1);
    for (size_t i = 0; values && count && i < bytes; i++) values[i] = from[i % count];
    return values;
}

static hid_t make_creation(int storage, int rank, const hsize_t *extents) {
    hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    hsize_t chunk[3];
    for (int d = 0; d < rank; d++) chunk[d] = extents[d] < 1 ? 1 : extents[d] < 64 ? extents[d] : 64;
    if (rank && storage != CONTIGUOUS) H5Pset_chunk(creation, rank, chunk);
    if (rank && storage == SHUFFLED) H5Pset_shuffle(creation);
    if (rank && (storage == DEFLATED || storage == SHUFFLED)) H5Pset_deflate(creation, 1);
    if (rank && storage == CODEC) H5Pset_filter(creation, 0x8ECF, H5Z_FLAG_OPTIONAL, 0, NULL);
    return creation;
}

static void put_dataset(hid_t file, const char *name, hid_t type, hid_t space, int storage, int rank, const hsize_t *extents,
                        const uint8_t *from, size_t count) {
    hid_t links = H5Pcreate(H5P_LINK_CREATE), creation = make_creation(storage, rank, extents);
    H5Pset_create_intermediate_group(links, 1);
    hid_t data = H5Dcreate2(file, name, type, space, links, creation, H5P_DEFAULT);
    const hsize_t first[3] = {0, 0, 0};
    hssize_t points = H5Sget_simple_extent_npoints(space);
    if (data >= 0 && storage == CODEC) {
        if (rank && count && points > 0) H5Dwrite_chunk(data, H5P_DEFAULT, 0, first, count, from);
    } else if (data >= 0 && points > 0 && points <= VALUES_MAX) { /* else what is said isn't there */
        uint8_t *values = fill((size_t)points * H5Tget_size(type), from, count);
        if (values) H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
        free(values);
    }
    H5Dclose(data);
    H5Pclose(creation);
    H5Pclose(links);
}

static void put_attribute(hid_t file, const char *name, hid_t type, hid_t space, const uint8_t *from, size_t count) {
    hssize_t points = H5Sget_simple_extent_npoints(space);
    hid_t attribute = points > 256 ? H5I_INVALID_HID : H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    uint8_t *values = attribute < 0 ? NULL : fill((size_t)points * H5Tget_size(type), from, count);
    if (values) H5Awrite(attribute, type, values);
    free(values);
    if (attribute >= 0) H5Aclose(attribute);
}

static void put_item(hid_t file, const uint8_t *item, const uint8_t *from, size_t count) {
    const char *name = names[item[0] % NAMES];
    int rank = item[2] % 4;
    hsize_t extents[3];
    for (int d = 0; d < 3; d++) extents[d] = (hsize_t)item[3 + d] * (item[2] & 128 ? 65536 : 1);
    hid_t type = make_type(item[1] % TYPES), space = rank ? H5Screate_simple(rank, extents, NULL) : H5Screate(H5S_SCALAR);
    if (name[0] == '@')
        put_attribute(file, name + 1, type, space, from, count);
    else
        put_dataset(file, name, type, space, item[6] % STORAGES, rank, extents, from, count);
    H5Sclose(space);
    H5Tclose(type);
}

static void make_file(const char *path, const uint8_t *data, size_t size) {
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    if (file < 0) abort();
    for (int items = 0; size > HEAD && items < ITEMS_MAX; items++) {
        size_t count = data[HEAD] < size - HEAD - 1 ? data[HEAD] : size - HEAD - 1;
        put_item(file, data, data + HEAD + 1, count);
        data += HEAD + 1 + count, size -= HEAD + 1 + count;
    }
    if (H5Fclose(file) < 0) abort();
}

static void read_events(const char *path) {
    static tides_event events[1000];
    tides_event_reader *reader = NULL;
    tides_event_facts facts;
    tides_error error = {TIDES_OK, ""};
    tides_status status = tides_event_reader_open(path, NULL, &reader, &error);
    if (status != TIDES_OK) {
        fuzz_refusal(status, &error);
        return;
    }
    tides_event_reader_facts(reader, &facts);
    uint64_t total = 0;
    for (size_t got = 1; got && status == TIDES_OK && total < VALUES_MAX; total += got) {
        status = tides_event_reader_read(reader, events, 1000, &got, &error);
        for (size_t i = 0; status == TIDES_OK && i < got; i++) {
            if (events[i].polarity != 1 && events[i].polarity != -1) abort();
            if (facts.width && (events[i].x >= facts.width || events[i].y >= facts.height)) abort();
        }
    }
    if (status != TIDES_OK) fuzz_refusal(status, &error);
    if (facts.counted && total > facts.count) abort();
    tides_event_reader_close(reader);
}

static void read_frames(const char *path) {
    static double Y[VALUES_MAX];
    tides_frames *frames = NULL;
    tides_frames_options options;
    tides_error error = {TIDES_OK, ""};
    int32_t width, height;
    tides_frames_options_defaults(&options);
    tides_status status = tides_frames_open(path, &options, &frames, &error);
    if (status == TIDES_BAD_CONFIG) {
        fuzz_one_line(status, &error); /* no times */
    } else if (status != TIDES_OK) {
        fuzz_refusal(status, &error);
    } else {
        tides_frames_size(frames, &width, &height);
        size_t pixels = (size_t)width * (size_t)height;
        for (size_t k = 0; pixels <= VALUES_MAX && k < tides_frames_count(frames) && k < 4; k++) {
            status = tides_frames_read(frames, k, Y, &error);
            if (status != TIDES_OK) fuzz_refusal(status, &error);
            for (size_t i = 0; status == TIDES_OK && i < pixels; i++)
                if (!(Y[i] >= 0) || isinf(Y[i])) abort();
        }
    }
    tides_frames_close(frames);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[FUZZ_PATH];
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    make_file(fuzz_path(path, "file.h5"), data, size);
    read_events(path);
    read_frames(path);
    return 0;
}
