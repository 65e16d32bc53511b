/* Finds the part of a scene that is in view: tests clusters of neighbouring Gaussians against the planes through the eye and
 * the image's borders. It computes in double on the host, on any device.
 *
 * A mean at (x, y, z) in the camera's coordinates, z > 0, is seen at u = fx x / z + cx. Its splat extends further by sigmas
 * (fx / z) s sigma, and by `blur` pixels at any z. Here sigma is its largest standard deviation, and s = sqrt(1 + limit^2)
 * bounds the Jacobian, whose slope is clamped. So the splat is right of the image if
 *   fx x - (width - cx + blur) z  >  sigmas fx s sigma.
 * This is a plane, and each other side of the image has one, too; a splat is behind the camera if z < near. Along a cubic
 * path, a linear function is at most its largest value at the cubic's Bezier points. On a ball it exceeds its value at the
 * centre by at most the radius times the length of the plane's normal. */
#include "camera/td_rotation.h"
#include "td_renderer.h"
#include "td_math.h"

#include <math.h>
#include <stdlib.h>

enum { POINTS_MOST = 4, PLANES_MOST = 5 };

/* With a larger size, single precision can't tell where a splat is, not even that it is out of view. Such clusters are kept. */
static const double size_most = 1e12;
/* Safety margin for reaches, and for coordinates: rounding to single precision adds far less. */
static const double more = 1.01, rounding = 1e-5;

/* -- clusters of a store ----------------------------------------------------------------------------------------------- */

static const double *row_of(const td_store *store, int g) { return store->geometry + (size_t)g * TD_GEOMETRY_STRIDE; }

static void bound(const td_store *store, td_cluster *cluster) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, sum = 0;
    for (int g = cluster->begin; g < cluster->end; g++) {
        const double *row = row_of(store, g);
        double square = 0;
        if (row[TD_G_OPACITY] == 0) continue; /* padding, or an invisible Gaussian */
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], row[TD_G_MEAN + k]), high[k] = fmax(high[k], row[TD_G_MEAN + k]);
            sum += row[TD_G_MEAN + k]; /* keeps a NaN, which fmin ignores */
        }
        for (int k = 0; k < 9; k++) square += row[TD_G_FACTOR + k] * row[TD_G_FACTOR + k];
        cluster->axis = fmax(cluster->axis, sqrt(square));
        cluster->opacity = fmax(cluster->opacity, row[TD_G_OPACITY]);
        sum += square + row[TD_G_OPACITY];
    }
    for (int k = 0; k < 3; k++) cluster->centre[k] = 0.5 * (low[k] + high[k]);
    for (int g = cluster->begin; g < cluster->end; g++) {
        double square = 0;
        if (row_of(store, g)[TD_G_OPACITY] == 0) continue;
        for (int k = 0; k < 3; k++) {
            const double away = row_of(store, g)[TD_G_MEAN + k] - cluster->centre[k];
            square += away * away;
        }
        cluster->radius = fmax(cluster->radius, sqrt(square));
    }
    const double size = cluster->radius + cluster->axis + fabs(low[0]) + fabs(low[1]) + fabs(low[2]);
    if (!(sum - sum == 0) || !(size < size_most)) cluster->radius = INFINITY;
}

tides_status td_clusters_create(const td_store *store, td_clusters *clusters, tides_error *error) {
    const size_t groups = (size_t)(store->count / TD_PAD);
    memset(clusters, 0, sizeof *clusters);
    clusters->of = td_alloc(groups, sizeof *clusters->of, error); /* an object has at least one group */
    clusters->state = td_alloc(groups, sizeof *clusters->state, error);
    clusters->first = td_alloc((size_t)store->objects + 1, sizeof *clusters->first, error);
    clusters->group = td_alloc(groups, sizeof *clusters->group, error);
    if (!clusters->of || !clusters->state || !clusters->first || !clusters->group) return TIDES_NO_MEMORY;
    for (int g = 0; g < store->count;) {
        const int object = store->object[g], moves = store->rates || store->mover[object] >= 0;
        td_cluster *cluster = &clusters->of[clusters->count];
        *cluster = (td_cluster){.begin = g};
        while (g < store->count && store->object[g] == object && g - cluster->begin < TD_CLUSTER) g += TD_PAD;
        cluster->end = g;
        bound(store, cluster);
        if (moves) cluster->radius = INFINITY; /* motion takes its Gaussians away from their rows */
        clusters->state[clusters->count++] = moves ? TD_CLUSTER_SEEN : TD_CLUSTER_LEFT;
        clusters->first[object + 1] = clusters->count;
    }
    return TIDES_OK;
}

void td_clusters_release(td_clusters *clusters) {
    free(clusters->of);
    free(clusters->state);
    free(clusters->first);
    free(clusters->group);
    memset(clusters, 0, sizeof *clusters);
}

/* -- clusters in view -------------------------------------------------------------------------------------------------- */

/* A plane of the view. A splat with its mean at p is out of view if n . p > spread sigmas sigma + behind. */
typedef struct plane {
    double normal[3], length; /* of the normal */
    double spread, behind;
} plane;

