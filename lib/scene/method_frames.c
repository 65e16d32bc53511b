/* Reads a sequence of plain 3DGS .ply files, one per frame, with the same Gaussians (4DGaussians' export_perframe_3DGS.py:
 * gaussian_pertimestamp/time_00000.ply ..). They become keyframes at equal distances from 0 to 1. */
#include "scene/td_method_arrays.h"

#include "td_base.h"

#include <stdlib.h>
#include <string.h>

enum { MEAN = 0, QUATERNION, LOG_SCALE, LOGIT, SH, PARTS };

typedef struct sequence {
    int64_t frames;
    size_t width[PARTS]; /* numbers per Gaussian */
    float *value[PARTS]; /* (frames x count x width) */
    double *mean;        /* (frames x count x 3) in double, if a file has more than single precision; else NULL */
    double *time;
    td_gaussians first;
} sequence;

static void parts_of(const td_gaussians *g, const float *part[PARTS]) {
    part[MEAN] = g->mean;
    part[QUATERNION] = g->quaternion;
    part[LOG_SCALE] = g->log_scale;
    part[LOGIT] = g->opacity_logit;
    part[SH] = g->sh;
}

static tides_status read_ply(const char *path, td_gaussians *gaussians, tides_error *error) {
    char *data = NULL;
    size_t bytes = 0;
    tides_status status = td_read_file(path, SIZE_MAX / 2, &data, &bytes, error);
    if (status == TIDES_OK) status = td_ply_parse(path, data, bytes, gaussians, error);
    if (status == TIDES_OK) {
        status = td_gaussians_check(gaussians, 1, TIDES_BAD_FILE, error);
        if (status != TIDES_OK) td_fail_within(error, status, "%s", path);
    }
    free(data);
    return status;
}

static tides_status sequence_begin(sequence *s, tides_error *error) {
    const size_t widths[PARTS] = {3, 4, 3, 1, 3 * td_sh_coefficients(s->first.sh_degree)};
    s->time = td_alloc((size_t)s->frames, sizeof *s->time, error);
    if (!s->time) return TIDES_NO_MEMORY;
    for (int64_t i = 0; i < s->frames; i++) s->time[i] = (double)i / (double)(s->frames - 1);
    for (int part = 0; part < PARTS; part++) {
        size_t row = widths[part] * sizeof(float);
        s->width[part] = widths[part];
        if ((size_t)s->frames > SIZE_MAX / row)
            return td_fail(error, TIDES_UNSUPPORTED, "%lld frames are more than memory can be", (long long)s->frames);
        s->value[part] = td_alloc((size_t)s->first.count, (size_t)s->frames * row, error);
        if (!s->value[part]) return TIDES_NO_MEMORY;
    }
    return TIDES_OK;
}

/* Stores means in double from the first frame that has them; earlier frames' means are converted. */
static tides_status add_means(sequence *s, int64_t frame, const td_gaussians *g, tides_error *error) {
    size_t reals = 3 * (size_t)g->count, before = (size_t)frame * reals;
    if (!g->mean_double && !s->mean) return TIDES_OK;
    if (!s->mean) {
        s->mean = td_alloc((size_t)s->frames * reals, sizeof *s->mean, error);
        if (!s->mean) return TIDES_NO_MEMORY;
        for (size_t i = 0; i < before; i++) s->mean[i] = s->value[MEAN][i];
    }
    for (size_t i = 0; i < reals; i++) s->mean[before + i] = g->mean_double ? g->mean_double[i] : (double)g->mean[i];
    return TIDES_OK;
}

static tides_status add_frame(sequence *s, int64_t frame, const td_gaussians *g, const char *path, tides_error *error) {
    const float *own[PARTS];
    if (g->count != s->first.count || g->sh_degree != s->first.sh_degree)
        return td_fail(error, TIDES_BAD_FILE, "%s: holds %lld Gaussians of SH degree %d, the first frame %lld of %d", path,
                       (long long)g->count, g->sh_degree, (long long)s->first.count, s->first.sh_degree);
    parts_of(g, own);
    for (int part = 0; part < PARTS; part++) {
        size_t reals = (size_t)g->count * s->width[part];
        memcpy(s->value[part] + (size_t)frame * reals, own[part], reals * sizeof *own[part]);
    }
    return add_means(s, frame, g, error);
}

static tides_status sequence_read(sequence *s, const td_model_dir *dir, tides_error *error) {
    tides_status status = read_ply(dir->frames[0], &s->first, error);
    if (status == TIDES_OK) status = sequence_begin(s, error);
    if (status == TIDES_OK) status = add_frame(s, 0, &s->first, dir->frames[0], error);
    for (int64_t i = 1; i < s->frames && status == TIDES_OK; i++) {
        td_gaussians g = {0};
        status = read_ply(dir->frames[i], &g, error);
        if (status == TIDES_OK) status = add_frame(s, i, &g, dir->frames[i], error);
        td_gaussians_free(&g);
    }
    return status;
}

/* Returns the part's values, or NULL if all frames have the same ones. */
static const float *changing(const sequence *s, int part) {
    size_t reals = (size_t)s->first.count * s->width[part];
    for (int64_t i = 1; i < s->frames; i++)
        if (memcmp(s->value[part], s->value[part] + (size_t)i * reals, reals * sizeof(float)) != 0) return s->value[part];
    return NULL;
}

tides_status td_frames_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error) {
    sequence s = {.frames = (int64_t)dir->frame_count};
    tides_motion *moves = NULL;
    if (dir->frame_count < 2)
        return td_fail(error, TIDES_BAD_FILE, "%s: holds %zu frame: needs two or more", dir->folder, dir->frame_count);
    tides_status status = sequence_read(&s, dir, error);
    if (status == TIDES_OK) {
        tides_keyframes_motion arrays = {.frames = s.frames, .count = s.first.count, .time = s.time, .mean = s.value[MEAN]};
        arrays.mean_double = s.mean;
        arrays.quaternion = s.value[QUATERNION];
        arrays.log_scale = changing(&s, LOG_SCALE);
        arrays.opacity_logit = changing(&s, LOGIT);
        arrays.sh = changing(&s, SH);
        arrays.sh_degree = s.first.sh_degree;
        status = tides_motion_create_keyframes(&arrays, &moves, error);
    }
    for (int part = 0; part < PARTS; part++) free(s.value[part]);
    free(s.time);
    free(s.mean);
    return td_arrays_finish(status, dir->folder, &s.first, moves, gaussians, motion, error);
}
