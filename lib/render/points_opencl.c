/* Points on an OpenCL device with double precision: misfits of paths, an interval's curves, lists of tiles, and values. */
#include "td_launch.h"
#include "td_points.h"

#include <float.h>
#include <stdlib.h>

enum {
    ENTRY_REALS = 7,        /* reals per lane of a list entry (td_point_room), */
    CODED_ENTRY_REALS = 11, /* and if light isn't linear in colours */
    CURVE_REALS = 32,       /* TD_CURVE_REALS */
    BESIDE_REALS = 8,       /* TD_BESIDE_REALS */
    TEST_REALS = 8,         /* TD_TEST_REALS */
    LIST_INTS = 4,          /* TD_LIST_INTS */
    /* Work-items: on a CPU one for each of its threads, which take turns; on a GPU as many as memory for their rooms has
     * room for, up to what fills a large one several times over. */
    GPU_WORKERS = 1 << 16,
    GPU_GROUP = 64
};

/* Largest size of all work-items' scratch [bytes]. */
static const size_t room_limit = (size_t)512 << 20;

typedef struct opencl_points {
    td_points_engine base;
    tides_device *device;
    cl_kernel misfit_kernel, splat_kernel, list_kernel, value_kernel, instant_kernel;
    td_buffer image;
    struct {
        td_buffer first, lengths, misfits;
    } tried; /* paths that are tried */
    struct {
        td_buffer path, sights, curves, candidates, tiles, depths, records;
        td_points_interval at;
        int longest; /* length of the longest list */
    } interval;
    struct {
        td_buffer row, lengths, seen, own, sights;
    } group; /* of splats of the interval */
    struct {
        td_buffer wanted, keys, places, tests, counts;
    } list;
    struct {
        td_buffer columns, piece, chunks, values, turn;
        cl_event launched; /* NULL: no values are being computed */
        double *out;       /* their target */
        size_t out_bytes;
    } batch;
    td_buffer entries, beside; /* beside: curves of green and blue */
    int is_coded, by_channels; /* by_channels: td_paths_by_channels */
} opencl_points;

static int on_gpu(const opencl_points *p) { return p->base.lanes == 1; }

/* The last lanes write beyond the end, so there are TD_PAD further numbers. */
static cl_int misfit_stride(const td_points_misfits *request) { return request->count + TD_PAD; }

static tides_status launch_misfits(opencl_points *p, const td_buffer *rows, const td_buffer *beside,
                                   const td_points_misfits *request, cl_int asks_each, tides_error *error) {
    size_t local, global = td_even_items(p->base.lanes, request->count, &local);
    const cl_int count = request->count, level = request->level, pieces = request->pieces, stride = misfit_stride(request);
    const cl_double target = request->target, rounding = DBL_EPSILON / 2, place = request->place;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(p->image),
                                     {rows, NULL, 0},
                                     {beside, NULL, 0},
                                     TD_BUFFER_ARGUMENT(p->tried.first),
                                     TD_VALUE_ARGUMENT(count),
                                     TD_VALUE_ARGUMENT(level),
                                     TD_BUFFER_ARGUMENT(p->tried.lengths),
                                     TD_VALUE_ARGUMENT(pieces),
                                     TD_VALUE_ARGUMENT(target),
                                     TD_VALUE_ARGUMENT(rounding),
                                     TD_VALUE_ARGUMENT(place),
                                     TD_BUFFER_ARGUMENT(p->tried.misfits),
                                     TD_VALUE_ARGUMENT(stride),
                                     TD_VALUE_ARGUMENT(asks_each)};
    return td_launch(p->device, p->misfit_kernel, 1, &global, &local, TD_ARGUMENTS(arguments), NULL, error);
}

