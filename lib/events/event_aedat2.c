/* Reads AEDAT 2.0 of jAER and v2e (.aedat): text lines that begin with '#', then per event a 32-bit address and a time in
 * microseconds, both big-endian. Address bits of a DAVIS: 31 set for images; 22 to 30 y and 12 to 21 x, both counted from the
 * far corner; 11 polarity; 10 set for external events. */
#include "td_event_format.h"

#include "td_base.h"
#include "td_endian.h"

#include <string.h>

enum { RECORD = 8 }; /* bytes of an event */

static const char magic[] = "#!AER-DAT2.0";

static int detect_aedat2(const td_event_probe *probe) {
    return probe->bytes >= sizeof magic && memcmp(probe->head, magic, sizeof magic - 1) == 0;
}

/* Sets the sensor's size from a word of the header. Without such a word it stays 346 x 260, as v2e writes. */
static void set_size(td_event_stream *stream, const char *line) {
    static const struct {
        const char *word;
        int32_t width, height;
    } sensors[] = {{"DAVIS240", 240, 180}, {"Davis240", 240, 180}, {"DAVIS640", 640, 480},
                   {"Davis640", 640, 480}, {"DAVIS346", 346, 260}, {"Davis346", 346, 260}};
    for (size_t i = 0; i < sizeof sensors / sizeof *sensors; i++) {
        if (!strstr(line, sensors[i].word)) continue;
        stream->facts.width = sensors[i].width;
        stream->facts.height = sensors[i].height;
    }
}

static tides_status open_aedat2(td_event_stream *stream, tides_error *error) {
    stream->facts.width = 346;
    stream->facts.height = 260;
    for (;;) {
        char line[1024];
        int got = 0;
        tides_status status = td_input_fill(&stream->input, 1, error);
        if (status != TIDES_OK || stream->input.ready == 0 || stream->input.data[0] != '#') return status;
        status = td_input_line(&stream->input, line, sizeof line, &got, error);
        if (status != TIDES_OK) return status;
        if (strstr(line, "DVS128"))
            return td_fail(error, TIDES_UNSUPPORTED, "%s: holds addresses of a DVS128: only those of DAVIS sensors can be read",
                           stream->input.path);
        set_size(stream, line);
    }
}

static tides_status read_aedat2(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got,
                                tides_error *error) {
    while (*got < capacity) {
        tides_status status = td_input_fill(&stream->input, RECORD, error);
        if (status != TIDES_OK) return status;
        if (stream->input.ready < RECORD) return stream->input.ready ? td_event_cut_off(stream, error) : TIDES_OK;
        uint32_t address = td_be32(stream->input.data);
        int32_t time = (int32_t)td_be32(stream->input.data + 4);
        td_input_skip(&stream->input, RECORD);
        if (address & 0x80000400u) continue; /* images, external events */
        int32_t x = stream->facts.width - 1 - (int32_t)(address >> 12 & 1023);
        int32_t y = stream->facts.height - 1 - (int32_t)(address >> 22 & 511);
        if (x < 0 || y < 0)
            return td_event_bad(stream, td_event_number(stream, *got), "lies outside the sensor that the header says", error);
        events[(*got)++] = (tides_event){.t = time * INT64_C(1000),
                                         .x = (uint16_t)x,
                                         .y = (uint16_t)y,
                                         .polarity = address >> 11 & 1 ? 1 : -1};
    }
    return TIDES_OK;
}

const td_event_format td_format_aedat2 = {
    .name = "aedat2",
    .summary = "AEDAT 2 (jAER, v2e) of DAVIS sensors",
    .detect = detect_aedat2,
    .open = open_aedat2,
    .read = read_aedat2,
    .close = td_event_close_state,
};
