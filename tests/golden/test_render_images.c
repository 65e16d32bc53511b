/* Images against independent renderers: every file of $TIDES_SHARED/golden/render, rendered by the double reference, by the
 * same functions in single precision, and by the first OpenCL CPU device. This must equal single precision to the bit (unless
 * it can't round division and square root correctly).
 *
 * Errors are relative to the largest value of their plane in the file, because a rate crosses 0 within every image. Away from
 * the documented cutoffs they stay below 1e-9 in double and 1e-4 in single precision, and the numbers of blended splats are
 * equal. Exceptions are counted and bounded: pixels that the file marks as within rounding of a cutoff (an alpha near 1/255 or
 * near alpha_max, a transmittance near the stop), where rounding decides whether a splat is blended. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_renderer.h"
#include "td_device.h"

#include "tests/support/golden_render.h"
#include "tests/support/opencl.h"
#include "tests/support/render_frame.h"
#include "tests/support/scene_folder.h"
#include "tests/support/shared.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* What of the file each of our planes is. */
typedef struct plane {
    const char *name;
    int plane, channels, channel;
} plane;
static const plane planes[] = {
    {"L", TD_OUT_L, 1, 0},
    {"L_dot", TD_OUT_L_DOT, 1, 0},
    {"Y", TD_OUT_Y, 1, 0},
    {"alpha", TD_OUT_ALPHA, 1, 0},
    {"alpha_dot", TD_OUT_ALPHA_DOT, 1, 0},
    {"sum_w", TD_OUT_COVERAGE, 1, 0},
    {"sum_w_dot", TD_OUT_ALPHA_DOT, 1, 0},
    {"image", TD_OUT_R, 3, 0},
    {"image", TD_OUT_G, 3, 1},
    {"image", TD_OUT_B, 3, 2},
    {"image_dot", TD_OUT_R_DOT, 3, 0},
    {"image_dot", TD_OUT_G_DOT, 3, 1},
    {"image_dot", TD_OUT_B_DOT, 3, 2},
};
enum { PLANES = sizeof planes / sizeof *planes };

/* Who renders. */
enum { IN_DOUBLE, IN_SINGLE, IN_OPENCL, RENDERERS };
typedef struct renderer {
    const char *name;
    double tolerance;
    double margin; /* nearer to a cutoff than this, a pixel is excepted */
    double share;  /* of pixels that may be */
} renderer;
static const renderer renderers[RENDERERS] = {
    {"double", 1e-9, 1e-12, 1e-3},
    {"single", 1e-4, 2e-6, 2e-2},
    {"OpenCL", 1e-4, 2e-6, 2e-2},
};

typedef struct run {
    tides_device *device; /* NULL: no OpenCL CPU device here */
    int failures;
} run;

typedef struct result {
    double error;
    const char *name;
    size_t pixel, excepted, miscounted;
} result;

/* Kernels are built per degree: those below share a build, with coefficients 0. */
static int degree_for(const golden_file *file, int which) {
    return which == IN_DOUBLE || file->sh_degree > 3 ? file->sh_degree : 3;
}

static td_backend *make_backend(const run *r, int which, const td_store *store, const td_image_numbers *image) {
    td_backend *backend = NULL;
    tides_error error;
    tides_status status;
    if (which == IN_DOUBLE)
        status = td_backend_create_f64(store, image, &backend, &error);
    else if (which == IN_SINGLE)
        status = td_backend_create_f32(store, image, &backend, &error);
    else
        status = td_backend_create_opencl(r->device, store, image, &backend, &error);
    scene_expect_ok(status, &error);
    return backend;
}

/* One time of a file, rendered with swept candidates and with all Gaussians for every tile: the same, to the bit. */
static double *render_time(const run *r, const golden_file *file, int time, int which) {
    int degree = degree_for(file, which);
    td_store store = golden_store(file, time, degree);
    td_image_numbers image = golden_image(file, degree, TD_OUT_COLOUR);
    double view[TD_VIEW_REALS], backdrop[TD_BACKDROP_REALS];
    golden_view(file, time, view);
    golden_backdrop(file, time, backdrop);
    td_backend *backend = make_backend(r, which, &store, &image);
    frame_input input = {&store, &image, view, backdrop, file->width, file->height, TD_OUT_COLOUR};
    double *frame = frame_render(backend, &input, FRAME_SWEPT);
    double *all = frame_render(backend, &input, FRAME_ALL);
    assert_memory_equal(frame, all, (size_t)TD_OUT_COLOUR * file->width * file->height * sizeof *frame);
    backend->type->destroy(backend);
    td_store_release(&store);
    free(all);
    return frame;
}

