/* Timing errors that a run with filters or noise reports: no smaller than the true ones, and not much larger. The truth
 * is the same run at a fine tolerance. Sensors are those of presets, and others with filters or noise.
 *
 * TIDES_TRIALS=N: N scenes for each sensor (30 are the issue's); otherwise FEW of 30 for each. TIDES_SEED=N: the first one's
 * seed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sensor/td_single.h"
#include "tests/property/simulator_run.h"
#include "tests/support/number_of.h"
#include "tides/run.h"

/* Scenes of a run of the test, how many each sensor gets, and events that are worth a percentile. */
enum { SCENES = 30, FEW = 3, ENOUGH = 200 };
#define FIRST_SEED 7400

/* Sensors beside the presets. */
typedef struct kind {
    char name[TIDES_PRESET_NAME];
    const char *sets[6];
} kind;

#define GEN4 "sensor.preset=gen4"
static const kind others[] = {
    {"low light", {GEN4, "frontend.photoreceptor_cutoff_hz=16"}},
    {"by light",
     {GEN4, "frontend.photoreceptor_cutoff_hz=300", "frontend.photoreceptor_law=intensity", "sensor.refractory_s=1e-4"}},
    {"noise", {"frontend.noise_rms=0.02", "frontend.noise_cutoff_hz=300"}},
    {"gen4, rms", {GEN4, "frontend.noise_rms=0.0238", "frontend.noise_cutoff_hz=77", "frontend.noise_sigma=0.04"}},
    {"low light, rms",
     {GEN4, "frontend.photoreceptor_cutoff_hz=16", "frontend.noise_rms=0.06", "frontend.noise_cutoff_hz=16",
      "frontend.noise_sigma=0.04"}},
    {"bright, rms",
     {GEN4, "frontend.photoreceptor_cutoff_hz=300", "frontend.noise_rms=0.03", "frontend.noise_cutoff_hz=300",
      "frontend.noise_sigma=0.04"}},
    {"v2e, rms", {"sensor.preset=v2e-noisy", "frontend.noise_rms=0.01", "frontend.noise_cutoff_hz=100"}},
};
enum { OTHERS = sizeof others / sizeof *others, KINDS_MAX = 32 };

static tides_sensor sensor_of(const kind *k) {
    static const char text[] = "{\"scene\": {\"file\": \"a.ply\"}, \"camera\": {\"file\": \"p.json\"}}";
    tides_run *run = NULL;
    tides_run_values values;
    tides_error error;
    size_t count = 0;
    while (k->sets[count]) count++;
    scene_expect_ok(tides_run_parse(text, "", k->sets, count, &run, &error), &error);
    tides_run_get(run, &values);
    tides_run_destroy(run);
    return values.sensor;
}

/* The presets whose events aren't looked up, and the others. */
static size_t find_kinds(kind kinds[KINDS_MAX], char sets[KINDS_MAX][64]) {
    size_t count = 0;
    kind k = {.name = ""};
    for (size_t i = 0; tides_preset_at(i, k.name); i++) {
        int shows = 0;
        tides_error error;
        assert_true(count + OTHERS < KINDS_MAX);
        snprintf(sets[count], 64, "sensor.preset=%s", k.name);
        k.sets[0] = sets[count];
        const tides_sensor sensor = sensor_of(&k);
        scene_expect_ok(td_sensor_shows_signal(&sensor, &shows, &error), &error);
        if (!shows) kinds[count++] = k;
    }
    memcpy(&kinds[count], others, sizeof others);
    return count + OTHERS;
}

/* A run whose references may begin anywhere between the levels. */
static outcome run_whole(const job *j) {
    outcome o = {0};
    tides_error error;
    tides_device *device = open_device(j->device);
    tides_simulator *s = make_simulator(j, device);
    scene_expect_ok(tides_simulator_run(s, j->stop, collect, &o, NULL, NULL, &error), &error);
    tides_simulator_stats(s, &o.stats);
    tides_simulator_destroy(s);
    tides_device_close(device);
    return o;
}

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The next event of a pixel from number k on, or the count. */
static size_t next_of(const outcome *o, const tides_event *like, size_t k) {
    while (k < o->count && (o->events[k].x != like->x || o->events[k].y != like->y)) k++;
    return k;
}

