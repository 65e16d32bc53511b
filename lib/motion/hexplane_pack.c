/* Packs 4DGaussians' deformation for its kernel: tables, weights, and a record for each Gaussian. Tables are the time planes,
 * reordered so that channels are neighbours. A record has the product of the space planes at the canonical mean, the raw
 * parameters, and the mean's places in the tables. */
#include "td_hexplane.h"

#include "td_dense.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int space_planes[3] = {0, 1, 3}, time_planes[3] = {2, 4, 5}; /* xy xz yz; xt yt zt */

/* State of packing. */
typedef struct packing {
    const tides_motion *motion;
    const tides_gaussians *gaussians;
    td_hexplane shape;
    int channels, features, width; /* padded; features: channels of all levels; width: hidden values of a layer */
    int rows;                      /* rows of the tables */
    int columns[TD_HEXPLANE_LEVELS_MAX][3];
    int stride, sh; /* numbers of a record; SH coefficients in it */
} packing;

/* A coordinate on an axis of `size` nodes: the node below it, and the fraction towards the next node. */
typedef struct place {
    int node;
    double fraction;
} place;

static int at_least_two(int count) { return count < 2 ? 2 : count; }

/* -- sizes --------------------------------------------------------------------------------------------------------- */

/* Rounds up to a multiple of TD_HEXPLANE_CHANNEL_PAD, so that vectors of channels are aligned in each part. */
static size_t padded_size(size_t size) {
    return (size + TD_HEXPLANE_CHANNEL_PAD - 1) / TD_HEXPLANE_CHANNEL_PAD * TD_HEXPLANE_CHANNEL_PAD;
}

static size_t table_size(const packing *p) {
    size_t columns = 0;
    for (int level = 0; level < p->shape.levels; level++)
        for (int axis = 0; axis < 3; axis++) columns += (size_t)p->columns[level][axis];
    return columns * (size_t)p->rows * (size_t)p->channels;
}

static int padded_outputs(int head) { return 1 << head == TD_HEAD_SH ? TD_HEXPLANE_SH_MAX : TD_DENSE_BLOCK; }

static size_t weights_size(const packing *p) {
    size_t size = td_dense_size(p->features, p->width) + (size_t)(p->shape.layers - 1) * td_dense_size(p->width, p->width);
    for (int head = 0; head < TD_HEADS; head++)
        if (p->shape.heads >> head & 1)
            size += td_dense_size(p->width, p->width) + td_dense_size(p->width, padded_outputs(head));
    return size;
}

static void plan(packing *p) {
    const td_hexplane *shape = &p->shape;
    int coefficients = p->gaussians->sh_degree + 1;
    p->channels = td_padded(shape->channels, TD_HEXPLANE_CHANNEL_PAD);
    p->features = shape->levels * p->channels;
    p->width = td_padded(shape->width, TD_DENSE_BLOCK);
    p->rows = at_least_two(shape->rows - td_hexplane_first_row(shape->rows));
    for (int level = 0; level < shape->levels; level++)
        for (int axis = 0; axis < 3; axis++) p->columns[level][axis] = at_least_two(shape->size[level][axis]);
    p->sh = shape->heads & TD_HEAD_SH ? 3 * coefficients * coefficients : 0;
    p->stride = td_padded(p->features + TD_HEXPLANE_PLACES + 6 * shape->levels + p->sh, TD_HEXPLANE_CHANNEL_PAD);
}

/* -- parts --------------------------------------------------------------------------------------------------------- */

/* The place of a coordinate on an axis: the box's first corner is -1, its second +1; outside it, the border's place. */
static place find_place(const packing *p, int axis, int size, double coordinate) {
    const float *box = td_motion_field(p->motion, "grid.aabb")->value;
    double from = box[axis], to = box[3 + axis];
    double along = ((coordinate - from) * 2 / (to - from) - 1 + 1) / 2 * (size - 1);
    double clamped = along < 0 ? 0 : along > size - 1 ? size - 1 : along;
    place found = {(int)clamped, 0};
    if (found.node > 0 && found.node == size - 1) found.node--;
    found.fraction = clamped - found.node;
    return found;
}

/* A coordinate of a canonical mean in the trainer's frame. */
static double coordinate_of(const packing *p, int64_t g, int axis) {
    return p->gaussians->origin[axis] + p->gaussians->mean[3 * g + axis];
}

