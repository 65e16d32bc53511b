/* Sweeps: candidate lists for an interval. Objects at rest before a camera at rest keep their boxes. Other objects are swept
 * in as many pieces as their paths need, and Gaussians that move by themselves in as many as their motion needs. */
#include "camera/td_trajectory.h"
#include "td_renderer.h"

/* Notes which objects move relative to the camera. */
static tides_status note_moves(tides_renderer *renderer, const tides_trajectory *camera, tides_error *error) {
    int camera_moves = !tides_trajectory_is_static(camera);
    for (int32_t i = 0; i < renderer->store.objects; i++) {
        tides_object object;
        tides_status status = tides_scene_object(renderer->scene, renderer->store.scene_object[i], &object, error);
        if (status != TIDES_OK) return status;
        renderer->sweep.object_moves[i] =
            (uint8_t)(camera_moves || renderer->store.mover[i] >= 0 || td_object_travels(&object));
    }
    return TIDES_OK;
}

/* How the sweep treats an object of the store: keeps its boxes, leaves it to the sweep of dynamic Gaussians, or sweeps it in
 * 2^level pieces, level = kind - BOX_WANTED. */
enum { BOX_KEPT = -2, BOX_DYNAMIC = -1, BOX_WANTED = 0 };

static int box_kind(const tides_renderer *renderer, int object, int kept) {
    if (renderer->store.mover[object] >= 0) return BOX_DYNAMIC;
    return kept && !renderer->sweep.object_moves[object] ? BOX_KEPT : BOX_WANTED + renderer->sweep.strays.level[object];
}

tides_status td_renderer_sweep_views(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                                     int level, tides_error *error) {
    int times = td_sweep_times(level), last = times - 1;
    tides_status status = td_reserve((void **)&renderer->sweep.times, &renderer->sweep.time_capacity, (size_t)times,
                                     sizeof *renderer->sweep.times, error);
    for (int i = 0; i < times && status == TIDES_OK; i++)
        renderer->sweep.times[i] = i == last ? stop : start + (stop - start) * (i / (double)last);
    return status == TIDES_OK ? td_renderer_views(renderer, camera, renderer->sweep.times, times, error) : status;
}

/* Finds the clusters of an object that may be in view in the interval, from the renderer's views. Boxes of clusters that left
 * the view are emptied. */
static void look_for(tides_renderer *renderer, int object, double start, double stop) {
    td_clusters *clusters = &renderer->clusters;
    const td_view *views = renderer->scratch.views + object;
    const td_cluster_path path = {views, views + 2 * renderer->store.objects,
                                  (const td_stray *)(const void *)(renderer->sweep.strays.bound +
                                                                   (size_t)object * TD_STRAY_REALS),
                                  stop - start};
    td_clusters_look(clusters, object, &renderer->image, &path);
    for (int i = clusters->first[object]; i < clusters->first[object + 1]; i++) {
        if (clusters->state[i] != TD_CLUSTER_LEFT) continue;
        for (int g = clusters->of[i].begin; g < clusters->of[i].end; g++) {
            td_box_empty(renderer->sweep.boxes + 4 * (size_t)g);
            renderer->sweep.travel[g] = 0;
        }
        clusters->state[i] = TD_CLUSTER_GONE;
    }
}

/* Sweeps the neighbouring objects [first, end), which have the same level. */
static tides_status sweep_objects(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                                  int first, int end, tides_error *error) {
    int level = renderer->sweep.strays.level[first];
    for (int i = first; i < end; i++) look_for(renderer, i, start, stop);
    const td_groups seen = td_clusters_seen(&renderer->clusters, first, end);
    if (seen.count == 0) return TIDES_OK;
    tides_status status = level > 0 ? td_renderer_sweep_views(renderer, camera, start, stop, level, error) : TIDES_OK;
    const td_sweep_request request = {.views = (const double *)renderer->scratch.views,
                                      .strays = renderer->sweep.strays.bound,
                                      .duration = stop - start,
                                      .level = level,
                                      .begin = renderer->object_first[first],
                                      .end = renderer->object_first[end],
                                      .groups = &seen};
    if (status == TIDES_OK)
        status =
            renderer->backend->type->sweep(renderer->backend, &request, renderer->sweep.boxes, renderer->sweep.travel, error);
    return status == TIDES_OK && level > 0 ? td_renderer_sweep_views(renderer, camera, start, stop, 0, error) : status;
}

