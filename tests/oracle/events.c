/* The event finder of the oracle: samples, refines where a level may be reached, and solves crossings. */
#include "tests/oracle/events.h"

#include "tests/oracle/doubt.h"
#include "tests/oracle/image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Allowance for a curve between two samples of the grid, beyond its bend and its doubts [thresholds]. */
#define FLOOR 0.01
/* Intervals no longer than this [s] aren't divided further; roots are found to a fifth of it. */
#define LEAST_S 1e-10
/* Between two knots of a path the grid has at least PER_KNOT samples, unless they would be closer than CLOSEST_S [s]. From one
 * sample to the next no visible splat travels further than TRAVEL standard deviations, unless samples would be closer than
 * FAST_S [s]: a splat that leaps passes a pixel within a microsecond. 40 scenes of leaps have the same events with four times
 * as many samples. */
enum { PER_KNOT = 8 };
#define CLOSEST_S 1e-6
#define TRAVEL 0.5
#define FAST_S 1e-7

/* Centre and half-widths of a splat at a sample [px]. */
typedef struct box {
    float x, y, rx, ry;
} box;

typedef struct finder {
    const oracle_scene *scene;
    oracle_events *found;
    double *time;          /* (count) */
    double *image;         /* (count x pixels) L */
    double *growth;        /* (pixels) oracle_growth at the start of the interval */
    box *boxes;            /* (count x splats); rx below 0 where it isn't visible */
    oracle_doubts *doubts; /* (count - 1) */
    float *hidden;         /* ((count - 1) x pixels) change of L that doubts may hide */
    int count, pixels;
    /* The pixel and interval in hand. */
    int pixel, interval, listed;
    int *list; /* (splats) those that may show there; filled if `listed` >= 0 */
    struct own_doubt {
        const oracle_doubt *doubt;
        double size;
    } * own; /* doubts that can change this pixel */
    int owns, own_room;
    double reference;
} finder;

typedef struct spot {
    double t, s;
} spot;

/* -- the grid ------------------------------------------------------------------------------------------------------------ */

