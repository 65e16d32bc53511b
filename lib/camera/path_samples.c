/* The list of samples that a path reader collects: appends, computes times relative to the first, sorts by time. */
#include "camera/td_path_reader.h"

#include <stdlib.h>
#include <string.h>

td_path_sample *td_path_append(td_path_reader *reader, size_t place) {
    void *samples = reader->samples;
    size_t needed = reader->count < 64 ? 64 : reader->count + 1;
    if (td_reserve(&samples, &reader->capacity, needed, sizeof *reader->samples, reader->error) != TIDES_OK) return NULL;
    reader->samples = samples;
    td_path_sample *sample = reader->samples + reader->count++;
    memset(sample, 0, sizeof *sample);
    sample->place = place;
    return sample;
}

double td_path_since(const td_path_sample *sample, const td_path_sample *origin) {
    return (sample->time - origin->time) + (sample->low - origin->low);
}

td_path_sample td_path_origin(const td_path_reader *reader, const td_path_sample *first) {
    td_path_sample given = {.time = reader->options->start};
    return reader->options->rebase ? *first : given;
}

void td_path_spread(td_path_reader *reader) { reader->spread = 1; }

static int by_time(const void *left, const void *right) {
    const td_path_sample *a = left, *b = right;
    if (a->time != b->time) return a->time < b->time ? -1 : 1;
    return a->place < b->place ? -1 : a->place > b->place;
}

void td_path_sort(td_path_reader *reader) {
    if (reader->count > 0) qsort(reader->samples, reader->count, sizeof *reader->samples, by_time);
}