static tides_status misfits(td_points_engine *engine, const td_points_misfits *request, const td_points_fit *fit,
                            tides_error *error) {
    opencl_points *p = (opencl_points *)engine;
    const size_t stride = (size_t)misfit_stride(request), pieces = (size_t)request->pieces, count = (size_t)request->count;
    const size_t each = fit->each ? td_points_tried(request) : 0, all = (1 + each) * stride;
    if (request->count == 0) return TIDES_OK;
    double *host = td_alloc(all, sizeof *host, error);
    if (!host) return TIDES_NO_MEMORY;
    tides_status status = td_buffer_write(p->device, &p->tried.first, request->first, stride * sizeof(cl_int), error);
    if (status == TIDES_OK)
        status = td_buffer_write(p->device, &p->tried.lengths, request->lengths, pieces * sizeof(cl_double), error);
    if (status == TIDES_OK) status = td_buffer_reserve(p->device, &p->tried.misfits, all * sizeof(cl_double), error);
    if (status == TIDES_OK)
        status = launch_misfits(p, td_exact_row_buffer(request->exact), td_exact_beside_buffer(request->exact), request,
                                each > 0, error);
    if (status == TIDES_OK) status = td_buffer_read(p->device, &p->tried.misfits, host, all * sizeof *host, error);
    for (int i = 0; i < request->count && status == TIDES_OK; i++) {
        fit->worst[i] = (float)host[i];
    }
    for (size_t curve = 0; curve < each && status == TIDES_OK; curve++)
        for (size_t i = 0; i < count; i++) fit->each[curve * count + i] = (float)host[(1 + curve) * stride + i];
    free(host);
    return status;
}

static tides_status make_splats(opencl_points *p, const td_points_group *added, tides_error *error) {
    const cl_int count = added->seen_count, from = added->first;
    size_t local, global = td_even_items(p->base.lanes, count, &local);
    const td_buffer *rows = added->exact ? td_exact_row_buffer(added->exact) : &p->image;
    const td_buffer *rows_beside = added->exact ? td_exact_beside_buffer(added->exact) : &p->image;
    const td_points_slices *slices = &p->interval.at.slices;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(p->image),
                                     {rows, NULL, 0},
                                     TD_BUFFER_ARGUMENT(p->group.row),
                                     TD_BUFFER_ARGUMENT(p->group.lengths),
                                     TD_BUFFER_ARGUMENT(p->group.seen),
                                     TD_BUFFER_ARGUMENT(p->group.own),
                                     TD_BUFFER_ARGUMENT(p->group.sights),
                                     TD_VALUE_ARGUMENT(count),
                                     TD_VALUE_ARGUMENT(from),
                                     TD_BUFFER_ARGUMENT(p->interval.path),
                                     TD_BUFFER_ARGUMENT(p->interval.sights),
                                     TD_VALUE_ARGUMENT(slices->pieces),
                                     TD_VALUE_ARGUMENT(slices->count),
                                     TD_VALUE_ARGUMENT(slices->split),
                                     TD_VALUE_ARGUMENT(slices->group),
                                     TD_BUFFER_ARGUMENT(p->interval.curves),
                                     TD_BUFFER_ARGUMENT(p->interval.depths),
                                     TD_BUFFER_ARGUMENT(p->interval.records),
                                     {rows_beside, NULL, 0},
                                     TD_BUFFER_ARGUMENT(p->beside)};
    return td_launch(p->device, p->splat_kernel, 1, &global, &local, TD_ARGUMENTS(arguments), NULL, error);
}

/* Room for curves up to number `end`; those before number `first` stay. */
static tides_status grow_curves(opencl_points *p, size_t first, size_t end, tides_error *error) {
    const size_t curve = CURVE_REALS * sizeof(cl_double), beside = p->by_channels ? BESIDE_REALS * sizeof(cl_double) : 0;
    const tides_status status = td_buffer_grow(p->device, &p->interval.curves, first * curve, (end + 1) * curve, error);
    return status == TIDES_OK ? td_buffer_grow(p->device, &p->beside, first * beside, beside ? (end + 1) * beside : 1, error)
                              : status;
}

/* Reserves curves, of which there are none yet. If the host's memory is the device's, memory that isn't written takes no room,
 * so room for all possible curves costs nothing. Elsewhere it grows with the requests. */
static tides_status reserve_curves(opencl_points *p, int count, tides_error *error) {
    const size_t curves = p->device->near ? (size_t)count + 1 : 1, beside = p->by_channels ? curves * BESIDE_REALS : 1;
    const tides_status status =
        td_buffer_reserve(p->device, &p->interval.curves, curves * CURVE_REALS * sizeof(cl_double), error);
    return status == TIDES_OK ? td_buffer_reserve(p->device, &p->beside, beside * sizeof(cl_double), error) : status;
}

