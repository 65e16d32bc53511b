/* Notes on how well frames show the light between them, written when a run is opened. A few frames are sampled for three
 * measures: the error of a straight line of log luminance at a frame left out, the motion between frames, and the share of
 * pixels where one step of an 8-bit value exceeds a threshold. */
#include "td_run.h"
#include "td_math.h"

#include "frames/td_frames.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    LOOKS = 4,   /* places in the sequence that are sampled */
    BLOCK = 16,  /* px, edge of a block */
    REACH = 16,  /* px, search range for a block in each direction */
    BLOCKS = 150 /* most blocks */
};
/* A block is followed if its mean |difference of neighbours| is above this times the frame's mean. */
#define TEXTURED 1.5
#define MOVES_FAR 2.0   /* px between frames */
#define MISSED 0.25     /* contrast thresholds that straight lines are off */
#define STEPS_MANY 0.01 /* share of the pixels */
#define EIGHT_BITS 255.0

typedef struct looks {
    tides_frames *frames;
    int32_t width, height;
    size_t pixels;
    double *Y[3], log_eps, threshold;
    double missed, moved;  /* over pixels whose light changes: sum of errors [log units], and number of pixels */
    size_t stepping, seen; /* pixels where one step exceeds a threshold; all sampled pixels */
    double distance[LOOKS * BLOCKS];
    size_t distances;
} looks;

/* Reads three frames; 0 if one can't be read (the run will report it). */
static int32_t read_three(looks *l, size_t first) {
    for (size_t k = 0; k < 3; k++)
        if (tides_frames_read(l->frames, first + k, l->Y[k], NULL) != TIDES_OK) return 0;
    return 1;
}

/* Compares the middle frame with straight lines between its neighbours, where these differ by at least half a threshold. It
 * also counts the pixels where one 8-bit step crosses a threshold. */
static void leave_out(looks *l, size_t first) {
    const double before = tides_frames_time(l->frames, first), after = tides_frames_time(l->frames, first + 2);
    const double share = (tides_frames_time(l->frames, first + 1) - before) / (after - before);
    const double step = td_expm1(l->threshold) * EIGHT_BITS;
    for (size_t i = 0; i < l->pixels; i++) {
        const double a = td_ln(l->Y[0][i] + l->log_eps), b = td_ln(l->Y[2][i] + l->log_eps);
        l->stepping += 1 >= step * (l->Y[1][i] + l->log_eps);
        if (fabs(b - a) < 0.5 * l->threshold) continue;
        l->missed += fabs(td_ln(l->Y[1][i] + l->log_eps) - (a + share * (b - a)));
        l->moved++;
    }
    l->seen += l->pixels;
}

/* -- motion ---------------------------------------------------------------------------------------------------------------- */

static double texture(const looks *l, size_t x, size_t y, size_t width, size_t height) {
    double sum = 0;
    for (size_t v = y; v < y + height; v++)
        for (size_t u = x; u + 1 < x + width; u++)
            sum += fabs(l->Y[0][v * (size_t)l->width + u + 1] - l->Y[0][v * (size_t)l->width + u]);
    return sum / (double)(width * height);
}

static double difference(const looks *l, size_t x, size_t y, int32_t u, int32_t v, double most) {
    const size_t width = (size_t)l->width, there = ((size_t)((int32_t)y + v)) * width + (size_t)((int32_t)x + u);
    double sum = 0;
    for (size_t r = 0; r < BLOCK && sum < most; r++)
        for (size_t k = 0; k < BLOCK; k++) sum += fabs(l->Y[1][there + r * width + k] - l->Y[0][(y + r) * width + x + k]);
    return sum;
}

/* Distance that the block at (x, y) moves to the next frame [px]. */
static double find_block(const looks *l, size_t x, size_t y) {
    /* counts as resting unless another place is clearly better */
    double least = difference(l, x, y, 0, 0, INFINITY) * 0.999, distance = 0;
    for (int32_t v = -REACH; v <= REACH; v++) {
        for (int32_t u = -REACH; u <= REACH; u++) {
            const double here = difference(l, x, y, u, v, least);
            if (!(here < least)) continue;
            least = here;
            distance = td_hypot(u, v);
        }
    }
    return distance;
}

