/* Tags of files that tell how a scene must be drawn: in each format, there and back, formats that can't hold them, and the
 * image by image.antialias = file. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"
#include "tests/support/splat_make.h"
#include "tides.h"

/* -- PLY -- */

/* An ASCII .ply of two Gaussians with a comment in its header. */
static scene_bytes ply_with(const char *comment, int32_t degree, const float *filter) {
    td_gaussians g = scene_random(3, 2, degree, SCENE_TRAINED);
    scene_bytes plain = scene_ply(&g, &(scene_recipe){.type = SCENE_FLOAT, .filter = filter}), b = {0};
    const char *second = strchr(plain.data, '\n') + 1;
    scene_bytes_add(&b, plain.data, (size_t)(second - plain.data));
    scene_bytes_add(&b, comment, strlen(comment));
    scene_bytes_add(&b, second, strlen(second));
    free(plain.data);
    td_gaussians_free(&g);
    return b;
}

static void comments(void **state) {
    (void)state;
    static const struct {
        const char *comment;
        int32_t trained;
        double up[3];
        const char *note;
    } cases[] = {
        {"", TIDES_TRAINED_UNKNOWN, {0}, NULL},
        {"comment SplatRenderMode: mip\n", TIDES_TRAINED_ANTIALIASED, {0}, NULL},
        {"comment SplatRenderMode: default\n", TIDES_TRAINED_PLAIN, {0}, NULL},
        {"comment splatrendermode: MIP\r\n", TIDES_TRAINED_ANTIALIASED, {0}, NULL},
        {"comment antialiased 1\n", TIDES_TRAINED_ANTIALIASED, {0}, NULL},
        {"comment antialiased 0\n", TIDES_TRAINED_PLAIN, {0}, NULL},
        {"comment antialiased 1\ncomment SplatRenderMode: default\n", TIDES_TRAINED_PLAIN, {0}, NULL},
        {"comment SplatRenderMode: soft\n", TIDES_TRAINED_UNKNOWN, {0}, "mode 'soft' isn't known"},
        {"comment Exported from Brush\ncomment Vertical axis: 0 -0.5 1\ncomment SH degree: 0\n",
         TIDES_TRAINED_UNKNOWN,
         {0, -0.5, 1},
         NULL},
        {"comment Vertical axis: y\n", TIDES_TRAINED_UNKNOWN, {0}, NULL},
        {"comment Vertical Axis: z\n", TIDES_TRAINED_UNKNOWN, {0, 0, 1}, NULL},
        {"comment up 1 2 3\n", TIDES_TRAINED_UNKNOWN, {1, 2, 3}, NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        scene_bytes b = ply_with(cases[i].comment, 0, NULL);
        td_gaussians g = splat_parse(td_ply_parse, &b);
        if (g.trained != cases[i].trained) fail_msg("%s: trained is %d", cases[i].comment, (int)g.trained);
        assert_memory_equal(g.up, cases[i].up, sizeof g.up);
        if (cases[i].note)
            assert_non_null(g.notes && strstr(g.notes, cases[i].note) ? g.notes : NULL);
        else
            assert_null(g.notes);
        td_gaussians_free(&g);
        free(b.data);
    }
}

/* mip-splatting trains its 3-D filter beside compensated opacities. */
/* Values as they are used, where 3DGS has those that are trained: said, and taken as they are written. */
static void activated(void **state) {
    (void)state;
    for (int kind = 0; kind < 4; kind++) { /* as trained; opacities; scales; all opacities the same */
        td_gaussians g = scene_random(3, 40, 0, SCENE_TRAINED);
        for (int i = 0; i < 40; i++) {
            if (kind == 1 || kind == 3) g.opacity_logit[i] = kind == 1 ? 0.025f * (float)i : 0.9f;
            for (int k = 0; kind == 2 && k < 3; k++) g.log_scale[3 * i + k] = 0.01f * (float)(i + k);
        }
        scene_bytes b = scene_ply(&g, &(scene_recipe){.type = SCENE_FLOAT});
        td_gaussians read = splat_parse(td_ply_parse, &b);
        const char *note = kind == 1 ? "opacities all lie from 0 to 1" : kind == 2 ? "scales all lie from 0 to 1" : NULL;
        assert_true(note ? read.notes && strstr(read.notes, note) : !read.notes);
        assert_true(read.opacity_logit[7] == g.opacity_logit[7] && read.log_scale[7] == g.log_scale[7]);
        td_gaussians_free(&read);
        td_gaussians_free(&g);
        free(b.data);
    }
}

static void filtered(void **state) {
    (void)state;
    const float filter[2] = {0.01f, 0.02f};
    scene_bytes b = ply_with("", 1, filter);
    td_gaussians g = splat_parse(td_ply_parse, &b);
    assert_int_equal(g.trained, TIDES_TRAINED_ANTIALIASED);
    td_gaussians_free(&g);
    free(b.data);
}

/* Discs have two scales, or say what they are. */
static void discs(void **state) {
    (void)state;
    scene_bytes b = ply_with("comment SplatRenderMode: 2dgs\n", 0, NULL);
    splat_refused(td_ply_parse, &b, TIDES_UNSUPPORTED, "2-D Gaussians|2DGS|train the scene with 3-D Gaussians");
    free(b.data);
    b = ply_with("", 0, NULL);
    memcpy(strstr(b.data, "scale_2"), "squared", 7);
    splat_refused(td_ply_parse, &b, TIDES_UNSUPPORTED, "2-D Gaussians|2DGS");
    memcpy(strstr(b.data, "opacity"), "density", 7); /* no splats at all */
    splat_refused(td_ply_parse, &b, TIDES_BAD_FILE, "no property opacity");
    free(b.data);
}

/* -- there and back -- */

static tides_scene *scene_of(int32_t trained, const double *up) {
    td_gaussians g = scene_random(5, 3, 1, SCENE_TRAINED);
    tides_scene *scene = scene_new();
    tides_error error;
    g.trained = trained;
    scene_add(scene, &g, NULL, 1, "a");
    scene_expect_ok(tides_scene_set_up(scene, up, &error), &error);
    td_gaussians_free(&g);
    return scene;
}

static void formats(void **state) {
    static const struct {
        const char *file;
        int32_t lost, plain; /* what is lost of all; what a plain scene comes back as */
    } cases[] = {{"a.ply", 0, TIDES_TRAINED_PLAIN},
                 {"a.h5", 0, TIDES_TRAINED_PLAIN},
                 /* its flag is 0 of scenes that nobody knows of, too */
                 {"a.spz", TIDES_LOSES_UP | TIDES_LOSES_TRANSFER, TIDES_TRAINED_UNKNOWN},
                 {"a.splat", TIDES_LOSES_HARMONICS | TIDES_LOSES_TRAINED | TIDES_LOSES_UP | TIDES_LOSES_TRANSFER,
                  TIDES_TRAINED_UNKNOWN},
                 {"a.glb", TIDES_LOSES_TRAINED | TIDES_LOSES_UP, TIDES_TRAINED_UNKNOWN}};
    const double up[3] = {0, 0, 1};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        for (int32_t trained = TIDES_TRAINED_UNKNOWN; trained <= TIDES_TRAINED_ANTIALIASED; trained++) {
            const char *file = scene_in_folder(*state, cases[i].file);
            double found[3];
            tides_scene *scene = scene_of(trained, up), *back = scene_new();
            const int32_t known = trained != TIDES_TRAINED_UNKNOWN, lost = tides_scene_losses(scene, file);
            assert_int_equal(lost, cases[i].lost & ~(known ? 0 : TIDES_LOSES_TRAINED));
            scene_save(scene, file);
            scene_load(back, file, NULL, 1);
            const int32_t kept = trained == TIDES_TRAINED_PLAIN ? cases[i].plain
                                 : lost & TIDES_LOSES_TRAINED   ? TIDES_TRAINED_UNKNOWN
                                                                : trained;
            assert_int_equal(tides_scene_trained(back), kept);
            assert_int_equal(tides_scene_up(back, found), !(lost & TIDES_LOSES_UP));
            tides_scene_destroy(scene);
            tides_scene_destroy(back);
        }
}

/* -- what colours are of light -- */

typedef struct coding {
    int32_t transfer;
    double gamma;
} coding;
static const coding codings[] = {{TIDES_TRANSFER_LINEAR, 0}, {TIDES_TRANSFER_SRGB, 0}, {TIDES_TRANSFER_GAMMA, 2.2}};
enum { CODINGS = sizeof codings / sizeof *codings };

static tides_scene *coded_scene(const coding *c, const char *name) {
    td_gaussians g = scene_random(5, 3, 1, SCENE_TRAINED);
    tides_scene *scene = scene_new();
    td_gaussians_tag(&g, c->transfer, c->gamma);
    scene_add(scene, &g, NULL, 1, name);
    td_gaussians_free(&g);
    return scene;
}

static void check_coding(const tides_scene *scene, const coding *wanted, const char *file) {
    int32_t transfer;
    double gamma;
    tides_error error;
    scene_expect_ok(tides_scene_transfer(scene, &transfer, &gamma, &error), &error);
    if (transfer != wanted->transfer || (transfer == TIDES_TRANSFER_GAMMA && gamma != wanted->gamma))
        fail_msg("%s: transfer %d, gamma %g, where %d and %g were written", file, (int)transfer, gamma, (int)wanted->transfer,
                 wanted->gamma);
}

/* What a format keeps of a coding, by the table of formats: all of it, or srgb, which is assumed then. */
static coding kept_by(const tides_scene_format *format, const coding *given) {
    static const coding srgb = {TIDES_TRANSFER_SRGB, 0};
    const int32_t no_exponent = given->transfer == TIDES_TRANSFER_GAMMA ? TIDES_LOSES_EXPONENT : 0;
    return format->losses & (TIDES_LOSES_TRANSFER | no_exponent) ? srgb : *given;
}

/* Saves the scene with the format's ending, and reads the file again: `now` is what it keeps, and a change of it is a loss. */
static tides_scene *pass_file(const tides_scene *scene, const tides_scene_format *format, const char *path, coding *now) {
    char file[1200];
    snprintf(file, sizeof file, "%s%.*s", path, (int)strcspn(format->endings, " "), format->endings);
    const coding kept = kept_by(format, now);
    const int lost = kept.transfer != now->transfer;
    assert_int_equal(!!(tides_scene_losses(scene, file) & TIDES_LOSES_TRANSFER), lost);
    scene_save(scene, file);
    tides_scene *read = scene_new();
    scene_load(read, file, NULL, 1);
    check_coding(read, &kept, file);
    assert_string_equal(tides_scene_notes(read), "");
    *now = kept;
    return read;
}

/* The row of the table that is written at `index` or later; 0: none. */
static int find_written(size_t *index, tides_scene_format *format) {
    while (tides_scene_format_at(*index, format))
        if (format->writes)
            return 1;
        else
            ++*index;
    return 0;
}

/* Each format that is written by way of each: the tag is in the file, comes back, and is lost where the table says so. */
static void transfers(void **state) {
    tides_scene_format first, second;
    size_t files = 0, whole = 0;
    for (size_t i = 0; find_written(&i, &first); i++)
        for (size_t j = 0; find_written(&j, &second); j++)
            for (int k = 0; k < CODINGS; k++, files += 2) {
                char one[1100];
                coding now = codings[k];
                snprintf(one, sizeof one, "%s-%d%d%d", scene_in_folder(*state, "a"), (int)i, (int)j, k);
                tides_scene *scene = coded_scene(&now, "a"), *there = pass_file(scene, &first, one, &now);
                snprintf(one + strlen(one), sizeof one - strlen(one), "-again");
                tides_scene *back = pass_file(there, &second, one, &now);
                whole += now.transfer == codings[k].transfer && k != TIDES_TRANSFER_SRGB;
                tides_scene_destroy(scene);
                tides_scene_destroy(there);
                tides_scene_destroy(back);
            }
    assert_true(files >= 40);
    assert_true(whole >= 4 + 9); /* gamma between .ply and .h5, linear among them and .glb */
}

/* What comments may say, and may not. */
static void transfer_comments(void **state) {
    static const struct {
        const char *comment;
        coding coding;
    } right[] = {{"", {TIDES_TRANSFER_LINEAR, 0}}, /* says nothing */
                 {"comment ColourTransfer: linear\n", {TIDES_TRANSFER_LINEAR, 0}},
                 {"comment ColourTransfer: srgb\n", {TIDES_TRANSFER_SRGB, 0}},
                 {"comment colourtransfer: gamma 1.8\r\n", {TIDES_TRANSFER_GAMMA, 1.8}}};
    static const char *const wrong[] = {"comment ColourTransfer: log\n", "comment ColourTransfer: gamma\n",
                                        "comment ColourTransfer: gamma 0.5\n", "comment ColourTransfer: srgb 2.2\n",
                                        "comment ColourTransfer:\n"};
    (void)state;
    for (size_t i = 0; i < sizeof right / sizeof *right; i++) {
        scene_bytes b = ply_with(right[i].comment, 0, NULL);
        td_gaussians g = splat_parse(td_ply_parse, &b);
        assert_true(g.transfer == right[i].coding.transfer && g.gamma == right[i].coding.gamma && g.says_transfer == (i > 0));
        td_gaussians_free(&g);
        free(b.data);
    }
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        scene_bytes b = ply_with(wrong[i], 0, NULL);
        splat_refused(td_ply_parse, &b, TIDES_BAD_FILE, "ColourTransfer|linear, srgb, or gamma");
        free(b.data);
    }
}

