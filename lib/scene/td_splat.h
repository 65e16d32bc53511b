/* Internal: readers of packed splat files, one per format, and what they share: the numbers that
 * quantised bytes stand for. */
#ifndef TD_SPLAT_H
#define TD_SPLAT_H

#include "scene/td_ply.h"
#include "scene/td_scene.h"
#include "td_folder.h"

/* -- readers: `path` is for messages only; `gaussians` is untouched on failure. TIDES_BAD_FILE, TIDES_UNSUPPORTED,
 *    TIDES_NO_MEMORY. Values are decoded, not judged: td_scene_take does that. ------------------------------------------- */

/* A PLY whose element vertex holds packed_position and its like (ply_packed.c). */
int td_ply_is_packed(const td_ply_header *header);
tides_status td_ply_packed_read(const td_ply_file *file, const td_ply_header *header, td_gaussians *gaussians,
                                tides_error *error);

/* TIDES_UNSUPPORTED: a file of 2-D Gaussians, and what to do. */
tides_status td_splat_refuse_discs(const char *path, tides_error *error);

tides_status td_splat_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error);

/* LCC, by its .lcc, at level `part` of detail, NULL: the finest; and the files beside it that this reads (lcc.c). */
int td_lcc_is(const char *path); /* 1 where the file's name ends so */
tides_status td_lcc_read(const char *path, const char *part, td_gaussians *gaussians, tides_error *error);
tides_status td_lcc_files(const char *path, const char *part, td_folder *files, tides_error *error);
/* LCC2, by its .lcc2, and its files: as LCC (lcc2.c). */
int td_lcc2_is(const char *path);
tides_status td_lcc2_read(const char *path, const char *part, td_gaussians *gaussians, tides_error *error);
tides_status td_lcc2_files(const char *path, const char *part, td_folder *files, tides_error *error);

/* 1 where the bytes begin as a .splatv; its Gaussians and their motion, both the caller's (splatv.c). */
int td_splatv_is(const void *start, size_t size);
tides_status td_splatv_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_motion **motion,
                             tides_error *error);

/* 1 where the bytes begin as a .spz (gzip, or its magic number) does. */
int td_spz_is(const void *start, size_t size);
tides_status td_spz_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error);

/* 1 where the header is a .ksplat's; it needs TD_KSPLAT_START bytes of the file. */
enum { TD_KSPLAT_START = 24 };
int td_ksplat_is(const void *start, size_t size, uint64_t file_size);
tides_status td_ksplat_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error);

/* SOG: a .sog in memory; a folder with meta.json, or that file. */
tides_status td_sog_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error);
tides_status td_sog_read_folder(const char *path, td_gaussians *gaussians, tides_error *error);
int td_sog_is_meta(const char *path); /* 1 where the file's name is meta.json */
int td_sog_is_zip(const char *path);  /* 1 where the file is a ZIP with a meta.json */

/* Streamed SOG: lod-meta.json or its folder, at level `part` of detail, NULL: the finest (sog_lod.c). The files that this
 * reads: the meta.json of each part. */
tides_status td_sog_read_lod(const char *path, const char *part, td_gaussians *gaussians, tides_error *error);
tides_status td_sog_lod_files(const char *path, const char *part, td_folder *files, tides_error *error);
int td_sog_is_lod(const char *path); /* 1 where the file's name is lod-meta.json */

/* glTF, .glb or .gltf (gltf_splats.c): its default scene; td_gltf_read: or that which `part` (nullable) names, or numbers. The
 * files that its buffers are in, beside it or below, whatever the part (gltf.c). */
tides_status td_gltf_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error);
tides_status td_gltf_read(const char *path, const char *part, td_gaussians *gaussians, tides_error *error);
/* As td_gltf_read, but a splat whose opacity is out of range becomes NaN, for td_gaussians_drop to leave out. */
tides_status td_gltf_read_leniently(const char *path, const char *part, td_gaussians *gaussians, tides_error *error);
tides_status td_gltf_files(const char *path, const char *part, td_folder *files, tides_error *error);

/* -- inflate.c: gzip and zstd into a buffer of known size -------------------------------------------------------------- */

/* Unpacks the first `size` bytes of a gzip file: out of memory before `out` is full is impossible, since `out` is the
 * caller's. `*more` is set where the stream goes on behind them; where it ends there, its checksum has been compared. */
tides_status td_gunzip(const char *path, const void *gzip, size_t bytes, unsigned char *out, size_t size, int *more,
                       tides_error *error);

/* 1 where `size` bytes can't possibly come out of `packed` bytes of gzip, or of zstd: to be asked before memory is. */
int td_gzip_lies(uint64_t size, size_t packed);
int td_zstd_lies(uint64_t size, size_t packed);

/* Exactly `size` bytes out of one zstd frame; `what` names it in messages. */
tides_status td_unzstd(const char *path, const char *what, const void *frame, size_t bytes, unsigned char *out, size_t size,
                       tides_error *error);

/* -- splat_values.c ------------------------------------------------------------------------------------------------------ */

/* Logit of an opacity in [0, 1]. The ends, whose logits are infinite, become the nearest that float tells from them:
 * 2^-24 and 1 - 2^-24. */
float td_splat_logit(double opacity);

/* Natural logarithm of a scale. 0, a flat Gaussian, becomes float's smallest normal number; NaN where negative. */
float td_splat_log_scale(double scale);

/* The opacity of a logit, and the quaternion scaled to length 1 (wxyz). */
double td_splat_opacity(float logit);
void td_splat_unit(const float q[4], double out[4]);

/* A quaternion of its three components but the largest, and which that is (0 to 3), all in one order: wxyz or another. */
void td_splat_rebuild(const double others[3], unsigned largest, float q[4]);

/* -- spz_axes.c: what extends a .spz -- */

typedef struct td_spz_records {
    uint32_t system; /* 0 to 16: the axes; 0 is RUB, right up back */
    char *notes;     /* what isn't read, as td_gaussians has it; the caller's */
} td_spz_records;

/* Records in `bytes`, and what may be left behind the last one. TIDES_BAD_FILE, TIDES_UNSUPPORTED, TIDES_NO_MEMORY. */
tides_status td_spz_read_records(const char *path, const unsigned char *bytes, size_t size, td_spz_records *found,
                                 tides_error *error);

/* From a file's axes to those of a 3DGS .ply: signs of x, y and z, and then perhaps a quarter turn about x. */
typedef struct td_spz_axes {
    double flips[3];
    int turned;
} td_spz_axes;
td_spz_axes td_spz_axes_of(uint32_t system);

/* The sign that coefficient k of INRIA's order gets with such signs of the axes; and the turn, of Gaussians that have them. */
float td_spz_harmonic_sign(const double flips[3], size_t k);
tides_status td_spz_turn(const td_spz_axes *axes, td_gaussians *gaussians, tides_error *error);

/* -- splat_write.c, gltf_write.c: whole files, means and scales times `scale` -- */

tides_status td_splat_write(const char *path, const td_gaussians *gaussians, double scale, tides_error *error);
tides_status td_spz_write(const char *path, const td_gaussians *gaussians, double scale, tides_error *error);
tides_status td_gltf_write(const char *path, const td_gaussians *gaussians, double scale, tides_error *error);

#endif