/* Clears the paths: no Gaussian has one. */
static tides_status clear_paths(opencl_points *p, int gaussians, tides_error *error) {
    int *none = td_alloc((size_t)gaussians, sizeof *none, error);
    if (!none) return TIDES_NO_MEMORY;
    for (int i = 0; i < gaussians; i++) none[i] = TD_PATH_UNSEEN;
    const tides_status status = td_buffer_write(p->device, &p->interval.path, none, (size_t)gaussians * sizeof *none, error);
    free(none);
    return status;
}

/* The interval's own data, and room for its splats and lists. */
static tides_status begin(td_points_engine *engine, const td_points_interval *interval, tides_error *error) {
    opencl_points *p = (opencl_points *)engine;
    size_t candidates = (size_t)interval->candidate_count + TD_PAD, tiles = (size_t)interval->tile_count;
    size_t gaussians = (size_t)interval->gaussians;
    size_t each = (size_t)interval->slices.count * TEST_REALS * sizeof(cl_float);
    const struct {
        td_buffer *buffer;
        const void *data; /* NULL: only room */
        size_t bytes;
    } wanted[] = {
        {&p->interval.candidates, interval->candidates, (size_t)interval->candidate_count * sizeof(cl_int)},
        {&p->interval.tiles, interval->tiles, tiles * sizeof *interval->tiles},
        {&p->list.wanted, NULL, tiles * sizeof(cl_int)},
        {&p->list.keys, NULL, 2 * candidates * sizeof(cl_long)},
        {&p->list.places, NULL, candidates * LIST_INTS * sizeof(cl_int)},
        {&p->interval.sights, NULL, 2 * gaussians * sizeof(cl_int)},
        {&p->list.tests, NULL, candidates * each},
        {&p->interval.depths, NULL, gaussians * sizeof(cl_int)},
        {&p->interval.records, NULL, gaussians * each},
        {&p->list.counts, NULL, tiles * sizeof(cl_int)},
    };
    p->interval.at = *interval;
    p->interval.longest = 0;
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        tides_status status = td_buffer_reserve(p->device, wanted[i].buffer, wanted[i].bytes ? wanted[i].bytes : 1, error);
        if (status == TIDES_OK && wanted[i].data && wanted[i].bytes)
            status = td_buffer_write(p->device, wanted[i].buffer, wanted[i].data, wanted[i].bytes, error);
        if (status != TIDES_OK) return status;
    }
    tides_status status = clear_paths(p, interval->gaussians, error);
    return status == TIDES_OK ? reserve_curves(p, interval->curves, error) : status;
}

static tides_status add(td_points_engine *engine, const td_points_group *added, tides_error *error) {
    opencl_points *p = (opencl_points *)engine;
    const size_t curves = (size_t)added->curves, seen = (size_t)added->seen_count * sizeof(cl_int);
    tides_status status = grow_curves(p, (size_t)added->first, (size_t)added->first + curves, error);
    if (status == TIDES_OK) status = td_buffer_write(p->device, &p->group.row, added->row, 2 * curves * sizeof(cl_int), error);
    if (status == TIDES_OK)
        status = td_buffer_write(p->device, &p->group.lengths, added->lengths, curves * sizeof(cl_double), error);
    if (status == TIDES_OK) status = td_buffer_write(p->device, &p->group.seen, added->seen, seen, error);
    if (status == TIDES_OK) status = td_buffer_write(p->device, &p->group.own, added->path, seen, error);
    if (status == TIDES_OK) status = td_buffer_write(p->device, &p->group.sights, added->sights, 2 * seen, error);
    return status == TIDES_OK ? make_splats(p, added, error) : status;
}