/* Sweeps every Gaussian that doesn't move by itself. If the camera rests at the same pose as before, only objects that move. */
static tides_status sweep_boxes(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                                tides_error *error) {
    tides_pose pose;
    tides_status status = td_trajectory_at(camera, renderer->epoch, start, &pose, error);
    if (status != TIDES_OK) return status;
    int rests = tides_trajectory_is_static(camera);
    int kept = rests && renderer->sweep.rested && memcmp(&pose, &renderer->sweep.rest_pose, sizeof pose) == 0;
    for (int i = 0; i < renderer->store.objects; i++) renderer->sweep.listed &= box_kind(renderer, i, kept) == BOX_KEPT;
    renderer->sweep.rested = 0;
    for (int i = 0; i < renderer->store.objects && status == TIDES_OK;) {
        int begin = i, kind = box_kind(renderer, i, kept);
        while (i < renderer->store.objects && box_kind(renderer, i, kept) == kind) i++; /* neighbours of one kind together */
        if (kind >= BOX_WANTED)
            status = sweep_objects(renderer, camera, start, stop, begin, i, error);
        else if (kind == BOX_KEPT)
            renderer->stats.gaussians_still += (uint64_t)(renderer->object_first[i] - renderer->object_first[begin]);
    }
    if (status == TIDES_OK && rests) {
        renderer->sweep.rested = 1;
        renderer->sweep.rest_pose = pose;
    }
    return status;
}

/* Sweeps every Gaussian that moves by itself. */
static tides_status sweep_moved(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                                tides_error *error) {
    if (!renderer->dynamic.gaussians) return TIDES_OK;
    const td_dynamic_sweep sweep = {.views = (const double *)renderer->scratch.views,
                                    .strays = renderer->sweep.strays.bound,
                                    .start = start,
                                    .stop = stop,
                                    .row_limit = renderer->row_limit,
                                    .boxes = renderer->sweep.boxes,
                                    .travel = renderer->sweep.travel};
    tides_status status = td_dynamic_sweep_rows(&renderer->dynamic, renderer->backend, &sweep, error);
    return status == TIDES_OK ? td_dynamic_sweep_pieces(renderer, camera, start, stop, error) : status;
}

/* Makes lists from the boxes, and notes which tiles move. */
static tides_status make_lists(tides_renderer *renderer, tides_error *error) {
    const td_groups seen = td_clusters_seen(&renderer->clusters, 0, renderer->store.objects);
    const td_boxes boxes = {renderer->sweep.boxes, renderer->sweep.travel, renderer->sweep.object_moves, &seen, renderer->pool};
    tides_status status = td_candidates_build(&renderer->candidates, &renderer->store, &boxes, error);
    /* the decoder's output behind all splats depends on the ray */
    const int all_moves = renderer->image.decoder && renderer->sweep.object_moves[0];
    if (status == TIDES_OK && all_moves) memset(renderer->candidates.moving, 1, (size_t)renderer->stats.tiles);
    if (status == TIDES_OK) status = td_psf_spread(&renderer->psf, &renderer->candidates, error);
    const int by_tiles = all_moves || renderer->psf.radius || renderer->image.extent_rule != TD_EXTENT_ELLIPSE;
    if (status == TIDES_OK && renderer->candidates.by_blocks && by_tiles) td_candidates_blocks_as_tiles(&renderer->candidates);
    renderer->sweep.listed = status == TIDES_OK;
    return status;
}

tides_status td_renderer_sweep_alone(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                                     tides_error *error) {
    tides_status status = td_renderer_sweep_views(renderer, camera, start, stop, 0, error);
    renderer->sweep.interval[0] = start;
    renderer->sweep.interval[1] = stop;
    if (status == TIDES_OK) status = note_moves(renderer, camera, error);
    const td_stray_interval interval = {renderer->scene, camera, renderer->epoch, start, stop, renderer->sweep.object_moves};
    if (status == TIDES_OK)
        status = td_strays_find(&renderer->sweep.strays, &renderer->store, &renderer->image, &interval, error);
    if (status == TIDES_OK) status = sweep_boxes(renderer, camera, start, stop, error);
    if (status == TIDES_OK) status = sweep_moved(renderer, camera, start, stop, error);
    double begun = td_now();
    renderer->candidates.instant = !(start < stop);
    /* Lists stay valid while no box changes. */
    if (status == TIDES_OK && !renderer->sweep.listed) status = make_lists(renderer, error);
    renderer->stats.time_sweep_s += td_now() - begun;
    return status;
}

tides_status td_renderer_sweep(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                               tides_error *error) {
    tides_status status = TIDES_OK;
    for (; renderer && status == TIDES_OK; renderer = renderer->beside)
        status = td_renderer_sweep_alone(renderer, camera, start, stop, error);
    return status;
}
