/* An animation as numbered pictures: a PNG for each picture, with its number in the name. */
#include "td_animation.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Finds the %d of a path, and its length; NULL if there is none, or another %. */
static const char *find_number(const char *path, size_t *length) {
    const char *percent = strchr(path, '%');
    if (!percent || strchr(percent + 1, '%')) return NULL;
    size_t n = 1;
    if (percent[n] == '0') n++;
    if (percent[n] >= '1' && percent[n] <= '9') n++;
    *length = n + 1;
    return percent[n] == 'd' ? percent : NULL;
}

int td_animation_is_numbered(const char *path) {
    size_t length;
    return find_number(path, &length) != NULL;
}

/* The name of picture `index`, allocated. The digit in %4d is the width; numbers are padded by zeros, since names shouldn't
 * have spaces. */
static char *name_of(const tides_animation *animation, uint64_t index, tides_error *error) {
    size_t length = 2; /* set by find_number */
    const char *number = find_number(animation->path, &length);
    const int width = isdigit((unsigned char)number[length - 2]) ? number[length - 2] - '0' : 1;
    return td_format(error, "%.*s%0*llu%s", (int)(number - animation->path), animation->path, width, (unsigned long long)index,
                     number + length);
}

static tides_status append(tides_animation *animation, const uint8_t *rgb, tides_error *error) {
    char *name = name_of(animation, animation->count, error);
    if (!name) return TIDES_NO_MEMORY;
    const tides_status status = tides_png_write(name, animation->width, animation->height, rgb, error);
    free(name);
    return status;
}

/* Removes pictures with higher numbers of an earlier, longer animation: they would look like a part of this one. */
static tides_status end(tides_animation *animation, tides_error *error) {
    int removed = 1;
    for (uint64_t index = animation->count; removed; index++) {
        char *name = name_of(animation, index, error);
        if (!name) return TIDES_NO_MEMORY;
        removed = remove(name) == 0;
        free(name);
    }
    return TIDES_OK;
}

const td_animation_format td_animation_numbered = {NULL, append, end};
