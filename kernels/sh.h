/* Colour of a Gaussian from its spherical harmonics (SH), and the rate of that colour (paper, Sec. 3.2). The rate comes from a
 * view direction d that turns, and from SH coefficients that change in time. Each channel is max(floor, 1/2 + sum_k Y_k(d)
 * sh_k), with floor 0 in 3DGS. The basis Y_k has the order, signs and constants of INRIA's code (Kerbl et al. 2023); degree 4
 * is as in gsplat. */
#ifndef TD_SH_H
#define TD_SH_H

#include "dual.h"
#include "transpose.h"

/* Type of the stored SH coefficients: td_real, or float in programs that define TD_BUILD_SH_FLOAT. Such a program reads the
 * floats of the scene itself, and widens them as it loads them. */
#ifdef TD_BUILD_SH_FLOAT
typedef float td_sh_real;
#else
typedef td_real td_sh_real;
#endif
TD_INLINE td_lanes td_gather_sh(TD_GLOBAL const td_sh_real *array, td_index i) { return TD_GATHER(td_lanes, array, i); }

typedef struct td_colour {
    td_dual channel[3];
} td_colour;

/* Where the SH coefficients of TD_LANES Gaussians are stored, one Gaussian for each lane. Coefficient k of a channel is
 * sh[index + 3 k + channel]. Where `moving`, its rate [1/s] is rates[rate_index + 3 k + channel]. */
typedef struct td_sh_source {
    TD_GLOBAL const td_sh_real *sh;
    TD_GLOBAL const td_real *rates;
    td_index index, rate_index;
    int moving;
    td_real floor; /* lower bound of each colour channel (TD_NO_FLOOR: none) */
} td_sh_source;

/* td_sh_numbers gives entry 3 k + channel of the SH coefficients of TD_LANES Gaussians, and the entry's rate. Rates are valid
 * only where `moving`. With one lane it is only the source, and entries are read when they are needed. With more lanes all
 * entries are loaded in advance. */
#if TD_LANES == 1

typedef td_sh_source td_sh_numbers;

TD_INLINE void td_load_sh(const td_sh_source *source, int count, td_sh_numbers *numbers) {
    (void)count;
    *numbers = *source;
}
TD_INLINE td_lanes td_sh_value(const td_sh_numbers *sh, int k) { return td_gather_sh(sh->sh, sh->index + k); }
TD_INLINE td_lanes td_sh_rate(const td_sh_numbers *sh, int k) { return td_gather(sh->rates, sh->rate_index + k); }

#else

enum { TD_SH_ROOM = 80 }; /* 3 channels x 25 coefficients of degree 4, rounded up to rows of TD_ROW = 16 */

typedef struct td_sh_numbers {
    td_lanes v[TD_SH_ROOM], d[TD_SH_ROOM];
    int moving;
} td_sh_numbers;

#if defined(TD_BUILD_SH_FLOAT) && defined(TD_REAL_DOUBLE)
TD_INLINE void td_load_sh_square(TD_GLOBAL const float *from, td_index index, td_lanes entry[TD_LANES]) {
#define TD_LOAD_SH(lane, letter) entry[lane] = td_load_floats(from + index.s##letter);
    TD_EACH_LANE(TD_LOAD_SH)
    td_transpose(entry);
}
#else
#define td_load_sh_square td_load_square
#endif

/* Loads `count` entries of each Gaussian, rounded up to whole rows of 16. The last row may reach up to 15 entries past the end
 * of the buffer. That is safe: TD_BUFFER_SLACK bytes behind every buffer can be read. */
TD_INLINE void td_load_sh(const td_sh_source *source, int count, td_sh_numbers *numbers) {
    numbers->moving = source->moving;
#define TD_LOAD_SH_PART(k) td_load_sh_square(source->sh + (first + (k)), source->index, numbers->v + (first + (k)));
#define TD_LOAD_SH_ROW(from)                                                                            \
    if ((from) < count) {                                                                               \
        const int first = (from);                                                                       \
        TD_EACH_SQUARE(TD_LOAD_SH_PART)                                                                 \
        if (source->moving) td_load_row(source->rates + first, source->rate_index, numbers->d + first); \
    }
    TD_LOAD_SH_ROW(0) TD_LOAD_SH_ROW(16) TD_LOAD_SH_ROW(32) TD_LOAD_SH_ROW(48) TD_LOAD_SH_ROW(64)
}
TD_INLINE td_lanes td_sh_value(const td_sh_numbers *sh, int k) { return sh->v[k]; }
TD_INLINE td_lanes td_sh_rate(const td_sh_numbers *sh, int k) { return sh->d[k]; }

