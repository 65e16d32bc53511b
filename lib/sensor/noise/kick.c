/* The kicks that the readout of a frame gives a row of pixels: their sum at a time, the next one, and bounds over a step. */
#include "td_kick.h"
#include "td_base.h"
#include "td_hash.h"
#include "td_math.h"
#include "td_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Lifetimes after which a kick has gone: e^-40 of it is below the rounding of anything it is added to. */
static const double lifetimes = 40;

/* -- the times of frames --------------------------------------------------------------------------------------------------- */

/* Largest size of a file of times: more is another kind of file. */
static const size_t bytes_most = (size_t)1 << 28;

void td_kick_release(td_kick *kick) {
    free(kick->listed);
    *kick = (td_kick){0};
}

/* Takes the number at the beginning of each line of `text`, which is cut into lines. Frames are in time order. */
static tides_status take_lines(td_kick *kick, char *text, const char *path, tides_error *error) {
    size_t capacity = 0, number = 0;
    double before = -INFINITY;
    for (char *line = text, *next; line; line = next) {
        next = strchr(line, '\n');
        if (next) *next++ = '\0';
        number++;
        line += strspn(line, " \t");
        if (!*line || *line == '#' || *line == '%') continue;
        char *end;
        const double time = strtod(line, &end);
        if (end == line || !strchr(" \t,;", *end) || !(fabs(time) <= 1e10))
            return td_fail(error, TIDES_BAD_FILE, "%s:%zu: a line of sensor.kick_times begins with a frame's time in seconds",
                           path, number);
        if (!(time > before))
            return td_fail(error, TIDES_BAD_FILE, "%s:%zu: %.15g s isn't after the frame before; times must ascend", path,
                           number, time);
        void *list = kick->listed;
        const tides_status status = td_reserve(&list, &capacity, kick->count + 1, sizeof *kick->listed, error);
        kick->listed = list;
        if (status != TIDES_OK) return status;
        kick->listed[kick->count++] = time;
        before = time;
    }
    if (kick->count) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: has no times of frames for sensor.kick_times", path);
}

static tides_status read_times(td_kick *kick, const char *path, tides_error *error) {
    char *text = NULL;
    size_t bytes = 0;
    td_plain_numbers numbers;
    tides_status status = td_read_file(path, bytes_most, &text, &bytes, error);
    if (status == TIDES_OK && strlen(text) != bytes)
        status = td_fail(error, TIDES_BAD_FILE, "%s: isn't text; sensor.kick_times wants a time per line", path);
    if (status == TIDES_OK && (status = td_plain_begin(&numbers, path, error)) == TIDES_OK) {
        td_break_lines(text);
        status = take_lines(kick, text, path, error);
        td_plain_end(&numbers);
    }
    free(text);
    if (status == TIDES_OK) kick->checksum = td_hash_words(1, kick->listed, kick->count * sizeof *kick->listed);
    return status;
}

/* -- parameters ------------------------------------------------------------------------------------------------------------ */

tides_status td_kick_check(const tides_sensor *s, tides_error *error) {
    const struct {
        const char *name;
        double value, least, most;
    } fields[] = {{"kick", s->kick, -10, 10},
                  {"kick_recovery_s", s->kick_recovery_s, 1e-9, 1},
                  {"kick_rate_hz", s->kick_rate_hz, 1e-3, 1e4},
                  {"kick_first_s", s->kick_first_s, -1e10, 1e10},
                  {"kick_row_s", s->kick_row_s, 0, 1},
                  {"kick_reads_s", s->kick_reads_s[0], 0, 1e3},
                  {"kick_reads_s", s->kick_reads_s[1], 0, 1e3}};
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        if (!(fields[i].value >= fields[i].least && fields[i].value <= fields[i].most))
            return td_fail(error, TIDES_BAD_ARGUMENT, "sensor: %s is %g; it must lie in [%g, %g]", fields[i].name,
                           fields[i].value, fields[i].least, fields[i].most);
    return TIDES_OK;
}

static double frame_at(const td_kick *kick, double frame) {
    if (!kick->listed) return frame * kick->period_ns;
    return frame < (double)kick->count ? 1e9 * (kick->listed[(size_t)frame] - kick->start) : INFINITY;
}

static double shortest_period(const td_kick *kick) {
    double least = INFINITY;
    for (size_t k = 1; k < kick->count; k++) least = fmin(least, frame_at(kick, (double)k) - frame_at(kick, (double)(k - 1)));
    return least;
}