/* Untagged files are srgb, whatever their format; what is made in memory is what it says, or linear. */
static void untagged(void **state) {
    static const coding srgb = {TIDES_TRANSFER_SRGB, 0};
    const char *file = scene_in_folder(*state, "untagged.ply");
    scene_bytes b = ply_with("", 0, NULL);
    tides_scene *scene = scene_new();
    scene_file_write(file, b.data, b.size);
    scene_load(scene, file, NULL, 1);
    check_coding(scene, &srgb, file);
    assert_string_equal(tides_scene_notes(scene), "");
    tides_scene_destroy(scene);
    free(b.data);
}

/* Two that differ are one scene, and no image, unless the image says. */
static void draw_coded(const tides_scene *scene, int32_t transfer, tides_status wanted, const char *words) {
    const tides_intrinsics camera = {.width = 24, .height = 24, .fx = 8, .fy = 8, .cx = 12, .cy = 12};
    tides_image_params params;
    tides_device *device = NULL;
    tides_renderer *renderer = NULL;
    tides_error error = {TIDES_OK, ""};
    tides_image_params_defaults(&params);
    assert_int_equal(params.transfer, TIDES_TRANSFER_FILE);
    params.transfer = transfer;
    scene_expect_ok(tides_device_open("reference", &device, &error), &error);
    tides_status status = tides_renderer_create(device, scene, &camera, &params, NULL, NULL, &renderer, &error);
    if (wanted == TIDES_OK)
        scene_expect_ok(status, &error);
    else
        scene_expect_error(status, wanted, &error, words);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
}

