/* Converts stored values of frames to luminance: scales, decodes sRGB if the options say so, and combines r, g, b. */
#include "td_frames.h"

#include "td_math.h"

#include <math.h>

/* The sRGB curve (IEC 61966-2-1), extended beyond 1. */
static double from_srgb(double v) { return v <= 0.04045 ? v / 12.92 : td_pow((v + 0.055) / 1.055, 2.4); }

double td_frame_light(tides_frames *frames, double stored, double value) {
    if (stored > frames->seen.largest) frames->seen.largest = stored;
    if (frames->seen.whole && fabs(stored - rint(stored)) > 0) frames->seen.whole = 0;
    if (frames->full > 0) value = stored / frames->full;
    return frames->options.transfer == TIDES_TRANSFER_SRGB ? from_srgb(value) : value;
}

void td_frame_luminance(tides_frames *frames, const float *values, double unit, int32_t channels, size_t count, double *Y) {
    for (size_t i = 0; i < count; i++) {
        double sum = 0;
        for (int32_t c = 0; c < channels; c++) {
            const double value = (double)values[i * (size_t)channels + (size_t)c];
            const double light = td_frame_light(frames, unit * value, value);
            sum += channels == 1 ? light : frames->options.luminance[c] * light;
        }
        Y[i] = sum;
    }
}
