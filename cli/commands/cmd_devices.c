/* tides devices: lists the OpenCL devices, and which one a run would use. */
#include "cli.h"

#include <stdio.h>
#include <stdlib.h>

static const char *kind_name(int32_t kind) {
    switch (kind) {
        case TIDES_DEVICE_CPU: return "cpu";
        case TIDES_DEVICE_GPU: return "gpu";
        case TIDES_DEVICE_REFERENCE: return "reference";
        default: return "other";
    }
}

static cJSON *row_json(const tides_device_info *row, int32_t used) {
    cJSON *json = cJSON_CreateObject();
    if (row->index >= 0)
        cJSON_AddNumberToObject(json, "index", row->index);
    else
        cJSON_AddNullToObject(json, "index");
    cJSON_AddStringToObject(json, "kind", kind_name(row->kind));
    cJSON_AddStringToObject(json, "name", row->name);
    cJSON_AddStringToObject(json, "platform", row->platform);
    cJSON_AddStringToObject(json, "driver", row->driver);
    cJSON_AddNumberToObject(json, "compute_units", row->compute_units);
    cJSON_AddNumberToObject(json, "lanes", row->lanes);
    cJSON_AddNumberToObject(json, "vector_bits", row->vector_bits);
    cJSON_AddBoolToObject(json, "fused", row->fused);
    cJSON_AddNumberToObject(json, "memory_bytes", (double)row->memory_bytes);
    cJSON_AddBoolToObject(json, "used", used);
    return json;
}

/* The instruction set of this processor that has vectors of so many bits. */
static const char *vectors_name(int32_t bits) {
#if defined(__x86_64__)
    return bits == 512 ? "AVX-512" : bits == 256 ? "AVX" : bits == 128 ? "SSE" : "";
#elif defined(__aarch64__)
    return bits == 128 ? "NEON" : bits > 128 ? "SVE" : "";
#else
    (void)bits;
    return "";
#endif
}

/* Vectors belong to this machine's processor; GPUs have none. */
static void print_vectors(const tides_device_info *row) {
    if (row->vector_bits == 0 || (row->kind != TIDES_DEVICE_CPU && row->kind != TIDES_DEVICE_REFERENCE)) return;
    const char *name = vectors_name(row->vector_bits);
    printf(", vectors of %d bits%s%s%s", row->vector_bits, *name ? " (" : "", name, *name ? ")" : "");
}

static void print_row(const tides_device_info *row, int32_t used) {
    char index[16] = "-";
    if (row->index >= 0) snprintf(index, sizeof index, "%d", row->index);
    printf("%c %-5s %-9s %-40s %s", used ? '*' : ' ', index, kind_name(row->kind), row->name, row->platform);
    if (row->index >= 0)
        printf(", %d compute units, %d lanes", row->compute_units, row->lanes);
    else
        printf(", %s", row->driver);
    print_vectors(row);
    if (row->index >= 0)
        printf(", %.3g GiB%s", (double)row->memory_bytes / 1073741824.0, row->fused ? "" : ", no fma: not the others' bits");
    putchar('\n');
}

/* Adds the reference behind the last row. */
static tides_status list_reference(tides_device_info *row, tides_error *error) {
    tides_device *reference = NULL;
    const tides_status status = tides_device_open("reference", &reference, error);
    if (status == TIDES_OK) tides_device_describe(reference, row);
    tides_device_close(reference);
    return status;
}

/* Lists all devices, and the reference in the row behind them; the caller frees `rows`. */
static tides_status list(tides_device_info **rows, int32_t *count, tides_error *error) {
    int32_t exist = 0, again = 0;
    tides_status status = tides_device_list(NULL, 0, &exist, error);
    if (status != TIDES_OK) return status;
    tides_device_info *made = calloc((size_t)exist + 1, sizeof *made);
    if (!made) return cli_error(error, TIDES_NO_MEMORY, "out of memory: %d devices", exist);
    status = tides_device_list(made, exist, &again, error);
    *count = exist < again ? exist : again;
    if (status == TIDES_OK) status = list_reference(&made[*count], error);
    if (status != TIDES_OK) {
        free(made);
        return status;
    }
    *rows = made;
    return TIDES_OK;
}

int cmd_devices(const cli_command *command, int argc, char **argv) {
    cli_common common;
    const cli_option options[] = {{NULL, 0, NULL, NULL, NULL, NULL, NULL}};
    int code = cli_parse(command, options, argc, argv, &common, NULL);
    if (code != CLI_GO) return code;

    tides_error error = {TIDES_OK, ""};
    tides_device_info *rows = NULL, used = {.kind = 0};
    int32_t count = 0;
    if (list(&rows, &count, &error) != TIDES_OK || !rows) return cli_fail(&error);
    tides_device *device = NULL;
    const tides_status opened = tides_device_open(common.device, &device, &error);
    if (opened == TIDES_OK) tides_device_describe(device, &used);

    cJSON *facts = common.json ? cJSON_CreateArray() : NULL;
    for (int32_t i = 0; i <= count; i++) { /* the reference is the row behind the last */
        const int32_t is_used = opened == TIDES_OK && rows[i].index == used.index;
        if (facts)
            cJSON_AddItemToArray(facts, row_json(&rows[i], is_used));
        else if (!common.json && !common.quiet && i == 0)
            printf("  index kind      name\n");
        if (!common.json && !common.quiet) print_row(&rows[i], is_used);
    }
    code = common.json ? cli_print_facts(facts, 1) : CLI_OK;
    if (opened != TIDES_OK) code = cli_fail(&error);
    tides_device_close(device);
    free(rows);
    return code;
}
