/* Internal: on what scale of time a Gaussian's motion happens, in its motion's own time. */
#ifndef TD_TIME_SCALE_H
#define TD_TIME_SCALE_H

/* At all times values and rates at the start, the middle and the end of `always` show what happens; within 3 widths of
 * `centre` those of `width` do, and outside of that nothing sharper than `always` does. INFINITY: no limit. `smooth`: over as
 * long as that the Gaussian is smooth whatever td_motion_class.scale says; 0: it isn't known to be. */
typedef struct td_time_scale {
    double always, centre, width, smooth;
} td_time_scale;

#endif
