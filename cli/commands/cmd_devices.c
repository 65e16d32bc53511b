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
    cJSON_AddBoolToObject(json, "fused", row->fused);
    cJSON_AddNumberToObject(json, "memory_bytes", (double)row->memory_bytes);
    cJSON_AddBoolToObject(json, "used", used);
    return json;
}

static void print_row(const tides_device_info *row, int32_t used) {
    char index[16] = "-";
    if (row->index >= 0) snprintf(index, sizeof index, "%d", row->index);
    printf("%c %-5s %-9s %-40s %s", used ? '*' : ' ', index, kind_name(row->kind), row->name, row->platform);
    if (row->index >= 0)
        printf(", %d compute units, %d lanes, %.3g GiB%s", row->compute_units, row->lanes,
               (double)row->memory_bytes / 1073741824.0, row->fused ? "" : ", no fma: not the others' bits");
    putchar('\n');
}

/* Lists all devices; the caller frees `rows`. */
static tides_status list(tides_device_info **rows, int32_t *count, tides_error *error) {
    int32_t exist = 0, again = 0;
    tides_status status = tides_device_list(NULL, 0, &exist, error);
    if (status != TIDES_OK) return status;
    tides_device_info *made = calloc((size_t)exist + 1, sizeof *made);
    if (!made) return cli_error(error, TIDES_NO_MEMORY, "out of memory: %d devices", exist);
    status = tides_device_list(made, exist, &again, error);
    if (status != TIDES_OK) {
        free(made);
        return status;
    }
    made[exist < again ? exist : again] =
        (tides_device_info){.kind = TIDES_DEVICE_REFERENCE, .index = -1, .lanes = 1, .fused = 1};
    *count = exist < again ? exist : again;
    snprintf(made[*count].name, sizeof made[*count].name, "reference");
    snprintf(made[*count].platform, sizeof made[*count].platform, "scalar C in double precision, no OpenCL");
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
