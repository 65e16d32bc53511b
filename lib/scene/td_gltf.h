/* Internal: glTF 2.0, as far as Gaussian splats need it: the container (gltf.c), where its nodes put meshes (gltf_nodes.c), and
 * splats of primitives (gltf_splats.c). Whatever refers to something is checked before it is followed. */
#ifndef TD_GLTF_H
#define TD_GLTF_H

#include "td_endian.h"
#include "td_splat_json.h"

/* The extension that holds splats, and what a binary file is marked with. */
#define TD_GLTF_SPLATS "KHR_gaussian_splatting"

/* Its colour spaces: both of a display, coded as sRGB or linear. */
#define TD_GLTF_SRGB "srgb_rec709_display"
#define TD_GLTF_LINEAR "lin_rec709_display"

enum {
    TD_GLTF_MAGIC = 0x46546c67,
    TD_GLTF_JSON = 0x4e4f534a,
    TD_GLTF_BINARY = 0x004e4942,
    TD_GLTF_HEADER = 12,
    TD_GLTF_CHUNK = 8
};

typedef struct td_gltf_buffer {
    const unsigned char *bytes; /* NULL: not asked for yet */
    size_t size;
    void *owned;
} td_gltf_buffer;

typedef struct td_gltf {
    const char *path;
    cJSON *json;
    const unsigned char *chunk; /* the binary file's own buffer; NULL: none */
    size_t chunk_size;
    const cJSON **views, **accessors, **nodes, **meshes; /* their arrays by index */
    int64_t view_count, accessor_count, node_count, mesh_count, buffer_count;
    td_gltf_buffer *buffers;
    int32_t lenient; /* 1: an opacity that can't be becomes NaN, for td_gaussians_drop */
    int64_t scene;   /* which of its scenes is shown; -1: the default one */
    tides_error *error;
} td_gltf;

/* -- gltf.c -- */

/* Parses a .glb or .gltf in memory; buffers beside it are read when they are asked for. Closed after a failure too. */
tides_status td_gltf_open(td_gltf *g, const char *path, const void *data, size_t size, tides_error *error);
void td_gltf_close(td_gltf *g);

/* The bytes of bufferView `index`, valid until closing. `stride` (nullable): its byteStride, 0 where it has none. */
tides_status td_gltf_view(td_gltf *g, int64_t index, const unsigned char **bytes, size_t *size, size_t *stride);

enum { TD_GLTF_BYTE = 5120, TD_GLTF_UBYTE, TD_GLTF_SHORT, TD_GLTF_USHORT, TD_GLTF_FLOAT = 5126 };

/* `count` elements of `width` numbers. */
typedef struct td_gltf_accessor {
    const unsigned char *bytes;
    size_t count, stride;
    int type, width, size; /* of a number: one of the above, and its bytes */
    double unit;           /* of an integer: 1, or that of a normalised one */
} td_gltf_accessor;

/* `what` names it in messages. Numbers of 32-bit integers, sparse accessors and those without a bufferView are refused. */
tides_status td_gltf_access(td_gltf *g, int64_t index, const char *what, td_gltf_accessor *accessor);

static inline double td_gltf_value(const td_gltf_accessor *a, size_t i, size_t c) {
    const unsigned char *b = a->bytes + a->stride * i + (size_t)a->size * c;
    if (a->type == TD_GLTF_FLOAT) return (double)td_le_float(b);
    if (a->type == TD_GLTF_UBYTE) return *b * a->unit;
    if (a->type == TD_GLTF_USHORT) return td_le16(b) * a->unit;
    const int value = a->type == TD_GLTF_BYTE ? (*b ^ 0x80) - 0x80 : (td_le16(b) ^ 0x8000) - 0x8000;
    return value * a->unit < -1 && a->unit < 1 ? -1 : value * a->unit; /* -128 and -127 both stand for -1 */
}

/* -- gltf_parts.c: what is in the file beside what is read -- */

/* The number of the scene that is shown. */
int64_t td_gltf_scene(const td_gltf *g);

/* Sets it to the one that is called `part`, or has that number; TIDES_BAD_ARGUMENT where there is none. */
tides_status td_gltf_choose(td_gltf *g, const char *part);

/* Adds notes of other scenes, of meshes that have no splats (`wanted` 0), of animations. */
tides_status td_gltf_note_rest(const td_gltf *g, const unsigned char *wanted, char **notes);

/* -- gltf_nodes.c -- */

typedef struct td_gltf_place {
    int64_t node, mesh;
    double map[12]; /* A | t, row by row: from the mesh to the scene */
} td_gltf_place;

/* Nodes of the scene that is shown (of all, where there are no scenes) whose mesh is one of those with `wanted` set; freed by
 * the caller. Nodes that mirror, shear or flatten: TIDES_UNSUPPORTED. */
tides_status td_gltf_places(const td_gltf *g, const unsigned char *wanted, td_gltf_place **places, size_t *count);

#endif
