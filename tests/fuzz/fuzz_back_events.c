/* Any events within any sensor, in each format that is written. They read back as written, rounded down to the format's tick,
 * or the writer refused them in one line. */
#include "fuzz.h"

#include "tides/events.h"

enum { RECORD = 8, EVENTS_MAX = 2000 };

/* Some formats write silence, 8 kB a second as far as 10^5 or 10^6 s. */
#define SHORT_NS INT64_C(200000000000)

typedef struct list {
    tides_event *events; /* (EVENTS_MAX) */
    size_t count;
} list;

static int in_order(const void *a, const void *b) {
    const tides_event *e = a, *f = b;
    if (e->t != f->t) return e->t < f->t ? -1 : 1;
    if (e->y != f->y) return e->y < f->y ? -1 : 1;
    if (e->x != f->x) return e->x < f->x ? -1 : 1;
    return e->polarity - f->polarity;
}

/* Eight bytes an event: how far from the one before (a number of 16 bits, and by how many bits it is moved up), x, y, and
 * which polarity. */
static void take_events(list *l, const tides_event_file *facts, int64_t longest, const uint8_t *data, size_t size) {
    int64_t t = 0;
    for (; size >= RECORD && l->count < EVENTS_MAX; data += RECORD, size -= RECORD) {
        const int64_t gap = (int64_t)(data[0] | data[1] << 8) << data[2] % 32;
        t += gap;
        if (t > longest) break;
        l->events[l->count++] = (tides_event){.t = t,
                                              .x = (uint16_t)((data[3] | data[4] << 8) % facts->width),
                                              .y = (uint16_t)((data[5] | data[6] << 8) % facts->height),
                                              .polarity = data[7] & 1 ? 1 : -1};
    }
    qsort(l->events, l->count, sizeof *l->events, in_order);
}

/* 0 where the format refuses it. */
static int put(const char *path, const char *format, const tides_event_file *facts, const list *l) {
    tides_event_writer *writer = NULL;
    tides_error error = {TIDES_OK, ""};
    const size_t half = l->count / 2;
    tides_status status = tides_event_writer_open(path, format, facts, &writer, &error);
    if (status == TIDES_OK) status = tides_event_writer_append(writer, l->events, NULL, half, &error);
    if (status == TIDES_OK) status = tides_event_writer_append(writer, l->events + half, NULL, l->count - half, &error);
    if (status == TIDES_OK) {
        status = tides_event_writer_finish(writer, l->count ? l->events[l->count - 1].t : 0, &error);
        writer = NULL;
    }
    tides_event_writer_abandon(writer);
    if (status == TIDES_OK) return 1;
    if (status != TIDES_UNSUPPORTED) abort();
    fuzz_one_line(status, &error);
    return 0;
}

static void look_back(const char *path, const char *format, const tides_event_file *facts, int64_t tick, const list *l) {
    static tides_event read[EVENTS_MAX + 1];
    tides_event_reader *reader = NULL;
    tides_event_facts said;
    tides_error error = {TIDES_OK, ""};
    size_t got = 0;
    if (tides_event_reader_open(path, format, &reader, &error) != TIDES_OK) abort();
    tides_event_reader_facts(reader, &said);
    if (said.width && (said.width != facts->width || said.height != facts->height)) abort();
    for (size_t more = 1; more && got <= l->count; got += more)
        if (tides_event_reader_read(reader, read + got, EVENTS_MAX + 1 - got, &more, &error) != TIDES_OK) abort();
    tides_event_reader_close(reader);
    if (got != l->count) abort();
    for (size_t i = 0; i < got; i++) {
        const tides_event *a = &l->events[i], *b = &read[i];
        if (b->t != a->t - a->t % tick || a->x != b->x || a->y != b->y || a->polarity != b->polarity) abort();
    }
}

/* The first byte chooses the format, the second the sensor; then events. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const int32_t sides[] = {1, 2, 16, 34, 240, 346, 1024, 1280, 2048, 2049, 8192, 16384, 32768, 65536};
    static tides_event events[EVENTS_MAX];
    char path[FUZZ_PATH];
    tides_event_format format;
    size_t formats = 0;
    if (size < 2) return 0;
    while (tides_event_format_at(formats, &format)) formats++;
    tides_event_format_at(data[0] % formats, &format);
    if (!format.writes) return 0;
    const size_t kinds = sizeof sides / sizeof *sides;
    const tides_event_file facts = {.width = sides[data[1] % kinds], .height = sides[data[1] / kinds % kinds]};
    list l = {.events = events};
    const int writes_silence = format.name[0] == 'e'; /* ecf, es, evt: of those that are written */
    take_events(&l, &facts, writes_silence ? SHORT_NS : INT64_MAX / 4, data + 2, size - 2);
    fuzz_empty(fuzz_root());
    if (put(fuzz_path(path, "events"), format.name, &facts, &l)) look_back(path, format.name, &facts, format.tick_ns, &l);
    return 0;
}