static void differing(void **state) {
    (void)state;
    tides_scene *scene = coded_scene(&codings[1], "chair");
    td_gaussians g = scene_random(6, 2, 0, SCENE_TRAINED);
    scene_add(scene, &g, NULL, 1, "ball");
    draw_coded(scene, TIDES_TRANSFER_FILE, TIDES_BAD_CONFIG, "'chair' are srgb|'ball' linear|image.transfer");
    draw_coded(scene, TIDES_TRANSFER_LINEAR, TIDES_OK, "");
    draw_coded(scene, TIDES_TRANSFER_SRGB, TIDES_OK, "");
    td_gaussians_free(&g);
    tides_scene_destroy(scene);
}

/* -- drawing -- */

/* A picture of small splats, which compensation changes. */
static void draw(const tides_scene *scene, int32_t antialias, double *Y, tides_status wanted, const char *words) {
    const tides_intrinsics camera = {.width = 24, .height = 24, .fx = 8, .fy = 8, .cx = 12, .cy = 12};
    const tides_pose_sample still = {.position = {0, 0, -30}, .quaternion = {1, 0, 0, 0}};
    tides_image_params params;
    tides_device *device = NULL;
    tides_renderer *renderer = NULL;
    tides_trajectory *path = NULL;
    tides_error error = {TIDES_OK, ""};
    tides_image_params_defaults(&params);
    assert_int_equal(params.antialias, TIDES_ANTIALIAS_FILE);
    params.antialias = antialias;
    scene_expect_ok(tides_device_open("reference", &device, &error), &error);
    tides_status status = tides_renderer_create(device, scene, &camera, &params, NULL, NULL, &renderer, &error);
    if (wanted != TIDES_OK) {
        scene_expect_error(status, wanted, &error, words);
    } else {
        const tides_frame frame = {{Y}};
        scene_expect_ok(status, &error);
        scene_expect_ok(tides_trajectory_create(&still, 1, &path, &error), &error);
        scene_expect_ok(tides_renderer_frame(renderer, path, 0, &frame, &error), &error);
    }
    tides_trajectory_destroy(path);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
}

