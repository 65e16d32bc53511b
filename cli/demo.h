/* The demo's world: y up, z towards the camera, metres. A wall and a table at rest, and a fan that turns. */
#ifndef CLI_DEMO_H
#define CLI_DEMO_H

#include "cli.h"

/* demo_splats.c: a growing set of flat Gaussians; `failed` is set where memory ran out. */
typedef struct demo_splats {
    tides_gaussians view; /* of the arrays below */
    float *mean, *log_scale, *quaternion, *opacity, *sh;
    size_t count, capacity;
    int32_t sh_degree, failed;
} demo_splats;

/* A point and colour (sRGB, 0..1) of a surface at (u, v) in [0, 1]^2. */
typedef void (*demo_surface)(const void *shape, double u, double v, double point[3], double colour[3]);

void demo_splats_start(demo_splats *splats, int32_t sh_degree);
void demo_splats_free(demo_splats *splats);
/* One Gaussian: standard deviations along two tangents and the normal (tangent x tangent); shaded by the demo's light. */
void demo_splat(demo_splats *splats, const double point[3], const double along[3], const double across[3],
                const double sigma[3], const double colour[3]);
/* Covers a surface with nu x nv Gaussians whose axes and sizes follow it. */
void demo_cover(demo_splats *splats, demo_surface surface, const void *shape, int32_t nu, int32_t nv);
/* A thin line from a to b in `count` pieces, `width` wide (one standard deviation), facing +z. */
void demo_line(demo_splats *splats, const double a[3], const double b[3], int32_t count, double width, const double colour[3]);
/* A number in [0, 1) that depends on its arguments only. */
double demo_hash(int32_t a, int32_t b, int32_t c);

/* demo_room.c, demo_fan.c: the parts. */
void demo_wall(demo_splats *splats);
void demo_table(demo_splats *splats);
void demo_balls(demo_splats *splats);
void demo_stand(demo_splats *splats);
void demo_guard(demo_splats *splats);
void demo_blades(demo_splats *splats);

/* Where the fan is and how it turns; the stand and guard are built around it. */
enum { DEMO_BLADES = 5 };
#define DEMO_FAN_X 0.0
#define DEMO_FAN_Y 0.18
#define DEMO_FAN_RADIUS 0.78
#define DEMO_TABLE_Y (-0.92)
#define DEMO_WALL_Z (-0.95)

/* The fan's rotation matrix at rest: turned a little to the side, columns are its axes in the world. */
void demo_fan_axes(double rotation[9]);

/* demo_scene.c: writes room.h5, fan.ply, fan.json, camera.json and run.json below `directory`. */
tides_status demo_scene_write(const char *directory, tides_error *error);

#endif
