/* EWA projection of Gaussians to splats, values and rates (paper, Sec. 3.1 and 3.2; gaussian_splatting: Zwicker et al. 2002).
 *
 * The covariance is kept as its factor M (Sigma = M M^T), so the projected covariance A A^T with A = J W M is never indefinite
 * in floating point, and its determinant comes without cancellation: |a0 x a1|^2 for the rows of A (Lagrange's identity). */
#ifndef TD_PROJECTION_H
#define TD_PROJECTION_H

#include "fine_depth.h"
#include "lens.h"
#include "sh.h"
#include "transpose.h"

/* TD_LANES Gaussians seen by one camera. Numbers are meaningless where `visible` is 0. */
typedef struct td_shape {
    td_dual depth;         /* camera z [scene units] */
    td_lanes depth_low;    /* rounding error of z, relative to it: for soft order */
    td_dual u, v;          /* mean2d [px] */
    td_dual a, b, c;       /* covariance after dilation: (a b; b c) [px^2] */
    td_dual det;           /* its determinant [px^4]; of a smaller copy where td_shrink_wide made one */
    td_dual conic[3];      /* its inverse: xx, xy, yy [1/px^2] */
    td_dual opacity;       /* with antialiasing and near fade */
    td_lanes compensation; /* the antialiasing factor, 1 where off */
    td_lanes power;        /* the ellipse's d^T Q d at the cut: 2 ln(opacity / cut) */
    td_mask visible;
    td_mask broken; /* in front of the camera and not finite in single precision: seen everywhere, to be found */
} td_shape;

/* A 2x3 matrix: the map from object displacements to pixels, or its product with the factor. Members instead of an array,
 * because PoCL keeps an array that a loop goes through in memory. */
typedef struct td_matrix23 {
    td_dual row[2][3];
} td_matrix23;

/* Rows of Gaussians: first those of the store, then, from `first_moved` on, Gaussians that move by themselves at one time. Rows
 * from `first_rate` on have rates, which are stored from there on. Without moving Gaussians no row has rates. */
typedef struct td_source {
    TD_GLOBAL const td_real *geometry, *rates; /* TD_GEOMETRY_STRIDE per row */
    TD_GLOBAL const td_sh_real *sh;            /* sh_stride per row */
    TD_GLOBAL const td_real *sh_rates;         /* likewise */
    TD_GLOBAL const int *owners;               /* of each moved row: its Gaussian in the store, which has the SH */
    int first_rate, first_moved;
    int rated, moved, sh_rated; /* of the rows in hand: 1 where they have rates, are moved ones, and have rates of SH */
} td_source;

#ifdef TD_OPENCL
/* A kernel's arrays as a source; td_source_of sets the members that are 0 here. */
TD_INLINE td_source td_source_make(TD_GLOBAL const td_real *geometry, TD_GLOBAL const td_real *rates,
                                   TD_GLOBAL const td_sh_real *sh, TD_GLOBAL const td_real *sh_rates,
                                   TD_GLOBAL const int *owners, int first_rate, int first_moved) {
    td_source source;
    source.geometry = geometry;
    source.rates = rates;
    source.sh = sh;
    source.sh_rates = sh_rates;
    source.owners = owners;
    source.first_rate = first_rate;
    source.first_moved = first_moved;
    source.rated = source.moved = source.sh_rated = 0;
    return source;
}
#endif

/* The source for a group of rows that begins with `leader`. All rows of a group are of one kind. */
TD_INLINE td_source td_source_of(const td_source *all, const td_image *image, int leader) {
    td_source source = *all;
    source.rated = td_moving(image) && leader >= all->first_rate;
    source.moved = td_moving(image) && leader >= all->first_moved;
    source.sh_rated = source.rated;
    if (source.moved) source.sh_rated = all->owners[2 * (leader - all->first_moved) + 1] >= all->first_rate;
    return source;
}

/* The store's Gaussian whose row is `leader`. */
TD_INLINE int td_owner_of(const td_source *source, int leader) {
    return source->moved ? source->owners[2 * (leader - source->first_moved)] : leader;
}