static tides_status lists(td_points_engine *engine, const int *tiles, int count, tides_error *error) {
    opencl_points *p = (opencl_points *)engine;
    if (count == 0) return TIDES_OK;
    size_t local = on_gpu(p) ? GPU_GROUP : 1, global = (size_t)count * local;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(p->interval.tiles),      TD_BUFFER_ARGUMENT(p->list.wanted),
                                     TD_BUFFER_ARGUMENT(p->interval.candidates), TD_BUFFER_ARGUMENT(p->interval.path),
                                     TD_BUFFER_ARGUMENT(p->interval.sights),     TD_BUFFER_ARGUMENT(p->interval.depths),
                                     TD_BUFFER_ARGUMENT(p->interval.records),    TD_VALUE_ARGUMENT(p->interval.at.slices.count),
                                     TD_BUFFER_ARGUMENT(p->list.keys),           TD_BUFFER_ARGUMENT(p->list.places),
                                     TD_BUFFER_ARGUMENT(p->list.tests),          TD_BUFFER_ARGUMENT(p->list.counts)};
    tides_status status = td_buffer_write(p->device, &p->list.wanted, tiles, (size_t)count * sizeof *tiles, error);
    if (status == TIDES_OK)
        status = td_launch(p->device, p->list_kernel, 1, &global, &local, TD_ARGUMENTS(arguments), NULL, error);
    for (int i = 0; i < count; i++)
        if (p->interval.at.tiles[tiles[i]].count > p->interval.longest)
            p->interval.longest = p->interval.at.tiles[tiles[i]].count;
    return td_finish(p->device, status, error);
}

/* Reals of an entry, for each lane. */
static size_t entry_reals(const opencl_points *p) { return p->is_coded ? CODED_ENTRY_REALS : ENTRY_REALS; }

/* Number of work-items for so many chunks, and their scratch of `reals` each. */
static tides_status reserve_rooms(opencl_points *p, int chunks, size_t reals, size_t *items, tides_error *error) {
    const size_t room = reals * sizeof(cl_double);
    size_t most = on_gpu(p) ? GPU_WORKERS : (size_t)p->device->info.compute_units;
    if (most > room_limit / room) most = room_limit / room;
    if (most > (size_t)chunks) most = (size_t)chunks;
    *items = most < 1 ? 1 : most;
    if (on_gpu(p)) *items = (*items + GPU_GROUP - 1) / GPU_GROUP * GPU_GROUP;
    return td_buffer_reserve(p->device, &p->entries, *items * room, error);
}

/* Makes room for `count` points' values. No work-item has taken a turn. */
static tides_status begin_values(opencl_points *p, size_t count, tides_error *error) {
    static const cl_int nobody = 0;
    tides_status status = td_buffer_write(p->device, &p->batch.turn, &nobody, sizeof nobody, error);
    return status == TIDES_OK ? td_buffer_reserve(p->device, &p->batch.values, 2 * count * sizeof(cl_double) + 1, error)
                              : status;
}

/* Sends points and chunks; columns follow one another at a distance of `stride`. */
static tides_status send_batch(opencl_points *p, const td_points_batch *batch, size_t stride, tides_error *error) {
    const size_t column = stride * sizeof(cl_double), used = (size_t)batch->count * sizeof(cl_double);
    tides_status status = td_buffer_reserve(p->device, &p->batch.columns, TD_POINT_COLUMNS * column, error);
    for (size_t k = 0; k < TD_POINT_COLUMNS && batch->count > 0 && status == TIDES_OK; k++)
        status = td_buffer_write_at(p->device, &p->batch.columns, k * column, batch->column[k], used, error);
    if (status == TIDES_OK) status = td_buffer_write(p->device, &p->batch.piece, batch->piece, stride * sizeof(cl_int), error);
    if (status == TIDES_OK)
        status = td_buffer_write(p->device, &p->batch.chunks, batch->chunks, (size_t)batch->chunk_count * sizeof *batch->chunks,
                                 error);
    return status == TIDES_OK ? begin_values(p, stride, error) : status;
}

