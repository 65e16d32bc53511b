/* A crowd: shapes that fly in front of a wall. In turn they move rigidly, by polynomials and by keyframes. Each rigid one is
 * an object. Each of the other two models is one object, whose motion moves all its Gaussians, as in trained scenes. */
#include "generate/td_generate.h"
#include "td_base.h"
#include "td_math.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FRAME_S 0.02 /* [s] between keyframes; longer if the run would have more than FRAMES_MOST of them */
enum { RIGID, POLYNOMIAL, KEYFRAMES, MODELS, FRAMES_MOST = 64 };
#define FLIGHT_MOST 1.3     /* [m]: total flight of a polynomial, for any length of the run */
#define FADE_LOG_WIDTH -1.6 /* natural logarithm of the share of the run in which a fading shape is visible */
#define NO_FADE 60          /* the same logarithm for a shape that doesn't fade: e^60 is practically for ever */

typedef struct member {
    int32_t number;
    double centre[3], radius;
    double reach[3], rate[3], phase[3]; /* motion to and fro of rigid members and of those in keyframes */
    double axis[3], spin;               /* in the world [rad/s] */
    double rest[4];
} member;

static double chance(const tides_generate_options *options, int32_t number, int32_t which) {
    return td_hash((int32_t)options->seed, number, 200 + which);
}

/* Places each member roughly in a cell of its own in the space before the wall. */
static member member_of(const tides_generate_options *options, int32_t number) {
    const double crowding = td_pow(200.0 / options->count, 1.0 / 3), polar = td_acos(2 * chance(options, number, 3) - 1);
    member m = {.number = number};
    const double low[3] = {-1.75, -1.15, -0.6}, span[3] = {3.5, 2.4, 1.7};
    for (int k = 0; k < 3; k++) {
        m.centre[k] = low[k] + span[k] * chance(options, number, k);
        m.reach[k] = (0.08 + 0.17 * chance(options, number, 10 + k)) * fmin(1, crowding);
        m.rate[k] = 2 * TD_PI * (0.8 + 1.7 * chance(options, number, 13 + k));
        m.phase[k] = 2 * TD_PI * chance(options, number, 16 + k);
    }
    m.radius = fmin(0.22, (0.07 + 0.08 * chance(options, number, 4)) * crowding);
    m.axis[0] = td_sin(polar) * td_cos(2 * TD_PI * chance(options, number, 5));
    m.axis[1] = td_sin(polar) * td_sin(2 * TD_PI * chance(options, number, 5));
    m.axis[2] = td_cos(polar);
    m.spin = 12 * (chance(options, number, 6) - 0.5);
    td_quaternion_about(m.axis, 2 * TD_PI * chance(options, number, 7), m.rest);
    return m;
}

static void pose_at(void *shape, tides_pose_sample *sample) {
    const member *m = shape;
    double turn[4];
    for (int k = 0; k < 3; k++) {
        const double angle = m->rate[k] * sample->time + m->phase[k];
        sample->position[k] = m->centre[k] + m->reach[k] * td_sin(angle);
        sample->velocity[k] = m->reach[k] * m->rate[k] * td_cos(angle);
        sample->angular_velocity[k] = m->spin * m->axis[k];
    }
    td_quaternion_about(m->axis, m->spin * sample->time, turn);
    td_quaternion_product(turn, m->rest, sample->quaternion);
}

/* -- shapes -------------------------------------------------------------------------------------------*/

enum { BALL, DIE, DISC, SHAPES };

/* Builds a shape of radius 1 with its own colours. */
static void build_shape(td_splats *splats, const tides_generate_options *options, int32_t number) {
    static const int64_t made[SHAPES] = {TD_BALL_GAUSSIANS, TD_DIE_GAUSSIANS, TD_DISC_GAUSSIANS};
    const int32_t shape = number / MODELS % SHAPES;
    td_ball ball = {.pattern = number / 9 % TD_BALL_PATTERNS};
    td_disc disc = {.sectors = 6};
    td_die die;
    td_colour_pair(options->seed, number, ball.light, ball.dark);
    memcpy(disc.light, ball.light, sizeof disc.light);
    memcpy(disc.dark, ball.dark, sizeof disc.dark);
    memcpy(die.pips, ball.light, sizeof die.pips);
    memcpy(die.colour, ball.dark, sizeof die.colour);
    splats->detail = td_generate_detail(options, made[shape]);
    splats->thickness = 0.02;
    if (shape == BALL)
        td_build_ball(splats, &ball);
    else if (shape == DIE)
        td_build_die(splats, &die);
    else
        td_build_disc(splats, &disc);
}

/* -- rigid ----------------------------------------------------------------------------------------------------------*/

typedef struct rigid_shape {
    const tides_generate_options *options;
    int32_t number;
} rigid_shape;

