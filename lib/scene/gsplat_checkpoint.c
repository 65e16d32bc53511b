/* Reads gsplat's checkpoint, {"step", "splats": {means [N, 3], scales [N, 3] (log), quats [N, 4] (wxyz, raw), opacities [N]
 * (logit), sh0 [N, 1, 3], shN [N, K - 1, 3]}}: raw parameters (gsplat, examples/simple_trainer.py). The training mode is in
 * the trainer's cfg.yml, one setting per line. It is looked for in the folder of the model or of the named file, then in the
 * folder above. */
#include "archive/td_pickle.h"
#include "scene/td_model_dir.h"
#include "td_base.h"
#include "td_folder.h"
#include "td_splat.h"

#include <stdlib.h>
#include <string.h>

/* The SH degree, by shN's second extent K - 1; 0 without shN, -1 if no degree has K coefficients. */
static int32_t degree_of(const td_value *splats) {
    const td_value *rest = td_value_get(splats, "shN");
    if (!rest) return 0;
    for (int32_t d = 0; d <= TIDES_SH_DEGREE_MAX; d++)
        if (rest->kind == TD_VALUE_TENSOR && rest->as.tensor->ndim == 3 &&
            rest->as.tensor->shape[1] + 1 == (int64_t)td_sh_coefficients(d))
            return d;
    return -1;
}

/* Reads floats, also NaN and Inf: later checks refuse or drop these, and name the Gaussian. */
static tides_status read_floats(const td_value *splats, const char *key, int ndim, const int64_t *shape, float **values,
                                tides_error *error) {
    const td_tensor *tensor = NULL;
    tides_status status = td_value_tensor(splats, key, &tensor, error);
    if (!status) status = td_tensor_check_shape(tensor, key, ndim, shape, error);
    return status ? status : td_tensor_floats(tensor, values, error);
}

static tides_status read_array(const td_value *splats, const char *key, int ndim, const int64_t *shape, float *out,
                               tides_error *error) {
    float *values = NULL;
    size_t count = 1;
    tides_status status = read_floats(splats, key, ndim, shape, &values, error);
    if (status) return status;
    for (int d = 0; d < ndim; d++) count *= (size_t)shape[d];
    memcpy(out, values, count * sizeof *values);
    free(values);
    return TIDES_OK;
}

/* Reads coefficient 0 from sh0 and the others from shN, interleaved per Gaussian. */
static tides_status read_sh(const td_value *splats, const td_gaussians *g, tides_error *error) {
    int64_t rest = (int64_t)td_sh_coefficients(g->sh_degree) - 1;
    float *first = NULL, *others = NULL;
    tides_status status = read_floats(splats, "sh0", 3, (const int64_t[]){g->count, 1, 3}, &first, error);
    if (!status && rest) status = read_floats(splats, "shN", 3, (const int64_t[]){g->count, rest, 3}, &others, error);
    for (int64_t i = 0; i < g->count && !status; i++) {
        float *out = g->sh + 3 * (rest + 1) * i;
        memcpy(out, first + 3 * i, 3 * sizeof *out);
        if (rest) memcpy(out + 3, others + 3 * rest * i, 3 * (size_t)rest * sizeof *out);
    }
    free(first);
    free(others);
    return status;
}

static tides_status read_splats(const td_value *splats, td_gaussians *gaussians, tides_error *error) {
    const td_tensor *means = NULL;
    int32_t degree = degree_of(splats);
    td_gaussians made;
    memset(&made, 0, sizeof made);
    tides_status status = td_value_tensor(splats, "means", &means, error);
    if (!status) status = td_tensor_check_shape(means, "means", 2, (const int64_t[]){-1, 3}, error);
    if (!status && degree < 0)
        status = td_fail(error, TIDES_BAD_FILE,
                         "tensor shN isn't of shape [N, 0, 3], [N, 3, 3], [N, 8, 3], [N, 15, 3] or "
                         "[N, 24, 3]: SH degrees 0 to 4 are read");
    if (!status && means->count == 0) status = td_fail(error, TIDES_BAD_FILE, "tensor means is empty: there is no Gaussian");
    if (!status) status = td_gaussians_create(&made, means->shape[0], degree, error);
    if (!status) status = read_array(splats, "means", 2, (const int64_t[]){made.count, 3}, made.mean, error);
    if (!status) status = read_array(splats, "scales", 2, (const int64_t[]){made.count, 3}, made.log_scale, error);
    if (!status) status = read_array(splats, "quats", 2, (const int64_t[]){made.count, 4}, made.quaternion, error);
    if (!status) status = read_array(splats, "opacities", 1, (const int64_t[]){made.count}, made.opacity_logit, error);
    if (!status) status = read_sh(splats, &made, error);
    if (status)
        td_gaussians_free(&made);
    else
        *gaussians = made;
    return status;
}

/* 1 if the text has this line, such as "key: value". */
static int says(const char *text, const char *line) {
    const size_t length = strlen(line);
    for (const char *at = text; (at = strstr(at, line)); at += length)
        if ((at == text || at[-1] == '\n') && strchr("\r\n", at[length])) return 1;
    return 0;
}

tides_status td_gsplat_tags(const td_model_dir *dir, int32_t *trained, tides_error *error) {
    enum { LIMIT = 1 << 20 }; /* bytes of a cfg.yml that are read at most */
    char *above = td_folder_of(dir->folder, error), *file = NULL, *text = NULL;
    const char *const folders[] = {dir->folder, above};
    size_t size = 0;
    tides_status status = above ? TIDES_OK : TIDES_NO_MEMORY;
    for (int i = 0; i < 2 && !status && !text; i++) {
        free(file);
        file = td_format(error, "%s/cfg.yml", folders[i]);
        if (!file) status = TIDES_NO_MEMORY;
        if (file && td_is_file(file)) status = td_read_file(file, LIMIT, &text, &size, error);
    }
    if (text && says(text, "antialiased: true")) *trained = TIDES_TRAINED_ANTIALIASED;
    if (text && says(text, "antialiased: false")) *trained = TIDES_TRAINED_PLAIN;
    if (text && (says(text, "model_type: 2dgs") || says(text, "model_type: '2dgs'")))
        status = td_splat_refuse_discs(dir->weights, error);
    free(text);
    free(file);
    free(above);
    return status;
}

tides_status td_gsplat_read(const char *path, td_gaussians *gaussians, tides_error *error) {
    td_tree *tree = NULL;
    tides_status status = td_torch_open(path, &tree, error);
    if (status) return status;
    const td_value *splats = td_value_get(td_tree_root(tree), "splats");
    status = splats ? read_splats(splats, gaussians, error)
                    : td_fail(error, TIDES_BAD_FILE, "holds no \"splats\": this isn't a checkpoint of gsplat");
    if (status) td_fail_within(error, status, "%s", path);
    td_tree_free(tree);
    return status;
}
