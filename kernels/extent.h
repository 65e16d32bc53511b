/* Which pixels a splat may reach: its screen box, and the 4x4 blocks of a tile that its ellipse touches. */
#ifndef TD_EXTENT_H
#define TD_EXTENT_H

#include "projection.h"

/* Largest whole number not above x, for |x| < 2^22. PoCL's floor() is a slow function call. */
TD_INLINE td_lanes td_floor(td_lanes x) {
#ifdef TD_REAL_DOUBLE
    td_real magic = 6755399441055744.0; /* 1.5 * 2^52 */
#else
    td_real magic = 12582912.0f; /* 1.5 * 2^23 */
#endif
    td_lanes nearest = (x + magic) - magic;
    return nearest - td_select(td_splat(0.0f), td_splat(1.0f), nearest > x);
}
TD_INLINE td_lanes td_ceil(td_lanes x) { return -td_floor(-x); }

/* Half-widths of the box around the splat [px], rounded up: a block too many costs time, and one too few would cut a visible
 * splat. */
TD_INLINE void td_half_widths(const td_shape *shape, td_lanes *rx, td_lanes *ry) {
    td_lanes power = td_larger(shape->power, td_splat(0.0f));
    *rx = td_fma(td_sqrt(power * shape->a.v), TD_REAL(1.0001), TD_REAL(0.01));
    *ry = td_fma(td_sqrt(power * shape->c.v), TD_REAL(1.0001), TD_REAL(0.01));
}

/* The extent of a splat in pixels: equal for all tiles. */
typedef struct td_extent {
    td_lanes u, v, rx, ry;     /* centre and half-widths of its box [px] */
    td_lanes slope, bend, end; /* of the ellipse's left and right side (td_extent_of) */
    td_lanes wide, high;       /* half-widths of the rule's rectangle [px], where the rule has one */
    td_mask visible;
} td_extent;

/* Half-widths by the two renderers' rules. INRIA: ceil(3 sqrt(lambda_max)), and a splat is seen only by the 16x16 tiles that
 * the square of that radius touches. gsplat: per axis ceil(min(3.33, sqrt(2 ln(255 opacity))) sqrt(cov_ii)). */
TD_INLINE void td_rectangle_of(const td_shape *shape, const td_image *image, td_extent *extent) {
    td_lanes rx, ry;
    if (td_extent_rule(image) == TD_EXTENT_INRIA) {
        td_lanes mid = 0.5f * (shape->a.v + shape->c.v);
        td_lanes half_gap = 0.5f * (shape->a.v - shape->c.v);
        td_lanes gap2 = td_fma(half_gap, half_gap, shape->b.v * shape->b.v); /* mid^2 - det */
        rx = 3.0f * td_sqrt(mid + td_sqrt(td_larger(gap2, td_splat(TD_REAL(0.1)))));
        ry = rx;
    } else {
        td_lanes sigmas = td_smaller(td_splat(TD_REAL(3.33)), td_sqrt(td_larger(shape->power, td_splat(0.0f))));
        rx = sigmas * td_sqrt(shape->a.v);
        ry = sigmas * td_sqrt(shape->c.v);
    }
    extent->wide = td_ceil(td_smaller(rx, td_splat(TD_REAL(1e6))));
    extent->high = td_ceil(td_smaller(ry, td_splat(TD_REAL(1e6))));
}

/* The ellipse's boundary is x(dy) = slope dy +- bend sqrt(ry^2 - dy^2) with slope = b/c. Its rightmost point lies at
 * dy = `end` = (b/a) rx, the leftmost at -`end`. */
TD_INLINE td_extent td_extent_of(const td_shape *shape, const td_image *image) {
    td_extent extent;
    extent.u = shape->u.v, extent.v = shape->v.v;
    td_half_widths(shape, &extent.rx, &extent.ry);
    extent.slope = shape->b.v / shape->c.v;
    extent.bend = td_sqrt(1.0f / (shape->c.v * shape->conic[0].v));
    extent.end = shape->b.v / shape->a.v * extent.rx;
    extent.wide = extent.high = td_splat(0.0f);
    if (td_extent_rule(image) != TD_EXTENT_ELLIPSE) td_rectangle_of(shape, image, &extent);
    extent.visible = shape->visible;
    return extent;
}

