/* Rows of moving Gaussians, interpolated between two times at which they are known: the cubic through both rows and their rates
 * (Hermite), with its derivative as the rates. Its error is estimated too.
 *
 * The host computes the weights in double, since they are equal for all rows of a time. With the step h between the two times
 * and s in [0, 1], value = v0 + W (v1 - v0) + W0 r0 + W1 r1. The rate is r = W' (v1 - v0) + W0' r0 + W1' r1. */
#ifndef TD_INTERPOLATE_H
#define TD_INTERPOLATE_H

#include "motion.h"
#include "sweep.h"
#include "transpose.h"

/* The weights of a time: TD_CUBIC_REALS reals. */
typedef struct td_cubic {
    td_real way, start, end;             /* W [1], W0, W1 [s] */
    td_real way_dot, start_dot, end_dot; /* their derivatives */
} td_cubic;

TD_INLINE td_dual td_cubic_at(const td_cubic *cubic, td_dual from, td_dual to) {
    td_lanes way = to.v - from.v;
    return td_dual_make(td_fma(way, cubic->way, td_fma(from.d, cubic->start, td_fma(to.d, cubic->end, from.v))),
                        td_fma(way, cubic->way_dot, td_fma(from.d, cubic->start_dot, to.d * cubic->end_dot)));
}

/* The arrays of all rows. Rates of geometry and SH begin with row `first_rate`. */
typedef struct td_row_arrays {
    TD_GLOBAL td_real *geometry, *rates; /* TD_GEOMETRY_STRIDE each */
    TD_GLOBAL td_real *sh, *sh_rates;    /* sh_stride each */
    int first_rate, sh_stride;
} td_row_arrays;

/* Geometry of one row, as one vector: its 16 entries are neighbours. */
TD_INLINE void td_cubic_geometry(const td_cubic *cubic, const td_row_arrays *rows, int from, int to, int row) {
    int rate0 = (from - rows->first_rate) * TD_GEOMETRY_STRIDE, rate1 = (to - rows->first_rate) * TD_GEOMETRY_STRIDE;
    for (int k = 0; k < TD_GEOMETRY_STRIDE; k += TD_LANES) {
        td_dual a =
            td_dual_make(td_load_lanes(rows->geometry + from * TD_GEOMETRY_STRIDE + k), td_load_lanes(rows->rates + rate0 + k));
        td_dual b =
            td_dual_make(td_load_lanes(rows->geometry + to * TD_GEOMETRY_STRIDE + k), td_load_lanes(rows->rates + rate1 + k));
        td_dual x = td_cubic_at(cubic, a, b);
        td_store_lanes(rows->geometry + row * TD_GEOMETRY_STRIDE + k, x.v);
        td_store_lanes(rows->rates + (row - rows->first_rate) * TD_GEOMETRY_STRIDE + k, x.d);
    }
}

/* Entry k of the spherical harmonics of the rows at `row`. */
TD_INLINE td_dual td_sh_entry(const td_row_arrays *rows, td_index row, int k) {
    return td_dual_make(td_gather(rows->sh, row * rows->sh_stride + k),
                        td_gather(rows->sh_rates, (row - rows->first_rate) * rows->sh_stride + k));
}

/* TD_LANES rows of a job, from its entry i on. */
TD_INLINE void td_cubic_group(const td_cubic *cubic, TD_GLOBAL const int *places, const td_cubic_job *job, int i,
                              const td_row_arrays *rows) {
    TD_GLOBAL const int *place = places + job->first + i;
    int row = job->row + i;
    for (int lane = 0; lane < TD_LANES; lane++)
        td_cubic_geometry(cubic, rows, job->from + place[lane], job->to + place[lane], row + lane);
    if (!job->moves_sh) return;
    td_index at = td_load_ints(place);
    for (int k = 0; k < rows->sh_stride; k++) {
        td_dual x = td_cubic_at(cubic, td_sh_entry(rows, job->from + at, k), td_sh_entry(rows, job->to + at, k));
        td_scatter(rows->sh + row * rows->sh_stride, rows->sh_stride, k, x.v);
        td_scatter(rows->sh_rates + (row - rows->first_rate) * rows->sh_stride, rows->sh_stride, k, x.d);
    }
}

