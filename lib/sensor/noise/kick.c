/* The kicks that the readout of a frame gives a row of pixels: their sum at a time, the next one, and bounds over a step. */
#include "td_kick.h"
#include "td_base.h"
#include "td_math.h"

#include <math.h>

/* Lifetimes after which a kick has gone: e^-40 of it is below the rounding of anything it is added to. */
static const double lifetimes = 40;

tides_status td_kick_make(const tides_sensor *s, double start, td_kick *kick, tides_error *error) {
    *kick = (td_kick){.on = s->kick != 0};
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
    if (kick->on && s->kick_recovery_s * s->kick_rate_hz > 10)
        return td_fail(error, TIDES_BAD_ARGUMENT, "sensor: kick_recovery_s is %g, more than ten frames at kick_rate_hz",
                       s->kick_recovery_s);
    kick->size = s->kick;
    kick->recovery_ns = 1e9 * s->kick_recovery_s;
    kick->period_ns = 1e9 / s->kick_rate_hz;
    kick->row_ns = 1e9 * s->kick_row_s;
    for (int r = 0; r < 2; r++) kick->read_ns[r] = 1e9 * (s->kick_first_s - start) + 1e9 * s->kick_reads_s[r];
    kick->reads = s->kick_reads_s[0] == s->kick_reads_s[1] ? 1 : 2;
    kick->most = fabs(kick->size) * kick->reads / -td_expm1(-(kick->period_ns - 1) / kick->recovery_ns); /* - 1: rounding */
    return TIDES_OK;
}

/* Time of a read [ns], at half a nanosecond. Steps may begin and end at reads, at whole nanoseconds. Rounding must not put a
 * read on one side of such an end in one step, and on the other in the next. */
static double read_at(const td_kick *kick, int r, int32_t y, double frame) {
    return floor(kick->read_ns[r] + frame * kick->period_ns + y * kick->row_ns) + 0.5;
}

/* The number of the first frame whose read r of row y is at or after `time`, at least 0. */
static double frame_from(const td_kick *kick, int r, int32_t y, double time) {
    const double from = fmax(time, 0);
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
