/* Parts of a recording for error bars: halves of the time, of the image, and of the pixels, drawn by chance. */
#include "td_calibrate.h"
#include "td_random.h"

enum { PURPOSE = 201 }; /* of td_random */

int32_t td_in_part(const td_pair *pair, uint32_t pixel, const td_part *part) {
    if (!part || part->what == TD_ALL) return 1;
    if (part->what == TD_EARLY) return pair->to < part->middle;
    if (part->what == TD_LATE) return pair->to >= part->middle;
    if (part->what == TD_LEFT) return pixel % (uint32_t)part->width < (uint32_t)part->middle;
    if (part->what == TD_RIGHT) return pixel % (uint32_t)part->width >= (uint32_t)part->middle;
    const td_random_bits bits = td_random(part->seed, pixel, 0, PURPOSE);
    return bits.word[0] & 1;
}