/* Geometry entry k of the rows at `index`, an offset in reals. */
TD_INLINE td_dual td_entry(const td_source *source, const td_image *image, td_index index, int k) {
    td_lanes rate = td_splat(0.0f);
    if (td_moving(image) && source->rated)
        rate = td_gather(source->rates, td_not_below_0(index - source->first_rate * TD_GEOMETRY_STRIDE) + k);
    return td_dual_make(td_gather(source->geometry, index + k), rate);
}

/* Rows of TD_LANES Gaussians, entries as in TD_G_MEAN and following. */
typedef struct td_gaussian {
    td_lanes v[TD_GEOMETRY_STRIDE], d[TD_GEOMETRY_STRIDE]; /* d: 0 where rows have no rates */
} td_gaussian;

TD_INLINE void td_load_gaussian(const td_source *source, const td_image *image, td_index row, td_gaussian *gaussian) {
    td_load_rows(source->geometry, row, gaussian->v);
    if (!td_moving(image)) return;
    if (source->rated)
        td_load_rows(source->rates, td_not_below_0(row - source->first_rate), gaussian->d);
    else
        td_zero_row(gaussian->d);
}

TD_INLINE td_dual td_number_of(const td_gaussian *gaussian, const td_image *image, int k) {
    return td_dual_make(gaussian->v[k], td_moving(image) ? gaussian->d[k] : td_splat(0.0f));
}

/* a b + c, where b is a Gaussian's own number and has a rate only in scenes with moving Gaussians. */
TD_INLINE td_dual td_dual_fma_own(const td_image *image, td_dual a, td_dual b, td_dual c) {
    return td_moving(image) ? td_dual_fma(a, b, c) : td_dual_fma_still(a, b.v, c);
}

/* A dual that is equal in all lanes. */
TD_INLINE td_dual td_dual_all(td_real v, td_real d) { return td_dual_make(td_splat(v), td_splat(d)); }

/* m . p + offset, and its rate: a row m of a moving frame, equal for all lanes, times the points p. */
TD_INLINE td_dual td_view_row(TD_GLOBAL const td_real *m, TD_GLOBAL const td_real *m_dot, const td_image *image,
                              const td_dual p[3], td_real offset, td_real offset_dot) {
    td_dual sum = td_dual_all(offset, offset_dot);
    sum = td_dual_fma_own(image, td_dual_all(m[0], m_dot[0]), p[0], sum);
    sum = td_dual_fma_own(image, td_dual_all(m[1], m_dot[1]), p[1], sum);
    return td_dual_fma_own(image, td_dual_all(m[2], m_dot[2]), p[2], sum);
}

/* Entry j of a row of T: focal / z (r - slope r_z), where r is a row of the view's rotation. */
TD_INLINE td_dual td_screen_entry(TD_GLOBAL const td_view *view, int row, int j, td_dual focal, td_dual slope) {
    td_dual r = td_dual_all(view->r[3 * row + j], view->r_dot[3 * row + j]);
    return td_dual_mul(focal, td_dual_sub(r, td_dual_mul(slope, td_dual_all(view->r[6 + j], view->r_dot[6 + j]))));
}

/* Column j of T with a lens: K Dd (r - slope r_z) / z. */
TD_INLINE void td_lens_column(TD_GLOBAL const td_view *view, const td_image *image, int j, const td_bent *bent, td_dual slope_x,
                              td_dual slope_y, td_dual inverse_z, td_matrix23 *t) {
    td_dual x = td_screen_entry(view, 0, j, inverse_z, slope_x), y = td_screen_entry(view, 1, j, inverse_z, slope_y);
    t->row[0][j] = td_dual_scale(td_dual_fma(bent->xx, x, td_dual_mul(bent->xy, y)), image->fx);
    t->row[1][j] = td_dual_scale(td_dual_fma(bent->yx, x, td_dual_mul(bent->yy, y)), image->fy);
}

