/* Ground truth of what is seen: optical flow, depth, normal and object of each pixel, with the image's blend weights.
 *
 * A splat covers pixels that show different parts of it. Its Gaussian is c + F xi in camera coordinates, xi standard normal.
 * p = c + F xi is the same material point at all times, so that p_dot = c_dot + F_dot xi. Points on a pixel's ray, (x/z,
 * y/z) = (rx, ry), satisfy two equations B xi = e with the rows
 *   b0 = F0 - rx F2,  b1 = F1 - ry F2,   e = (rx c2 - c0, ry c2 - c1).
 * Of these the pixel shows the densest, which has the least |xi|: with n = b0 x b1
 *   xi = (e0 (b1 x n) - e1 (b0 x n)) / |n|^2.
 * That is exact in perspective (the splat's weight isn't): a plane of flat splats has a plane's depth and flow at every pixel,
 * to rounding. A point's normal is that of the level surface of density which the ray touches there, K (rx, ry, 1) with
 * K = adj(F F^T). For a flat splat it is the splat's normal, for a ball the direction to the eye. */
#ifndef TD_TRUTH_H
#define TD_TRUTH_H

#include "block.h"
#include "projection.h"
#include "transpose.h"

/* A splat's surface: two records of 16 reals, places and rates. F and its rate are multiplied by `scale`, a power of two that
 * makes F's largest entry 1 to 2, so that products of four entries stay in single precision. */
enum {
    TD_S_C = 0, /* 3: the centre in camera coordinates [scene units] */
    TD_S_F = 3, /* 9: its factor there, row by row */
    TD_S_OBJECT = 12,
    TD_S_K = 13, /* K: xx, xy, xz here; yy, yz, zz at TD_S_K_REST of the rates' record */
    TD_S_K_REST = 12,
    TD_S_SCALE = 15 /* in the rates' record */
};

enum { TD_TRUTH_OBJECTS = 8 }; /* objects whose weights are summed in one pass over the splats */

/* Limit of |xi|^2 over d^T Q d at the pixel, with Q of the dilated splat. Only splats thinner than 0.3 px exceed it.
 * Dilation shows these where they are not: a disc seen from its edge would reach to the horizon. MIDDLE is added to d^T Q d
 * for rounding of 0 in single precision. */
#define TD_TRUTH_REACH TD_REAL(4.0)
#define TD_TRUTH_MIDDLE TD_REAL(1e-3)

/* The transmittance below which splats behind change no digit of the result. */
#ifdef TD_REAL_DOUBLE
#define TD_TRUTH_FAINT 1e-16
#else
#define TD_TRUTH_FAINT 1e-7f
#endif

/* -- surfaces ------------------------------------------------------------------------------------------------------ */

typedef struct td_surfaces {
    TD_GLOBAL td_real *places, *rates; /* 16 each per record */
} td_surfaces;

/* F = R M in the camera's coordinates, and its rate. */
TD_INLINE void td_camera_factor(TD_GLOBAL const td_view *view, const td_source *source, const td_image *image, td_index index,
                                td_dual f[9]) {
    for (int i = 0; i < 9; i++) f[i] = td_dual_make(td_splat(0.0f), td_splat(0.0f));
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 3; j++) {
            td_dual m = td_entry(source, image, index, TD_G_FACTOR + 3 * k + j);
            for (int i = 0; i < 3; i++) {
                td_dual r = td_dual_make(td_splat(view->r[3 * i + k]), td_splat(view->r_dot[3 * i + k]));
                f[3 * i + j] = td_dual_fma(r, m, f[3 * i + j]);
            }
        }
}

/* The power of two by which F is multiplied; 1 for a Gaussian without extent. */
TD_INLINE td_lanes td_surface_scale(const td_dual f[9]) {
    td_lanes largest = td_splat(0.0f);
    for (int i = 0; i < 9; i++) largest = td_larger(largest, td_size(f[i].v));
    td_mask some = (largest > TD_REAL(1e-30)) & (largest < TD_REAL(1e30));
    return td_select(td_splat(1.0f), td_inverse_power(td_select(td_splat(1.0f), largest, some)), some);
}