/* 1 where rounding decides what is blended at a pixel. */
static int near_cutoff(const golden_file *file, size_t pixel, double margin) {
    return golden_reals(file, "margin_alpha")[pixel] < margin || golden_reals(file, "margin_T")[pixel] < margin ||
           golden_reals(file, "margin_sat")[pixel] < margin;
}

static double largest_of(const golden_file *file, const char *name, int channels) {
    const double *values = golden_reals(file, name);
    size_t count = (size_t)file->times * file->width * file->height * channels;
    double largest = 0;
    for (size_t i = 0; i < count; i++) largest = fmax(largest, fabs(values[i]));
    return largest;
}

/* Compares a frame's plane with the file's at `first`, the place of the time's first pixel. */
static void compare_plane(const golden_file *file, const renderer *who, const plane *p, const double *frame, size_t first,
                          result *worst) {
    size_t pixels = (size_t)file->width * file->height;
    const double *want = golden_reals(file, p->name), *got = frame + (size_t)p->plane * pixels;
    double largest = largest_of(file, p->name, p->channels);
    for (size_t i = 0; i < pixels; i++) {
        double error = fabs(got[i] - want[(first + i) * p->channels + p->channel]);
        double relative = error == 0 ? 0 : error / largest;
        if (relative <= worst->error || near_cutoff(file, first + i, who->margin)) continue;
        worst->error = isnan(relative) ? INFINITY : relative;
        worst->name = p->name;
        worst->pixel = first + i;
    }
}

/* Counts are equal, but without a cut: there ours leaves out splats whose alpha is below 1e-30, which the file counts. */
static void compare_counts(const golden_file *file, const renderer *who, const double *frame, size_t first, result *worst) {
    size_t pixels = (size_t)file->width * file->height;
    const int32_t *want = golden_ints(file, "count");
    const double *got = frame + TD_OUT_CONTRIBUTORS * pixels;
    for (size_t i = 0; i < pixels; i++) {
        int excepted = near_cutoff(file, first + i, who->margin);
        worst->excepted += (size_t)excepted;
        if (file->has_tiles)
            worst->miscounted += !excepted && got[i] != want[first + i];
        else
            worst->miscounted += !(got[i] <= want[first + i]);
    }
}

/* The device's frame against the host's in single precision. */
static void expect_single(const run *r, const golden_file *file, int time, const double *frame) {
    if (!r->device->correctly_rounded) return;
    double *single = render_time(r, file, time, IN_SINGLE);
    assert_memory_equal(frame, single, (size_t)TD_OUT_COLOUR * file->width * file->height * sizeof *frame);
    free(single);
}

static result compare_file(const run *r, const golden_file *file, int which) {
    result worst = {0, "", 0, 0, 0};
    for (int t = 0; t < file->times; t++) {
        size_t first = (size_t)t * file->width * file->height;
        double *frame = render_time(r, file, t, which);
        for (int p = 0; p < PLANES; p++) compare_plane(file, &renderers[which], &planes[p], frame, first, &worst);
        compare_counts(file, &renderers[which], frame, first, &worst);
        if (which == IN_OPENCL) expect_single(r, file, t, frame);
        free(frame);
    }
    return worst;
}

static int visit(void *user, const char *path, const char *name) {
    run *r = user;
    golden_file file = golden_open(path);
    double pixels = (double)file.times * file.width * file.height;
    for (int which = 0; which < RENDERERS; which++) {
        const renderer *who = &renderers[which];
        if (which == IN_OPENCL && !r->device) continue;
        result w = compare_file(r, &file, which);
        int wrong = !(w.error <= who->tolerance) || w.miscounted || (double)w.excepted > who->share * pixels;
        print_message("    %-32s %s  %.1e (%s, pixel %zu); %zu of %.0f pixels excepted, %zu miscounted%s\n", name, who->name,
                      w.error, w.name, w.pixel, w.excepted, pixels, w.miscounted, wrong ? ": TOO MUCH" : "");
        r->failures += wrong;
    }
    golden_close(&file);
    return 0;
}

static void images_and_their_rates(void **state) {
    (void)state;
    char folder[1024];
    run r = {NULL, 0};
    tides_error error;
    if (shared_path(folder, sizeof folder, "golden/render") != 0) skip();
    if (tides_device_open("cpu", &r.device, &error) != TIDES_OK) print_message("    without OpenCL: %s\n", error.text);
    assert_true(shared_scan(folder, ".npz", visit, &r) > 0);
    tides_device_close(r.device);
    if (r.failures) fail_msg("%d comparisons failed: see the lines above", r.failures);
    skip_without_opencl();
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(images_and_their_rates)};
    return cmocka_run_group_tests_name("golden render: images", tests, NULL, NULL);
}