/* -- the misfit ---------------------------------------------------------------------------------------------------- */

/* Units in which the misfit of interpolation is measured. */
typedef struct td_misfit_terms {
    td_real duration;       /* from the first row to the last [s] */
    td_real tolerance;      /* of log_luminance */
    td_real time_tolerance; /* of when it is reached [s]; 0: not asked for */
    td_cubic middle;
    int moves_sh;
} td_misfit_terms;

/* By how much the cubic through both ends misses the row in the middle: in value, and in rate times half the interval. Where
 * a row is smooth, the rate's part is 0 to leading order. It shows kinks of a network with ReLU a quarter of the interval
 * from the middle, which leave the middle's value right. With this weight the sum bounds the error of the two halves' cubics
 * at a kink, to within a tenth. Where rows are smooth, the halves' cubics are 16 times more accurate than the sum says. */
TD_INLINE td_lanes td_cubic_stray(const td_misfit_terms *terms, td_dual start, td_dual middle, td_dual end) {
    td_dual cubic = td_cubic_at(&terms->middle, start, end);
    return td_fma(td_splat(0.5f * terms->duration), td_size(middle.d - cubic.d), td_size(middle.v - cubic.v));
}

/* Euclidean length of td_cubic_stray over `count` entries of geometry from `first` on. */
TD_INLINE td_lanes td_stray_length(const td_misfit_terms *terms, const td_source *source, const td_image *image,
                                   const td_index index[3], int first, int count) {
    td_lanes sum = td_splat(0.0f);
    for (int k = first; k < first + count; k++) {
        td_lanes stray = td_cubic_stray(terms, td_entry(source, image, index[0], k), td_entry(source, image, index[1], k),
                                        td_entry(source, image, index[2], k));
        sum = td_fma(stray, stray, sum);
    }
    return td_sqrt(sum);
}

/* Square of the shortest axis, which is the least column of the factor M; `rate` gets the length of M's rate. */
TD_INLINE td_lanes td_shortest_axis(const td_source *source, const td_image *image, td_index index, td_lanes *rate) {
    td_lanes least = td_splat(0.0f), sum = td_splat(0.0f);
    for (int j = 0; j < 3; j++) {
        td_lanes axis = td_splat(0.0f);
        for (int k = 0; k < 3; k++) {
            td_dual m = td_entry(source, image, index, TD_G_FACTOR + 3 * k + j);
            axis = td_fma(m.v, m.v, axis);
            sum = td_fma(m.d, m.d, sum);
        }
        least = j ? td_smaller(least, axis) : axis;
    }
    *rate = td_sqrt(sum);
    return least;
}

/* Pixels per unit of length at the Gaussians: the greatest of three times. `view` is the object's view at the first time. */
TD_INLINE td_lanes td_pixels_per_unit(TD_GLOBAL const td_view *view, const td_image *image, const td_source *source,
                                      const td_index index[3]) {
    td_lanes nearest = td_splat(0.0f);
    td_real scale = 0, focal = image->fx > image->fy ? image->fx : image->fy;
    if (td_lens_model(image)) focal = focal * image->lens.stretch;
    for (int i = 0; i < 3; i++) {
        TD_GLOBAL const td_view *at = view + i * image->objects;
        td_dual mean[3];
        for (int k = 0; k < 3; k++) mean[k] = td_entry(source, image, index[i], TD_G_MEAN + k);
        td_lanes depth = td_view_row(at->r + 6, at->r_dot + 6, image, mean, at->t[2], at->t_dot[2]).v;
        nearest = i ? td_smaller(nearest, depth) : depth;
    }
    for (int k = 0; k < 3; k++) scale += view->r[6 + k] * view->r[6 + k]; /* the square of the object's scale */
    nearest = td_larger(nearest, td_splat(image->near > TD_REAL(1e-3) ? image->near : TD_REAL(1e-3)));
    return focal * td_sqrt(td_splat(scale)) / nearest;
}

/* Error of log_luminance from colours: the sum of td_cubic_stray over all SH coefficients, over the luminance of the constant
 * term. A basis function up to degree 4 is at most sqrt(9 / (4 pi)), by the addition theorem. */
