/* The container of glTF 2.0: a JSON file (.gltf) with buffers in other files or in the text, or a binary file (.glb) with
 * JSON and a buffer. Little-endian:
 *
 *     uint32 "glTF", uint32 2, uint32 size of the file; then chunks: uint32 size, uint32 "JSON" or "BIN\0", bytes
 *
 * A buffer is cut into views, and accessors describe numbers in a view. All sizes are checked against the bytes that exist. */
#include "td_gltf.h"
#include "td_splat.h"

#include <stdlib.h>
#include <string.h>

/* -- opening ------------------------------------------------------------------------------------------------------------- */

static tides_status find_chunks(td_gltf *g, const unsigned char *b, size_t size, const unsigned char **json, size_t *bytes) {
    if (size < TD_GLTF_HEADER + TD_GLTF_CHUNK || td_le32(b + 8) > size)
        return td_fail(g->error, TIDES_BAD_FILE, "%s: is a binary glTF that ends early: truncated?", g->path);
    if (td_le32(b + 4) != 2)
        return td_fail(g->error, TIDES_UNSUPPORTED, "%s: is a binary glTF of version %lu: 2 is read", g->path,
                       (unsigned long)td_le32(b + 4));
    size_t at = TD_GLTF_HEADER, end = td_le32(b + 8);
    for (int chunk = 0; chunk < 2 && at + TD_GLTF_CHUNK <= end; chunk++) {
        const size_t length = td_le32(b + at);
        const uint32_t kind = td_le32(b + at + 4);
        at += TD_GLTF_CHUNK;
        if (length > end - at) return td_fail(g->error, TIDES_BAD_FILE, "%s: chunk %d ends behind the file", g->path, chunk);
        if (chunk == 0 && kind == TD_GLTF_JSON) {
            *json = b + at;
            *bytes = length;
        } else if (chunk == 1 && kind == TD_GLTF_BINARY) {
            g->chunk = b + at;
            g->chunk_size = length;
        }
        at += length + 3 - (length + 3) % 4;
    }
    if (*json) return TIDES_OK;
    return td_fail(g->error, TIDES_BAD_FILE, "%s: is a binary glTF whose first chunk is no JSON", g->path);
}

/* The array json.key as a list with random access, and its length. */
static tides_status index_list(const td_gltf *g, const char *key, const cJSON ***items, int64_t *count) {
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(g->json, key), *item;
    *items = td_alloc(cJSON_IsArray(list) ? (size_t)cJSON_GetArraySize(list) : 0, sizeof **items, g->error);
    if (!*items) return TIDES_NO_MEMORY;
    cJSON_ArrayForEach(item, list) {
        if (cJSON_IsArray(list)) (*items)[(*count)++] = item;
    }
    return TIDES_OK;
}

/* Refuses a file that requires an unknown extension. Extensions for materials, textures and lights don't concern splats. */
static tides_status check_required(const td_gltf *g) {
    static const char *const fine[] = {TD_GLTF_SPLATS,          "KHR_spz_gaussian_splats_compression",
                                       "KHR_mesh_quantization", "KHR_materials_",
                                       "KHR_texture_",          "KHR_lights_"};
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(g->json, "extensionsRequired")) {
        size_t i = 0;
        const char *name = cJSON_IsString(item) ? item->valuestring : "?";
        while (i < sizeof fine / sizeof *fine && strncmp(name, fine[i], strlen(fine[i])) != 0) i++;
        if (i == sizeof fine / sizeof *fine)
            return td_fail(g->error, TIDES_UNSUPPORTED, "%s: is a glTF that needs the extension %.80s, which isn't read",
                           g->path, name);
    }
    return TIDES_OK;
}

static tides_status check_asset(const td_gltf *g) {
    const char *version = td_json_text(cJSON_GetObjectItemCaseSensitive(g->json, "asset"), "version");
    if (!version) return td_fail(g->error, TIDES_BAD_FILE, "%s: is no glTF: it has no asset.version", g->path);
    if (strncmp(version, "2.", 2) != 0)
        return td_fail(g->error, TIDES_UNSUPPORTED, "%s: is a glTF of version %.20s: 2.0 is read", g->path, version);
    return check_required(g);
}