/* T = J R with a lens. */
TD_INLINE td_matrix23 td_lens_map(TD_GLOBAL const td_view *view, const td_image *image, td_dual slope_x, td_dual slope_y,
                                  td_dual inverse_z) {
    td_matrix23 t;
    td_bent bent = td_bend(image, slope_x, slope_y);
    td_lens_column(view, image, 0, &bent, slope_x, slope_y, inverse_z, &t);
    td_lens_column(view, image, 1, &bent, slope_x, slope_y, inverse_z, &t);
    td_lens_column(view, image, 2, &bent, slope_x, slope_y, inverse_z, &t);
    return t;
}

/* T = J R: the Jacobian of the pinhole times the view's rotation. (x_z, y_z) = (x/z, y/z). */
TD_INLINE td_matrix23 td_screen_map(TD_GLOBAL const td_view *view, const td_image *image, td_dual x_z, td_dual y_z,
                                    td_dual inverse_z) {
    td_matrix23 t;
    td_dual slope_x = td_dual_clamp(x_z, image->limit_x0, image->limit_x1);
    td_dual slope_y = td_dual_clamp(y_z, image->limit_y0, image->limit_y1);
    if (td_lens_model(image)) return td_lens_map(view, image, slope_x, slope_y, inverse_z);
    td_dual focal_x = td_dual_scale(inverse_z, image->fx), focal_y = td_dual_scale(inverse_z, image->fy);
    t.row[0][0] = td_screen_entry(view, 0, 0, focal_x, slope_x), t.row[1][0] = td_screen_entry(view, 1, 0, focal_y, slope_y);
    t.row[0][1] = td_screen_entry(view, 0, 1, focal_x, slope_x), t.row[1][1] = td_screen_entry(view, 1, 1, focal_y, slope_y);
    t.row[0][2] = td_screen_entry(view, 0, 2, focal_x, slope_x), t.row[1][2] = td_screen_entry(view, 1, 2, focal_y, slope_y);
    return t;
}

TD_INLINE td_dual td_dual_dot3(const td_dual a[3], const td_dual b[3]) {
    return td_dual_fma(a[0], b[0], td_dual_fma(a[1], b[1], td_dual_mul(a[2], b[2])));
}

/* Column j of a row of A = T M, with the Gaussians' factors M. */
TD_INLINE td_dual td_factor_entry(const td_dual t[3], const td_image *image, const td_gaussian *gaussian, int j) {
    td_dual sum = td_dual_fma_own(image, t[0], td_number_of(gaussian, image, TD_G_FACTOR + j), td_dual_all(0, 0));
    sum = td_dual_fma_own(image, t[1], td_number_of(gaussian, image, TD_G_FACTOR + 3 + j), sum);
    return td_dual_fma_own(image, t[2], td_number_of(gaussian, image, TD_G_FACTOR + 6 + j), sum);
}

TD_INLINE td_matrix23 td_project_factor(const td_matrix23 *t, const td_image *image, const td_gaussian *gaussian) {
    td_matrix23 a;
    a.row[0][0] = td_factor_entry(t->row[0], image, gaussian, 0), a.row[1][0] = td_factor_entry(t->row[1], image, gaussian, 0);
    a.row[0][1] = td_factor_entry(t->row[0], image, gaussian, 1), a.row[1][1] = td_factor_entry(t->row[1], image, gaussian, 1);
    a.row[0][2] = td_factor_entry(t->row[0], image, gaussian, 2), a.row[1][2] = td_factor_entry(t->row[1], image, gaussian, 2);
    return a;
}

/* An entry of the cross product a0 x a1 of A's rows: columns k and l. */
TD_INLINE td_dual td_cross_entry(const td_matrix23 *a, int k, int l) {
    return td_dual_fma(a->row[0][k], a->row[1][l], td_dual_negate(td_dual_mul(a->row[0][l], a->row[1][k])));
}

