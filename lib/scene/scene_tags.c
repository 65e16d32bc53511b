/* Facts about a scene besides its Gaussians: how they were trained, how colours code light, notes for the user, and what a
 * given file format can't store. */
#include "td_base.h"
#include "td_folder.h"
#include "td_scene.h"
#include "td_text.h"

#include <stdlib.h>
#include <stdio.h>
#include <string.h>

int32_t tides_scene_trained(const tides_scene *scene) {
    int32_t trained = TIDES_TRAINED_UNKNOWN;
    for (size_t i = 0; scene && i < scene->count; i++) trained = td_trained_join(trained, scene->objects[i].gaussians.trained);
    return trained;
}

tides_status tides_scene_transfer(const tides_scene *scene, int32_t *transfer, double *gamma, tides_error *error) {
    *transfer = TIDES_TRANSFER_LINEAR;
    *gamma = 1;
    for (size_t i = 0; scene && i < scene->count; i++) {
        const td_gaussians *first = &scene->objects[0].gaussians, *g = &scene->objects[i].gaussians;
        if (g->transfer != first->transfer || (g->transfer == TIDES_TRANSFER_GAMMA && fabs(g->gamma - first->gamma) > 0)) {
            char one[TD_TRANSFER_TEXT], other[TD_TRANSFER_TEXT];
            td_transfer_say(first->transfer, first->gamma, one);
            td_transfer_say(g->transfer, g->gamma, other);
            return td_fail(error, TIDES_BAD_CONFIG,
                           "the colours of '%.80s' are %s, those of '%.80s' %s, and one image is decoded in one way: tag their "
                           "files "
                           "alike, or say which with image.transfer",
                           scene->objects[0].name, one, scene->objects[i].name, other);
        }
        *transfer = g->transfer;
        *gamma = g->transfer == TIDES_TRANSFER_GAMMA ? g->gamma : 1;
    }
    return TIDES_OK;
}

int64_t tides_scene_dropped(const tides_scene *scene) { return scene ? scene->dropped : 0; }

const char *tides_scene_notes(const tides_scene *scene) { return scene && scene->notes ? scene->notes : ""; }

/* -- losses -- */

/* TIDES_LOSES_* flags for how the objects code light. sRGB sets none, since every reader assumes it. */
static int32_t transfers_of(const tides_scene *scene) {
    int32_t held = 0;
    for (size_t i = 0; scene && i < scene->count; i++) {
        const int32_t transfer = scene->objects[i].gaussians.transfer;
        if (transfer != TIDES_TRANSFER_SRGB) held |= TIDES_LOSES_TRANSFER;
        if (transfer == TIDES_TRANSFER_GAMMA) held |= TIDES_LOSES_EXPONENT;
    }
    return held;
}

int32_t tides_scene_losses(const tides_scene *scene, const char *file) {
    double up[3];
    int32_t lost = 0, held = 0;
    tides_scene_format format;
    for (size_t i = 0; file && tides_scene_format_at(i, &format); i++) {
        char ending[32];
        /* the first ending is the one that is written */
        snprintf(ending, sizeof ending, "%.*s", (int)strcspn(format.endings, " "), format.endings);
        if (td_ends_in(file, ending)) lost = format.losses;
    }
    if (tides_scene_sh_degree(scene) > 0) held |= TIDES_LOSES_HARMONICS;
    if (tides_scene_trained(scene) != TIDES_TRAINED_UNKNOWN) held |= TIDES_LOSES_TRAINED;
    if (tides_scene_up(scene, up)) held |= TIDES_LOSES_UP;
    lost &= held | transfers_of(scene);
    return lost & TIDES_LOSES_EXPONENT ? (lost & ~TIDES_LOSES_EXPONENT) | TIDES_LOSES_TRANSFER : lost;
}
