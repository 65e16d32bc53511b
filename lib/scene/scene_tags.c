/* What a scene's files say of it beside its Gaussians: how these were trained, and what a user should hear; and what of that a
 * file to be written has no place for. */
#include "td_base.h"
#include "td_folder.h"
#include "td_scene.h"

#include <stdlib.h>
#include <string.h>

int32_t td_trained_join(int32_t a, int32_t b) {
    if (a == TIDES_TRAINED_UNKNOWN || a == b) return b;
    return b == TIDES_TRAINED_UNKNOWN ? a : TIDES_TRAINED_MIXED;
}

int32_t tides_scene_trained(const tides_scene *scene) {
    int32_t trained = TIDES_TRAINED_UNKNOWN;
    for (size_t i = 0; scene && i < scene->count; i++) trained = td_trained_join(trained, scene->objects[i].gaussians.trained);
    return trained;
}

int64_t tides_scene_dropped(const tides_scene *scene) { return scene ? scene->dropped : 0; }

const char *tides_scene_notes(const tides_scene *scene) { return scene && scene->notes ? scene->notes : ""; }

/* -- losses -- */

int32_t tides_scene_losses(const tides_scene *scene, const char *file) {
    double up[3];
    int32_t lost = 0, held = 0;
    tides_scene_format format;
    for (size_t i = 0; file && tides_scene_format_at(i, &format); i++) {
        char ending[32];
        snprintf(ending, sizeof ending, "%.*s", (int)strcspn(format.endings, " "), format.endings); /* that which is written */
        if (td_ends_in(file, ending)) lost = format.losses;
    }
    if (tides_scene_sh_degree(scene) > 0) held |= TIDES_LOSES_HARMONICS;
    if (tides_scene_trained(scene) != TIDES_TRAINED_UNKNOWN) held |= TIDES_LOSES_TRAINED;
    if (tides_scene_up(scene, up)) held |= TIDES_LOSES_UP;
    return lost & held;
}