/* The mask of the Gaussians whose rectangle holds the tile. */
TD_INLINE td_mask td_rectangle_holds(const td_extent *extent, const td_image *image, int tile_x, int tile_y) {
    /* Tile borders against [u - r, u + r), rounded as the two renderers do. In INRIA's, pixel centres are whole numbers. */
    td_lanes shift = td_splat(td_extent_rule(image) == TD_EXTENT_INRIA ? TD_REAL(0.5) : TD_REAL(0.0));
    td_lanes u = extent->u - shift, v = extent->v - shift;
    td_real reach = td_extent_rule(image) == TD_EXTENT_INRIA ? TD_REAL(15.0) : TD_REAL(16.0);
    return (u - extent->wide < (td_real)(tile_x + TD_TILE)) & (u + extent->wide + reach >= (td_real)(tile_x + TD_TILE)) &
           (v - extent->high < (td_real)(tile_y + TD_TILE)) & (v + extent->high + reach >= (td_real)(tile_y + TD_TILE));
}

/* The x range of the ellipse within row j of a tile's blocks, as bits of these four blocks. */
TD_INLINE td_mask td_block_row(const td_extent *e, int tile_x, int tile_y, int j) {
    int y = tile_y + 4 * j;
    td_lanes from = (td_real)y + 0.5f - e->v, to = (td_real)y + 3.5f - e->v;
    td_mask touched = (from <= e->ry) & (to >= -e->ry);
    /* Each side is convex, so within the row it is extreme at the dy nearest to that of its extreme point. */
    td_lanes dy_right = td_smaller(td_larger(e->end, from), to), dy_left = td_smaller(td_larger(-e->end, from), to);
    td_lanes half_right = td_sqrt(td_larger(td_fma(e->ry, e->ry, -(dy_right * dy_right)), td_splat(0.0f)));
    td_lanes half_left = td_sqrt(td_larger(td_fma(e->ry, e->ry, -(dy_left * dy_left)), td_splat(0.0f)));
    td_lanes margin = td_fma(e->rx, TD_REAL(1e-4), TD_REAL(0.01));
    td_lanes right = td_fma(e->slope, dy_right, td_fma(e->bend, half_right, e->u + margin));
    td_lanes left = td_fma(e->slope, dy_left, e->u - margin - e->bend * half_left);
#define TD_BLOCK_BIT(i)                                                                                                \
    td_mask_bit(touched &(left <= (td_real)(tile_x + 4 * (i)) + 3.5f) & (right >= (td_real)(tile_x + 4 * (i)) + 0.5f), \
                1 << (4 * j + (i)))
    return TD_BLOCK_BIT(0) | TD_BLOCK_BIT(1) | TD_BLOCK_BIT(2) | TD_BLOCK_BIT(3);
}

/* 16 bits: bit 4 j + i says that the splat reaches block (i, j) of the tile. 0: not visible in this tile. */
TD_INLINE td_mask td_block_mask(const td_extent *extent, const td_image *image, int tile_x, int tile_y) {
    td_mask visible = extent->visible;
    if (td_extent_rule(image) != TD_EXTENT_ELLIPSE) visible = visible & td_rectangle_holds(extent, image, tile_x, tile_y);
    td_mask bits = td_block_row(extent, tile_x, tile_y, 0); /* no loop: LLVM wouldn't unroll it, nor that within */
    bits |= td_block_row(extent, tile_x, tile_y, 1);
    bits |= td_block_row(extent, tile_x, tile_y, 2);
    bits |= td_block_row(extent, tile_x, tile_y, 3);
    return td_mask_bit(visible, bits);
}

#endif