#endif

/* channel += basis * entry k */
TD_INLINE td_dual td_sh_add_to(td_dual channel, td_dual basis, const td_sh_numbers *sh, int k) {
    channel = td_dual_fma_still(basis, td_sh_value(sh, k), channel);
    if (sh->moving) channel.d = td_fma(basis.v, td_sh_rate(sh, k), channel.d);
    return channel;
}

/* colour += basis * coefficient k */
TD_INLINE void td_sh_add(td_colour *colour, td_dual basis, const td_sh_numbers *sh, int k) {
    colour->channel[0] = td_sh_add_to(colour->channel[0], basis, sh, 3 * k);
    colour->channel[1] = td_sh_add_to(colour->channel[1], basis, sh, 3 * k + 1);
    colour->channel[2] = td_sh_add_to(colour->channel[2], basis, sh, 3 * k + 2);
}

/* Products of the components of the unit view direction, which several SH degrees use. */
typedef struct td_sh_direction {
    td_dual x, y, z, xx, yy, zz, xy, yz, xz;
} td_sh_direction;

TD_INLINE td_dual td_sh_term(td_real number, td_dual a, td_dual b) { return td_dual_scale(td_dual_mul(a, b), number); }

TD_INLINE void td_sh_degree_1(td_colour *colour, const td_sh_direction *d, const td_sh_numbers *sh) {
    td_sh_add(colour, td_dual_scale(d->y, -TD_REAL(0.4886025119029199)), sh, 1);
    td_sh_add(colour, td_dual_scale(d->z, TD_REAL(0.4886025119029199)), sh, 2);
    td_sh_add(colour, td_dual_scale(d->x, -TD_REAL(0.4886025119029199)), sh, 3);
}

TD_INLINE void td_sh_degree_2(td_colour *colour, const td_sh_direction *d, const td_sh_numbers *sh) {
    td_dual xx_yy = td_dual_sub(d->xx, d->yy);
    td_dual zz2 = td_dual_sub(td_dual_sub(td_dual_scale(d->zz, 2), d->xx), d->yy);
    td_sh_add(colour, td_dual_scale(d->xy, TD_REAL(1.0925484305920792)), sh, 4);
    td_sh_add(colour, td_dual_scale(d->yz, -TD_REAL(1.0925484305920792)), sh, 5);
    td_sh_add(colour, td_dual_scale(zz2, TD_REAL(0.31539156525252005)), sh, 6);
    td_sh_add(colour, td_dual_scale(d->xz, -TD_REAL(1.0925484305920792)), sh, 7);
    td_sh_add(colour, td_dual_scale(xx_yy, TD_REAL(0.5462742152960396)), sh, 8);
}

TD_INLINE void td_sh_degree_3(td_colour *colour, const td_sh_direction *d, const td_sh_numbers *sh) {
    td_dual xx_yy = td_dual_sub(d->xx, d->yy);
    td_dual xx3_yy = td_dual_sub(td_dual_scale(d->xx, 3), d->yy);
    td_dual xx_yy3 = td_dual_sub(d->xx, td_dual_scale(d->yy, 3));
    td_dual zz4 = td_dual_sub(td_dual_sub(td_dual_scale(d->zz, 4), d->xx), d->yy);
    td_dual zz2 = td_dual_plus(td_dual_plus(td_dual_scale(d->zz, 2), -3, d->xx), -3, d->yy);
    td_sh_add(colour, td_sh_term(-TD_REAL(0.5900435899266435), d->y, xx3_yy), sh, 9);
    td_sh_add(colour, td_sh_term(TD_REAL(2.890611442640554), d->xy, d->z), sh, 10);
    td_sh_add(colour, td_sh_term(-TD_REAL(0.4570457994644658), d->y, zz4), sh, 11);
    td_sh_add(colour, td_sh_term(TD_REAL(0.3731763325901154), d->z, zz2), sh, 12);
    td_sh_add(colour, td_sh_term(-TD_REAL(0.4570457994644658), d->x, zz4), sh, 13);
    td_sh_add(colour, td_sh_term(TD_REAL(1.445305721320277), d->z, xx_yy), sh, 14);
    td_sh_add(colour, td_sh_term(-TD_REAL(0.5900435899266435), d->x, xx_yy3), sh, 15);
}

