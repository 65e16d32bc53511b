/* Projects single Gaussians with the functions of kernels/. Two files include it, one in single and one in double precision;
 * they define the names GOLDEN_PROJECT and GOLDEN_TILE. */
#include "kernels/extent.h"

#include "tests/support/golden_render.h"

#include <stdlib.h>

/* Inputs in this precision: one Gaussian. */
typedef struct probe {
    td_image image;
    td_view view;
    td_real geometry[TD_GEOMETRY_STRIDE], rates[TD_GEOMETRY_STRIDE];
    td_real sh[3 * 25], sh_rates[3 * 25];
    td_source source;
} probe;

static void narrow(const double *from, td_real *to, int count) {
    for (int i = 0; i < count; i++) to[i] = (td_real)from[i];
}

static void probe_fill(probe *p, const td_image_numbers *numbers, const double *view, const td_store *store, int gaussian) {
    td_real reals[TD_IMAGE_REALS];
    narrow(numbers->real, reals, TD_IMAGE_REALS);
    memcpy(&p->image, reals, sizeof reals);
    memcpy((char *)&p->image + sizeof reals, numbers->whole, sizeof numbers->whole);
    td_real view_reals[TD_VIEW_REALS];
    narrow(view, view_reals, TD_VIEW_REALS);
    memcpy(&p->view, view_reals, sizeof view_reals);
    size_t sh = (size_t)gaussian * (size_t)store->sh_stride, geometry = (size_t)gaussian * TD_GEOMETRY_STRIDE;
    narrow(store->geometry + geometry, p->geometry, TD_GEOMETRY_STRIDE);
    narrow(store->rates + geometry, p->rates, TD_GEOMETRY_STRIDE);
    narrow(store->sh_wide + sh, p->sh, store->sh_stride);
    narrow(store->sh_rates + sh, p->sh_rates, store->sh_stride);
    p->image.objects = 1;
    p->image.moving = 1;
    p->source.geometry = p->geometry;
    p->source.rates = p->rates;
    p->source.sh = p->sh;
    p->source.sh_rates = p->sh_rates;
    p->source.owners = NULL;
    p->source.first_rate = 0;
    p->source.first_moved = 1;
    p->source.rated = p->source.sh_rated = 1;
    p->source.moved = 0;
}

static void put(golden_splat *splat, int at, td_dual x) {
    splat->value[at] = x.v;
    splat->rate[at] = x.d;
}

static td_shape probe_shape(const probe *p, td_gaussian *gaussian) {
    td_load_gaussian(&p->source, &p->image, 0, gaussian);
    return td_project_shape(&p->view, &p->image, gaussian, 1);
}

/* Factor M = R diag(s) back to s (the columns' lengths), R, and M M^T. */
static void put_activation(const probe *p, golden_splat *splat) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    td_dual m[9];
    for (int k = 0; k < 9; k++) m[k] = td_entry(&p->source, &p->image, 0, TD_G_FACTOR + k);
    for (int j = 0; j < 3; j++) {
        const td_dual axis[3] = {m[j], m[3 + j], m[6 + j]};
        td_dual length = td_dual_sqrt(td_dual_dot3(axis, axis)), inverse = td_dual_reciprocal(length);
        put(splat, SPLAT_SCALE + j, length);
        for (int i = 0; i < 3; i++) put(splat, SPLAT_ROTATION + 3 * i + j, td_dual_mul(axis[i], inverse));
    }
    for (int k = 0; k < 6; k++) put(splat, SPLAT_COV3 + k, td_dual_dot3(m + 3 * row[k], m + 3 * column[k]));
    put(splat, SPLAT_OPACITY, td_entry(&p->source, &p->image, 0, TD_G_OPACITY));
}

static void put_camera_mean(const probe *p, golden_splat *splat) {
    td_dual mean[3];
    for (int j = 0; j < 3; j++) mean[j] = td_entry(&p->source, &p->image, 0, TD_G_MEAN + j);
    for (int i = 0; i < 3; i++)
        put(splat, SPLAT_PC + i,
            td_view_row(p->view.r + 3 * i, p->view.r_dot + 3 * i, &p->image, mean, p->view.t[i], p->view.t_dot[i]));
}

static void put_shape(const td_shape *shape, golden_splat *splat) {
    put(splat, SPLAT_U, shape->u);
    put(splat, SPLAT_U + 1, shape->v);
    put(splat, SPLAT_DEPTH, shape->depth);
    put(splat, SPLAT_COV2, shape->a);
    put(splat, SPLAT_COV2 + 1, shape->b);
    put(splat, SPLAT_COV2 + 2, shape->c);
    for (int k = 0; k < 3; k++) put(splat, SPLAT_CONIC + k, shape->conic[k]);
    put(splat, SPLAT_OPACITY_EFF, shape->opacity);
    splat->visible = shape->visible != 0;
}

void GOLDEN_PROJECT(const td_image_numbers *image, const double *view, const td_store *store, int gaussian,
                    golden_splat *splat) {
    probe p;
    probe_fill(&p, image, view, store, gaussian);
    put_activation(&p, splat);
    put_camera_mean(&p, splat);
    td_gaussian numbers;
    td_shape shape = probe_shape(&p, &numbers);
    put_shape(&shape, splat);
    td_colour colour = td_project_colour(&p.view, &p.image, &p.source, &numbers, 0);
    for (int c = 0; c < 3; c++) put(splat, SPLAT_COLOUR + c, colour.channel[c]);
    /* The files hold the antialiasing factor in every mode: it is the opacity of an antialiased splat of opacity 1. */
    p.image.antialias = 1;
    p.geometry[TD_G_OPACITY] = 1;
    p.rates[TD_G_OPACITY] = 0;
    put(splat, SPLAT_COMP, probe_shape(&p, &numbers).opacity);
}

int GOLDEN_TILE(const td_image_numbers *image, const double *view, const td_store *store, int gaussian, int x, int y) {
    probe p;
    probe_fill(&p, image, view, store, gaussian);
    td_gaussian numbers;
    td_shape shape = probe_shape(&p, &numbers);
    td_extent extent = td_extent_of(&shape, &p.image);
    return td_rectangle_holds(&extent, &p.image, x, y) != 0;
}
