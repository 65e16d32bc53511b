/* tides camera: writes a camera path made by a formula, placed by a scene if one is given. */
#include "cli.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE 0.017453292519943295 /* [rad] */

/* The texts of the options, NULL where not given. */
typedef struct camera_texts {
    const char *output, *scene, *size, *fov, *up, *target, *from, *to, *start, *stop, *turn, *shake, *sway, *frequency, *seed;
} camera_texts;

/* Values of the options; those that aren't given come from the scene, or are defaults. */
typedef struct camera_plan {
    tides_intrinsics intrinsics;
    double up[3], target[3], from[3], to[3];
    double start, stop, turn_s;         /* [s] */
    double shake, sway, frequency, fov; /* [scene units], [rad], [Hz], [rad] */
    double seed;
    tides_orbit orbit;
} camera_plan;

static int read_vector(const cli_command *command, const char *option, const char *text, double vector[3]) {
    char rest;
    if (!text) return CLI_GO;
    if (sscanf(text, "%lf,%lf,%lf%c", &vector[0], &vector[1], &vector[2], &rest) == 3 && isfinite(vector[0]) &&
        isfinite(vector[1]) && isfinite(vector[2]))
        return CLI_GO;
    return cli_usage(command, "%s %s: must be three numbers with commas between, as 0,-1,0", option, text);
}

static int read_numbers(const cli_command *command, const camera_texts *t, camera_plan *p) {
    const struct {
        const char *option, *text;
        double *number;
    } rows[] = {{"--start", t->start, &p->start}, {"--stop", t->stop, &p->stop}, {"--turn", t->turn, &p->turn_s},
                {"--shake", t->shake, &p->shake}, {"--sway", t->sway, &p->sway}, {"--frequency", t->frequency, &p->frequency},
                {"--seed", t->seed, &p->seed},    {"--fov", t->fov, &p->fov}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const int code = rows[i].text ? cli_number(command, rows[i].option, rows[i].text, rows[i].number) : CLI_GO;
        if (code != CLI_GO) return code;
    }
    if (!(p->fov > 0 && p->fov < 180)) return cli_usage(command, "--fov %g: must lie between 0 and 180 degrees", p->fov);
    if (!(p->stop > p->start)) return cli_usage(command, "--stop %g: must be after --start %g", p->stop, p->start);
    if (!(fabs(p->turn_s) > 0)) return cli_usage(command, "--turn: seconds of a turn can't be 0");
    if (!(p->seed >= 0 && p->seed <= 0x1p53))
        return cli_usage(command, "--seed %s: must be a whole number below 2^53", t->seed);
    p->fov *= DEGREE;
    p->sway *= DEGREE;
    return CLI_GO;
}

static int read_size(const cli_command *command, const char *text, camera_plan *p) {
    int width = 640, height = 480;
    char rest;
    if (text && (sscanf(text, "%5dx%5d%c", &width, &height, &rest) != 2 || width < 1 || height < 1))
        return cli_usage(command, "--size %s: must be WIDTHxHEIGHT in pixels, as 346x260", text);
    const double focal = 0.5 * width / tan(0.5 * p->fov);
    p->intrinsics =
        (tides_intrinsics){.width = width, .height = height, .fx = focal, .fy = focal, .cx = 0.5 * width, .cy = 0.5 * height};
    return CLI_GO;
}

/* Takes target, up and distance from the scene. */
static tides_status ask_scene(const camera_texts *t, camera_plan *p, tides_error *error) {
    tides_scene *scene = NULL;
    const double narrower = fmin(p->intrinsics.width, p->intrinsics.height) / p->intrinsics.fx;
    tides_status status = tides_scene_create(&scene, error);
    if (status == TIDES_OK) status = tides_scene_add_file(scene, t->scene, NULL, 1.0, error);
    if (status == TIDES_OK) status = tides_scene_orbit(scene, t->up ? p->up : NULL, 2 * atan(0.5 * narrower), &p->orbit, error);
    tides_scene_destroy(scene);
    if (status != TIDES_OK) return status;
    memcpy(p->up, p->orbit.up, sizeof p->up);
    if (!t->target) memcpy(p->target, p->orbit.target, sizeof p->target);
    return TIDES_OK;
}

