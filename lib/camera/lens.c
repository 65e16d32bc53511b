/* Prepares a lens for the kernels: how far out its polynomial is used, bounds on its slopes, and a check that it can be
 * inverted everywhere in the image.
 *
 * Along a radius both lens models are G(s) = s (1 + k1 s^2 + k2 s^4 + k3 s^6 + k4 s^8), with s = tan(theta) for radtan, theta
 * for equidistant. Where G' = 0 the lens folds over. A fold within the image is refused. For a fold beyond the corner, the
 * lens continues along a straight line from half way between the corner and the fold (kernels/lens.h). */
#include "camera/td_lens.h"
#include "camera/td_lens_models.h"
#include "td_math.h"

#include <math.h>
#include <string.h>

/* STEPS: steps of a search along a radius. MAX_PIXELS: most pixels of a side. GRID: parts of a side at whose borders the
 * inversion is checked. */
enum { STEPS = 1024, MAX_PIXELS = 16384, GRID = 32 };

static const double right_angle = 1.57079632679489661923;
/* The polynomial is used up to at most `beyond_corner` times the corner's radius. The straight continuation has at least the
 * slope `least_slope`. */
static const double beyond_corner = 1.25, least_slope = 0.05;
/* Beyond this angle [rad] there is no room for a straight continuation. */
static const double widest = 1.5;
/* Bounds of the tangential part, for coefficients of size |p| at radius r. The slope is at most 7 |p| r, and twice that on the
 * straight continuation, so 14. The size is at most 3 |p| r^2. */
static const double tangential_slope = 14, tangential_size = 3;
/* Largest error of inverting the lens by the kernels' Newton steps [px]. */
static const double undone_px = 1e-6;

/* -- the given numbers -------------------------------------------------------------------------------------------------- */

/* The ranges are those of the run file's keys. Within them no product of the numbers overflows single precision. */
static tides_status check_number(const char *key, double value, double lower, double upper, tides_error *error) {
    if (value >= lower && value <= upper) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT, "camera.%s: %g is out of range; it must lie in [%.10g, %.10g]", key, value, lower,
                   upper);
}

static tides_status check_coefficients(tides_lens lens, tides_error *error) {
    char keys[TD_LENS_WORDS];
    tides_status status = TIDES_OK;
    for (int k = 0; k < TD_COEFFICIENTS_MAX && status == TIDES_OK; k++) {
        const char *key = td_lens_key[k];
        const double value = *td_lens_at(&lens, k);
        status = check_number(key, value, -1e3, 1e3, error);
        if (status == TIDES_OK && !td_lens_has(lens.model, key) && (value < 0 || value > 0))
            status = td_fail(error, TIDES_BAD_ARGUMENT, "camera.%s: %g, but camera.lens is %s, which has %s", key, value,
                             tides_lens_name(lens.model), td_lens_keys(lens.model, keys));
    }
    return status;
}

static tides_status check_camera(const tides_intrinsics *c, tides_error *error) {
    if (c->width < 1 || c->width > MAX_PIXELS || c->height < 1 || c->height > MAX_PIXELS)
        return td_fail(error, TIDES_BAD_ARGUMENT, "camera: %d x %d pixels; width and height must be 1 to %d", (int)c->width,
                       (int)c->height, MAX_PIXELS);
    if (!td_lens_model_of(c->lens.model))
        return td_fail(error, TIDES_BAD_ARGUMENT, "camera.lens: %d is none of TIDES_LENS_*", (int)c->lens.model);
    tides_status status = check_number("fx", c->fx, 1e-3, 1e9, error);
    if (status == TIDES_OK) status = check_number("fy", c->fy, 1e-3, 1e9, error);
    if (status == TIDES_OK) status = check_number("cx", c->cx, -1e6, 1e6, error);
    if (status == TIDES_OK) status = check_number("cy", c->cy, -1e6, 1e6, error);
    return status == TIDES_OK ? check_coefficients(c->lens, error) : status;
}

