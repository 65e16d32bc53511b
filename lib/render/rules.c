/* The decisions of each renderer, as numbers (reference: gaussian_splatting notes, sections 1.1 to 1.4).
 *
 *            near          alpha_max  cut                    stop                      extent
 *   inria    0.2, hard     0.99       1/255, hard            T(1-a) < 1e-4, excluded   square of ceil(3 sigma_max), 16 px tiles
 *   gsplat   0.01, hard    0.999      1/255, hard            T(1-a) <= 1e-4, excluded  per axis, opacity-aware, 16 px tiles
 *   smooth   0.2, faded    0.99       0.1/255 to 1/255, C2   bound on L, included      the ellipse, out to the end of the taper
 *
 * smooth is inria made continuous in time: each jump of inria is a false event or a wrong timestamp (DESIGN 3.1). */
#include "td_render.h"

#include <math.h>

enum { MAX_PIXELS = 16384 };

static const double alpha_cut = 1.0 / 255.0;
static const double jacobian_margin = 0.3; /* of tan(fov/2), beyond the image's border */

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

/* Where x/z and y/z are clamped in the Jacobian: 0.3 tan(fov/2) beyond the borders (gsplat; INRIA's +-1.3 tan(fov/2) when
 * centred, and symmetric whatever the centre). */
static void set_limits(td_image *image, int32_t rules, const tides_intrinsics *camera) {
    double tan_x = 0.5 * camera->width / camera->fx, tan_y = 0.5 * camera->height / camera->fy;
    double left = camera->cx / camera->fx, top = camera->cy / camera->fy;
    double right = (camera->width - camera->cx) / camera->fx, bottom = (camera->height - camera->cy) / camera->fy;
    if (rules == TIDES_RULES_INRIA) left = right = tan_x, top = bottom = tan_y;
    image->limit_x0 = -left - jacobian_margin * tan_x;
    image->limit_x1 = right + jacobian_margin * tan_x;
    image->limit_y0 = -top - jacobian_margin * tan_y;
    image->limit_y1 = bottom + jacobian_margin * tan_y;
}

static tides_status check_intrinsics(const tides_intrinsics *camera, tides_error *error) {
    if (camera->width < 1 || camera->width > MAX_PIXELS || camera->height < 1 || camera->height > MAX_PIXELS)
        return td_fail(error, TIDES_BAD_ARGUMENT, "camera: %d x %d pixels; width and height must be 1 to %d",
                       (int)camera->width, (int)camera->height, MAX_PIXELS);
    if (!(camera->fx > 0) || !(camera->fy > 0) || !isfinite(camera->fx) || !isfinite(camera->fy))
        return td_fail(error, TIDES_BAD_ARGUMENT, "camera: fx %g, fy %g; focal lengths must be positive numbers of pixels",
                       camera->fx, camera->fy);
    if (!isfinite(camera->cx) || !isfinite(camera->cy))
        return td_fail(error, TIDES_BAD_ARGUMENT, "camera: cx %g, cy %g; the principal point must be finite", camera->cx,
                       camera->cy);
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
    if (params->size > sizeof *params)
        return td_fail(error, TIDES_BAD_ARGUMENT, "image params: size %u is from a newer version of TIDES", params->size);
    if (params->rules < TIDES_RULES_SMOOTH || params->rules > TIDES_RULES_GSPLAT)
        return td_fail(error, TIDES_BAD_ARGUMENT, "image.rules: %d is none of TIDES_RULES_*", (int)params->rules);
    if (params->sh_degree < 0 || params->sh_degree > TIDES_SH_DEGREE_MAX)
        return td_fail(error, TIDES_BAD_ARGUMENT, "image.sh_degree: %d is outside 0 to %d", (int)params->sh_degree,
                       TIDES_SH_DEGREE_MAX);
    if (!(params->dilation >= 0) || !isfinite(params->dilation))
        return td_fail(error, TIDES_BAD_ARGUMENT, "image.dilation: %g must be a number of px^2, 0 or more", params->dilation);
    if (!(params->log_eps > 0) || !isfinite(params->log_eps))
        return td_fail(error, TIDES_BAD_ARGUMENT, "image.log_eps: %g must be above 0", params->log_eps);
    if (params->rules == TIDES_RULES_SMOOTH && check_smoothing(&params->smoothing, error) != TIDES_OK)
        return TIDES_BAD_ARGUMENT;
    for (int c = 0; c < 3; c++) {
        if (!(params->luminance[c] >= 0) || !isfinite(params->luminance[c]))
            return td_fail(error, TIDES_BAD_ARGUMENT, "image.luminance[%d]: %g must be 0 or more", c, params->luminance[c]);
        if (!(params->background[c] >= 0) || !isfinite(params->background[c]))
            return td_fail(error, TIDES_BAD_ARGUMENT, "scene.background[%d]: %g must be 0 or more", c, params->background[c]);
    }
    return TIDES_OK;
}

void tides_image_params_defaults(tides_image_params *params) {
    /* The measures of smooth were chosen by error against run time (tides bench image). */
    static const tides_image_params defaults = {.size = sizeof defaults,
                                                .rules = TIDES_RULES_SMOOTH,
                                                .sh_degree = TIDES_SH_DEGREE_MAX,
                                                .dilation = 0.3,
                                                .luminance = {0.2126, 0.7152, 0.0722},
                                                .log_eps = 1e-3,
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
    tides_status status = check_intrinsics(intrinsics, error);
    if (status == TIDES_OK) status = check_params(params, error);
    if (status != TIDES_OK) return status;
    memset(image, 0, sizeof *image);
    if (params->rules == TIDES_RULES_INRIA)
        set_inria(image);
    else if (params->rules == TIDES_RULES_GSPLAT)
        set_gsplat(image);
    else
        set_smooth(image, &params->smoothing);
    set_limits(image, params->rules, intrinsics);
    image->fx = intrinsics->fx;
    image->fy = intrinsics->fy;
    image->cx = intrinsics->cx;
    image->cy = intrinsics->cy;
    image->width = intrinsics->width;
    image->height = intrinsics->height;
    image->dilation = params->dilation;
    image->antialias = params->antialias != 0;
    image->log_eps = params->log_eps;
    for (int c = 0; c < 3; c++) image->luminance[c] = params->luminance[c];
    image->sh_degree = params->sh_degree < scene_sh_degree ? params->sh_degree : scene_sh_degree;
    image->sh_stride = 3 * (scene_sh_degree + 1) * (scene_sh_degree + 1);
    image->outputs = TD_OUT_SIGNAL;
    return TIDES_OK;
}

td_image_numbers td_image_pack(const td_image *image) {
    td_image_numbers numbers;
    memcpy(numbers.real, image, sizeof numbers.real);
    memcpy(numbers.whole, (const char *)image + sizeof numbers.real, sizeof numbers.whole);
    return numbers;
}
