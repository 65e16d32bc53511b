/* Material points: picks those that pixels show, and follows them. A point is a fixed place xi in a Gaussian, and lies at c +
 * F xi, where c is the Gaussian's centre and F its factor. It works on the host, in double; rows of Gaussians that move by
 * themselves come from the backend. */
#include "camera/td_rotation.h"
#include "td_renderer.h"
#include "tides/truth.h"

#include "kernels/truth.h"

#include <math.h>
#include <stdlib.h>

/* The scene at one time: at each pixel the Gaussian with the median transmittance (index in the store, or -1), and the
 * objects' views. */
typedef struct moment {
    double time;
    td_image image; /* without rates: only places are needed */
    double *splat;  /* (height x width) */
    td_view *views; /* (objects of the store) */
} moment;

/* A Gaussian seen along a ray: the place xi that the ray shows, its position, and the Gaussian's depth there. */
typedef struct glance {
    double xi[3], p[3], thickness;
} glance;

/* -- moments --------------------------------------------------------------------------------------------------------- */

static void moment_release(moment *m) {
    free(m->splat);
    free(m->views);
}

/* Converts places in tiles' lists to Gaussians. */
static void name_splats(const tides_renderer *r, double *splat) {
    for (int y = 0; y < r->image.height; y++)
        for (int x = 0; x < r->image.width; x++) {
            double *at = &splat[(size_t)y * (size_t)r->image.width + (size_t)x];
            const int tile = y / TD_TILE * r->candidates.tiles_x + x / TD_TILE;
            if (*at >= 0) *at = r->candidates.list[r->candidates.first[tile] + (int)*at];
        }
}

static tides_status moment_take(tides_renderer *r, const tides_trajectory *camera, double time, moment *m, tides_error *error) {
    const double *planes = NULL;
    memset(m, 0, sizeof *m);
    m->time = time;
    m->image = r->image;
    m->image.moving = 0;
    m->splat = td_alloc((size_t)r->image.width * (size_t)r->image.height, sizeof *m->splat, error);
    m->views = td_alloc((size_t)r->store.objects, sizeof *m->views, error);
    tides_status status = m->splat && m->views ? TIDES_OK : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = td_renderer_all_tiles(r, camera, time, TD_OUT_TRUTH, &planes, error);
    if (status == TIDES_OK) {
        td_renderer_assemble(r, planes, TD_TRUTH_SPLAT, TD_OUT_TRUTH, m->splat);
        name_splats(r, m->splat);
        status = td_renderer_views(r, camera, &time, 1, error);
    }
    if (status == TIDES_OK) memcpy(m->views, r->scratch.views, (size_t)r->store.objects * sizeof *m->views);
    return status;
}

/* -- Gaussians along rays -------------------------------------------------------------------------------------------- */

/* A Gaussian's centre and factor in the camera's coordinates: a record of places, and one of rates. */
/* NOLINTNEXTLINE(readability-non-const-parameter): td_surfaces writes through them */
static void surface_at(const moment *m, const td_view *view, const double *row, double place[16], double rate[16]) {
    td_source source;
    memset(&source, 0, sizeof source);
    source.geometry = row;
    const td_surfaces to = {place, rate};
    td_store_surfaces(view, &m->image, &source, 0, 0, 0, &to);
}

