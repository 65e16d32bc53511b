/* Bytes of event files: read through a buffer, and written to the .part beside the final file. */
#include "td_event_format.h"

#include "td_base.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- in ---- */

tides_status td_input_open(td_event_input *input, const char *path, tides_error *error) {
    struct stat there;
    *input = (td_event_input){.path = path};
    input->file = fopen(path, "rb");
    if (!input->file) return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", path, strerror(errno));
    if (fstat(fileno(input->file), &there) != 0 || !S_ISREG(there.st_mode))
        return td_fail(error, TIDES_BAD_FILE, "%s: is not a regular file", path);
    input->size = (uint64_t)there.st_size;
    input->buffer = td_alloc(TD_EVENT_BUFFER, 1, error);
    if (!input->buffer) return TIDES_NO_MEMORY;
    input->data = input->buffer;
    return TIDES_OK;
}

void td_input_close(td_event_input *input) {
    if (input->file) fclose(input->file);
    free(input->buffer);
    input->file = NULL;
    input->buffer = NULL;
}

static tides_status read_failed(const td_event_input *input, tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s: can't be read at byte %llu: %s", input->path, (unsigned long long)input->at,
                   strerror(errno));
}

tides_status td_input_fill(td_event_input *input, size_t wanted, tides_error *error) {
    if (input->ready >= wanted) return TIDES_OK;
    memmove(input->buffer, input->data, input->ready);
    input->data = input->buffer;
    input->ready += fread(input->buffer + input->ready, 1, TD_EVENT_BUFFER - input->ready, input->file);
    return ferror(input->file) ? read_failed(input, error) : TIDES_OK;
}

void td_input_skip(td_event_input *input, size_t bytes) {
    input->data += bytes;
    input->ready -= bytes;
    input->at += bytes;
}

tides_status td_input_copy(td_event_input *input, void *out, size_t bytes, tides_error *error) {
    size_t had = bytes < input->ready ? bytes : input->ready;
    memcpy(out, input->data, had);
    td_input_skip(input, had);
    size_t got = fread((char *)out + had, 1, bytes - had, input->file);
    input->at += got;
    if (ferror(input->file)) return read_failed(input, error);
    if (had + got == bytes) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: is cut off: %zu bytes are missing at its end", input->path, bytes - had - got);
}

/* Reads a line, which ends with LF, CR LF, or CR alone. */
tides_status td_input_peek(td_event_input *input, char *line, size_t size, int *got, size_t *bytes, tides_error *error) {
    tides_status status = td_input_fill(input, size + 1, error); /* + 1 for the LF behind the CR of the longest line */
    if (status != TIDES_OK) return status;
    const unsigned char *data = input->data;
    const size_t most = input->ready < size ? input->ready : size;
    size_t length = 0;
    while (length < most && data[length] != '\n' && data[length] != '\r') length++;
    *got = input->ready > 0;
    if (length >= size)
        return td_fail(error, TIDES_BAD_FILE, "%s: the line at byte %llu is longer than any line of an event file", input->path,
                       (unsigned long long)input->at);
    memcpy(line, data, length);
    line[length] = '\0';
    *bytes = length;
    if (length < input->ready) *bytes += data[length] == '\r' && length + 1 < input->ready && data[length + 1] == '\n' ? 2 : 1;
    return TIDES_OK;
}

tides_status td_input_line(td_event_input *input, char *line, size_t size, int *got, tides_error *error) {
    size_t bytes = 0;
    tides_status status = td_input_peek(input, line, size, got, &bytes, error);
    if (status == TIDES_OK) td_input_skip(input, bytes);
    return status;
}

/* ---- out ---- */

void td_sink_flush(td_event_sink *sink) {
    errno = 0;
    if (!sink->failed && fwrite(sink->held, 1, sink->holds, sink->file) != sink->holds) sink->failed = errno ? errno : EIO;
    sink->holds = 0;
}

void td_sink_text(td_event_sink *sink, const char *text) { td_sink_bytes(sink, text, strlen(text)); }

void td_sink_patch(td_event_sink *sink, uint64_t at, const void *data, size_t bytes) {
    td_sink_flush(sink);
    if (sink->failed) return;
    errno = 0;
    int done = fseeko(sink->file, (off_t)at, SEEK_SET) == 0 && fwrite(data, 1, bytes, sink->file) == bytes &&
               fseeko(sink->file, 0, SEEK_END) == 0;
    if (!done) sink->failed = errno ? errno : EIO;
}