/* |a0 x a1|^2: the determinant of A A^T. */
TD_INLINE td_dual td_factor_determinant(const td_matrix23 *a) {
    const td_dual n[3] = {td_cross_entry(a, 1, 2), td_cross_entry(a, 2, 0), td_cross_entry(a, 0, 1)};
    return td_dual_dot3(n, n);
}

TD_INLINE td_lanes td_largest_entry(const td_dual a[3], td_lanes largest) {
    return td_larger(td_larger(td_larger(largest, td_size(a[0].v)), td_size(a[1].v)), td_size(a[2].v));
}

TD_INLINE td_dual td_dual_times(td_dual a, td_lanes factor) { return td_dual_make(a.v * factor, a.d * factor); }
TD_INLINE void td_row_times(td_dual a[3], td_lanes factor) {
    a[0] = td_dual_times(a[0], factor), a[1] = td_dual_times(a[1], factor), a[2] = td_dual_times(a[2], factor);
}

/* A splat may be so wide [px] that its determinant, a product of four such lengths, overflows single precision: from 2^32 px
 * on, earlier for rates. If A is beyond 2^25 px it is multiplied by `shrink`, a power of two, which rounds nothing; the results
 * are multiplied by its inverse `grow` later. Returns 1 where a lane needs it, which none does in double precision: there the
 * determinant is the splat's own. Beyond 2^60 px conics would overflow single precision, too, and the splat is broken. */
TD_INLINE int td_shrink_wide(td_shape *shape, td_matrix23 *a, td_lanes *shrink, td_lanes *grow) {
    const td_real wide = TD_REAL(33554432.0), widest = TD_REAL(1152921504606846976.0); /* 2^25 and 2^60 */
    td_lanes largest = td_largest_entry(a->row[1], td_largest_entry(a->row[0], td_splat(0.0f)));
    td_mask needs = largest > wide;
    shape->broken = largest > widest;
    if (sizeof(td_real) > sizeof(float) || !td_any(needs)) return 0;
    *shrink = td_select(td_splat(1.0f), td_inverse_power(td_clamp(largest, wide, widest)), needs);
    *grow = 1.0f / *shrink;
    td_row_times(a->row[0], *shrink);
    td_row_times(a->row[1], *shrink);
    return 1;
}

/* Covariance, conic and antialiasing factor from A. */
TD_INLINE td_dual td_shape_covariance(td_shape *shape, const td_matrix23 *given, const td_image *image) {
    td_matrix23 shrunk = *given, *a = &shrunk;
    td_lanes shrink, grow, dilation = td_splat(image->dilation);
    int wide = td_shrink_wide(shape, a, &shrink, &grow);
    if (wide) dilation = dilation * shrink * shrink;
    td_dual xx = td_dual_dot3(a->row[0], a->row[0]), yy = td_dual_dot3(a->row[1], a->row[1]);
    shape->a = td_dual_make(xx.v + dilation, xx.d);
    shape->b = td_dual_dot3(a->row[0], a->row[1]);
    shape->c = td_dual_make(yy.v + dilation, yy.d);
    td_dual det0 = td_factor_determinant(a);
    td_dual det = td_dual_add(det0, td_dual_times(td_dual_add(xx, yy), dilation));
    det.v = det.v + dilation * dilation;
    if (wide) det0 = td_dual_times(det0, grow), det = td_dual_times(det, grow);
    shape->det = det;
    td_dual inverse = td_dual_reciprocal(det);
    td_dual ratio = td_dual_mul(det0, inverse);
    /* Without dilation a splat may be narrower than 2^-25 px, which single precision can't tell: no pixel's centre sees it. */
    td_mask narrow = det.v <= (image->dilation > 0 ? TD_REAL(0.0) : TD_REAL(7.8886090522101181e-31)); /* 2^-100 */
    inverse = td_dual_select(inverse, td_dual_make(td_splat(0.0f), td_splat(0.0f)), narrow);
    if (wide) inverse = td_dual_times(inverse, shrink);
    shape->conic[0] = td_dual_mul(shape->c, inverse);
    shape->conic[1] = td_dual_negate(td_dual_mul(shape->b, inverse));
    shape->conic[2] = td_dual_mul(shape->a, inverse);
    shape->visible = shape->visible & ~narrow;
    if (wide) {
        shape->a = td_dual_times(shape->a, grow * grow);
        shape->b = td_dual_times(shape->b, grow * grow);
        shape->c = td_dual_times(shape->c, grow * grow);
    }
    td_mask floored = ratio.v <= image->antialias_floor;
    td_dual floor_value = td_dual_make(td_splat(image->antialias_floor), td_splat(0.0f));
    return td_dual_sqrt(td_dual_select(ratio, floor_value, floored));
}