static void drawn_as_trained(void **state) {
    (void)state;
    enum { PIXELS = 24 * 24 };
    static double on[PIXELS], off[PIXELS], of_file[PIXELS];
    tides_scene *scenes[] = {scene_of(TIDES_TRAINED_UNKNOWN, NULL), scene_of(TIDES_TRAINED_PLAIN, NULL),
                             scene_of(TIDES_TRAINED_ANTIALIASED, NULL)};
    draw(scenes[0], TIDES_ANTIALIAS_TRUE, on, TIDES_OK, "");
    draw(scenes[0], TIDES_ANTIALIAS_FALSE, off, TIDES_OK, "");
    assert_memory_not_equal(on, off, sizeof on);
    for (int i = 0; i < 3; i++) {
        draw(scenes[i], TIDES_ANTIALIAS_FILE, of_file, TIDES_OK, "");
        assert_memory_equal(of_file, i == 2 ? on : off, sizeof on);
        draw(scenes[i], TIDES_ANTIALIAS_FALSE, of_file, TIDES_OK, "");
        assert_memory_equal(of_file, off, sizeof off);
    }
    td_gaussians g = scene_random(6, 2, 0, SCENE_TRAINED);
    scene_add(scenes[2], &g, NULL, 1, "says nothing");
    assert_int_equal(tides_scene_trained(scenes[2]), TIDES_TRAINED_ANTIALIASED);
    g.trained = TIDES_TRAINED_PLAIN;
    scene_add(scenes[2], &g, NULL, 1, "contradicts");
    assert_int_equal(tides_scene_trained(scenes[2]), TIDES_TRAINED_MIXED);
    draw(scenes[2], TIDES_ANTIALIAS_FILE, of_file, TIDES_BAD_CONFIG, "image.antialias|set it to true or false");
    draw(scenes[2], TIDES_ANTIALIAS_TRUE, of_file, TIDES_OK, "");
    draw(scenes[0], 3, of_file, TIDES_BAD_ARGUMENT, "image.antialias|3");
    td_gaussians_free(&g);
    for (int i = 0; i < 3; i++) tides_scene_destroy(scenes[i]);
}

