/* The kinds of generated worlds, their options, and the function that makes any of them. */
#include "generate/td_generate.h"
#include "td_base.h"
#include "td_struct.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

#define LONGEST_S 600.0                 /* longer paths should come from files */
#define FASTEST 1000.0                  /* times the kind's own speed */
#define MOST_GAUSSIANS 20000000         /* 1.1 GB as arrays, and twice that while a file is written */
#define MOST_PIXELS 8192                /* of a side */
#define FOCAL_PER_WIDTH (300.0 / 346.0) /* focal length per width: 60 degrees across */

typedef struct kind {
    tides_generator shown; /* name, summary, what is counted, default and largest count, Gaussians of each, duration [s] */
    tides_status (*make)(const tides_generate_options *options, tides_world *world, tides_error *error);
    double background[3];
    double up; /* y of the scene's up direction; 0: unknown, as for a wall alone */
} kind;

#define DARK \
    { 0.02, 0.02, 0.03 }

static const kind kinds[] = {
    {{"fan", "a patterned fan that spins behind its guard, in a room; handheld camera", NULL, 0, 0, TD_FAN_GAUSSIANS, 0.3},
     td_generate_fan,
     DARK,
     1},
    {{"pendulum", "pendulums with patterned bobs that swing past each other; handheld camera", "pendulums", 5, 100, 1800, 0.5},
     td_generate_pendulum,
     DARK,
     1},
    {{"balls", "balls that spin and bounce on a table; handheld camera", "balls", 7, 1000, TD_BALL_GAUSSIANS, 0.5},
     td_generate_balls,
     DARK,
     1},
    {{"plane", "a textured plane at rest (one object, so .ply will do); the camera slides past it", NULL, 0, 0,
      2 * TD_PLANE_GAUSSIANS, 0.3},
     td_generate_plane,
     {0.05, 0.05, 0.05},
     0},
    {{"crowd", "things that fly about, a third each rigid, polynomial (some fade) and keyframed; camera at rest", "things", 200,
      10000, 300, 0.5},
     td_generate_crowd,
     DARK,
     1},
    {{"disc", "discs with sectors that turn before a wall; camera at rest", "discs", 1, 100, 4 * TD_DISC_GAUSSIANS, 0.3},
     td_generate_disc,
     DARK,
     0},
    {{"room", "a brick wall, posters, a table and balls at rest; handheld camera", NULL, 0, 0, 0, 0.3},
     td_generate_room,
     DARK,
     1},
};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

static tides_generator generators[KINDS];
static pthread_once_t made_list = PTHREAD_ONCE_INIT;

static void make_list(void) {
    for (size_t i = 0; i < KINDS; i++) generators[i] = kinds[i].shown;
}

const tides_generator *tides_generators(size_t *count) {
    pthread_once(&made_list, make_list);
    if (count) *count = KINDS;
    return generators;
}

void tides_generate_options_defaults(tides_generate_options *options) {
    *options = (tides_generate_options){.size = sizeof *options, .speed = 1, .seed = 1, .width = 346, .height = 260};
}

static tides_status find(const char *name, const kind **found, tides_error *error) {
    const char *names[KINDS + 1] = {NULL};
    char list[256] = "";
    for (size_t i = 0; i < KINDS; i++) {
        names[i] = kinds[i].shown.name;
        *found = &kinds[i];
        if (strcmp(name, names[i]) == 0) return TIDES_OK;
        const size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s%s", i == 0 ? "" : i + 1 == KINDS ? " or " : ", ", names[i]);
    }
    const char *nearest = tides_nearest_name(name, names);
    return nearest ? td_fail(error, TIDES_BAD_ARGUMENT, "unknown kind of scene '%.80s'; did you mean '%s'?", name, nearest)
                   : td_fail(error, TIDES_BAD_ARGUMENT, "unknown kind of scene '%.80s': must be %s", name, list);
}

