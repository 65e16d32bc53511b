/* One work-group per node job: it projects the job's Gaussians, TD_LANES at a time, to rows of record paths. Another kernel
 * makes paths with twice as many rows. */
#include "path_node.h"

/* Prefetches the data of groups ahead: where few of all Gaussians are wanted, nothing else brings it near. */
enum { TD_PREFETCH_NODES = 2 * TD_LANES };
static void td_nodes_prefetch(const td_node_job *job, int i, __global const int *gaussians, const td_source *source,
                              const td_image *image) {
    const int line = 64 / (int)sizeof(td_sh_real);
    for (int lane = i; lane < i + TD_LANES && lane < job->count; lane++) {
        const int gaussian = gaussians[job->first + lane];
        if (gaussian < 0) continue;
        td_prefetch(source->geometry + (long)gaussian * TD_GEOMETRY_STRIDE);
        td_prefetch(source->geometry + (long)gaussian * TD_GEOMETRY_STRIDE + 8);
        for (int k = 0; k < image->sh_stride; k += line) td_prefetch(source->sh + (long)gaussian * image->sh_stride + k);
    }
}

TD_APART void td_nodes_apart(__constant const td_image *image_buffer, __global const td_node_job *at,
                             __global const int *gaussians, __global const int *places, __global const int *object,
                             __global const td_view *views, const td_source *sources, const td_node_sink *to, int first,
                             int step) {
    const td_image image = *image_buffer;
    const td_node_job job = *at;
    const td_source source = *sources;
    const td_node_sink sink = *to;
    for (int i = first; i < job.count; i += step) {
        if (TD_LANES > 1) td_nodes_prefetch(&job, i + TD_PREFETCH_NODES, gaussians, &source, &image);
        td_node_group(&job, i, gaussians, places, object, views, &image, &source, &sink);
    }
}

__kernel void td_project_nodes(__constant const td_image *image_buffer, __global const td_node_job *jobs,
                               __global const int *gaussians, __global const int *places, __global const int *object,
                               __global const td_view *views, __global const td_real *geometry, __global const td_real *rates,
                               __global const td_sh_real *sh, __global const td_real *sh_rates, __global const int *owners,
                               int first_rate, int first_moved, __global td_real *rows, __global td_real *beside) {
    const td_source source = td_source_make(geometry, rates, sh, sh_rates, owners, first_rate, first_moved);
    td_node_sink sink;
    sink.rows = rows;
    sink.beside = beside;
    td_nodes_apart(image_buffer, jobs + get_group_id(0), gaussians, places, object, views, &source, &sink,
                   (int)get_local_id(0) * TD_LANES, (int)get_local_size(0) * TD_LANES);
}

/* Makes rows of the next level at `to` of those at `from`, for `count` paths; `beside` are green and blue where paths are by
 * channels. */
__kernel void td_halve_paths(__global td_real *rows, __global td_real *beside, int by_channels, __global const int *from,
                             __global const int *to, int count, int level, int pieces, __global const td_real *lengths) {
    for (int i = (int)get_global_id(0); i < count; i += (int)get_global_size(0)) {
        td_path_halve(rows, TD_PATH_NUMBERS, from[i], to[i], level, pieces, lengths);
        if (by_channels) td_path_halve(beside, TD_BESIDE_NUMBERS, from[i], to[i], level, pieces, lengths);
    }
}
