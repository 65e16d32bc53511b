/* Finds, opens and describes devices by a SPEC string (the user's name for a device). */
#include "td_advice.h"
#include "td_drivers.h"
#include "td_device.h"
#include "td_forked.h"
#include "td_near.h"
#include "td_pool.h"
#include "td_wide.h"

#include <ctype.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* More than machines have; further devices aren't listed. */
enum { MAX_PLATFORMS = 16, MAX_DEVICES = 64 };

/* All devices that can be opened, in the order of their indices. */
typedef struct device_list {
    tides_device_info info[MAX_DEVICES];
    cl_platform_id platform[MAX_DEVICES];
    cl_device_id id[MAX_DEVICES];
    int32_t count;
} device_list;

static int32_t kind_of(cl_device_id id) {
    cl_device_type type = 0;
    clGetDeviceInfo(id, CL_DEVICE_TYPE, sizeof type, &type, NULL);
    if (type & CL_DEVICE_TYPE_GPU) return TIDES_DEVICE_GPU;
    return type & CL_DEVICE_TYPE_CPU ? TIDES_DEVICE_CPU : TIDES_DEVICE_OTHER;
}

static int is_rusticl(const tides_device_info *info) { return strcmp(info->platform, "rusticl") == 0; }
static int is_pocl(const tides_device_info *info) { return strcmp(info->platform, "Portable Computing Language") == 0; }

/* Pixels per work-item. On a CPU it is a 4x4 block: a vector of sixteen hides latency, even as two halves. On a GPU it is
 * one, and also where a driver vectorises work-items itself, as rusticl does on llvmpipe. On NEON a block takes four of 32
 * registers, so that eight such vectors fit, as with AVX2; this wasn't measured. */
static int32_t lanes_of(const tides_device_info *info) { return info->kind == TIDES_DEVICE_CPU && !is_rusticl(info) ? 16 : 1; }

/* Lanes in double precision: the width of a register, eight with AVX-512, else four. With eight lanes on registers of four,
 * each vector takes two of sixteen registers, and points take 1.4 times as long: a third of that moves vectors to memory and
 * back. */
static int double_lanes_of(cl_device_id id) {
    cl_uint width = 0;
    clGetDeviceInfo(id, CL_DEVICE_NATIVE_VECTOR_WIDTH_DOUBLE, sizeof width, &width, NULL);
    return width >= 8 ? 8 : 4;
}

static int32_t vector_bits_of(cl_device_id id) {
    cl_uint width = 0;
    clGetDeviceInfo(id, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT, sizeof width, &width, NULL);
    return (int32_t)(width * sizeof(cl_float) * CHAR_BIT);
}

/* 1 if kernels may use fma(). Mesa inlines a software fma() of some hundred instructions at each call. On llvmpipe (Mesa
 * 22.3) kernels compiled for over three minutes without end, in 1.3 GB; with sixteen lanes for twenty minutes, in 7 GB.
 * Without fma() all kernels of a run take 20 to 40 s and 0.4 GB, and events are within 32 ns of the reference's. Other
 * drivers' software fma() is a function call. */
static int32_t is_fused(cl_device_id id, const tides_device_info *info) {
    cl_device_fp_config single = 0;
    clGetDeviceInfo(id, CL_DEVICE_SINGLE_FP_CONFIG, sizeof single, &single, NULL);
    return !is_rusticl(info) || (single & CL_FP_FMA) != 0;
}

static void describe(cl_platform_id platform, cl_device_id id, int32_t index, tides_device_info *info) {
    memset(info, 0, sizeof *info);
    char version[256] = "", driver[60] = ""; /* PoCL's version has 64 characters with AVX-512 */
    cl_uint units = 0;
    cl_ulong memory = 0;
    info->kind = kind_of(id);
    info->index = index;
    clGetDeviceInfo(id, CL_DEVICE_NAME, sizeof info->name - 1, info->name, NULL);
    clGetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof info->platform - 1, info->platform, NULL);
    info->lanes = lanes_of(info);
    info->vector_bits = vector_bits_of(id);
    info->fused = is_fused(id, info);
    clGetDeviceInfo(id, CL_DEVICE_VERSION, sizeof version - 1, version, NULL);
    clGetDeviceInfo(id, CL_DRIVER_VERSION, sizeof driver - 1, driver, NULL);
    snprintf(info->driver, sizeof info->driver, "%.70s, driver %.47s", version, driver);
    clGetDeviceInfo(id, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units, NULL);
    clGetDeviceInfo(id, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof memory, &memory, NULL);
    info->compute_units = units > 0 ? (int32_t)units : 1; /* unknown, but at least one */
    info->memory_bytes = memory;
}

/* Lists all platforms' devices. Without any platform, the list is empty: the ICD loader reports that by a code of its own
 * (-1001). */