/* Opacity as composited: applies the fade at the near plane, and tells whether opacity exceeds the cut. */
TD_INLINE void td_shape_fade(td_shape *shape, td_dual opacity, const td_image *image) {
    if (image->near_full > image->near) {
        td_real scale = 1 / (image->near_full - image->near);
        td_dual x = td_dual_clamp(td_dual_scale(td_dual_offset(shape->depth, -image->near), scale), 0, 1);
        opacity = td_dual_mul(opacity, td_dual_make(td_smootherstep(x.v), td_smootherstep_slope(x.v) * x.d));
    }
    shape->opacity = opacity;
    /* Without a cut the ellipse ends where single precision does. td_log needs a positive normal number. */
    td_real cut = td_least_seen(image);
    shape->visible = shape->visible & (opacity.v > cut);
    shape->power = 2.0f * td_log(td_select(td_splat(1.0f), opacity.v / cut, shape->visible));
}

/* Projects Gaussians without the near plane's fade: opacity is that with antialiasing. `visible` is 1 in front of the near
 * plane, unless the splat is too narrow. Lanes that aren't `there` come out invisible. */
TD_INLINE td_shape td_project_bare(TD_GLOBAL const td_view *view, const td_image *image, const td_gaussian *gaussian,
                                   td_mask there) {
    td_shape shape;
    const td_dual mean[3] = {td_number_of(gaussian, image, TD_G_MEAN), td_number_of(gaussian, image, TD_G_MEAN + 1),
                             td_number_of(gaussian, image, TD_G_MEAN + 2)};
    td_dual x = td_view_row(view->r, view->r_dot, image, mean, view->t[0], view->t_dot[0]);
    td_dual y = td_view_row(view->r + 3, view->r_dot + 3, image, mean, view->t[1], view->t_dot[1]);
    td_dual z = td_view_row(view->r + 6, view->r_dot + 6, image, mean, view->t[2], view->t_dot[2]);
    shape.depth_low = td_splat(0.0f);
#ifndef TD_REAL_DOUBLE
    if (td_soft_order(image)) z.v = td_fine_row(view->r + 6, mean, view->t[2], &shape.depth_low);
#endif
    shape.depth = z;
    shape.visible = (z.v > image->near) & there;
    /* Behind the near plane a splat is invisible; depth 1 keeps its arithmetic finite. */
    td_dual safe = td_dual_select(td_dual_make(td_splat(1.0f), td_splat(0.0f)), z, z.v > image->near);
    td_dual inverse_z = td_dual_reciprocal(safe);
    td_dual x_z = td_dual_mul(x, inverse_z), y_z = td_dual_mul(y, inverse_z);
    td_matrix23 map = td_screen_map(view, image, x_z, y_z, inverse_z);
    if (td_lens_model(image)) {
        td_bent bent = td_bend(image, x_z, y_z);
        x_z = bent.x, y_z = bent.y;
    }
    shape.u = td_dual_offset(td_dual_scale(x_z, image->fx), image->cx);
    shape.v = td_dual_offset(td_dual_scale(y_z, image->fy), image->cy);
    td_matrix23 a = td_project_factor(&map, image, gaussian);
    td_dual compensation = td_shape_covariance(&shape, &a, image);
    shape.compensation = td_splat(1.0f);
    shape.opacity = td_number_of(gaussian, image, TD_G_OPACITY);
    if (td_antialias(image)) {
        shape.opacity = td_dual_mul(shape.opacity, compensation);
        shape.compensation = compensation.v;
    }
    return shape;
}

