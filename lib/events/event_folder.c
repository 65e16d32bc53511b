/* Folders of data sets: finds their event files, the order of these, and the image's size.
 *
 *   DSEC      SEQ/events/{left,right}/events.h5, rectify_map.h5 beside it (height, width, 2)
 *   EDS       SEQ/events.h5
 *   ECD       SEQ/events.txt, SEQ/images/frame_%08d.png
 *   MVSEC     SEQ/NAME_data.hdf5
 *   BlinkFlow SEQ/events_left/events.h5
 *   HS-ERGB   SEQ/events_aligned/%06d.npz, SEQ/images_corrected/%06d.png
 *   BS-ERGB   SEQ/events/%06d.npz, SEQ/images/%06d.png
 *   rpg_vid2e DIR/%010d.npz
 *
 * The user names the folder of the sequence or of the event files. Numbered files are read one after the other. Coordinates
 * of HS-ERGB and BS-ERGB are fine, in 1/32 px. They are rounded to the nearest pixel and clipped to the image, as in the
 * loaders of these data sets. */
#include "td_event_format.h"

#include "td_event_h5_source.h"
#include "td_folder.h"

#include <stdlib.h>
#include <string.h>

typedef struct folder_state {
    td_folder files;
    size_t next;                  /* index of the next file to open */
    const td_event_format *inner; /* the format of all files */
    td_event_stream stream;       /* the file being read */
    uint64_t dropped;             /* invalid events of the file being read that were already counted */
    int opened;
} folder_state;

/* ---- finding the files ---- */

/* Places of the event files, relative to the named folder. */
static const char *const places[] = {"", "/events_aligned", "/events", "/events/left", "/events/right", "/events_left"};
enum { PLACES = sizeof places / sizeof *places };

/* Lists the numbered files of one ending. Other files there hold other data (MVSEC's flow, EVIMO2's masks). */
static tides_status list_numbered(const char *path, td_folder *files, tides_error *error) {
    td_folder all = {NULL, 0, 0};
    tides_status status = td_folder_list(&all, path, ".npz", error);
    for (size_t i = 0; i < all.count && status == TIDES_OK; i++) {
        const char *name = td_base_name(all.files[i]), *ending = strrchr(name, '.');
        if (ending > name && ending[-1] >= '0' && ending[-1] <= '9') status = td_folder_add(files, path, name, error);
    }
    td_folder_free(&all);
    return status;
}

/* Finds the event files in one folder: a single file, or all numbered .npz. */
static tides_status list_place(const char *path, td_folder *files, tides_error *error) {
    static const char *const singles[] = {"events.h5", "events.txt"};
    tides_status status = TIDES_OK;
    for (int i = 0; i < 2 && !files->count && status == TIDES_OK; i++) {
        char *single = td_format(error, "%s/%s", path, singles[i]);
        status = !single ? TIDES_NO_MEMORY : td_is_file(single) ? td_folder_add(files, path, singles[i], error) : TIDES_OK;
        free(single);
    }
    if (status == TIDES_OK && !files->count) status = td_folder_list(files, path, "_data.hdf5", error);
    if (status == TIDES_OK && files->count > 1)
        status = td_fail(error, TIDES_BAD_FILE, "%s: holds %zu recordings, %s and others: name one of them", path, files->count,
                         td_base_name(files->files[0]));
    return status == TIDES_OK && !files->count ? list_numbered(path, files, error) : status;
}

/* Finds the event files. `*where` becomes their folder, which the caller frees. */
static tides_status find_files(folder_state *state, const char *path, const char *stream, char **where, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int i = 0; i < PLACES && status == TIDES_OK; i++) {
        td_folder files = {NULL, 0, 0};
        if (stream && !td_ends_in(places[i], stream)) continue;
        char *place = td_format(error, "%s%s", path, places[i]);
        status = place ? list_place(place, &files, error) : TIDES_NO_MEMORY;
        if (status == TIDES_OK && files.count && !*where) {
            *where = place;
            state->files = files;
            continue;
        }
        if (status == TIDES_OK && files.count)
            status =
                td_fail(error, TIDES_BAD_FILE, "%s: holds events in %s and in %s: name one of them, or --stream (stream) left",
                        path, *where, place);
        td_folder_free(&files);
        free(place);
    }
    if (status != TIDES_OK || *where) return status;
    return td_fail(error, TIDES_FILE_NOT_FOUND,
                   "%s: is a folder without events of DSEC, EDS, ECD, MVSEC, BlinkFlow, HS-ERGB, BS-ERGB or rpg_vid2e "
                   "(events.h5, "
                   "events.txt, *_data.hdf5 or numbered .npz, in it or in events, events_aligned, events_left, events/left or "
                   "events/right): name a file in it",
                   path);
}

