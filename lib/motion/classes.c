/* The motion models that there are. */
#include "td_motion.h"

#include <string.h>

static const td_motion_class *const classes[] = {
    NULL, /* one line per model */
};

const td_motion_class *td_motion_class_find(const char *name) {
    for (const td_motion_class *const *type = classes; *type; type++)
        if (strcmp((*type)->name, name) == 0) return *type;
    return NULL;
}
