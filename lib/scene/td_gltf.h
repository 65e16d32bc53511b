/* Internal: glTF 2.0, as far as Gaussian splats need it: the container, the places of its meshes by nodes, and the splats of
 * primitives. Every reference is checked before it is used. */
#ifndef TD_GLTF_H
#define TD_GLTF_H

#include "td_endian.h"
#include "td_splat_json.h"

/* The extension for splats. */
#define TD_GLTF_SPLATS "KHR_gaussian_splatting"

/* Colour spaces in the extension, both of a display: coded as sRGB, or linear. */
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
    const unsigned char *bytes; /* NULL: not read yet */
    size_t size;
    void *owned;
} td_gltf_buffer;

typedef struct td_gltf {
    const char *path;
    cJSON *json;
    const unsigned char *chunk; /* the buffer within a binary file; NULL: none */
    size_t chunk_size;
    const cJSON **views, **accessors, **nodes, **meshes; /* arrays of the JSON, by index */
    int64_t view_count, accessor_count, node_count, mesh_count, buffer_count;
    td_gltf_buffer *buffers;
    int32_t lenient; /* 1: an impossible opacity becomes NaN, so that the Gaussian can be left out later */
    int64_t scene;   /* number of the scene to read; -1: the default one */
    tides_error *error;
} td_gltf;

/* -- container -- */

/* Opens a .glb or .gltf in memory; buffers in other files are read when needed. Close it after a failure, too. */
tides_status td_gltf_open(td_gltf *g, const char *path, const void *data, size_t size, tides_error *error);
void td_gltf_close(td_gltf *g);

/* The bytes of bufferView `index`, valid until closing. `stride` (may be NULL): its byteStride, 0 if it has none. */
tides_status td_gltf_view(td_gltf *g, int64_t index, const unsigned char **bytes, size_t *size, size_t *stride);

enum { TD_GLTF_BYTE = 5120, TD_GLTF_UBYTE, TD_GLTF_SHORT, TD_GLTF_USHORT, TD_GLTF_FLOAT = 5126 };

/* An accessor: `count` elements of `width` numbers. */
typedef struct td_gltf_accessor {
    const unsigned char *bytes;
    size_t count, stride;
    int type, width, size; /* TD_GLTF_* type of a number, and its bytes */
    double unit;           /* value of an integer step: 1, or the normalised one */
} td_gltf_accessor;

/* Opens an accessor; `what` names it in messages. 32-bit integers, sparse accessors and those without a bufferView are
 * refused. */
tides_status td_gltf_access(td_gltf *g, int64_t index, const char *what, td_gltf_accessor *accessor);

static inline double td_gltf_value(const td_gltf_accessor *a, size_t i, size_t c) {
    const unsigned char *b = a->bytes + a->stride * i + (size_t)a->size * c;
    if (a->type == TD_GLTF_FLOAT) return (double)td_le_float(b);
    if (a->type == TD_GLTF_UBYTE) return *b * a->unit;
    if (a->type == TD_GLTF_USHORT) return td_le16(b) * a->unit;
    const int value = a->type == TD_GLTF_BYTE ? (*b ^ 0x80) - 0x80 : (td_le16(b) ^ 0x8000) - 0x8000;
    return value * a->unit < -1 && a->unit < 1 ? -1 : value * a->unit; /* when normalised, -128 and -127 both mean -1 */
}

/* -- other contents of the file -- */

/* The number of the scene that is read. */
int64_t td_gltf_scene(const td_gltf *g);

/* Chooses the scene with name or number `part`; TIDES_BAD_ARGUMENT if there is none. */
tides_status td_gltf_choose(td_gltf *g, const char *part);

/* Adds notes about other scenes, meshes without splats (`wanted` 0), and animations. */
tides_status td_gltf_note_rest(const td_gltf *g, const unsigned char *wanted, char **notes);

/* -- nodes -- */

typedef struct td_gltf_place {
    int64_t node, mesh;
    double map[12]; /* A | t, row by row: maps the mesh to the scene */
} td_gltf_place;

/* Lists the nodes of the scene (without scenes, of the file) whose mesh is `wanted`, with their maps; the caller frees it. A
 * node that mirrors, shears or flattens is TIDES_UNSUPPORTED. */
tides_status td_gltf_places(const td_gltf *g, const unsigned char *wanted, td_gltf_place **places, size_t *count);

#endif
