/* Image formation in double precision, splat by splat and pixel by pixel. */
#include "tests/oracle/image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Constants of image.rules `smooth` (docs/DESIGN.md 3.1). Splats fade in from depth NEAR to NEAR_FULL [scene units] and from
 * alpha TAPER_BEGIN to TAPER_END. SOFT_DEPTH is relative; DILATION is added to variances [px^2]. */
#define NEAR 0.2
#define NEAR_FULL 0.25
#define ALPHA_MAX 0.99
#define TAPER_BEGIN (0.1 / 255)
#define TAPER_END (1.0 / 255)
#define SOFT_DEPTH 1e-4
#define DILATION 0.3
#define MARGIN 0.3  /* of tan(fov/2): the Jacobian's slopes are clamped so far beyond the border */
#define BEYOND 16.0 /* d^T Q d above which alpha is below TAPER_BEGIN: 2 ln 2550 is 15.7 */
#define FAR 40.0    /* splats further apart don't mix [soft depths]: e^-40 is below rounding */
static const double luminance[3] = {0.2126, 0.7152, 0.0722};

static double smootherstep(double x) {
    const double s = x < 0 ? 0 : x > 1 ? 1 : x;
    return s * s * s * (10 + s * (6 * s - 15));
}

/* -- light of colours (IEC 61966-2-1) ---------------------------------------------------------------------------------- */

#define JOINT 0.04045 /* coded colours below it are linear in light */

static double decoded(double colour) { return colour <= JOINT ? colour / 12.92 : pow((colour + 0.055) / 1.055, 2.4); }

static double coded_of(double light) { return light <= JOINT / 12.92 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055; }

double oracle_share_of(int channel) { return luminance[channel]; }

double oracle_growth(const oracle_scene *s, double shown) {
    if (!s->coded) return 1;
    const double most = coded_of(shown / luminance[2]); /* as if all light were in blue, which counts least */
    return fmax(1 / 12.92, 2.4 / 1.055 * pow((most + 0.055) / 1.055, 1.4));
}

/* -- where things are --------------------------------------------------------------------------------------------------- */

static void rotation_of(const double given[4], double r[9]) {
    double q[4], square = 0;
    for (int k = 0; k < 4; k++) square += given[k] * given[k];
    for (int k = 0; k < 4; k++) q[k] = given[k] / sqrt(square);
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double m[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                         2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    memcpy(r, m, sizeof m);
}

static void pose_at(const oracle_curve *path, double time, double rotation[9], double position[3]) {
    double pose[7] = {0, 0, 0, 1, 0, 0, 0};
    if (path->count > 0) {
        const oracle_place place = oracle_curve_find(path, time);
        oracle_curve_at(path, &place, 0, 7, pose);
    }
    rotation_of(pose + 3, rotation);
    memcpy(position, pose, 3 * sizeof *position);
}

void oracle_look(const oracle_scene *s, double time, oracle_view *view) {
    double eye[9], at[3];
    pose_at(&s->camera, time, eye, at);
    view->time = time;
    for (int k = 0; k < s->objects; k++) {
        oracle_seen *seen = &view->object[k];
        double turn[9], place[3], away[3];
        pose_at(&s->object[k].path, time, turn, place);
        for (int i = 0; i < 3; i++) away[i] = place[i] - at[i];
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++)
                seen->rotation[3 * i + j] = eye[i] * turn[j] + eye[3 + i] * turn[3 + j] + eye[6 + i] * turn[6 + j];
            seen->shift[i] = eye[i] * away[0] + eye[3 + i] * away[1] + eye[6 + i] * away[2];
            seen->eye[i] = -(turn[i] * away[0] + turn[3 + i] * away[1] + turn[6 + i] * away[2]);
        }
        seen->place = oracle_curve_find(&s->object[k].keys, time);
    }
}

double oracle_opacity(double logit) { return 1 / (1 + exp(-logit)); }

void oracle_factor(const oracle_splat *splat, double factor[9]) {
    rotation_of(splat->quaternion, factor);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) factor[3 * i + j] *= exp(splat->log_scale[j]);
}

/* -- colour --------------------------------------------------------------------------------------------------------------- */