/* The Gaussian as a ray sees it. xi is limited to the distance up to which kernels draw splats. */
static glance glance_at(const moment *m, const td_view *view, const double *row, double x, double y) {
    double place[16], rate[16], way[3];
    td_source source;
    td_truth pixel;
    td_gaussian own;
    glance g;
    memset(&source, 0, sizeof source);
    source.geometry = row;
    surface_at(m, view, row, place, rate);
    td_truth_start(&pixel, x, y, &m->image);
    td_load_gaussian(&source, &m->image, 0, &own);
    const td_shape shape = td_project_shape(view, &m->image, &own, 1);
    const double dx = x - shape.u.v, dy = y - shape.v.v, scale = rate[TD_S_SCALE], *f = place + TD_S_F;
    const double out = shape.conic[0].v * dx * dx + 2 * shape.conic[1].v * dx * dy + shape.conic[2].v * dy * dy;
    td_seen_point(place, scale, TD_TRUTH_REACH * (out + TD_TRUTH_MIDDLE), &pixel, g.xi);
    for (int i = 0; i < 3; i++) g.p[i] = place[TD_S_C + i] + td_dot3(f + 3 * i, g.xi);
    const double ray[3] = {pixel.rx, pixel.ry, 1}, *k = place + TD_S_K, *rest = rate + TD_S_K_REST;
    way[0] = k[0] * ray[0] + k[1] * ray[1] + k[2], way[1] = k[1] * ray[0] + rest[0] * ray[1] + rest[1];
    way[2] = k[2] * ray[0] + rest[1] * ray[1] + rest[2];
    const double volume =
        fabs(f[0] * (f[4] * f[8] - f[5] * f[7]) + f[1] * (f[5] * f[6] - f[3] * f[8]) + f[2] * (f[3] * f[7] - f[4] * f[6]));
    const double across = td_dot3(ray, way); /* 1 / sqrt(d^T Sigma^-1 d) is the Gaussian's depth along the ray */
    g.thickness = across > 0 ? volume / (scale * sqrt(across)) : 0;
    for (int j = 0; j < 3; j++) g.xi[j] *= scale;
    return g;
}

/* The position of a point in the camera's coordinates. */
static void point_at(const moment *m, const td_view *view, const double *row, const double xi[3], double p[3]) {
    double place[16], rate[16];
    surface_at(m, view, row, place, rate);
    for (int i = 0; i < 3; i++) p[i] = place[TD_S_C + i] + td_dot3(place + TD_S_F + 3 * i, xi) / rate[TD_S_SCALE];
}

/* Projects a position in the camera's coordinates onto the screen. */
static void project(const moment *m, const double p[3], double *u, double *v) {
    double x = p[0] / p[2], y = p[1] / p[2];
    if (m->image.lens_model) {
        const td_bent bent = td_bend(&m->image, td_still(x), td_still(y));
        x = bent.x.v, y = bent.y.v;
    }
    *u = m->image.fx * x + m->image.cx;
    *v = m->image.fy * y + m->image.cy;
}

/* -- picking --------------------------------------------------------------------------------------------------------- */

static tides_status check_places(const tides_renderer *r, const double *xy, size_t count, tides_error *error) {
    for (size_t i = 0; i < count; i++)
        if (!(xy[2 * i] >= 0 && xy[2 * i] < r->image.width && xy[2 * i + 1] >= 0 && xy[2 * i + 1] < r->image.height))
            return td_fail(error, TIDES_BAD_ARGUMENT, "place %zu, (%g, %g) px, is outside of the image, %d x %d px", i,
                           xy[2 * i], xy[2 * i + 1], r->image.width, r->image.height);
    return TIDES_OK;
}

/* The Gaussian (of the store) with the median at a place, or -1. */
static int splat_at(const moment *m, double x, double y) {
    return (int)m->splat[(size_t)y * (size_t)m->image.width + (size_t)x];
}

/* Finds the points at xy, and their places on the screen, start (count x 2, may be NULL). These are xy, except for splats
 * that dilation makes visible where they are not. */
static tides_status pick(tides_renderer *r, const tides_trajectory *camera, double time, const double *xy, size_t count,
                         tides_material_point *points, double *start, tides_error *error) {
    tides_status status = check_places(r, xy, count, error);
    moment m = {0};
    int *gaussians = td_alloc(count + 1, sizeof *gaussians, error);
    double *rows = td_alloc(count + 1, TD_GEOMETRY_STRIDE * sizeof *rows, error);
    if (status == TIDES_OK && !(gaussians && rows)) status = TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = moment_take(r, camera, time - r->epoch, &m, error);
    for (size_t i = 0; i < count && status == TIDES_OK; i++) gaussians[i] = splat_at(&m, xy[2 * i], xy[2 * i + 1]);
    if (status == TIDES_OK) status = td_renderer_rows_at(r, gaussians, count, m.time, rows, error);
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        const int g = gaussians[i];
        points[i] = (tides_material_point){.object = -1, .gaussian = -1};
        if (g < 0) continue;
        const glance seen =
            glance_at(&m, &m.views[r->store.object[g]], rows + i * TD_GEOMETRY_STRIDE, xy[2 * i], xy[2 * i + 1]);
        points[i].object = r->store.scene_object[r->store.object[g]];
        points[i].gaussian = r->store.number[g];
        memcpy(points[i].xi, seen.xi, sizeof points[i].xi);
        if (start) project(&m, seen.p, &start[2 * i], &start[2 * i + 1]);
    }
    moment_release(&m);
    free(rows);
    free(gaussians);
    return status;
}

