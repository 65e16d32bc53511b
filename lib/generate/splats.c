/* Builds Gaussians from surfaces: flat ones within the surface, shaded once by a fixed light. */
#include "generate/td_generate.h"
#include "camera/td_rotation.h"
#include "td_base.h"
#include "td_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define OPACITY_LOGIT 2.944 /* logit of 0.95 */
#define OVERLAP 0.62        /* standard deviation over spacing: smooth, without holes */
#define THICKNESS 0.002     /* [m] standard deviation along the normal */

void td_splats_start(td_splats *splats, tides_error *error) {
    memset(splats, 0, sizeof *splats);
    splats->detail = 1;
    splats->thickness = THICKNESS;
    splats->error = error;
}

void td_splats_free(td_splats *splats) {
    td_gaussians_free(&splats->gaussians);
    splats->capacity = 0;
}

double td_hash(int32_t a, int32_t b, int32_t c) {
    uint32_t h = (uint32_t)a * 0x9e3779b1u ^ (uint32_t)b * 0x85ebca77u ^ (uint32_t)c * 0xc2b2ae3du;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return (double)(h ^ h >> 15) / 4294967296.0;
}

/* Makes room for one more in an array with `width` floats each; all five arrays grow alike. */
static int reserve_one(td_splats *s, float **array, size_t width, size_t *capacity) {
    if (s->status != TIDES_OK) return 0;
    void *memory = *array;
    *capacity = s->capacity;
    s->status = td_reserve(&memory, capacity, (size_t)s->gaussians.count + 1, width * sizeof(float), s->error);
    *array = memory;
    return s->status == TIDES_OK;
}

static int reserve(td_splats *s) {
    td_gaussians *g = &s->gaussians;
    size_t capacity = s->capacity;
    if (!reserve_one(s, &g->mean, 3, &capacity) || !reserve_one(s, &g->log_scale, 3, &capacity) ||
        !reserve_one(s, &g->quaternion, 4, &capacity) || !reserve_one(s, &g->opacity_logit, 1, &capacity) ||
        !reserve_one(s, &g->sh, 3, &capacity))
        return 0;
    s->capacity = capacity;
    return 1;
}

static double normalise(double a[3]) {
    double length = td_length3(a);
    for (int i = 0; i < 3 && length > 0; i++) a[i] /= length;
    return length;
}

/* Quaternion (wxyz) of the rotation with columns u, v, n, computed from the largest of the four squares, so never near 0/0. */
static void quaternion_of(const double u[3], const double v[3], const double n[3], double q[4]) {
    const double squares[4] = {1 + u[0] + v[1] + n[2], 1 + u[0] - v[1] - n[2], 1 - u[0] + v[1] - n[2], 1 - u[0] - v[1] + n[2]};
    int big = 0;
    for (int i = 1; i < 4; i++)
        if (squares[i] > squares[big]) big = i;
    const double s = 2 * sqrt(squares[big]);
    const double wx = (v[2] - n[1]) / s, wy = (n[0] - u[2]) / s, wz = (u[1] - v[0]) / s;
    const double xy = (v[0] + u[1]) / s, xz = (n[0] + u[2]) / s, yz = (n[1] + v[2]) / s;
    const double rows[4][4] = {{s / 4, wx, wy, wz}, {wx, s / 4, xy, xz}, {wy, xy, s / 4, yz}, {wz, xz, yz, s / 4}};
    memcpy(q, rows[big], sizeof rows[big]);
}

/* Factor of a surface's colour: diffuse light from the upper left in front, and ambient light. It is for linear colours. */
static double shade(const double normal[3]) {
    static const double light[3] = {-0.42, 0.60, 0.68};
    double lit = td_dot3(normal, light);
    return 0.45 + 0.55 * (lit > 0 ? lit : 0);
}

