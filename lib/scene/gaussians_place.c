/* Moves Gaussians by an affine map, and joins several sets. Some formats hold a scene in pieces, each with a map (glTF's
 * nodes, streamed SOG's chunks). */
#include "camera/td_rotation.h"
#include "td_base.h"
#include "td_math.h"
#include "td_scene.h"

#include <math.h>
#include <string.h>

/* -- spherical harmonics ------------------------------------------------------------------------------------------------- */

/* MOST: coefficients of all bands. NODES and TURNS: points of an integral over the sphere, along z and around it. */
enum { BANDS = TIDES_SH_DEGREE_MAX + 1, MOST = BANDS * BANDS, NODES = 5, TURNS = 9 };

/* Values of band l of the spherical harmonics (SH) in the unit direction d, for m from -l to l. The basis is that of INRIA's
 * 3DGS: real, with the Condon-Shortley phase. */
static void band(const double d[3], int l, double *y) {
    /* cosine, sine: of m times the azimuth, both times sin(polar angle)^m. start: Legendre's P_mm without this power */
    double cosine = 1, sine = 0, start = 1;
    for (int m = 0; m <= l; m++) {
        double factor = (2 * l + 1) / (4 * TD_PI), before = 0, p = start;
        for (int k = l - m + 1; k <= l + m; k++) factor /= k;
        for (int k = m + 1; k <= l; k++) {
            const double next = ((2 * k - 1) * d[2] * p - (k + m - 1) * before) / (k - m);
            before = p;
            p = next;
        }
        const double value = (m % 2 ? -1 : 1) * sqrt(factor * (m ? 2 : 1)) * p, turned = cosine * d[0] - sine * d[1];
        y[l + m] = value * cosine;
        if (m) y[l - m] = value * sine;
        sine = cosine * d[1] + sine * d[0];
        cosine = turned;
        start *= 2 * m + 1;
    }
}

/* Matrix that rotates band l's coefficients by R (row-major): D[j][k] is the integral of Y_j(u) Y_k(R^T u) over the sphere.
 * The integral is a sum over NODES Gauss-Legendre nodes along z, times TURNS equal steps around z. The sum is exact for
 * products of two bands up to 4. */
static void band_rotation(const double r[9], int l, double *matrix) {
    static const double at[NODES] = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831, 0.9061798459386640};
    static const double weight[NODES] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                                         0.2369268850561891};
    const int width = 2 * l + 1;
    double here[2 * BANDS], there[2 * BANDS];
    memset(matrix, 0, (size_t)(width * width) * sizeof *matrix);
    for (int i = 0; i < NODES * TURNS; i++) {
        const double z = at[i / TURNS], around = 2 * TD_PI * (i % TURNS) / TURNS, off = sqrt(1 - z * z);
        const double u[3] = {off * td_cos(around), off * td_sin(around), z};
        double back[3];
        for (int k = 0; k < 3; k++) back[k] = r[k] * u[0] + r[3 + k] * u[1] + r[6 + k] * u[2];
        band(u, l, here);
        band(back, l, there);
        for (int j = 0; j < width; j++)
            for (int k = 0; k < width; k++)
                matrix[width * j + k] += weight[i / TURNS] * (2 * TD_PI / TURNS) * here[j] * there[k];
    }
    for (int i = 0; i < width * width; i++) { /* under half turns about an axis all entries are 0, 1 or -1: make them exact */
        const double whole = floor(matrix[i] + 0.5);
        if (fabs(matrix[i] - whole) < 1e-13) matrix[i] = whole;
    }
}

static void turn_harmonics(const td_gaussians *g, const double r[9]) {
    const size_t coefficients = td_sh_coefficients(g->sh_degree);
    for (int l = 1; l <= g->sh_degree; l++) {
        const int width = 2 * l + 1;
        double matrix[(2 * BANDS - 1) * (2 * BANDS - 1)], old[2 * BANDS];
        band_rotation(r, l, matrix);
        for (int64_t i = 0; i < 3 * g->count; i++) {
            float *sh = g->sh + 3 * (coefficients * (size_t)(i / 3) + (size_t)(l * l)) + i % 3;
            for (int k = 0; k < width; k++) old[k] = (double)sh[3 * k];
            for (int j = 0; j < width; j++) {
                double sum = 0;
                for (int k = 0; k < width; k++) sum += matrix[width * j + k] * old[k];
                sh[3 * j] = td_narrow(sum);
            }
        }
    }
}