tides_status tides_renderer_pick(tides_renderer *r, const tides_trajectory *camera, double time, const double *xy, size_t count,
                                 tides_material_point *points, tides_error *error) {
    if (!r || !camera || (count && (!xy || !points)))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_renderer_pick: renderer, camera, xy and points must be given");
    return pick(r, camera, time, xy, count, points, NULL, error);
}

/* -- following ------------------------------------------------------------------------------------------------------- */

/* The store's Gaussians by their number within an object of the scene; `first` has (objects of the scene + 1) entries. */
typedef struct numbering {
    int objects;
    int64_t *first;
    int *gaussian;
} numbering;

static void numbering_release(numbering *n) {
    free(n->first);
    free(n->gaussian);
}

static tides_status numbering_make(const tides_renderer *r, numbering *n, tides_error *error) {
    const td_store *store = &r->store;
    memset(n, 0, sizeof *n);
    n->objects = td_store_scene_objects(store);
    n->first = td_alloc((size_t)n->objects + 1, sizeof *n->first, error);
    n->gaussian = td_alloc((size_t)store->count, sizeof *n->gaussian, error);
    if (!n->first || !n->gaussian) return TIDES_NO_MEMORY;
    for (int g = 0; g < store->count; g++) { /* the number of Gaussians; padding repeats the last one */
        int64_t *end = &n->first[store->scene_object[store->object[g]] + 1];
        if (store->number[g] + 1 > *end) *end = store->number[g] + 1;
    }
    for (int i = 0; i < n->objects; i++) n->first[i + 1] += n->first[i];
    for (int g = store->count - 1; g >= 0; g--) /* the lowest index of a number, which isn't padding */
        n->gaussian[n->first[store->scene_object[store->object[g]]] + store->number[g]] = g;
    return TIDES_OK;
}

/* Finds the store's Gaussians of points; -1 for none. */
static tides_status find_points(const tides_renderer *r, const tides_material_point *points, size_t count, int *gaussians,
                                tides_error *error) {
    numbering n;
    tides_status status = numbering_make(r, &n, error);
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        const tides_material_point *p = &points[i];
        gaussians[i] = -1;
        if (p->object == -1) continue;
        if (p->object < 0 || p->object >= n.objects || p->gaussian < 0 ||
            p->gaussian >= n.first[p->object + 1] - n.first[p->object])
            status = td_fail(error, TIDES_BAD_ARGUMENT, "point %zu: the scene has no Gaussian %lld of object %d", i,
                             (long long)p->gaussian, (int)p->object);
        else
            gaussians[i] = n.gaussian[n.first[p->object] + p->gaussian];
    }
    numbering_release(&n);
    return status;
}

/* 1 if a point is hidden by the Gaussian that its pixel shows. It must be behind that by more than both splats' depth, and by
 * more than soft order can distinguish. */
static int is_hidden(const moment *m, double depth, const glance *own, const glance *shown) {
    const double deep = 3 * (own->thickness + shown->thickness), near = TD_SOFT_REACH * m->image.soft_depth * shown->p[2];
    return depth > shown->p[2] + deep + near;
}

static int is_inside(const moment *m, const tides_track *track) {
    return track->depth > m->image.near && track->u >= 0 && track->u < m->image.width && track->v >= 0 &&
           track->v < m->image.height;
}

/* Points under way: Gaussians of the store, and their rows. */
typedef struct followed {
    size_t count;
    const tides_material_point *points;
    int *own, *shown;          /* the point's own; the one that its place shows, -1 where there is none */
    double *rows, *shown_rows; /* (count x TD_GEOMETRY_STRIDE) */
    tides_track *tracks;       /* results */
} followed;

