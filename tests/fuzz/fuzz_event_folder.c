/* Any files in the places of data sets, as a folder of events: read to the end within the size that the folder tells, or
 * refused in one line. The first byte chooses the path that is opened, the second the format. The rest is a list of files;
 * those of HDF5 are lists of items (hdf5_items.h). */
#include "hdf5_items.h"
#include "read_events.h"

static const char *const files[] = {"seq/events/0.npz",
                                    "seq/events/1.npz",
                                    "seq/images/0.png",
                                    "seq/events_aligned/0.npz",
                                    "seq/events_aligned/1.npz",
                                    "seq/images_corrected/0.png",
                                    "seq/0.npz",
                                    "seq/1.npz",
                                    "seq/events.h5",
                                    "seq/events/left/events.h5",
                                    "seq/events/left/rectify_map.h5",
                                    "seq/events/right/events.h5"};
enum { FILES = sizeof files / sizeof *files };

static void put_files(const uint8_t *data, size_t size) {
    char path[FUZZ_PATH];
    fuzz_part part;
    fuzz_empty(fuzz_root());
    while (fuzz_row_next(&data, &size, &part)) {
        const char *name = files[part.name % FILES];
        if (strstr(name, ".h5"))
            h5_make_file(fuzz_path(path, name), part.data, part.size);
        else
            fuzz_put(name, part.data, part.size);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const opened[] = {"seq", "seq/events", "seq/events/left", "seq/events_aligned"};
    static const char *const formats[] = {NULL, "ergb", "npz", "hdf5"};
    char path[FUZZ_PATH];
    if (size < 2) return 0;
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    put_files(data + 2, size - 2);
    fuzz_read_events(fuzz_path(path, opened[data[0] % 4]), formats[data[1] % 4], 1);
    return 0;
}
