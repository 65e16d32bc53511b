/* Projects all Gaussians with their rates, sixteen at a time. Its input are arrays of sixteen numbers of one kind, its results
 * records of single splats. Invisible splats are dropped before their colour is computed. */
#include "limit_parts.h"

static const float near_plane = 0.2f;

/* Numbers of the frame and the object, which all its Gaussians share. */
typedef struct scenery {
    float r[9], r_dot[9], t[3], t_dot[3];
    float eye[3], eye_dot[3]; /* in the object's coordinates */
    float limit_x, limit_y;   /* of x/z and y/z in the Jacobian */
} scenery;

static scenery scenery_of(const limit *l, const limit_view *view) {
    scenery s;
    double size2 = 0;
    for (int k = 0; k < 9; k++) s.r[k] = (float)view->r[k], s.r_dot[k] = (float)view->r_dot[k];
    for (int k = 0; k < 3; k++) s.t[k] = (float)view->t[k], s.t_dot[k] = (float)view->t_dot[k];
    for (int k = 0; k < 3; k++) size2 += view->r[k] * view->r[k];
    for (int k = 0; k < 3; k++) { /* eye = -R^T t / |r|^2, as R is a rotation times a number */
        double eye = 0, eye_dot = 0;
        for (int i = 0; i < 3; i++) {
            eye -= view->r[3 * i + k] * view->t[i];
            eye_dot -= view->r_dot[3 * i + k] * view->t[i] + view->r[3 * i + k] * view->t_dot[i];
        }
        s.eye[k] = (float)(eye / size2), s.eye_dot[k] = (float)(eye_dot / size2);
    }
    s.limit_x = (float)(1.3 * 0.5 * l->setup.width / l->setup.fx);
    s.limit_y = (float)(1.3 * 0.5 * l->setup.height / l->setup.fy);
    return s;
}

/* A row of the view times a point that rests in its object. */
LIMIT_INLINE dual view_row(const scenery *s, int i, const vec p[3], int rates) {
    dual sum = make(splat(s->t[i]), splat(rates ? s->t_dot[i] : 0));
    for (int j = 0; j < 3; j++) {
        sum.v += s->r[3 * i + j] * p[j];
        if (rates) sum.d += s->r_dot[3 * i + j] * p[j];
    }
    return sum;
}

LIMIT_INLINE dual clamp_slope(dual x, float most) {
    const mask inside = above(x.v, splat(-most)) & above(splat(most), x.v);
    return make(smaller(larger(x.v, splat(-most)), splat(most)), keep(inside, x.d));
}

/* The splats of a group. */
typedef struct shapes {
    dual u, v, a, b, c, inverse, z; /* inverse: 1 / determinant */
    mask visible;
} shapes;

/* Rows of A = J R M, the factor on the screen. */
LIMIT_INLINE void project_factor(const limit *l, const scenery *s, const float *g, dual x_z, dual y_z, dual inverse_z,
                                 int rates, dual a[2][3]) {
    const dual slopes[2] = {clamp_slope(x_z, s->limit_x), clamp_slope(y_z, s->limit_y)};
    const float focal[2] = {(float)l->setup.fx, (float)l->setup.fy};
    for (int i = 0; i < 2; i++) {
        const dual f_z = scale(inverse_z, focal[i]);
        for (int j = 0; j < 3; j++) a[i][j] = make(splat(0), splat(0));
        for (int k = 0; k < 3; k++) {
            const dual row = make(splat(s->r[3 * i + k]), splat(rates ? s->r_dot[3 * i + k] : 0));
            const dual depth = make(splat(s->r[6 + k]), splat(rates ? s->r_dot[6 + k] : 0));
            const dual t = mul(f_z, sub(row, mul(slopes[i], depth)));
            for (int j = 0; j < 3; j++) {
                const vec m = load(g + LANES * (G_FACTOR + 3 * k + j));
                a[i][j].v += t.v * m;
                if (rates) a[i][j].d += t.d * m;
            }
        }
    }
}

