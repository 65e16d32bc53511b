/* Internal: why drivers that are installed offer no device, or build nothing. */
#ifndef TD_DRIVERS_H
#define TD_DRIVERS_H

/* One sentence, without a full stop, of what is wrong and its remedy; "" where nothing was found. Returns `text`. */
enum { TD_TROUBLE_MAX = 640 };

/* Trouble with the drivers that the loader is to load: a library that is missing or can't be loaded; else that of
 * td_cache_trouble with PoCL; else that they have no device. "" where there is no driver at all. */
const char *td_driver_trouble(char text[TD_TROUBLE_MAX]);

/* Trouble with the folder of PoCL's kernels, without which it has no device, or builds none. */
const char *td_cache_trouble(char text[TD_TROUBLE_MAX]);

#endif
