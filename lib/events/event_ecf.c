/* Reads Prophesee's HDF5 files: a dataset /CD/events of {x, y, p, t [us]}. Its chunks are unpacked here, so that Prophesee's
 * plugin for HDF5 isn't needed. */
#include "td_ecf.h"

#include "td_base.h"
#include "td_endian.h"
#include "td_event_h5_source.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* The codec allows 65535 events per chunk. An event takes at most 24 packed bytes. */
enum { CHUNK_MOST = 65535, PACKED_MOST = 12 + CHUNK_MOST * 24 };

typedef struct ecf_state {
    hid_t file, dataset;
    uint64_t rows, chunk; /* number of events; events per chunk */
    uint64_t next;        /* index of the next chunk to read */
    size_t held, taken;
    tides_event *events;
    unsigned char *packed;
    size_t packed_capacity;
} ecf_state;

static int detect_ecf(const td_event_probe *probe) {
    hid_t file = -1;
    td_h5_quiet quiet;
    if (!td_h5_detect(probe)) return 0;
    td_h5_quiet_begin(&quiet);
    int found = td_h5_open_file(probe->path, &file, NULL) == TIDES_OK && td_h5_exists(file, "/CD/events");
    td_h5_close(file);
    td_h5_quiet_end(&quiet);
    return found;
}

/* ---- opening ---- */

/* 1 if the dataset's only filter is Prophesee's codec. */
static int has_codec(hid_t creation) {
    unsigned flags, config;
    size_t values = 0;
    return H5Pget_nfilters(creation) == 1 &&
           H5Pget_filter2(creation, 0, &flags, &values, NULL, 0, NULL, &config) == TD_ECF_FILTER;
}

static tides_status open_dataset(ecf_state *state, const char *path, tides_error *error) {
    hsize_t extent = 0, chunk = 0;
    state->dataset = H5Dopen2(state->file, "/CD/events", H5P_DEFAULT);
    hid_t space = state->dataset < 0 ? -1 : H5Dget_space(state->dataset);
    hid_t creation = state->dataset < 0 ? -1 : H5Dget_create_plist(state->dataset);
    int flat = space >= 0 && H5Sget_simple_extent_ndims(space) == 1 && H5Sget_simple_extent_dims(space, &extent, NULL) == 1;
    int chunked = creation >= 0 && H5Pget_layout(creation) == H5D_CHUNKED && H5Pget_chunk(creation, 1, &chunk) == 1;
    int codec = chunked && has_codec(creation);
    td_h5_close(creation);
    td_h5_close(space);
    if (flat && !codec && !chunked)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: /CD/events isn't packed by Prophesee's filter (ECF), and only that is read: write its fields t, x, "
                       "y and p as datasets of their own",
                       path);
    if (!flat || !chunked || chunk == 0 || chunk > CHUNK_MOST)
        return td_fail(error, TIDES_BAD_FILE, "%s: /CD/events should be one column of events in chunks of up to %d", path,
                       CHUNK_MOST);
    if (!codec)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: /CD/events isn't compressed with Prophesee's codec (HDF5 filter %d) alone", path, TD_ECF_FILTER);
    state->rows = extent;
    state->chunk = chunk;
    return td_h5_check_storage(path, "/CD/events", state->dataset, extent, 1, error);
}

/* Reads the sensor's size from a text such as "1280x720". */
static void read_geometry(const ecf_state *state, tides_event_facts *facts) {
    char text[64], *end;
    if (!td_h5_read_text(state->file, "geometry", text, sizeof text)) return;
    long width = strtol(text, &end, 10), height = *end == 'x' ? strtol(end + 1, NULL, 10) : 0;
    if (width < 1 || height < 1 || width > 65536 || height > 65536) return;
    facts->width = (int32_t)width;
    facts->height = (int32_t)height;
}

static tides_status open_ecf(td_event_stream *stream, tides_error *error) {
    ecf_state *state = td_alloc(1, sizeof *state, error);
    stream->state = state;
    if (!state) return TIDES_NO_MEMORY;
    state->file = state->dataset = -1;
    tides_status status = td_h5_open_file(stream->input.path, &state->file, error);
    if (status == TIDES_OK) status = open_dataset(state, stream->input.path, error);
    if (status != TIDES_OK) return status;
    read_geometry(state, &stream->facts);
    stream->facts.counted = 1;
    stream->facts.count = state->rows;
    state->events = td_alloc((size_t)state->chunk, sizeof *state->events, error);
    return state->events ? TIDES_OK : TIDES_NO_MEMORY;
}

