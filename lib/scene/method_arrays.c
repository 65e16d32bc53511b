/* Final checks of a trained model that is read from named arrays (.npz, .pth): its Gaussians must be valid, and its motion must
 * fit them. */
#include "scene/td_method_arrays.h"

#include "motion/td_motion.h"

tides_status td_arrays_finish(tides_status status, const char *path, td_gaussians *made, tides_motion *moves,
                              td_gaussians *gaussians, tides_motion **motion, tides_error *error) {
    if (status == TIDES_OK) {
        const tides_gaussians view = td_gaussians_view(made);
        status = td_gaussians_check(made, 1, TIDES_BAD_FILE, error);
        if (status == TIDES_OK) status = moves->type->check(moves, &view, error);
    }
    if (status == TIDES_OK) {
        *gaussians = *made;
        *motion = moves;
        return TIDES_OK;
    }
    tides_motion_destroy(moves);
    td_gaussians_free(made);
    if (status == TIDES_BAD_ARGUMENT) { /* from the motion's check, which doesn't know that the arrays are a file's */
        status = TIDES_BAD_FILE;
        if (error) error->status = status;
    }
    return td_fail_within(error, status, "%s", path);
}
