/* Compiles the motion models of kernels/ in single precision, as the function move_f32, which moves one Gaussian after another.
 * move_mover_f32 converts a job to a td_mover in bytes, for the buffer that the OpenCL kernel td_move_gaussians reads. */
#define MOVE move_f32
#include "tests/support/move_body.h"

size_t move_mover_bytes(void) { return sizeof(td_mover); }

void move_mover_f32(const move_job *job, void *mover) {
    td_mover made;
    fill_mover(job, &made);
    memcpy(mover, &made, sizeof made);
}