static void build_rigid(td_splats *splats, const void *shape) {
    const rigid_shape *r = shape;
    build_shape(splats, r->options, r->number);
}

static tides_status add_rigid(const tides_generate_options *options, int32_t number, tides_scene *scene, tides_error *error) {
    member m = member_of(options, number);
    const rigid_shape shape = {options, number};
    char name[32];
    snprintf(name, sizeof name, "thing %d", (int)number);
    const td_part part = {name, build_rigid, &shape, 0, 0};
    tides_trajectory *path = NULL;
    tides_status status =
        td_sample_path(pose_at, &m, options, 0.008, &path, error); /* at most 0.13 rad of the fastest motion to and fro */
    if (status == TIDES_OK) status = td_part_add(scene, &part, path, m.radius, error);
    tides_trajectory_destroy(path);
    return status;
}

/* -- members with a common motion ----------------------------------------------------------------------------------------*/

/* The Gaussians of all members of a model, each member around the origin, and the first Gaussian of each. */
typedef struct herd {
    const tides_generate_options *options;
    td_splats splats;
    int32_t members;
    int64_t *first; /* (members + 1) */
    member *member; /* (members) */
} herd;

static void herd_free(herd *h) {
    td_splats_free(&h->splats);
    free(h->first);
    free(h->member);
}

static tides_status herd_make(const tides_generate_options *options, int32_t model, herd *h, tides_error *error) {
    *h = (herd){.options = options, .members = (options->count - model + MODELS - 1) / MODELS};
    h->first = td_alloc((size_t)h->members + 1, sizeof *h->first, error);
    h->member = h->first ? td_alloc((size_t)h->members, sizeof *h->member, error) : NULL;
    if (!h->member) return TIDES_NO_MEMORY;
    td_splats_start(&h->splats, error);
    for (int32_t i = 0; i < h->members; i++) {
        h->member[i] = member_of(options, model + i * MODELS);
        build_shape(&h->splats, options, h->member[i].number);
        td_splats_place(&h->splats, h->first[i], (const double[3]){0, 0, 0}, h->member[i].radius);
        h->first[i + 1] = h->splats.gaussians.count;
    }
    return h->splats.status;
}

/* Applies a pose to Gaussian i: sets its mean and quaternion. */
static void put(const td_gaussians *g, int64_t i, const tides_pose_sample *pose, float mean[3], float quaternion[4]) {
    const double *q = pose->quaternion, own[4] = {0, g->mean[3 * i], g->mean[3 * i + 1], g->mean[3 * i + 2]};
    const double back[4] = {q[0], -q[1], -q[2], -q[3]};
    const double turned[4] = {g->quaternion[4 * i], g->quaternion[4 * i + 1], g->quaternion[4 * i + 2],
                              g->quaternion[4 * i + 3]};
    double point[4], product[4];
    td_quaternion_product(q, own, point);
    td_quaternion_product(point, back, point);
    td_quaternion_product(q, turned, product);
    for (int k = 0; k < 3; k++) mean[k] = (float)(pose->position[k] + point[k + 1]);
    for (int k = 0; k < 4; k++) quaternion[k] = (float)product[k];
}

/* Sets means (N x 3) and quaternions (N x 4) of all members at `time`. */
static void put_all(const herd *h, double time, float *mean, float *quaternion) {
    for (int32_t m = 0; m < h->members; m++) {
        tides_pose_sample pose = {.time = h->options->speed * time};
        pose_at(&h->member[m], &pose);
        for (int64_t i = h->first[m]; i < h->first[m + 1]; i++)
            put(&h->splats.gaussians, i, &pose, mean + 3 * i, quaternion + 4 * i);
    }
}

static tides_status add_herd(const herd *h, tides_motion *motion, const char *name, tides_scene *scene, tides_error *error) {
    const tides_gaussians view = td_gaussians_view(&h->splats.gaussians);
    tides_status status = tides_scene_add_moving(scene, &view, motion, h->options->duration_s, NULL, 1.0, name, NULL, error);
    if (status != TIDES_OK) tides_motion_destroy(motion);
    return status;
}

/* -- polynomials: thrown, so that they curve; every third fades in and out ------------------------------------------------*/

typedef struct polynomial_arrays {
    float *centre, *log_width, *coefficient, *quaternion_dot;
} polynomial_arrays;

static void throw_all(const herd *h, const polynomial_arrays *arrays) {
    for (int32_t m = 0; m < h->members; m++) {
        const member *thing = &h->member[m];
        const double heading = 2 * TD_PI * chance(h->options, thing->number, 20);
        const double way = fmin(FLIGHT_MOST, 1.6 * h->options->speed * h->options->duration_s);
        const float flight[9] = {(float)(way * td_cos(heading)), (float)(way * td_sin(heading)), 0, 0, (float)(-0.8 * way), 0};
        const int fades = m % 3 == 2;
        for (int64_t i = h->first[m]; i < h->first[m + 1]; i++) {
            arrays->centre[i] = fades ? (float)chance(h->options, thing->number, 21) : 0.5f;
            arrays->log_width[i] = fades ? (float)FADE_LOG_WIDTH : NO_FADE;
            memcpy(arrays->coefficient + 9 * i, flight, sizeof flight);
        }
    }
}

