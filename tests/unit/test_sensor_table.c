/* The tables of docs/guide/sensors.md: each camera preset's response to a rising edge of 100 % contrast, to a lamp of 100 Hz,
 * and to a grey wall in four lights, measured on its comparator. The page has these values, digit for digit. */
#include "sensor_rig.h"
#include "signal/td_event_sort.h"

#include "tides/run.h"

#include <stdio.h>

static const char PAGE[] = "docs/guide/sensors.md";
static const double dark_Y = 0.4, bright_Y = 0.8, wall_Y = 0.5, edge_s = 1e-6, begin_s = 0.1, end_s = 0.2, lamp_hz = 100;
enum { TILES = 8 };

typedef struct scene {
    double before, after;
} scene;

/* At the ends of steps: the edge is one step's cubic between them, level at both ends. */
static void edge(const void *user, int i, double t, double *S, double *S_dot) {
    const scene *s = user;
    (void)i;
    *S = t < begin_s + 0.5 * edge_s ? s->before : s->after;
    *S_dot = 0;
}

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Events of an edge: how many a pixel fires, and when the first [us]: median, and half of what is between 16 and 84 %. */
static void measure_edge(const tides_sensor *sensor, double eps, double row[3]) {
    const scene s = {log(dark_Y + eps), log(bright_Y + eps)};
    rig *r = rig_make(sensor, TILES, 0, edge, &s);
    rig_run(r, begin_s, 10);
    td_work_clear(&r->work);
    rig_step(r, begin_s + edge_s);
    rig_run(r, end_s, 100);
    double *first = rig_alloc(r->pixels, sizeof *first);
    size_t fired = 0;
    for (size_t i = 0; i < r->pixels; i++) first[i] = INFINITY;
    for (size_t k = 0; k < r->work.events.count; k++) {
        const tides_event *e = &r->work.events.events[k];
        double *at = &first[e->y * TILES * RIG_WIDTH + e->x];
        const double t = 1e-3 * (double)e->t - 1e6 * begin_s;
        if (e->polarity > 0 && t < *at) *at = t;
    }
    for (size_t i = 0; i < r->pixels; i++) fired += first[i] < INFINITY;
    qsort(first, r->pixels, sizeof *first, compare);
    row[0] = (double)r->work.counts.events_on / (double)r->pixels;
    row[1] = first[fired / 2];
    row[2] = 0.5 * (first[fired * 84 / 100] - first[fired * 16 / 100]);
    free(first);
    rig_free(r);
}

/* A lamp that goes from a third of the middle to as much above it, as often as the mains' halves. */
static void lamp(const void *user, int i, double t, double *S, double *S_dot) {
    const double pi = 3.14159265358979, swing = 1.0 / 3, phase = 2 * pi * lamp_hz * t, Y = wall_Y * (1 + swing * sin(phase));
    (void)i;
    *S = log(Y + *(const double *)user);
    *S_dot = wall_Y * swing * 2 * pi * lamp_hz * cos(phase) / (Y + *(const double *)user);
}

/* Events of a pixel per period, of the 20 after the first 20. */
static double measure_lamp(const tides_sensor *sensor, double eps) {
    rig *r = rig_make(sensor, 1, 0, lamp, &eps);
    rig_run(r, 0.2, 640);
    td_work_clear(&r->work);
    rig_run(r, 0.4, 640);
    const double events = (double)(r->work.counts.events_on + r->work.counts.events_off);
    const double pixels = (double)r->pixels;
    rig_free(r);
    return events / pixels / 20;
}

static int is_noisy(const tides_sensor *sensor) { return sensor->noise_law == TIDES_NOISE_PHOTOCURRENT; }

/* At rest: events of a pixel and second, the ON ones' share, and the share of a pixel's successive ones that alternate. */
static void measure_wall(const tides_sensor *sensor, double eps, double row[3]) {
    const scene s = {log(wall_Y + eps), log(wall_Y + eps)};
    const int kicked = sensor->kick != 0, noisy = is_noisy(sensor);
    const double seconds = noisy ? 4 : 100;
    rig *r = rig_make(sensor, kicked ? 1 : TILES, 0, edge, &s);
    rig_run(r, seconds, kicked ? 4000 : 200); /* kicks want short ones */
    const double on = (double)r->work.counts.events_on, all = on + (double)r->work.counts.events_off;
    double pairs = 0, alternate = 0;
    int *last = rig_alloc(r->pixels, sizeof *last);
    tides_event *scratch = rig_alloc(r->work.events.count, sizeof *scratch);
    td_event_sort(r->work.events.events, scratch, r->work.events.count);
    for (size_t k = 0; k < r->work.events.count; k++) {
        const tides_event *e = &r->work.events.events[k];
        int *before = &last[(size_t)(e->x / RIG_WIDTH) * RIG_PIXELS + (size_t)(e->y * RIG_WIDTH + e->x % RIG_WIDTH)];
        pairs += *before != 0;
        alternate += *before == -e->polarity;
        *before = e->polarity;
    }
    free(scratch);
    free(last);
    row[0] = all / (double)r->pixels / seconds;
    row[1] = all > 0 ? on / all : 0;
    row[2] = pairs > 0 ? alternate / pairs : 0;
    rig_free(r);
}