static void harmonics(const double d[3], int degree, double basis[ORACLE_SH]) {
    const double x = d[0], y = d[1], z = d[2];
    basis[0] = 0.28209479177387814;
    if (degree < 1) return;
    basis[1] = -0.4886025119029199 * y, basis[2] = 0.4886025119029199 * z, basis[3] = -0.4886025119029199 * x;
    if (degree < 2) return;
    basis[4] = 1.0925484305920792 * x * y, basis[5] = -1.0925484305920792 * y * z;
    basis[6] = 0.31539156525252005 * (2 * z * z - x * x - y * y), basis[7] = -1.0925484305920792 * x * z;
    basis[8] = 0.5462742152960396 * (x * x - y * y);
    if (degree < 3) return;
    basis[9] = -0.5900435899266435 * y * (3 * x * x - y * y), basis[10] = 2.890611442640554 * x * y * z;
    basis[11] = -0.4570457994644658 * y * (4 * z * z - x * x - y * y);
    basis[12] = 0.3731763325901154 * z * (2 * z * z - 3 * x * x - 3 * y * y);
    basis[13] = -0.4570457994644658 * x * (4 * z * z - x * x - y * y);
    basis[14] = 1.445305721320277 * z * (x * x - y * y), basis[15] = -0.5900435899266435 * x * (x * x - 3 * y * y);
}

static void colour_of(const double mean[3], const double (*sh)[3], const double eye[3], int degree, oracle_shown *out) {
    double d[3] = {0, 0, 0}, basis[ORACLE_SH];
    if (degree > 0) {
        for (int k = 0; k < 3; k++) d[k] = mean[k] - eye[k];
        const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        for (int k = 0; k < 3; k++) d[k] /= length;
    }
    harmonics(d, degree, basis);
    for (int c = 0; c < 3; c++) {
        double sum = 0.5;
        for (int k = 0; k < (degree + 1) * (degree + 1); k++) sum += basis[k] * sh[k][c];
        out->raw[c] = sum;
        out->colour[c] = sum > 0 ? sum : 0;
    }
}

/* -- projection ----------------------------------------------------------------------------------------------------------- */

static double within(double x, double low, double high) { return x < low ? low : x > high ? high : x; }

/* Rows of J W M: the Gaussian's factor as the screen sees it. */
static void screen_rows(const oracle_scene *s, const oracle_seen *seen, const double p[3], const double factor[9],
                        double row[2][3]) {
    const double tan_x = 0.5 * s->width / s->focal, tan_y = 0.5 * s->height / s->focal, *r = seen->rotation;
    const double slope[2] = {within(p[0] / p[2], -(1 + MARGIN) * tan_x, (1 + MARGIN) * tan_x),
                             within(p[1] / p[2], -(1 + MARGIN) * tan_y, (1 + MARGIN) * tan_y)};
    for (int i = 0; i < 2; i++) {
        double map[3];
        for (int j = 0; j < 3; j++) map[j] = s->focal / p[2] * (r[3 * i + j] - slope[i] * r[6 + j]);
        for (int j = 0; j < 3; j++) row[i][j] = map[0] * factor[j] + map[1] * factor[3 + j] + map[2] * factor[6 + j];
    }
}

static void spread(const double row[2][3], oracle_shown *out) {
    const double *a = row[0], *b = row[1];
    const double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    const double xx = a[0] * a[0] + a[1] * a[1] + a[2] * a[2], yy = b[0] * b[0] + b[1] * b[1] + b[2] * b[2];
    const double xy = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    /* |a x b|^2 is xx yy - xy^2 without its cancellation for long, thin splats. */
    const double det = n[0] * n[0] + n[1] * n[1] + n[2] * n[2] + DILATION * (xx + yy) + DILATION * DILATION;
    out->xx = (yy + DILATION) / det;
    out->xy = -xy / det;
    out->yy = (xx + DILATION) / det;
    out->across = xx + DILATION;
    out->down = yy + DILATION;
}

/* A Gaussian at the view's time, at rest in its object or by keyframes: `mean` in the object, `p` in the camera's axes. */
typedef struct placed {
    double mean[3], p[3], opacity, moved[9];
    const double *factor;
} placed;

static void place(const oracle_object *o, const oracle_seen *seen, int i, placed *at) {
    const oracle_splat *splat = &o->splat[i];
    const double *r = seen->rotation, *mean = at->mean;
    const int first = i * ORACLE_NUMBERS;
    memcpy(at->mean, splat->mean, sizeof at->mean);
    at->opacity = o->opacity[i];
    at->factor = o->factor[i];
    if (o->moves & ORACLE_MOVES_MEAN) oracle_curve_at(&o->keys, &seen->place, first + ORACLE_MEAN, 3, at->mean);
    if (o->moves & ORACLE_MOVES_OPACITY) {
        double logit;
        oracle_curve_at(&o->keys, &seen->place, first + ORACLE_LOGIT, 1, &logit);
        at->opacity = oracle_opacity(logit);
    }
    if (o->moves & ORACLE_MOVES_SCALE) {
        oracle_splat scaled = *splat;
        oracle_curve_at(&o->keys, &seen->place, first + ORACLE_LOG_SCALE, 3, scaled.log_scale);
        oracle_factor(&scaled, at->moved);
        at->factor = at->moved;
    }
    for (int k = 0; k < 3; k++)
        at->p[k] = r[3 * k] * mean[0] + r[3 * k + 1] * mean[1] + r[3 * k + 2] * mean[2] + seen->shift[k];
}

