/* The decisions of each image.rules as numbers, from their sources (INRIA's diff-gaussian-rasterization, gsplat), and TIDES's
 * own:
 *
 *            near          alpha_max  cut                    stop                      extent
 *   inria    0.2, hard     0.99       1/255, hard            T(1-a) < 1e-4, excluded   square of ceil(3 sigma_max), 16 px tiles
 *   gsplat   0.01, hard    0.999      1/255, hard            T(1-a) <= 1e-4, excluded  per axis, opacity-aware, 16 px tiles
 *   smooth   0.2, faded    0.99       0.1/255 to 1/255, C2   bound on L, included      the ellipse, out to the end of the taper
 *
 * smooth is inria made continuous in time, because each jump of inria is a false event or a wrong timestamp. */
#include "camera/td_lens.h"
#include "td_renderer.h"
#include "td_transfer.h"

#include <math.h>

static const double alpha_cut = 1.0 / 255.0;
static const double jacobian_margin = 0.3; /* share of tan(fov/2) beyond the image's border */
static const double no_limit = 1e6;

static void set_inria(td_image *image) {
    image->near = image->near_full = 0.2;
    image->alpha_max = 0.99;
    image->cut = image->cut_full = alpha_cut;
    image->cut_rule = TD_CUT_HARD;
    image->stop = 1e-4;
    image->stop_rule = TD_STOP_BELOW;
    image->extent_rule = TD_EXTENT_INRIA;
    image->antialias_floor = 2.5e-5;
}

static void set_gsplat(td_image *image) {
    set_inria(image);
    image->near = image->near_full = 0.01;
    image->alpha_max = 0.999;
    image->stop_rule = TD_STOP_BELOW_OR_AT;
    image->extent_rule = TD_EXTENT_GSPLAT;
    image->antialias_floor = 0;
}

static void set_smooth(td_image *image, const tides_smoothing *smoothing) {
    set_inria(image);
    image->near_full = smoothing->near_fade * image->near;
    image->cut = smoothing->taper_begin;
    image->cut_full = smoothing->taper_end;
    if (smoothing->taper_end > smoothing->taper_begin) image->cut_rule = TD_CUT_TAPER;
    if (smoothing->stop_change > 0) {
        image->stop = smoothing->stop_change;
        image->stop_rule = TD_STOP_BOUND;
    }
    image->soft_depth = smoothing->soft_depth;
    image->soft_order = smoothing->soft_depth > 0;
    if (smoothing->ellipses) image->extent_rule = TD_EXTENT_ELLIPSE;
}

/* Sets the bounds at which x/z and y/z are clamped in the Jacobian: 0.3 tan(fov/2) beyond the borders. That is gsplat's rule.
 * INRIA clamps at +-1.3 tan(fov/2), which is the same for a centred principal point, and symmetric for any. */
static void set_limits(td_image *image, int32_t rules, const tides_intrinsics *camera) {
    double tan_x = 0.5 * camera->width / camera->fx, tan_y = 0.5 * camera->height / camera->fy;
    double left = camera->cx / camera->fx, top = camera->cy / camera->fy;
    double right = (camera->width - camera->cx) / camera->fx, bottom = (camera->height - camera->cy) / camera->fy;
    if (image->lens_model == TD_LENS_EQUIDISTANT) { /* its Jacobian is bounded without a clamp */
        image->limit_x0 = image->limit_y0 = -no_limit;
        image->limit_x1 = image->limit_y1 = no_limit;
        return;
    }
    if (image->lens_model == TD_LENS_RADTAN) {
        double range[4];
        td_camera_range(image, range);
        left = -range[0], right = range[1], top = -range[2], bottom = range[3];
        tan_x = 0.5 * (left + right), tan_y = 0.5 * (top + bottom);
    }
    if (rules == TIDES_RULES_INRIA) left = right = tan_x, top = bottom = tan_y;
    image->limit_x0 = -left - jacobian_margin * tan_x;
    image->limit_x1 = right + jacobian_margin * tan_x;
    image->limit_y0 = -top - jacobian_margin * tan_y;
    image->limit_y1 = bottom + jacobian_margin * tan_y;
}

/* A number of the image and its allowed range, the same as of the run file's key. Within these ranges no product of the
 * numbers overflows single precision. One exception: with a log_eps of 1e-12 or less, L_dot = Y_dot / (Y + log_eps) may
 * overflow in the dark. */
typedef struct ranged {
    const char *name;
    double value, lower, upper;
} ranged;

static tides_status check_ranges(const ranged *numbers, size_t count, tides_error *error) {
    for (size_t i = 0; i < count; i++)
        if (!(numbers[i].value >= numbers[i].lower && numbers[i].value <= numbers[i].upper))
            return td_fail(error, TIDES_BAD_ARGUMENT, "%s: %g is out of range; it must lie in [%.10g, %.10g]", numbers[i].name,
                           numbers[i].value, numbers[i].lower, numbers[i].upper);
    return TIDES_OK;
}

static tides_status check_smoothing(const tides_smoothing *s, tides_error *error) {
    if (!(s->taper_begin > 0) || !(s->taper_end >= s->taper_begin) || !(s->taper_end < 1))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "image.smoothing: a taper from %g to %g; both must be within (0, 1), in order", s->taper_begin,
                       s->taper_end);
    if (!(s->stop_change >= 0) || !isfinite(s->stop_change))
        return td_fail(error, TIDES_BAD_ARGUMENT, "image.smoothing: stop_change %g must be 0 or more", s->stop_change);
    if (!(s->near_fade >= 1) || !isfinite(s->near_fade))
        return td_fail(error, TIDES_BAD_ARGUMENT, "image.smoothing: near_fade %g must be 1 or more", s->near_fade);
    if (!(s->soft_depth >= 0) || !(s->soft_depth < 1))
        return td_fail(error, TIDES_BAD_ARGUMENT, "image.smoothing: soft_depth %g must be within [0, 1)", s->soft_depth);
    return TIDES_OK;
}