LIMIT_INLINE dual dot3(const dual a[3], const dual b[3]) { return add(mul(a[0], b[0]), add(mul(a[1], b[1]), mul(a[2], b[2]))); }

/* Returns 0 if no Gaussian of the group is in front of the camera. */
LIMIT_INLINE int shape_of(const limit *l, const scenery *s, const float *g, int rates, shapes *out) {
    vec mean[3];
    dual a[2][3];
    for (int k = 0; k < 3; k++) mean[k] = load(g + LANES * (G_MEAN + k));
    out->z = view_row(s, 2, mean, rates);
    out->visible = above(out->z.v, splat(near_plane)) & above(load(g + LANES * G_REACH), splat(0));
    if (!any(out->visible)) return 0;
    const dual safe = make(choose(out->visible, out->z.v, splat(1)), out->z.d);
    const dual inverse_z = reciprocal(safe);
    const dual x_z = mul(view_row(s, 0, mean, rates), inverse_z), y_z = mul(view_row(s, 1, mean, rates), inverse_z);
    out->u = scale(x_z, (float)l->setup.fx), out->v = scale(y_z, (float)l->setup.fy);
    out->u.v += (float)l->setup.cx, out->v.v += (float)l->setup.cy;
    project_factor(l, s, g, x_z, y_z, inverse_z, rates, a);
    const float dilation = (float)l->setup.dilation;
    const dual xx = dot3(a[0], a[0]), yy = dot3(a[1], a[1]);
    out->a = make(xx.v + dilation, xx.d), out->b = dot3(a[0], a[1]), out->c = make(yy.v + dilation, yy.d);
    /* |a0 x a1|^2 is the determinant without cancellation (kernels/projection.h). */
    dual det = make(dilation * (xx.v + yy.v) + dilation * dilation, dilation * (xx.d + yy.d));
    for (int j = 0; j < 3; j++) {
        const int k = (j + 1) % 3, i = (j + 2) % 3;
        const dual n = sub(mul(a[0][k], a[1][i]), mul(a[0][i], a[1][k]));
        det = add(det, mul(n, n));
    }
    out->inverse = reciprocal(det);
    return 1;
}

/* Tiles [first, end) that lie within both the ellipse's box and INRIA's square of three sigma, along one axis. */
LIMIT_INLINE void tiles_reached(vec centre, vec reach, vec square, int tiles, ivec *first, ivec *end) {
    const vec low = larger((centre - reach) * (1.0f / TILE), (centre - 0.5f - square) * (1.0f / TILE));
    const vec high = smaller((centre + reach) * (1.0f / TILE) + 1.0f, (centre - 0.5f + square + 15.0f) * (1.0f / TILE));
    const vec none = splat(0), most = splat((float)tiles);
    *first = __builtin_convertvector(smaller(larger(low, none), most), ivec);
    *end = __builtin_convertvector(smaller(larger(high, none), most), ivec);
}

LIMIT_INLINE dual direction_term(float number, dual a, dual b) { return scale(mul(a, b), number); }

/* Adds the basis times the coefficients of band k to the colour. */
LIMIT_INLINE void add_band(dual colour[3], dual basis, const float *sh, int k, int rates) {
    for (int c = 0; c < 3; c++) {
        const vec h = load(sh + LANES * (3 * k + c));
        colour[c].v += basis.v * h;
        if (rates) colour[c].d += basis.d * h;
    }
}

