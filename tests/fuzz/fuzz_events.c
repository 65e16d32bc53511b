/* Any bytes as an event file, of the format that they look like, or else of one that has no mark: read to the end within the
 * sensor that the file says, or refused in one line. Reads at most 100 000 events: a few compressed bytes can stand for many.
 * HDF5 is left out: its library (1.10.8) reads freed memory itself where a file's metadata are damaged. */
#include "tides/events.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { BATCH = 1000, BATCHES = 100 };

static void check_refusal(tides_status status, const tides_error *error) {
    int expected = status == TIDES_BAD_FILE || status == TIDES_UNSUPPORTED || status == TIDES_NO_MEMORY;
    if (!expected || error->status != status || !error->text[0] || strchr(error->text, '\n')) abort();
}

static void read_file(const char *path, const char *format) {
    static tides_event events[BATCH];
    tides_event_reader *reader = NULL;
    tides_event_facts facts;
    tides_error error = {TIDES_OK, ""};
    tides_status status = tides_event_reader_open(path, format, &reader, &error);
    if (status != TIDES_OK) {
        check_refusal(status, &error);
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
    if (status != TIDES_OK) check_refusal(status, &error);
    tides_event_reader_close(reader);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const unmarked[] = {"nmnist", "ecd", "dat", "csv-openeb"};
    char path[] = "/tmp/tides_fuzz_XXXXXX";
    if (size >= 4 && memcmp(data, "\x89HDF", 4) == 0) return 0;
    int descriptor = mkstemp(path);
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file) != 0) abort();
    read_file(path, NULL);
    read_file(path, unmarked[size % 4]);
    unlink(path);
    return 0;
}
