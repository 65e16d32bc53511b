/* A process that has used a device and then forks: the child gets one error, at once, and can still use functions that need no
 * driver. The parent goes on as before. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/device.h"
#include "tides/render.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"

#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TIME_LIMIT = 60 }; /* [s] after which a child that hangs is ended: what it did before */

typedef struct picture {
    random_scene scene;
    tides_device *device;
    tides_renderer *renderer;
    tides_frame frame;
} picture;

static void picture_open(picture *p, const char *spec) {
    random_recipe recipe = random_recipe_defaults(5);
    tides_image_params params;
    tides_error error;
    tides_image_params_defaults(&params);
    p->scene = random_scene_make(&recipe);
    memset(&p->frame, 0, sizeof p->frame);
    p->frame.plane[TIDES_Y] = calloc((size_t)recipe.width * (size_t)recipe.height, sizeof(double));
    scene_expect_ok(tides_device_open(spec, &p->device, &error), &error);
    scene_expect_ok(tides_renderer_create(p->device, p->scene.scene, &p->scene.camera, &params, NULL, NULL, &p->renderer,
                                          &error),
                    &error);
}

static void picture_close(picture *p) {
    tides_renderer_destroy(p->renderer);
    tides_device_close(p->device);
    free(p->frame.plane[TIDES_Y]);
    random_scene_free(&p->scene);
}

static tides_status picture_take(picture *p, tides_error *error) {
    return tides_renderer_frame(p->renderer, p->scene.path, 0.5, &p->frame, error);
}

/* 0 where `status` is the error of a forked process. */
static int refused(tides_status status, const tides_error *error) {
    return !(status == TIDES_NO_DEVICE && strstr(error->text, "forked") && strstr(error->text, "spawn"));
}

/* In the child, without cmocka, whose failures are the parent's: the number of the first thing that went wrong, or 0. */
static int child_of(picture *parents) {
    tides_error error = {TIDES_OK, ""};
    tides_device *device = NULL;
    tides_renderer *renderer = NULL;
    tides_image_params params;
    int32_t count = 77;
    tides_image_params_defaults(&params);
    if (refused(picture_take(parents, &error), &error)) return 1;
    if (refused(tides_device_list(NULL, 0, &count, &error), &error) || count != 77) return 2;
    if (refused(tides_device_open("0", &device, &error), &error) || device) return 3;
    if (refused(tides_renderer_create(parents->device, parents->scene.scene, &parents->scene.camera, &params, NULL, NULL,
                                      &renderer, &error),
                &error))
        return 4;
    if (tides_device_open("reference", &device, &error) != TIDES_OK) return 5;
    if (tides_renderer_create(device, parents->scene.scene, &parents->scene.camera, &params, NULL, NULL, &renderer, &error))
        return 6;
    if (tides_renderer_frame(renderer, parents->scene.path, 0.5, &parents->frame, &error) != TIDES_OK) return 7;
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    picture_close(parents);
    return 0;
}

static void test_child_is_told(void **state) {
    (void)state;
    int32_t count = 0;
    assert_int_equal(tides_device_list(NULL, 0, &count, NULL), TIDES_OK);
    if (count == 0) {
        print_message("skipped: this machine has no OpenCL device\n");
        skip();
    }
    picture p;
    tides_error error;
    int result = -1;
    picture_open(&p, "0");
    scene_expect_ok(picture_take(&p, &error), &error);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        alarm(TIME_LIMIT);
        exit(child_of(&p)); /* and not _exit: what drivers do at the end must not hang either */
    }
    assert_true(waitpid(child, &result, 0) == child);
    assert_false(WIFSIGNALED(result));
    assert_int_equal(WEXITSTATUS(result), 0);
    scene_expect_ok(picture_take(&p, &error), &error); /* the parent's are as they were */
    picture_close(&p);
}

/* One that forks before it uses a device is no concern of ours. */
static void test_fork_first(void **state) {
    (void)state;
    int result = -1;
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        int32_t count = 0;
        alarm(TIME_LIMIT);
        _exit(tides_device_list(NULL, 0, &count, NULL) == TIDES_OK ? 0 : 1);
    }
    assert_true(waitpid(child, &result, 0) == child);
    assert_true(WIFEXITED(result) && WEXITSTATUS(result) == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_fork_first), cmocka_unit_test(test_child_is_told)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