/* Reorders a plane from (channel, row, column) to (row, column, channel): rows from `first` on. A missing row at the end
 * repeats the last one. */
static void turn_plane(const td_field *field, int first, int rows, int columns, int channels, double *to) {
    int height = (int)field->shape[2], width = (int)field->shape[3];
    for (int row = 0; row < rows; row++)
        for (int column = 0; column < columns; column++, to += channels) {
            size_t y = (size_t)(first + row < height ? first + row : height - 1);
            size_t x = (size_t)(column < width ? column : width - 1);
            for (size_t c = 0; c < field->shape[1]; c++) to[c] = field->value[(c * (size_t)height + y) * (size_t)width + x];
        }
}

static double *pack_tables(const packing *p, double *to) {
    int first = td_hexplane_first_row(p->shape.rows);
    for (int level = 0; level < p->shape.levels; level++)
        for (int axis = 0; axis < 3; axis++) {
            int columns = p->columns[level][axis];
            turn_plane(td_hexplane_plane(p->motion, level, time_planes[axis]), first, p->rows, columns, p->channels, to);
            to += (size_t)p->rows * (size_t)columns * (size_t)p->channels;
        }
    return to;
}

static double *pack_layer(const packing *p, const char *name, int rows, const int *order, int inputs, int outputs, double *to) {
    td_dense_layer layer = {NULL, NULL, rows, order, inputs, outputs};
    /* can't fail: measured before */
    if (td_dense_fields(p->motion, name, 0, 0, &layer.weight, &layer.bias, NULL) != TIDES_OK) return to;
    return td_dense_pack(&layer, to);
}

static double *pack_weights(const packing *p, double *to) {
    int input[TD_HEXPLANE_FEATURES_MAX], channels = p->shape.channels;
    char name[48];
    for (int i = 0; i < p->shape.levels * channels; i++) input[i] = i / channels * p->channels + i % channels;
    to = pack_layer(p, "feature_out.0", p->shape.width, input, p->features, p->width, to);
    for (int l = 1; l < p->shape.layers; l++) {
        snprintf(name, sizeof name, "feature_out.%d", 2 * l);
        to = pack_layer(p, name, p->shape.width, NULL, p->width, p->width, to);
    }
    for (int head = 0; head < TD_HEADS; head++) {
        static const int rows[TD_HEADS] = {3, 3, 4, 1, TD_HEXPLANE_SH_MAX};
        if (!(p->shape.heads >> head & 1)) continue;
        snprintf(name, sizeof name, "%s.1", td_hexplane_heads[head]);
        to = pack_layer(p, name, p->shape.width, NULL, p->width, p->width, to);
        snprintf(name, sizeof name, "%s.3", td_hexplane_heads[head]);
        to = pack_layer(p, name, rows[head], NULL, p->width, padded_outputs(head), to);
    }
    return to;
}

/* Multiplies product[channel] by the plane's bilinear value at (x, y). */
static void multiply_plane(const double *plane, int columns, int channels, place x, place y, double *product) {
    const double *a = plane + ((size_t)y.node * (size_t)columns + (size_t)x.node) * (size_t)channels;
    const double *b = a + (size_t)columns * (size_t)channels;
    for (int c = 0; c < channels; c++) {
        double below = a[c] + x.fraction * (a[channels + c] - a[c]), above = b[c] + x.fraction * (b[channels + c] - b[c]);
        product[c] *= below + y.fraction * (above - below);
    }
}

