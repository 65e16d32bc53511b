/* When frames were taken: a text file, a rate, or what the array file says. */
#include "td_frames.h"

#include "td_folder.h"
#include "td_kinds.h"
#include "td_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A page of text per thousand frames; more than this is another kind of file. */
#define TIMES_BYTES_MAX ((size_t)1 << 28)

double td_frame_unit(const tides_frames_options *options, const char *file) {
    static const double seconds[] =
        {[TIDES_TIME_S] = 1, [TIDES_TIME_MS] = 1e-3, [TIDES_TIME_US] = 1e-6, [TIDES_TIME_NS] = 1e-9};
    if (options->unit != TIDES_TIME_AUTO) return seconds[options->unit];
    return strstr(file, "image_timestamps") ? 1e-6 : 1.0;
}

/* A number divided by a power of ten where it is whole: 1e-6 itself isn't a double, 1e6 is. */
static double in_seconds(double value, double unit) { return unit < 1 ? value / round(1 / unit) : value; }

/* The number of one line: alone, or beside a name (ECD's "time name", DVS-Voltmeter's "name time"). */
static int read_line(char *line, double *value) {
    char *rest = NULL;
    for (char *word = strtok_r(line, " \t\r,;", &rest); word; word = strtok_r(NULL, " \t\r,;", &rest)) {
        char *end = NULL;
        *value = strtod(word, &end);
        if (end != word && !*end && isfinite(*value)) return 1;
    }
    return 0;
}

static tides_status read_lines(tides_frames *frames, const char *file, char *text, tides_error *error) {
    double unit = td_frame_unit(&frames->options, file);
    size_t count = 0, number = 0;
    for (char *line = text; line;) {
        char *end = strchr(line, '\n');
        if (end) *end = '\0';
        number++;
        size_t blank = strspn(line, " \t\r");
        double value = 0;
        if (line[blank] && line[blank] != '#') {
            if (!read_line(line, &value))
                return td_fail(error, TIDES_BAD_FILE, "%s:%zu: there is no time in this line; write one number per line", file,
                               number);
            if (count < frames->count) frames->times[count] = in_seconds(value, unit);
            count++;
        }
        line = end ? end + 1 : NULL;
    }
    if (count == frames->count) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: has %zu times, but %s has %zu frames", file, count, frames->path, frames->count);
}

static tides_status read_file(tides_frames *frames, const char *file, tides_error *error) {
    char *text = NULL;
    size_t bytes = 0;
    tides_status status = td_read_file(file, TIMES_BYTES_MAX, &text, &bytes, error);
    if (status != TIDES_OK) return status;
    td_plain_numbers numbers;
    status = td_plain_begin(&numbers, file, error);
    if (status == TIDES_OK) {
        status = td_kind_judge(file, TD_WANTS_TEXT, read_lines(frames, file, text, error), error);
        td_plain_end(&numbers);
    }
    free(text);
    return status;
}

/* A timestamp file in the folder, or beside the folder or file; NULL where there is none. */
static char *find_file(const char *path, tides_error *error, tides_status *status) {
    static const char *const names[] = {"timestamps.txt", "image_timestamps.txt", "../timestamps.txt",
                                        "../image_timestamps.txt"};
    const int folder = td_is_folder(path);
    *status = TIDES_OK;
    for (size_t i = 0; i < (folder ? 4u : 2u); i++) {
        char *file = folder ? td_format(error, "%s/%s", path, names[i]) : td_beside(path, names[i], error);
        if (!file) {
            *status = TIDES_NO_MEMORY;
            return NULL;
        }
        if (td_is_file(file)) return file;
        free(file);
    }
    return NULL;
}

static tides_status fill(tides_frames *frames, tides_error *error) {
    const tides_frames_options *o = &frames->options;
    const int own = frames->times != NULL;
    if (!own && !(frames->times = td_alloc(frames->count, sizeof *frames->times, error))) return TIDES_NO_MEMORY;
    if (o->timestamps) return read_file(frames, o->timestamps, error);
    if (o->frames_per_second > 0) {
        for (size_t k = 0; k < frames->count; k++) frames->times[k] = (double)k / o->frames_per_second;
        return TIDES_OK;
    }
    if (own) return TIDES_OK;
    tides_status status;
    char *file = find_file(frames->path, error, &status);
    if (status != TIDES_OK) return status;
    status = file ? read_file(frames, file, error)
                  : td_fail(error, TIDES_BAD_CONFIG,
                            "%s: its frames have no times: give frames.timestamps or frames.frames_per_second, or put a "
                            "timestamps.txt there",
                            frames->path);
    free(file);
    return status;
}

tides_status td_frames_times(tides_frames *frames, tides_error *error) {
    tides_status status = fill(frames, error);
    if (status != TIDES_OK) return status;
    const double first = frames->options.rebase ? frames->times[0] : 0;
    for (size_t k = 0; k < frames->count; k++) {
        if (!isfinite(frames->times[k]) || (k > 0 && !(frames->times[k] - first > frames->times[k - 1])))
            return td_fail(error, TIDES_BAD_FILE, "%s: frame %zu is at %.15g s, which isn't after the one before", frames->path,
                           k, frames->times[k]);
        frames->times[k] -= first;
    }
    return TIDES_OK;
}
