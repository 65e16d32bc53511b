/* What a run of a batch depends on, as a hash: the run with every default filled in, the files that it reads, the device that
 * was asked for, and the library's numerics. And what memory it will want. */
#include "batch.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Memory of a run: a process with an OpenCL compiler in it; a scene in the file's form, unpacked, and on the device; state and
 * channels of a pixel. Coarse, and corrected by the first run that ends (batch_pool.c). */
#define PROCESS_BYTES 200e6
#define SCENE_FACTOR 4.0
#define PIXEL_BYTES 600.0
/* Where only the path file knows. */
#define UNKNOWN_PIXELS (1280.0 * 720.0)

/* Files that were hashed: most runs of a batch share theirs. */
typedef struct hashed {
    char *path;
    uint64_t hash;
    double bytes;
} hashed;
typedef struct hashed_files {
    hashed *items;
    size_t count, capacity;
} hashed_files;

/* FNV-1a: no defence against malice, and none is needed. */
static uint64_t mix(uint64_t hash, const void *data, size_t bytes) {
    const unsigned char *at = data;
    for (size_t i = 0; i < bytes; i++) hash = (hash ^ at[i]) * 0x100000001b3u;
    return hash;
}

static uint64_t mix_text(uint64_t hash, const char *text) { return mix(hash, text, strlen(text) + 1); }

