/* Voxel grids, event frames and time surfaces of $TIDES_SHARED/golden/metrics, to 1e-6 (they agree better). */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/representations.h"

#include "tests/support/event_stream.h"
#include "tests/support/npz.h"
#include "tests/support/golden_folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define TOLERANCE 1e-6

typedef struct stream {
    tides_event *events;
    size_t count;
    int32_t width, height;
} stream;

static stream read_simulated(npz *archive) {
    stream s = {NULL, 0, 0, 0};
    double *t = npz_doubles(archive, "sim_t", &s.count), *x = npz_doubles(archive, "sim_x", NULL);
    double *y = npz_doubles(archive, "sim_y", NULL), *p = npz_doubles(archive, "sim_p", NULL);
    const npz_array *frame = npz_get(archive, "sim_frame");
    assert_true(t && x && y && p && frame);
    assert_true(frame->ndim == 3);
    s.height = (int32_t)frame->shape[1];
    s.width = (int32_t)frame->shape[2];
    s.events = calloc(s.count + 1, sizeof *s.events);
    assert_non_null(s.events);
    for (size_t i = 0; i < s.count; i++) s.events[i] = event_at(llround(1e3 * t[i]), (int)x[i], (int)y[i], p[i] > 0 ? 1 : -1);
    free(t), free(x), free(y), free(p);
    return s;
}

/* The array `name` of the file against ours. */
static void check(npz *archive, const char *file, const char *name, const double *got, size_t cells, double *worst) {
    size_t count = 0;
    double *wanted = npz_doubles(archive, name, &count);
    assert_non_null(wanted);
    assert_int_equal(count, cells);
    for (size_t i = 0; i < count; i++) {
        const double error = fabs(got[i] - wanted[i]);
        if (!(error <= TOLERANCE)) fail_msg("%s: %s[%zu] is %.17g, expected %.17g", file, name, i, got[i], wanted[i]);
        *worst = fmax(*worst, error);
    }
    free(wanted);
}

static int check_file(void *user, const char *path, const char *file) {
    double *worst = user;
    npz *archive = npz_open(path);
    assert_non_null(archive);
    if (npz_get(archive, "sim_frame")) { /* absent where the stream is empty */
        stream s = read_simulated(archive);
        const size_t pixels = (size_t)s.width * (size_t)s.height;
        double *out = calloc(15 * pixels, sizeof *out);
        tides_voxel_options o;
        assert_non_null(out);
        tides_voxel_options_defaults(&o, TIDES_VOXEL_E2VID);
        assert_int_equal(tides_voxel_grid(s.events, s.count, s.width, s.height, &o, out, NULL), TIDES_OK);
        check(archive, file, "sim_voxel5_norm", out, 5 * pixels, worst);
        o.normalise = TIDES_NORMALISE_NONE;
        assert_int_equal(tides_voxel_grid(s.events, s.count, s.width, s.height, &o, out, NULL), TIDES_OK);
        check(archive, file, "sim_voxel5", out, 5 * pixels, worst);
        tides_voxel_options_defaults(&o, TIDES_VOXEL_DSEC);
        assert_int_equal(tides_voxel_grid(s.events, s.count, s.width, s.height, &o, out, NULL), TIDES_OK);
        check(archive, file, "sim_dsec15", out, 15 * pixels, worst);
        assert_int_equal(tides_event_frame(s.events, s.count, s.width, s.height, out, NULL), TIDES_OK);
        check(archive, file, "sim_frame", out, 2 * pixels, worst);
        const int64_t last = s.events[s.count - 1].t;
        assert_int_equal(tides_time_surface(s.events, s.count, s.width, s.height, last, 30e-3, out, NULL), TIDES_OK);
        check(archive, file, "sim_ts30ms", out, 2 * pixels, worst);
        free(out);
        free(s.events);
    }
    npz_close(archive);
    return 0;
}

static void every_array_of_every_file(void **state) {
    (void)state;
    double worst = -1;
    const size_t files = golden_folder("golden/metrics", ".npz", check_file, &worst);
    print_message("%zu files, largest difference %.3g\n", files, worst);
    assert_true(worst >= 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_array_of_every_file)};
    return cmocka_run_group_tests_name("representations golden", tests, NULL, NULL);
}
