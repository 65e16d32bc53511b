/* The oracle's image: rules `smooth` in double precision (docs/DESIGN.md 3.1, docs/soft_order.md), values alone. */
#ifndef TESTS_ORACLE_IMAGE_H
#define TESTS_ORACLE_IMAGE_H

#include "tests/oracle/scene.h"

/* An object before the camera: p_camera = rotation p + shift; the eye in its coordinates; its keyframes' place. */
typedef struct oracle_seen {
    double rotation[9], shift[3], eye[3];
    oracle_place place;
} oracle_seen;

typedef struct oracle_view {
    double time;
    oracle_seen object[ORACLE_OBJECTS];
} oracle_view;

/* A Gaussian on the screen. */
typedef struct oracle_shown {
    int id, visible;          /* 0: not beyond the near plane, or below the taper; the rest means nothing */
    double u, v;              /* its middle [px] */
    double xx, xy, yy;        /* the inverse covariance [1/px^2] */
    double opacity;           /* at the middle */
    double across, down;      /* variances [px^2] */
    double reach_x, reach_y;  /* half-widths of the box around it [px] */
    double place;             /* ln z / soft_depth */
    double colour[3], raw[3]; /* by channel, and before the clamp at 0 */
} oracle_shown;

/* Light on its way to one pixel: what is left of it, the colour that the pixel shows; of the splats that take light out now the
 * densities A and B, or, where it is one alone, tau and its colour. */
typedef struct oracle_light {
    double left, shown[3], a, b[3], place, tau, colour[3];
    int open; /* how many: 0, 1, more: 2 */
} oracle_light;

double oracle_opacity(double logit);
void oracle_factor(const oracle_splat *splat, double factor[9]);
void oracle_look(const oracle_scene *scene, double time, oracle_view *view);
void oracle_project(const oracle_scene *scene, const oracle_view *view, int id, oracle_shown *out);
/* Luminance's share of a channel. */
double oracle_share_of(int channel);
/* By how much light grows with colours at most where a pixel shows Y + log_eps = `shown`. */
double oracle_growth(const oracle_scene *scene, double shown);
/* What it takes of the light at a pixel's centre. */
double oracle_tau(const oracle_shown *splat, double x, double y);

/* Splats in the order of their depths, nearest first; L of what has come. */
void oracle_light_start(oracle_light *light);
void oracle_light_add(oracle_light *light, double place, double tau, const double colour[3]);
double oracle_light_end(const oracle_scene *scene, oracle_light *light);

/* All splats at a time, the nearest first: shown (splats). How many are visible. */
int oracle_show(const oracle_scene *scene, double time, oracle_shown *shown);
/* L of all pixels of those: image (width x height), lights (width x height) scratch. */
void oracle_image(const oracle_scene *scene, const oracle_shown *shown, int count, oracle_light *lights, double *image);
/* L of pixel (x, y) at a time, of the splats whose numbers are listed. */
double oracle_point(const oracle_scene *scene, const int *ids, int count, int x, int y, double time);

#endif