/* Of a preset, in this light (where Y = 0.5) or its own. */
static tides_run *take(const char *name, double lux, tides_run_values *v) {
    char set[64], light[64];
    const char *const sets[] = {set, "seed=43", light};
    tides_run *run = NULL;
    tides_error error = {TIDES_OK, ""};
    snprintf(set, sizeof set, "sensor.preset=%s", name);
    snprintf(light, sizeof light, "camera.lux=%g", lux / wall_Y);
    if (tides_run_parse("{\"frames\": {\"file\": \"-\"}}", "", sets, lux > 0 ? 3 : 2, &run, &error) != TIDES_OK)
        fail_msg("%s", error.text);
    tides_run_get(run, v);
    return run;
}

static void make_row(const char *name, char line[200]) {
    tides_run_values v;
    tides_run *run = take(name, 0, &v);
    double row[3];
    measure_edge(&v.sensor, v.image.log_eps, row);
    snprintf(line, 200, "| `%s` | %.2f | %.3g | %.3g | %.2f |", name, row[0], row[1], row[2],
             measure_lamp(&v.sensor, v.image.log_eps));
    tides_run_destroy(run);
}

/* Noise that doesn't go with light is measured once. */
static void make_wall(const char *name, char line[200]) {
    static const double lux[] = {1, 10, 100, 1000};
    double row[4][3];
    int at = snprintf(line, 200, "| `%s` |", name);
    for (size_t k = 0; k < 4; k++) {
        tides_run_values v;
        tides_run *run = take(name, lux[k], &v);
        const int goes = is_noisy(&v.sensor);
        if (k > 0 && !goes)
            memcpy(row[k], row[0], sizeof *row);
        else
            measure_wall(&v.sensor, v.image.log_eps, row[k]);
        at += snprintf(line + at, 200 - (size_t)at, " %.2g, %.0f %%, %.0f %% |", row[k][0], 100 * row[k][1], 100 * row[k][2]);
        tides_run_destroy(run);
    }
}

static void test_page(void **state) {
    (void)state;
    static char page[1 << 16];
    FILE *file = fopen(PAGE, "r");
    assert_non_null(file);
    page[fread(page, 1, sizeof page - 1, file)] = '\0';
    fclose(file);
    char name[TIDES_PRESET_NAME], line[200];
    int wrong = 0;
    for (size_t i = 0; tides_preset_at(i, name); i++) {
        if (strcmp(name, "ideal") == 0 || strncmp(name, "v2e-", 4) == 0) continue;
        make_row(name, line);
        printf("%s\n", line);
        wrong += !strstr(page, line);
        make_wall(name, line);
        printf("%s\n", line);
        wrong += !strstr(page, line);
    }
    if (wrong) fail_msg("%d rows above aren't in %s", wrong, PAGE);
}

/* The IMX636's noise at factory biases, as arXiv 2605.16317 fits it, of both polarities: the peak near 2 lux, rates within a
 * quarter, and polarities that alternate in dim light. */
static void test_published(void **state) {
    static const double lux[] = {0.15, 0.5, 1, 2, 5, 10, 20, 50, 100},
                        hz[] = {0.76, 1.42, 1.92, 2.23, 1.77, 0.90, 0.275, 0.054, 0.0416};
    enum { LIGHTS = sizeof lux / sizeof *lux };
    double row[LIGHTS][3];
    size_t most = 0;
    (void)state;
    for (size_t k = 0; k < LIGHTS; k++) {
        tides_run_values v;
        tides_run *run = take("imx636-lowlight", lux[k], &v);
        measure_wall(&v.sensor, v.image.log_eps, row[k]);
        tides_run_destroy(run);
        if (row[k][0] > row[most][0]) most = k;
        printf("%4g lux: %.3g Hz, published %.3g; ON %.2f, alternate %.2f\n", lux[k], row[k][0], hz[k], row[k][1], row[k][2]);
        assert_true(fabs(row[k][0] / hz[k] - 1) < 0.25);
        assert_true(lux[k] > 10 || row[k][2] > 0.9);
    }
    assert_true(lux[most] >= 1 && lux[most] <= 5);
}

/* The rates of that preset's pixels in dim light spread between the 0.24 decades of IEBCS' noise files and the half a decade of
 * jAER's NoiseTesterFilter. */
static void test_spread(void **state) {
    tides_run_values v;
    tides_run *run = take("imx636-lowlight", 0.15, &v);
    const scene s = {log(wall_Y + v.image.log_eps), log(wall_Y + v.image.log_eps)};
    rig *r = rig_make(&v.sensor, 1, 0, edge, &s);
    double count[RIG_PIXELS] = {0}, sum = 0, squares = 0;
    (void)state;
    rig_run(r, 150, 150);
    for (size_t k = 0; k < r->work.events.count; k++)
        count[r->work.events.events[k].y * RIG_WIDTH + r->work.events.events[k].x]++;
    for (int i = 0; i < RIG_PIXELS; i++) {
        const double decades = log10(count[i] + 0.5);
        sum += decades;
        squares += decades * decades;
    }
    const double mean = sum / RIG_PIXELS, spread = sqrt(squares / RIG_PIXELS - mean * mean);
    printf("%.3g events a pixel, spread by %.3f decades\n", (double)r->work.events.count / RIG_PIXELS, spread);
    assert_true(spread > 0.24 && spread < 0.5);
    rig_free(r);
    tides_run_destroy(run);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_page), cmocka_unit_test(test_published),
                                       cmocka_unit_test(test_spread)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
