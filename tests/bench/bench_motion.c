/* Times Theta and Theta_dot of deformation networks on a device.
 *   bench_motion [DEVICE] [GAUSSIANS]
 * 4DGaussians with the sizes of its D-NeRF configuration and random weights: all Gaussians, 1 % of them, and the plain network
 * (plain_hexplane.h), batched as in the library and with one Gaussian per work-item. Then Deformable-3DGS's network. Every
 * number is the best of alternating rounds, beside the time that the device's fma units need for as many fma in the same
 * rounds. Both the clock and the processor time of all threads are given; ratios are of the latter, which other work disturbs
 * least. */
#include "tests/bench/plain_hexplane.h"
#include "tests/support/motion_device.h"
#include "tests/support/random_network.h"

#include "motion/td_hexplane.h"
#include "motion/td_network.h"

#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 12, JOB = 256, SMALL_JOB = 32, FMA_ITEMS = 64, FMA_ROUNDS = 20000, DEVICE_LANES = 16 };
static const double TIME = 0.37;
static const double FMA_COUNT = 256.0 * FMA_ROUNDS * FMA_ITEMS;

static void stop_on(tides_status status, const tides_error *error) {
    if (status == TIDES_OK) return;
    fprintf(stderr, "bench_motion: %s\n", error->text);
    exit(1);
}

static void stop_on_code(cl_int code, const char *call) {
    if (code == CL_SUCCESS) return;
    fprintf(stderr, "bench_motion: %s: %s\n", call, td_cl_name(code));
    exit(1);
}

static int padded(int count) { return (count + TD_PAD - 1) / TD_PAD * TD_PAD; }

static void keep_best(motion_time *best, motion_time time) {
    if (best->elapsed == 0 || time.elapsed < best->elapsed) best->elapsed = time.elapsed;
    if (best->processor == 0 || time.processor < best->processor) best->processor = time.processor;
}

/* -- kernels of the bench's own ------------------------------------------------------------------------------------ */

/* A kernel of `source` behind the text of motion.cl. */
static cl_kernel build(tides_device *device, int lanes, const char *defines, const char *source, const char *name) {
    tides_error error = {0};
    td_source_text text = {0};
    char prelude[512];
    cl_int code = CL_SUCCESS;
    snprintf(prelude, sizeof prelude,
             "#pragma OPENCL FP_CONTRACT OFF\n#define TD_OPENCL 1\n#define TD_LANES %d\n#define TD_BUILD_MODEL %d\n%s", lanes,
             TD_MOTION_HEXPLANE, defines);
    stop_on(td_source_gather(&text, "motion.cl", &error), &error);
    const char **pieces = malloc((text.count + 2) * sizeof *pieces);
    if (!pieces) exit(1);
    pieces[0] = prelude;
    for (size_t i = 0; i < text.count; i++) pieces[1 + i] = text.piece[i];
    pieces[text.count + 1] = source;
    cl_program program = clCreateProgramWithSource(device->context, (cl_uint)text.count + 2, pieces, NULL, &code);
    stop_on_code(code, "clCreateProgramWithSource");
    stop_on_code(clBuildProgram(program, 1, &device->id, "-cl-std=CL1.2", NULL, NULL), "clBuildProgram");
    cl_kernel kernel = clCreateKernel(program, name, &code);
    stop_on_code(code, "clCreateKernel");
    clReleaseProgram(program);
    free(pieces);
    td_source_release(&text);
    return kernel;
}

static motion_time launch(tides_device *device, cl_kernel kernel, size_t global, td_arguments arguments) {
    tides_error error = {0};
    size_t local = 1;
    clFinish(device->queue);
    motion_time begun = motion_time_now();
    stop_on(td_launch(device, kernel, 1, &global, &local, arguments, NULL, &error), &error);
    clFinish(device->queue);
    return motion_time_since(begun);
}

typedef struct fma_limit {
    tides_device *device;
    cl_kernel kernel;
    td_buffer out;
    motion_time best; /* of FMA_COUNT fma of one number */
} fma_limit;

static fma_limit fma_make(tides_device *device) {
    tides_error error = {0};
    fma_limit limit = {.device = device, .kernel = build(device, DEVICE_LANES, "", fma_source, "fma_limit")};
    stop_on(td_buffer_reserve(device, &limit.out, FMA_ITEMS * 16 * sizeof(float), &error), &error);
    return limit;
}