/* Run files from before it was a choice have true or false. */
static void in_run_files(void **state) {
    (void)state;
    static const struct {
        const char *value;
        int32_t antialias;
    } cases[] = {{"true", TIDES_ANTIALIAS_TRUE},       {"false", TIDES_ANTIALIAS_FALSE},   {"\"true\"", TIDES_ANTIALIAS_TRUE},
                 {"\"false\"", TIDES_ANTIALIAS_FALSE}, {"\"file\"", TIDES_ANTIALIAS_FILE}, {NULL, TIDES_ANTIALIAS_FILE}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[160], set[64];
        const char *const sets[] = {set};
        tides_run *run = NULL, *again = NULL;
        tides_run_values values;
        tides_error error;
        snprintf(text, sizeof text, "{\"scene\": {\"file\": \"a\"}, \"camera\": {\"file\": \"b\"}%s%s%s}",
                 cases[i].value ? ", \"image\": {\"antialias\": " : "", cases[i].value ? cases[i].value : "",
                 cases[i].value ? "}" : "");
        scene_expect_ok(tides_run_parse(text, "", NULL, 0, &run, &error), &error);
        tides_run_get(run, &values);
        assert_int_equal(values.image.antialias, cases[i].antialias);
        snprintf(set, sizeof set, "image.antialias=%s", cases[i].value ? cases[i].value : "file");
        scene_expect_ok(tides_run_parse("{\"scene\": {\"file\": \"a\"}, \"camera\": {\"file\": \"b\"}}", "", sets, 1, &again,
                                        &error),
                        &error);
        tides_run_get(again, &values);
        assert_int_equal(values.image.antialias, cases[i].antialias);
        tides_run_destroy(run);
        tides_run_destroy(again);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(comments),
        cmocka_unit_test(activated),
        cmocka_unit_test(filtered),
        cmocka_unit_test(discs),
        cmocka_unit_test_setup_teardown(formats, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(transfers, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test(transfer_comments),
        cmocka_unit_test_setup_teardown(untagged, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test(differing),
        cmocka_unit_test(drawn_as_trained),
        cmocka_unit_test(in_run_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
