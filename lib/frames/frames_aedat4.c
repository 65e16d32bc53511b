/* Frames of an AEDAT 4 recording (dv, DAVIS cameras), which are beside the events and have their clock: packets of the stream
 * of type FRME. Each is a flatbuffer with the middle of its exposure (taken as its time), begin and end of the exposure,
 * format, size, place, and pixels. Pixels have 8 bits, and are grey or blue, green, red. The places of all frames are listed
 * when the file is opened. */
#include "td_frames.h"

#include "archive/td_aedat4_parts.h"
#include "td_endian.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Field numbers of a frame. */
enum { TIME = 0, EXPOSED_FROM = 3, EXPOSED_TO = 4, FORMAT = 5, WIDTH = 6, HEIGHT = 7, LEFT = 8, TOP = 9, PIXELS = 10 };
/* Numbers of the formats that are read; and the most frames that are listed. */
enum { GREY = 0, BGR = 16, BGRA = 24, COUNT_MOST = 100000000 };

typedef struct place {
    uint64_t at; /* byte offset of the packet's payload */
    uint32_t bytes;
} place;

typedef struct recording {
    FILE *file;
    uint64_t end; /* byte offset at which the packets end */
    int32_t compression, stream;
    place *places;
    size_t capacity, times_capacity;
    unsigned char *packed, *payload;
    size_t packed_capacity, payload_capacity;
    double exposed; /* [s] exposure of the first frame; 0: unknown */
} recording;

/* A frame in the recording's memory. */
typedef struct one_frame {
    double time, exposed;                               /* [s] */
    int32_t width, height, left, top, channels, stored; /* [px] size and place; channels with light, and all channels stored */
    const unsigned char *pixels;
} one_frame;

static void close_recording(void *state) {
    recording *r = state;
    if (r->file) fclose(r->file);
    free(r->places);
    free(r->packed);
    free(r->payload);
    free(r);
}

/* -- one frame ------------------------------------------------------------------------------------------------------------- */

static int64_t number_of(td_flat f, size_t table, size_t field) {
    const size_t at = td_flat_field(f, table, field, 8);
    return at ? (int64_t)td_le64(f.data + at) : 0;
}

static int32_t short_of(td_flat f, size_t table, size_t field) {
    const size_t at = td_flat_field(f, table, field, 2);
    return at ? (int16_t)td_le16(f.data + at) : 0;
}

static tides_status take_frame(const tides_frames *frames, td_flat f, size_t index, one_frame *out, tides_error *error) {
    const size_t table = td_flat_root(f, "FRME"), format = table ? td_flat_field(f, table, FORMAT, 1) : 0;
    size_t bytes = 0;
    if (!table)
        return td_fail(error, TIDES_BAD_FILE, "%s: frame %zu is none (FRME), though its stream says so", frames->path, index);
    const int64_t from = number_of(f, table, EXPOSED_FROM), to = number_of(f, table, EXPOSED_TO);
    const int32_t kind = format ? (int8_t)f.data[format] : GREY;
    *out = (one_frame){.time = (double)number_of(f, table, TIME) / 1e6,
                       .exposed = to > from ? (double)(to - from) / 1e6 : 0,
                       .width = short_of(f, table, WIDTH),
                       .height = short_of(f, table, HEIGHT),
                       .left = short_of(f, table, LEFT),
                       .top = short_of(f, table, TOP),
                       .channels = kind == GREY ? 1 : 3,
                       .stored = kind == GREY  ? 1
                                 : kind == BGR ? 3
                                               : 4};
    out->pixels = td_flat_vector(f, table, PIXELS, 1, &bytes);
    if (kind != GREY && kind != BGR && kind != BGRA)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: frame %zu is of format %d; GRAY, BGR and BGRA are known", frames->path,
                       index, kind);
    if (out->width < 1 || out->height < 1 || !out->pixels ||
        bytes / (size_t)out->stored / (size_t)out->width < (size_t)out->height)
        return td_fail(error, TIDES_BAD_FILE, "%s: frame %zu says %dx%d px and has %zu bytes", frames->path, index, out->width,
                       out->height, bytes);
    return TIDES_OK;
}

static tides_status cut_off(const tides_frames *frames, tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s: ends within a packet", frames->path);
}

static tides_status read_packet(tides_frames *frames, const place *where, size_t index, one_frame *out, tides_error *error) {
    recording *r = frames->state;
    size_t bytes = where->bytes;
    tides_status status = td_reserve((void **)&r->packed, &r->packed_capacity, bytes + 1, 1, error);
    if (status != TIDES_OK) return status;
    if (fseeko(r->file, (off_t)where->at, SEEK_SET) != 0 || fread(r->packed, 1, bytes, r->file) != bytes)
        return cut_off(frames, error);
    const unsigned char *data = r->packed;
    if (r->compression != TD_AEDAT4_NONE) {
        status = td_aedat4_unpack(r->compression, r->packed, where->bytes, TD_AEDAT4_PACKET_MOST, &r->payload,
                                  &r->payload_capacity, &bytes, error);
        if (status != TIDES_OK) return status;
        data = r->payload;
    }
    if (bytes < 4 || td_le32(data) > bytes - 4) return cut_off(frames, error);
    return take_frame(frames, (td_flat){data + 4, td_le32(data)}, index, out, error);
}