static tides_status check_params(const tides_image_params *params, tides_error *error) {
    if (params->rules < TIDES_RULES_SMOOTH || params->rules > TIDES_RULES_GSPLAT)
        return td_fail(error, TIDES_BAD_ARGUMENT, "image.rules: %d is none of TIDES_RULES_*", (int)params->rules);
    if (params->sh_degree < 0 || params->sh_degree > TIDES_SH_DEGREE_MAX)
        return td_fail(error, TIDES_BAD_ARGUMENT, "image.sh_degree: %d is outside 0 to %d", (int)params->sh_degree,
                       TIDES_SH_DEGREE_MAX);
    if (params->antialias < TIDES_ANTIALIAS_FALSE || params->antialias > TIDES_ANTIALIAS_FILE)
        return td_fail(error, TIDES_BAD_ARGUMENT, "image.antialias: %d is none of TIDES_ANTIALIAS_*", (int)params->antialias);
    if (params->rules == TIDES_RULES_SMOOTH && check_smoothing(&params->smoothing, error) != TIDES_OK)
        return TIDES_BAD_ARGUMENT;
    const ranged numbers[] = {{"image.dilation", params->dilation, 0, 100},
                              {"image.log_eps", params->log_eps, 1e-9, 1e6},
                              {"image.luminance[0]", params->luminance[0], 0, 100},
                              {"image.luminance[1]", params->luminance[1], 0, 100},
                              {"image.luminance[2]", params->luminance[2], 0, 100},
                              {"scene.background[0]", params->background[0], 0, 1e6},
                              {"scene.background[1]", params->background[1], 0, 1e6},
                              {"scene.background[2]", params->background[2], 0, 1e6}};
    return check_ranges(numbers, sizeof numbers / sizeof *numbers, error);
}

void tides_image_params_defaults(tides_image_params *params) {
    /* The numbers of smooth were chosen by error against run time (`own_bench image`). */
    static const tides_image_params defaults = {.size = sizeof defaults,
                                                .rules = TIDES_RULES_SMOOTH,
                                                .antialias = TIDES_ANTIALIAS_FILE,
                                                .sh_degree = TIDES_SH_DEGREE_MAX,
                                                .dilation = 0.3,
                                                .luminance = {0.2126, 0.7152, 0.0722},
                                                .log_eps = 1e-3,
                                                .transfer = TIDES_TRANSFER_FILE,
                                                .gamma = 2.2,
                                                .smoothing = {.taper_begin = 0.1 / 255,
                                                              .taper_end = 1.0 / 255,
                                                              .stop_change = 1e-5,
                                                              .near_fade = 1.25,
                                                              .soft_depth = 1e-4,
                                                              .ellipses = 1}};
    *params = defaults;
}

tides_status td_image_resolve(const tides_image_params *params, const tides_intrinsics *intrinsics, int scene_sh_degree,
                              td_image *image, tides_error *error) {
    tides_status status = check_params(params, error);
    memset(image, 0, sizeof *image);
    if (status == TIDES_OK) status = td_camera_resolve(intrinsics, image, error);
    if (status != TIDES_OK) return status;
    if (params->rules == TIDES_RULES_INRIA)
        set_inria(image);
    else if (params->rules == TIDES_RULES_GSPLAT)
        set_gsplat(image);
    else
        set_smooth(image, &params->smoothing);
    set_limits(image, params->rules, intrinsics);
    image->dilation = params->dilation;
    image->antialias = params->antialias == TIDES_ANTIALIAS_TRUE;
    image->log_eps = params->log_eps;
    for (int c = 0; c < 3; c++) image->luminance[c] = params->luminance[c];
    image->sh_degree = params->sh_degree < scene_sh_degree ? params->sh_degree : scene_sh_degree;
    image->sh_stride = 3 * (scene_sh_degree + 1) * (scene_sh_degree + 1);
    image->outputs = TD_OUT_SIGNAL;
    td_image_set_transfer(TIDES_TRANSFER_LINEAR, 1, image);
    return TIDES_OK;
}

tides_status td_image_take_training(const tides_image_params *params, const tides_scene *scene, td_image *image,
                                    tides_error *error) {
    if (params->antialias != TIDES_ANTIALIAS_FILE) return TIDES_OK;
    const int32_t trained = tides_scene_trained(scene);
    image->antialias = trained == TIDES_TRAINED_ANTIALIASED;
    if (trained != TIDES_TRAINED_MIXED) return TIDES_OK;
    return td_fail(error, TIDES_BAD_CONFIG,
                   "image.antialias: some of the scene was trained with compensated opacities and some without, as its files "
                   "say, "
                   "and one image has one of both: set it to true or false");
}

td_image_numbers td_image_pack(const td_image *image) {
    td_image_numbers numbers;
    memcpy(numbers.real, image, sizeof numbers.real);
    memcpy(numbers.whole, (const char *)image + sizeof numbers.real, sizeof numbers.whole);
    return numbers;
}

const char *td_renderer_lacks_exact_points(const tides_renderer *renderer) {
    const td_image *image = &renderer->image;
    if (renderer->psf.radius) return "the optics' blur (image.psf_sigma_px) makes a pixel of its neighbours too";
    if (image->decoder) return "a decoder makes the scene's colours";
    if (image->extent_rule != TD_EXTENT_ELLIPSE || td_drops_splats(image))
        return "splats of image.rules inria and gsplat end abruptly, so that the image jumps";
    return NULL;
}