LIMIT_INLINE void add_degree_2_and_3(dual colour[3], dual x, dual y, dual z, const float *sh, int bands, int rates) {
    const dual xx = mul(x, x), yy = mul(y, y), zz = mul(z, z), xy = mul(x, y), yz = mul(y, z), xz = mul(x, z);
    const dual xx_yy = sub(xx, yy);
    add_band(colour, scale(xy, 1.0925484305920792f), sh, 4, rates);
    add_band(colour, scale(yz, -1.0925484305920792f), sh, 5, rates);
    add_band(colour, scale(sub(scale(zz, 2), add(xx, yy)), 0.31539156525252005f), sh, 6, rates);
    add_band(colour, scale(xz, -1.0925484305920792f), sh, 7, rates);
    add_band(colour, scale(xx_yy, 0.5462742152960396f), sh, 8, rates);
    if (bands <= 9) return;
    const dual zz4 = sub(scale(zz, 4), add(xx, yy));
    add_band(colour, direction_term(-0.5900435899266435f, y, sub(scale(xx, 3), yy)), sh, 9, rates);
    add_band(colour, direction_term(2.890611442640554f, xy, z), sh, 10, rates);
    add_band(colour, direction_term(-0.4570457994644658f, y, zz4), sh, 11, rates);
    add_band(colour, direction_term(0.3731763325901154f, z, sub(scale(zz, 2), scale(add(xx, yy), 3))), sh, 12, rates);
    add_band(colour, direction_term(-0.4570457994644658f, x, zz4), sh, 13, rates);
    add_band(colour, direction_term(1.445305721320277f, z, xx_yy), sh, 14, rates);
    add_band(colour, direction_term(-0.5900435899266435f, x, sub(xx, scale(yy, 3))), sh, 15, rates);
}

/* Luminance of the colour that the eye sees. Channels below 0 count as 0. */
LIMIT_INLINE dual luminance_of(const limit *l, const scenery *s, const float *g, const float *sh, int bands, int rates) {
    dual colour[3], sum = make(splat(0), splat(0));
    for (int c = 0; c < 3; c++) colour[c] = make(splat(0.5f) + 0.28209479177387814f * load(sh + LANES * c), splat(0));
    if (bands > 1) {
        dual d[3];
        for (int k = 0; k < 3; k++) d[k] = make(load(g + LANES * (G_MEAN + k)) - s->eye[k], splat(rates ? -s->eye_dot[k] : 0));
        const dual size2 = dot3(d, d);
        const vec inverse = 1.0f / root(size2.v);
        const dual unit = make(inverse, -0.5f * size2.d * inverse * inverse * inverse);
        const dual x = mul(d[0], unit), y = mul(d[1], unit), z = mul(d[2], unit);
        add_band(colour, scale(y, -0.4886025119029199f), sh, 1, rates);
        add_band(colour, scale(z, 0.4886025119029199f), sh, 2, rates);
        add_band(colour, scale(x, -0.4886025119029199f), sh, 3, rates);
        if (bands > 4) add_degree_2_and_3(colour, x, y, z, sh, bands, rates);
    }
    for (int c = 0; c < 3; c++) {
        const mask lit = above(colour[c].v, splat(0));
        sum.v += (float)l->setup.luminance[c] * keep(lit, colour[c].v);
        if (rates) sum.d += (float)l->setup.luminance[c] * keep(lit, colour[c].d);
    }
    return sum;
}

