/* Internal: tells if OpenCL can still be called in this process, which it can't in a child of a process that has used it. */
#ifndef TD_FORKED_H
#define TD_FORKED_H

#include "td_base.h"

/* Enclose the loading of OpenCL's drivers: one thread at a time, and no other thread forks in between. */
void td_drivers_lock(void);
void td_drivers_unlock(void);

/* 1 in a child of a process that had loaded the drivers: their threads exist only in the parent, so any call would wait for
 * ever, even a release. They can't be loaded again, since the loader's table and the drivers' state were copied, too. */
int32_t td_is_forked(void);

/* TIDES_OK, or an error that says what to do instead. */
tides_status td_check_forked(tides_error *error);

#endif