/* ---- format and size ---- */

/* Decides from all files together whether coordinates are fine (1/32 px). A single file with all events near the corner can't
 * tell. */
static tides_status choose_inner(folder_state *state, const char *where, tides_error *error) {
    const td_folder *files = &state->files;
    int fine = 0;
    state->inner = &td_format_hdf5;
    if (!td_ends_in(files->files[0], ".npz")) {
        if (td_ends_in(files->files[0], ".txt")) state->inner = &td_format_ecd;
        return TIDES_OK;
    }
    for (size_t i = 0; i < files->count && !fine; i++) {
        tides_status status = td_event_npz_is_fine(files->files[i], &fine, error);
        if (status != TIDES_OK) return status;
    }
    state->inner = fine ? &td_format_ergb : &td_format_npz;
    if (fine || !strstr(where, "events_aligned")) return TIDES_OK;
    return td_fail(error, TIDES_UNSUPPORTED,
                   "%s: no coordinate is beyond 8191, so that 1/32 px (HS-ERGB) and whole pixels (rpg_vid2e) look alike: name "
                   "the format, ergb or npz (--from)",
                   where);
}

/* Reads a PNG's big-endian width and height, which follow its signature and the first chunk's name. 0: not a size. */
static void read_png_size(const char *path, tides_event_facts *facts) {
    unsigned char head[24];
    FILE *file = fopen(path, "rb");
    size_t got = file ? fread(head, 1, sizeof head, file) : 0;
    if (file) fclose(file);
    if (got < sizeof head || memcmp(head, "\x89PNG", 4) != 0 || head[16] || head[17] || head[20] || head[21]) return;
    const int32_t width = head[18] << 8 | head[19], height = head[22] << 8 | head[23];
    if (!width || !height) return;
    facts->width = width;
    facts->height = height;
}

/* The size of the first picture. ERGB's events are aligned with the pictures, and ECD's pictures are the sensor's own. */
static tides_status read_picture_size(const char *where, tides_event_facts *facts, tides_error *error) {
    static const char *const places_of[] = {"../images_corrected", "../images", "images"};
    tides_status status = TIDES_OK;
    for (int i = 0; i < 3 && !facts->width && status == TIDES_OK; i++) {
        td_folder pictures = {NULL, 0, 0};
        char *path = td_format(error, "%s/%s", where, places_of[i]);
        status = path ? td_folder_list(&pictures, path, ".png", error) : TIDES_NO_MEMORY;
        if (pictures.count) read_png_size(pictures.files[0], facts);
        td_folder_free(&pictures);
        free(path);
    }
    return status;
}

/* The size of DSEC's rectification map, which has one entry per pixel. */
static tides_status read_map_size(const char *where, tides_event_facts *facts, tides_error *error) {
    hsize_t extent[3] = {0, 0, 0};
    hid_t file = -1, map = -1, space = -1;
    char *path = td_format(error, "%s/rectify_map.h5", where);
    if (!path) return TIDES_NO_MEMORY;
    tides_status status = td_is_file(path) ? td_h5_open_file(path, &file, error) : TIDES_OK;
    if (file >= 0 && td_h5_exists(file, "/rectify_map")) map = H5Dopen2(file, "/rectify_map", H5P_DEFAULT);
    if (map >= 0) space = H5Dget_space(map);
    if (file >= 0 &&
        (space < 0 || H5Sget_simple_extent_ndims(space) != 3 || H5Sget_simple_extent_dims(space, extent, NULL) != 3 ||
         extent[2] != 2 || extent[0] < 1 || extent[1] < 1 || extent[0] > 65536 || extent[1] > 65536))
        status = td_fail(error, TIDES_BAD_FILE, "%s: should hold a dataset rectify_map of the shape (height, width, 2)", path);
    td_h5_close(space);
    td_h5_close(map);
    td_h5_close(file);
    free(path);
    if (status != TIDES_OK || file < 0) return status;
    facts->width = (int32_t)extent[1];
    facts->height = (int32_t)extent[0];
    return TIDES_OK;
}

/* ---- reading ---- */