static tides_status hash_content(const char *path, uint64_t *hash, tides_error *error) {
    enum { PIECE = 1 << 18 };
    unsigned char *piece = malloc(PIECE);
    FILE *file = piece ? fopen(path, "rb") : NULL;
    tides_status status = TIDES_OK;
    if (!piece)
        status = batch_no_memory(error);
    else if (!file)
        status = cli_error(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", path, strerror(errno));
    else {
        size_t got;
        while ((got = fread(piece, 1, PIECE, file)) > 0) *hash = mix(*hash, piece, got);
        if (ferror(file)) status = cli_error(error, TIDES_BAD_FILE, "%s: can't be read", path);
    }
    if (file) fclose(file);
    free(piece);
    return status;
}

/* A dataset's or model's folder: names, sizes and ages of its entries, for it may hold gigabytes of pictures. */
static tides_status hash_folder(const char *path, uint64_t *hash, double *bytes, tides_error *error) {
    struct dirent **entries = NULL;
    const int count = scandir(path, &entries, NULL, alphasort);
    if (count < 0) return cli_error(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", path, strerror(errno));
    tides_status status = TIDES_OK;
    for (int i = 0; i < count; i++) {
        struct stat found;
        char *name = entries[i]->d_name[0] == '.' ? NULL : batch_text("%s/%s", path, entries[i]->d_name);
        if (name && stat(name, &found) == 0) {
            const int64_t facts[2] = {(int64_t)found.st_size, (int64_t)found.st_mtim.tv_sec};
            *hash = mix(mix_text(*hash, entries[i]->d_name), facts, sizeof facts);
            *bytes += (double)found.st_size;
        }
        free(name);
        free(entries[i]);
    }
    free(entries);
    return status;
}

static tides_status hash_path(const char *path, hashed *made, tides_error *error) {
    struct stat found;
    if (stat(path, &found) != 0)
        return cli_error(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", path, strerror(errno));
    if (S_ISDIR(found.st_mode)) return hash_folder(path, &made->hash, &made->bytes, error);
    made->bytes = (double)found.st_size;
    return hash_content(path, &made->hash, error);
}

/* Mixes a file in. */
static tides_status add_file(hashed_files *files, const char *path, uint64_t *hash, double *bytes, tides_error *error) {
    size_t i = 0;
    while (i < files->count && strcmp(files->items[i].path, path) != 0) i++;
    if (i == files->count) {
        hashed made = {.path = NULL, .hash = 0xcbf29ce484222325u, .bytes = 0};
        tides_status status = hash_path(path, &made, error);
        if (status != TIDES_OK) return status;
        if (files->count == files->capacity) {
            const size_t capacity = files->capacity ? 2 * files->capacity : 16;
            hashed *items = realloc(files->items, capacity * sizeof *items);
            if (!items) return batch_no_memory(error);
            files->items = items;
            files->capacity = capacity;
        }
        if (!(made.path = batch_text("%s", path))) return batch_no_memory(error);
        files->items[files->count++] = made;
    }
    *hash = mix(*hash, &files->items[i].hash, sizeof files->items[i].hash);
    *bytes += files->items[i].bytes;
    return TIDES_OK;
}

/* One file of an entry of scene.objects; null and absent ones are none. */
static tides_status add_object_file(hashed_files *files, const batch_run *run, const cJSON *name, uint64_t *hash, double *bytes,
                                    tides_error *error) {
    if (!cJSON_IsString(name)) return TIDES_OK;
    const char *slash = strrchr(run->file, '/');
    const int length = slash && name->valuestring[0] != '/' ? (int)(slash - run->file + 1) : 0;
    char *path = batch_text("%.*s%s", length, run->file, name->valuestring);
    tides_status status = path ? add_file(files, path, hash, bytes, error) : batch_no_memory(error);
    free(path);
    return status;
}

/* The files that the run reads. */
static tides_status add_inputs(hashed_files *files, const batch_run *run, const tides_run_values *v, uint64_t *hash,
                               double *bytes, tides_error *error) {
    tides_status status = v->scene_file ? add_file(files, v->scene_file, hash, bytes, error) : TIDES_OK;
    if (status == TIDES_OK) status = add_file(files, v->camera_file, hash, bytes, error);
    cJSON *json = cJSON_Parse(v->json);
    const cJSON *scene = cJSON_GetObjectItemCaseSensitive(json, "scene"), *object = NULL;
    const cJSON *objects = cJSON_GetObjectItemCaseSensitive(scene, "objects");
    cJSON_ArrayForEach(object, objects) {
        const cJSON *file = cJSON_GetObjectItemCaseSensitive(object, "file");
        const cJSON *trajectory = cJSON_GetObjectItemCaseSensitive(object, "trajectory");
        if (status == TIDES_OK) status = add_object_file(files, run, file, hash, bytes, error);
        if (status == TIDES_OK) status = add_object_file(files, run, trajectory, hash, bytes, error);
    }
    cJSON_Delete(json);
    return status;
}

/* A run that the reader refuses is the manifest's fault, and an error; a file that isn't there is this run's alone. */
static tides_status prepare(const batch *b, hashed_files *files, batch_run *run, tides_error *error) {
    tides_run *loaded = NULL;
    tides_run_values v;
    tides_error reason = {TIDES_OK, ""};
    tides_status status = tides_run_load(run->file, (const char *const *)run->sets, run->count, &loaded, &reason);
    if (status != TIDES_OK) return cli_error(error, status, "%s: %s: %.800s", b->manifest, run->name, reason.text);
    tides_run_get(loaded, &v);
    const int32_t numerics = TIDES_NUMERICS;
    uint64_t hash = mix(0xcbf29ce484222325u, &numerics, sizeof numerics);
    hash = mix_text(mix_text(hash, v.json), b->common->device ? b->common->device : "");
    double bytes = 0;
    status = add_inputs(files, run, &v, &hash, &bytes, &reason);
    const double pixels = (double)v.intrinsics.width * v.intrinsics.height;
    run->estimate = PROCESS_BYTES + SCENE_FACTOR * bytes + PIXEL_BYTES * (pixels > 0 ? pixels : UNKNOWN_PIXELS);
    snprintf(run->hash, sizeof run->hash, "%016" PRIx64, hash);
    tides_run_destroy(loaded);
    if (status == TIDES_OK) return TIDES_OK;
    run->hash[0] = '\0'; /* of a part */
    run->state = BATCH_FAILED;
    return (run->error = batch_text("%s", reason.text)) ? TIDES_OK : batch_no_memory(error);
}

tides_status batch_prepare(batch *b, tides_error *error) {
    hashed_files files = {NULL, 0, 0};
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < b->count; i++) status = prepare(b, &files, &b->runs[i], error);
    for (size_t i = 0; i < files.count; i++) free(files.items[i].path);
    free(files.items);
    return status;
}
