/* The static parts of a room: a brick wall with two posters, a wooden table, and three balls. */
#include "generate/td_generate.h"
#include "tides/image.h"
#include "td_math.h"

#include <math.h>
#include <string.h>

static void mix(const double a[3], const double b[3], double share, double mixed[3]) {
    for (int i = 0; i < 3; i++) mixed[i] = a[i] + share * (b[i] - a[i]);
}

/* -- wall: one or two big soft splats per brick; thin mortar lines and dark specks in front ------------------- */

enum { COURSES = 27 };
/* Sizes and places [m]. */
#define BRICK_WIDTH 0.36
#define BRICK_HEIGHT 0.15
#define WALL_LEFT (-2.9)
#define WALL_RIGHT 2.9
#define WALL_BOTTOM (-1.65)
/* Distance of mortar and specks from the bricks [m], so that no small turn of the camera changes their order. */
#define WALL_STEP 0.03

static const double right[3] = {1, 0, 0}, up[3] = {0, 1, 0};

static void brick(td_splats *splats, double x, double y, int32_t column, int32_t course) {
    static const double pale[3] = {0.74, 0.42, 0.30}, dark[3] = {0.47, 0.20, 0.15}, grey[3] = {0.40, 0.33, 0.31};
    static const double sigma[3] = {0.075, 0.062, 0.002};
    double colour[3];
    mix(dark, pale, td_hash(column, course, 1), colour);
    if (td_hash(column, course, 2) > 0.86) mix(colour, grey, 0.7, colour);
    for (int32_t half = 0; half < 2; half++) {
        const double point[3] = {x + (half - 0.5) * 0.5 * BRICK_WIDTH, y, TD_WALL_Z};
        td_splats_add(splats, point, right, up, sigma, colour);
    }
    for (int32_t speck = 0; speck < 9; speck++) {
        const double point[3] = {x + (td_hash(column, course, 10 + speck) - 0.5) * 0.30,
                                 y + (td_hash(column, course, 30 + speck) - 0.5) * 0.10, TD_WALL_Z + WALL_STEP};
        const double size = 0.006 + 0.012 * td_hash(column, course, 50 + speck);
        const double speck_sigma[3] = {1.6 * size, size, 0.002};
        double tint[3];
        mix(colour, speck % 3 ? dark : pale, 0.6, tint);
        for (int i = 0; i < 3; i++) tint[i] *= speck % 3 ? 0.75 : 1.1;
        td_splats_add(splats, point, right, up, speck_sigma, tint);
    }
}

static void mortar(td_splats *splats, double x, double y, double dx, double dy, int32_t count) {
    static const double colour[3] = {0.80, 0.77, 0.70};
    const double a[3] = {x, y, TD_WALL_Z + WALL_STEP}, b[3] = {x + dx, y + dy, TD_WALL_Z + WALL_STEP};
    td_splats_line(splats, a, b, count, 0.0075, colour);
}

static void bricks(td_splats *splats) {
    for (int32_t course = 0; course < COURSES; course++) {
        const double y = WALL_BOTTOM + (course + 0.5) * BRICK_HEIGHT, shift = course % 2 ? 0.5 * BRICK_WIDTH : 0.0;
        mortar(splats, WALL_LEFT, y - 0.5 * BRICK_HEIGHT, WALL_RIGHT - WALL_LEFT, 0, 48);
        for (int32_t column = 0; WALL_LEFT + column * BRICK_WIDTH < WALL_RIGHT; column++) {
            const double x = WALL_LEFT + column * BRICK_WIDTH + shift;
            brick(splats, x, y, column, course);
            mortar(splats, x + 0.5 * BRICK_WIDTH, y - 0.5 * BRICK_HEIGHT, 0, BRICK_HEIGHT, 2);
        }
    }
}

/* -- posters ---------------------------------------------------------------------------------------------------------- */

typedef struct sheet {
    double left, bottom, width, height, z;
    double colour[3], faded[3];
} sheet;

static void sheet_surface(const void *shape, double u, double v, double point[3], double colour[3]) {
    const sheet *s = shape;
    point[0] = s->left + u * s->width;
    point[1] = s->bottom + v * s->height;
    point[2] = s->z;
    mix(s->colour, s->faded, v, colour);
}

/* Draws letters on the poster, with a splat for each dot of the library's bitmap font. */
static void poster_text(td_splats *splats, const char *text, double left, double top, double z, const double colour[3]) {
    enum { COLUMNS = 36, ROWS = 9 };
    static const uint8_t ink[3] = {1, 1, 1};
    static const double dot_size = 0.031, sigma[3] = {0.5 * 0.031, 0.5 * 0.031, 0.002};
    uint8_t dots[ROWS * COLUMNS * 3] = {0};
    tides_picture_text(dots, COLUMNS, ROWS, 0, 0, 1, ink, text);
    for (int32_t i = 0; i < ROWS * COLUMNS; i++) {
        if (!dots[3 * i]) continue;
        const int32_t row = i / COLUMNS, column = i % COLUMNS;
        const double point[3] = {left + dot_size * column, top - dot_size * row, z};
        td_splats_add(splats, point, right, up, sigma, colour);
    }
}

