/* Internal: an animation that is being written; each format is a set of functions. */
#ifndef TD_ANIMATION_H
#define TD_ANIMATION_H

#include "td_base.h"
#include "tides/image.h"

typedef struct td_animation_format td_animation_format;

struct tides_animation {
    const td_animation_format *format;
    char *path, *part; /* part: NULL if the format writes no .part */
    FILE *file;        /* NULL for numbered pictures */
    int32_t width, height;
    uint32_t rate, rate_scale; /* rate / rate_scale pictures a second, both below 65536 */
    uint64_t count;            /* pictures so far */
    uint32_t sequence;         /* APNG: chunks of the animation so far */
    long counter_at;           /* APNG: file position of the chunk with the number of pictures */
    uint8_t *bytes;            /* y4m: one picture's planes */
};

/* `begin` and `end` may be NULL. The file is open during all calls, if the format has one. */
struct td_animation_format {
    tides_status (*begin)(tides_animation *animation, tides_error *error);
    tides_status (*append)(tides_animation *animation, const uint8_t *rgb, tides_error *error);
    tides_status (*end)(tides_animation *animation, tides_error *error);
};

extern const td_animation_format td_animation_apng, td_animation_y4m, td_animation_numbered;

/* Writes to the file; an error names the path. */
tides_status td_animation_put(tides_animation *animation, const void *bytes, size_t size, tides_error *error);

/* 1 if the path has one %d (%4d, %04d, up to %9d) and no other %. */
int td_animation_is_numbered(const char *path);

#endif