/* K from F: the sum over pairs of columns of n n^T, n their cross product. */
TD_INLINE void td_surface_normals(const td_dual f[9], td_lanes k[6]) {
    for (int i = 0; i < 6; i++) k[i] = td_splat(0.0f);
    for (int j = 0; j < 3; j++) {
        int l = (j + 1) % 3;
        td_lanes x = td_fma(f[3 + j].v, f[6 + l].v, -(f[6 + j].v * f[3 + l].v));
        td_lanes y = td_fma(f[6 + j].v, f[l].v, -(f[j].v * f[6 + l].v));
        td_lanes z = td_fma(f[j].v, f[3 + l].v, -(f[3 + j].v * f[l].v));
        k[0] = td_fma(x, x, k[0]), k[1] = td_fma(x, y, k[1]), k[2] = td_fma(x, z, k[2]);
        k[3] = td_fma(y, y, k[3]), k[4] = td_fma(y, z, k[4]), k[5] = td_fma(z, z, k[5]);
    }
}

/* Stores surfaces of TD_LANES candidates. `broken` ones, whose projection isn't finite, are NaN. */
TD_INLINE void td_store_surfaces(TD_GLOBAL const td_view *view, const td_image *image, const td_source *source,
                                 td_index gaussian, td_mask broken, int object, const td_surfaces *to) {
    td_index index = td_not_below_0(gaussian) * TD_GEOMETRY_STRIDE;
    td_dual mean[3], f[9];
    td_lanes place[16], rate[16], k[6];
    for (int j = 0; j < 3; j++) mean[j] = td_entry(source, image, index, TD_G_MEAN + j);
    for (int i = 0; i < 3; i++) {
        td_dual c = td_view_row(view->r + 3 * i, view->r_dot + 3 * i, image, mean, view->t[i], view->t_dot[i]);
        place[TD_S_C + i] = td_select(c.v, td_not_a_number(), broken);
        rate[TD_S_C + i] = c.d;
    }
    td_camera_factor(view, source, image, index, f);
    td_lanes scale = td_surface_scale(f);
    for (int i = 0; i < 9; i++) {
        f[i] = td_dual_times(f[i], scale);
        place[TD_S_F + i] = f[i].v;
        rate[TD_S_F + i] = f[i].d;
    }
    td_surface_normals(f, k);
    for (int i = 0; i < 3; i++) place[TD_S_K + i] = k[i], rate[TD_S_K_REST + i] = k[3 + i];
    place[TD_S_OBJECT] = td_splat((td_real)object);
    rate[TD_S_SCALE] = scale;
    td_store_records(to->places, place);
    td_store_records(to->rates, rate);
}

/* Stores surfaces of candidates [first, first + TD_LANES) of a job whose records are made. `numbers`: for each object of the
 * store, its number in the scene. */
TD_INLINE void td_surface_group(const td_job *job, int first, TD_GLOBAL const int *candidates, TD_GLOBAL const int *object,
                                TD_GLOBAL const int *numbers, TD_GLOBAL const td_view *views, const td_image *image,
                                const td_source *source, TD_GLOBAL const td_real *records, TD_GLOBAL const int *masks,
                                const td_surfaces *all) {
    int at = job->records + first, leader = candidates[job->candidates + (first & ~(TD_PAD - 1))];
    if (!td_any((td_load_ints(masks + at) & job->blocks) != 0)) return; /* no block that is asked for has any of these */
    td_source own = td_source_of(source, image, leader);
    int number = object[td_owner_of(&own, leader)];
    td_index lanes = td_count_from(0) * TD_RECORD_STRIDE;
    td_mask broken = td_is_broken(td_gather(records + at * TD_RECORD_STRIDE, lanes + TD_R_LUMINANCE));
    td_surfaces to = {all->places + at * TD_RECORD_STRIDE, all->rates + at * TD_RECORD_STRIDE};
    td_store_surfaces(views + job->slot * image->objects + number, image, &own,
                      td_load_ints(candidates + job->candidates + first), broken, numbers[number], &to);
}

/* -- at pixels ----------------------------------------------------------------------------------------------------- */

/* The point of a splat that each pixel shows: flow [px/s], depth, normal; or weighted sums of these. */
typedef struct td_seen {
    td_lanes u, v, z, nx, ny, nz;
    td_lanes weight;
} td_seen;

/* TD_LANES pixels, composited as far as one place of the list. */
typedef struct td_truth {
    td_lanes x, y, rx, ry;          /* pixel centres [px]; x/z and y/z of their rays */
    td_lanes xx, xy, yx, yy;        /* Dd of a lens at the rays; unused without one */
    td_lanes transmittance, behind; /* T, and what it would be in hard order */
    td_seen sums;
    td_lanes median, splat; /* depth of the first splat that took T below a half, and its place in the job; 0 and -1 before */
    td_mask live;
} td_truth;