static void fma_measure(fma_limit *limit) {
    int rounds = FMA_ROUNDS;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(limit->out), TD_VALUE_ARGUMENT(rounds)};
    keep_best(&limit->best, launch(limit->device, limit->kernel, FMA_ITEMS, TD_ARGUMENTS(arguments)));
}

/* -- the plain network --------------------------------------------------------------------------------------------- */

typedef struct plain {
    motion_device *on;
    cl_kernel kernel;
    int lanes;
    td_buffer planes, sizes, means;
    motion_time best;
} plain;

static float *turned_planes(const tides_motion *motion, const td_hexplane *shape, size_t *count) {
    size_t total = 0, at = 0;
    for (int level = 0; level < shape->levels; level++)
        for (int k = 0; k < 6; k++) {
            const td_field *field = td_hexplane_plane(motion, level, k);
            total += field->shape[1] * field->shape[2] * field->shape[3];
        }
    float *turned = malloc((total ? total : 1) * sizeof *turned);
    if (!turned) exit(1);
    for (int level = 0; level < shape->levels; level++)
        for (int k = 0; k < 6; k++) {
            const td_field *field = td_hexplane_plane(motion, level, k);
            size_t cells = field->shape[2] * field->shape[3];
            for (size_t i = 0; i < cells; i++)
                for (size_t c = 0; c < field->shape[1]; c++) turned[at++] = field->value[c * cells + i];
        }
    *count = total;
    return turned;
}

static plain plain_make(motion_device *on, const tides_gaussians *gaussians, int lanes) {
    plain made = {.on = on, .lanes = lanes};
    tides_error error = {0};
    td_hexplane shape;
    int sizes[4 * TD_HEXPLANE_LEVELS_MAX];
    size_t count = 0;
    stop_on(td_hexplane_measure(on->packed->motion, &shape, &error), &error);
    for (int level = 0; level < shape.levels; level++) {
        for (int axis = 0; axis < 3; axis++) sizes[4 * level + axis] = shape.size[level][axis];
        sizes[4 * level + 3] = shape.rows;
    }
    float *planes = turned_planes(on->packed->motion, &shape, &count);
    stop_on(td_buffer_write(on->device, &made.planes, planes, count * sizeof *planes, &error), &error);
    stop_on(td_buffer_write(on->device, &made.sizes, sizes, sizeof sizes, &error), &error);
    stop_on(td_buffer_write(on->device, &made.means, gaussians->mean, 3 * sizeof(float) * (size_t)gaussians->count, &error),
            &error);
    made.kernel = build(on->device, lanes, on->packed->numbers.defines, plain_source, "plain_network");
    free(planes);
    return made;
}

/* Whole vectors of all Gaussians; motion_device_set has listed them. */
static void plain_measure(plain *network, int gaussians) {
    float t = (float)TIME;
    motion_device *on = network->on;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(on->mover),
                                     TD_BUFFER_ARGUMENT(on->data),
                                     TD_BUFFER_ARGUMENT(network->planes),
                                     TD_BUFFER_ARGUMENT(network->sizes),
                                     TD_BUFFER_ARGUMENT(network->means),
                                     TD_BUFFER_ARGUMENT(on->index),
                                     TD_VALUE_ARGUMENT(t),
                                     TD_BUFFER_ARGUMENT(on->geometry),
                                     TD_BUFFER_ARGUMENT(on->rates)};
    keep_best(&network->best,
              launch(on->device, network->kernel, (size_t)(gaussians / network->lanes), TD_ARGUMENTS(arguments)));
}

/* -- tables ---------------------------------------------------------------------------------------------------------- */

/* `fma`: what the work must have at least. */
static void print_time(const char *name, motion_time time, double fma, const fma_limit *limit) {
    double share = fma / FMA_COUNT;
    printf("%-44s %9.2f ms, processor %9.2f ms", name, time.elapsed * 1e3, time.processor * 1e3);
    if (fma > 0)
        printf("; fma limit %8.2f ms, %8.2f ms: %3.0f %%", 1e3 * share * limit->best.elapsed,
               1e3 * share * limit->best.processor, 100 * share * limit->best.processor / time.processor);
    printf("\n");
}

