/* A driver that fails to wait: the call fails, and memory that commands under way still use isn't freed. This program's
 * clFinish replaces the driver's, and fails once, without waiting, at a given call. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_opencl.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

static int calls, failing_call; /* 0: none */

CL_API_ENTRY cl_int CL_API_CALL clFinish(cl_command_queue queue) {
    static cl_int(CL_API_CALL * drivers)(cl_command_queue);
    if (!drivers) {
        void *library = dlopen("libOpenCL.so.1", RTLD_NOW), *found = library ? dlsym(library, "clFinish") : NULL;
        memcpy(&drivers, &found, sizeof drivers); /* ISO C has no conversion between the two */
    }
    if (++calls == failing_call || !drivers) return CL_OUT_OF_RESOURCES;
    return drivers(queue);
}

/* A renderer and a frame of the whole, freed at once after a failure; the planes too, which a device would write into. */
static tides_status render(tides_device *device, const random_scene *scene, tides_error *error) {
    tides_renderer *renderer = NULL;
    tides_image_params params;
    tides_image_params_defaults(&params);
    tides_status status = tides_renderer_create(device, scene->scene, &scene->camera, &params, NULL, NULL, &renderer, error);
    double *plane = malloc((size_t)scene->camera.width * (size_t)scene->camera.height * sizeof *plane);
    tides_frame frame = {{NULL}};
    assert_non_null(plane);
    frame.plane[TIDES_L] = plane;
    if (status == TIDES_OK) status = tides_renderer_frame(renderer, scene->path, 0.5, &frame, error);
    tides_renderer_destroy(renderer);
    free(plane);
    return status;
}

static void test_every_wait_fails(void **state) {
    random_recipe recipe = random_recipe_defaults(8);
    tides_device *device = NULL;
    tides_error error = {0, ""};
    (void)state;
    recipe.count = 2000; /* enough to be under way for a while */
    tides_status status = tides_device_open("cpu", &device, &error);
    if (status == TIDES_NO_DEVICE) skip();
    scene_expect_ok(status, &error);
    random_scene scene = random_scene_make(&recipe);
    calls = failing_call = 0;
    scene_expect_ok(render(device, &scene, &error), &error);
    const int waits = calls;
    assert_true(waits >= 2); /* a warm-up, and the frame */
    for (int round = 0; round < 3; round++)
        for (int k = 1; k <= waits; k++) {
            calls = 0;
            failing_call = k;
            scene_expect_error(render(device, &scene, &error), TIDES_DEVICE_FAILED, &error, "clFinish");
            assert_true(calls > k); /* it was asked again */
        }
    failing_call = 0;
    scene_expect_ok(render(device, &scene, &error), &error);
    random_scene_free(&scene);
    tides_device_close(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_wait_fails)};
    return cmocka_run_group_tests_name("finish", tests, NULL, NULL);
}
