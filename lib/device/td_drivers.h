/* Internal: explains why installed drivers offer no device, or can't build kernels. */
#ifndef TD_DRIVERS_H
#define TD_DRIVERS_H

/* Both functions write a sentence without a full stop, with the problem and its remedy; "" if none was found. They return
 * `text`. */
enum { TD_TROUBLE_MAX = 640 };

/* Problems of installed drivers: a library is missing or can't be loaded; otherwise that of PoCL's cache folder; otherwise
 * the drivers have no device. "" if no driver is installed. */
const char *td_driver_trouble(char text[TD_TROUBLE_MAX]);

/* Problems of the folder in which PoCL caches kernels. Without it PoCL has no device, or can't build. */
const char *td_cache_trouble(char text[TD_TROUBLE_MAX]);

#endif