TD_INLINE td_lanes td_colour_stray(const td_misfit_terms *terms, const td_image *image, const td_row_arrays *rows,
                                   const td_index row[3]) {
    td_lanes sum = td_splat(0.0f), luminance = td_splat(image->transfer.dark);
    for (int k = 0; k < rows->sh_stride; k++) {
        td_dual middle = td_sh_entry(rows, row[1], k);
        td_lanes stray = td_cubic_stray(terms, td_sh_entry(rows, row[0], k), middle, td_sh_entry(rows, row[2], k));
        sum = td_fma(td_splat(image->luminance[k % 3]), stray, sum);
        if (k < 3) {
            td_lanes colour = td_larger(td_fma(middle.v, TD_REAL(0.28209479177387814), td_splat(0.5f)), td_splat(0.0f));
            luminance = td_fma(colour, image->luminance[k], luminance);
        }
    }
    return TD_REAL(0.8462843753216345) * sum / luminance;
}

/* Misfit of TD_LANES Gaussians of an object. Their rows are neighbours, from row[0] on at an interval's start, row[1] in its
 * middle, row[2] at its end. The misfit is the possible error of log_luminance within the halves, in tolerances. Up to 1 the
 * host interpolates; above, it computes more rows.
 *
 * The worst case is a splat that is as bright as all that is seen there, before black or the reverse. Then log_luminance
 * changes by the change of splat_alpha. That is at most e^(-1/2) opacity du / sigma for a shift of the mean (one standard
 * deviation out), 2/e opacity times the relative change of the axes, and the change of opacity. sigma is that of the shortest
 * axis on the screen. The error of a crossing's time is this change over the rate of splat_alpha. */
TD_INLINE td_lanes td_misfit_group(TD_GLOBAL const td_view *views, const td_image *image, const td_source *all,
                                   TD_GLOBAL const int *object, const td_row_arrays *rows, const int row[3],
                                   const td_misfit_terms *terms) {
    td_source own = td_source_of(all, image, row[0]);
    td_index at[3], index[3];
    for (int i = 0; i < 3; i++) {
        at[i] = td_count_from(row[i]);
        index[i] = at[i] * TD_GEOMETRY_STRIDE;
    }
    TD_GLOBAL const td_view *view = views + object[td_owner_of(&own, row[0])];
    td_lanes pixels = td_pixels_per_unit(view, image, &own, index), factor_dot;
    td_lanes axis = td_shortest_axis(&own, image, index[1], &factor_dot);
    td_lanes sigma = td_sqrt(td_fma(pixels * pixels, axis, td_splat(image->dilation + TD_REAL(1e-6))));
    td_lanes shift = td_stray_length(terms, &own, image, index, TD_G_MEAN, 3);
    td_lanes shape = td_stray_length(terms, &own, image, index, TD_G_FACTOR, 9);
    td_lanes faint = td_stray_length(terms, &own, image, index, TD_G_OPACITY, 1);
    td_dual opacity = td_entry(&own, image, index[1], TD_G_OPACITY);
    td_lanes across = opacity.v * pixels / sigma;
    td_lanes stray = td_fma(across, td_fma(TD_REAL(0.7357588823428847), shape, TD_REAL(0.6065306597126334) * shift), faint);
    if (terms->moves_sh) stray += td_colour_stray(terms, image, rows, at);
    td_lanes misfit = image->transfer.steepest * stray / terms->tolerance;
    if (!(terms->time_tolerance > 0)) return misfit;
    td_lanes speed = td_splat(0.0f);
    for (int k = 0; k < 3; k++) {
        td_dual mean = td_entry(&own, image, index[1], TD_G_MEAN + k);
        speed = td_fma(mean.d, mean.d, speed);
    }
    td_lanes change = td_fma(TD_REAL(0.7357588823428847), factor_dot, TD_REAL(0.6065306597126334) * td_sqrt(speed));
    change = td_fma(across, change, td_size(opacity.d));
    td_lanes late = stray / td_larger(terms->time_tolerance * change, td_splat(TD_REAL(1e-30)));
    return td_larger(misfit, td_select(late, td_splat(0.0f), stray <= 0.0f));
}

#endif
