/* Internal: why drivers that are installed offer no device, or build nothing. */
#ifndef TD_DRIVERS_H
#define TD_DRIVERS_H

/* One sentence, without a full stop, of what is wrong and its remedy; "" where nothing was found. Returns `text`. */
enum { TD_TROUBLE_MAX = 640 };

/* Of the drivers that the loader is to load: a library that is gone, or can't be loaded; else what td_cache_trouble says of
 * PoCL; else that they have no device. "" where there is no driver at all. */
const char *td_driver_trouble(char text[TD_TROUBLE_MAX]);

/* Of the folder that PoCL keeps kernels in, without which it has no device, or builds none. */
const char *td_cache_trouble(char text[TD_TROUBLE_MAX]);

#endif
