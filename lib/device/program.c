/* Builds kernels: prelude and source become a cl_program, once per device, set of files and set of defines. PoCL and vendors'
 * drivers cache binaries on disk, so this keeps only a table in memory.
 *
 * Two ideas were tried and refused. A cache of our own binaries: with it PoCL 3.1 makes a program in 1 to 4 ms, instead of 25
 * to 40 (in which clang reads 900 KB of headers to find the key of its cache). But to return a binary it compiles kernels
 * again, for any size of work-groups, 0.3 to 1.7 s each, as long as the build. And -cl-opt-disable, which leaves optimising
 * to the launch: kernels were 13 to 18 times slower. With always_inline bits were equal and programs took 2.9 instead of 4.2
 * s, but first launches took 5.8 instead of 3.5.
 *
 * The solution in use: the 900 KB declare OpenCL's functions, of which kernels call two dozen. The program declares these
 * itself, and defines the header's include guard, so that clang skips the header. Then 10 to 25 ms are left. */
#include "td_device.h"
#include "td_drivers.h"
#include "td_forked.h"

#include <stdlib.h>
#include <string.h>

struct td_program_entry {
    char *key; /* files, precision, lanes and defines */
    cl_program program;
    td_program_entry *next;
};

/* clang-format off */
const char *td_cl_name(cl_int code) {
    switch (code) {
#define NAME(x) case x: return #x;
        NAME(CL_SUCCESS) NAME(CL_DEVICE_NOT_FOUND) NAME(CL_DEVICE_NOT_AVAILABLE) NAME(CL_COMPILER_NOT_AVAILABLE)
        NAME(CL_MEM_OBJECT_ALLOCATION_FAILURE) NAME(CL_OUT_OF_RESOURCES) NAME(CL_OUT_OF_HOST_MEMORY)
        NAME(CL_PROFILING_INFO_NOT_AVAILABLE) NAME(CL_BUILD_PROGRAM_FAILURE) NAME(CL_MAP_FAILURE) NAME(CL_INVALID_VALUE)
        NAME(CL_INVALID_PLATFORM) NAME(CL_INVALID_DEVICE) NAME(CL_INVALID_CONTEXT) NAME(CL_INVALID_COMMAND_QUEUE)
        NAME(CL_INVALID_MEM_OBJECT) NAME(CL_INVALID_BUILD_OPTIONS) NAME(CL_INVALID_PROGRAM)
        NAME(CL_INVALID_PROGRAM_EXECUTABLE) NAME(CL_INVALID_KERNEL_NAME) NAME(CL_INVALID_KERNEL) NAME(CL_INVALID_ARG_INDEX)
        NAME(CL_INVALID_ARG_VALUE) NAME(CL_INVALID_ARG_SIZE) NAME(CL_INVALID_KERNEL_ARGS) NAME(CL_INVALID_WORK_DIMENSION)
        NAME(CL_INVALID_WORK_GROUP_SIZE) NAME(CL_INVALID_WORK_ITEM_SIZE) NAME(CL_INVALID_EVENT) NAME(CL_INVALID_OPERATION)
        NAME(CL_INVALID_BUFFER_SIZE) NAME(CL_INVALID_GLOBAL_WORK_SIZE)
#undef NAME
        default: return "unknown OpenCL error";
    }
}
/* clang-format on */

tides_status td_cl_fail(tides_error *error, cl_int code, const char *call) {
    int length = (int)strcspn(call, "("); /* only the name of the call */
    return td_fail(error, TIDES_DEVICE_FAILED, "OpenCL: %.*s failed with %s (%d)", length, call, td_cl_name(code), (int)code);
}

/* Fails with the first lines of the compiler's log. */
static tides_status fail_build(const tides_device *device, cl_program program, const char *file, tides_error *error) {
    char *log = NULL;
    size_t bytes = 0;
    clGetProgramBuildInfo(program, device->id, CL_PROGRAM_BUILD_LOG, 0, NULL, &bytes);
    log = td_alloc(bytes + 1, 1, NULL);
    if (log) clGetProgramBuildInfo(program, device->id, CL_PROGRAM_BUILD_LOG, bytes, log, NULL);
    for (char *c = log; c && *c; c++) /* makes it one line */
        if (*c == '\n' || *c == '\r') *c = ' ';
    char trouble[TD_TROUBLE_MAX] = "";
    if (strcmp(device->info.platform, "Portable Computing Language") == 0) td_cache_trouble(trouble);
    tides_status status =
        td_fail(error, TIDES_DEVICE_FAILED, "kernel %s doesn't build on %.60s: %.700s", file, device->info.name,
                trouble[0] ? trouble
                : log      ? log
                           : "(no log)");
    free(log);
    return status;
}