/* Weights of each of `count` objects from number `first` on; `density`: those of splats that take out light now. */
typedef struct td_objects {
    int first, count;
    td_lanes *weight, *density;
} td_objects;

TD_INLINE td_lanes td_dot_row(TD_GLOBAL const td_real *row, td_lanes x, td_lanes y, td_lanes z, td_real offset) {
    return td_fma(td_splat(row[0]), x, td_fma(td_splat(row[1]), y, td_fma(td_splat(row[2]), z, td_splat(offset))));
}

/* The xi that a pixel shows. */
TD_INLINE void td_seen_point(TD_GLOBAL const td_real *place, td_real scale, td_lanes reach, const td_truth *pixels,
                             td_lanes xi[3]) {
    TD_GLOBAL const td_real *c = place + TD_S_C, *f = place + TD_S_F;
    td_lanes rx = pixels->rx, ry = pixels->ry;
    td_lanes p0 = td_fma(-rx, f[6], f[0]), p1 = td_fma(-rx, f[7], f[1]), p2 = td_fma(-rx, f[8], f[2]);
    td_lanes q0 = td_fma(-ry, f[6], f[3]), q1 = td_fma(-ry, f[7], f[4]), q2 = td_fma(-ry, f[8], f[5]);
    td_lanes e0 = td_fma(rx, c[2], td_splat(-c[0])), e1 = td_fma(ry, c[2], td_splat(-c[1]));
    td_lanes n0 = td_fma(p1, q2, -(p2 * q1)), n1 = td_fma(p2, q0, -(p0 * q2)), n2 = td_fma(p0, q1, -(p1 * q0));
    td_lanes size = td_fma(n0, n0, td_fma(n1, n1, n2 * n2));
    td_lanes s0 = td_fma(e0, q0, -(e1 * p0)), s1 = td_fma(e0, q1, -(e1 * p1)), s2 = td_fma(e0, q2, -(e1 * p2));
    td_mask edge = size < TD_REAL(1e-30); /* at a needle's tip or a disc's edge xi isn't defined */
    td_lanes inverse = td_select(1 / td_select(size, td_splat(1.0f), edge), td_splat(0.0f), edge);
    xi[0] = td_fma(s1, n2, -(s2 * n1)) * inverse;
    xi[1] = td_fma(s2, n0, -(s0 * n2)) * inverse;
    xi[2] = td_fma(s0, n1, -(s1 * n0)) * inverse;
    td_lanes way = td_fma(xi[0], xi[0], td_fma(xi[1], xi[1], xi[2] * xi[2])) * (scale * scale);
    td_mask far = way > reach;
    if (!td_any(far)) return; /* nearly always: roots and divisions take long */
    td_lanes back = td_select(td_splat(1.0f), td_sqrt(reach / td_select(td_splat(1.0f), way, far)), far);
    for (int j = 0; j < 3; j++) xi[j] = xi[j] * back;
}

/* A pinhole's flow carried through the lens: K Dd K^-1. */
TD_INLINE void td_seen_through(const td_image *image, const td_truth *pixels, td_seen *seen) {
    td_lanes x = seen->u / image->fx, y = seen->v / image->fy;
    seen->u = td_fma(pixels->xx, x, pixels->xy * y) * image->fx;
    seen->v = td_fma(pixels->yx, x, pixels->yy * y) * image->fy;
}

/* The point of a splat that each pixel shows; |xi|^2 is at most `reach`. */
TD_INLINE td_seen td_seen_at(TD_GLOBAL const td_real *place, TD_GLOBAL const td_real *rate, td_lanes reach,
                             const td_image *image, const td_truth *pixels) {
    TD_GLOBAL const td_real *f_dot = rate + TD_S_F, *k = place + TD_S_K, *rest = rate + TD_S_K_REST;
    td_lanes xi[3];
    td_seen seen;
    td_seen_point(place, rate[TD_S_SCALE], reach, pixels, xi);
    td_lanes z = td_dot_row(place + TD_S_F + 6, xi[0], xi[1], xi[2], place[TD_S_C + 2]);
    seen.z = td_select(z, td_splat(image->near), z < image->near);
    td_lanes x_dot = td_dot_row(f_dot, xi[0], xi[1], xi[2], rate[TD_S_C]);
    td_lanes y_dot = td_dot_row(f_dot + 3, xi[0], xi[1], xi[2], rate[TD_S_C + 1]);
    td_lanes z_dot = td_dot_row(f_dot + 6, xi[0], xi[1], xi[2], rate[TD_S_C + 2]);
    td_lanes inverse = 1 / seen.z;
    seen.u = td_fma(-pixels->rx, z_dot, x_dot) * (inverse * image->fx);
    seen.v = td_fma(-pixels->ry, z_dot, y_dot) * (inverse * image->fy);
    if (td_lens_model(image)) td_seen_through(image, pixels, &seen);
    td_lanes nx = td_fma(pixels->rx, k[0], td_fma(pixels->ry, k[1], td_splat(k[2])));
    td_lanes ny = td_fma(pixels->rx, k[1], td_fma(pixels->ry, rest[0], td_splat(rest[1])));
    td_lanes nz = td_fma(pixels->rx, k[2], td_fma(pixels->ry, rest[1], td_splat(rest[2])));
    td_lanes size = td_fma(nx, nx, td_fma(ny, ny, nz * nz));
    td_mask none = size < TD_REAL(1e-36);
    td_lanes turn = td_select(-1 / td_sqrt(td_select(size, td_splat(1.0f), none)), td_splat(0.0f), none);
    seen.nx = nx * turn, seen.ny = ny * turn, seen.nz = nz * turn;
    seen.weight = td_splat(1.0f);
    return seen;
}

