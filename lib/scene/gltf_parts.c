/* Notes for the user about contents of a glTF that aren't read: other scenes (one of which may be chosen), meshes without
 * splats, animations. */
#include "td_base.h"
#include "td_gltf.h"
#include "td_scene.h"

#include <stdlib.h>
#include <string.h>

static const cJSON *scenes_of(const td_gltf *g) { return cJSON_GetObjectItemCaseSensitive(g->json, "scenes"); }

int64_t td_gltf_scene(const td_gltf *g) {
    const int64_t number = g->scene >= 0 ? g->scene : td_json_whole(g->json, "scene", 0, INT32_MAX);
    return number < 0 ? 0 : number;
}

/* Lists scenes with names, if any, and numbers: "'room' (0), 1, 'garden' (2)". */
static char *list_scenes(const td_gltf *g, tides_error *error) {
    char *text = td_strdup("", error);
    const cJSON *scene;
    int64_t i = 0;
    cJSON_ArrayForEach(scene, scenes_of(g)) {
        const char *name = td_json_text(scene, "name");
        char *grown = !text  ? NULL
                      : name ? td_format(error, "%s%s'%.40s' (%lld)", text, i ? ", " : "", name, (long long)i)
                             : td_format(error, "%s%s%lld", text, i ? ", " : "", (long long)i);
        free(text);
        text = grown;
        i++;
    }
    return text;
}

tides_status td_gltf_choose(td_gltf *g, const char *part) {
    const cJSON *scene;
    int64_t i = 0;
    char number[24];
    cJSON_ArrayForEach(scene, scenes_of(g)) {
        const char *name = td_json_text(scene, "name");
        snprintf(number, sizeof number, "%lld", (long long)i);
        if ((name && strcmp(name, part) == 0) || (g->scene < 0 && strcmp(number, part) == 0)) g->scene = i;
        i++;
    }
    if (g->scene >= 0) return TIDES_OK;
    char *all = list_scenes(g, g->error);
    if (!all) return TIDES_NO_MEMORY;
    const tides_status status = td_fail(g->error, TIDES_BAD_ARGUMENT, "%s: scene.part = \"%.80s\" is none of its scenes: %s",
                                        g->path, part, all[0] ? all : "it has none");
    free(all);
    return status;
}

static tides_status note_scenes(const td_gltf *g, char **notes) {
    if (cJSON_GetArraySize(scenes_of(g)) < 2) return TIDES_OK;
    char *all = list_scenes(g, g->error);
    if (!all) return TIDES_NO_MEMORY;
    const tides_status status =
        td_note(notes, g->error, "its scene %lld is read, of %s: scene.part names another", (long long)td_gltf_scene(g), all);
    free(all);
    return status;
}

tides_status td_gltf_note_rest(const td_gltf *g, const unsigned char *wanted, char **notes) {
    long long plain = 0;
    const int animations = cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(g->json, "animations"));
    for (int64_t i = 0; i < g->mesh_count; i++) plain += !wanted[i];
    tides_status status = note_scenes(g, notes);
    if (plain && !status)
        status = td_note(notes, g->error, "%lld of its %lld meshes have no splats, and aren't shown", plain,
                         (long long)g->mesh_count);
    if (animations > 0 && !status) status = td_note(notes, g->error, "its animations aren't read: all is where it is at rest");
    return status;
}
