/* Stored values to luminance, for all sources of frames: sRGB decoded where the options say so, and r, g, b weighed. */
#include "td_frames.h"

#include <math.h>

/* IEC 61966-2-1; beyond 1 the curve goes on. */
static double from_srgb(double v) { return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4); }

double td_frame_decode(const tides_frames_options *options, double value) {
    return options->transfer == TIDES_TRANSFER_SRGB ? from_srgb(value) : value;
}

void td_frame_luminance(const tides_frames_options *options, const float *values, int32_t channels, size_t count, double *Y) {
    for (size_t i = 0; i < count; i++) {
        double sum = 0;
        for (int32_t c = 0; c < channels; c++) {
            double value = td_frame_decode(options, (double)values[i * (size_t)channels + (size_t)c]);
            sum += channels == 1 ? value : options->luminance[c] * value;
        }
        Y[i] = sum;
    }
}
