/* Reads files of N-MNIST and N-Caltech101 (.bin). An event is 5 bytes: x, y, polarity << 7 | bits 22 to 16 of the time, bits
 * 15 to 8, bits 7 to 0, in microseconds. There is no header: files are recognised by ending, size and rising times. */
#include "td_event_format.h"

#include <string.h>

enum { RECORD = 5 }; /* bytes of an event */

static uint32_t time_us(const unsigned char *p) { return (uint32_t)(p[2] & 127) << 16 | (uint32_t)p[3] << 8 | p[4]; }

static int detect_nmnist(const td_event_probe *probe) {
    size_t length = strlen(probe->path);
    if (length < 4 || strcmp(probe->path + length - 4, ".bin") != 0 || probe->size % RECORD != 0) return 0;
    const unsigned char *head = (const unsigned char *)probe->head;
    for (size_t at = RECORD; at + RECORD <= probe->bytes; at += RECORD)
        if (time_us(head + at) < time_us(head + at - RECORD)) return 0;
    return 1;
}

static tides_status open_nmnist(td_event_stream *stream, tides_error *error) {
    (void)stream;
    (void)error;
    return TIDES_OK; /* the sensor's size is unknown: 34 x 34 or 233 x 173, by data set */
}

static tides_status read_nmnist(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got,
                                tides_error *error) {
    while (*got < capacity) {
        tides_status status = td_input_fill(&stream->input, RECORD, error);
        if (status != TIDES_OK) return status;
        const unsigned char *p = stream->input.data;
        if (stream->input.ready < RECORD) return stream->input.ready ? td_event_cut_off(stream, error) : TIDES_OK;
        events[(*got)++] = (tides_event){.t = time_us(p) * INT64_C(1000), .x = p[0], .y = p[1], .polarity = p[2] >> 7 ? 1 : -1};
        td_input_skip(&stream->input, RECORD);
    }
    return TIDES_OK;
}

const td_event_format td_format_nmnist = {
    .name = "nmnist",
    .summary = "N-MNIST and N-Caltech101",
    .detect = detect_nmnist,
    .open = open_nmnist,
    .read = read_nmnist,
    .close = td_event_close_state,
};
