/* Reads and writes scene files: finds the reader from a file's content, and the writer from its ending. */
#include "td_base.h"
#include "td_folder.h"
#include "td_kinds.h"
#include "td_struct.h"
#include "td_model_dir.h"
#include "td_scene.h"
#include "td_splat.h"

#include <errno.h>
#include <float.h>
#include <hdf5.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static tides_status add_model(tides_scene *scene, const char *path, const tides_trajectory *trajectory, double scale,
                              tides_error *error) {
    td_model_dir dir;
    tides_status status = td_model_dir_find(path, scene->part, &dir, error);
    if (status) return status;
    if (dir.others)
        status = td_note(&scene->notes, error, "%s: iteration %lld is read, of %s: scene.part names another", path,
                         (long long)dir.iteration, dir.others);
    if (!status) status = td_scene_add_model(scene, &dir, trajectory, scale, error);
    td_model_dir_free(&dir);
    return status;
}

/* The start of a file, from which its format is detected. */
typedef struct beginning {
    const char *file;
    int folder; /* 1: a folder, so nothing below is set */
    unsigned char bytes[TD_KSPLAT_START];
    size_t got;
    uint64_t size;
} beginning;

static int is_ply(const beginning *b) {
    return b->got >= 4 && memcmp(b->bytes, "ply", 3) == 0 && (b->bytes[3] == '\n' || b->bytes[3] == '\r');
}

static int is_lcc(const beginning *b) { return !b->folder && td_lcc_is(b->file); }
static int is_lcc2(const beginning *b) { return !b->folder && td_lcc2_is(b->file); }
static int is_splatv(const beginning *b) { return td_splatv_is(b->bytes, b->got); }
static int is_spz(const beginning *b) { return td_spz_is(b->bytes, b->got); }

static int is_hdf5(const beginning *b) {
    htri_t found;
    if (b->folder) return 0;
    H5E_BEGIN_TRY { found = H5Fis_hdf5(b->file); }
    H5E_END_TRY
    return found > 0;
}

/* .ksplat has no magic number and .splat not even a header, so their endings count, too. */
static int is_ksplat(const beginning *b) { return td_ksplat_is(b->bytes, b->got, b->size) || td_ends_in(b->file, ".ksplat"); }
static int is_splat(const beginning *b) { return td_ends_in(b->file, ".splat"); }

static int is_sog(const beginning *b) { return b->got >= 4 && memcmp(b->bytes, "PK\3\4", 4) == 0 && td_sog_is_zip(b->file); }

/* 1 if the path is a folder that holds a file of this name. */
static int holds(const beginning *b, const char *name) {
    char *file = b->folder ? td_format(NULL, "%s/%s", b->file, name) : NULL;
    const int found = file && td_is_file(file);
    free(file);
    return found;
}

static int is_sog_folder(const beginning *b) { return b->folder ? holds(b, "meta.json") : td_sog_is_meta(b->file); }
static int is_sog_lod(const beginning *b) { return b->folder ? holds(b, "lod-meta.json") : td_sog_is_lod(b->file); }

static int is_gltf(const beginning *b) {
    return (b->got >= 4 && memcmp(b->bytes, "glTF", 4) == 0) || (!b->folder && td_ends_in(b->file, ".gltf"));
}

/* The beginning of a Git LFS pointer, which stands in for a large file that Git hasn't fetched. */
static const char pointer[] = "version https://git-lfs";
static int is_pointer(const beginning *b) {
    return b->got >= sizeof pointer - 1 && memcmp(b->bytes, pointer, sizeof pointer - 1) == 0;
}
static tides_status refuse_pointer(const char *path, td_gaussians *gaussians, tides_error *error) {
    (void)gaussians;
    return td_kind_refuse(path, TD_WANTS_SCENE, error);
}

/* A function that writes the Gaussians of one object at rest. */
typedef tides_status (*writer)(const char *path, const td_gaussians *gaussians, double scale, tides_error *error);

/* One row per format; all lists of formats come from this table. A file has the first format whose `is` returns 1, so rows with
 * the surest signs come first. A row without a summary isn't a format, but stands for files that Git hasn't fetched. A row
 * without a reader is TIDES's own format, which stores everything. */
