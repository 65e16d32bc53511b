/* Timing errors that a run with filters or noise reports: no smaller than the true ones, and not much larger. The truth
 * is the same run at a fine tolerance; sensors are those of presets. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/property/simulator_run.h"

static const uint64_t SEED = 7400;

/* A preset's. */
typedef struct kind {
    const char *name;
    double threshold_on, threshold_off, sigma, cutoff_hz;
    int law;
    double refractory_s;
    int refractory_law;
    double leak_hz;
    double noise_rms, noise_hz, noise_sigma, shot_hz, kick;
} kind;

static const kind kinds[] = {
    {"gen4", 0.223, 0.223, 0.0065, 77, TIDES_PHOTORECEPTOR_CONSTANT, 7.9e-5, TIDES_REFRACTORY_HOLD, 0, 0, 0, 0, 0, 0},
    {"davis346", 0.283, 0.262, 0.035, 45.5, TIDES_PHOTORECEPTOR_CONSTANT, 3.4e-6, TIDES_REFRACTORY_HOLD, 3e-5, 0, 0, 0, 0, 0},
    {"v2e-noisy", 0.2, 0.2, 0.05, 30, TIDES_PHOTORECEPTOR_INTENSITY, 0, TIDES_REFRACTORY_DROP_KEEP, 0.1, 0, 0, 0, 0, 0},
    {"gen3", 0.15, 0.1, 0.03, 200, TIDES_PHOTORECEPTOR_CONSTANT, 1e-4, TIDES_REFRACTORY_HOLD, 0.05, 0, 0, 0, 0, 0},
    {"dvs128", 0.198, 0.329, 0.021, 3000, TIDES_PHOTORECEPTOR_CONSTANT, 3.5e-5, TIDES_REFRACTORY_HOLD, 0.039, 0, 0, 0, 0, 0},
    {"low light", 0.223, 0.223, 0.0065, 16, TIDES_PHOTORECEPTOR_CONSTANT, 7.9e-5, TIDES_REFRACTORY_HOLD, 0, 0, 0, 0, 0, 0},
    {"by light", 0.2, 0.2, 0, 300, TIDES_PHOTORECEPTOR_INTENSITY, 1e-4, TIDES_REFRACTORY_HOLD, 0, 0, 0, 0, 0, 0},
};
enum { KINDS = sizeof kinds / sizeof *kinds, SCENES = 5 };

/* Blocks whose events depend on more than the light. */
static const kind noisy[] = {
    {"noise", 0.2, 0.2, 0, 0, TIDES_PHOTORECEPTOR_CONSTANT, 0, TIDES_REFRACTORY_HOLD, 0, 0.02, 300, 0, 0, 0},
    {"low light", 0.223, 0.223, 0.0065, 16, TIDES_PHOTORECEPTOR_CONSTANT, 7.9e-5, TIDES_REFRACTORY_HOLD, 0, 0.06, 16, 0.04,
     0.06, 0},
    {"gen4", 0.223, 0.223, 0.0065, 77, TIDES_PHOTORECEPTOR_CONSTANT, 7.9e-5, TIDES_REFRACTORY_HOLD, 0, 0.0238, 77, 0.04, 0.06,
     0},
    {"bright", 0.223, 0.223, 0.0065, 300, TIDES_PHOTORECEPTOR_CONSTANT, 7.9e-5, TIDES_REFRACTORY_HOLD, 0, 0.03, 300, 0.04, 0.06,
     0},
    {"v2e-noisy", 0.2, 0.2, 0.05, 30, TIDES_PHOTORECEPTOR_INTENSITY, 0, TIDES_REFRACTORY_DROP_KEEP, 0.1, 0, 0, 0, 5, 0},
    {"v2e, rms", 0.2, 0.2, 0.05, 30, TIDES_PHOTORECEPTOR_INTENSITY, 0, TIDES_REFRACTORY_DROP_KEEP, 0.1, 0.01, 100, 0, 5, 0},
    {"frames", 0.283, 0.262, 0.035, 45.5, TIDES_PHOTORECEPTOR_CONSTANT, 3.4e-6, TIDES_REFRACTORY_HOLD, 3e-5, 0, 0, 0, 0, 0.04},
};
enum { NOISY = sizeof noisy / sizeof *noisy };

static tides_sensor sensor_of(const kind *k) {
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.threshold_on = k->threshold_on;
    sensor.threshold_off = k->threshold_off;
    sensor.threshold_sigma = k->sigma;
    sensor.photoreceptor_cutoff_hz = k->cutoff_hz;
    sensor.photoreceptor_law = k->law;
    sensor.refractory_s = k->refractory_s;
    sensor.refractory_law = k->refractory_law;
    sensor.leak_rate_hz = k->leak_hz;
    sensor.noise_rms = k->noise_rms;
    if (k->noise_hz > 0) sensor.noise_cutoff_hz = k->noise_hz;
    sensor.noise_sigma = k->noise_sigma;
    sensor.shot_noise_hz = k->shot_hz;
    sensor.kick = k->kick;
    return sensor;
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

/* Reported over true p95, of events as many as are worth a percentile; 0 where there are too few. */
static double ratio_of(const kind *k, int number) {
    random_recipe recipe = random_recipe_defaults(SEED + (uint64_t)number);
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
    outcome a = run(&j), truth = run(&fine);
    double *apart = calloc(a.count + 1, sizeof *apart), ratio = 0;
    const size_t count = compare(&a, &truth, recipe.width, recipe.height, apart);
    if (count >= 200) {
        qsort(apart, count, sizeof *apart, by_size);
        const double p95 = apart[(size_t)(0.95 * (double)(count - 1))];
        ratio = fmax(a.stats.error_p95_s, 1e-9) / fmax(p95, 1e-9); /* times are whole nanoseconds */
        print_message("%-10s scene %2d: %5zu events, p95 %8.0f ns, reported %8.0f ns: %.3g times\n", k->name, number, count,
                      1e9 * p95, 1e9 * a.stats.error_p95_s, ratio);
    }
    free(apart);
    free_outcome(&a);
    free_outcome(&truth);
    random_scene_free(&scene);
    return ratio;
}

static void expect_honest(const kind *of, size_t kinds_count) {
    double ratio[(KINDS + NOISY) * SCENES];
    size_t count = 0;
    for (size_t k = 0; k < kinds_count; k++)
        for (int scene = 0; scene < SCENES; scene++) {
            ratio[count] = ratio_of(&of[k], (int)k * SCENES + scene);
            count += ratio[count] > 0;
        }
    assert_true(count > kinds_count * SCENES / 2);
    qsort(ratio, count, sizeof *ratio, by_size);
    print_message("%zu runs: from %.3g to %.3g times, %.3g in the median\n", count, ratio[0], ratio[count - 1],
                  ratio[count / 2]);
    assert_true(ratio[0] >= 1);
    assert_true(ratio[count / 2] <= 5);
}

static void test_filters(void **state) {
    (void)state;
    expect_honest(kinds, KINDS);
}

static void test_noise(void **state) {
    (void)state;
    expect_honest(noisy, NOISY);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_filters), cmocka_unit_test(test_noise)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