tides_status td_gltf_open(td_gltf *g, const char *path, const void *data, size_t size, tides_error *error) {
    const unsigned char *bytes = data, *json = NULL;
    size_t length = 0;
    *g = (td_gltf){.path = path, .scene = -1, .error = error};
    tides_status status = TIDES_OK;
    if (size >= 4 && td_le32(bytes) == TD_GLTF_MAGIC) {
        status = find_chunks(g, bytes, size, &json, &length);
    } else {
        json = bytes;
        length = size;
    }
    if (!status) status = td_splat_json(path, NULL, json, length, &g->json, error);
    if (!status) status = check_asset(g);
    if (!status) status = index_list(g, "bufferViews", &g->views, &g->view_count);
    if (!status) status = index_list(g, "accessors", &g->accessors, &g->accessor_count);
    if (!status) status = index_list(g, "nodes", &g->nodes, &g->node_count);
    if (!status) status = index_list(g, "meshes", &g->meshes, &g->mesh_count);
    const cJSON *buffers = cJSON_GetObjectItemCaseSensitive(g->json, "buffers");
    g->buffer_count = cJSON_IsArray(buffers) ? cJSON_GetArraySize(buffers) : 0;
    if (!status && !(g->buffers = td_alloc((size_t)g->buffer_count, sizeof *g->buffers, error))) status = TIDES_NO_MEMORY;
    return status;
}

void td_gltf_close(td_gltf *g) {
    for (int64_t i = 0; g->buffers && i < g->buffer_count; i++) free(g->buffers[i].owned);
    free(g->buffers);
    free(g->views);
    free(g->accessors);
    free(g->nodes);
    free(g->meshes);
    cJSON_Delete(g->json);
}

/* -- buffers ------------------------------------------------------------------------------------------------------------- */

/* Decodes "%20" and the like in place. */
static void undo_percents(char *text) {
    static const char digits[] = "0123456789abcdef0123456789ABCDEF";
    char *to = text;
    for (; *text; text++) {
        const char *high = *text == '%' && text[1] ? strchr(digits, text[1]) : NULL;
        const char *low = high && text[2] ? strchr(digits, text[2]) : NULL;
        char byte = *text;
        if (low) byte = (char)((high - digits) % 16 * 16 + (low - digits) % 16);
        if (low) text += 2;
        *to++ = byte;
    }
    *to = 0;
}

/* The path of a file in the glTF's folder or below; the caller frees it. */
static tides_status name_beside(const td_gltf *g, const char *uri, char **name) {
    if (!(*name = td_strdup(uri, g->error))) return TIDES_NO_MEMORY;
    undo_percents(*name);
    if (td_json_is_below(*name) && !strchr(*name, ':')) return TIDES_OK;
    return td_fail(g->error, TIDES_UNSUPPORTED, "%s: its buffer is at %.80s: only files beside it are read", g->path, uri);
}

static int is_data(const char *uri) { return strncmp(uri, "data:", 5) == 0; }

static tides_status read_beside(const td_gltf *g, const char *uri, td_gltf_buffer *buffer) {
    char *name = NULL, *file = NULL, *data = NULL;
    tides_status status = name_beside(g, uri, &name);
    if (!status && !(file = td_beside(g->path, name, g->error))) status = TIDES_NO_MEMORY;
    if (!status)
        status = td_is_file(file) ? td_read_file(file, SIZE_MAX - 1, &data, &buffer->size, g->error)
                                  : td_fail(g->error, TIDES_FILE_NOT_FOUND, "%s: its buffer %.200s isn't there", g->path, file);
    buffer->owned = data;
    buffer->bytes = (const unsigned char *)data;
    free(name);
    free(file);
    return status;
}

static tides_status add_file(const td_gltf *g, const char *folder, const char *uri, td_folder *files) {
    char *name = NULL;
    tides_status status = name_beside(g, uri, &name);
    if (!status) status = td_folder_add(files, folder, name, g->error);
    free(name);
    return status;
}