/* -- shapes -------------------------------------------------------------------------------------------------------------- */

/* Rotates columns a and b of `m` within their plane until they are orthogonal. Returns 0 if they already were. */
static int straighten_pair(double m[9], int a, int b) {
    double aa = 0, bb = 0, ab = 0;
    for (int k = 0; k < 9; k += 3) {
        aa += m[k + a] * m[k + a];
        bb += m[k + b] * m[k + b];
        ab += m[k + a] * m[k + b];
    }
    if (!(fabs(ab) > 1e-15 * sqrt(aa * bb))) return 0;
    const double zeta = (bb - aa) / (2 * ab), t = (zeta < 0 ? -1 : 1) / (fabs(zeta) + sqrt(1 + zeta * zeta));
    const double c = 1 / sqrt(1 + t * t), s = c * t;
    for (int k = 0; k < 9; k += 3) {
        const double old = m[k + a];
        m[k + a] = c * old - s * m[k + b];
        m[k + b] = s * old + c * m[k + b];
    }
    return 1;
}

/* Finds the orthogonal axes of the ellipsoid m m^T, by Hestenes's one-sided Jacobi method. The columns of `m` are a Gaussian's
 * axes after a map that scales one axis more than another, so they aren't orthogonal any more. */
static void shape_of(double m[9], float *log_scale, float *quaternion) {
    enum { SWEEPS = 30 }; /* for 3x3, four to six are enough */
    double r[9], q[4], length[3];
    for (int sweep = 0, turned = 1; sweep < SWEEPS && turned; sweep++)
        turned = straighten_pair(m, 0, 1) + straighten_pair(m, 0, 2) + straighten_pair(m, 1, 2);
    for (int c = 0; c < 3; c++) {
        length[c] = sqrt(m[c] * m[c] + m[3 + c] * m[3 + c] + m[6 + c] * m[6 + c]);
        for (int k = 0; k < 9; k += 3) r[k + c] = m[k + c] / length[c];
        log_scale[c] = (float)td_ln(length[c]);
    }
    const double third[3] = {r[3] * r[7] - r[6] * r[4], r[6] * r[1] - r[0] * r[7], r[0] * r[4] - r[3] * r[1]};
    for (int k = 0; k < 3; k++) r[3 * k + 2] = third[k]; /* makes r a rotation; an ellipsoid's axis has no sign */
    td_quaternion_from_rotation(r, q);
    for (int k = 0; k < 4; k++) quaternion[k] = (float)q[k];
}

static void stretch(const td_gaussians *g, int64_t i, const double linear[9]) {
    double q[4], r[9], m[9];
    for (int k = 0; k < 4; k++) q[k] = (double)g->quaternion[4 * i + k];
    if (!td_normalise_quaternion(q)) return; /* an invalid quaternion is refused when the scene takes the Gaussians */
    td_rotation_from_quaternion(q, r);
    for (int row = 0; row < 3; row++)
        for (int c = 0; c < 3; c++) {
            const double *a = linear + 3 * row;
            m[3 * row + c] = (a[0] * r[c] + a[1] * r[3 + c] + a[2] * r[6 + c]) * td_exp((double)g->log_scale[3 * i + c]);
        }
    shape_of(m, g->log_scale + 3 * i, g->quaternion + 4 * i);
}

static int is_identity(const double map[12]) {
    int same = 1;
    for (int i = 0; i < 12; i++) same &= map[i] == (i % 5 == 0); /* false for NaN, which the scene refuses */
    return same;
}

