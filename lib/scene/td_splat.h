/* Internal: readers and writers of packed splat files, and the decoding of quantised bytes. */
#ifndef TD_SPLAT_H
#define TD_SPLAT_H

#include "scene/td_ply.h"
#include "scene/td_scene.h"
#include "td_folder.h"

/* -- readers: `path` is for messages only; on failure `gaussians` is unchanged. TIDES_BAD_FILE, TIDES_UNSUPPORTED,
 * TIDES_NO_MEMORY. Values are decoded, and checked later by td_scene_take. -- */

/* A compressed PLY, whose element vertex holds packed_position, packed_rotation, packed_scale and packed_color. */
int td_ply_is_packed(const td_ply_header *header);
tides_status td_ply_packed_read(const td_ply_file *file, const td_ply_header *header, td_gaussians *gaussians,
                                tides_error *error);

/* TIDES_UNSUPPORTED: says that the file has 2-D Gaussians, and what to do. */
tides_status td_splat_refuse_discs(const char *path, tides_error *error);

tides_status td_splat_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error);

/* Reads LCC from its .lcc, at level of detail `part` (NULL: the finest). td_lcc_files lists the files beside it that are
 * read. */
int td_lcc_is(const char *path); /* 1 if the file's name ends in .lcc */
tides_status td_lcc_read(const char *path, const char *part, td_gaussians *gaussians, tides_error *error);
tides_status td_lcc_files(const char *path, const char *part, td_folder *files, tides_error *error);
/* Reads LCC2 from its .lcc2, at level of detail `part` (NULL: the finest). td_lcc2_files lists the files of Gaussians, beside
 * it or below, that are read. */
int td_lcc2_is(const char *path);
tides_status td_lcc2_read(const char *path, const char *part, td_gaussians *gaussians, tides_error *error);
tides_status td_lcc2_files(const char *path, const char *part, td_folder *files, tides_error *error);

/* 1 if the bytes begin as a .splatv; reading returns its Gaussians and their motion, which belong to the caller. */
int td_splatv_is(const void *start, size_t size);
tides_status td_splatv_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_motion **motion,
                             tides_error *error);

/* 1 if the bytes begin as a .spz (gzip, or its magic number). */
int td_spz_is(const void *start, size_t size);
tides_status td_spz_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error);

/* 1 if the header is a .ksplat's; it needs the first TD_KSPLAT_START bytes. */
enum { TD_KSPLAT_START = 24 };
int td_ksplat_is(const void *start, size_t size, uint64_t file_size);
tides_status td_ksplat_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error);

/* SOG: a .sog in memory; or a folder with meta.json, or that meta.json. */
tides_status td_sog_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error);
tides_status td_sog_read_folder(const char *path, td_gaussians *gaussians, tides_error *error);
int td_sog_is_meta(const char *path); /* 1 if the file's name is meta.json */
int td_sog_is_zip(const char *path);  /* 1 if the file is a ZIP with a meta.json */

/* Streamed SOG: lod-meta.json or its folder, at level of detail `part` (NULL: the finest). td_sog_lod_files lists the
 * meta.json of each part that is read. */
tides_status td_sog_read_lod(const char *path, const char *part, td_gaussians *gaussians, tides_error *error);
tides_status td_sog_lod_files(const char *path, const char *part, td_folder *files, tides_error *error);
int td_sog_is_lod(const char *path); /* 1 if the file's name is lod-meta.json */

/* glTF, .glb or .gltf: the scene with name or number `part` (NULL: the default). td_gltf_files lists the files of its buffers,
 * beside it or below, for any part. lenient: as td_gltf_read_leniently. */
tides_status td_gltf_parse(const char *path, const void *data, size_t size, const char *part, int32_t lenient,
                           td_gaussians *gaussians, tides_error *error);
tides_status td_gltf_read(const char *path, const char *part, td_gaussians *gaussians, tides_error *error);
/* Like td_gltf_read, but a splat whose opacity is out of range becomes NaN, so that it can be left out later. */
tides_status td_gltf_read_leniently(const char *path, const char *part, td_gaussians *gaussians, tides_error *error);
tides_status td_gltf_files(const char *path, const char *part, td_folder *files, tides_error *error);

/* -- gzip and zstd into a buffer of known size -------------------------------------------------------------- */

/* Unpacks the first `size` bytes of a gzip file into the caller's buffer. `*more`: 1 if the stream goes on behind them; if it
 * ends there, its checksum was compared. */
tides_status td_gunzip(const char *path, const void *gzip, size_t bytes, unsigned char *out, size_t size, int *more,
                       tides_error *error);

/* 1 if `packed` bytes of gzip, or of zstd, can't give `size` bytes. Call it before memory is allocated. */
int td_gzip_lies(uint64_t size, size_t packed);
int td_zstd_lies(uint64_t size, size_t packed);

/* Unpacks exactly `size` bytes from one zstd frame; `what` names it in messages. */
tides_status td_unzstd(const char *path, const char *what, const void *frame, size_t bytes, unsigned char *out, size_t size,
                       tides_error *error);

/* -- values ------------------------------------------------------------------------------------------------------ */

/* Logit of an opacity in [0, 1]. 0 and 1, whose logits are infinite, become 2^-24 and 1 - 2^-24, the nearest that a float can
 * distinguish from them. */
float td_splat_logit(double opacity);

/* Natural logarithm of a scale. 0, a flat Gaussian, becomes float's smallest normal number; NaN for a negative scale. */
float td_splat_log_scale(double scale);

/* The opacity of a logit, and the quaternion scaled to length 1 (wxyz). */
double td_splat_opacity(float logit);
void td_splat_unit(const float q[4], double out[4]);

/* Rebuilds a quaternion from its three smaller components and the index of the largest (0 to 3), in any order of components. */
void td_splat_rebuild(const double others[3], unsigned largest, float q[4]);

/* -- records and axes of a .spz -- */

typedef struct td_spz_records {
    uint32_t system; /* 0 to 16: the axes; 0 is RUB, right up back */
    char *notes;     /* notes on records that aren't read; the caller's */
} td_spz_records;

/* Reads the records in `bytes`; bytes behind the last record are allowed. TIDES_BAD_FILE, TIDES_UNSUPPORTED,
 * TIDES_NO_MEMORY. */
tides_status td_spz_read_records(const char *path, const unsigned char *bytes, size_t size, td_spz_records *found,
                                 tides_error *error);

/* From a file's axes to those of a 3DGS .ply: signs of x, y and z, and then, if `turned`, a quarter turn about x. */
typedef struct td_spz_axes {
    double flips[3];
    int turned;
} td_spz_axes;
td_spz_axes td_spz_axes_of(uint32_t system);

/* td_spz_harmonic_sign: the sign of SH coefficient k (in the order of INRIA's 3DGS) if axes change signs by `flips`.
 * td_spz_turn: turns the Gaussians by the quarter turn, if the axes have one. */
float td_spz_harmonic_sign(const double flips[3], size_t k);
tides_status td_spz_turn(const td_spz_axes *axes, td_gaussians *gaussians, tides_error *error);

/* -- writers: means and scales are multiplied by `scale` -- */

tides_status td_splat_write(const char *path, const td_gaussians *gaussians, double scale, tides_error *error);
tides_status td_spz_write(const char *path, const td_gaussians *gaussians, double scale, tides_error *error);
tides_status td_gltf_write(const char *path, const td_gaussians *gaussians, double scale, tides_error *error);

#endif