static void bench_hexplane(tides_device *device, fma_limit *limit, int gaussians) {
    random_hexplane_recipe recipe = random_hexplane_defaults(1);
    tides_motion *motion = random_hexplane_make(&recipe);
    random_gaussians some = random_gaussians_make(2, gaussians, 0, 1.5);
    double begun = td_now();
    motion_time all = {0, 0}, few = {0, 0};
    packed_motion packed = packed_motion_make(motion, &some.view);
    printf("4DGaussians, D-NeRF sizes, %d Gaussians: packed in %.2f s to %.0f MB on the device\n", gaussians, td_now() - begun,
           (double)packed.numbers.data_count * 4e-6);
    motion_device on = motion_device_make(device, &packed, padded(gaussians), 0);
    plain batched = plain_make(&on, &some.view, DEVICE_LANES), single = plain_make(&on, &some.view, 1);
    int *selected = malloc((size_t)gaussians * sizeof *selected), one_percent = gaussians / 100;
    if (!selected) exit(1);
    for (int i = 0; i < one_percent; i++) selected[i] = i * 97;
    for (int round = 0; round < ROUNDS; round++) {
        fma_measure(limit);
        motion_device_set(&on, selected, one_percent, SMALL_JOB);
        keep_best(&few, motion_device_run(&on, TIME, 1));
        motion_device_set(&on, NULL, gaussians, JOB);
        keep_best(&all, motion_device_run(&on, TIME, 1));
        plain_measure(&batched, gaussians);
        if (round < 3) plain_measure(&single, gaussians);
    }
    /* Values and rates: 64 x 64 in the trunk, 3 heads of 64 x 64 and 64 x (3 + 3 + 4). */
    double fma = 2.0 * gaussians * (4 * 64 * 64 + 64 * 10);
    print_time("all Gaussians", all, fma, limit);
    print_time("1 % of them", few, fma / 100, limit);
    print_time("plain network, batched alike", batched.best, 0, limit);
    print_time("plain network, one Gaussian per work-item", single.best, 0, limit);
    printf("factor over the plain network: %.2f batched alike, %.2f one per work-item; 1 %% costs %.2f %%\n",
           batched.best.processor / all.processor, single.best.processor / all.processor, 100 * few.processor / all.processor);
    motion_device_free(&on);
    packed_motion_free(&packed);
    random_gaussians_free(&some);
    tides_motion_destroy(motion);
    free(selected);
}

static void bench_network(tides_device *device, fma_limit *limit, int gaussians) {
    random_network_recipe recipe = random_network_defaults(1);
    tides_motion *motion = random_network_make(&recipe);
    random_gaussians some = random_gaussians_make(2, gaussians, 0, 1.5);
    packed_motion packed = packed_motion_make(motion, &some.view);
    motion_device on = motion_device_make(device, &packed, padded(gaussians), 0);
    motion_time all = {0, 0};
    motion_device_set(&on, NULL, gaussians, SMALL_JOB);
    for (int round = 0; round < 3; round++) {
        fma_measure(limit);
        keep_best(&all, motion_device_run(&on, TIME, 1));
    }
    /* The inputs from the mean have no rate. */
    double fma = 2.0 * gaussians * (7 * 256 * 256 + 2 * 21 * 256 + 256 * 10) + 2.0 * gaussians * 63 * 256;
    printf("Deformable-3DGS, %d Gaussians\n", gaussians);
    print_time("all Gaussians", all, fma, limit);
    motion_device_free(&on);
    packed_motion_free(&packed);
    random_gaussians_free(&some);
    tides_motion_destroy(motion);
}

int main(int count, char **words) {
    tides_device *device = NULL;
    tides_error error = {0};
    int gaussians = padded(count > 2 ? atoi(words[2]) : 100000);
    stop_on(tides_device_open(count > 1 ? words[1] : "cpu", &device, &error), &error);
    if (gaussians < 1600) {
        fprintf(stderr, "bench_motion: at least 1600 Gaussians\n");
        return 2;
    }
    fma_limit limit = fma_make(device);
    bench_hexplane(device, &limit, gaussians);
    bench_network(device, &limit, padded(gaussians / 10));
    printf("fma limit: %.1f G/s, %.1f G/s and core\n", 1e-9 * FMA_COUNT / limit.best.elapsed,
           1e-9 * FMA_COUNT / limit.best.processor);
    tides_device_close(device);
    return 0;
}
