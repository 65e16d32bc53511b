/* tides dataset: writes a run, with all cameras of its rig, to a folder in a dataset's layout. */
#include "session.h"

#include <stdio.h>
#include <string.h>

static void help_layouts(void) {
    tides_dataset_layout layout;
    printf("\nlayouts (--layout):\n");
    for (size_t i = 0; tides_dataset_layout_at(i, &layout); i++)
        printf("  %-11s %s%s\n", layout.name, layout.summary, layout.metric ? " (needs scene.metres_per_unit)" : "");
}

/* Joins the names with commas; the library checks them. */
static int join(const cli_list *layouts, char *text, size_t size) {
    size_t used = 0;
    for (size_t i = 0; i < (size_t)layouts->count; i++) {
        const int written = snprintf(text + used, size - used, "%s%s", i ? "," : "", layouts->items[i]);
        if (written < 0 || (size_t)written >= size - used) return 0;
        used += (size_t)written;
    }
    return 1;
}

static cJSON *facts_of(const char *folder, const tides_dataset_report *report) {
    cJSON *facts = cJSON_CreateObject();
    cJSON_AddStringToObject(facts, "folder", folder);
    cJSON_AddNumberToObject(facts, "cameras", report->cameras);
    cJSON_AddNumberToObject(facts, "unseeing", report->unseeing);
    cJSON_AddNumberToObject(facts, "events", (double)report->events);
    cJSON_AddNumberToObject(facts, "pictures", report->pictures);
    cJSON_AddNumberToObject(facts, "truths", report->truths);
    cJSON_AddNumberToObject(facts, "poses", report->poses);
    return facts;
}

int cmd_dataset(const cli_command *command, int argc, char **argv) {
    cli_common common;
    cli_list sets = {.count = 0}, layouts = {.count = 0};
    const char *run = NULL, *output = NULL;
    const cli_option options[] = {
        {"--output", 'o', "DIR", "the dataset's folder, which must not be there yet (required)", NULL, &output, NULL},
        {"--layout", 0, "LAYOUT", "whose layout; may be repeated: each gets a folder in DIR (dataset.layout)", NULL, NULL,
         &layouts},
        {"--set", 0, "KEY=VALUE", "override a key of the run file; may be repeated", NULL, NULL, &sets},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &run);
    if (code == CLI_OK) help_layouts();
    if (code != CLI_GO) return code;
    char names[256];
    if (!output) return cli_usage(command, "the output is missing: -o DIR");
    if (!join(&layouts, names, sizeof names)) return cli_usage(command, "--layout: too many names");

    tides_error error = {TIDES_OK, ""};
    tides_session *session = NULL;
    tides_dataset_report report;
    const cli_output written = {output, NULL};
    if (cli_session_open(run, &sets, &common, &written, 1, &session, &error) != TIDES_OK) return cli_fail(&error);
    tides_session_facts facts;
    tides_session_get(session, &facts);
    const char *wanted = layouts.count ? names : facts.values.dataset_layout;
    if (!wanted) {
        tides_session_close(session);
        return cli_usage(command, "the layout is missing: --layout dsec, or dataset.layout in the run file");
    }
    cli_progress progress = {.quiet = common.quiet};
    cli_catch_interrupt();
    const tides_status status = tides_dataset_write(session, output, wanted, cli_progress_step, &progress, &report, &error);
    cli_progress_end(&progress);
    char who[40] = "";
    if (status == TIDES_OK && report.cameras > 1)
        snprintf(who, sizeof who, " of %d of %d cameras", (int)report.unseeing, (int)report.cameras);
    if (status == TIDES_OK && report.unseeing) cli_tell_unseen(&common, who);
    code = status == TIDES_OK ? cli_report_facts(facts_of(output, &report), &common) : cli_fail(&error);
    tides_session_close(session);
    return code;
}