/* What the events of one run are off by in the other, pixel by pixel until their polarities differ; returns how many. */
static size_t compare(const outcome *a, const outcome *truth, int width, int height, double *apart) {
    size_t count = 0;
    for (int pixel = 0; pixel < width * height; pixel++) {
        const tides_event like = {.x = (uint16_t)(pixel % width), .y = (uint16_t)(pixel / width)};
        size_t i = next_of(a, &like, 0), j = next_of(truth, &like, 0);
        while (i < a->count && j < truth->count && a->events[i].polarity == truth->events[j].polarity) {
            apart[count++] = 1e-9 * fabs((double)(a->events[i].t - truth->events[j].t));
            i = next_of(a, &like, i + 1);
            j = next_of(truth, &like, j + 1);
        }
    }
    return count;
}

/* Reported over true p95; 0 where there are too few events. */
static double ratio_of(const kind *k, uint64_t number) {
    random_recipe recipe = random_recipe_defaults(number_of("TIDES_SEED", FIRST_SEED) + number);
    recipe.sh_degree = 0;
    recipe.width = 32;
    recipe.height = 28;
    recipe.count = 40;
    recipe.size = number % 2 ? 0.2 : 0.08;
    recipe.camera_speed = number % 3 ? 3 : 10;
    random_scene scene = random_scene_make(&recipe);
    job j = adaptive_job_of(&scene, 1), fine;
    j.sensor = sensor_of(k);
    j.device = "reference";
    j.stepping.tolerance = 1e-2;
    fine = j;
    fine.stepping.tolerance = 1e-4;
    outcome a = run_whole(&j), truth = run_whole(&fine);
    double *apart = calloc(a.count + 1, sizeof *apart), ratio = 0;
    const size_t count = compare(&a, &truth, recipe.width, recipe.height, apart);
    if (count >= ENOUGH) {
        qsort(apart, count, sizeof *apart, by_size);
        const double p95 = apart[(size_t)(0.95 * (double)(count - 1))];
        ratio = fmax(a.stats.error_p95_s, 1e-9) / fmax(p95, 1e-9); /* times are whole nanoseconds */
        print_message("%-16s scene %2d: %5zu events, p95 %8.0f ns, reported %8.0f ns: %.3g times\n", k->name, (int)number,
                      count, 1e9 * p95, 1e9 * a.stats.error_p95_s, ratio);
    }
    free(apart);
    free_outcome(&a);
    free_outcome(&truth);
    random_scene_free(&scene);
    return ratio;
}

static void test_filters(void **state) {
    (void)state;
    kind kinds[KINDS_MAX];
    char sets[KINDS_MAX][64];
    const uint64_t trials = number_of("TIDES_TRIALS", FEW), kinds_count = find_kinds(kinds, sets);
    const size_t runs = (size_t)(kinds_count * trials);
    double *ratio = calloc(runs, sizeof *ratio);
    size_t count = 0;
    for (uint64_t k = 0; k < kinds_count; k++)
        for (uint64_t n = 0; n < trials; n++) {
            ratio[count] = ratio_of(&kinds[k], trials < SCENES ? (k * trials + n) % SCENES : n);
            count += ratio[count] > 0;
        }
    assert_true(count > runs / 3);
    qsort(ratio, count, sizeof *ratio, by_size);
    size_t small = 0;
    while (small < count && ratio[small] < 1) small++;
    print_message("%zu runs: from %.3g to %.3g times, %.3g in the median; %zu report too little\n", count, ratio[0],
                  ratio[count - 1], ratio[count / 2], small);
    assert_true(ratio[count / 2] <= 5);
    assert_int_equal(small, 0);
    free(ratio);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_filters)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