static int rising(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Adds the knots of a curve, and samples between them where the grid's `spacing` [s] gives too few. Without `time` it only
 * counts them. */
static int add_knots(const oracle_curve *c, double stop, double spacing, int finer, double *time) {
    int n = 0;
    for (int i = 0; i + 1 < c->count; i++) {
        const double h = c->time[i + 1] - c->time[i];
        const int parts = h >= PER_KNOT * spacing ? 1 : (int)fmin(PER_KNOT * finer, fmax(1, h * finer / CLOSEST_S));
        for (int k = 0; k < parts; k++) {
            const double t = c->time[i] + h * k / parts;
            if (t <= 0 || t >= stop) continue;
            if (time) time[n] = t;
            n++;
        }
    }
    return n;
}

static int all_knots(const oracle_scene *s, int finer, double *time) {
    int n = add_knots(&s->camera, s->stop, s->spacing, finer, time);
    for (int k = 0; k < s->objects; k++) {
        n += add_knots(&s->object[k].path, s->stop, s->spacing, finer, time ? time + n : NULL);
        n += add_knots(&s->object[k].keys, s->stop, s->spacing, finer, time ? time + n : NULL);
    }
    return n;
}

/* How far the fastest visible splat travels between two times, in its standard deviations along either axis. */
static double travel_between(const oracle_scene *s, double from, double to) {
    oracle_view a, b;
    double most = 0;
    oracle_look(s, from, &a);
    oracle_look(s, to, &b);
    for (int id = 0; id < s->splats; id++) {
        oracle_shown i, j;
        oracle_project(s, &a, id, &i);
        oracle_project(s, &b, id, &j);
        if (!i.visible || !j.visible) continue;
        const double x = fabs(j.u - i.u), y = fabs(j.v - i.v), rx = fmax(i.reach_x, j.reach_x), ry = fmax(i.reach_y, j.reach_y);
        if (fmin(i.u, j.u) - rx > s->width || fmax(i.u, j.u) + rx < 0 || fmin(i.v, j.v) - ry > s->height ||
            fmax(i.v, j.v) + ry < 0)
            continue;
        most = fmax(most, fmax(x / sqrt(fmin(i.across, j.across)), y / sqrt(fmin(i.down, j.down))));
    }
    return most;
}

/* Adds samples where splats travel far from one to the next. */
static void add_fast(finder *f, int finer) {
    const int count = f->count;
    int *parts = oracle_alloc((size_t)count, sizeof *parts), all = 1;
    double *time = f->time;
    for (int k = 0; k + 1 < count; k++) {
        const double travel = travel_between(f->scene, time[k], time[k + 1]), most = (time[k + 1] - time[k]) / FAST_S;
        parts[k] = travel > TRAVEL ? finer * (int)fmax(1, fmin(ceil(travel / TRAVEL), most)) : 1;
        all += parts[k];
    }
    f->time = oracle_alloc((size_t)all, sizeof *f->time);
    f->count = 0;
    for (int k = 0; k + 1 < count; k++)
        for (int i = 0; i < parts[k]; i++) f->time[f->count++] = time[k] + (time[k + 1] - time[k]) * i / parts[k];
    f->time[f->count++] = time[count - 1];
    free(parts);
    free(time);
}

static void make_grid(finder *f, int finer) {
    const oracle_scene *s = f->scene;
    const int even = (int)ceil(s->stop / s->spacing) * finer, knots = all_knots(s, finer, NULL);
    f->time = oracle_alloc((size_t)(even + knots + 1), sizeof *f->time);
    for (int k = 0; k <= even; k++) f->time[k] = s->stop * k / even;
    all_knots(s, finer, f->time + even + 1);
    qsort(f->time, (size_t)(even + knots + 1), sizeof *f->time, rising);
    f->count = 1;
    for (int k = 1; k <= even + knots; k++) {
        const double after = f->time[k] - f->time[f->count - 1];
        if (after > 0.25 * CLOSEST_S / finer || (after > 0 && f->time[k] == s->stop)) f->time[f->count++] = f->time[k];
    }
    add_fast(f, finer);
}

/* -- what all pixels share ------------------------------------------------------------------------------------------------- */

/* Sorts the shown splats into tables by number: `all` and `boxes`; `order` keeps their numbers, nearest first. */
static void by_number(const oracle_scene *s, const oracle_shown *shown, int count, oracle_shown *all, int *order, box *boxes) {
    for (int id = 0; id < s->splats; id++) {
        all[id].visible = 0;
        boxes[id] = (box){0, 0, -1, -1};
    }
    for (int k = 0; k < count; k++) {
        const oracle_shown *one = &shown[k];
        all[one->id] = *one;
        order[k] = one->id;
        boxes[one->id] = (box){(float)one->u, (float)one->v, (float)one->reach_x, (float)one->reach_y};
    }
}

static int first_pixel(double middle, double reach, int size) { return (int)fmin(fmax(floor(middle - reach - 1), 0), size); }
static int last_pixel(double middle, double reach, int size) { return (int)fmax(fmin(ceil(middle + reach), size - 1), -1); }

/* Adds to each pixel the change of L that the doubts of interval k may hide. */
static void hide(const finder *f, int k, const oracle_shown *all) {
    const oracle_scene *s = f->scene;
    const double *image = f->image + (size_t)k * (size_t)f->pixels;
    float *hidden = f->hidden + (size_t)k * (size_t)f->pixels;
    for (int i = 0; i < f->pixels; i++) f->growth[i] = oracle_growth(s, exp(image[i]));
    for (int n = 0; n < f->doubts[k].count; n++) {
        const oracle_doubt *d = &f->doubts[k].doubt[n];
        const oracle_shown *i = &all[d->i], *j = &all[d->j < 0 ? d->i : d->j];
        const double share = oracle_doubt_share(d, f->time[k], f->time[k + 1], f->time[k + 1] - f->time[k]);
        const int x1 = (int)fmin(last_pixel(i->u, i->reach_x, s->width), last_pixel(j->u, j->reach_x, s->width));
        const int y1 = (int)fmin(last_pixel(i->v, i->reach_y, s->height), last_pixel(j->v, j->reach_y, s->height));
        const int x0 = (int)fmax(first_pixel(i->u, i->reach_x, s->width), first_pixel(j->u, j->reach_x, s->width));
        for (int y = (int)fmax(first_pixel(i->v, i->reach_y, s->height), first_pixel(j->v, j->reach_y, s->height)); y <= y1;
             y++)
            for (int x = x0; x <= x1; x++) {
                const int at = y * s->width + x;
                /* The factor 2 allows for splats that move within the interval. */
                hidden[at] += (float)(2 * share * oracle_doubt_size(d, i, j, x + 0.5, y + 0.5, exp(image[at]), f->growth[at]));
            }
    }
}

static void sample_all(finder *f) {
    const oracle_scene *s = f->scene;
    const size_t splats = (size_t)s->splats, pixels = (size_t)f->pixels;
    oracle_shown *shown = oracle_alloc(splats, sizeof *shown), *all[2];
    oracle_light *lights = oracle_alloc(pixels, sizeof *lights);
    int *order[2], counts[2] = {0, 0};
    for (int i = 0; i < 2; i++) {
        all[i] = oracle_alloc(splats, sizeof *all[i]);
        order[i] = oracle_alloc(splats, sizeof *order[i]);
    }
    for (int k = 0; k < f->count; k++) {
        const int now = k % 2, last = 1 - now;
        counts[now] = oracle_show(s, f->time[k], shown);
        by_number(s, shown, counts[now], all[now], order[now], f->boxes + (size_t)k * splats);
        oracle_image(s, shown, counts[now], lights, f->image + (size_t)k * pixels);
        if (k == 0) continue;
        oracle_find_doubts(all[last], all[now], f->time[k - 1], f->time[k], order[last], counts[last], &f->doubts[k - 1]);
        hide(f, k - 1, all[last]);
    }
    f->found->samples = (size_t)f->count * pixels;
    for (int i = 0; i < 2; i++) {
        free(all[i]);
        free(order[i]);
    }
    free(shown);
    free(lights);
}

/* -- one pixel ------------------------------------------------------------------------------------------------------------- */

static double leak_at(const oracle_scene *s, double t) { return s->leak_hz * s->threshold_on * t; }

static int near_box(const box *a, const box *b, double x, double y) {
    if (a->rx < 0 && b->rx < 0) return 0;
    if (a->rx < 0) a = b;
    if (b->rx < 0) b = a;
    const double rx = fmax(a->rx, b->rx) + fabs(a->rx - b->rx) + fabs(a->x - b->x) + 0.5;
    const double ry = fmax(a->ry, b->ry) + fabs(a->ry - b->ry) + fabs(a->y - b->y) + 0.5;
    return fabs(x - a->x) <= rx && fabs(y - a->y) <= ry;
}

/* Lists the splats that may show in the pixel during the interval. */
static void make_list(finder *f) {
    const oracle_scene *s = f->scene;
    const box *a = f->boxes + (size_t)f->interval * (size_t)s->splats, *b = a + s->splats;
    const double x = f->pixel % s->width + 0.5, y = f->pixel / s->width + 0.5;
    f->listed = 0;
    for (int id = 0; id < s->splats; id++)
        if (near_box(&a[id], &b[id], x, y)) f->list[f->listed++] = id;
}

static double look(finder *f, double t) {
    const oracle_scene *s = f->scene;
    if (f->listed < 0) make_list(f);
    f->found->looks++;
    return oracle_point(s, f->list, f->listed, f->pixel % s->width, f->pixel / s->width, t) + leak_at(s, t);
}

/* Collects the interval's doubts that can change the pixel. */
static void own_doubts(finder *f) {
    const oracle_scene *s = f->scene;
    const size_t at = (size_t)f->interval * (size_t)f->pixels + (size_t)f->pixel;
    const oracle_doubts *all = &f->doubts[f->interval];
    oracle_view view;
    f->owns = 0;
    const double growth = oracle_growth(s, exp(f->image[at]));
    if (!(f->hidden[at] > 0)) return;
    if (all->count > f->own_room) {
        free(f->own);
        f->own_room = 2 * all->count;
        f->own = oracle_alloc((size_t)f->own_room, sizeof *f->own);
    }
    oracle_look(s, f->time[f->interval], &view);
    for (int n = 0; n < all->count; n++) {
        oracle_shown i, j;
        oracle_project(s, &view, all->doubt[n].i, &i);
        const double x = f->pixel % s->width + 0.5, y = f->pixel / s->width + 0.5;
        if (!i.visible || !(oracle_tau(&i, x, y) > 0)) continue;
        if (all->doubt[n].j >= 0) oracle_project(s, &view, all->doubt[n].j, &j);
        const double size = 2 * oracle_doubt_size(&all->doubt[n], &i, &j, x, y, exp(f->image[at]), growth);
        if (!(size > 1e-7 * s->threshold_on)) continue;
        f->own[f->owns++] = (struct own_doubt){&all->doubt[n], size};
    }
}

static double doubt_of(const finder *f, double a, double b) {
    const double whole = f->time[f->interval + 1] - f->time[f->interval];
    const double part = (b - a) / whole; /* squared, since a bend falls with the square of the interval */
    double sum = FLOOR * fmin(f->scene->threshold_on, f->scene->threshold_off) * part * part + 1e-13;
    for (int k = 0; k < f->owns; k++) sum += f->own[k].size * oracle_doubt_share(f->own[k].doubt, a, b, whole);
    return sum;
}

static void emit(finder *f, double t, int polarity) {
    const oracle_scene *s = f->scene;
    oracle_events *e = f->found;
    if (e->count == e->capacity) {
        e->capacity = 2 * e->capacity + 4096;
        oracle_event *grown = realloc(e->event, e->capacity * sizeof *grown);
        if (!grown) abort();
        e->event = grown;
    }
    e->event[e->count++] = (oracle_event){t, f->pixel, polarity};
    f->reference += polarity > 0 ? s->threshold_on : -s->threshold_off;
}

/* The time at which S passes `level` between a and b, which lie on either side of it. Regula falsi by the Illinois rule;
 * each eighth step bisects. It ends when the same secant leaves less than a fifth of LEAST_S. */
static double root(finder *f, spot a, spot b, double level) {
    double fa = a.s - level, fb = b.s - level, t = a.t;
    for (int k = 0; b.t - a.t > 0.2 * LEAST_S && k < 200; k++) {
        const double slope = (fb - fa) / (b.t - a.t);
        t = k % 8 == 7 ? 0.5 * (a.t + b.t) : a.t - fa / slope;
        if (!(t > a.t && t < b.t)) t = 0.5 * (a.t + b.t);
        const double s = look(f, t) - level;
        if (fabs(s) < 0.2 * LEAST_S * fabs(slope)) return t - s / slope;
        if ((s > 0) == (fb > 0)) {
            b.t = t, fb = s;
            if (k % 8 != 7) fa *= 0.5;
        } else {
            a.t = t, fa = s;
            if (k % 8 != 7) fb *= 0.5;
        }
    }
    return t;
}

/* Emits all events that are left at b, where [a, b] is too short to be divided further. */
static void finish_short(finder *f, spot b) {
    for (;;) {
        if (b.s >= f->reference + f->scene->threshold_on)
            emit(f, b.t, 1);
        else if (b.s <= f->reference - f->scene->threshold_off)
            emit(f, b.t, -1);
        else
            return;
    }
}

/* If S surely passes one level between a and b, and surely not the other, emits the event, moves `a` there and returns 1. e:
 * the distance by which S may leave the range of its values at a and b. */
static int pass_level(finder *f, spot *a, spot b, double e) {
    const double up = f->reference + f->scene->threshold_on, down = f->reference - f->scene->threshold_off;
    const int rises = b.s > a->s;
    const double low = rises ? a->s : b.s, high = rises ? b.s : a->s, level = rises ? up : down;
    if (!(high - low > 4 * e) || !(level > low + e && level < high - e)) return 0;
    if (rises ? !(down < low - e) : !(up > high + e)) return 0;
    const double t = root(f, *a, b, level);
    emit(f, t, rises ? 1 : -1);
    *a = (spot){t, level};
    return 1;
}

static void walk(finder *f, spot a, spot b, double bend) {
    for (;;) {
        const double e = bend + doubt_of(f, a.t, b.t);
        const double up = f->reference + f->scene->threshold_on, down = f->reference - f->scene->threshold_off;
        if (up > fmax(a.s, b.s) + e && down < fmin(a.s, b.s) - e) return;
        if (b.t - a.t <= LEAST_S) {
            finish_short(f, b);
            return;
        }
        if (pass_level(f, &a, b, e)) continue;
        spot middle = {0.5 * (a.t + b.t), 0};
        middle.s = look(f, middle.t);
        /* What a kink in either half leaves there, wherever it is: at most this. Of a smooth bend it is eight times what is
         * left. */
        bend = fabs(a.s - 2 * middle.s + b.s);
        walk(f, a, middle, bend);
        a = middle;
    }
}

/* Bound on L's distance from its chord in interval k, by second differences at both ends: four times a smooth curve's. */
static double bend_of(const finder *f, int k) {
    double most = 0;
    for (int i = k; i <= k + 1; i++) {
        if (i < 1 || i + 1 >= f->count) continue;
        const double *L = f->image + (size_t)i * (size_t)f->pixels + (size_t)f->pixel;
        const double before = f->time[i] - f->time[i - 1], after = f->time[i + 1] - f->time[i];
        const double h = f->time[k + 1] - f->time[k];
        const double bend = ((L[f->pixels] - L[0]) / after - (L[0] - L[-(ptrdiff_t)f->pixels]) / before) / (before + after);
        most = fmax(most, fabs(bend) * h * h);
    }
    return most;
}

static void find_in_pixel(finder *f, int pixel) {
    const oracle_scene *s = f->scene;
    const double floor_of = FLOOR * fmin(s->threshold_on, s->threshold_off) + 1e-13;
    f->pixel = pixel;
    f->reference = f->image[pixel];
    for (int k = 0; k + 1 < f->count; k++) {
        const size_t at = (size_t)k * (size_t)f->pixels + (size_t)pixel;
        const spot a = {f->time[k], f->image[at] + leak_at(s, f->time[k])};
        const spot b = {f->time[k + 1], f->image[at + (size_t)f->pixels] + leak_at(s, f->time[k + 1])};
        const double bend = bend_of(f, k), e = bend + floor_of + f->hidden[at];
        if (f->reference + s->threshold_on > fmax(a.s, b.s) + e && f->reference - s->threshold_off < fmin(a.s, b.s) - e)
            continue;
        f->interval = k;
        f->listed = -1;
        own_doubts(f);
        walk(f, a, b, bend);
    }
}

oracle_events oracle_find_events(const oracle_scene *scene, int finer) {
    oracle_events found = {NULL, 0, 0, NULL, 0, 0};
    finder *f = oracle_alloc(1, sizeof *f);
    f->scene = scene;
    f->found = &found;
    f->pixels = scene->width * scene->height;
    make_grid(f, finer);
    const size_t times = (size_t)f->count, pixels = (size_t)f->pixels;
    f->image = oracle_alloc(times * pixels, sizeof *f->image);
    f->hidden = oracle_alloc(times * pixels, sizeof *f->hidden);
    f->boxes = oracle_alloc(times * (size_t)scene->splats, sizeof *f->boxes);
    f->growth = oracle_alloc(pixels, sizeof *f->growth);
    f->doubts = oracle_alloc(times, sizeof *f->doubts);
    f->list = oracle_alloc((size_t)scene->splats, sizeof *f->list);
    found.first = oracle_alloc(pixels + 1, sizeof *found.first);
    sample_all(f);
    for (int pixel = 0; pixel < f->pixels; pixel++) {
        found.first[pixel] = found.count;
        find_in_pixel(f, pixel);
    }
    found.first[pixels] = found.count;
    for (size_t k = 0; k < times; k++) free(f->doubts[k].doubt);
    free(f->time);
    free(f->image);
    free(f->growth);
    free(f->hidden);
    free(f->boxes);
    free(f->doubts);
    free(f->list);
    free(f->own);
    free(f);
    return found;
}

void oracle_events_free(oracle_events *events) {
    free(events->event);
    free(events->first);
}
