/* The tail of an unfinished event file: its events after the last whole chunk.
 *
 * Chunks of the .part are written only once: a death while one is rewritten would destroy events that were safe before. So a
 * flush puts a partial chunk into another file, PATH.part.tail. It has the same HDF5 layout, and an attribute `first`, the
 * number of its first event in the stream. It is always replaced as a whole, by a rename. */
#include "td_event_store.h"

#include "archive/td_h5_driver.h"
#include "td_base.h"

#include <inttypes.h>
#include <stdlib.h>
#include <unistd.h>

static tides_status write_store(const char *part, const tides_event_file *facts, int64_t offset, uint64_t first,
                                const tides_event *events, const int64_t *fired, size_t count, tides_error *error) {
    td_event_store store;
    /* run text and seed are in the .part */
    const tides_event_file bare = {facts->width, facts->height, NULL, NULL, facts->labels, 0, 0};
    tides_status status = td_event_store_create(&store, part, &bare, offset, error);
    if (status != TIDES_OK) return status;
    tides_error reason = {0};
    if (td_h5_write_int(store.file, "first", H5T_STD_I64LE, (int64_t)first) < 0) {
        td_h5_reason text;
        status = td_fail(&reason, TIDES_WRITE_FAILED, "%s", td_h5_reason_text(&text));
    }
    if (status == TIDES_OK) status = td_event_store_append(&store, events, fired, count, &reason);
    tides_status closed = td_event_store_close(&store, status == TIDES_OK ? &reason : NULL);
    if (status == TIDES_OK) status = closed;
    return status == TIDES_OK ? status : td_fail(error, status, "%s: can't be written: %s", part, reason.text);
}

tides_status td_event_tail_write(const char *path, const tides_event_file *facts, int64_t offset, uint64_t first,
                                 const tides_event *events, const int64_t *fired, size_t count, tides_error *error) {
    char *part = NULL;
    tides_status status = td_part_name(path, 0, &part, error);
    if (status != TIDES_OK) return status;
    status = write_store(part, facts, offset, first, events, fired, count, error);
    if (status == TIDES_OK) status = td_commit_file(part, path, error);
    if (status != TIDES_OK) td_remove_part(part, path);
    free(part);
    return status;
}

/* Reads the attribute `first`; -1 if it is missing. */
static int64_t read_first(const char *path) {
    int64_t first = -1;
    hid_t file = td_h5_open_disk(path);
    if (file >= 0 && !td_h5_read_int(file, "first", &first)) first = -1;
    td_h5_close(file);
    return first;
}

tides_status td_event_tail_read(const char *path, uint64_t first, tides_event *events, int64_t *fired, size_t count,
                                tides_error *error) {
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    int64_t begins = read_first(path);
    td_h5_quiet_end(&quiet);
    if (begins < 0 || (uint64_t)begins != first)
        return td_fail(error, TIDES_BAD_FILE, "%s: is missing, or doesn't begin with event %" PRIu64, path, first);
    size_t got = 0;
    tides_status status = tides_events_read(path, 0, count, events, &got, error);
    if (status == TIDES_OK && got == count) status = tides_events_labels(path, 0, count, events, fired, error);
    if (status != TIDES_OK || got == count) return status;
    return td_fail(error, TIDES_BAD_FILE, "%s: holds %zu events, %zu were expected", path, got, count);
}
