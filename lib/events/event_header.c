/* The text header of Prophesee's binary files: lines that begin with '%', with the keys that openeb, faery and expelliarmus
 * use. */
#include "td_event_format.h"

#include "td_base.h"

#include <stdlib.h>
#include <string.h>

/* A size from 1 to 65536 px, or 0. */
static int32_t parse_size(const char *text, char **end) {
    long value = strtol(text, end, 10);
    return value >= 1 && value <= 65536 ? (int32_t)value : 0;
}

static void take_word(const char *text, char *out, size_t size) {
    size_t length = strcspn(text, "; \t\r\n");
    if (length >= size) length = size - 1;
    memcpy(out, text, length);
    out[length] = '\0';
}

/* Parses a format line such as "EVT3;height=720;width=1280" or "EVT21;endianness=legacy". */
static void parse_format(const char *text, td_event_header *header) {
    take_word(text, header->format, sizeof header->format);
    const char *height = strstr(text, "height="), *width = strstr(text, "width=");
    char *end;
    if (height) header->height = parse_size(height + strlen("height="), &end);
    if (width) header->width = parse_size(width + strlen("width="), &end);
    header->swapped = strstr(text, "endianness=legacy") != NULL;
}

static void parse_line(const char *line, td_event_header *header) {
    char *end;
    const char *text = line + 1 + strspn(line + 1, " \t");
    if (strncmp(text, "evt ", 4) == 0) take_word(text + 4, header->evt, sizeof header->evt);
    if (strncmp(text, "format ", 7) == 0) parse_format(text + 7, header);
    if (strncmp(text, "Version ", 8) == 0) header->version = parse_size(text + 8, &end);
    if (strncmp(text, "Width ", 6) == 0) header->width = parse_size(text + 6, &end);
    if (strncmp(text, "Height ", 7) == 0) header->height = parse_size(text + 7, &end);
    if (strncmp(text, "geometry ", 9) == 0 && header->width == 0) {
        header->width = parse_size(text + 9, &end);
        header->height = *end == 'x' ? parse_size(end + 1, &end) : 0;
    }
}

/* Parses the header. It ends with "% end", or at the first line that doesn't begin with "% ". Binary data may begin with "%
 * ", too, but then the line isn't printable text, or doesn't end. */
void td_event_header_parse(const char *head, size_t bytes, td_event_header *header) {
    memset(header, 0, sizeof *header);
    while (header->bytes + 2 < bytes && memcmp(head + header->bytes, "% ", 2) == 0) {
        const char *line = head + header->bytes, *stop = memchr(line, '\n', bytes - header->bytes);
        char text[256];
        if (!stop) return;
        size_t length = (size_t)(stop - line);
        snprintf(text, sizeof text, "%.*s", (int)(length < sizeof text ? length : sizeof text - 1), line);
        parse_line(text, header);
        header->bytes += length + 1;
        if (strcmp(text, "% end") == 0 || strcmp(text, "% end\r") == 0) return; /* but not "% endianness" */
    }
}

tides_status td_event_header_read(td_event_stream *stream, td_event_header *header, tides_error *error) {
    tides_status status = td_input_fill(&stream->input, TD_EVENT_BUFFER, error);
    if (status != TIDES_OK) return status;
    td_event_header_parse((const char *)stream->input.data, stream->input.ready, header);
    td_input_skip(&stream->input, header->bytes);
    stream->facts.width = header->width && header->height ? header->width : 0;
    stream->facts.height = header->width && header->height ? header->height : 0;
    return TIDES_OK;
}

/* Writes format and geometry, which openeb needs both and in agreement. The date is fixed, so that equal events give equal
 * bytes. */
void td_event_header_write(td_event_sink *sink, const char *evt, const char *format) {
    char text[512];
    snprintf(text, sizeof text,
             "%% camera_integrator_name TIDES\n%% date 1970-01-01 00:00:00\n%% evt %s\n%% format %s;height=%d;width=%d\n"
             "%% geometry %dx%d\n%% plugin_integrator_name TIDES\n%% end\n",
             evt, format, sink->height, sink->width, sink->width, sink->height);
    td_sink_text(sink, text);
}
