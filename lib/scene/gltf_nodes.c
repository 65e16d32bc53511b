/* The maps from a glTF's meshes to its scene. A mesh belongs to a node; its map is the node's own, followed by the maps of all
 * nodes above it. */
#include "camera/td_rotation.h"
#include "td_gltf.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEEPEST = 256 }; /* levels of nodes; this bound ends the search where nodes are their own ancestors */

static const double still[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/* out = a b */
static void chain(const double a[12], const double b[12], double out[12]) {
    double made[12];
    for (int row = 0; row < 3; row++)
        for (int c = 0; c < 4; c++) {
            const double *r = a + 4 * row;
            made[4 * row + c] = r[0] * b[c] + r[1] * b[4 + c] + r[2] * b[8 + c] + (c == 3 ? r[3] : 0);
        }
    memcpy(out, made, sizeof made);
}

/* Reads "key" as `count` numbers into `values`, which stay unchanged if it is missing. */
static tides_status take(const td_gltf *g, int64_t node, const char *key, double *values, int count) {
    if (!cJSON_GetObjectItemCaseSensitive(g->nodes[node], key) || td_json_numbers(g->nodes[node], key, values, count))
        return TIDES_OK;
    return td_fail(g->error, TIDES_BAD_FILE, "%s: node %lld: %s must be %d numbers", g->path, (long long)node, key, count);
}

/* A node's own map: a matrix by columns, or translation, rotation (xyzw) and scale. */
static tides_status own_map(const td_gltf *g, int64_t node, double map[12]) {
    double matrix[16] = {0}, shift[3] = {0}, turn[4] = {0, 0, 0, 1}, scale[3] = {1, 1, 1}, r[9];
    tides_status status = take(g, node, "translation", shift, 3);
    if (!status) status = take(g, node, "rotation", turn, 4);
    if (!status) status = take(g, node, "scale", scale, 3);
    if (!status) status = take(g, node, "matrix", matrix, 16);
    if (status) return status;
    double q[4] = {turn[3], turn[0], turn[1], turn[2]};
    if (!td_normalise_quaternion(q))
        return td_fail(g->error, TIDES_BAD_FILE, "%s: node %lld: its rotation is 0", g->path, (long long)node);
    td_rotation_from_quaternion(q, r);
    for (int row = 0; row < 3; row++)
        for (int c = 0; c < 4; c++) map[4 * row + c] = c < 3 ? r[3 * row + c] * scale[c] : shift[row];
    if (cJSON_GetObjectItemCaseSensitive(g->nodes[node], "matrix"))
        for (int i = 0; i < 12; i++) map[i] = matrix[4 * (i % 4) + i / 4];
    return TIDES_OK;
}

/* Finds the parent of each node; -1: none. A node has at most one. */
static tides_status find_parents(const td_gltf *g, int64_t *parents) {
    for (int64_t i = 0; i < g->node_count; i++) parents[i] = -1;
    for (int64_t i = 0; i < g->node_count; i++) {
        const cJSON *child;
        cJSON_ArrayForEach(child, cJSON_GetObjectItemCaseSensitive(g->nodes[i], "children")) {
            const double number = cJSON_IsNumber(child) ? child->valuedouble : -1;
            if (!(number >= 0 && number < (double)g->node_count) || parents[(int64_t)number] >= 0)
                return td_fail(g->error, TIDES_BAD_FILE, "%s: node %lld has a child that isn't there, or is another's", g->path,
                               (long long)i);
            parents[(int64_t)number] = i;
        }
    }
    return TIDES_OK;
}

/* Marks the root nodes of the scene; without scenes, all nodes. */
static void find_roots(const td_gltf *g, unsigned char *shown) {
    const cJSON *scenes = cJSON_GetObjectItemCaseSensitive(g->json, "scenes"), *root;
    const cJSON *scene = cJSON_GetArrayItem(scenes, (int)td_gltf_scene(g));
    memset(shown, scenes == NULL, (size_t)g->node_count);
    cJSON_ArrayForEach(root, cJSON_GetObjectItemCaseSensitive(scene, "nodes")) {
        if (cJSON_IsNumber(root) && root->valuedouble >= 0 && root->valuedouble < (double)g->node_count)
            shown[(int64_t)root->valuedouble] = 1;
    }
}

/* Computes the map from the mesh of `place`'s node to the scene. `*top`: the root node of its branch. */
static tides_status find_map(const td_gltf *g, const int64_t *parents, td_gltf_place *place, int64_t *top) {
    int64_t node = place->node;
    memcpy(place->map, still, sizeof still);
    for (int depth = 0; node >= 0; node = parents[node]) {
        double own[12] = {0};
        if (++depth > DEEPEST)
            return td_fail(g->error, TIDES_BAD_FILE, "%s: node %lld lies over %d nodes deep", g->path, (long long)place->node,
                           DEEPEST);
        tides_status status = own_map(g, node, own);
        if (status) return status;
        chain(own, place->map, place->map);
        *top = node;
    }
    return TIDES_OK;
}

/* Fails unless the map scales along the mesh's axes and then rotates. Other maps (mirrors, shears) have no defined result for
 * splats, whose colours depend on the direction of view. */
static tides_status check_map(const td_gltf *g, const td_gltf_place *place) {
    const double *m = place->map;
    double c[3][3];
    int good = cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(g->nodes[place->node], "extensions"),
                                                "EXT_mesh_gpu_instancing") == NULL;
    for (int k = 0; k < 3; k++) {
        const double length = sqrt(m[k] * m[k] + m[4 + k] * m[4 + k] + m[8 + k] * m[8 + k]);
        for (int row = 0; row < 3; row++) c[k][row] = m[4 * row + k] / length;
        good = good && length > 1e-18 && length < 1e18;
    }
    double third[3];
    td_cross3(c[0], c[1], third);
    const double close = 1e-3; /* tolerance of the determinant of the normalised columns, which is 1 for orthogonal ones */
    if (good && fabs(td_dot3(third, c[2]) - 1) < close) return TIDES_OK;
    return td_fail(g->error, TIDES_UNSUPPORTED,
                   "%s: node %lld mirrors, shears, flattens or repeats its splats: bake that into them", g->path,
                   (long long)place->node);
}

