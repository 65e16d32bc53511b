/* Draws events in space and time, in perspective. By default time runs to the right, the image stands across it, and the eye is
 * on the side of the earliest events. */
#include "view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 1200, HEIGHT = 780, TOP = 66, MARGIN_X = 128, MARGIN_Y = 60 /* for ticks and labels */, POINTS_MAX = 400000 };
enum { SHAPES_MAX = 8000 /* for .svg: about 150 kB */ };

/* The box's axes. Lengths are in units of the image's longer side. */
enum { TIME, Y, X, AXES };
#define TIME_EXTENT 1.5  /* over the longer side of the image */
#define EYE_DISTANCE 4.0 /* from the box's centre, over the longer side of the image */

typedef struct scene {
    double half[AXES];
    double right[AXES], down[AXES], forward[AXES]; /* the eye's axes in those of the box */
    double scale, x, y;                            /* to px: the scale, and where the view's axis meets the screen */
} scene;

static double dot(const double a[AXES], const double b[AXES]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* The place on the screen [px]. Returns the distance from the eye along its view. */
static double project(const scene *s, const double point[AXES], double *x, double *y) {
    const double depth = EYE_DISTANCE + dot(point, s->forward);
    *x = s->x + s->scale * dot(point, s->right) / depth;
    *y = s->y + s->scale * dot(point, s->down) / depth;
    return depth;
}

/* Corner number 0 to 7: one bit per axis. */
static void corner(const scene *s, int number, double point[AXES]) {
    for (int axis = 0; axis < AXES; axis++) point[axis] = number >> axis & 1 ? s->half[axis] : -s->half[axis];
}

/* Sets the eye's axes. With x to the right, y down and time away from a viewer, the eye is `azimuth` to the right of the
 * axis of time and `elevation` above it. */
static void set_eye(scene *s, double azimuth_deg, double elevation_deg) {
    const double degree = 3.14159265358979323846 / 180, a = azimuth_deg * degree, e = elevation_deg * degree;
    const double right[AXES] = {sin(a), 0, cos(a)}, flat[AXES] = {cos(a), 0, -sin(a)};
    for (int axis = 0; axis < AXES; axis++) {
        const double downward = axis == Y;
        s->right[axis] = right[axis];
        s->forward[axis] = cos(e) * flat[axis] + sin(e) * downward;
        s->down[axis] = -sin(e) * flat[axis] + cos(e) * downward;
    }
}

/* Centres the projected box, as large as fits. */
static void fit(scene *s, const view_part *within) {
    double low_x = INFINITY, high_x = -INFINITY, low_y = INFINITY, high_y = -INFINITY;
    s->scale = 1;
    s->x = s->y = 0;
    for (int c = 0; c < 8; c++) {
        double point[AXES], x, y;
        corner(s, c, point);
        project(s, point, &x, &y);
        if (x < low_x) low_x = x; /* gcc 12 for arm64 crashes on fmin and fmax here (vect_transform_reduction) */
        if (x > high_x) high_x = x;
        if (y < low_y) low_y = y;
        if (y > high_y) high_y = y;
    }
    const int32_t width = within->right - within->left, height = within->bottom - within->top;
    s->scale = fmin((width - 2 * MARGIN_X) / (high_x - low_x), (height - 2 * MARGIN_Y) / (high_y - low_y));
    s->x = 0.5 * (within->left + within->right) - s->scale * 0.5 * (low_x + high_x);
    s->y = 0.5 * (within->top + within->bottom) - s->scale * 0.5 * (low_y + high_y);
}

static scene make_scene(const view *v, const cli_window *shown, const view_part *within) {
    scene s = {{0.5 * TIME_EXTENT, 0.5, 0.5}, {0}, {0}, {0}, 1, 0, 0};
    if (shown->width >= shown->height)
        s.half[Y] *= (double)shown->height / shown->width;
    else
        s.half[X] *= (double)shown->width / shown->height;
    set_eye(&s, v->azimuth_deg, v->elevation_deg);
    fit(&s, within);
    return s;
}

/* ---- axes ---- */

/* 1 if the eye sees the outside of the box's face at the positive (`end` 1) or negative (`end` 0) end of an axis. */
static int32_t faces_eye(const scene *s, int axis, int end) {
    const double eye = -EYE_DISTANCE * s->forward[axis];
    return end ? eye > s->half[axis] : eye < -s->half[axis];
}

typedef struct range {
    double low, high;
    const char *label;
} range;

static double place(const scene *s, int axis, const range *r, double value) {
    return s->half[axis] * (2 * (value - r->low) / (r->high - r->low) - 1);
}

static void segment(cli_canvas *canvas, const scene *s, const double a[AXES], const double b[AXES], double width,
                    canvas_colour colour) {
    double ax, ay, bx, by;
    project(s, a, &ax, &ay);
    project(s, b, &bx, &by);
    canvas_line(canvas, ax, ay, bx, by, width, colour);
}

static int32_t ticks_of(const scene *s, int axis, const range *r, double ticks[PLOT_TICKS_MAX], int32_t *decimals) {
    enum { ROOM = 90 /* px between labels, on an axis at right angles to the view, at the box's centre */ };
    return plot_linear_ticks(r->low, r->high, (int32_t)(2 * s->half[axis] * s->scale / EYE_DISTANCE), ROOM, ticks, decimals);
}

/* Draws lines at the ticks of `axis`, on the far face at `end` of the axis `across`. */
static void grid_lines(cli_canvas *canvas, const scene *s, int axis, int across, int end, const range *r) {
    double ticks[PLOT_TICKS_MAX], from[AXES], to[AXES];
    int32_t decimals;
    const int along = AXES - axis - across;
    const int32_t count = ticks_of(s, axis, r, ticks, &decimals);
    for (int32_t i = 0; i < count; i++) {
        from[axis] = to[axis] = place(s, axis, r, ticks[i]);
        from[across] = to[across] = end ? s->half[across] : -s->half[across];
        from[along] = -s->half[along];
        to[along] = s->half[along];
        segment(canvas, s, from, to, 1.0, canvas->theme->grid);
    }
}

static void draw_far_faces(cli_canvas *canvas, const scene *s, const range ranges[AXES]) {
    for (int across = 0; across < AXES; across++)
        for (int end = 0; end < 2; end++)
            for (int axis = 0; axis < AXES && !faces_eye(s, across, end); axis++)
                if (axis != across) grid_lines(canvas, s, axis, across, end, &ranges[axis]);
}

/* Draws the box's edges. Edges between two faces that face away from the eye lie behind the events. */
static void draw_edges(cli_canvas *canvas, const scene *s, int32_t behind) {
    for (int axis = 0; axis < AXES; axis++)
        for (int ends = 0; ends < 4; ends++) {
            const int second = (axis + 1) % AXES, third = (axis + 2) % AXES;
            const int32_t hidden = !faces_eye(s, second, ends & 1) && !faces_eye(s, third, ends >> 1);
            if (hidden != behind) continue;
            double from[AXES], to[AXES];
            from[second] = to[second] = ends & 1 ? s->half[second] : -s->half[second];
            from[third] = to[third] = ends >> 1 ? s->half[third] : -s->half[third];
            from[axis] = -s->half[axis];
            to[axis] = s->half[axis];
            segment(canvas, s, from, to, 1.4, canvas->theme->edge);
        }
}

/* Chooses which of an axis' four edges gets the labels: one on the outline, lowest for time and x, leftmost for y. `at` gets
 * its places on the other two axes. */
static int32_t choose_edge(const scene *s, int axis, double at[AXES]) {
    const int second = (axis + 1) % AXES, third = (axis + 2) % AXES;
    double best = -INFINITY;
    for (int ends = 0; ends < 4; ends++) {
        if (faces_eye(s, second, ends & 1) == faces_eye(s, third, ends >> 1)) continue; /* not on the outline */
        double middle[AXES] = {0}, x, y;
        middle[second] = ends & 1 ? s->half[second] : -s->half[second];
        middle[third] = ends >> 1 ? s->half[third] : -s->half[third];
        project(s, middle, &x, &y);
        const double rank = axis == Y ? -x : y;
        if (rank <= best) continue;
        best = rank;
        for (int k = 0; k < AXES; k++) at[k] = middle[k];
    }
    return best > -INFINITY;
}

/* Boxes of the texts so far: two axes meet at a corner, and each may have a label there. */
typedef struct label_boxes {
    double box[3 * (PLOT_TICKS_MAX + 1)][4]; /* left, top, right, bottom */
    int32_t count;
} label_boxes;

static int32_t is_taken(const label_boxes *boxes, const double box[4]) {
    enum { GAP = 4 };
    for (int32_t i = 0; i < boxes->count; i++) {
        const double *other = boxes->box[i];
        if (box[0] < other[2] + GAP && other[0] < box[2] + GAP && box[1] < other[3] && other[1] < box[3]) return 1;
    }
    return 0;
}

/* Draws text whose nearest border is `distance` px from (x, y) along the direction (dx, dy), unless it would overlap another
 * text. */
static void text_beside(cli_canvas *canvas, double x, double y, double dx, double dy, double distance, const char *text,
                        label_boxes *boxes) {
    enum { HALF_HEIGHT = 7 };
    const double half_width = 0.5 * canvas_text_width(text), reach = distance + fabs(dx) * half_width + fabs(dy) * HALF_HEIGHT;
    x += reach * dx, y += reach * dy;
    const double box[4] = {x - half_width, y - HALF_HEIGHT, x + half_width, y + HALF_HEIGHT};
    if (is_taken(boxes, box)) return;
    memcpy(boxes->box[boxes->count++], box, sizeof box);
    canvas_text(canvas, x, y, 0.5, text);
}

/* Draws an axis. Ticks point away from the box, at right angles to their edge on the screen. */
static void draw_axis(cli_canvas *canvas, const scene *s, int axis, const range *r, label_boxes *boxes) {
    double at[AXES], from[AXES], to[AXES], ax, ay, bx, by, cx, cy, ticks[PLOT_TICKS_MAX];
    const double centre[AXES] = {0};
    int32_t decimals;
    if (!choose_edge(s, axis, at)) return;
    for (int k = 0; k < AXES; k++) from[k] = to[k] = at[k];
    from[axis] = -s->half[axis], to[axis] = s->half[axis];
    project(s, from, &ax, &ay), project(s, to, &bx, &by), project(s, centre, &cx, &cy);
    const double length = fmax(hypot(bx - ax, by - ay), 1e-9);
    double dx = -(by - ay) / length, dy = (bx - ax) / length;
    if (dx * (0.5 * (ax + bx) - cx) + dy * (0.5 * (ay + by) - cy) < 0) dx = -dx, dy = -dy;
    const int32_t count = ticks_of(s, axis, r, ticks, &decimals);
    double widest = 0;
    for (int32_t i = 0; i < count; i++) {
        char label[32];
        double x, y;
        at[axis] = place(s, axis, r, ticks[i]);
        project(s, at, &x, &y);
        canvas_line(canvas, x, y, x + 7 * dx, y + 7 * dy, 1.4, canvas->theme->ink);
        snprintf(label, sizeof label, "%.*f", decimals, ticks[i]);
        text_beside(canvas, x, y, dx, dy, 11, label, boxes);
        widest = fmax(widest, fabs(dx) * canvas_text_width(label) + fabs(dy) * 14);
    }
    text_beside(canvas, 0.5 * (ax + bx), 0.5 * (ay + by), dx, dy, 30 + widest, r->label, boxes);
}

/* ---- events ---- */

/* Layers of depth. Events are drawn farthest first, each polarity of a layer at once, smaller and paler with distance. */
enum { PER_DEPTH = 16, LAYERS_MAX = 8 * PER_DEPTH /* depths from 0 to 2 EYE_DISTANCE hold the box */ };

typedef struct layers {
    double *xy;                       /* places of the drawn events on the screen [px], layer by layer, OFF before ON */
    size_t first[2 * LAYERS_MAX + 1]; /* index of the first place of each layer and polarity */
} layers;

/* Every n-th event is drawn, so that a picture takes at most a second. Returns n. */
static size_t stride_of(const view *v, const cli_window *shown) {
    const size_t most = v->points ? v->points : v->style.shapes ? SHAPES_MAX : POINTS_MAX;
    return (shown->count + most - 1) / most + !shown->count;
}

/* The event's place on the screen; returns 2 * layer + (1 for ON), an index of layers.first. */
static size_t project_event(const scene *s, const tides_event *e, const range ranges[AXES], const view_axis *time,
                            double xy[2]) {
    const double values[AXES] = {view_on_axis(time, (double)e->t), e->y + 0.5, e->x + 0.5};
    double at[AXES];
    for (int axis = 0; axis < AXES; axis++) at[axis] = place(s, axis, &ranges[axis], values[axis]);
    const double depth = project(s, at, &xy[0], &xy[1]);
    const double layer = fmin(fmax(LAYERS_MAX - 1 - floor(PER_DEPTH * depth), 0), LAYERS_MAX - 1);
    return 2 * (size_t)layer + (e->polarity > 0);
}

/* A counting sort of events by layer; 0: out of memory. */
static int32_t sort_events(const scene *s, const cli_window *shown, size_t stride, const range ranges[AXES],
                           const view_axis *time, layers *l) {
    size_t next[2 * LAYERS_MAX];
    double xy[2];
    memset(l->first, 0, sizeof l->first);
    l->xy = malloc(2 * (shown->count / stride + 1) * sizeof *l->xy);
    if (!l->xy) return 0;
    for (size_t i = 0; i < shown->count; i += stride) l->first[project_event(s, &shown->events[i], ranges, time, xy) + 1]++;
    for (size_t k = 0; k < 2 * LAYERS_MAX; k++) {
        next[k] = l->first[k];
        l->first[k + 1] += l->first[k];
    }
    for (size_t i = 0; i < shown->count; i += stride) {
        const size_t place_in = next[project_event(s, &shown->events[i], ranges, time, xy)]++;
        memcpy(l->xy + 2 * place_in, xy, sizeof xy);
    }
    return 1;
}

/* Draws the layers; the fewer events, the larger the dots. */
static void draw_layers(cli_canvas *canvas, const layers *l) {
    const size_t count = l->first[2 * LAYERS_MAX];
    const double radius = fmin(4.0, (canvas->style.shapes ? 9.0 : 6.0) * pow((double)count + 1, -0.16));
    for (size_t k = 0; k < 2 * LAYERS_MAX; k++) {
        const size_t layer = k / 2;
        const double depth = (LAYERS_MAX - 0.5 - (double)layer) / PER_DEPTH;
        const double haze = fmin(fmax(0.45 * (depth - EYE_DISTANCE + 1) / 2, 0), 0.6);
        const canvas_colour pure = k % 2 ? canvas->theme->on : canvas->theme->off;
        canvas_dots(canvas, l->xy + 2 * l->first[k], l->first[k + 1] - l->first[k], radius * EYE_DISTANCE / depth,
                    canvas_mix(pure, canvas->theme->paper, haze), 0.85);
    }
}

static void draw_mark(cli_canvas *canvas, const scene *s, const view_mark *mark, const range ranges[AXES],
                      const view_axis *time) {
    const double times[2] = {view_on_axis(time, (double)mark->first_ns), view_on_axis(time, (double)mark->stop_ns)};
    double corners[5][2];
    for (int i = 0; i < 5; i++) {
        const double at[AXES] = {place(s, TIME, &ranges[TIME], times[(i + 1) / 2 % 2]), place(s, Y, &ranges[Y], mark->y + 0.5),
                                 place(s, X, &ranges[X], mark->x + (i / 2 % 2 ? mark->width : 0))};
        project(s, at, &corners[i][0], &corners[i][1]);
    }
    canvas_polyline(canvas, corners[0], 5, 5, canvas->theme->paper);
    canvas_polyline(canvas, corners[0], 5, 2, canvas->theme->ink);
}

int32_t view_draw_xyt(cli_canvas *canvas, const view *v, const cli_window *shown, const view_part *within) {
    const view_axis time = view_time_axis(shown);
    const scene s = make_scene(v, shown, within);
    layers l;
    label_boxes boxes = {.count = 0};
    const range ranges[AXES] = {{view_on_axis(&time, (double)time.first_ns), view_on_axis(&time, (double)time.stop_ns),
                                 time.label},
                                {0, shown->height, "y [px]"},
                                {0, shown->width, "x [px]"}};
    if (!sort_events(&s, shown, stride_of(v, shown), ranges, &time, &l)) return 0;
    draw_far_faces(canvas, &s, ranges);
    draw_edges(canvas, &s, 1);
    draw_layers(canvas, &l);
    if (v->mark) draw_mark(canvas, &s, v->mark, ranges, &time);
    draw_edges(canvas, &s, 0);
    for (int axis = 0; axis < AXES; axis++) draw_axis(canvas, &s, axis, &ranges[axis], &boxes);
    free(l.xy);
    return 1;
}

int32_t view_xyt(const view *v, const cli_window *recording, const cli_window *shown, cli_canvas *canvas) {
    static const view_part within = {0, TOP, WIDTH, HEIGHT};
    (void)recording;
    *canvas = canvas_create(&v->style, WIDTH, HEIGHT);
    if (!view_draw_xyt(canvas, v, shown, &within)) return 0;
    const size_t stride = stride_of(v, shown);
    char title[64] = "events";
    if (stride > 1) snprintf(title, sizeof title, "events (1 of %zu is drawn)", stride);
    view_heading(canvas, 36, shown, title);
    return 1;
}