/* to += w from */
TD_INLINE void td_seen_add(td_seen *to, td_lanes w, const td_seen *from) {
    to->u = td_fma(w, from->u, to->u), to->v = td_fma(w, from->v, to->v), to->z = td_fma(w, from->z, to->z);
    to->nx = td_fma(w, from->nx, to->nx), to->ny = td_fma(w, from->ny, to->ny), to->nz = td_fma(w, from->nz, to->nz);
    to->weight = td_fma(w, from->weight, to->weight);
}
TD_INLINE void td_seen_fall(td_seen *sums, td_real left) {
    sums->u = sums->u * left, sums->v = sums->v * left, sums->z = sums->z * left;
    sums->nx = sums->nx * left, sums->ny = sums->ny * left, sums->nz = sums->nz * left;
    sums->weight = sums->weight * left;
}
TD_INLINE td_seen td_seen_nothing(void) {
    td_seen none;
    none.u = none.v = none.z = none.nx = none.ny = none.nz = none.weight = td_splat(0.0f);
    return none;
}

/* -- blending: the image's own weights, without their rates -------------------------------------------------------- */

/* tau, 0 where the pixel doesn't blend this splat. The stop rule BOUND isn't applied here. */
TD_INLINE td_lanes td_truth_alpha(TD_GLOBAL const td_real *record, const td_image *image, td_truth *pixels, td_lanes *reach) {
    td_lanes dx = pixels->x - record[TD_R_U], dy = pixels->y - record[TD_R_V], tau, unused;
    td_lanes power = td_fma(record[TD_R_QYY] * dy, dy, record[TD_R_LOG2_OPACITY]);
    power = td_fma(dx, td_fma(record[TD_R_QXX], dx, record[TD_R_QXY] * dy), power);
    td_lanes out = (record[TD_R_LOG2_OPACITY] - power) * TD_REAL(1.38629436111989061883); /* 2 ln 2: d^T Q d */
    *reach = TD_TRUTH_REACH * (td_larger(out, td_splat(0.0f)) + TD_TRUTH_MIDDLE);
    td_mask seen;
    td_cap_alpha(image, td_exp2(power), td_splat(0.0f), &tau, &unused, &seen);
    td_lanes before = td_soft_order(image) ? pixels->behind : pixels->transmittance;
    if (td_drops_splats(image)) {
        td_mask on = td_above_stop(image, before * (1 - tau), td_splat(image->stop));
        pixels->live = td_select_mask(pixels->live, pixels->live & on, seen);
        seen = seen & pixels->live;
    }
    tau = td_select(td_splat(0.0f), tau, seen);
    pixels->behind = td_fma(-pixels->behind, tau, pixels->behind);
    return tau;
}

/* Finds the splat with the median depth, in hard order. In soft order coplanar splats take light together, and the last of them
 * may not be at the pixel. */
TD_INLINE void td_truth_pass(const td_seen *seen, td_real place, td_lanes before, td_truth *pixels) {
    td_mask crossed = (before >= 0.5f) & (pixels->behind < 0.5f);
    pixels->median = td_select(pixels->median, seen->z, crossed);
    pixels->splat = td_select(pixels->splat, td_splat(place), crossed);
}