/* An object in an interval: maps p = r c + t whose convex hull holds the path of a cluster's centre c, and bounds of the
 * rest. */
typedef struct outlook {
    double r[POINTS_MOST][9], t[POINTS_MOST][3];
    int points, planes;
    plane plane[PLANES_MOST];
    double scale, far; /* of the object; largest |t| */
    const td_stray *stray;
} outlook;

static void set_points(const td_cluster_path *path, outlook *out) {
    const td_view *ends[2] = {path->from, path->to};
    const double third = path->duration / 3;
    out->points = path->duration > 0 ? POINTS_MOST : 1;
    for (int i = 0; i < out->points; i++) {
        const td_view *end = ends[i / 2];
        const double way = i == 1 ? third : i == 2 ? -third : 0;
        for (int k = 0; k < 9; k++) out->r[i][k] = end->r[k] + way * end->r_dot[k];
        for (int k = 0; k < 3; k++) out->t[i][k] = end->t[k] + way * end->t_dot[k];
        out->far = fmax(out->far, td_length3(out->t[i]));
    }
    out->scale = td_length3(path->from->r);
    out->stray = path->stray;
}

/* Adds the plane of one side of the image: the side where `axis` grows (sign 1) or falls (-1), `border` pixels from the
 * principal point. */
static void add_side(outlook *out, int axis, double sign, double focal, double limit, double border) {
    plane *side = &out->plane[out->planes++];
    *side = (plane){.spread = focal * sqrt(1 + limit * limit)};
    side->normal[axis] = sign * focal;
    side->normal[2] = -border;
    side->length = td_length3(side->normal);
}

static void set_planes(const td_image *image, double blur, outlook *out) {
    const double limit_x = fmax(image->limit_x1, -image->limit_x0), limit_y = fmax(image->limit_y1, -image->limit_y0);
    out->planes = 0;
    plane *back = &out->plane[out->planes++];
    *back = (plane){.normal = {0, 0, -1}, .length = 1, .behind = -image->near};
    if (image->lens_model) return; /* a lens may bend points from outside the pinhole's image into it */
    add_side(out, 0, 1, image->fx, limit_x, image->width - image->cx + blur);
    add_side(out, 0, -1, image->fx, limit_x, image->cx + blur);
    add_side(out, 1, 1, image->fy, limit_y, image->height - image->cy + blur);
    add_side(out, 1, -1, image->fy, limit_y, image->cy + blur);
}

/* 1 if a cluster is beyond one of the planes throughout. `sigmas`: where its splats are cut off, in standard deviations. */
static int is_out(const td_cluster *cluster, const outlook *out, double sigmas) {
    double at[POINTS_MOST][3];
    const double *c = cluster->centre,
                 away[3] = {c[0] - out->stray->origin[0], c[1] - out->stray->origin[1], c[2] - out->stray->origin[2]};
    for (int i = 0; i < out->points; i++)
        for (int k = 0; k < 3; k++) {
            const double *r = out->r[i] + 3 * k;
            at[i][k] = r[0] * c[0] + r[1] * c[1] + r[2] * c[2] + out->t[i][k];
        }
    const double turn = out->stray->rotation[0];
    const double reach =
        more * (out->scale * cluster->radius + out->stray->position[0] + turn * (td_length3(away) + cluster->radius)) +
        rounding * (out->scale * td_length3(c) + out->far);
    const double wide = more * sigmas * (out->scale + turn) * cluster->axis;
    for (int p = 0; p < out->planes; p++) {
        const plane *side = &out->plane[p];
        double least = INFINITY;
        for (int i = 0; i < out->points; i++)
            least = fmin(least, side->normal[0] * at[i][0] + side->normal[1] * at[i][1] + side->normal[2] * at[i][2]);
        if (least > side->length * reach + side->spread * wide + side->behind) return 1;
    }
    return 0;
}

void td_clusters_look(td_clusters *clusters, int object, const td_image *image, const td_cluster_path *path) {
    const double cut = td_least_seen(image);
    outlook out = {.points = 0};
    double opacity = -1, sigmas = 0;
    set_points(path, &out);
    for (int i = clusters->first[object]; i < clusters->first[object + 1]; i++) {
        const td_cluster *cluster = &clusters->of[i];
        if (cluster->opacity != opacity) {
            opacity = cluster->opacity;
            sigmas = more * sqrt(2 * td_ln(fmax(opacity / cut, 1)));
            set_planes(image, 1 + sigmas * sqrt(image->dilation), &out);
        }
        if (!is_out(cluster, &out, sigmas))
            clusters->state[i] = TD_CLUSTER_SEEN;
        else if (clusters->state[i] == TD_CLUSTER_SEEN)
            clusters->state[i] = TD_CLUSTER_LEFT;
    }
}

td_groups td_clusters_seen(td_clusters *clusters, int first, int end) {
    td_groups seen = {clusters->group, 0};
    for (int i = clusters->first[first]; i < clusters->first[end]; i++)
        for (int g = clusters->of[i].begin; clusters->state[i] == TD_CLUSTER_SEEN && g < clusters->of[i].end; g += TD_PAD)
            clusters->group[seen.count++] = g / TD_PAD;
    return seen;
}
