/* Any bytes as an event file, of the format that they look like, or else of one that has no mark: read to the end within the
 * sensor that the file says, or refused in one line. Reads at most 100 000 events: a few compressed bytes can stand for many.
 * HDF5 is left to fuzz_hdf5.c: its library (1.10.8) reads freed memory itself where a file's metadata are damaged. */
#include "fuzz.h"

#include "tides/events.h"

enum { BATCH = 1000, BATCHES = 100 };

static void read_file(const char *path, const char *format) {
    static tides_event events[BATCH];
    tides_event_reader *reader = NULL;
    tides_event_facts facts;
    tides_error error = {TIDES_OK, ""};
    tides_status status = tides_event_reader_open(path, format, &reader, &error);
    if (status != TIDES_OK) {
        fuzz_refusal(status, &error);
        if (reader) abort();
        return;
    }
    tides_event_reader_facts(reader, &facts);
    size_t got = 1;
    for (int i = 0; i < BATCHES && got && status == TIDES_OK; i++) {
        status = tides_event_reader_read(reader, events, BATCH, &got, &error);
        for (size_t e = 0; status == TIDES_OK && e < got; e++) {
            if (events[e].polarity != 1 && events[e].polarity != -1) abort();
            if (facts.width && (events[e].x >= facts.width || events[e].y >= facts.height)) abort();
        }
    }
    if (status != TIDES_OK) fuzz_refusal(status, &error);
    tides_event_reader_close(reader);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const unmarked[] = {"nmnist", "ecd", "dat", "csv-openeb"};
    char path[FUZZ_PATH];
    if (size >= 4 && memcmp(data, "\x89HDF", 4) == 0) return 0;
    fuzz_put("events", data, size);
    read_file(fuzz_path(path, "events"), NULL);
    read_file(path, unmarked[size % 4]);
    return 0;
}