tides_status td_kick_make(const tides_sensor *s, double start, td_kick *kick, tides_error *error) {
    *kick = (td_kick){.on = s->kick != 0, .size = s->kick};
    tides_status status = td_kick_check(s, error);
    if (status == TIDES_OK && s->kick_times) status = read_times(kick, s->kick_times, error);
    if (!kick->on) td_kick_release(kick); /* a file that can't be read is refused even where nothing comes of it */
    if (status == TIDES_OK) status = td_kick_begin(kick, s, start, error);
    if (status != TIDES_OK) td_kick_release(kick);
    return status;
}

tides_status td_kick_begin(td_kick *kick, const tides_sensor *s, double start, tides_error *error) {
    kick->start = start;
    kick->recovery_ns = 1e9 * s->kick_recovery_s;
    kick->period_ns = kick->listed ? shortest_period(kick) : 1e9 / s->kick_rate_hz;
    kick->row_ns = 1e9 * s->kick_row_s;
    if (kick->on && kick->recovery_ns > 10 * kick->period_ns)
        return td_fail(error, TIDES_BAD_ARGUMENT, "sensor: kick_recovery_s is %g, more than ten frames %s", s->kick_recovery_s,
                       kick->listed ? "where those of kick_times are nearest" : "at kick_rate_hz");
    const double first_ns = kick->listed ? 0 : 1e9 * (s->kick_first_s - start);
    for (int r = 0; r < 2; r++) kick->read_ns[r] = first_ns + 1e9 * s->kick_reads_s[r];
    kick->reads = s->kick_reads_s[0] == s->kick_reads_s[1] ? 1 : 2;
    kick->most = fabs(kick->size) * kick->reads / -td_expm1(-(kick->period_ns - 1) / kick->recovery_ns); /* - 1: rounding */
    return TIDES_OK;
}

/* -- reads ----------------------------------------------------------------------------------------------------------------- */

/* Time of a read [ns], at half a nanosecond. Steps may begin and end at reads, at whole nanoseconds. Rounding must not put a
 * read on one side of such an end in one step, and on the other in the next. */
static double read_at(const td_kick *kick, int r, int32_t y, double frame) {
    return floor(kick->read_ns[r] + frame_at(kick, frame) + y * kick->row_ns) + 0.5;
}

/* The number of the first frame whose read r of row y is at or after `time`, at least 0. */
static double frame_from(const td_kick *kick, int r, int32_t y, double time) {
    const double from = fmax(time, 0);
    if (kick->listed) {
        size_t low = 0, high = kick->count;
        while (low < high) {
            const size_t middle = low + (high - low) / 2;
            if (read_at(kick, r, y, (double)middle) < from)
                low = middle + 1;
            else
                high = middle;
        }
        return (double)low;
    }
    double frame = fmax(ceil((from - read_at(kick, r, y, 0)) / kick->period_ns), 0);
    while (frame > 0 && read_at(kick, r, y, frame - 1) >= from) frame--; /* mends the rounding of the division */
    while (read_at(kick, r, y, frame) < from) frame++;
    return frame;
}

double td_kick_at(const td_kick *kick, int32_t y, double time) {
    double sum = 0;
    for (int r = 0; r < kick->reads; r++)
        for (double frame = frame_from(kick, r, y, time) - 1; frame >= 0; frame--) {
            const double read = read_at(kick, r, y, frame), age = (time - read) / kick->recovery_ns;
            if (read < 0 || age > lifetimes) break;
            sum += td_exp(-age);
        }
    return kick->size * sum;
}

double td_kick_next(const td_kick *kick, int32_t y, double time) {
    double next = INFINITY;
    for (int r = 0; r < kick->reads; r++) next = fmin(next, read_at(kick, r, y, frame_from(kick, r, y, time)));
    return next;
}

/* Between reads K decays to 0. Its extremes are just before and after reads, and at the interval's ends. */
void td_kick_bounds(const td_kick *kick, int32_t y, double from, double to, double *low, double *high) {
    double K = td_kick_at(kick, y, from), at = from;
    *low = *high = K;
    for (double read = td_kick_next(kick, y, from); read <= to; read = td_kick_next(kick, y, nextafter(read, INFINITY))) {
        K *= td_exp(-(read - at) / kick->recovery_ns);
        *low = fmin(*low, fmin(K, K + kick->size));
        *high = fmax(*high, fmax(K, K + kick->size));
        K += kick->size;
        at = read;
    }
    K *= td_exp(-(to - at) / kick->recovery_ns);
    *low = fmin(*low, K) - 1e-14 * kick->most;
    *high = fmax(*high, K) + 1e-14 * kick->most;
}