/* Transposes sixteen vectors. A step interleaves halves, and four steps do it all. */
LIMIT_INLINE void turn_over(vec m[LANES]) {
    for (int step = 0; step < 4; step++) {
        vec n[LANES];
        for (int i = 0; i < LANES / 2; i++) {
            n[2 * i] = __builtin_shufflevector(m[i], m[i + 8], 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
            n[2 * i + 1] =
                __builtin_shufflevector(m[i], m[i + 8], 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
        }
        for (int i = 0; i < LANES; i++) m[i] = n[i];
    }
}

LIMIT_INLINE void lay_record(const shapes *p, const float *g, dual luminance, int rates, vec entry[LANES]) {
    const float half_log2_e = 0.72134752044448170368f;
    const dual qxx = mul(p->c, p->inverse), qxy = mul(p->b, p->inverse),
               qyy = mul(p->a, p->inverse); /* qxy: without its sign */
    entry[0] = p->u.v, entry[1] = p->v.v;
    entry[2] = -half_log2_e * qxx.v, entry[3] = 2 * half_log2_e * qxy.v, entry[4] = -half_log2_e * qyy.v;
    entry[5] = load(g + LANES * G_LOG2_OPACITY);
    entry[6] = luminance.v, entry[7] = luminance.d;
    entry[8] = splat(0);
    entry[9] = rates ? qxx.v * p->u.d - qxy.v * p->v.d : splat(0);
    entry[10] = rates ? qyy.v * p->v.d - qxy.v * p->u.d : splat(0);
    entry[11] = -0.5f * qxx.d, entry[12] = qxy.d, entry[13] = -0.5f * qyy.d;
}

/* Projects one group. Writes its visible splats from `record` and `key` on, and returns their number. */
LIMIT_INLINE int64_t project_group(const limit *l, const scenery *s, const float *g, const float *sh, int bands, int rates,
                                   limit_record *record, uint32_t *key) {
    shapes p;
    vec entry[LANES];
    if (!shape_of(l, s, g, rates, &p)) return 0;
    ivec x0, y0, x1, y1;
    const vec reach = load(g + LANES * G_REACH), half_gap = 0.5f * (p.a.v - p.c.v);
    const vec widest = 0.5f * (p.a.v + p.c.v) + root(larger(half_gap * half_gap + p.b.v * p.b.v, splat(0.1f)));
    /* The next whole number, for squares below 2^22. */
    const vec sigmas = smaller(3.0f * root(widest), splat(1e6f)), near = (sigmas + 12582912.0f) - 12582912.0f;
    const vec square = near + keep(above(sigmas, near), splat(1));
    tiles_reached(p.u.v, reach * root(p.a.v) * 1.0001f + 0.01f, square, l->tiles_x, &x0, &x1);
    tiles_reached(p.v.v, reach * root(p.c.v) * 1.0001f + 0.01f, square, l->tiles_y, &y0, &y1);
    const uint32_t seen = bits(p.visible & above(__builtin_convertvector(x1 - x0, vec), splat(0)) &
                               above(__builtin_convertvector(y1 - y0, vec), splat(0)));
    if (!seen) return 0;
    lay_record(&p, g, luminance_of(l, s, g, sh, bands, rates), rates, entry);
    entry[14] = from_bits(x0 | y0 << 16), entry[15] = from_bits(x1 | y1 << 16);
    turn_over(entry);
    const ivec depth = bits_of(p.z.v);
    int64_t count = 0;
    for (uint32_t rest = seen; rest; rest &= rest - 1) {
        const int lane = __builtin_ctz(rest);
        memcpy(&record[count], &entry[lane], sizeof *record);
        key[count++] = (uint32_t)depth[lane];
    }
    return count;
}

LIMIT_INLINE void project_part(limit *l, const limit_part *part, int32_t which, int32_t first, int32_t end, int rates,
                               limit_worker *w) {
    const scenery s = scenery_of(l, &l->views[which]);
    for (int32_t i = first; i < end; i++) {
        const float *g = part->geometry + (size_t)i * GEOMETRY * LANES, *sh = part->sh + (size_t)i * 3 * part->bands * LANES;
        const int64_t at = w->first_splat + w->splats;
        limit_record *record = &l->records[at];
        uint32_t *key = &l->keys[0][at];
        switch (part->bands) { /* with a constant number of bands the code has no branches */
            case 1: w->splats += project_group(l, &s, g, sh, 1, rates, record, key); break;
            case 4: w->splats += project_group(l, &s, g, sh, 4, rates, record, key); break;
            case 9: w->splats += project_group(l, &s, g, sh, 9, rates, record, key); break;
            default: w->splats += project_group(l, &s, g, sh, 16, rates, record, key);
        }
    }
}

void limit_project(limit *l, int32_t thread) {
    limit_worker *w = &l->workers[thread];
    const int32_t first = (int32_t)((int64_t)l->groups * thread / l->threads);
    const int32_t end = (int32_t)((int64_t)l->groups * (thread + 1) / l->threads);
    w->first_splat = (int64_t)first * LANES;
    w->splats = 0;
    for (int32_t k = 0; k < l->part_count; k++) {
        const limit_part *part = &l->parts[k];
        const int32_t from = first > part->first_group ? first - part->first_group : 0;
        const int32_t to = end - part->first_group < part->groups ? end - part->first_group : part->groups;
        if (l->rates)
            project_part(l, part, k, from, to, 1, w);
        else
            project_part(l, part, k, from, to, 0, w);
    }
}
