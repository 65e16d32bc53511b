/* The table of motion models, by which scene files and readers find a model from its name. */
#include "td_hexplane.h"
#include "td_models.h"
#include "td_network.h"

#include <string.h>

static const td_motion_class *const classes[] = {
    &td_polynomial_class, &td_rotor_class, &td_keyframes_class, &td_hexplane_class, &td_network_class, &td_callback_class, NULL,
};

const td_motion_class *td_motion_class_find(const char *name) {
    for (const td_motion_class *const *type = classes; *type; type++)
        if (strcmp((*type)->name, name) == 0) return *type;
    return NULL;
}