static void follow(looks *l) {
    const size_t inner_x = (size_t)l->width - 2 * REACH - BLOCK, inner_y = (size_t)l->height - 2 * REACH - BLOCK;
    if (l->width < 2 * REACH + BLOCK + 1 || l->height < 2 * REACH + BLOCK + 1) return;
    const double usual = texture(l, 0, 0, (size_t)l->width, (size_t)l->height);
    size_t across = inner_x / BLOCK + 1, down = inner_y / BLOCK + 1, every = across * down / BLOCKS + 1;
    for (size_t b = 0; b < across * down; b += every) {
        const size_t x = REACH + b % across * BLOCK, y = REACH + b / across * BLOCK;
        if (x > REACH + inner_x || y > REACH + inner_y) continue;
        if (usual > 0 && texture(l, x, y, BLOCK, BLOCK) > TEXTURED * usual && l->distances < LOOKS * BLOCKS)
            l->distance[l->distances++] = find_block(l, x, y);
    }
}

/* -- the lines ------------------------------------------------------------------------------------------------------------- */

static tides_status tell(looks *l, int32_t of_tides, char **notes, tides_error *error) {
    const size_t count = tides_frames_count(l->frames);
    const double rate = (double)(count - 1) / (tides_frames_time(l->frames, count - 1) - tides_frames_time(l->frames, 0));
    const double missed = l->moved > 0 ? l->missed / l->moved : 0;
    const double stepping = (double)l->stepping / (double)l->seen;
    tides_status status = TIDES_OK;
    if (missed > MISSED * l->threshold)
        status = td_note(notes, error,
                         "frames.file: %.4g frames per second say little of the light between them: a frame left out is off by "
                         "%.2g log units (%.2g thresholds) from straight lines where light changes",
                         rate, missed, missed / l->threshold);
    qsort(l->distance, l->distances, sizeof *l->distance, td_ascending);
    const double far = l->distances ? l->distance[3 * l->distances / 4] : 0; /* upper quartile */
    if (status == TIDES_OK && far > MOVES_FAR)
        status =
            td_note(notes, error,
                    "frames.file: a quarter of the edges move by %.0f px or more from frame to frame: light fades over there "
                    "in place of moving, and events come at wrong times; %.3g frames per second would be enough",
                    far, rate * far);
    if (status == TIDES_OK && of_tides && l->frames->most > 0 && l->frames->most <= EIGHT_BITS && stepping > STEPS_MANY)
        status =
            td_note(notes, error,
                    "frames.file: in %.0f %% of the pixels one step of an 8-bit value crosses a threshold at image.log_eps "
                    "= %.3g: what fires there is rounding and noise; from %.2g on none does",
                    100 * stepping, l->log_eps, 1 / (EIGHT_BITS * td_expm1(l->threshold)));
    return status;
}

tides_status td_run_frames_light(const tides_run_values *values, tides_frames *frames, char **notes, tides_error *error) {
    const size_t count = tides_frames_count(frames);
    looks l = {.frames = frames, .log_eps = values->image.log_eps};
    tides_status status = TIDES_OK;
    size_t last = count;
    if (tides_frames_planes(frames) > 1 || count < 3) return TIDES_OK;
    tides_frames_size(frames, &l.width, &l.height);
    l.pixels = (size_t)l.width * (size_t)l.height;
    l.threshold = fmin(values->sensor.threshold_on, values->sensor.threshold_off);
    for (int k = 0; k < 3 && status == TIDES_OK; k++) {
        l.Y[k] = td_alloc(l.pixels, sizeof *l.Y[k], error);
        if (!l.Y[k]) status = TIDES_NO_MEMORY;
    }
    for (size_t i = 0; i < LOOKS && status == TIDES_OK; i++) {
        const size_t first = i * (count - 3) / (LOOKS - 1);
        if (first == last) continue;
        last = first;
        if (!read_three(&l, first)) break;
        leave_out(&l, first);
        follow(&l);
    }
    if (status == TIDES_OK && l.seen) status = tell(&l, values->baseline.method == TIDES_METHOD_TIDES, notes, error);
    for (int k = 0; k < 3; k++) free(l.Y[k]);
    return status;
}
