/* Builds the renderer's kernels, each only for those decisions of the image that its code uses. */
#include "td_opencl.h"

#include <stdlib.h>

/* The image's decisions for which kernels are built. */
enum {
    BY_SH = 1,
    BY_ANTIALIAS = 2,
    BY_CUT = 4,
    BY_STOP = 8,
    BY_EXTENT = 16,
    BY_MOVING = 32,
    BY_OUTPUTS = 64,
    BY_SOFT_ORDER = 128,
    BY_DECODER = 256,
    BY_LENS = 512,
    BY_CODED = 1024,
    BY_COLOURS_MOVE = 2048,
    BY_ALL = 4095,
    BY_PROJECTION = BY_SH | BY_ANTIALIAS | BY_CUT | BY_EXTENT | BY_MOVING | BY_SOFT_ORDER | BY_LENS
};

/* The decisions that a program uses. Drivers cache builds by their text, so a superfluous decision would compile the same
 * code again: 44 builds of sort in the tests were one program. A file that isn't listed is built for every decision. */
static int decisions_of(const char *files) {
    static const struct {
        const char *files;
        int decisions;
    } known[] = {{TD_FIRST_KERNELS, BY_ANTIALIAS | BY_CUT | BY_MOVING | BY_SOFT_ORDER | BY_LENS},
                 {TD_PROJECT_KERNELS, BY_PROJECTION | BY_OUTPUTS | BY_DECODER | BY_CODED},
                 {"composite.cl", BY_CUT | BY_STOP | BY_OUTPUTS | BY_SOFT_ORDER | BY_DECODER | BY_LENS | BY_CODED},
                 {"interpolate.cl", 0},
                 {"misfit.cl", BY_PROJECTION},
                 {"path_nodes.cl", BY_PROJECTION | BY_CODED | BY_COLOURS_MOVE}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strcmp(known[i].files, files) == 0) return known[i].decisions;
    return BY_ALL;
}

/* The decisions as #defines: code for what is off isn't compiled. */
char *td_opencl_defines(const char *files, const td_image *image, int outputs, tides_error *error) {
    const struct {
        const char *name;
        int value;
    } all[] = {{"SH_DEGREE", image->sh_degree},
               {"ANTIALIAS", image->antialias},
               {"CUT_RULE", image->cut_rule},
               {"STOP_RULE", image->stop_rule},
               {"EXTENT_RULE", image->extent_rule},
               {"MOVING", image->moving},
               {"OUTPUTS", outputs},
               {"SOFT_ORDER", image->soft_order},
               {"DECODER", image->decoder},
               {"LENS", image->lens_model},
               {"CODED", image->is_coded},
               {"COLOURS_MOVE", image->colours_move}};
    int decisions = decisions_of(files);
    char text[640] = "";
    for (size_t i = 0, used = 0; i < sizeof all / sizeof *all; i++)
        if (decisions >> i & 1)
            used += (size_t)snprintf(text + used, sizeof text - used, "#define TD_BUILD_%s %d\n", all[i].name, all[i].value);
    return td_format(error, "%s", text);
}

tides_status td_opencl_make_kernel(opencl_backend *b, const char *files, const char *name, int outputs, cl_kernel *kernel,
                                   tides_error *error) {
    if (*kernel) return TIDES_OK;
    char *defines = td_opencl_defines(files, &b->image, outputs, error);
    if (!defines) return TIDES_NO_MEMORY;
    double begun = td_now();
    tides_status status = td_kernel_create(b->device, files, defines, name, kernel, error);
    b->base.stats.time_build_s += td_now() - begun;
    free(defines);
    return status;
}