static const struct format {
    int (*is)(const beginning *b);
    td_scene_reader with;
    writer write;
    const char *endings, *summary;
    int32_t losses; /* TIDES_LOSES_*: facts that the format can't store */
} formats[] = {
    {is_pointer, {.read = refuse_pointer}, NULL, "", NULL, 0},
    {is_ply, {.parse = td_ply_parse}, td_ply_write, ".ply", "3DGS by property name; compressed too", 0},
    {is_spz,
     {.parse = td_spz_parse},
     td_spz_write,
     ".spz",
     "Niantic's, versions 1 to 4",
     TIDES_LOSES_UP | TIDES_LOSES_TRANSFER},
    {is_sog, {.parse = td_sog_parse}, NULL, ".sog", "PlayCanvas's, versions 1 and 2", 0},
    {is_gltf,
     {.choose = td_gltf_read},
     td_gltf_write,
     ".glb .gltf",
     "glTF with KHR_gaussian_splatting",
     TIDES_LOSES_TRAINED | TIDES_LOSES_UP | TIDES_LOSES_EXPONENT},
    {is_sog_lod, {.choose = td_sog_read_lod}, NULL, "lod-meta.json", "streamed SOG, or its folder", 0},
    {is_sog_folder, {.read = td_sog_read_folder}, NULL, "meta.json", "unpacked SOG, or its folder", 0},
    {is_splatv, {.moving = td_splatv_parse}, NULL, ".splatv", "splaTV's SpacetimeGaussians", 0},
    {is_lcc, {.choose = td_lcc_read}, NULL, ".lcc", "XGRIDS' LCC, with the .bin files beside it", 0},
    {is_lcc2, {.choose = td_lcc2_read}, NULL, ".lcc2", "XGRIDS' LCC2, with the .sog, .spz or .ply files below it", 0},
    {is_hdf5, {.parse = NULL}, NULL, ".h5", "TIDES's own, which holds everything", 0},
    {is_ksplat, {.parse = td_ksplat_parse}, NULL, ".ksplat", "mkkellogg's", 0},
    {is_splat,
     {.parse = td_splat_parse},
     td_splat_write,
     ".splat",
     "antimatter15's",
     TIDES_LOSES_HARMONICS | TIDES_LOSES_TRAINED | TIDES_LOSES_UP | TIDES_LOSES_TRANSFER},
};
enum { FORMATS = sizeof formats / sizeof formats[0] };

static int is_own(const struct format *format) {
    return !format->with.parse && !format->with.read && !format->with.choose && !format->with.moving;
}

int32_t tides_scene_format_at(size_t index, tides_scene_format *format) {
    for (size_t i = 0; i < FORMATS; i++) {
        const struct format *row = &formats[i];
        if (!row->summary || index-- > 0) continue;
        *format = (tides_scene_format){row->endings, row->summary, row->write != NULL || is_own(row), row->losses};
        return 1;
    }
    return 0;
}

/* Lists the first endings of all formats, or of those with a writer: "a, b or c". */
enum { LIST = 256 };
static const char *list_formats(int written, char text[LIST]) {
    size_t used = 0, last = 0;
    tides_scene_format format;
    for (size_t i = 0; tides_scene_format_at(i, &format) && used < LIST; i++) {
        if (written && !format.writes) continue;
        last = used;
        used += (size_t)snprintf(text + used, LIST - used, "%s%.*s", used ? ", " : "", (int)strcspn(format.endings, " "),
                                 format.endings);
    }
    char tail[64];
    snprintf(tail, sizeof tail, " or %s", text + last + 2);
    snprintf(text + last, LIST - last, "%s", tail);
    return text;
}

/* Index into `formats`; FORMATS if the content is unknown. */
static size_t format_of(const beginning *b) {
    size_t i = 0;
    while (i < FORMATS && !formats[i].is(b)) i++;
    return i;
}

static tides_status read_beginning(const char *file, beginning *b, tides_error *error) {
    struct stat facts;
    if (stat(file, &facts) != 0) return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", file, strerror(errno));
    *b = (beginning){.file = file, .folder = S_ISDIR(facts.st_mode)};
    if (b->folder) return TIDES_OK;
    if (!S_ISREG(facts.st_mode)) return td_fail(error, TIDES_BAD_FILE, "%s: is not a regular file", file);
    FILE *in = fopen(file, "rb");
    if (!in) return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", file, strerror(errno));
    b->size = (uint64_t)facts.st_size;
    b->got = fread(b->bytes, 1, sizeof b->bytes, in);
    fclose(in);
    if (b->got == 0) return td_fail(error, TIDES_BAD_FILE, "%s: is empty: a .ply or .h5 scene was expected", file);
    return TIDES_OK;
}

int32_t tides_scene_is_file(const char *file) {
    beginning start;
    if (file && td_model_dir_is(file)) return 1;
    return file && read_beginning(file, &start, NULL) == TIDES_OK && format_of(&start) < FORMATS;
}

