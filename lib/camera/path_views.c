/* Selects the poses that options->views names, and finds what their cameras have in common. */
#include "camera/td_path_reader.h"

#include "td_base.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static int differs(double a, double b) { return a < b || a > b; }

static int same_lens(const tides_lens *a, const tides_lens *b) {
    return a->model == b->model && !differs(a->k1, b->k1) && !differs(a->k2, b->k2) && !differs(a->k3, b->k3) &&
           !differs(a->k4, b->k4) && !differs(a->p1, b->p1) && !differs(a->p2, b->p2);
}

static int same_view(const td_path_view *a, const td_path_view *b) {
    const tides_intrinsics *x = &a->intrinsics, *y = &b->intrinsics;
    return x->width == y->width && x->height == y->height && !differs(x->fx, y->fx) && !differs(x->fy, y->fy) &&
           !differs(x->cx, y->cx) && !differs(x->cy, y->cy) && same_lens(&x->lens, &y->lens) &&
           !differs(a->field_of_view_x, b->field_of_view_x) && a->distorted == b->distorted;
}

/* Sets the camera of a sample. Neighbours mostly have the same camera, which is then stored once. */
tides_status td_path_set_view(td_path_reader *reader, td_path_sample *sample, const td_path_view *view) {
    if (reader->view_count == 0 || !same_view(reader->views + reader->view_count - 1, view)) {
        void *views = reader->views;
        tides_status status =
            td_reserve(&views, &reader->view_capacity, reader->view_count + 1, sizeof *reader->views, reader->error);
        if (status != TIDES_OK) return status;
        reader->views = views;
        reader->views[reader->view_count++] = *view;
    }
    sample->view = reader->view_count;
    return TIDES_OK;
}

static void share_side(tides_path *path, int32_t bit, int32_t *common, int32_t other) {
    if (*common == other) return;
    *common = 0;
    path->varied |= bit;
}

static void share_number(tides_path *path, int32_t bit, double *common, double other) {
    if (!differs(*common, other)) return;
    *common = 0.0;
    path->varied |= bit;
}

static void share(tides_path *path, const td_path_view *view) {
    tides_intrinsics *common = &path->intrinsics;
    const tides_intrinsics *other = &view->intrinsics;
    share_side(path, TIDES_VARIED_WIDTH, &common->width, other->width);
    share_side(path, TIDES_VARIED_HEIGHT, &common->height, other->height);
    share_number(path, TIDES_VARIED_FX, &common->fx, other->fx);
    share_number(path, TIDES_VARIED_FY, &common->fy, other->fy);
    share_number(path, TIDES_VARIED_CX, &common->cx, other->cx);
    share_number(path, TIDES_VARIED_CY, &common->cy, other->cy);
    if (differs(path->field_of_view_x, view->field_of_view_x)) path->field_of_view_x = 0.0;
    path->distorted |= view->distorted;
    if (same_lens(&common->lens, &other->lens)) return;
    common->lens = (tides_lens){.model = TIDES_LENS_NONE};
    path->distorted = 1;
}

/* Reads a whole number at `*c`; without one `*value` stays. 0 if the number is out of any path's range. */
static int read_place(const char **c, long long *value) {
    char *end;
    if (!strchr("+-0123456789", **c) || !**c) return 1;
    errno = 0;
    const long long number = strtoll(*c, &end, 10);
    if (end == *c || errno) return 0;
    *value = number;
    *c = end;
    return 1;
}

/* An index as in Python: negative ones count from the end. Clamped to [0, count]. */
static size_t settle(long long place, size_t count) {
    if (place < 0) place += (long long)count;
    return place < 0 ? 0 : place > (long long)count ? count : (size_t)place;
}

/* Reads one piece of the list, "7" or "first:stop:step", at `*c`, and marks its poses in `chosen`. 0 if it is neither. */
static int choose_piece(const char **c, unsigned char *chosen, size_t count) {
    const char *start = *c;
    long long first = 0, stop = (long long)count, step = 1;
    int good = read_place(c, &first);
    if (good && *c != start && **c != ':') {
        if (first >= (long long)count || first < -(long long)count) return 0;
        stop = first == -1 ? (long long)count : first + 1;
    } else {
        if (!good || **c != ':') return 0;
        ++*c;
        good = read_place(c, &stop);
        if (good && **c == ':') {
            ++*c;
            good = read_place(c, &step);
        }
    }
    if (!good || step < 1) return 0;
    const size_t end = settle(stop, count);
    for (size_t i = settle(first, count); i < end; i += (size_t)step) {
        chosen[i] = 1;
        if (end - i <= (size_t)step) break; /* i + step could overflow */
    }
    return 1;
}

/* Keeps only the samples that `views` names. */
static tides_status keep(td_path_reader *reader, const char *views) {
    unsigned char *chosen = td_alloc(reader->count ? reader->count : 1, 1, reader->error);
    if (!chosen) return TIDES_NO_MEMORY;
    memset(chosen, 0, reader->count);
    const char *c = views;
    int good = choose_piece(&c, chosen, reader->count);
    while (good && *c == ',') {
        c++;
        good = choose_piece(&c, chosen, reader->count);
    }
    const size_t all = reader->count;
    reader->count = 0;
    for (size_t i = 0; i < all; i++)
        if (chosen[i]) reader->samples[reader->count++] = reader->samples[i];
    free(chosen);
    if (good && !*c && reader->count > 0) return TIDES_OK;
    char word[TD_QUOTE];
    return td_fail(reader->error, TIDES_BAD_FILE,
                   "%s: views \"%s\": %s of its %zu poses, which are counted from 0; write 7, 0:100:10 or 3,5,-1", reader->file,
                   td_path_quote(views, strlen(views), word), good && !*c ? "chooses none" : "isn't a choice", all);
}

tides_status td_path_choose(td_path_reader *reader) {
    const char *views = reader->options->views;
    if (views && reader->path.trajectory)
        return td_fail(reader->error, TIDES_BAD_FILE, "%s: is a path by a formula: it has no views to choose from",
                       reader->file);
    tides_status status = views ? keep(reader, views) : TIDES_OK;
    for (size_t i = 0; i < reader->count && status == TIDES_OK; i++) {
        if (reader->samples[i].view == 0) continue;
        const td_path_view *view = reader->views + reader->samples[i].view - 1;
        if (i > 0) {
            share(&reader->path, view);
            continue;
        }
        reader->path.intrinsics = view->intrinsics;
        reader->path.field_of_view_x = view->field_of_view_x;
        reader->path.distorted = view->distorted;
    }
    if (reader->path.varied & (TIDES_VARIED_CX | TIDES_VARIED_CY))
        td_path_note(reader,
                     "its principal points differ from pose to pose: the image's centre is taken where nothing else is said");
    return status;
}
