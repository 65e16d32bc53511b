/* v2e's centre-surround: a sheet of horizontal cells that diffuses, driven by the photoreceptors. */
#include "td_v2e.h"

#include <math.h>
#include <string.h>

/* v2e's choices: five Euler steps per time constant; no further step when no cell moves by more than this [log units]. */
#define STEPS_PER_TAU 5.0
#define SETTLED 1e-5f

/* The sum of the four neighbours minus four times the cell. Cells beyond the border equal those on it. */
static float laplacian(const float *h, size_t x, size_t y, size_t width, size_t height) {
    size_t left = x ? x - 1 : 0, right = x + 1 < width ? x + 1 : x, up = y ? y - 1 : 0, down = y + 1 < height ? y + 1 : y;
    return h[up * width + x] + h[y * width + left] - 4.0f * h[y * width + x] + h[y * width + right] + h[down * width + x];
}

/* Makes one Euler step from state->surround to state->scratch; returns the largest change. */
static float diffuse(td_v2e_state *s, size_t width, size_t height, double drive, double spread) {
    float largest = 0;
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++) {
            size_t i = y * width + x;
            float cell = s->surround[i];
            float change =
                (float)drive * ((float)s->level[i] - cell) + (float)spread * laplacian(s->surround, x, y, width, height);
            s->scratch[i] = cell + change;
            largest = fmaxf(largest, fabsf(change));
        }
    return largest;
}

void td_v2e_surround(const tides_baseline *b) {
    td_v2e_state *s = b->state;
    const tides_v2e *p = &b->params.v2e;
    double tau_p = 1e-3 * p->cs_tau_p_ms, tau_h = tau_p / (p->cs_lambda_pixels * p->cs_lambda_pixels);
    double length = b->now - b->before, steps = fmax(1.0, ceil(length / fmin(tau_p, tau_h) * STEPS_PER_TAU));
    float largest = 2 * SETTLED;
    for (double k = 0; k < steps && largest > SETTLED; k++) {
        largest = diffuse(s, (size_t)b->width, (size_t)b->height, length / steps / tau_p, length / steps / tau_h);
        float *next = s->scratch;
        s->scratch = s->surround;
        s->surround = next;
    }
}