/* Where the camera begins, and a dolly ends: on the scene's orbit, unless the options say otherwise. */
static tides_status place(const camera_texts *t, camera_plan *p, tides_error *error) {
    tides_trajectory *orbit = NULL;
    tides_pose pose;
    if (!t->scene) return TIDES_OK;
    tides_status status = tides_trajectory_create_orbit(&p->orbit, &orbit, error);
    if (status == TIDES_OK) status = tides_trajectory_at(orbit, p->orbit.start, &pose, error);
    if (status == TIDES_OK && !t->from) memcpy(p->from, pose.position, sizeof p->from);
    if (status == TIDES_OK) status = tides_trajectory_at(orbit, p->orbit.start + 0.05 * p->orbit.stop, &pose, error);
    if (status == TIDES_OK && !t->to) memcpy(p->to, pose.position, sizeof p->to);
    tides_trajectory_destroy(orbit);
    return status;
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Height, radius and angle of the orbit that begins at `from`. Angles count from the world's x axis, or y where x is up. */
static void begin_orbit(camera_plan *p) {
    const double length = sqrt(dot(p->up, p->up));
    double out[3], up[3], ahead[3] = {0};
    for (int k = 0; k < 3; k++) {
        out[k] = p->from[k] - p->target[k];
        up[k] = p->up[k] / length;
    }
    ahead[fabs(up[0]) < 0.9 ? 0 : 1] = 1;
    const double above = dot(out, up), along = dot(ahead, up);
    for (int k = 0; k < 3; k++) {
        out[k] -= above * up[k];
        ahead[k] -= along * up[k];
    }
    const double aside[3] = {up[1] * ahead[2] - up[2] * ahead[1], up[2] * ahead[0] - up[0] * ahead[2],
                             up[0] * ahead[1] - up[1] * ahead[0]};
    p->orbit.height = above;
    p->orbit.radius = sqrt(dot(out, out));
    p->orbit.start_angle = atan2(dot(out, aside), dot(out, ahead));
}

/* Sets the orbit from `from` on, or the scene's. */
static void aim_orbit(camera_plan *p, int32_t from_given) {
    if (from_given) begin_orbit(p);
    memcpy(p->orbit.target, p->target, sizeof p->target);
    memcpy(p->orbit.up, p->up, sizeof p->up);
    p->orbit.angular_speed = 360 * DEGREE / p->turn_s;
    p->orbit.start = p->start;
    p->orbit.stop = p->stop;
}

static tides_status make(const char *kind, const camera_texts *t, camera_plan *p, tides_trajectory **path, tides_error *error) {
    if (strcmp(kind, "orbit") == 0) {
        aim_orbit(p, t->from != NULL);
        return tides_trajectory_create_orbit(&p->orbit, path, error);
    }
    if (strcmp(kind, "handheld") == 0) {
        tides_handheld held = {.position_amplitude = p->shake,
                               .rotation_amplitude = p->sway,
                               .frequency = p->frequency,
                               .seed = (uint64_t)p->seed,
                               .start = p->start,
                               .stop = p->stop};
        memcpy(held.position, p->from, sizeof p->from);
        memcpy(held.target, p->target, sizeof p->target);
        memcpy(held.up, p->up, sizeof p->up);
        return tides_trajectory_create_handheld(&held, path, error);
    }
    tides_dolly dolly = {.start = p->start, .stop = p->stop};
    const int32_t still = strcmp(kind, "look-at") == 0;
    memcpy(dolly.from, p->from, sizeof p->from);
    memcpy(dolly.to, still ? p->from : p->to, sizeof p->to);
    memcpy(dolly.target, p->target, sizeof p->target);
    memcpy(dolly.up, p->up, sizeof p->up);
    return tides_trajectory_create_dolly(&dolly, path, error);
}

static int check(const cli_command *command, const char *kind, const camera_texts *t) {
    static const char *const kinds[] = {"orbit", "dolly", "handheld", "look-at", NULL};
    int known = 0;
    for (int i = 0; kinds[i]; i++) known |= strcmp(kind, kinds[i]) == 0;
    const char *nearest = known ? NULL : tides_nearest_name(kind, kinds);
    if (!known)
        return cli_usage(command, "%s: none of orbit, dolly, handheld, look-at%s%s%s", kind, nearest ? "; did you mean " : "",
                         nearest ? nearest : "", nearest ? "?" : "");
    if (!t->output) return cli_usage(command, "the output is missing: -o PATH.json");
    if (!t->scene && !t->from) return cli_usage(command, "from where? --scene SCENE finds it, --from X,Y,Z says it");
    if (strcmp(kind, "dolly") == 0 && !t->scene && !t->to) return cli_usage(command, "to where? --to X,Y,Z says it");
    return CLI_GO;
}

static int write_path(const char *kind, const camera_texts *t, camera_plan *p, const cli_common *common) {
    tides_error error = {TIDES_OK, ""};
    tides_trajectory *path = NULL;
    const cli_output written = {t->output, ".json"};
    tides_status status = cli_check_outputs(t->scene, &written, 1, &error);
    if (status == TIDES_OK && t->scene) status = ask_scene(t, p, &error);
    if (status == TIDES_OK) status = place(t, p, &error);
    if (status == TIDES_OK) status = make(kind, t, p, &path, &error);
    if (status == TIDES_OK) status = tides_path_save(t->output, path, &p->intrinsics, &error);
    cJSON *facts = status == TIDES_OK ? cJSON_CreateObject() : NULL;
    if (facts) {
        cJSON_AddStringToObject(facts, "file", t->output);
        cJSON_AddNumberToObject(facts, "samples", (double)tides_trajectory_count(path));
        cJSON_AddItemToObject(facts, "target", cJSON_CreateDoubleArray(p->target, 3));
        cJSON_AddItemToObject(facts, "up", cJSON_CreateDoubleArray(p->up, 3));
    }
    tides_trajectory_destroy(path);
    return status == TIDES_OK ? cli_report_facts(facts, common) : cli_fail(&error);
}

int cmd_camera(const cli_command *command, int argc, char **argv) {
    cli_common common;
    const char *kind = NULL;
    camera_texts t = {.output = NULL};
    const cli_option options[] = {
        {"--output", 'o', "PATH.json", "the path, with its image size and focal length (required)", NULL, &t.output, NULL},
        {"--scene", 0, "FILE", "look at the middle of this scene, from as far as shows it", NULL, &t.scene, NULL},
        {"--from", 0, "X,Y,Z", "where the camera is, or begins", NULL, &t.from, NULL},
        {"--to", 0, "X,Y,Z", "dolly: where it ends", NULL, &t.to, NULL},
        {"--target", 0, "X,Y,Z", "what it looks at (0,0,0, or the scene's middle)", NULL, &t.target, NULL},
        {"--up", 0, "X,Y,Z", "what is up (0,-1,0, or guessed from the scene)", NULL, &t.up, NULL},
        {"--start", 0, "S", "when the path begins [s] (0)", NULL, &t.start, NULL},
        {"--stop", 0, "S", "when it ends [s] (1)", NULL, &t.stop, NULL},
        {"--turn", 0, "S", "orbit: seconds of a turn; below 0: the other way (12)", NULL, &t.turn, NULL},
        {"--shake", 0, "UNITS", "handheld: rms of its place along each axis (0.01)", NULL, &t.shake, NULL},
        {"--sway", 0, "DEGREES", "handheld: rms of its turning about each axis (0.5)", NULL, &t.sway, NULL},
        {"--frequency", 0, "HZ", "handheld: of the slowest shaking (1)", NULL, &t.frequency, NULL},
        {"--seed", 0, "N", "handheld: another hand (0)", NULL, &t.seed, NULL},
        {"--size", 0, "WxH", "image size [px] (640x480)", NULL, &t.size, NULL},
        {"--fov", 0, "DEGREES", "field of view across the image's width (60)", NULL, &t.fov, NULL},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    camera_plan p = {.up = {0, -1, 0}, .stop = 1, .turn_s = 12, .shake = 0.01, .sway = 0.5, .frequency = 1, .fov = 60};
    int code = cli_parse(command, options, argc, argv, &common, &kind);
    if (code == CLI_GO) code = check(command, kind, &t);
    if (code == CLI_GO) code = read_numbers(command, &t, &p);
    if (code == CLI_GO) code = read_size(command, t.size, &p);
    if (code == CLI_GO) code = read_vector(command, "--up", t.up, p.up);
    if (code == CLI_GO) code = read_vector(command, "--target", t.target, p.target);
    if (code == CLI_GO) code = read_vector(command, "--from", t.from, p.from);
    if (code == CLI_GO) code = read_vector(command, "--to", t.to, p.to);
    return code == CLI_GO ? write_path(kind, &t, &p, &common) : code;
}