/* Soft order: light passes one step. T falls, and the splats that take light now are added with the weight W. */
TD_INLINE void td_truth_go(td_real m, td_real left, td_seen *open, const td_objects *objects, td_truth *pixels) {
    td_lanes t = pixels->transmittance, after = t * td_exp2(open->weight * (-m * TD_REAL(1.44269504088896340736)));
    td_lanes w = (t - after) / (open->weight + TD_REAL(1e-20));
    td_seen_add(&pixels->sums, w, open);
    td_seen_fall(open, left);
    for (int i = 0; i < objects->count; i++) {
        objects->weight[i] = td_fma(w, objects->density[i], objects->weight[i]);
        objects->density[i] = objects->density[i] * left;
    }
    pixels->transmittance = after;
}

/* Blends a splat in hard order. */
TD_INLINE void td_truth_blend(const td_seen *seen, td_lanes tau, int object, const td_objects *objects, td_truth *pixels) {
    td_lanes w = pixels->transmittance * tau;
    td_seen_add(&pixels->sums, w, seen);
    if (object >= 0 && object < objects->count) objects->weight[object] = objects->weight[object] + w;
    pixels->transmittance = pixels->transmittance - w;
}

/* Blends a splat that some pixels see. In soft order (`soft`) it begins to take light; otherwise it takes all its light at
 * once. */
TD_INLINE void td_truth_splat(const td_surfaces *surfaces, const td_image *image, int place, td_lanes tau, td_lanes before,
                              td_lanes reach, int soft, td_seen *open, const td_objects *objects, td_truth *pixels) {
    TD_GLOBAL const td_real *at = surfaces->places + place * TD_RECORD_STRIDE;
    td_seen seen = td_seen_at(at, surfaces->rates + place * TD_RECORD_STRIDE, reach, image, pixels);
    int object = (int)at[TD_S_OBJECT] - objects->first;
    td_truth_pass(&seen, (td_real)place, before, pixels);
    if (!soft) {
        td_truth_blend(&seen, tau, object, objects, pixels);
        return;
    }
    td_lanes a, a_dot;
    td_optical_depth(tau, td_splat(0.0f), &a, &a_dot);
    td_seen_add(open, a, &seen);
    if (object >= 0 && object < objects->count) objects->density[object] = objects->density[object] + a;
}

/* Composites the splats of a block, front to back, and returns their number. */
TD_INLINE int td_truth_list(const td_list *list, const td_surfaces *surfaces, const td_image *image, int block,
                            const td_objects *objects, td_truth *pixels) {
    int blended = 0, is_open = 0;
    td_seen open = td_seen_nothing();
    td_finder finder;
    td_group group;
    td_soft_steps steps;
    td_finder_start(list, block, &finder);
    for (td_next_group(list, image, block, &finder, &group); group.count > 0;
         td_next_group(list, image, block, &finder, &group)) {
        if (td_soft_order(image)) td_soft_measure(list, image, &group, &steps);
        for (int k = 0; k < group.count; k++) { /* prefetched: waiting for them took a third of the time */
            td_prefetch(surfaces->places + group.row[k] * TD_RECORD_STRIDE);
            td_prefetch(surfaces->rates + group.row[k] * TD_RECORD_STRIDE);
        }
        for (int k = 0; k < group.count; k++) {
            int near = 0;
            td_real m = 1, left = 0;
            if (td_soft_order(image)) near = steps.near[k], m = steps.m[k], left = steps.left[k];
            int soft = near || is_open;
            td_lanes before = pixels->behind, reach;
            td_lanes tau = td_truth_alpha(td_list_record(list, group.row[k]), image, pixels, &reach);
            if (td_any(tau != 0.0f)) /* no pixel sees it otherwise */
                td_truth_splat(surfaces, image, group.row[k], tau, before, reach, soft, &open, objects, pixels);
            if (soft && m != 0) td_truth_go(m, left, &open, objects, pixels);
            is_open = near;
            if ((++blended & 7) != 0) continue;
            td_mask bright = pixels->transmittance > TD_TRUTH_FAINT;
            pixels->transmittance = td_select(td_splat(0.0f), pixels->transmittance, bright);
            if (!is_open && !td_any(bright & pixels->live)) return blended;
        }
    }
    return blended;
}