/* A poster with TIDES over three waves. */
static void title_poster(td_splats *splats) {
    static const sheet paper = {-1.92, 0.42, 1.06, 0.78, TD_WALL_Z + 0.08, {0.04, 0.20, 0.36}, {0.05, 0.36, 0.52}};
    static const double white[3] = {0.97, 0.95, 0.88}, foam[3] = {0.45, 0.86, 0.86};
    const double z = paper.z + WALL_STEP;
    td_splats_cover(splats, sheet_surface, &paper, 26, 19);
    poster_text(splats, "TIDES", paper.left + 0.09, paper.bottom + 0.69, z, white);
    for (int32_t wave = 0; wave < 3; wave++)
        for (int32_t i = 0; i < 40; i++) {
            const double x = 0.08 + 0.90 * (i + 0.5) / 40, phase = 2 * TD_PI * (2.5 * x + 0.21 * wave);
            const double point[3] = {paper.left + x, paper.bottom + 0.34 - 0.11 * wave + 0.035 * td_sin(phase), z};
            const double along[3] = {1, 0.035 * 2 * TD_PI * 2.5 * td_cos(phase), 0}, sigma[3] = {0.020, 0.010, 0.002};
            td_splats_add(splats, point, along, up, sigma, wave == 1 ? white : foam);
        }
}

/* Surface of a Siemens star: black and white sectors, whose stripes become finer towards the centre. */
static void star_surface(const void *shape, double u, double v, double point[3], double colour[3]) {
    static const double white[3] = {0.95, 0.94, 0.90}, black[3] = {0.07, 0.07, 0.09};
    const double *centre = shape, radius = 0.03 + 0.40 * v, angle = -2 * TD_PI * u; /* faces the room */
    point[0] = centre[0] + radius * td_cos(angle);
    point[1] = centre[1] + radius * td_sin(angle);
    point[2] = centre[2];
    memcpy(colour, (int32_t)floor(u * 24) % 2 ? white : black, sizeof white);
}

static void star_poster(td_splats *splats) {
    static const sheet paper = {0.98, 0.24, 0.96, 0.96, TD_WALL_Z + 0.08, {0.93, 0.90, 0.80}, {0.96, 0.94, 0.87}};
    static const double centre[3] = {1.46, 0.72, TD_WALL_Z + 0.08 + WALL_STEP};
    td_splats_cover(splats, sheet_surface, &paper, 20, 20);
    td_splats_cover(splats, star_surface, centre, 72, 9);
}

void td_build_wall(td_splats *splats, const void *shape) {
    static const sheet plaster = {-3.1, -1.75, 6.2, 4.3, TD_WALL_Z - 0.03, {0.50, 0.42, 0.37}, {0.55, 0.47, 0.42}};
    (void)shape;
    td_splats_cover(splats, sheet_surface, &plaster, 40, 28);
    bricks(splats);
    title_poster(splats);
    star_poster(splats);
}

/* -- table: planks from the wall towards the camera ------------------------------------------------------------------- */

enum { PLANKS = 13 };

static void plank_surface(const void *shape, double u, double v, double point[3], double colour[3]) {
    static const double pale[3] = {0.78, 0.58, 0.36}, dark[3] = {0.50, 0.32, 0.17};
    const int32_t plank = *(const int32_t *)shape;
    const double width = 4.6 / PLANKS;
    point[0] = -2.3 + (plank + 0.02 + 0.96 * u) * width;
    point[1] = TD_TABLE_Y;
    point[2] = 1.0 - 1.9 * v; /* from the edge to the wall: along x across -z faces up */
    const double grain = 0.5 + 0.5 * td_sin(40 * u + 6 * td_hash(plank, 0, 0) + 3 * td_sin(5 * v + plank));
    mix(dark, pale, 0.35 + 0.4 * td_hash(plank, 1, 0) + 0.25 * grain, colour);
    if (u < 0.09 || u > 0.91) mix(colour, dark, 0.8, colour);
}

static void edge_surface(const void *shape, double u, double v, double point[3], double colour[3]) {
    static const double wood[3] = {0.42, 0.26, 0.14};
    (void)shape;
    point[0] = -2.3 + 4.6 * u;
    point[1] = TD_TABLE_Y - 0.08 * (1 - v);
    point[2] = 1.0;
    memcpy(colour, wood, sizeof wood);
}

void td_build_table(td_splats *splats, const void *shape) {
    (void)shape;
    for (int32_t plank = 0; plank < PLANKS; plank++) td_splats_cover(splats, plank_surface, &plank, 10, 14);
    td_splats_cover(splats, edge_surface, NULL, 60, 3);
}

/* -- the room --------------------------------------------------------------------------------------------------------- */

static void still_ball(td_splats *splats, double x, double z, double radius, const td_ball *ball) {
    const int64_t first = splats->gaussians.count;
    const double centre[3] = {x, TD_TABLE_Y + radius, z};
    td_build_ball(splats, ball);
    td_splats_place(splats, first, centre, radius);
}

void td_build_still_balls(td_splats *splats, const void *shape) {
    static const td_ball beach = {TD_BALL_STRIPES, {0.98, 0.80, 0.18}, {0.88, 0.18, 0.16}},
                         checker = {TD_BALL_CHECKER, {0.96, 0.95, 0.92}, {0.09, 0.09, 0.12}},
                         dots = {TD_BALL_DOTS, {0.96, 0.95, 0.92}, {0.05, 0.50, 0.52}};
    (void)shape;
    still_ball(splats, -0.98, 0.18, 0.27, &beach);
    still_ball(splats, 0.62, 0.62, 0.22, &checker);
    still_ball(splats, 1.36, -0.30, 0.30, &dots);
}

tides_status td_generate_room(const tides_generate_options *options, tides_world *world, tides_error *error) {
    static const td_part parts[] = {{"wall", td_build_wall, NULL, 0, 0},
                                    {"table", td_build_table, NULL, 0, 0},
                                    {"balls", td_build_still_balls, NULL, 0, 0.008}};
    static const double position[3] = {0.10, 0.42, 3.05}, target[3] = {0.0, -0.02, 0.0};
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0] && status == TIDES_OK; i++)
        status = td_part_add(world->scene, &parts[i], NULL, 1.0, error);
    return status == TIDES_OK ? td_path_camera(position, target, options, &world->camera, error) : status;
}
