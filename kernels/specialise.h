/* The image's constants as a kernel sees them: read from the buffer, with the decisions that the prelude fixes at build time
 * put in as literals, so that what is switched off is not even compiled. The host says for which of them a file is built. */
#ifndef TD_SPECIALISE_H
#define TD_SPECIALISE_H

#include "layout.h"

TD_INLINE td_image td_specialised(__constant const td_image *buffer) {
    td_image image = *buffer;
#ifdef TD_BUILD_SH_DEGREE
    image.sh_degree = TD_BUILD_SH_DEGREE;
#endif
#ifdef TD_BUILD_ANTIALIAS
    image.antialias = TD_BUILD_ANTIALIAS;
#endif
#ifdef TD_BUILD_CUT_RULE
    image.cut_rule = TD_BUILD_CUT_RULE;
#endif
#ifdef TD_BUILD_STOP_RULE
    image.stop_rule = TD_BUILD_STOP_RULE;
#endif
#ifdef TD_BUILD_EXTENT_RULE
    image.extent_rule = TD_BUILD_EXTENT_RULE;
#endif
#ifdef TD_BUILD_MOVING
    image.moving = TD_BUILD_MOVING;
#endif
#ifdef TD_BUILD_OUTPUTS
    image.outputs = TD_BUILD_OUTPUTS;
#endif
#ifdef TD_BUILD_SOFT_ORDER
    image.soft_order = TD_BUILD_SOFT_ORDER;
#endif
#ifdef TD_BUILD_DECODER
    image.decoder = TD_BUILD_DECODER;
#endif
#ifdef TD_BUILD_LENS
    image.lens_model = TD_BUILD_LENS;
#endif
    return image;
}

#endif