TD_INLINE void td_truth_start(td_truth *pixels, td_lanes x, td_lanes y, const td_image *image) {
    pixels->x = x;
    pixels->y = y;
    td_ray_of(image, x, y, &pixels->rx, &pixels->ry);
    pixels->xx = pixels->xy = pixels->yx = pixels->yy = td_splat(0.0f);
    if (td_lens_model(image)) {
        td_bent bent = td_bend(image, td_still(pixels->rx), td_still(pixels->ry));
        pixels->xx = bent.xx.v, pixels->xy = bent.xy.v, pixels->yx = bent.yx.v, pixels->yy = bent.yy.v;
    }
    pixels->transmittance = pixels->behind = td_splat(1.0f);
    pixels->sums = td_seen_nothing();
    pixels->median = td_splat(0.0f);
    pixels->splat = td_splat(-1.0f);
    pixels->live = x == x;
}

/* Stores weighted means, and the values that one splat has, in planes TD_BLOCK_PIXELS apart. */
TD_INLINE void td_truth_store(const td_truth *pixels, td_lanes instance, TD_GLOBAL td_real *out) {
    const td_seen *sums = &pixels->sums;
    td_mask some = (sums->weight > 0.0f) | td_is_broken(sums->z); /* where z isn't finite the mean is NaN */
    td_lanes none = td_splat(0.0f), inverse = 1 / td_select(td_splat(1.0f), sums->weight, some);
    td_lanes size = td_fma(sums->nx, sums->nx, td_fma(sums->ny, sums->ny, sums->nz * sums->nz));
    td_mask turned = size > 0.0f;
    td_lanes turn = td_select(none, 1 / td_sqrt(td_select(td_splat(1.0f), size, turned)), turned);
    td_store_lanes(out + TD_TRUTH_U * TD_BLOCK_PIXELS, td_select(none, sums->u * inverse, some));
    td_store_lanes(out + TD_TRUTH_V * TD_BLOCK_PIXELS, td_select(none, sums->v * inverse, some));
    td_store_lanes(out + TD_TRUTH_DEPTH * TD_BLOCK_PIXELS, td_select(none, sums->z * inverse, some));
    td_store_lanes(out + TD_TRUTH_MEDIAN * TD_BLOCK_PIXELS, pixels->median);
    td_store_lanes(out + TD_TRUTH_ALPHA * TD_BLOCK_PIXELS, 1 - pixels->transmittance);
    td_store_lanes(out + TD_TRUTH_INSTANCE * TD_BLOCK_PIXELS, instance);
    td_store_lanes(out + TD_TRUTH_NX * TD_BLOCK_PIXELS, sums->nx * turn);
    td_store_lanes(out + TD_TRUTH_NY * TD_BLOCK_PIXELS, sums->ny * turn);
    td_store_lanes(out + TD_TRUTH_NZ * TD_BLOCK_PIXELS, sums->nz * turn);
    td_store_lanes(out + TD_TRUTH_SPLAT * TD_BLOCK_PIXELS, pixels->splat);
}

/* Composites pixels [first, first + TD_LANES) of block `block` of a job. `objects`: number of objects in the scene. There is
 * one pass over the splats for every TD_TRUTH_OBJECTS objects; a single object needs no sums. */
TD_INLINE int td_truth_block(const td_job *job, const td_list *list, const td_surfaces *surfaces, const td_image *image,
                             int objects, int block, int first, TD_GLOBAL td_real *out) {
    td_lanes weight[TD_TRUTH_OBJECTS], density[TD_TRUTH_OBJECTS], x, y, best = td_splat(0.0f), instance = td_splat(-1.0f);
    td_truth pixels;
    td_objects some;
    int blended = 0;
    td_block_offsets(first, &x, &y);
    x = x + ((td_real)(job->x + 4 * (block & 3)) + 0.5f);
    y = y + ((td_real)(job->y + 4 * (block >> 2)) + 0.5f);
    some.weight = weight;
    some.density = density;
    some.first = 0;
    do {
        int left = objects - some.first;
        some.count = objects == 1 ? 0 : left < TD_TRUTH_OBJECTS ? left : TD_TRUTH_OBJECTS;
        for (int i = 0; i < some.count; i++) weight[i] = density[i] = td_splat(0.0f);
        td_truth_start(&pixels, x, y, image);
        blended += td_truth_list(list, surfaces, image, block, &some, &pixels);
        for (int i = 0; i < some.count; i++) {
            td_mask more = weight[i] > best;
            instance = td_select(instance, td_splat((td_real)(some.first + i)), more);
            best = td_larger(weight[i], best);
        }
        some.first += TD_TRUTH_OBJECTS;
    } while (some.first < objects);
    if (objects == 1) instance = td_select(instance, td_splat(0.0f), pixels.sums.weight > 0.0f);
    td_truth_store(&pixels, instance, out);
    return blended;
}

#endif