static tides_status polynomial_motion(const herd *h, tides_motion **motion, tides_error *error) {
    const size_t n = (size_t)h->splats.gaussians.count;
    polynomial_arrays a = {.centre = td_alloc(n, sizeof(float), error)};
    tides_status status = TIDES_NO_MEMORY;
    if (a.centre) a.log_width = td_alloc(n, sizeof(float), error);
    if (a.log_width) a.coefficient = td_alloc(n, 9 * sizeof(float), error);
    if (a.coefficient) a.quaternion_dot = td_alloc(n, 4 * sizeof(float), error);
    if (a.quaternion_dot) {
        throw_all(h, &a);
        const tides_polynomial_motion given = {.count = (int64_t)n,
                                               .stop = 1,
                                               .opacity_centre = a.centre,
                                               .opacity_log_width = a.log_width,
                                               .mean_coefficient = a.coefficient,
                                               .quaternion_dot = a.quaternion_dot};
        status = tides_motion_create_polynomial(&given, motion, error);
    }
    free(a.centre);
    free(a.log_width);
    free(a.coefficient);
    free(a.quaternion_dot);
    return status;
}

static tides_status add_polynomials(const tides_generate_options *options, tides_scene *scene, tides_error *error) {
    herd h;
    tides_motion *motion = NULL;
    tides_status status = herd_make(options, POLYNOMIAL, &h, error);
    if (status == TIDES_OK) {
        put_all(&h, 0, h.splats.gaussians.mean, h.splats.gaussians.quaternion);
        status = polynomial_motion(&h, &motion, error);
    }
    if (status == TIDES_OK) status = add_herd(&h, motion, "things that are thrown", scene, error);
    herd_free(&h);
    return status;
}

/* -- keyframes ------------------------------------------------------------------------------------------------------------*/

static tides_status keyframe_motion(const herd *h, tides_motion **motion, tides_error *error) {
    const size_t n = (size_t)h->splats.gaussians.count;
    const double duration = h->options->duration_s;
    const size_t frames = (size_t)fmin(fmax(ceil(duration / FRAME_S), 4), FRAMES_MOST) + 1;
    double *time = td_alloc(frames, sizeof *time, error);
    float *mean = time ? td_alloc(n, 3 * frames * sizeof *mean, error) : NULL;
    float *quaternion = mean ? td_alloc(n, 4 * frames * sizeof *quaternion, error) : NULL;
    tides_status status = TIDES_NO_MEMORY;
    if (quaternion) {
        for (size_t f = 0; f < frames; f++) {
            time[f] = (double)f;
            put_all(h, duration * (double)f / (double)(frames - 1), mean + 3 * n * f, quaternion + 4 * n * f);
        }
        const tides_keyframes_motion given = {.frames = (int64_t)frames,
                                              .count = (int64_t)n,
                                              .time = time,
                                              .mean = mean,
                                              .quaternion = quaternion};
        status = tides_motion_create_keyframes(&given, motion, error);
    }
    free(time);
    free(mean);
    free(quaternion);
    return status;
}

static tides_status add_keyframes(const tides_generate_options *options, tides_scene *scene, tides_error *error) {
    herd h;
    tides_motion *motion = NULL;
    tides_status status = herd_make(options, KEYFRAMES, &h, error);
    if (status == TIDES_OK) status = keyframe_motion(&h, &motion, error);
    if (status == TIDES_OK) { /* stores the Gaussians as they are at the start, for programs that don't read the motion */
        put_all(&h, 0, h.splats.gaussians.mean, h.splats.gaussians.quaternion);
        status = add_herd(&h, motion, "things in keyframes", scene, error);
    }
    herd_free(&h);
    return status;
}

tides_status td_generate_crowd(const tides_generate_options *options, tides_world *world, tides_error *error) {
    static const td_part wall = {"wall", td_build_wall, NULL, 0, 0};
    tides_status status = td_part_add(world->scene, &wall, NULL, 1.0, error);
    for (int32_t i = RIGID; i < options->count && status == TIDES_OK; i += MODELS)
        status = add_rigid(options, i, world->scene, error);
    if (status == TIDES_OK && options->count > POLYNOMIAL) status = add_polynomials(options, world->scene, error);
    if (status == TIDES_OK && options->count > KEYFRAMES) status = add_keyframes(options, world->scene, error);
    return status == TIDES_OK ? td_path_still_camera(&world->camera, error) : status;
}