/* A program's precision and number of lanes. */
typedef struct dialect {
    int is_double, lanes;
} dialect;

int td_double_lanes(const tides_device *device) {
    return device->info.lanes > device->double_lanes ? device->double_lanes : (int)device->info.lanes;
}

/* The first lines of each program. The pragma only affects text behind it, so it comes first. Vectors wider than the device's
 * registers never cross a program's border here, so clang's note about their calling convention is suppressed.
 * intel_vec_len_hint(1) keeps Intel's CPU driver from making vectors of work-items: runs weren't faster, and compiling took
 * three to five times as long (demo: 13 s instead of 2.6 to 3.7). */
static char *make_prelude(const tides_device *device, const dialect *of, const char *defines, tides_error *error) {
    return td_format(error,
                     "#pragma OPENCL FP_CONTRACT OFF\n%s"
                     "#ifdef __clang__\n#pragma clang diagnostic ignored \"-Wpsabi\"\n#endif\n"
                     "#ifdef cl_intel_vec_len_hint\n#define __kernel __attribute__((intel_vec_len_hint(1))) __kernel\n#endif\n"
                     "%s#define TD_OPENCL 1\n#define TD_LANES %d\n%s",
                     of->is_double ? "#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n#define TD_REAL_DOUBLE 1\n" : "",
                     device->info.fused ? "" : "#define TD_UNFUSED 1\n", of->lanes, defines);
}

/* Appends the text of each of `files` and of their includes, each once. */
static tides_status gather_all(td_source_text *text, const char *files, tides_error *error) {
    tides_status status = TIDES_OK;
    while (*files && status == TIDES_OK) {
        size_t length = strcspn(files, " ");
        char *file = td_format(error, "%.*s", (int)length, files);
        status = file ? td_source_gather(text, file, error) : TIDES_NO_MEMORY;
        free(file);
        files += length + strspn(files + length, " ");
    }
    return status;
}

/* Defines the include guard of clang's OpenCL header, which is then empty; kernels/builtins.h replaces it. */
#define OWN_BUILTINS " -D_OPENCL_H_"

/* Assembles a program: prelude, declarations if it uses its own, and `files`. */
static tides_status gather_program(td_source_text *text, const tides_device *device, const dialect *of, const char *files,
                                   const char *defines, tides_error *error) {
    char *prelude = make_prelude(device, of, defines, error);
    if (!prelude) return TIDES_NO_MEMORY;
    tides_status status = td_reserve((void **)&text->piece, &text->capacity, 1, sizeof *text->piece, error);
    if (status != TIDES_OK) {
        free(prelude);
        return status;
    }
    text->piece[text->count++] = prelude;
    if (device->own_builtins) status = td_source_gather(text, "builtins.h", error);
    return status == TIDES_OK ? gather_all(text, files, error) : status;
}

static tides_status compile(const tides_device *device, const td_source_text *text, const char *files, cl_program *program,
                            tides_error *error) {
    tides_status status = TIDES_OK;
    cl_int code = CL_SUCCESS;
    char options[128];
    cl_program built =
        clCreateProgramWithSource(device->context, (cl_uint)text->count, (const char **)(void *)text->piece, NULL, &code);
    TD_CL(code);
    snprintf(options, sizeof options, "-cl-std=CL1.2%s%s",
             device->correctly_rounded ? " -cl-fp32-correctly-rounded-divide-sqrt" : "",
             device->own_builtins ? OWN_BUILTINS : "");
    code = clBuildProgram(built, 1, &device->id, options, NULL, NULL);
    if (code != CL_SUCCESS) {
        status = fail_build(device, built, files, error);
        goto done;
    }
    *program = built;
    built = NULL;
done:
    if (built) clReleaseProgram(built);
    return status;
}

