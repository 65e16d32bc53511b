/* The layout of TUM RGB-D (Sturm et al. 2012). It has rgb/ and depth/ with rgb.txt and depth.txt, and files named by their
 * times [s]. Depth has 16 bits, 5000 per metre, and 0 for none. groundtruth.txt is `t tx ty tz qx qy qz qw` of the camera in
 * the world [m]. */
#include "td_dataset.h"

#include <stdlib.h>

typedef struct tum {
    td_text rgb, depth, poses;
    uint16_t *values;
} tum;

static tides_status begin(td_writer *w, tides_error *error) {
    tum *t = w->state = td_alloc(1, sizeof *t, error);
    if (!t) return TIDES_NO_MEMORY;
    t->values = td_alloc(td_pixels(w->camera), sizeof *t->values, error);
    tides_status status = t->values ? TIDES_OK : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = td_text_in_folder(&t->rgb, w->folder, "rgb.txt", error);
    if (status == TIDES_OK) status = td_text_in_folder(&t->depth, w->folder, "depth.txt", error);
    if (status == TIDES_OK) status = td_text_in_folder(&t->poses, w->folder, "groundtruth.txt", error);
    if (status == TIDES_OK) status = td_text_put(&t->rgb, error, "# timestamp filename\n");
    if (status == TIDES_OK) status = td_text_put(&t->depth, error, "# timestamp filename\n");
    return status == TIDES_OK ? td_text_put(&t->poses, error, "# timestamp tx ty tz qx qy qz qw\n") : status;
}

/* Writes a picture named by its time (with a decimal point in any locale), and its line. */
static tides_status put(td_writer *w, td_text *lines, const char *kind, int64_t us, int32_t bits, int32_t channels,
                        const void *values, tides_error *error) {
    char name[64];
    snprintf(name, sizeof name, "%s/%s%lld.%06lld.png", kind, us < 0 ? "-" : "", llabs(us) / 1000000, llabs(us) % 1000000);
    const tides_status status = td_text_put(lines, error, "%.6f %s\n", td_seconds(us), name);
    return status == TIDES_OK ? td_plane_write(w->folder, name, 0, w->camera, bits, channels, values, error) : status;
}

static tides_status picture(td_writer *w, const td_picture *p, tides_error *error) {
    return put(w, &((tum *)w->state)->rgb, "rgb", p->us, 8, 3, p->rgb, error);
}

static tides_status truth(td_writer *w, const td_truth *truth, tides_error *error) {
    tum *t = w->state;
    td_depth_16(w->set, w->camera, truth->depth, 5000, t->values);
    return put(w, &t->depth, "depth", truth->us, 16, 1, t->values, error);
}

static tides_status pose(td_writer *w, const td_place_at *at, tides_error *error) {
    return td_pose_line(w->set, &((tum *)w->state)->poses, at, error);
}

static void drop(td_writer *w) {
    tum *t = w->state;
    if (!t) return;
    td_text_drop(&t->rgb);
    td_text_drop(&t->depth);
    td_text_drop(&t->poses);
    free(t->values);
    free(t);
    w->state = NULL;
}

static tides_status end(td_writer *w, tides_error *error) {
    tum *t = w->state;
    tides_status status = td_text_close(&t->rgb, TIDES_OK, error);
    if (status == TIDES_OK) status = td_text_close(&t->depth, TIDES_OK, error);
    if (status == TIDES_OK) status = td_text_close(&t->poses, TIDES_OK, error);
    drop(w);
    return status;
}

const td_layout td_layout_tum = {.name = "tum",
                                 .summary = "TUM RGB-D: colour, depth, poses",
                                 .metric = 1,
                                 .per_camera = 1,
                                 .begin = begin,
                                 .picture = picture,
                                 .truth = truth,
                                 .pose = pose,
                                 .end = end,
                                 .drop = drop};