TD_INLINE void td_sh_degree_4(td_colour *colour, const td_sh_direction *d, const td_sh_numbers *sh) {
    td_dual xx_yy = td_dual_sub(d->xx, d->yy);
    td_dual xx3_yy = td_dual_sub(td_dual_scale(d->xx, 3), d->yy);
    td_dual xx_yy3 = td_dual_sub(d->xx, td_dual_scale(d->yy, 3));
    td_dual zz7_1 = td_dual_offset(td_dual_scale(d->zz, 7), -1);
    td_dual zz7_3 = td_dual_offset(td_dual_scale(d->zz, 7), -3);
    td_dual zonal = td_dual_offset(td_dual_mul(d->zz, td_dual_offset(td_dual_scale(d->zz, 35), -30)), 3);
    td_dual sectoral = td_dual_sub(td_dual_mul(d->xx, xx_yy3), td_dual_mul(d->yy, xx3_yy));
    td_sh_add(colour, td_sh_term(TD_REAL(2.5033429417967046), d->xy, xx_yy), sh, 16);
    td_sh_add(colour, td_sh_term(-TD_REAL(1.7701307697799304), d->yz, xx3_yy), sh, 17);
    td_sh_add(colour, td_sh_term(TD_REAL(0.9461746957575601), d->xy, zz7_1), sh, 18);
    td_sh_add(colour, td_sh_term(-TD_REAL(0.6690465435572892), d->yz, zz7_3), sh, 19);
    td_sh_add(colour, td_dual_scale(zonal, TD_REAL(0.10578554691520431)), sh, 20);
    td_sh_add(colour, td_sh_term(-TD_REAL(0.6690465435572892), d->xz, zz7_3), sh, 21);
    td_sh_add(colour, td_sh_term(TD_REAL(0.47308734787878004), xx_yy, zz7_1), sh, 22);
    td_sh_add(colour, td_sh_term(-TD_REAL(1.7701307697799304), d->xz, xx_yy3), sh, 23);
    td_sh_add(colour, td_dual_scale(sectoral, TD_REAL(0.6258357354491761)), sh, 24);
}

TD_INLINE td_dual td_sh_floor(td_dual channel, td_real floor) {
    td_mask dark = channel.v <= floor; /* false for NaN, so a NaN stays a NaN */
    return td_dual_select(channel, td_dual_make(td_splat(floor), td_splat(0.0f)), dark);
}

/* Colour seen along the unit direction (x, y, z). Clamped channels have rate 0. */
TD_INLINE td_colour td_sh_colour(td_dual x, td_dual y, td_dual z, const td_sh_source *source, int degree) {
    td_colour colour;
    td_sh_numbers sh;
    td_load_sh(source, 3 * (degree + 1) * (degree + 1), &sh);
    colour.channel[0] = colour.channel[1] = colour.channel[2] = td_dual_make(td_splat(0.5f), td_splat(0.0f));
    td_sh_add(&colour, td_dual_make(td_splat(TD_REAL(0.28209479177387814)), td_splat(0.0f)), &sh, 0);
    td_sh_direction d;
    d.x = x, d.y = y, d.z = z;
    if (degree > 0) td_sh_degree_1(&colour, &d, &sh);
    if (degree > 1) {
        d.xx = td_dual_mul(x, x), d.yy = td_dual_mul(y, y), d.zz = td_dual_mul(z, z);
        d.xy = td_dual_mul(x, y), d.yz = td_dual_mul(y, z), d.xz = td_dual_mul(x, z);
        td_sh_degree_2(&colour, &d, &sh);
    }
    if (degree > 2) td_sh_degree_3(&colour, &d, &sh);
    if (degree > 3) td_sh_degree_4(&colour, &d, &sh);
    colour.channel[0] = td_sh_floor(colour.channel[0], source->floor);
    colour.channel[1] = td_sh_floor(colour.channel[1], source->floor);
    colour.channel[2] = td_sh_floor(colour.channel[2], source->floor);
    return colour;
}

#endif