/* Reads only the JSON of a binary file. It comes first, and the rest may be gigabytes. */
static tides_status read_json(const char *path, cJSON **json, tides_error *error) {
    enum { FRONT = 20 /* bytes of the file's and the first chunk's heads */, JSON_MOST = 1 << 28 };
    unsigned char front[FRONT];
    char *data = NULL;
    size_t size = 0;
    tides_status status = TIDES_OK;
    FILE *file = fopen(path, "rb");
    const int binary = file && fread(front, 1, FRONT, file) == FRONT && td_le32(front) == TD_GLTF_MAGIC;
    if (binary) {
        size = td_le32(front + 12);
        data = size < JSON_MOST ? td_alloc(size + 1, 1, error) : NULL;
        status = !data                                ? td_fail(error, TIDES_NO_MEMORY, "%s: its JSON is too large", path)
                 : fread(data, 1, size, file) == size ? TIDES_OK
                                                      : td_fail(error, TIDES_BAD_FILE, "%s: ends within its JSON", path);
    }
    if (file) fclose(file);
    if (!binary) status = td_read_file(path, SIZE_MAX - 1, &data, &size, error);
    if (!status) status = td_splat_json(path, NULL, (const unsigned char *)data, size, json, error);
    free(data);
    return status;
}

tides_status td_gltf_files(const char *path, const char *part, td_folder *files, tides_error *error) {
    (void)part;
    td_gltf g = {.path = path, .error = error};
    char *folder = td_folder_of(path, error);
    const cJSON *buffer;
    tides_status status = folder ? read_json(path, &g.json, error) : TIDES_NO_MEMORY;
    cJSON_ArrayForEach(buffer, cJSON_GetObjectItemCaseSensitive(g.json, "buffers")) {
        const char *uri = td_json_text(buffer, "uri");
        if (!status && uri && !is_data(uri)) status = add_file(&g, folder, uri, files);
    }
    td_gltf_close(&g);
    free(folder);
    return status;
}

static int base64_digit(char c) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *at = c ? strchr(digits, c) : NULL;
    return at ? (int)(at - digits) : -1;
}

/* Decodes "data:application/octet-stream;base64,AAAA". */
static tides_status read_data(const td_gltf *g, const char *uri, td_gltf_buffer *buffer) {
    const char *text = strstr(uri, ";base64,");
    if (!text) return td_fail(g->error, TIDES_UNSUPPORTED, "%s: has a buffer in its text that isn't base64", g->path);
    text += strlen(";base64,");
    unsigned char *bytes = td_alloc(strlen(text) / 4 + 1, 3, g->error);
    if (!bytes) return TIDES_NO_MEMORY;
    uint32_t word = 0;
    size_t size = 0;
    int bits = 0;
    for (; *text && *text != '='; text++) {
        const int digit = base64_digit(*text);
        if (digit < 0) {
            free(bytes);
            return td_fail(g->error, TIDES_BAD_FILE, "%s: a buffer in its text isn't valid base64", g->path);
        }
        word = word << 6 | (uint32_t)digit;
        if ((bits += 6) < 8) continue;
        bits -= 8;
        bytes[size++] = (unsigned char)(word >> bits);
    }
    *buffer = (td_gltf_buffer){bytes, size, bytes};
    return TIDES_OK;
}

static tides_status read_buffer(td_gltf *g, int64_t index) {
    const cJSON *json = cJSON_GetArrayItem(cJSON_GetObjectItemCaseSensitive(g->json, "buffers"), (int)index);
    const char *uri = td_json_text(json, "uri");
    td_gltf_buffer *buffer = &g->buffers[index];
    const int64_t length = td_json_whole(json, "byteLength", 1, INT64_C(1) << 52);
    tides_status status = TIDES_OK;
    if (buffer->bytes) return TIDES_OK;
    if (uri)
        status = is_data(uri) ? read_data(g, uri, buffer) : read_beside(g, uri, buffer);
    else if (g->chunk && index == 0)
        *buffer = (td_gltf_buffer){g->chunk, g->chunk_size, NULL};
    else
        status = td_fail(g->error, TIDES_BAD_FILE, "%s: buffer %lld has no bytes", g->path, (long long)index);
    if (status) return status;
    if (length < 0 || (uint64_t)length > buffer->size)
        return td_fail(g->error, TIDES_BAD_FILE, "%s: buffer %lld has %zu bytes, but its byteLength is %lld: truncated?",
                       g->path, (long long)index, buffer->size, (long long)length);
    buffer->size = (size_t)length;
    return TIDES_OK;
}

/* -- views and accessors ------------------------------------------------------------------------------------------------- */

