/* Test support: files of golden/render, as inputs for the renderer and expected results. */
#ifndef TESTS_SUPPORT_GOLDEN_RENDER_H
#define TESTS_SUPPORT_GOLDEN_RENDER_H

#include "render/td_backend.h"

#include "tests/support/npz.h"

typedef struct golden_file {
    npz *npz;
    char mode[32];
    int times, gaussians, width, height, sh_degree;
    int whole_pixel_centres; /* 1: the file's pixel centres are whole numbers, ours lie 0.5 further (INRIA) */
    int has_tiles;           /* 1: the file's renderer cuts splats to tile rectangles */
} golden_file;

/* Opens a file; fails the cmocka test where it can't be read or its mode is unknown. */
golden_file golden_open(const char *path);
void golden_close(golden_file *file);

/* A whole array, times first, then Gaussians or pixels; fails the test where it is absent or of another type. */
const double *golden_reals(const golden_file *file, const char *name);
const int32_t *golden_ints(const golden_file *file, const char *name);
const uint8_t *golden_bytes(const golden_file *file, const char *name);

/* Inputs at time number `time`: one object, with rates. The store is freed with td_store_release; its SH may be padded to a
 * higher degree, so that one build of the kernels serves several files. */
td_store golden_store(const golden_file *file, int time, int sh_degree);
void golden_view(const golden_file *file, int time, double view[TD_VIEW_REALS]);
void golden_backdrop(const golden_file *file, int time, double backdrop[TD_BACKDROP_REALS]);

/* The image's numbers for the file's mode. golden_coded_image: for colours that code light as `transfer` (TIDES_TRANSFER_*). */
td_image_numbers golden_image(const golden_file *file, int sh_degree, int outputs);
td_image_numbers golden_coded_image(const golden_file *file, int sh_degree, int outputs, int32_t transfer, double gamma);

/* Per-Gaussian quantities: where each begins in a golden_splat. */
enum {
    SPLAT_SCALE = 0,
    SPLAT_ROTATION = 3,
    SPLAT_OPACITY = 12,
    SPLAT_COV3 = 13,
    SPLAT_PC = 19,
    SPLAT_U = 22,
    SPLAT_DEPTH = 24,
    SPLAT_COV2 = 25,
    SPLAT_CONIC = 28,
    SPLAT_COLOUR = 31,
    SPLAT_OPACITY_EFF = 34,
    SPLAT_COMP = 35,
    SPLAT_REALS = 36
};

/* One Gaussian's quantities from activation to the screen, with rates. It has the rotation instead of the quaternion, whose
 * sign means nothing. */
typedef struct golden_splat {
    double value[SPLAT_REALS], rate[SPLAT_REALS];
    int visible; /* in front of the camera and above the cut */
} golden_splat;

/* The file's values, in our convention of pixel centres; `visible` stays 0 (the file has `keep`). */
void golden_expected(const golden_file *file, int time, int gaussian, golden_splat *splat);

/* The values that the functions of kernels/ compute in each precision. golden_tile: 1 if the splat's rectangle holds the
 * tile whose top left pixel is (x, y). */
void golden_project_f64(const td_image_numbers *image, const double *view, const td_store *store, int gaussian,
                        golden_splat *splat);
void golden_project_f32(const td_image_numbers *image, const double *view, const td_store *store, int gaussian,
                        golden_splat *splat);
int golden_tile_f64(const td_image_numbers *image, const double *view, const td_store *store, int gaussian, int x, int y);
int golden_tile_f32(const td_image_numbers *image, const double *view, const td_store *store, int gaussian, int x, int y);

#endif
