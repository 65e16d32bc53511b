/* Any bytes as an event file, of the format that they look like, or else of one without a mark. HDF5 has a target of its own:
 * its library (1.10.8) reads freed memory if a file's metadata are damaged. */
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