void td_splats_add(td_splats *s, const double point[3], const double along[3], const double across[3], const double sigma[3],
                   const double colour[3]) {
    double u[3], v[3], n[3], q[4];
    memcpy(u, along, sizeof u);
    if (normalise(u) <= 0) return;
    td_cross3(u, across, n);
    if (normalise(n) <= 0 || !reserve(s)) return;
    td_cross3(n, u, v);
    quaternion_of(u, v, n, q);
    td_gaussians *g = &s->gaussians;
    const size_t at = (size_t)g->count++;
    for (size_t i = 0; i < 3; i++) {
        g->mean[3 * at + i] = (float)point[i];
        g->log_scale[3 * at + i] = (float)td_ln(sigma[i]);
        g->sh[3 * at + i] = td_splat_dc(shade(n) * td_pow(colour[i], 2.2)); /* sRGB to linear, as a plain power */
    }
    for (size_t i = 0; i < 4; i++) g->quaternion[4 * at + i] = (float)q[i];
    g->opacity_logit[at] = (float)OPACITY_LOGIT;
}

static int32_t finer(int32_t count, double detail) {
    const double wanted = round(count * detail);
    return wanted < 1 ? 1 : (int32_t)wanted;
}

void td_splats_cover(td_splats *splats, td_surface surface, const void *shape, int32_t nu, int32_t nv) {
    nu = finer(nu, splats->detail);
    nv = finer(nv, splats->detail);
    const double du = 1.0 / nu, dv = 1.0 / nv;
    for (int32_t j = 0; j < nv; j++) {
        for (int32_t i = 0; i < nu; i++) {
            const double u = (i + 0.5) * du, v = (j + 0.5) * dv, h = 0.25;
            double point[3], colour[3], ends[4][3], unused[3], along[3], across[3];
            surface(shape, u - h * du, v, ends[0], unused);
            surface(shape, u + h * du, v, ends[1], unused);
            surface(shape, u, v - h * dv, ends[2], unused);
            surface(shape, u, v + h * dv, ends[3], unused);
            surface(shape, u, v, point, colour);
            for (int k = 0; k < 3; k++) {
                along[k] = (ends[1][k] - ends[0][k]) / (2 * h); /* edges of a cell */
                across[k] = (ends[3][k] - ends[2][k]) / (2 * h);
            }
            const double sigma[3] = {fmax(OVERLAP * td_length3(along), splats->thickness),
                                     fmax(OVERLAP * td_length3(across), splats->thickness), splats->thickness};
            td_splats_add(splats, point, along, across, sigma, colour);
        }
    }
}

void td_splats_line(td_splats *splats, const double a[3], const double b[3], int32_t count, double width,
                    const double colour[3]) {
    static const double forward[3] = {0, 0, 1}, up[3] = {0, 1, 0};
    double along[3], across[3], point[3];
    for (int k = 0; k < 3; k++) along[k] = (b[k] - a[k]) / count;
    td_cross3(forward, along, across);
    if (td_dot3(across, across) <= 0) td_cross3(up, along, across); /* a line towards the camera */
    const double sigma[3] = {OVERLAP * td_length3(along), width, fmin(width, splats->thickness)};
    for (int32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) point[k] = a[k] + (i + 0.5) * along[k];
        td_splats_add(splats, point, along, across, sigma, colour);
    }
}

void td_splats_place(td_splats *splats, int64_t first, const double centre[3], double scale) {
    td_gaussians *g = &splats->gaussians;
    for (int64_t i = 3 * first; i < 3 * g->count; i++) {
        g->mean[i] = (float)(centre[i % 3] + scale * g->mean[i]);
        g->log_scale[i] += (float)td_ln(scale);
    }
}

tides_status td_part_add(tides_scene *scene, const td_part *part, const tides_trajectory *path, double scale,
                         tides_error *error) {
    td_splats splats;
    td_splats_start(&splats, error);
    if (part->detail > 0) splats.detail = part->detail;
    if (part->thickness > 0) splats.thickness = part->thickness;
    part->build(&splats, part->shape);
    const tides_gaussians view = td_gaussians_view(&splats.gaussians);
    tides_status status = splats.status;
    if (status == TIDES_OK) status = tides_scene_add(scene, &view, path, scale, part->name, NULL, error);
    td_splats_free(&splats);
    return status;
}

double td_generate_detail(const tides_generate_options *options, int64_t made) {
    return sqrt((double)options->gaussians / (double)made);
}