static tides_status build_once(const tides_device *device, const dialect *of, const char *files, const char *defines,
                               cl_program *program, tides_error *error) {
    td_source_text text = {0};
    tides_status status = gather_program(&text, device, of, files, defines, error);
    if (status == TIDES_OK) status = compile(device, &text, files, program, error);
    td_source_release(&text);
    return status;
}

/* Combines the logs of two builds, if they differ; `error` has the later one. */
static tides_status fail_both(const tides_error *before, tides_status status, tides_error *error) {
    if (!error || before->status != TIDES_DEVICE_FAILED || strcmp(before->text, error->text) == 0) return status;
    const tides_error now = *error;
    return td_fail(error, status, "%.550s; and before that, with kernels/builtins.h: %.400s", now.text, before->text);
}

/* Builds a program with its own declarations or, if that fails, with the driver's; later programs then use these, too.
 * Another PoCL may have an incompatible header, and changed kernels may call functions that aren't declared. That is slower,
 * with the same bits. If it fails as well, the declarations weren't the cause. */
static tides_status build(tides_device *device, const dialect *of, const char *files, const char *defines, cl_program *program,
                          tides_error *error) {
    tides_error before = {TIDES_OK, ""};
    const int own = device->own_builtins;
    if (own && build_once(device, of, files, defines, program, &before) == TIDES_OK) return TIDES_OK;
    device->own_builtins = 0;
    tides_status status = build_once(device, of, files, defines, program, error);
    if (status == TIDES_OK || !own) return status;
    device->own_builtins = own;
    return fail_both(&before, status, error);
}

static tides_status find_program(tides_device *device, const dialect *of, const char *files, const char *defines,
                                 cl_program *program, tides_error *error) {
    tides_status status = TIDES_NO_MEMORY;
    td_program_entry *entry = NULL;
    char *key = td_format(error, "%s\n%d lanes%s\n%s", files, of->lanes, of->is_double ? " of doubles" : "", defines);
    if (!key) return TIDES_NO_MEMORY;
    for (entry = device->programs; entry; entry = entry->next)
        if (strcmp(entry->key, key) == 0) {
            *program = entry->program;
            free(key);
            return TIDES_OK;
        }
    entry = td_alloc(1, sizeof *entry, error);
    if (!entry) goto done;
    if ((status = build(device, of, files, defines, &entry->program, error)) != TIDES_OK) goto done;
    *program = entry->program;
    entry->key = key;
    entry->next = device->programs;
    device->programs = entry;
    return TIDES_OK;
done:
    free(entry);
    free(key);
    return status;
}

static tides_status create_kernel(tides_device *device, const dialect *of, const char *files, const char *defines,
                                  const char *name, cl_kernel *kernel, tides_error *error) {
    cl_program program = NULL;
    cl_int code = CL_SUCCESS;
    tides_status status = td_check_forked(error);
    if (status != TIDES_OK) return status;
    pthread_mutex_lock(&device->building);
    status = find_program(device, of, files, defines, &program, error);
    pthread_mutex_unlock(&device->building);
    if (status != TIDES_OK) return status;
    cl_kernel made = clCreateKernel(program, name, &code);
    if (code != CL_SUCCESS) return td_cl_fail(error, code, "clCreateKernel");
    *kernel = made;
    return TIDES_OK;
}

tides_status td_kernel_create(tides_device *device, const char *files, const char *defines, const char *name, cl_kernel *kernel,
                              tides_error *error) {
    const dialect single = {0, (int)device->info.lanes};
    return create_kernel(device, &single, files, defines, name, kernel, error);
}

tides_status td_kernel_create_double(tides_device *device, const char *files, const char *defines, const char *name,
                                     cl_kernel *kernel, tides_error *error) {
    const dialect wide = {1, td_double_lanes(device)};
    if (!td_device_has_double(device))
        return td_fail(error, TIDES_UNSUPPORTED, "device '%.60s' has no double precision (cl_khr_fp64)", device->info.name);
    return create_kernel(device, &wide, files, defines, name, kernel, error);
}

void td_programs_release(tides_device *device) {
    while (device->programs) {
        td_program_entry *entry = device->programs;
        device->programs = entry->next;
        if (!td_is_forked()) clReleaseProgram(entry->program);
        free(entry->key);
        free(entry);
    }
}
