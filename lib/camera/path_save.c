/* Writes a path as TIDES's own JSON, one sample per line. Numbers have as many digits as are needed to read them back
 * exactly. The file is written beside its place and renamed, so that a path file is never incomplete. */
#include "tides/camera.h"

#include "camera/td_lens_models.h"
#include "camera/td_rotation.h"
#include "td_base.h"
#include "td_text.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void write_vector(FILE *out, const char *key, const double *values, int count) {
    fprintf(out, ", \"%s\": [", key);
    for (int k = 0; k < count; k++) fprintf(out, "%s%s", k ? ", " : "", TD_SHORT(values[k]));
    fputc(']', out);
}

static void write_camera(FILE *out, const tides_intrinsics *camera) {
    tides_lens lens = camera->lens;
    fprintf(out, "  \"intrinsics\": {\"width\": %d, \"height\": %d, \"fx\": %s, \"fy\": %s, \"cx\": %s, \"cy\": %s",
            (int)camera->width, (int)camera->height, TD_SHORT(camera->fx), TD_SHORT(camera->fy), TD_SHORT(camera->cx),
            TD_SHORT(camera->cy));
    if (lens.model != TIDES_LENS_NONE) {
        fprintf(out, ",\n    \"lens\": {\"model\": \"%s\"", tides_lens_name(lens.model));
        for (int k = 0; k < TD_COEFFICIENTS_MAX; k++)
            fprintf(out, ", \"%s\": %s", td_lens_key[k], TD_SHORT(*td_lens_at(&lens, k)));
        fputc('}', out);
    }
    fputs("},\n", out);
}

static void write_path(FILE *out, const tides_trajectory *trajectory, const tides_intrinsics *camera) {
    size_t count = tides_trajectory_count(trajectory);
    fputs("{\n  \"format\": \"tides-path\", \"version\": 1,\n", out);
    if (camera) write_camera(out, camera);
    if (tides_trajectory_is_open(trajectory)) fputs("  \"open\": true,\n", out);
    fputs("  \"samples\": [\n", out);
    for (size_t i = 0; i < count; i++) {
        tides_pose_sample sample;
        if (tides_trajectory_sample(trajectory, i, &sample, NULL) != TIDES_OK) continue; /* can't fail: i < count */
        fprintf(out, "    {\"t\": %s", TD_SHORT(sample.time));
        write_vector(out, "position", sample.position, 3);
        write_vector(out, "quaternion", sample.quaternion, 4);
        if (sample.has_rates) {
            write_vector(out, "velocity", sample.velocity, 3);
            write_vector(out, "angular_velocity", sample.angular_velocity, 3);
        }
        fprintf(out, "}%s\n", i + 1 < count ? "," : "");
    }
    fputs("  ]\n}\n", out);
}

/* Refuses intrinsics that tides_path_load would refuse. */
static tides_status check_intrinsics(const tides_intrinsics *camera, tides_error *error) {
    tides_lens lens = camera->lens;
    const double numbers[] = {camera->fx, camera->fy, camera->cx, camera->cy};
    int good = tides_lens_name(lens.model) != NULL && td_all_finite(numbers, 4);
    good = good && camera->width >= 1 && camera->height >= 1 && camera->fx > 0.0 && camera->fy > 0.0;
    for (int k = 0; k < TD_COEFFICIENTS_MAX; k++) good = good && isfinite(*td_lens_at(&lens, k));
    if (good) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT,
                   "intrinsics %dx%d, fx %g, fy %g, cx %g, cy %g: sizes and focal lengths must be above 0, all values finite; "
                   "pass "
                   "NULL to leave them out",
                   (int)camera->width, (int)camera->height, camera->fx, camera->fy, camera->cx, camera->cy);
}

tides_status tides_path_save(const char *file, const tides_trajectory *trajectory, const tides_intrinsics *intrinsics,
                             tides_error *error) {
    if (!file || !trajectory) return td_fail(error, TIDES_BAD_ARGUMENT, "saving a path needs a file name and a trajectory");
    if (intrinsics && check_intrinsics(intrinsics, error) != TIDES_OK) return TIDES_BAD_ARGUMENT;
    td_text text;
    tides_status status = tides_file_named(file, ".json", error);
    if (status == TIDES_OK) status = td_text_open(&text, file, error);
    if (status != TIDES_OK) return status;
    const locale_t before = uselocale(text.plain); /* JSON needs decimal points whatever the program's locale */
    write_path(text.file, trajectory, intrinsics);
    uselocale(before);
    return td_text_close(&text, TIDES_OK, error);
}