/* Projects Gaussians, with the fade at the near plane. */
TD_INLINE td_shape td_project_shape(TD_GLOBAL const td_view *view, const td_image *image, const td_gaussian *gaussian,
                                    td_mask there) {
    td_shape shape = td_project_bare(view, image, gaussian, there);
    td_lanes z = shape.depth.v;
    td_shape_fade(&shape, shape.opacity, image);
    td_lanes all = (shape.conic[0].d + shape.conic[2].d) + (shape.u.d + shape.v.d) + (shape.opacity.v + shape.opacity.d);
    /* By the opacity before the fade: where depth is NaN, the fade leaves no opacity, and the broken splat wouldn't be
     * found. */
    td_real cut = td_cut_rule(image) == TD_CUT_NONE ? TD_REAL(0.0) : image->cut;
    td_mask unseen = gaussian->v[TD_G_OPACITY] <= cut;
    shape.broken = (((z > image->near) & (shape.broken | td_is_broken(all))) | td_is_broken(z)) & there & ~unseen;
    return shape;
}

/* Rows of the spherical harmonics of the Gaussians at `row`. */
TD_INLINE td_sh_source td_sh_source_of(TD_GLOBAL const td_view *view, const td_image *image, const td_source *source,
                                       td_index row) {
    td_sh_source sh;
    sh.sh = source->sh;
    sh.rates = source->sh_rates;
    if (td_moving(image) && source->moved)
        row = td_gather_ints(source->owners, 2 * td_not_below_0(row - source->first_moved) + 1);
    sh.index = row * image->sh_stride;
    sh.rate_index = td_not_below_0(row - source->first_rate) * image->sh_stride;
    sh.moving = td_moving(image) && source->sh_rated;
    sh.floor = view->colour_floor;
    return sh;
}

/* From the eye to the Gaussian's origin, along axis j of the object's coordinates. */
TD_INLINE td_dual td_from_eye(TD_GLOBAL const td_view *view, const td_image *image, const td_gaussian *gaussian, int j) {
    int origin = td_moving(image) ? TD_G_ORIGIN : TD_G_MEAN; /* equal for Gaussians at rest, and the mean is loaded already */
    return td_dual_sub(td_number_of(gaussian, image, origin + j), td_dual_all(view->eye[j], view->eye_dot[j]));
}

/* The colours seen along the unit direction from the eye to the origins of the Gaussians at `row`, clamped at `floor`. */
TD_INLINE td_colour td_project_colour_above(TD_GLOBAL const td_view *view, const td_image *image, const td_source *source,
                                            const td_gaussian *gaussian, td_index row, td_real floor) {
    const td_dual d[3] = {td_from_eye(view, image, gaussian, 0), td_from_eye(view, image, gaussian, 1),
                          td_from_eye(view, image, gaussian, 2)};
    /* A Gaussian at the eye itself is behind the near plane. The offset only keeps 1/length finite. */
    td_dual length = td_dual_sqrt(td_dual_offset(td_dual_dot3(d, d), TD_REAL(1e-30)));
    td_dual inverse = td_dual_reciprocal(length);
    td_sh_source sh = td_sh_source_of(view, image, source, row);
    sh.floor = floor;
    return td_sh_colour(td_dual_mul(d[0], inverse), td_dual_mul(d[1], inverse), td_dual_mul(d[2], inverse), &sh,
                        td_sh_degree(image));
}

/* The colours that td_project_colour_above computes, clamped at the floor of the object's method. */
TD_INLINE td_colour td_project_colour(TD_GLOBAL const td_view *view, const td_image *image, const td_source *source,
                                      const td_gaussian *gaussian, td_index row) {
    return td_project_colour_above(view, image, source, gaussian, row, view->colour_floor);
}

#endif
