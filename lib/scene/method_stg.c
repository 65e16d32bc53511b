/* Reads SpacetimeGaussians (Li et al. 2024): point_cloud.ply with these raw properties:
 *     x y z, scale_0..2, rot_0..3, opacity    as 3DGS
 *     trbf_center, trbf_scale                 centre and ln width of the bell of opacity
 *     motion_0..8                             coefficients of dt, dt^2, dt^3, xyz each
 *     omega_0..3                              the quaternion's rate
 *     f_dc_0..2                               colour (lite); with f_dc_3..5 and f_t_0..2, nine features (full), which a small
 *                                             network beside it, point_cloud.pt, turns into colour per pixel:
 *                                             mlp1.weight [6, 12, 1, 1], mlp2.weight [3, 6, 1, 1]
 * The motion's own time is tau = (frame - first frame) / frames, from 0 to 1, and dt = tau - trbf_center. */
#include "scene/td_method_arrays.h"

#include "archive/td_pickle.h"
#include "scene/td_ply_table.h"
#include "td_base.h"

#include <stdlib.h>
#include <string.h>

static tides_status read_columns(const td_ply_table *table, const char *prefix, int count, float *out, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int k = 0; k < count && status == TIDES_OK; k++) {
        char name[64];
        snprintf(name, sizeof name, "%s_%d", prefix, k);
        status = td_ply_table_column(table, name, out + k, (size_t)count, error);
    }
    return status;
}

static tides_status read_gaussians(const td_ply_table *table, td_gaussians *g, tides_error *error) {
    tides_status status = td_gaussians_create(g, table->rows, 0, error);
    if (status == TIDES_OK) status = td_ply_table_column(table, "x", g->mean, 3, error);
    if (status == TIDES_OK) status = td_ply_table_column(table, "y", g->mean + 1, 3, error);
    if (status == TIDES_OK) status = td_ply_table_column(table, "z", g->mean + 2, 3, error);
    if (status == TIDES_OK) status = td_ply_table_column(table, "opacity", g->opacity_logit, 1, error);
    if (status == TIDES_OK) status = read_columns(table, "scale", 3, g->log_scale, error);
    if (status == TIDES_OK) status = read_columns(table, "rot", 4, g->quaternion, error);
    if (status == TIDES_OK) status = read_columns(table, "f_dc", 3, g->sh, error);
    for (int64_t i = 0; i < 3 * table->rows && status == TIDES_OK; i++) g->sh[i] = td_splat_dc((double)g->sh[i]);
    return status;
}

/* Owned arrays for the motion's constructor. */
typedef struct stg_arrays {
    float *centre, *log_width, *coefficient, *quaternion_dot;
    float *feature, *feature_dot, *first, *second; /* only the full model has these */
    int decoder;
} stg_arrays;

static void arrays_free(stg_arrays *a) {
    float *const all[] = {a->centre,  a->log_width,   a->coefficient, a->quaternion_dot,
                          a->feature, a->feature_dot, a->first,       a->second};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
}

static tides_status read_bell(const td_ply_table *table, stg_arrays *a, tides_error *error) {
    a->centre = td_alloc((size_t)table->rows, sizeof *a->centre, error);
    a->log_width = td_alloc((size_t)table->rows, sizeof *a->log_width, error);
    tides_status status = a->centre && a->log_width ? TIDES_OK : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = td_ply_table_column(table, "trbf_center", a->centre, 1, error);
    if (status == TIDES_OK) status = td_ply_table_column(table, "trbf_scale", a->log_width, 1, error);
    if (status == TIDES_OK) status = td_ply_table_columns(table, "motion", 9, &a->coefficient, error);
    if (status == TIDES_OK) status = td_ply_table_columns(table, "omega", 4, &a->quaternion_dot, error);
    return status;
}

/* Finds the last operation of the decoder, the network that makes colours of features. `rgbfunction` in cfg_args names one of
 * three; without it the model has the paper's, "sandwich". */
static tides_status find_decoder(const td_model_dir *dir, int *decoder, tides_error *error) {
    static const char *const names[] = {"sandwich", "sandwichnoact", "sandwichnoactss"};
    const char *name = td_value_text(td_value_get(dir->cfg ? td_tree_root(dir->cfg) : NULL, "rgbfunction"));
    *decoder = TIDES_DECODER_SIGMOID;
    for (int i = 0; i < 3 && name; i++)
        if (strcmp(name, names[i]) == 0) {
            *decoder = TIDES_DECODER_SIGMOID + i;
            return TIDES_OK;
        }
    if (!name) return TIDES_OK;
    return td_fail(error, TIDES_UNSUPPORTED,
                   "cfg_args: rgbfunction is '%.40s': sandwich, sandwichnoact and sandwichnoactss are read", name);
}

static tides_status read_decoder(const td_model_dir *dir, stg_arrays *a, tides_error *error) {
    static const int64_t first[4] = {6, 12, 1, 1}, second[4] = {3, 6, 1, 1};
    td_tree *tree = NULL;
    if (!dir->weights) return td_fail(error, TIDES_BAD_FILE, "has nine features, but there is no point_cloud.pt beside it");
    tides_status status = td_torch_open(dir->weights, &tree, error);
    if (status == TIDES_OK) status = td_value_floats(td_tree_root(tree), "mlp1.weight", 4, first, &a->first, error);
    if (status == TIDES_OK) status = td_value_floats(td_tree_root(tree), "mlp2.weight", 4, second, &a->second, error);
    td_tree_free(tree);
    if (status == TIDES_OK) status = find_decoder(dir, &a->decoder, error);
    return status;
}

static tides_status read_arrays(const td_model_dir *dir, const td_ply_table *table, stg_arrays *a, tides_error *error) {
    tides_status status = read_bell(table, a, error);
    if (status != TIDES_OK || !td_ply_table_has(table, "f_t_0") || !td_ply_table_has(table, "f_dc_5")) return status;
    status = td_ply_table_columns(table, "f_dc", 6, &a->feature, error);
    if (status == TIDES_OK) status = td_ply_table_columns(table, "f_t", 3, &a->feature_dot, error);
    if (status == TIDES_OK) status = read_decoder(dir, a, error);
    return status;
}

tides_status td_stg_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error) {
    td_ply_table table;
    td_gaussians made = {0};
    tides_motion *moves = NULL;
    stg_arrays a = {0};
    tides_status status = td_ply_table_open(dir->points, &table, error);
    if (status != TIDES_OK) return status;
    status = read_gaussians(&table, &made, error);
    if (status == TIDES_OK) status = read_arrays(dir, &table, &a, error);
    const tides_polynomial_motion arrays = {.count = table.rows,
                                            .start = 0,
                                            .stop = 1,
                                            .opacity_centre = a.centre,
                                            .opacity_log_width = a.log_width,
                                            .mean_coefficient = a.coefficient,
                                            .quaternion_dot = a.quaternion_dot,
                                            .plain_colour = 1,
                                            .decoder = a.decoder,
                                            .feature = a.feature,
                                            .feature_dot = a.feature_dot,
                                            .decoder_first = a.first,
                                            .decoder_second = a.second};
    if (status == TIDES_OK) status = tides_motion_create_polynomial(&arrays, &moves, error);
    arrays_free(&a);
    td_ply_table_close(&table);
    return td_arrays_finish(status, dir->points, &made, moves, gaussians, motion, error);
}