static void close_ecf(td_event_stream *stream) {
    ecf_state *state = stream->state;
    if (!state) return;
    td_h5_close(state->dataset);
    td_h5_close(state->file);
    free(state->packed);
    free(state->events);
    free(state);
}

/* ---- reading ---- */

static tides_status bad_chunk(const td_event_stream *stream, const char *what, tides_error *error) {
    const ecf_state *state = stream->state;
    return td_fail(error, TIDES_BAD_FILE, "%s: chunk %" PRIu64 " of /CD/events %s", stream->input.path, state->next, what);
}

/* Takes a chunk that is stored without the codec: records as they are in memory. */
static int take_records(ecf_state *state, size_t bytes) {
    state->held = bytes / TD_ECF_RECORD < state->chunk ? bytes / TD_ECF_RECORD : (size_t)state->chunk;
    for (size_t i = 0; i < state->held; i++) {
        const unsigned char *p = state->packed + TD_ECF_RECORD * i;
        state->events[i] = (tides_event){.x = td_le16(p), .y = td_le16(p + 2), .polarity = td_le16(p + 4) ? 1 : -1};
        if (!td_event_microseconds((int64_t)td_le64(p + 8), &state->events[i].t)) return 0;
    }
    return 1;
}

static tides_status next_chunk(td_event_stream *stream, tides_error *error) {
    ecf_state *state = stream->state;
    const hsize_t first = state->next * state->chunk;
    hsize_t bytes = 0;
    uint32_t skipped = 0;
    size_t wanted = state->rows - first < state->chunk ? (size_t)(state->rows - first) : (size_t)state->chunk;
    if (H5Dget_chunk_storage_size(state->dataset, &first, &bytes) < 0 || bytes == 0 || bytes > PACKED_MOST)
        return bad_chunk(stream, "isn't there, or larger than a chunk can be", error);
    tides_status status = td_reserve((void **)&state->packed, &state->packed_capacity, (size_t)bytes, 1, error);
    if (status != TIDES_OK) return status;
    if (H5Dread_chunk(state->dataset, H5P_DEFAULT, &first, &skipped, state->packed) < 0)
        return bad_chunk(stream, "can't be read", error);
    memset(state->events, 0, (size_t)state->chunk * sizeof *state->events);
    state->taken = state->held = 0;
    int good = skipped ? take_records(state, (size_t)bytes)
                       : td_ecf_unpack(state->packed, (size_t)bytes, state->events, (size_t)state->chunk, &state->held);
    if (!good || state->held < wanted) {
        state->held = 0;
        return bad_chunk(stream, "is damaged", error);
    }
    state->held = wanted; /* the rest of the last chunk is padding */
    state->next++;
    return TIDES_OK;
}

static tides_status read_ecf(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error) {
    ecf_state *state = stream->state;
    while (*got < capacity) {
        if (state->taken == state->held && state->next * state->chunk >= state->rows) return TIDES_OK;
        tides_status status = state->taken == state->held ? next_chunk(stream, error) : TIDES_OK;
        if (status != TIDES_OK) return status;
        size_t there = state->held - state->taken, room = capacity - *got, count = there < room ? there : room;
        memcpy(events + *got, state->events + state->taken, count * sizeof *events);
        state->taken += count;
        *got += count;
    }
    return TIDES_OK;
}

const td_event_format td_format_ecf = {
    .name = "ecf",
    .endings = ".ecf.hdf5 .ecf.h5",
    .summary = "Prophesee's HDF5",
    .tick_ns = 1000,
    .size_limit = 2048,
    .library = 1,
    .detect = detect_ecf,
    .open = open_ecf,
    .read = read_ecf,
    .close = close_ecf,
    .create = td_ecf_create,
    .check = td_ecf_check,
    .write = td_ecf_write,
    .complete = td_ecf_complete,
    .discard = td_ecf_discard,
};