/* Projects a Gaussian: all of `out` but reach, depth and colours. */
static void shape_of(const oracle_scene *s, const oracle_seen *seen, const placed *at, int id, oracle_shown *out) {
    const double *p = at->p;
    double row[2][3];
    out->id = id;
    out->visible = 0;
    if (!(p[2] > NEAR)) return;
    out->opacity = at->opacity;
    if (p[2] < NEAR_FULL) out->opacity *= smootherstep((p[2] - NEAR) / (NEAR_FULL - NEAR));
    if (!(out->opacity > TAPER_BEGIN)) return;
    out->visible = 1;
    out->u = s->focal * p[0] / p[2] + 0.5 * s->width;
    out->v = s->focal * p[1] / p[2] + 0.5 * s->height;
    screen_rows(s, seen, p, at->factor, row);
    spread((const double(*)[3])row, out);
}

static void look_of(const oracle_scene *s, const oracle_seen *seen, const placed *at, oracle_shown *out) {
    const oracle_object *o = &s->object[s->owner[out->id]];
    const int i = s->own[out->id], entries = 3 * (o->degree + 1) * (o->degree + 1);
    double moved[ORACLE_SH][3];
    out->place = log(at->p[2]) / SOFT_DEPTH;
    if (o->moves & ORACLE_MOVES_SH) {
        oracle_curve_at(&o->keys, &seen->place, i * ORACLE_NUMBERS + ORACLE_COLOUR, entries, moved[0]);
        colour_of(at->mean, (const double(*)[3])moved, seen->eye, o->degree, out);
    } else {
        colour_of(at->mean, (const double(*)[3])o->splat[i].sh, seen->eye, o->degree, out);
    }
}

void oracle_project(const oracle_scene *s, const oracle_view *view, int id, oracle_shown *out) {
    const oracle_seen *seen = &view->object[s->owner[id]];
    placed at;
    place(&s->object[s->owner[id]], seen, s->own[id], &at);
    shape_of(s, seen, &at, id, out);
    if (!out->visible) return;
    const double power = 2 * log(out->opacity / TAPER_BEGIN);
    out->reach_x = sqrt(power * out->across);
    out->reach_y = sqrt(power * out->down);
    look_of(s, seen, &at, out);
}

/* Returns tau at (x, y) [px]; depth and colours of `out` are set only where it isn't 0. */
static double project_to(const oracle_scene *s, const oracle_view *view, int id, double x, double y, oracle_shown *out) {
    const oracle_seen *seen = &view->object[s->owner[id]];
    placed at;
    place(&s->object[s->owner[id]], seen, s->own[id], &at);
    shape_of(s, seen, &at, id, out);
    const double tau = out->visible ? oracle_tau(out, x, y) : 0;
    if (tau > 0) look_of(s, seen, &at, out);
    return tau;
}

double oracle_tau(const oracle_shown *splat, double x, double y) {
    const double dx = x - splat->u, dy = y - splat->v;
    const double q = dx * (splat->xx * dx + 2 * splat->xy * dy) + splat->yy * dy * dy;
    if (!(q < BEYOND)) return 0;
    const double alpha = splat->opacity * exp(-0.5 * q);
    if (!(alpha > TAPER_BEGIN)) return 0;
    const double share = alpha >= TAPER_END ? 1 : smootherstep((alpha - TAPER_BEGIN) / (TAPER_END - TAPER_BEGIN));
    return (alpha < ALPHA_MAX ? alpha : ALPHA_MAX) * share;
}

/* -- light ---------------------------------------------------------------------------------------------------------------- */

void oracle_light_start(oracle_light *l) {
    memset(l, 0, sizeof *l);
    l->left = 1;
}

/* Takes light through the open splats over a distance of x [soft depths]: left_after = left exp(-a (1 - e^-x)), and shown
 * grows by b / a (left - left_after). docs/soft_order.md derives it. */
