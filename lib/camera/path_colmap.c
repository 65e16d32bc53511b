/* COLMAP's images.txt and images.bin, which hold the poses, with the intrinsics from cameras.txt or cameras.bin beside them.
 *
 * Text: two lines per image. The first is `ID QW QX QY QZ TX TY TZ CAMERA_ID NAME`; the second has points, is skipped, and may
 * be empty. '#' at a line's start begins a comment. Binary, little-endian: uint64 count, then {uint32 id, double q[4], double
 * t[3], uint32 camera, name ending in 0, uint64 points, 24 bytes for each}. q and t map the world to the camera in OpenCV axes.
 *
 * There are no times. Images are put in the order of their names, with digits as numbers, which for a video's frames is their
 * order in time. Their times are spread evenly over `duration`. */
#include "camera/td_path_reader.h"

#include "camera/td_colmap.h"
#include "camera/td_rotation.h"
#include "td_base.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBERS = 9, POINT_BYTES = 24 }; /* an image's numbers: id, q, t, camera; bytes of a point */

typedef struct images {
    td_path_reader *reader;
    const td_colmap_cameras *cameras;
} images;

/* Converts an image's numbers `v` (id, q, t, camera) to a pose. The file maps world to camera; the pose is the inverse. */
static tides_status set_pose(const images *m, const char *where, const double v[NUMBERS], tides_pose_sample *pose) {
    double q[4] = {v[1], v[2], v[3], v[4]}, rotation[9];
    tides_status status = td_path_check_quaternion(m->reader, where, q, "QW QX QY QZ");
    if (status || !td_normalise_quaternion(q)) return status;
    td_rotation_from_quaternion(q, rotation);
    for (int i = 0; i < 3; i++) {
        pose->position[i] = -(rotation[i] * v[5] + rotation[3 + i] * v[6] + rotation[6 + i] * v[7]);
        pose->quaternion[i + 1] = -q[i + 1];
    }
    pose->quaternion[0] = q[0];
    return TIDES_OK;
}

/* Appends an image. `where` names its line or number in messages. */
static tides_status add(images *m, const char *where, size_t place, const double v[NUMBERS], const char *name, size_t length) {
    td_path_sample *made = td_path_append(m->reader, place);
    if (!made) return TIDES_NO_MEMORY;
    made->word = name;
    made->length = length;
    for (int k = 0; k < NUMBERS; k++)
        if (!isfinite(v[k]))
            return td_fail(m->reader->error, TIDES_BAD_FILE, "%s: %s: the pose has a number that isn't finite", m->reader->file,
                           where);
    tides_status status = set_pose(m, where, v, &made->pose);
    if (status) return status;
    const td_colmap_camera *camera = v[8] >= 0 && v[8] <= UINT32_MAX ? td_colmap_find(m->cameras, (uint32_t)v[8]) : NULL;
    if (!camera)
        return td_fail(m->reader->error, TIDES_BAD_FILE, "%s: %s: camera %g isn't among the %zu of the cameras file",
                       m->reader->file, where, v[8], m->cameras->count);
    const td_path_view view = {.intrinsics = camera->intrinsics, .distorted = camera->distorted};
    return td_path_set_view(m->reader, made, &view);
}

static tides_status read_line(images *m, size_t line, const char *c) {
    double v[NUMBERS];
    char where[32];
    snprintf(where, sizeof where, "line %zu", line);
    for (int k = 0; k < NUMBERS; k++) {
        const char *after = td_text_number(c, v + k);
        if (after == c || (*after != ' ' && *after != '\t'))
            return td_fail(m->reader->error, TIDES_BAD_FILE,
                           "%s:%zu: an image is ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, with its points on the next line",
                           m->reader->file, line);
        c = td_text_skip(after);
    }
    return add(m, where, line, v, c, strcspn(c, "\r\n"));
}

static tides_status read_text(images *m) {
    tides_status status = TIDES_OK;
    const char *c = m->reader->text;
    for (size_t line = 1; *c && !status; line++) {
        const char *data = td_text_skip(c);
        int has_image = !td_text_ends(data);
        if (has_image) status = read_line(m, line, data);
        for (int k = 0; k < 1 + has_image && *c; k++) { /* the next line has the image's points */
            c += strcspn(c, "\n");
            c += *c == '\n';
        }
        line += (size_t)has_image;
    }
    return status;
}

static tides_status read_binary(images *m) {
    td_bytes b = {m->reader->text, m->reader->bytes};
    uint64_t count = 0, points, whole;
    if (!td_bytes_number(&b, 8, &count))
        return td_fail(m->reader->error, TIDES_BAD_FILE, "%s: ends within the number of images: truncated?", m->reader->file);
    for (uint64_t i = 0; i < count; i++) {
        double v[NUMBERS];
        char where[40];
        snprintf(where, sizeof where, "images[%llu]", (unsigned long long)i);
        int good = td_bytes_number(&b, 4, &whole);
        v[0] = (double)whole;
        for (int k = 1; k < 8 && good; k++) good = td_bytes_double(&b, v + k);
        good = good && td_bytes_number(&b, 4, &whole);
        v[8] = (double)whole;
        const char *name = b.at, *end = good ? memchr(name, 0, b.left) : NULL;
        good = end && td_bytes_skip(&b, (uint64_t)(end - name) + 1) && td_bytes_number(&b, 8, &points) &&
               points <= b.left / POINT_BYTES && td_bytes_skip(&b, points * POINT_BYTES);
        if (!good)
            return td_fail(m->reader->error, TIDES_BAD_FILE, "%s: ends within image %llu of %llu: truncated?", m->reader->file,
                           (unsigned long long)i + 1, (unsigned long long)count);
        tides_status status = add(m, where, (size_t)i, v, name, (size_t)(end - name));
        if (status) return status;
    }
    return TIDES_OK;
}

tides_status td_path_read_images(td_path_reader *reader, int binary, const td_colmap_cameras *cameras) {
    images m = {.reader = reader, .cameras = cameras};
    strcpy(reader->path.format, "colmap");
    reader->list = binary ? "images" : NULL;
    tides_status status = binary ? read_binary(&m) : read_text(&m);
    if (!status) td_path_order(reader, 0);
    return status ? status : td_path_apply_frame(reader, NULL);
}

tides_status td_path_read_colmap(td_path_reader *reader, int binary) {
    td_colmap_cameras cameras = {NULL, 0, 0};
    tides_status status = td_colmap_load_cameras(reader->file, binary, &cameras, reader->error);
    if (!status) status = td_path_read_images(reader, binary, &cameras);
    free(cameras.list);
    return status;
}

tides_status td_path_refuse_cameras(td_path_reader *reader, int binary) {
    td_colmap_cameras cameras;
    tides_status status = td_colmap_parse_cameras(reader->file, reader->text, reader->bytes, binary, &cameras, reader->error);
    if (status) return status;
    const tides_intrinsics *first = &cameras.list[0].intrinsics;
    status = td_fail(reader->error, TIDES_BAD_FILE,
                     "%s: holds %zu camera%s (%dx%d px, fx %.6g) but no poses: give COLMAP's images.%s, or the folder of both",
                     reader->file, cameras.count, cameras.count == 1 ? "" : "s", (int)first->width, (int)first->height,
                     first->fx, binary ? "bin" : "txt");
    free(cameras.list);
    return status;
}
