/* The oracle's image: rules `smooth` in double precision (docs/DESIGN.md 3.1, docs/soft_order.md), values alone. */
#ifndef TESTS_ORACLE_IMAGE_H
#define TESTS_ORACLE_IMAGE_H

#include "tests/oracle/scene.h"

/* An object as the camera sees it: p_camera = rotation p + shift; `eye`: the camera in the object's axes; `place`: the
 * view's time in its keyframes. */
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
    int id, visible;          /* visible 0: before the near plane or below the taper; the rest is then undefined */
    double u, v;              /* its centre [px] */
    double xx, xy, yy;        /* the inverse covariance [1/px^2] */
    double opacity;           /* at the centre */
    double across, down;      /* variances [px^2] */
    double reach_x, reach_y;  /* half-widths of the box around it [px] */
    double place;             /* depth [soft depths]: ln z / soft_depth */
    double colour[3], raw[3]; /* by channel, clamped at 0; raw: before the clamp */
} oracle_shown;

/* Light on its way to one pixel: `left` of 1, and `shown`, the colour so far. Of the splats that take light at `place`: sums
 * a of densities and b of density times colour; of a single one, tau and its colour. */
typedef struct oracle_light {
    double left, shown[3], a, b[3], place, tau, colour[3];
    int open; /* number of splats that take light now: 0, 1, or 2 for more */
} oracle_light;

double oracle_opacity(double logit);
void oracle_factor(const oracle_splat *splat, double factor[9]);
void oracle_look(const oracle_scene *scene, double time, oracle_view *view);
void oracle_project(const oracle_scene *scene, const oracle_view *view, int id, oracle_shown *out);
/* Luminance's share of a channel. */
double oracle_share_of(int channel);
/* Largest change of light per change of colour in a pixel whose Y + log_eps is `shown`; 1 if colours aren't coded. */
double oracle_growth(const oracle_scene *scene, double shown);
/* The share of light that a splat takes at (x, y) [px]. */
double oracle_tau(const oracle_shown *splat, double x, double y);

/* Composites one pixel: start, add each splat in order of depth (nearest first), end. The end returns L. */
void oracle_light_start(oracle_light *light);
void oracle_light_add(oracle_light *light, double place, double tau, const double colour[3]);
double oracle_light_end(const oracle_scene *scene, oracle_light *light);

/* Fills `shown` (room for all splats) with the visible splats at a time, nearest first; returns their number. */
int oracle_show(const oracle_scene *scene, double time, oracle_shown *shown);
/* L of all pixels from these splats: image (width x height); lights (width x height) is scratch. */
void oracle_image(const oracle_scene *scene, const oracle_shown *shown, int count, oracle_light *lights, double *image);
/* L of pixel (x, y) at a time, from the splats with the numbers `ids`. */
double oracle_point(const oracle_scene *scene, const int *ids, int count, int x, int y, double time);

#endif