static tides_status read_frame(tides_frames *frames, size_t index, double *Y, tides_error *error) {
    const recording *r = frames->state;
    const size_t pixels = (size_t)frames->width * (size_t)frames->height;
    one_frame f;
    tides_status status = read_packet(frames, &r->places[index], index, &f, error);
    if (status != TIDES_OK) return status;
    if (f.width != frames->width || f.height != frames->height || f.left || f.top)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: frame %zu is %dx%d px at %d, %d, a part of the others' %dx%d",
                       frames->path, index, f.width, f.height, f.left, f.top, frames->width, frames->height);
    float *values = td_alloc(pixels * (size_t)f.channels, sizeof *values, error);
    if (!values) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < pixels; i++)
        for (int32_t k = 0; k < f.channels; k++)
            values[i * (size_t)f.channels + (size_t)k] =
                (float)f.pixels[i * (size_t)f.stored + (size_t)(f.channels - 1 - k)] / 255.0f;
    td_frame_luminance(frames, values, 255, f.channels, pixels, Y);
    free(values);
    return TIDES_OK;
}

/* -- the file -------------------------------------------------------------------------------------------------------------- */

static tides_status parse_header(tides_frames *frames, td_flat header, tides_error *error) {
    recording *r = frames->state;
    td_aedat4_stream told, other;
    char *xml = NULL;
    uint64_t end = 0;
    const tides_status status = td_aedat4_header(header, frames->path, &r->compression, &end, &xml, error);
    if (status != TIDES_OK) return status;
    if (end > 0 && end < r->end) r->end = end;
    const int found = td_aedat4_next(xml, xml, "FRME", &told),
              several = found && td_aedat4_next(xml, told.type, "FRME", &other);
    r->stream = found ? told.number : -1;
    free(xml);
    if (!found) return td_fail(error, TIDES_BAD_FILE, "%s: holds no stream of frames (FRME)", frames->path);
    return several ? td_fail(error, TIDES_UNSUPPORTED, "%s: holds several streams of frames (FRME); one is read", frames->path)
                   : TIDES_OK;
}

static tides_status open_header(tides_frames *frames, tides_error *error) {
    recording *r = frames->state;
    unsigned char start[TD_AEDAT4_MAGIC_BYTES + 4], *header;
    r->file = fopen(frames->path, "rb");
    if (!r->file || fseeko(r->file, 0, SEEK_END) != 0)
        return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened", frames->path);
    r->end = (uint64_t)ftello(r->file);
    rewind(r->file);
    if (fread(start, 1, sizeof start, r->file) != sizeof start || memcmp(start, TD_AEDAT4_MAGIC, TD_AEDAT4_MAGIC_BYTES) != 0)
        return td_fail(error, TIDES_BAD_FILE, "%s: isn't AEDAT 4", frames->path);
    const size_t bytes = td_le32(start + TD_AEDAT4_MAGIC_BYTES);
    if (bytes > TD_AEDAT4_HEADER_MOST || bytes > r->end) return td_aedat4_damaged(frames->path, error);
    header = td_alloc(bytes, 1, error);
    if (!header) return TIDES_NO_MEMORY;
    const tides_status status = fread(header, 1, bytes, r->file) == bytes
                                    ? parse_header(frames, (td_flat){header, bytes}, error)
                                    : td_aedat4_damaged(frames->path, error);
    free(header);
    return status;
}

/* Adds the next frame to the list, with its time. */
static tides_status list_frame(tides_frames *frames, place where, tides_error *error) {
    recording *r = frames->state;
    one_frame f;
    tides_status status = td_reserve((void **)&r->places, &r->capacity, frames->count + 1, sizeof *r->places, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&frames->times, &r->times_capacity, frames->count + 1, sizeof *frames->times, error);
    if (status == TIDES_OK) status = read_packet(frames, &where, frames->count, &f, error);
    if (status != TIDES_OK) return status;
    if (frames->count == 0) {
        frames->width = f.width;
        frames->height = f.height;
        r->exposed = f.exposed;
    }
    frames->times[frames->count] = f.time;
    r->places[frames->count++] = where;
    return TIDES_OK;
}

static tides_status list_frames(tides_frames *frames, tides_error *error) {
    recording *r = frames->state;
    tides_status status = TIDES_OK;
    for (uint64_t at = (uint64_t)ftello(r->file); at < r->end && frames->count < COUNT_MOST && status == TIDES_OK;) {
        unsigned char head[8];
        if (r->end - at < sizeof head || fseeko(r->file, (off_t)at, SEEK_SET) != 0 ||
            fread(head, 1, sizeof head, r->file) != sizeof head)
            return cut_off(frames, error);
        const place where = {at + sizeof head, td_le32(head + 4)};
        if (where.bytes > r->end - where.at || where.bytes > TD_AEDAT4_PACKET_MOST) return cut_off(frames, error);
        if ((int32_t)td_le32(head) == r->stream) status = list_frame(frames, where, error);
        at = where.at + where.bytes;
    }
    return status;
}

tides_status td_frames_aedat4(tides_frames *frames, tides_error *error) {
    static const td_frame_source source = {read_frame, close_recording};
    recording *r = td_alloc(1, sizeof *r, error);
    if (!r) return TIDES_NO_MEMORY;
    frames->source = &source;
    frames->state = r;
    frames->most = 255;
    tides_status status = open_header(frames, error);
    if (status == TIDES_OK) status = list_frames(frames, error);
    if (status == TIDES_OK)
        status =
            td_frames_take_shape(frames, frames->path, frames->count, (size_t)frames->height, (size_t)frames->width, error);
    if (status == TIDES_OK && r->exposed > 0)
        snprintf(frames->note, sizeof frames->note,
                 "%.200s: frames' times are the middles of their exposures, of %.4g ms in the first", frames->path,
                 1e3 * r->exposed);
    return status;
}