/* -- along a radius ------------------------------------------------------------------------------------------------ */

/* G(s) and its derivative. */
static double along(const td_lens *lens, double s, double *slope) {
    const td_of_w p = td_lens_polynomial(lens, s * s);
    *slope = p.f + 2 * s * s * p.first;
    return s * p.f;
}

/* G(s) and its derivative, with the straight continuation from s1 on. */
static double along_straight(const td_lens *lens, double s1, double s, double *slope) {
    if (s <= s1) return along(lens, s, slope);
    *slope = lens->straight_slope;
    return lens->straight_slope * s + lens->straight_offset;
}

/* Radius of the image's farthest corner, in distorted normalised coordinates. */
static double corner_of(const td_image *image) {
    double most = 0;
    for (int k = 0; k < 4; k++)
        most = fmax(most, td_hypot(((k & 1 ? image->width : 0) - image->cx) / image->fx,
                                   ((k & 2 ? image->height : 0) - image->cy) / image->fy));
    return most;
}

/* Along a radius: s at the image's corner, and s where the polynomial ends (0: nowhere). */
typedef struct radius {
    double corner, end;
} radius;

static tides_status find_radius(const td_image *image, radius *found, tides_error *error) {
    const td_lens *lens = &image->lens;
    const int angle = image->lens_model == TD_LENS_EQUIDISTANT;
    const double step = (angle ? right_angle : lens->corner) / STEPS, most = angle ? right_angle : 1000 * lens->corner;
    double s = 0, slope = 1, g = 0, px = sqrt(image->fx * image->fy);
    for (int i = 1; g < lens->corner && s < most && slope > 0; i++) g = along(lens, s = fmin(i * step, most), &slope);
    if (!(slope > 0) || (g < lens->corner && !angle))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "camera.lens: %s folds over %.1f px from the principal point, within the image, whose farthest corner "
                       "is "
                       "at %.1f px: its coefficients don't hold out there; take a smaller image, or calibrate to its corners",
                       tides_lens_name(image->lens_model), g * px, lens->corner * px);
    found->corner = s;
    found->end = beyond_corner * s;
    for (int i = 0; i <= STEPS && s < found->end; i++) {
        s = found->corner + (found->end - found->corner) * i / STEPS;
        along(lens, s, &slope);
        if (!(slope > 0)) found->end = 0.5 * (found->corner + s);
    }
    if (angle && found->end > widest) found->end = 0;
    return TIDES_OK;
}

/* -- bounds -------------------------------------------------------------------------------------------------------- */

/* Bounds of the slopes along and across a radius. `outer` is the least slope along it from the corner on. */
typedef struct bounds {
    double most, least, outer;
} bounds;

static bounds bounds_of(const td_image *image, const radius *r) {
    const int angle = image->lens_model == TD_LENS_EQUIDISTANT;
    const double last = angle ? right_angle : r->end, end = r->end > 0 ? r->end : last;
    bounds b = {1, 1, angle ? 0 : image->lens.straight_slope};
    for (int i = 1; i <= STEPS; i++) {
        double s = last * i / STEPS, slope, g = along_straight(&image->lens, end, s, &slope);
        b.most = fmax(b.most, fmax(slope, angle ? g / td_sin(s) : g / s));
        b.least = fmin(b.least, g / s);
        if (s >= r->corner && !angle) b.outer = fmin(b.outer, slope);
    }
    return b;
}

static void set_bounds(td_image *image, const radius *r) {
    td_lens *lens = &image->lens;
    const double tangential = td_hypot(lens->p1, lens->p2);
    const bounds b = bounds_of(image, r);
    if (image->lens_model == TD_LENS_EQUIDISTANT) {
        lens->stretch = lens->sideways = b.most;
        return;
    }
    const double slack = tangential_slope * tangential * r->end;
    const double least = fmax(fmin(b.least, lens->straight_slope) - slack, 0.1 * least_slope);
    const double outer = fmax(b.outer - slack, 1e-9); /* above 0, or nothing would ever count as outside the image */
    double range[4], tilt = 0;
    lens->stretch = fmax(b.most, lens->straight_slope) + slack;
    lens->slope = 1 / least;
    td_camera_range(image, range);
    for (int k = 0; k < 2; k++) {
        const double farthest = 1.3 * fmax(fabs(range[2 * k]), fabs(range[2 * k + 1]));
        tilt += farthest * farthest;
    }
    lens->reach = 2 * lens->stretch * sqrt(1 + tilt) / outer; /* 2: for clamped Jacobians, too, and others */
    lens->tangential = tangential_size * tangential;
}