static tides_status find_places(const td_gltf *g, const unsigned char *wanted, const int64_t *parents,
                                const unsigned char *shown, td_gltf_place *places, size_t *count) {
    for (int64_t i = 0; i < g->node_count; i++) {
        td_gltf_place place = {.node = i, .mesh = td_json_whole(g->nodes[i], "mesh", 0, g->mesh_count - 1)};
        int64_t top = i;
        if (place.mesh < 0 || !wanted[place.mesh]) continue;
        tides_status status = find_map(g, parents, &place, &top);
        if (!status && !shown[top]) continue;
        if (!status) status = check_map(g, &place);
        if (status) return status;
        places[(*count)++] = place;
    }
    return TIDES_OK;
}

tides_status td_gltf_places(const td_gltf *g, const unsigned char *wanted, td_gltf_place **places, size_t *count) {
    const size_t nodes = (size_t)g->node_count;
    int64_t *parents = td_alloc(nodes, sizeof *parents, g->error);
    unsigned char *shown = parents ? td_alloc(nodes, 1, g->error) : NULL;
    td_gltf_place *found = shown ? td_alloc(nodes, sizeof *found, g->error) : NULL;
    tides_status status = found ? find_parents(g, parents) : TIDES_NO_MEMORY;
    *count = 0;
    if (!status) {
        find_roots(g, shown);
        status = find_places(g, wanted, parents, shown, found, count);
    }
    free(parents);
    free(shown);
    if (status)
        free(found);
    else
        *places = found;
    return status;
}