static void close_file(folder_state *state) {
    if (!state->opened) return;
    state->inner->close(&state->stream);
    td_input_close(&state->stream.input);
    state->opened = 0;
}

static tides_status open_next(td_event_stream *stream, tides_error *error) {
    folder_state *state = stream->state;
    const char *path = state->files.files[state->next];
    stream->input.at = state->next++; /* position counted in files */
    state->stream = (td_event_stream){.input = {.path = path}, .reading = stream->reading};
    state->stream.reading.stream = NULL; /* the option `stream` names a stream of the folder, not of the file */
    snprintf(state->stream.facts.format, sizeof state->stream.facts.format, "%s", state->inner->name);
    state->opened = 1;
    state->dropped = 0;
    tides_status status = state->inner->library ? TIDES_OK : td_input_open(&state->stream.input, path, error);
    if (status == TIDES_OK) status = state->inner->open(&state->stream, error);
    if (status != TIDES_OK) return status;
    const tides_event_facts *file = &state->stream.facts;
    if (!stream->facts.width) {
        stream->facts.width = file->width;
        stream->facts.height = file->height;
    }
    if (!file->width || (file->width == stream->facts.width && file->height == stream->facts.height)) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: says %d x %d px, but the folder's other files say %d x %d", path, file->width,
                   file->height, stream->facts.width, stream->facts.height);
}

static tides_status open_files(td_event_stream *stream, char **where, tides_error *error) {
    folder_state *state = stream->state;
    tides_status status = find_files(state, stream->input.path, stream->reading.stream, where, error);
    if (status != TIDES_OK) return status;
    state->inner = stream->named;
    if (!state->inner) status = choose_inner(state, *where, error);
    if (status != TIDES_OK) return status;
    const char *first = state->files.files[0];
    if (td_ends_in(first, ".h5"))
        status = read_map_size(*where, &stream->facts, error);
    else if (!td_ends_in(first, ".hdf5"))
        status = read_picture_size(*where, &stream->facts, error);
    stream->input.size = state->files.count;
    if (status == TIDES_OK) status = open_next(stream, error);
    if (status != TIDES_OK) return status;
    memcpy(stream->facts.format, state->stream.facts.format, sizeof stream->facts.format);
    memcpy(stream->facts.version, state->stream.facts.version, sizeof stream->facts.version);
    memcpy(stream->facts.read_as, state->stream.facts.read_as, sizeof stream->facts.read_as);
    stream->facts.zero = state->stream.facts.zero;
    stream->facts.zero_ns = state->stream.facts.zero_ns;
    stream->facts.counted = state->files.count == 1 && state->stream.facts.counted;
    stream->facts.count = stream->facts.counted ? state->stream.facts.count : 0;
    return TIDES_OK;
}

static tides_status open_folder(td_event_stream *stream, tides_error *error) {
    char *where = NULL;
    if (!(stream->state = td_alloc(1, sizeof(folder_state), error))) return TIDES_NO_MEMORY;
    tides_status status = open_files(stream, &where, error);
    free(where);
    return status;
}

static void clip(const tides_event_facts *facts, tides_event *events, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (events[i].x >= facts->width) events[i].x = (uint16_t)(facts->width - 1);
        if (events[i].y >= facts->height) events[i].y = (uint16_t)(facts->height - 1);
    }
}

static tides_status read_folder(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got,
                                tides_error *error) {
    folder_state *state = stream->state;
    for (;;) {
        tides_status status = state->inner->read(&state->stream, events, capacity, got, error);
        state->stream.done += *got;
        stream->facts.dropped += state->stream.facts.dropped - state->dropped;
        state->dropped = state->stream.facts.dropped;
        if (state->inner == &td_format_ergb && stream->facts.width) clip(&stream->facts, events, *got);
        if (status != TIDES_OK || *got || state->next == state->files.count) return status;
        close_file(state);
        status = open_next(stream, error);
        if (status != TIDES_OK) return status;
    }
}

static void close_folder(td_event_stream *stream) {
    folder_state *state = stream->state;
    if (!state) return;
    close_file(state);
    td_folder_free(&state->files);
    free(state);
}

const td_event_format td_format_folder = {
    .name = "folder",
    .summary = "folders of DSEC, EDS, ECD, MVSEC, BlinkFlow, HS-ERGB, BS-ERGB and rpg_vid2e",
    .library = 1,
    .takes = TD_TAKES_STREAM | TD_TAKES_UNIT,
    .open = open_folder,
    .read = read_folder,
    .close = close_folder,
};
