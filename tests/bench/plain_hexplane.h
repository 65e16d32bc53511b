/* OpenCL source that bench_motion compares with, appended to motion.cl: the device's fma limit, and 4DGaussians' network
 * literally by its equations. All six planes of every level are sampled bilinearly for every Gaussian at every time. */
#ifndef BENCH_PLAIN_HEXPLANE_H
#define BENCH_PLAIN_HEXPLANE_H

#define SOURCE_TEXT(...) #__VA_ARGS__

/* 16 chains of fma on the widest vectors: 16 * 16 * rounds fma per work-item. */
static const char fma_source[] = SOURCE_TEXT(__kernel void fma_limit(__global float *out, int rounds) {
    float16 x[16];
    float16 a = (float16)(0.999f + 1e-9f * get_global_id(0));
    float16 b = (float16)(1e-3f);
    for (int k = 0; k < 16; k++) x[k] = (float16)(1e-2f * k);
    for (int i = 0; i < rounds; i++) {
        x[0] = fma(x[0], a, b), x[1] = fma(x[1], a, b), x[2] = fma(x[2], a, b), x[3] = fma(x[3], a, b);
        x[4] = fma(x[4], a, b), x[5] = fma(x[5], a, b), x[6] = fma(x[6], a, b), x[7] = fma(x[7], a, b);
        x[8] = fma(x[8], a, b), x[9] = fma(x[9], a, b), x[10] = fma(x[10], a, b), x[11] = fma(x[11], a, b);
        x[12] = fma(x[12], a, b), x[13] = fma(x[13], a, b), x[14] = fma(x[14], a, b), x[15] = fma(x[15], a, b);
    }
    float16 sum =
        x[0] + x[1] + x[2] + x[3] + x[4] + x[5] + x[6] + x[7] + x[8] + x[9] + x[10] + x[11] + x[12] + x[13] + x[14] + x[15];
    vstore16(sum, get_global_id(0), out);
});

/* planes: [level][xy xz xt yz yt zt][row][column][channel]; sizes: x y z t per level. The box is the cube from 1.6 to -1.6. */
static const char plain_source[] = SOURCE_TEXT(
    inline td_dual plain_plane(__global const float *plane, int columns, int rows, int channels, float x, float y, float y_dot,
                               int channel) {
        float u = clamp(x, 0.0f, (float)(columns - 1));
        float v = clamp(y, 0.0f, (float)(rows - 1));
        int i = min((int)u, columns - 2);
        int j = min((int)v, rows - 2);
        __global const float *corner = plane + (j * columns + i) * channels + channel;
        td_lanes a = td_load_lanes(corner);
        td_lanes b = td_load_lanes(corner + columns * channels);
        a = td_fma(u - i, td_load_lanes(corner + channels) - a, a);
        b = td_fma(u - i, td_load_lanes(corner + columns * channels + channels) - b, b);
        return td_dual_make(td_fma(v - j, b - a, a), (b - a) * y_dot);
    }

    __kernel void plain_network(__global const td_mover *mover, __global const float *data, __global const float *planes,
                                __global const int *sizes, __global const float *means, __global const int *gaussians, float t,
                                __global float *geometry, __global float *rates) {
        int first = get_global_id(0) * TD_LANES;
        int width = mover->own[TD_HEXPLANE_WIDTH];
        int channels = mover->own[TD_HEXPLANE_CHANNELS];
        td_dual feature[TD_HEXPLANE_FEATURES_HERE];
        td_dual hidden[TD_HEXPLANE_WIDTH_HERE];
        td_dual between[TD_HEXPLANE_WIDTH_HERE];
        td_dual add[4][4];
        int at = 0;
        for (int l = 0; l < mover->own[TD_HEXPLANE_LEVELS]; l++, sizes += 4) {
            __global const float *next = planes;
            for (int channel = 0; channel < channels; channel += TD_LANES) {
                td_lanes value[TD_LANES];
                td_lanes rate[TD_LANES];
                for (int g = 0; g < TD_LANES; g++) {
                    td_dual product = td_dual_make(td_splat(1.0f), td_splat(0.0f));
                    next = planes;
                    for (int i = 0; i < 3; i++)
                        for (int j = i + 1; j < 4; j++) {
                            float x = (1.6f - means[3 * (first + g) + i]) / 3.2f * (sizes[i] - 1);
                            float y = j < 3 ? (1.6f - means[3 * (first + g) + j]) / 3.2f * (sizes[j] - 1)
                                            : (t + 1) / 2 * (sizes[3] - 1);
                            float y_dot = j < 3 ? 0.0f : 0.5f * (sizes[3] - 1);
                            product =
                                td_dual_mul(product, plain_plane(next, sizes[i], sizes[j], channels, x, y, y_dot, channel));
                            next += sizes[i] * sizes[j] * channels;
                        }
                    value[g] = product.v;
                    rate[g] = product.d;
                }
                td_transpose(value);
                td_transpose(rate);
                for (int k = 0; k < TD_LANES; k++) feature[at++] = td_dual_make(value[k], rate[k]);
            }
            planes = next;
        }
        __global const float *layer = data + mover->own[TD_HEXPLANE_WEIGHTS];
        layer = td_dense(layer, feature, at, hidden, width, 1);
        for (int head = 0; head < 4; head++) layer = td_hexplane_head(mover, layer, 1 << head, hidden, between, add[head], 4);
        td_theta_sink sink;
        sink.geometry = geometry + first * TD_GEOMETRY_STRIDE;
        sink.rates = rates + first * TD_GEOMETRY_STRIDE;
        sink.tau_dot = 1;
        td_index index = td_load_ints(gaussians + first);
        td_hexplane_geometry(mover, data + mover->own[TD_HEXPLANE_RECORDS] + at, index * mover->own[TD_HEXPLANE_STRIDE], add,
                             &sink);
    });

#endif
