/* Draws the pictures of `tides view`: frames, surfaces, x-y-t, rates, intervals. */
#ifndef CLI_VIEW_H
#define CLI_VIEW_H

#include "plot.h"
#include "session.h"

/* A part of a row of pixels, and an interval of time. */
typedef struct view_mark {
    int32_t x, y, width;
    int64_t first_ns, stop_ns;
} view_mark;

/* How events are drawn; zero: defaults. */
typedef struct view {
    double decay_s;                    /* surface */
    double bin_s;                      /* rate: length of a bin; 0: a 200th of the time shown */
    double azimuth_deg, elevation_deg; /* xyt: the eye's direction, from the axis of time, and above it */
    int32_t scale;                     /* frame, surface: px per pixel; 0: chosen */
    int32_t plain;                     /* frame, surface: 1: only pixels, without axes */
    canvas_style style;
    size_t points;         /* xyt: greatest number of events drawn; 0: chosen */
    const view_mark *mark; /* xyt: is outlined; or NULL */
} view;

/* The eye's direction for x-y-t by default. */
#define VIEW_AZIMUTH_DEG 58.0
#define VIEW_ELEVATION_DEG 18.0

/* Each draws the events of `shown`, a slice of `recording`, on a new canvas, whose size depends only on the sensor's. Surfaces
 * also use events before the slice. Returns 1, or 0: out of memory. The caller frees the canvas in both cases. */
typedef int32_t (*view_drawer)(const view *v, const cli_window *recording, const cli_window *shown, cli_canvas *canvas);
int32_t view_frame(const view *v, const cli_window *recording, const cli_window *shown, cli_canvas *canvas); /* view_image.c */
int32_t view_surface(const view *v, const cli_window *recording, const cli_window *shown,
                     cli_canvas *canvas);   /* view_image.c */
int64_t view_surface_memory(const view *v); /* [ns] time before the slice that surfaces use */
int32_t view_xyt(const view *v, const cli_window *recording, const cli_window *shown, cli_canvas *canvas); /* view_scatter.c */
/* A part of a canvas [px]. _draw_xyt: draws the box of view_xyt with axes and events into it, as large as fits; 0: out of
 * memory. */
typedef struct view_part {
    int32_t left, top, right, bottom;
} view_part;
int32_t view_draw_xyt(cli_canvas *canvas, const view *v, const cli_window *shown, const view_part *within);
int32_t view_rate(const view *v, const cli_window *recording, const cli_window *shown, cli_canvas *canvas); /* view_plots.c */
int32_t view_isi(const view *v, const cli_window *recording, const cli_window *shown, cli_canvas *canvas);  /* view_plots.c */

/* view_text.c: texts that the pictures share. */

/* A unit for printing times: "s", "ms" or "us", and its length in ns. */
typedef struct view_unit {
    const char *name;
    double ns;
} view_unit;
view_unit view_unit_for(int64_t first_ns, int64_t stop_ns);
/* An axis of time, at least a microsecond long. Values count from 0, or from an origin named in the label if they would need
 * too many decimals. */
typedef struct view_axis {
    view_unit unit;
    int64_t origin_ns, first_ns, stop_ns;
    char label[80];
} view_axis;
view_axis view_time_axis(const cli_window *shown);
double view_on_axis(const view_axis *axis, double time_ns); /* value on the axis, in its unit */
/* Writes "140.0 to 160.0 ms", with as many decimals as distinguish the ends. */
void view_interval(const cli_window *shown, char text[96]);
/* Draws the numbers of ON and OFF events with their colours; y is the middle of the line. */
void view_legend(cli_canvas *canvas, double x, double y, const cli_window *shown);
/* Draws "title, 140 to 160 ms" in the first line, and the legend in the second. */
enum { VIEW_LINE_1 = 22, VIEW_LINE_2 = 50 /* [px] their middles */ };
void view_heading(cli_canvas *canvas, double x, const cli_window *shown, const char *title);
/* Writes 1234567 as "1 234 567". */
void view_number(uint64_t number, char text[32]);

#endif
