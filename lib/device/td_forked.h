/* Internal: whether OpenCL can still be called in this process. */
#ifndef TD_FORKED_H
#define TD_FORKED_H

#include "td_base.h"

/* OpenCL's drivers are being loaded by this process, by one thread at a time: between the two, no other thread forks. */
void td_drivers_lock(void);
void td_drivers_unlock(void);

/* 1 in a process that was forked from one which had loaded the drivers: their threads are the parent's, so that calls would
 * wait for ever, releases too. No way to load them anew: the loader's table and the drivers' state came along. */
int32_t td_is_forked(void);

/* TIDES_OK, or the error that says what to do instead. */
tides_status td_check_forked(tides_error *error);

#endif