void td_camera_range(const td_image *image, double range[4]) {
    range[0] = range[2] = INFINITY;
    range[1] = range[3] = -INFINITY;
    for (int i = 0; i <= GRID; i++)
        for (int j = 0; j <= GRID; j++) {
            double a, b;
            td_ray_of(image, image->width * i / (double)GRID, image->height * j / (double)GRID, &a, &b);
            range[0] = fmin(range[0], a), range[1] = fmax(range[1], a);
            range[2] = fmin(range[2], b), range[3] = fmax(range[3], b);
        }
}

/* Checks on a grid that the kernels find exactly one ray for each pixel. Directions of an equidistant lens that aren't in
 * front of the camera are left out. */
static tides_status check_undone(const td_image *image, tides_error *error) {
    for (int i = 0; i <= GRID; i++)
        for (int j = 0; j <= GRID; j++) {
            const double u = image->width * i / (double)GRID, v = image->height * j / (double)GRID;
            double a, b;
            td_ray_of(image, u, v, &a, &b);
            const td_bent bent = td_bend(image, td_still(a), td_still(b));
            const double off = td_hypot(bent.x.v * image->fx + image->cx - u, bent.y.v * image->fy + image->cy - v);
            const double det = bent.xx.v * bent.yy.v - bent.xy.v * bent.yx.v;
            if (image->lens_model == TD_LENS_EQUIDISTANT && td_hypot(a, b) > td_tan(widest)) continue;
            if (!(off < undone_px && det > 0))
                return td_fail(error, TIDES_BAD_ARGUMENT,
                               "camera.lens: %s can't be undone at (%.1f, %.1f) px: its coefficients fold the image over there",
                               tides_lens_name(image->lens_model), u, v);
        }
    return TIDES_OK;
}

tides_status td_camera_resolve(const tides_intrinsics *camera, td_image *image, tides_error *error) {
    tides_status status = check_camera(camera, error);
    if (status != TIDES_OK) return status;
    image->fx = camera->fx, image->fy = camera->fy;
    image->cx = camera->cx, image->cy = camera->cy;
    image->width = camera->width, image->height = camera->height;
    image->lens_model = camera->lens.model;
    memset(&image->lens, 0, sizeof image->lens);
    if (camera->lens.model == TIDES_LENS_NONE) return TIDES_OK;
    td_lens *lens = &image->lens;
    lens->k1 = camera->lens.k1, lens->k2 = camera->lens.k2, lens->k3 = camera->lens.k3, lens->k4 = camera->lens.k4;
    lens->p1 = camera->lens.p1, lens->p2 = camera->lens.p2;
    lens->corner = corner_of(image);
    lens->straight_from = 1e30;
    radius r = {0, 0};
    status = find_radius(image, &r, error);
    if (status != TIDES_OK) return status;
    if (r.end > 0) {
        double slope, g = along(lens, r.end, &slope), floor = least_slope;
        lens->straight_radius = image->lens_model == TD_LENS_EQUIDISTANT ? td_tan(r.end) : r.end;
        lens->straight_from = lens->straight_radius * lens->straight_radius;
        if (image->lens_model == TD_LENS_RADTAN) floor += tangential_slope * td_hypot(lens->p1, lens->p2) * r.end;
        lens->straight_slope = fmax(slope, floor);
        lens->straight_offset = g - lens->straight_slope * r.end;
    }
    set_bounds(image, &r);
    return check_undone(image, error);
}