/* object.key as a size: 0 if missing, -1 if invalid. */
static int64_t size_of(const cJSON *object, const char *key) {
    return cJSON_GetObjectItemCaseSensitive(object, key) ? td_json_whole(object, key, 0, INT64_C(1) << 52) : 0;
}

tides_status td_gltf_view(td_gltf *g, int64_t index, const unsigned char **bytes, size_t *size, size_t *stride) {
    const cJSON *json = index >= 0 && index < g->view_count ? g->views[index] : NULL;
    const int64_t buffer = td_json_whole(json, "buffer", 0, g->buffer_count - 1), offset = size_of(json, "byteOffset");
    const int64_t length = td_json_whole(json, "byteLength", 1, INT64_C(1) << 52), step = size_of(json, "byteStride");
    if (buffer < 0 || offset < 0 || length < 0 || step < 0)
        return td_fail(g->error, TIDES_BAD_FILE, "%s: bufferView %lld isn't there or isn't valid", g->path, (long long)index);
    tides_status status = read_buffer(g, buffer);
    if (status) return status;
    if ((uint64_t)(offset + length) > g->buffers[buffer].size)
        return td_fail(g->error, TIDES_BAD_FILE, "%s: bufferView %lld ends behind its buffer", g->path, (long long)index);
    *bytes = g->buffers[buffer].bytes + offset;
    *size = (size_t)length;
    if (stride) *stride = (size_t)step;
    return TIDES_OK;
}

/* Sets type, width and unit; 0 if such numbers aren't supported. */
static int describe(const cJSON *json, td_gltf_accessor *a) {
    static const struct {
        int size;
        double most;
    } types[] = {{1, 127}, {1, 255}, {2, 32767}, {2, 65535}, {0, 0}, {0, 0}, {4, 0}};
    static const char *const widths[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    const char *type = td_json_text(json, "type");
    const int64_t number = td_json_whole(json, "componentType", TD_GLTF_BYTE, TD_GLTF_FLOAT);
    for (int i = 0; type && i < 4; i++)
        if (strcmp(type, widths[i]) == 0) a->width = i + 1;
    if (number < TD_GLTF_BYTE || a->width == 0 || types[number - TD_GLTF_BYTE].size == 0) return 0;
    const int normalised = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(json, "normalized"));
    a->type = (int)number;
    a->size = types[number - TD_GLTF_BYTE].size;
    a->unit = normalised && a->type != TD_GLTF_FLOAT ? 1 / types[number - TD_GLTF_BYTE].most : 1;
    return 1;
}

tides_status td_gltf_access(td_gltf *g, int64_t index, const char *what, td_gltf_accessor *a) {
    const cJSON *json = index >= 0 && index < g->accessor_count ? g->accessors[index] : NULL;
    const int64_t count = td_json_whole(json, "count", 1, INT64_C(1) << 40), offset = size_of(json, "byteOffset");
    size_t size = 0, stride = 0;
    *a = (td_gltf_accessor){.width = 0};
    if (!json || count < 0 || offset < 0)
        return td_fail(g->error, TIDES_BAD_FILE, "%s: %s: accessor %lld isn't there or isn't valid", g->path, what,
                       (long long)index);
    if (!describe(json, a) || cJSON_GetObjectItemCaseSensitive(json, "sparse"))
        return td_fail(g->error, TIDES_UNSUPPORTED, "%s: %s: accessor %lld is of a kind that splats don't have", g->path, what,
                       (long long)index);
    if (!cJSON_GetObjectItemCaseSensitive(json, "bufferView"))
        return td_fail(g->error, TIDES_UNSUPPORTED,
                       "%s: %s has no bufferView: its numbers are where an extension says that isn't read", g->path, what);
    tides_status status = td_gltf_view(g, td_json_whole(json, "bufferView", 0, g->view_count - 1), &a->bytes, &size, &stride);
    if (status) return status;
    const size_t element = (size_t)a->width * (size_t)a->size, step = stride ? stride : element;
    if (step == 0 || step < element || (uint64_t)offset > size || size - (size_t)offset < element ||
        (uint64_t)(count - 1) > (size - (size_t)offset - element) / step)
        return td_fail(g->error, TIDES_BAD_FILE, "%s: %s: %lld elements of accessor %lld end behind its bufferView", g->path,
                       what, (long long)count, (long long)index);
    a->bytes += offset;
    a->count = (size_t)count;
    a->stride = step;
    return TIDES_OK;
}
