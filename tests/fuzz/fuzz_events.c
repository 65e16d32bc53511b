/* Any bytes as an event file, of the format that they look like, or else of one that has no mark (read_events.h). HDF5 is left
 * to fuzz_hdf5.c: its library (1.10.8) reads freed memory itself where a file's metadata are damaged. */
#include "read_events.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const unmarked[] = {"nmnist", "ecd", "dat", "csv-openeb"};
    char path[FUZZ_PATH];
    if (size >= 4 && memcmp(data, "\x89HDF", 4) == 0) return 0;
    fuzz_put("events", data, size);
    fuzz_read_events(fuzz_path(path, "events"), NULL, 0);
    fuzz_read_events(path, unmarked[size % 4], 0);
    return 0;
}
