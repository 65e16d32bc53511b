/* The table of docs/guide/sensors.md: what each preset of a camera makes of a rising edge of 100 % contrast, and of a grey
 * wall, measured on its comparator. The page says what is measured here, digit for digit. */
#include "sensor_rig.h"

#include "tides/run.h"

#include <stdio.h>

static const char PAGE[] = "docs/guide/sensors.md";
static const double dark_Y = 0.4, bright_Y = 0.8, wall_Y = 0.5, edge_s = 1e-6, begin_s = 0.1, end_s = 0.2;
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

/* At rest, 100 s: events of a pixel and second, and the ON ones' share. */
static void measure_wall(const tides_sensor *sensor, double eps, double row[2]) {
    const scene s = {log(wall_Y + eps), log(wall_Y + eps)};
    rig *r = rig_make(sensor, TILES, 0, edge, &s);
    rig_run(r, 100, 1000);
    const double on = (double)r->work.counts.events_on, all = on + (double)r->work.counts.events_off;
    row[0] = all / (double)r->pixels / 100;
    row[1] = all > 0 ? on / all : 0;
    rig_free(r);
}

static void make_row(const char *name, char line[200]) {
    char set[64];
    const char *const sets[] = {set, "seed=43"};
    tides_run *run = NULL;
    tides_run_values v;
    tides_error error = {TIDES_OK, ""};
    double row[5];
    snprintf(set, sizeof set, "sensor.preset=%s", name);
    if (tides_run_parse("{\"frames\": {\"file\": \"-\"}}", "", sets, 2, &run, &error) != TIDES_OK) fail_msg("%s", error.text);
    tides_run_get(run, &v);
    measure_edge(&v.sensor, v.image.log_eps, row);
    measure_wall(&v.sensor, v.image.log_eps, row + 3);
    snprintf(line, 200, "| `%s` | %.2f | %.3g | %.3g | %.2g | %.0f %% |", name, row[0], row[1], row[2], row[3], 100 * row[4]);
    tides_run_destroy(run);
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
    }
    if (wrong) fail_msg("%d rows above aren't in %s", wrong, PAGE);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_page)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