static tides_status launch_values(opencl_points *p, const td_points_batch *batch, size_t items, cl_int rows, cl_int stride,
                                  tides_error *error) {
    size_t local = on_gpu(p) ? GPU_GROUP : 1;
    const cl_int chunks = batch->chunk_count;
    const td_points_backdrop behind = batch->backdrop;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(p->image),
                                     TD_BUFFER_ARGUMENT(p->interval.tiles),
                                     TD_BUFFER_ARGUMENT(p->list.counts),
                                     TD_BUFFER_ARGUMENT(p->interval.curves),
                                     TD_VALUE_ARGUMENT(p->interval.at.slices.pieces),
                                     TD_VALUE_ARGUMENT(p->interval.at.slices.count),
                                     TD_VALUE_ARGUMENT(p->interval.at.slices.split),
                                     TD_VALUE_ARGUMENT(p->interval.at.slices.group),
                                     TD_BUFFER_ARGUMENT(p->list.places),
                                     TD_BUFFER_ARGUMENT(p->list.tests),
                                     TD_BUFFER_ARGUMENT(p->batch.columns),
                                     TD_VALUE_ARGUMENT(stride),
                                     TD_BUFFER_ARGUMENT(p->batch.piece),
                                     TD_BUFFER_ARGUMENT(p->batch.chunks),
                                     TD_VALUE_ARGUMENT(chunks),
                                     TD_BUFFER_ARGUMENT(p->entries),
                                     TD_VALUE_ARGUMENT(rows),
                                     TD_VALUE_ARGUMENT(behind.first),
                                     TD_VALUE_ARGUMENT(behind.first_dot),
                                     TD_BUFFER_ARGUMENT(p->batch.values),
                                     TD_BUFFER_ARGUMENT(p->batch.turn),
                                     TD_BUFFER_ARGUMENT(p->beside),
                                     TD_VALUE_ARGUMENT(behind.green),
                                     TD_VALUE_ARGUMENT(behind.blue)};
    return td_launch(p->device, p->value_kernel, 1, &items, &local, TD_ARGUMENTS(arguments), &p->batch.launched, error);
}

static tides_status values(td_points_engine *engine, const td_points_batch *batch, double *out, tides_error *error) {
    opencl_points *p = (opencl_points *)engine;
    const size_t stride = (size_t)batch->count + TD_PAD; /* the last lanes read beyond the end */
    const int rows = p->interval.longest > 0 ? p->interval.longest : 1;
    size_t items;
    tides_status status =
        reserve_rooms(p, batch->chunk_count, (size_t)rows * entry_reals(p) * (size_t)p->base.lanes, &items, error);
    if (status == TIDES_OK) status = send_batch(p, batch, stride, error);
    if (status == TIDES_OK) status = launch_values(p, batch, items, rows, (cl_int)stride, error);
    p->batch.out = out;
    p->batch.out_bytes = 2 * (size_t)batch->count * sizeof *out;
    if (status == TIDES_OK) status = td_flush(p->device, error);
    return status == TIDES_OK ? status : td_finish(p->device, status, error);
}

static tides_status finish(td_points_engine *engine, tides_error *error) {
    opencl_points *p = (opencl_points *)engine;
    tides_status status = td_buffer_read(p->device, &p->batch.values, p->batch.out, p->batch.out_bytes, error);
    status = td_finish(p->device, status, error);
    engine->took = td_event_seconds(&p->batch.launched);
    return status;
}

static tides_status launch_instants(opencl_points *p, const td_points_instants *points, size_t items, cl_int room,
                                    tides_error *error) {
    size_t local = on_gpu(p) ? GPU_GROUP : 1;
    const cl_int count = points->count, most = points->most;
    const td_points_backdrop behind = points->backdrop;
    const td_buffer *rows = points->exact ? td_exact_row_buffer(points->exact) : &p->image;
    const td_buffer *beside = points->exact ? td_exact_beside_buffer(points->exact) : &p->image;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(p->image),
                                     {rows, NULL, 0},
                                     {beside, NULL, 0},
                                     TD_BUFFER_ARGUMENT(p->batch.piece),
                                     TD_BUFFER_ARGUMENT(p->batch.columns),
                                     TD_VALUE_ARGUMENT(count),
                                     TD_VALUE_ARGUMENT(most),
                                     TD_BUFFER_ARGUMENT(p->entries),
                                     TD_VALUE_ARGUMENT(room),
                                     TD_VALUE_ARGUMENT(behind.first),
                                     TD_VALUE_ARGUMENT(behind.first_dot),
                                     TD_VALUE_ARGUMENT(behind.green),
                                     TD_VALUE_ARGUMENT(behind.blue),
                                     TD_BUFFER_ARGUMENT(p->batch.values),
                                     TD_BUFFER_ARGUMENT(p->batch.turn)};
    return td_launch(p->device, p->instant_kernel, 1, &items, &local, TD_ARGUMENTS(arguments), NULL, error);
}