/* Sets the numbers of objects and Gaussians, by default or option. */
static tides_status settle_counts(const tides_generator *g, tides_generate_options *o, tides_error *error) {
    if (o->count && !g->counted)
        return td_fail(error, TIDES_BAD_ARGUMENT, "count is %d: a %s has none", (int)o->count, g->name);
    if (o->gaussians && !g->gaussians)
        return td_fail(error, TIDES_BAD_ARGUMENT, "gaussians is %lld: a %s has a fixed number", (long long)o->gaussians,
                       g->name);
    if (!o->count) o->count = g->count;
    if (!o->gaussians) o->gaussians = g->gaussians;
    if (g->counted && (o->count < 1 || o->count > g->count_most))
        return td_fail(error, TIDES_BAD_ARGUMENT, "count is %d: must be 1 to %d %s", (int)o->count, (int)g->count_most,
                       g->counted);
    const int64_t each = g->counted ? o->count : 1;
    if (o->gaussians < 0 || o->gaussians > MOST_GAUSSIANS / each)
        return td_fail(error, TIDES_BAD_ARGUMENT, "gaussians is %lld: must be 1 to %lld (%d in all)", (long long)o->gaussians,
                       (long long)(MOST_GAUSSIANS / each), MOST_GAUSSIANS);
    return TIDES_OK;
}

static tides_status settle(const tides_generator *g, tides_generate_options *o, tides_error *error) {
    if (!(o->duration_s >= 0 && o->duration_s <= LONGEST_S))
        return td_fail(error, TIDES_BAD_ARGUMENT, "duration_s is %g: must be above 0 (or 0 for the default) and at most %g",
                       o->duration_s, LONGEST_S);
    if (!(o->speed > 0 && o->speed <= FASTEST))
        return td_fail(error, TIDES_BAD_ARGUMENT, "speed is %g: must be above 0 and at most %g", o->speed, FASTEST);
    if (o->width < 1 || o->width > MOST_PIXELS || o->height < 1 || o->height > MOST_PIXELS)
        return td_fail(error, TIDES_BAD_ARGUMENT, "the image is %d x %d pixels: sides must be 1 to %d", (int)o->width,
                       (int)o->height, MOST_PIXELS);
    if (!(o->duration_s > 0)) o->duration_s = g->duration_s;
    return settle_counts(g, o, error);
}

tides_status tides_generate(const char *name, const tides_generate_options *options, tides_world *world, tides_error *error) {
    if (!name || !options || !world)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_generate: %s is NULL", !name ? "kind" : options ? "world" : "options");
    const kind *k = NULL;
    tides_status status = find(name, &k, error);
    if (status != TIDES_OK) return status;
    tides_generate_options own;
    tides_generate_options_defaults(&own);
    status = TD_TAKE_STRUCT(tides_generate_options, &own, options, error);
    if (status == TIDES_OK) status = settle(&k->shown, &own, error);
    if (status != TIDES_OK) return td_fail_within(error, status, "%s", name);
    tides_world made = {.duration_s = own.duration_s};
    const double focal = FOCAL_PER_WIDTH * own.width;
    made.intrinsics = (tides_intrinsics){own.width, own.height, focal, focal, 0.5 * own.width, 0.5 * own.height, {0}};
    memcpy(made.background, k->background, sizeof made.background);
    status = tides_scene_create(&made.scene, error);
    if (status == TIDES_OK) status = k->make(&own, &made, error);
    if (status == TIDES_OK) status = tides_scene_set_up(made.scene, (const double[]){0, k->up, 0}, error);
    if (status == TIDES_OK)
        *world = made;
    else
        tides_world_release(&made);
    return status == TIDES_OK ? status : td_fail_within(error, status, "%s", name);
}

void tides_world_release(tides_world *world) {
    if (!world) return;
    tides_scene_destroy(world->scene);
    tides_trajectory_destroy(world->camera);
    memset(world, 0, sizeof *world);
}
