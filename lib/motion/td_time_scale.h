/* Internal: the scale of time on which a Gaussian's motion happens, in its motion's own time. */
#ifndef TD_TIME_SCALE_H
#define TD_TIME_SCALE_H

/* On intervals of length `always`, values and rates at start, middle and end show all that happens, at any time. Within 3
 * widths of `centre`, a shorter scale `width` holds; elsewhere it doesn't. INFINITY: no limit. `smooth`: up to this length
 * the Gaussian is smooth, whatever the common scale of the motion says; 0: not known. */
typedef struct td_time_scale {
    double always, centre, width, smooth;
} td_time_scale;

#endif