/* Sets the tracks of the points as if nothing hid them, and the Gaussians that their places show. */
static tides_status place_points(tides_renderer *r, const moment *m, const followed *f, tides_error *error) {
    const int *own = f->own;
    int *shown = f->shown;
    tides_track *tracks = f->tracks;
    tides_status status = td_renderer_rows_at(r, own, f->count, m->time, f->rows, error);
    for (size_t i = 0; i < f->count && status == TIDES_OK; i++) {
        double p[3];
        tracks[i] = (tides_track){.u = NAN, .v = NAN, .depth = NAN};
        shown[i] = -1;
        if (own[i] < 0) continue;
        point_at(m, &m->views[r->store.object[own[i]]], f->rows + i * TD_GEOMETRY_STRIDE, f->points[i].xi, p);
        tracks[i].depth = p[2];
        if (!(p[2] > m->image.near)) continue;
        project(m, p, &tracks[i].u, &tracks[i].v);
        tracks[i].visible = is_inside(m, &tracks[i]);
        if (tracks[i].visible) shown[i] = splat_at(m, tracks[i].u, tracks[i].v);
    }
    return status;
}

static tides_status hide_points(tides_renderer *r, const moment *m, const followed *f, tides_error *error) {
    const int *own = f->own, *shown = f->shown;
    tides_track *tracks = f->tracks;
    tides_status status = td_renderer_rows_at(r, shown, f->count, m->time, f->shown_rows, error);
    for (size_t i = 0; i < f->count && status == TIDES_OK; i++) {
        if (shown[i] < 0 || shown[i] == own[i]) continue;
        const double u = tracks[i].u, v = tracks[i].v;
        const glance mine = glance_at(m, &m->views[r->store.object[own[i]]], f->rows + i * TD_GEOMETRY_STRIDE, u, v);
        const glance there = glance_at(m, &m->views[r->store.object[shown[i]]], f->shown_rows + i * TD_GEOMETRY_STRIDE, u, v);
        if (is_hidden(m, tracks[i].depth, &mine, &there)) tracks[i].visible = 0;
    }
    return status;
}

tides_status tides_renderer_follow(tides_renderer *r, const tides_trajectory *camera, double time,
                                   const tides_material_point *points, size_t count, tides_track *tracks, tides_error *error) {
    if (!r || !camera || (count && (!points || !tracks)))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_renderer_follow: renderer, camera, points and tracks must be given");
    moment m = {0};
    int *own = td_alloc(2 * count + 1, sizeof *own, error);
    double *rows = td_alloc(2 * count + 1, TD_GEOMETRY_STRIDE * sizeof *rows, error);
    tides_status status = own && rows ? find_points(r, points, count, own, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = moment_take(r, camera, time - r->epoch, &m, error);
    if (status == TIDES_OK) {
        const followed f = {count, points, own, own + count, rows, rows + count * TD_GEOMETRY_STRIDE, tracks};
        status = place_points(r, &m, &f, error);
        if (status == TIDES_OK) status = hide_points(r, &m, &f, error);
    }
    moment_release(&m);
    free(rows);
    free(own);
    return status;
}

tides_status tides_renderer_displacement(tides_renderer *r, const tides_trajectory *camera, double from, double to, double *u,
                                         double *v, double *visible, tides_error *error) {
    if (!r || !camera)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_renderer_displacement: renderer and camera must be given");
    const size_t pixels = (size_t)r->image.width * (size_t)r->image.height;
    double *xy = td_alloc(2 * pixels, sizeof *xy, error);
    tides_material_point *points = td_alloc(pixels, sizeof *points, error);
    tides_track *tracks = td_alloc(pixels, sizeof *tracks, error);
    tides_status status = xy && points && tracks ? TIDES_OK : TIDES_NO_MEMORY;
    for (size_t i = 0; i < pixels && status == TIDES_OK; i++) {
        const size_t column = i % (size_t)r->image.width, row = i / (size_t)r->image.width;
        xy[2 * i] = (double)column + 0.5;
        xy[2 * i + 1] = (double)row + 0.5;
    }
    if (status == TIDES_OK) status = pick(r, camera, from, xy, pixels, points, xy, error);
    if (status == TIDES_OK) status = tides_renderer_follow(r, camera, to, points, pixels, tracks, error);
    for (size_t i = 0; i < pixels && status == TIDES_OK; i++) {
        if (u) u[i] = tracks[i].u - xy[2 * i];
        if (v) v[i] = tracks[i].v - xy[2 * i + 1];
        if (visible) visible[i] = tracks[i].visible;
    }
    free(tracks);
    free(points);
    free(xy);
    return status;
}
