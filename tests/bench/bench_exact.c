/* Projection at three nodes of record paths, in double: milliseconds of a launch, on the clock and of all threads together.
 *   usage: bench_exact [GAUSSIANS [SH_DEGREE [JOB_SIZE]]] */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_renderer.h"

#include "render/td_exact.h"
#include "tests/support/random_scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { NODES = 3, TURNS = 9 };
static const double node_times[NODES] = {0.4, 0.405, 0.41};

typedef struct asked {
    int *gaussians, *rows, count, job_count;
    td_node_job *jobs;
} asked;

/* Every Gaussian at every node, a job at a time: the nodes of the same Gaussians follow one another. */
static asked ask(int gaussians, int job_size) {
    asked a = {0};
    size_t all = (size_t)NODES * (size_t)gaussians;
    a.gaussians = calloc(all, sizeof *a.gaussians);
    a.rows = calloc(all, sizeof *a.rows);
    a.jobs = calloc(all / TD_PAD + NODES, sizeof *a.jobs);
    if (!a.gaussians || !a.rows || !a.jobs) abort();
    for (int first = 0; first < gaussians; first += job_size)
        for (int node = 0; node < NODES; node++) {
            int size = gaussians - first < job_size ? gaussians - first : job_size;
            a.jobs[a.job_count++] = (td_node_job){node, a.count, size, 0};
            for (int i = first; i < first + size; i++) {
                a.gaussians[a.count] = i;
                a.rows[a.count++] = i * NODES + node;
            }
        }
    return a;
}

static double processor(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The fastest of some turns. */
static tides_status measure(td_backend *backend, td_exact *exact, const td_node_request *request, tides_error *error) {
    double least = 1e9, work = 1e9;
    tides_status status = TIDES_OK;
    for (int turn = 0; turn < TURNS && status == TIDES_OK; turn++) {
        double begun = td_now(), before = processor();
        status = td_exact_nodes(exact, backend, request, error);
        if (td_now() - begun < least) least = td_now() - begun;
        if (processor() - before < work) work = processor() - before;
    }
    printf("%8.1f %10.1f\n", 1e3 * least, 1e3 * work);
    return status;
}

static tides_status run(tides_device *device, const random_scene *scene, int job_size, tides_error *error) {
    td_backend *backend = NULL;
    td_exact *exact = NULL;
    td_store store = random_scene_store(scene, node_times[0]);
    td_image_numbers image = random_scene_image(scene, TIDES_RULES_SMOOTH, 0, TD_OUT_SIGNAL);
    double *views = random_scene_views(scene, node_times, NODES);
    asked a = ask(store.count, job_size);
    const td_node_request request = {views, NODES, a.jobs, a.job_count, a.gaussians, a.rows, a.count, a.count};
    tides_status status = td_backend_create_opencl(device, &store, &image, &backend, error);
    if (status == TIDES_OK) status = td_exact_create(device, &store, &image, &exact, error);
    printf("%d Gaussians of SH degree %d, %d nodes, jobs of %d\n%8s %10s\n", store.count, scene->recipe.sh_degree, NODES,
           job_size, "ms", "cpu ms");
    if (status == TIDES_OK) status = measure(backend, exact, &request, error);
    td_exact_destroy(exact);
    if (backend) backend->type->destroy(backend);
    free(views);
    free(a.gaussians);
    free(a.rows);
    free(a.jobs);
    td_store_release(&store);
    return status;
}

int main(int argc, char **argv) {
    random_recipe recipe = random_recipe_defaults(1);
    tides_device *device = NULL;
    tides_error error;
    recipe.count = argc > 1 ? atoi(argv[1]) : 100000;
    recipe.sh_degree = argc > 2 ? atoi(argv[2]) : 3;
    tides_status status = tides_device_open(NULL, &device, &error);
    if (status == TIDES_OK) {
        random_scene scene = random_scene_make(&recipe);
        status = run(device, &scene, argc > 3 ? atoi(argv[3]) : 256, &error);
        random_scene_free(&scene);
    }
    tides_device_close(device);
    if (status != TIDES_OK) fprintf(stderr, "bench_exact: %s\n", error.text);
    return status != TIDES_OK;
}