/* Points without curves, in the buffers of batches; their ends are in that of pieces. */
static tides_status instants(td_points_engine *engine, const td_points_instants *points, double *out, tides_error *error) {
    opencl_points *p = (opencl_points *)engine;
    const size_t count = (size_t)points->count, column = count * sizeof(cl_double), lanes = (size_t)p->base.lanes;
    const size_t room = TD_INSTANT_REALS(points->most, entry_reals(p), lanes);
    size_t items;
    tides_status status = reserve_rooms(p, (int)((count + lanes - 1) / lanes), room, &items, error);
    if (status == TIDES_OK) status = td_buffer_reserve(p->device, &p->batch.columns, 2 * column + 1, error);
    if (status == TIDES_OK && count > 0) status = td_buffer_write_at(p->device, &p->batch.columns, 0, points->x, column, error);
    if (status == TIDES_OK && count > 0)
        status = td_buffer_write_at(p->device, &p->batch.columns, column, points->y, column, error);
    if (status == TIDES_OK && count > 0)
        status = td_buffer_write(p->device, &p->batch.piece, points->end, count * sizeof(cl_int), error);
    if (status == TIDES_OK) status = begin_values(p, count, error);
    if (status == TIDES_OK) status = launch_instants(p, points, items, (cl_int)room, error);
    if (status == TIDES_OK && count > 0) status = td_buffer_read(p->device, &p->batch.values, out, 2 * column, error);
    return td_finish(p->device, status, error);
}

static void destroy(td_points_engine *engine) {
    opencl_points *p = (opencl_points *)engine;
    td_buffer *buffers[] = {&p->tried.first,         &p->tried.lengths,    &p->tried.misfits,  &p->image,
                            &p->interval.path,       &p->interval.sights,  &p->group.row,      &p->interval.curves,
                            &p->interval.candidates, &p->group.lengths,    &p->interval.tiles, &p->list.wanted,
                            &p->list.keys,           &p->list.places,      &p->group.seen,     &p->group.own,
                            &p->interval.depths,     &p->interval.records, &p->group.sights,   &p->list.tests,
                            &p->list.counts,         &p->batch.columns,    &p->batch.piece,    &p->batch.chunks,
                            &p->batch.values,        &p->batch.turn,       &p->entries,        &p->beside};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) td_buffer_release(buffers[i]);
    if (p->misfit_kernel) clReleaseKernel(p->misfit_kernel);
    if (p->splat_kernel) clReleaseKernel(p->splat_kernel);
    if (p->list_kernel) clReleaseKernel(p->list_kernel);
    if (p->value_kernel) clReleaseKernel(p->value_kernel);
    if (p->instant_kernel) clReleaseKernel(p->instant_kernel);
    free(p);
}

static const td_points_class opencl_points_class = {misfits, begin, add, lists, values, finish, instants, destroy};

/* Sends the image in double: reals, then ints. */
static tides_status write_image(opencl_points *p, const td_image_numbers *image, tides_error *error) {
    td_image packed;
    memcpy(&packed, image->real, sizeof image->real);
    memcpy((char *)&packed + sizeof image->real, image->whole, sizeof image->whole);
    return td_buffer_write(p->device, &p->image, &packed, sizeof packed, error);
}