static void ask_all(device_list *list) {
    cl_platform_id platforms[MAX_PLATFORMS];
    cl_uint platform_count = 0;
    list->count = 0;
    if (clGetPlatformIDs(MAX_PLATFORMS, platforms, &platform_count) != CL_SUCCESS) return;
    if (platform_count > MAX_PLATFORMS) platform_count = MAX_PLATFORMS;
    for (cl_uint p = 0; p < platform_count; p++) {
        cl_device_id ids[MAX_DEVICES];
        cl_uint count = 0;
        if (clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, MAX_DEVICES, ids, &count) != CL_SUCCESS) continue;
        for (cl_uint d = 0; d < count && list->count < MAX_DEVICES; d++) {
            int32_t at = list->count++;
            list->platform[at] = platforms[p];
            list->id[at] = ids[d];
            describe(platforms[p], ids[d], at, &list->info[at]);
        }
    }
}

/* Lists the devices; one thread at a time. The first call makes the loader load the drivers, and ocl-icd 2.3 and PoCL 3.1
 * don't support two first calls at once: in 3 of 10 tries a thread found no device, or the driver ended the process. */
static tides_status enumerate(device_list *list, tides_error *error) {
    tides_status status = td_check_forked(error);
    if (status != TIDES_OK) return status;
    td_drivers_lock();
    ask_all(list);
    td_drivers_unlock();
    return TIDES_OK;
}

tides_status tides_device_list(tides_device_info *rows, int32_t capacity, int32_t *count, tides_error *error) {
    if (!count || capacity < 0 || (capacity > 0 && !rows))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_device_list: rows must hold capacity >= 0 entries and count be given");
    device_list *list = td_alloc(1, sizeof *list, error);
    if (!list) return TIDES_NO_MEMORY;
    tides_status status = enumerate(list, error);
    for (int32_t i = 0; status == TIDES_OK && i < list->count && i < capacity; i++) rows[i] = list->info[i];
    if (status == TIDES_OK) *count = list->count;
    free(list);
    return status;
}

/* 1 if `text` contains `part`, in any case. */
static int contains(const char *text, const char *part) {
    size_t length = strlen(part);
    for (; *text; text++) {
        size_t i = 0;
        while (i < length && text[i] && tolower((unsigned char)text[i]) == tolower((unsigned char)part[i])) i++;
        if (i == length) return 1;
    }
    return 0;
}

static int32_t first_of_kind(const device_list *list, int32_t kind) {
    for (int32_t i = 0; i < list->count; i++)
        if (list->info[i].kind == kind) return i;
    return -1;
}

/* The entry of the list that `spec` names; -1 for none. */
static int32_t match(const device_list *list, const char *spec) {
    if (strcmp(spec, "cpu") == 0) return first_of_kind(list, TIDES_DEVICE_CPU);
    if (strcmp(spec, "gpu") == 0) return first_of_kind(list, TIDES_DEVICE_GPU);
    if (strcmp(spec, "auto") == 0) {
        int32_t gpu = first_of_kind(list, TIDES_DEVICE_GPU);
        return gpu >= 0 ? gpu : first_of_kind(list, TIDES_DEVICE_CPU);
    }
    char *end;
    long index = strtol(spec, &end, 10);
    if (*spec && !*end) return index >= 0 && index < list->count ? (int32_t)index : -1;
    for (int32_t i = 0; i < list->count; i++)
        if (contains(list->info[i].name, spec) || contains(list->info[i].platform, spec)) return i;
    return -1;
}

/* The error for a SPEC without a match: lists the devices, or says how to get one. */
static tides_status fail_no_match(const device_list *list, const char *spec, tides_error *error) {
    char suggestion[TD_SUGGESTION_MAX];
    td_suggest(spec, "auto cpu gpu reference reference-f32", " ", suggestion);
    const int is_kind = strcmp(spec, "auto") == 0 || strcmp(spec, "cpu") == 0 || strcmp(spec, "gpu") == 0;
    if (is_kind) suggestion[0] = '\0'; /* the spec is spelt right, but no such device exists */
    char trouble[TD_TROUBLE_MAX];
    if (list->count == 0 && td_driver_trouble(trouble)[0])
        return td_fail(error, TIDES_NO_DEVICE, "device '%s': no OpenCL device was found: %s; or use --device reference%s", spec,
                       trouble, suggestion);
    if (list->count == 0)
        return td_fail(error, TIDES_NO_DEVICE,
                       "device '%s': no OpenCL device was found; install one (%s%s) or use --device reference%s", spec,
                       td_device_advice(TD_OS_RELEASE), TD_ADVICE_PIP, suggestion);
    char names[600] = "";
    for (int32_t i = 0; i < list->count; i++) {
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%d = %.60s (%.40s)", i ? ", " : "", i, list->info[i].name,
                 list->info[i].platform);
    }
    return td_fail(error, TIDES_NO_DEVICE, "device '%s': nothing matches; there are: %s, and 'reference'%s", spec, names,
                   suggestion);
}