static void pass(oracle_light *l, double x) {
    if (l->open == 1 && x >= FAR) { /* one splat without others near it: hard order */
        for (int c = 0; c < 3; c++) l->shown[c] += l->left * l->tau * l->colour[c];
        l->left *= 1 - l->tau;
        l->open = 0;
        return;
    }
    if (l->open == 1) {
        l->a = -log1p(-l->tau);
        for (int c = 0; c < 3; c++) l->b[c] = l->a * l->colour[c];
        l->open = 2;
    }
    const double fall = expm1(-x), taken = -l->left * expm1(l->a * fall);
    for (int c = 0; c < 3 && l->a > 0; c++) l->shown[c] += l->b[c] / l->a * taken;
    l->left -= taken;
    l->a *= 1 + fall;
    for (int c = 0; c < 3; c++) l->b[c] *= 1 + fall;
    if (x >= FAR) l->open = 0;
}

void oracle_light_add(oracle_light *l, double place, double tau, const double colour[3]) {
    if (l->open) pass(l, place - l->place);
    l->place = place;
    if (!l->open) {
        l->tau = tau;
        memcpy(l->colour, colour, sizeof l->colour);
        l->open = 1;
        return;
    }
    const double a = -log1p(-tau);
    l->a += a;
    for (int c = 0; c < 3; c++) l->b[c] += a * colour[c];
}

double oracle_light_end(const oracle_scene *s, oracle_light *l) {
    if (l->open) pass(l, 10 * FAR);
    const double behind = s->coded ? coded_of(s->background) : s->background;
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        const double colour = l->shown[c] + l->left * behind;
        sum += luminance[c] * (s->coded ? decoded(colour) : colour);
    }
    return log(sum + s->log_eps);
}

/* -- images --------------------------------------------------------------------------------------------------------------- */

static int nearest_first(const void *a, const void *b) {
    const double x = ((const oracle_shown *)a)->place, y = ((const oracle_shown *)b)->place;
    return (x > y) - (x < y);
}

int oracle_show(const oracle_scene *s, double time, oracle_shown *shown) {
    oracle_view view;
    int count = 0;
    oracle_look(s, time, &view);
    for (int id = 0; id < s->splats; id++) {
        oracle_project(s, &view, id, &shown[count]);
        count += shown[count].visible;
    }
    qsort(shown, (size_t)count, sizeof *shown, nearest_first);
    return count;
}

/* Pixels [first, last] whose centres may lie within `reach` of `middle`. */
static void pixels_within(double middle, double reach, int size, int *first, int *last) {
    *first = (int)floor(within(middle - reach - 1, 0, size));
    *last = (int)ceil(within(middle + reach, -1, size - 1));
}

void oracle_image(const oracle_scene *s, const oracle_shown *shown, int count, oracle_light *lights, double *image) {
    const int pixels = s->width * s->height;
    for (int i = 0; i < pixels; i++) oracle_light_start(&lights[i]);
    for (int k = 0; k < count; k++) {
        int x0, x1, y0, y1;
        pixels_within(shown[k].u, shown[k].reach_x, s->width, &x0, &x1);
        pixels_within(shown[k].v, shown[k].reach_y, s->height, &y0, &y1);
        for (int y = y0; y <= y1; y++)
            for (int x = x0; x <= x1; x++) {
                const double tau = oracle_tau(&shown[k], x + 0.5, y + 0.5);
                if (tau > 0) oracle_light_add(&lights[y * s->width + x], shown[k].place, tau, shown[k].colour);
            }
    }
    for (int i = 0; i < pixels; i++) image[i] = oracle_light_end(s, &lights[i]);
}

typedef struct taker {
    double place, tau, colour[3];
} taker;

double oracle_point(const oracle_scene *s, const int *ids, int count, int x, int y, double time) {
    enum { MOST = 4096 };
    static taker list[MOST];
    oracle_view view;
    oracle_shown shown;
    oracle_light light;
    int n = 0;
    oracle_look(s, time, &view);
    for (int k = 0; k < count; k++) {
        const double tau = project_to(s, &view, ids[k], x + 0.5, y + 0.5, &shown);
        if (!(tau > 0)) continue;
        if (n == MOST) abort();
        int at = n++;
        for (; at > 0 && list[at - 1].place > shown.place; at--) list[at] = list[at - 1];
        list[at] = (taker){shown.place, tau, {shown.colour[0], shown.colour[1], shown.colour[2]}};
    }
    oracle_light_start(&light);
    for (int k = 0; k < n; k++) oracle_light_add(&light, list[k].place, list[k].tau, list[k].colour);
    return oracle_light_end(s, &light);
}