static tides_status make_kernels(opencl_points *p, const td_image_numbers *numbers, tides_error *error) {
    td_image image;
    memcpy((char *)&image + sizeof numbers->real, numbers->whole, sizeof numbers->whole);
    const struct {
        const char *name;
        cl_kernel *kernel;
    } kernels[] = {{"td_point_find_misfits", &p->misfit_kernel},
                   {"td_point_make_splats", &p->splat_kernel},
                   {"td_point_make_lists", &p->list_kernel},
                   {"td_point_values", &p->value_kernel},
                   {"td_point_instants", &p->instant_kernel}};
    p->is_coded = image.is_coded;
    p->by_channels = td_paths_by_channels(&image);
    /* Decisions that don't concern points are fixed to 0, so that few programs are built. All degrees but 0 are one, and so are
     * colours that change by themselves. */
    char *defines = td_format(error,
                              "#define TD_BUILD_SH_DEGREE %d\n#define TD_BUILD_ANTIALIAS 0\n#define TD_BUILD_CUT_RULE %d\n"
                              "#define TD_BUILD_STOP_RULE 0\n#define TD_BUILD_EXTENT_RULE 0\n#define TD_BUILD_MOVING 0\n"
                              "#define TD_BUILD_OUTPUTS %d\n#define TD_BUILD_SOFT_ORDER %d\n#define TD_BUILD_DECODER "
                              "0\n#define TD_BUILD_LENS 0\n#define TD_BUILD_CODED %d\n#define TD_BUILD_COLOURS_MOVE 0\n",
                              p->by_channels && !p->is_coded, image.cut_rule, TD_OUT_SIGNAL, image.soft_order, image.is_coded);
    tides_status status = defines ? TIDES_OK : TIDES_NO_MEMORY;
    for (size_t i = 0; i < sizeof kernels / sizeof *kernels && status == TIDES_OK; i++)
        status = td_kernel_create_double(p->device, "points.cl", defines, kernels[i].name, kernels[i].kernel, error);
    free(defines);
    return status;
}

/* Runs an empty interval: drivers such as PoCL compile when a kernel first runs, and that belongs to the build's time. */
static tides_status warm_up(opencl_points *p, tides_error *error) {
    static const td_points_tile nothing = {0, 0, 0, 0};
    static const int none[TD_PAD] = {0};
    static const double no_length[2] = {0, 1};
    const td_points_interval interval =
        {.gaussians = 1, .slices = {1, 1, 0, 1}, .candidates = none, .candidate_count = 1, .tiles = &nothing, .tile_count = 1};
    const td_points_group nothing_added = {.row = none, .lengths = no_length, .seen = none, .path = none, .sights = none};
    const td_points_batch batch = {{no_length, no_length, no_length, no_length}, none, 0, NULL, 0, {0, 0, 0, 0}};
    const td_points_instants no_instants = {.most = 1};
    const td_points_misfits nobody = {NULL, 1, none, 0, 1, no_length, 1, 1, 0};
    td_buffer *misfit_buffers[] = {&p->tried.first, &p->tried.lengths, &p->tried.misfits};
    tides_status status = begin(&p->base, &interval, error);
    if (status == TIDES_OK) status = add(&p->base, &nothing_added, error);
    for (int i = 0; i < 3 && status == TIDES_OK; i++)
        status = td_buffer_reserve(p->device, misfit_buffers[i], sizeof(cl_double), error);
    if (status == TIDES_OK) status = launch_misfits(p, &p->image, &p->image, &nobody, 0, error);
    if (status == TIDES_OK) status = lists(&p->base, none, 1, error);
    if (status == TIDES_OK) status = td_buffer_reserve(p->device, &p->batch.chunks, sizeof(td_points_chunk), error);
    if (status == TIDES_OK) status = values(&p->base, &batch, NULL, error);
    if (status == TIDES_OK) status = finish(&p->base, error);
    return status == TIDES_OK ? instants(&p->base, &no_instants, NULL, error) : status;
}

tides_status td_points_create_opencl(tides_device *device, const td_image_numbers *image, td_points_engine **engine,
                                     tides_error *error) {
    opencl_points *p = td_alloc(1, sizeof *p, error);
    if (!p) return TIDES_NO_MEMORY;
    p->base.type = &opencl_points_class;
    p->base.lanes = td_double_lanes(device);
    p->base.goes_on = 1;
    p->device = device;
    tides_status status = write_image(p, image, error);
    if (status == TIDES_OK) status = make_kernels(p, image, error);
    if (status == TIDES_OK) status = warm_up(p, error);
    if (status == TIDES_OK)
        *engine = &p->base;
    else
        destroy(&p->base);
    return status;
}
