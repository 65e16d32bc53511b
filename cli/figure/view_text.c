/* Text on the pictures of `tides view`: intervals and axes of time, numbers, headings, and the legend of ON and OFF. */
#include "view.h"

#include <math.h>
#include <stdio.h>

view_unit view_unit_for(int64_t first_ns, int64_t stop_ns) {
    const double largest = fmax(fabs((double)first_ns), fabs((double)stop_ns));
    if (largest >= 1e9) return (view_unit){"s", 1e9};
    return largest >= 1e6 ? (view_unit){"ms", 1e6} : (view_unit){"us", 1e3};
}

/* The number of decimals that times in `unit` need so that a difference of `least_ns` shows. Differences below a nanosecond get
 * the decimals of a nanosecond. */
static int decimals_for(const view_unit *unit, double least_ns) {
    const double digits = ceil(log10(unit->ns) - log10(fmax(least_ns, 1)) - 1e-9);
    return digits > 0 ? (int)digits : 0;
}

void view_interval(const cli_window *shown, char text[96]) {
    const view_unit unit = view_unit_for(shown->first_ns, shown->stop_ns);
    const double first = (double)shown->first_ns, stop = (double)shown->stop_ns;
    const int decimals = stop > first ? decimals_for(&unit, pow(10, floor(log10(stop - first)) - 2)) : 3;
    if (stop > first)
        snprintf(text, 96, "%.*f to %.*f %s", decimals, first / unit.ns, decimals, stop / unit.ns, unit.name);
    else
        snprintf(text, 96, "at %.*f %s", decimals, first / unit.ns, unit.name);
}

view_axis view_time_axis(const cli_window *shown) {
    enum { LEAST_NS = 1000, ENOUGH = 20 /* spans: farther from 0, three digits no longer tell ticks apart */ };
    view_axis axis = {.first_ns = shown->first_ns, .stop_ns = shown->stop_ns};
    if (axis.stop_ns < axis.first_ns + LEAST_NS) axis.stop_ns = axis.first_ns + LEAST_NS;
    const double span = (double)(axis.stop_ns - axis.first_ns),
                 far = fmax(fabs((double)axis.first_ns), fabs((double)axis.stop_ns));
    if (far <= ENOUGH * span) {
        axis.unit = view_unit_for(axis.first_ns, axis.stop_ns);
        snprintf(axis.label, sizeof axis.label, "time [%s]", axis.unit.name);
        return axis;
    }
    const int64_t round = (int64_t)pow(10, floor(log10(span)));
    const view_unit unit = view_unit_for(axis.first_ns, axis.first_ns);
    axis.origin_ns = axis.first_ns / round * round;
    if (axis.origin_ns > axis.first_ns) axis.origin_ns -= round; /* C rounds a negative quotient up */
    axis.unit = view_unit_for(0, axis.stop_ns - axis.origin_ns);
    snprintf(axis.label, sizeof axis.label, "time after %.*f %s [%s]", decimals_for(&unit, (double)round),
             (double)axis.origin_ns / unit.ns, unit.name, axis.unit.name);
    return axis;
}

double view_on_axis(const view_axis *axis, double time_ns) { return (time_ns - (double)axis->origin_ns) / axis->unit.ns; }

void view_number(uint64_t number, char text[32]) {
    char digits[24];
    const int length = snprintf(digits, sizeof digits, "%llu", (unsigned long long)number);
    int at = 0;
    for (int i = 0; i < length; i++) {
        if (i && (length - i) % 3 == 0) text[at++] = ' ';
        text[at++] = digits[i];
    }
    text[at] = '\0';
}

static double legend_entry(cli_canvas *canvas, double x, double y, canvas_colour colour, const char *name, uint64_t events) {
    enum { SWATCH = 14, BESIDE = 8, APART = 28 /* [px] */ };
    char number[32], text[64];
    view_number(events, number);
    snprintf(text, sizeof text, "%s %s", name, number);
    canvas_fill(canvas, x, y - 0.5 * SWATCH, x + SWATCH, y + 0.5 * SWATCH, colour);
    canvas_text(canvas, x + SWATCH + BESIDE, y, 0, text);
    return x + SWATCH + BESIDE + canvas_text_width(text) + APART;
}

void view_legend(cli_canvas *canvas, double x, double y, const cli_window *shown) {
    uint64_t on = 0;
    for (size_t i = 0; i < shown->count; i++) on += shown->events[i].polarity > 0;
    x = legend_entry(canvas, x, y, canvas->theme->on, "ON", on);
    legend_entry(canvas, x, y, canvas->theme->off, "OFF", shown->count - on);
}

void view_heading(cli_canvas *canvas, double x, const cli_window *shown, const char *title) {
    char interval[96], line[160];
    view_interval(shown, interval);
    snprintf(line, sizeof line, "%s, %s", title, interval);
    canvas_title(canvas, x, VIEW_LINE_1, 0, line);
    view_legend(canvas, x, VIEW_LINE_2, shown);
}