int td_device_is_double(const tides_device *device) {
    return device->info.kind == TIDES_DEVICE_REFERENCE && !device->single_precision;
}

static void open_reference(tides_device *device, int single_precision) {
    device->single_precision = single_precision;
    device->info.kind = TIDES_DEVICE_REFERENCE;
    device->info.index = -1;
    device->info.lanes = 1;
    device->info.vector_bits = td_wide_bits();
    device->info.fused = 1;
    device->info.compute_units = 1;
    snprintf(device->info.name, sizeof device->info.name, "%s", single_precision ? "reference-f32" : "reference");
    snprintf(device->info.platform, sizeof device->info.platform, "scalar C");
    snprintf(device->info.driver, sizeof device->info.driver, "%s precision, no OpenCL",
             single_precision ? "single" : "double");
}

static tides_status open_opencl(tides_device *device, const char *spec, tides_error *error) {
    tides_status status = TIDES_OK;
    cl_int code = CL_SUCCESS;
    cl_device_fp_config rounding = 0, wide = 0;
    device_list *list = td_alloc(1, sizeof *list, error);
    if (!list) return TIDES_NO_MEMORY;
    int32_t at = -1;
    if ((status = enumerate(list, error)) != TIDES_OK) goto done;
    at = match(list, spec);
    if (at < 0) {
        status = fail_no_match(list, spec, error);
        goto done;
    }
    device->info = list->info[at];
    device->platform = list->platform[at];
    device->id = list->id[at];
    clGetDeviceInfo(device->id, CL_DEVICE_SINGLE_FP_CONFIG, sizeof rounding, &rounding, NULL);
    clGetDeviceInfo(device->id, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof wide, &wide, NULL);
    device->has_double = wide != 0;
    device->double_lanes = double_lanes_of(device->id);
    device->near = td_near_is_had(device->id, device->info.kind);
    device->own_builtins = is_pocl(&device->info);
    device->correctly_rounded = (rounding & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
    device->context = clCreateContext(NULL, 1, &device->id, NULL, NULL, &code);
    if (code != CL_SUCCESS) {
        status = td_cl_fail(error, code, "clCreateContext");
        goto done;
    }
    device->queue = clCreateCommandQueue(device->context, device->id, CL_QUEUE_PROFILING_ENABLE, &code);
    if (code != CL_SUCCESS) status = td_cl_fail(error, code, "clCreateCommandQueue");
done:
    free(list);
    return status;
}

tides_status tides_device_set_threads(tides_device *device, int32_t threads, tides_error *error) {
    if (!device || threads < 0 || threads > TD_POOL_MOST)
        return td_fail(error, TIDES_BAD_ARGUMENT, "threads: %d is not from 0 (as many as there are processors) to %d",
                       (int)threads, (int)TD_POOL_MOST);
    device->threads = threads;
    return TIDES_OK;
}

int32_t tides_device_threads(const tides_device *device) { return device->threads; }

/* Sets the number of threads from the environment. */
static tides_status take_threads(tides_device *device, tides_error *error) {
    const char *asked = getenv("TIDES_THREADS");
    char *end = NULL;
    if (!asked || !*asked) return TIDES_OK;
    const long threads = strtol(asked, &end, 10);
    if (*end || threads < 0 || threads > TD_POOL_MOST)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "TIDES_THREADS: \"%.40s\" is not from 0 (as many as there are processors) to %d", asked,
                       (int)TD_POOL_MOST);
    device->threads = (int)threads;
    return TIDES_OK;
}

tides_status tides_device_open(const char *spec, tides_device **device, tides_error *error) {
    if (!device) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_device_open: device must not be NULL");
    if (!spec || !*spec) spec = getenv("TIDES_DEVICE");
    if (!spec || !*spec) spec = "auto";
    tides_device *opened = td_alloc(1, sizeof *opened, error);
    if (!opened) return TIDES_NO_MEMORY;
    if (pthread_mutex_init(&opened->building, NULL)) {
        free(opened);
        return td_fail(error, TIDES_NO_MEMORY, "out of memory for a device's lock");
    }
    tides_status status = take_threads(opened, error);
    if (strcmp(spec, "reference") == 0)
        open_reference(opened, 0);
    else if (strcmp(spec, "reference-f32") == 0)
        open_reference(opened, 1);
    else if (status == TIDES_OK)
        status = open_opencl(opened, spec, error);
    if (status != TIDES_OK) {
        tides_device_close(opened);
        return status;
    }
    *device = opened;
    return TIDES_OK;
}

void tides_device_close(tides_device *device) {
    if (!device) return;
    td_programs_release(device);
    if (device->queue && !td_is_forked()) clReleaseCommandQueue(device->queue);
    if (device->context && !td_is_forked()) clReleaseContext(device->context);
    pthread_mutex_destroy(&device->building);
    free(device);
}

void tides_device_describe(const tides_device *device, tides_device_info *info) { *info = device->info; }