tides_status td_gaussians_place(td_gaussians *g, const double map[12], tides_error *error) {
    double linear[9], turn[9], size[3], q[4];
    if (is_identity(map)) return TIDES_OK;
    for (int c = 0; c < 3; c++) {
        size[c] = sqrt(map[c] * map[c] + map[4 + c] * map[4 + c] + map[8 + c] * map[8 + c]);
        for (int row = 0; row < 3; row++) turn[3 * row + c] = (linear[3 * row + c] = map[4 * row + c]) / size[c];
    }
    td_quaternion_from_rotation(turn, q);
    const int moved = map[3] < 0 || map[3] > 0 || map[7] < 0 || map[7] > 0 || map[11] < 0 || map[11] > 0;
    tides_status status = moved ? td_gaussians_widen(g, error) : TIDES_OK; /* far from 0, single precision is too coarse */
    if (status) return status;
    const double least = fmin(fmin(size[0], size[1]), size[2]), most = fmax(fmax(size[0], size[1]), size[2]);
    const int even = most <= least * (1 + 1e-6);
    const float larger = fabs(size[0] - 1) < 1e-12 ? 0 : (float)td_ln(size[0]);
    for (int64_t i = 0; i < g->count; i++) {
        const double p[3] = {td_gaussians_mean(g, i, 0), td_gaussians_mean(g, i, 1), td_gaussians_mean(g, i, 2)};
        for (int k = 0; k < 3; k++) {
            const double *a = map + 4 * k;
            td_gaussians_put_mean(g, (size_t)i, (size_t)k, a[0] * p[0] + a[1] * p[1] + a[2] * p[2] + a[3]);
        }
        if (!even) {
            stretch(g, i, linear);
            continue;
        }
        float *own = g->quaternion + 4 * i;
        double turned[4] = {(double)own[0], (double)own[1], (double)own[2], (double)own[3]};
        td_quaternion_product(q, turned, turned);
        for (int k = 0; k < 4; k++) own[k] = (float)turned[k];
        for (int k = 0; k < 3; k++) g->log_scale[3 * i + k] += larger;
    }
    turn_harmonics(g, turn);
    return TIDES_OK;
}

/* -- several sets -------------------------------------------------------------------------------------------------------- */

/* Copies `from` behind the first `at` Gaussians of `to`. */
static void append(const td_gaussians *to, size_t at, const td_gaussians *from) {
    const size_t n = (size_t)from->count, wide = 3 * td_sh_coefficients(to->sh_degree);
    const size_t narrow = 3 * td_sh_coefficients(from->sh_degree);
    memcpy(to->mean + 3 * at, from->mean, 3 * n * sizeof(float));
    memcpy(to->log_scale + 3 * at, from->log_scale, 3 * n * sizeof(float));
    memcpy(to->quaternion + 4 * at, from->quaternion, 4 * n * sizeof(float));
    memcpy(to->opacity_logit + at, from->opacity_logit, n * sizeof(float));
    for (size_t i = 0; i < n; i++) memcpy(to->sh + wide * (at + i), from->sh + narrow * i, narrow * sizeof(float));
    for (size_t i = 0; to->mean_double && i < 3 * n; i++)
        to->mean_double[3 * at + i] = from->mean_double ? from->mean_double[i] : (double)from->mean[i];
}

tides_status td_gaussians_join(td_gaussians *parts, size_t count, td_gaussians *joined, tides_error *error) {
    int64_t total = 0;
    int32_t degree = 0, trained = TIDES_TRAINED_UNKNOWN;
    int wide = 0;
    for (size_t i = 0; i < count; i++) {
        total += parts[i].count;
        trained = td_trained_join(trained, parts[i].trained);
        if (parts[i].sh_degree > degree) degree = parts[i].sh_degree;
        if (parts[i].mean_double) wide = 1;
    }
    td_gaussians made = {0};
    tides_status status = TIDES_OK;
    if (count == 1) {
        made = parts[0];
        memset(&parts[0], 0, sizeof parts[0]);
    } else
        status = td_gaussians_create(&made, total, degree, error);
    if (!status && wide) status = td_gaussians_widen(&made, error);
    made.trained = trained;
    if (count > 1 && parts[0].says_transfer) td_gaussians_tag(&made, parts[0].transfer, parts[0].gamma);
    for (size_t i = 0, at = 0; !status && count > 1 && i < count; i++) {
        append(&made, at, &parts[i]);
        at += (size_t)parts[i].count;
        if (parts[i].notes && !made.notes) { /* the parts come from one file, and have the same notes */
            made.notes = parts[i].notes;
            parts[i].notes = NULL;
        }
        td_gaussians_free(&parts[i]);
    }
    if (status)
        td_gaussians_free(&made);
    else
        *joined = made;
    return status;
}
