/* The motion models of kernels/ in single precision, one Gaussian at a time, and the kernel's buffers. */
#define MOVE move_f32
#include "tests/support/move_body.h"

size_t move_mover_bytes(void) { return sizeof(td_mover); }

void move_mover_f32(const move_job *job, void *mover) {
    td_mover made;
    fill_mover(job, &made);
    memcpy(mover, &made, sizeof made);
}