static tides_status add_file(tides_scene *scene, const char *file, const tides_trajectory *trajectory, double scale,
                             tides_error *error) {
    if (!(scale > 0 && scale <= FLT_MAX))
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: scale is %g: must be a positive number within float's range", file,
                       scale);
    beginning start;
    tides_status status = read_beginning(file, &start, error);
    if (status) return status;
    size_t format = format_of(&start);
    if (start.folder ? format == FORMATS : td_model_dir_is(file)) return add_model(scene, file, trajectory, scale, error);
    if (format == FORMATS && (status = td_kind_refuse(file, TD_WANTS_SCENE, error)) != TIDES_OK) return status;
    char list[LIST];
    if (format == FORMATS)
        return td_fail(error, TIDES_BAD_FILE, "%s: is no scene, neither %s: convert it to a 3DGS .ply first", file,
                       list_formats(0, list));
    if (!is_own(&formats[format])) return td_scene_read_one(scene, file, formats[format].with, NULL, trajectory, scale, error);
    return td_scene_hdf5_read(scene, file, trajectory, scale, error);
}

void tides_scene_options_defaults(tides_scene_options *options) { *options = (tides_scene_options){.size = sizeof *options}; }

tides_status tides_scene_read(tides_scene *scene, const char *file, const tides_scene_options *options,
                              const tides_trajectory *trajectory, double scale, tides_error *error) {
    tides_scene_options own;
    tides_scene_options_defaults(&own);
    if (!scene || !file) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_scene_read: %s is NULL", scene ? "file" : "scene");
    tides_status status = options ? TD_TAKE_STRUCT(tides_scene_options, &own, options, error) : TIDES_OK;
    if (status) return status;
    if (own.invalid < TIDES_INVALID_ERROR || own.invalid > TIDES_INVALID_DROP)
        return td_fail(error, TIDES_BAD_ARGUMENT, "scene.invalid: %d is none of TIDES_INVALID_*", (int)own.invalid);
    scene->drop = own.invalid == TIDES_INVALID_DROP;
    scene->part = own.part;
    status = add_file(scene, file, trajectory, scale, error);
    scene->drop = 0;
    scene->part = NULL;
    return status;
}

tides_status tides_scene_add_file(tides_scene *scene, const char *file, const tides_trajectory *trajectory, double scale,
                                  tides_error *error) {
    if (!scene || !file)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_scene_add_file: %s is NULL", scene ? "file" : "scene");
    return tides_scene_read(scene, file, NULL, trajectory, scale, error);
}

/* The ending of the name, if it is one of the format's; otherwise NULL. */
static const char *ending_of(const char *file, const struct format *format, char ending[32]) {
    for (const char *at = format->endings; *at; at += strcspn(at, " "), at += *at == ' ') {
        snprintf(ending, 32, "%.*s", (int)strcspn(at, " "), at);
        if (ending[0] == '.' && td_ends_in(file, ending)) return ending;
    }
    return NULL;
}

/* Saves to a format that stores the Gaussians of one object at rest. */
static tides_status save_one(const tides_scene *scene, const char *file, writer write, const char *ending, tides_error *error) {
    if (scene->count > 1)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: a %s holds one object and the scene has %zu: save it as .h5", file,
                       ending, scene->count);
    const td_object *object = &scene->objects[0];
    if (object->trajectory)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: a %s has no place for the trajectory of '%.80s': save it as .h5", file,
                       ending, object->name);
    if (object->motion)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: a %s has no place for the motion of '%.80s': save it as .h5", file,
                       ending, object->name);
    td_gaussians gaussians = object->gaussians; /* a view: the arrays still belong to the object */
    tides_scene_up(scene, gaussians.up);
    return write(file, &gaussians, object->scale, error);
}

tides_status tides_scene_save(const tides_scene *scene, const char *file, tides_error *error) {
    if (!scene || !file) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_scene_save: %s is NULL", scene ? "file" : "scene");
    if (scene->count == 0) return td_fail(error, TIDES_BAD_ARGUMENT, "%s: the scene is empty: add an object first", file);
    char ending[32], list[LIST];
    for (size_t i = 0; i < FORMATS; i++) {
        const int written = formats[i].summary && (formats[i].write || is_own(&formats[i]));
        if (!written || !ending_of(file, &formats[i], ending)) continue;
        if (formats[i].write && strncmp(formats[i].endings, ending, strlen(ending)) == 0) /* .gltf can't be written */
            return save_one(scene, file, formats[i].write, ending, error);
        if (is_own(&formats[i])) return td_scene_hdf5_write(scene, file, error);
    }
    return td_fail(error, TIDES_BAD_ARGUMENT, "%s: a scene is saved as %s: the name should end in one of them", file,
                   list_formats(1, list));
}