/* Writes the products of one level's space planes into all records. */
static tides_status pack_space(const packing *p, int level, double *records, tides_error *error) {
    static const int axes[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    for (int plane = 0; plane < 3; plane++) {
        int i = axes[plane][0], j = axes[plane][1], columns = p->columns[level][i], rows = p->columns[level][j];
        double *turned = td_alloc((size_t)columns * (size_t)rows * (size_t)p->channels, sizeof *turned, error);
        if (!turned) return TIDES_NO_MEMORY;
        turn_plane(td_hexplane_plane(p->motion, level, space_planes[plane]), 0, rows, columns, p->channels, turned);
        for (int64_t g = 0; g < p->gaussians->count; g++) {
            const double x = coordinate_of(p, g, i), y = coordinate_of(p, g, j);
            double *product = records + g * p->stride + level * p->channels;
            if (plane == 0)
                for (int c = 0; c < p->channels; c++) product[c] = 1;
            multiply_plane(turned, columns, p->channels, find_place(p, i, p->shape.size[level][i], x),
                           find_place(p, j, p->shape.size[level][j], y), product);
        }
        free(turned);
    }
    return TIDES_OK;
}

static void pack_record(const packing *p, int64_t g, double *raw) {
    const tides_gaussians *from = p->gaussians;
    for (int i = 0; i < 3; i++) {
        raw[TD_HEXPLANE_MEAN + i] = from->mean[3 * g + i];
        raw[TD_HEXPLANE_SCALE + i] = from->log_scale[3 * g + i];
    }
    for (int i = 0; i < 4; i++) raw[TD_HEXPLANE_ROTATION + i] = from->quaternion[4 * g + i];
    raw[TD_HEXPLANE_OPACITY] = from->opacity_logit[g];
    raw += TD_HEXPLANE_PLACES;
    for (int level = 0; level < p->shape.levels; level++)
        for (int axis = 0; axis < 3; axis++) {
            place found = find_place(p, axis, p->shape.size[level][axis], coordinate_of(p, g, axis));
            *raw++ = found.node;
            *raw++ = found.fraction;
        }
    for (int k = 0; k < p->sh; k++) raw[k] = from->sh[p->sh * g + k];
}

/* -- all ----------------------------------------------------------------------------------------------------------- */

static void set_own(const packing *p, size_t tables, size_t weights, td_mover_numbers *numbers) {
    int *own = numbers->own;
    own[TD_HEXPLANE_LEVELS] = p->shape.levels;
    own[TD_HEXPLANE_CHANNELS] = p->channels;
    own[TD_HEXPLANE_WIDTH] = p->width;
    own[TD_HEXPLANE_LAYERS] = p->shape.layers - 1;
    own[TD_HEXPLANE_HEADS] = p->shape.heads;
    own[TD_HEXPLANE_TURNS] = p->shape.turns;
    own[TD_HEXPLANE_TABLES] = 0;
    own[TD_HEXPLANE_ROWS] = p->rows;
    own[TD_HEXPLANE_WEIGHTS] = (int)tables;
    own[TD_HEXPLANE_RECORDS] = (int)(tables + weights);
    own[TD_HEXPLANE_STRIDE] = p->stride;
    own[TD_HEXPLANE_SH] = p->sh;
    for (int level = 0; level < p->shape.levels; level++)
        for (int axis = 0; axis < 3; axis++) own[TD_HEXPLANE_COLUMNS + 3 * level + axis] = p->columns[level][axis];
    numbers->moves_sh = p->sh > 0;
    snprintf(numbers->defines, sizeof numbers->defines,
             "#define TD_BUILD_HEXPLANE_WIDTH %d\n#define TD_BUILD_HEXPLANE_FEATURES %d\n", p->width, p->features);
}

tides_status td_hexplane_pack(const tides_motion *motion, const tides_gaussians *gaussians, td_mover_numbers *numbers,
                              tides_error *error) {
    packing p = {.motion = motion, .gaussians = gaussians};
    tides_status status = td_hexplane_measure(motion, &p.shape, error);
    if (status != TIDES_OK) return status;
    plan(&p);
    size_t tables = padded_size(table_size(&p)), weights = padded_size(weights_size(&p));
    double total = (double)tables + (double)weights + (double)p.stride * (double)gaussians->count;
    if (total > INT_MAX)
        return td_fail(error, TIDES_UNSUPPORTED, "hexplane motion: %lld Gaussians take %.3g numbers, at most %d are supported",
                       (long long)gaussians->count, total, INT_MAX);
    memset(numbers, 0, sizeof *numbers);
    numbers->data_count = (size_t)total;
    numbers->data = td_alloc(numbers->data_count, sizeof *numbers->data, error);
    if (!numbers->data) return TIDES_NO_MEMORY;
    set_own(&p, tables, weights, numbers);
    pack_tables(&p, numbers->data);
    pack_weights(&p, numbers->data + tables);
    double *records = numbers->data + tables + weights;
    for (int64_t g = 0; g < gaussians->count; g++) pack_record(&p, g, records + g * p.stride + p.features);
    for (int level = 0; level < p.shape.levels && status == TIDES_OK; level++) status = pack_space(&p, level, records, error);
    if (status != TIDES_OK) td_mover_release(numbers);
    return status;
}
