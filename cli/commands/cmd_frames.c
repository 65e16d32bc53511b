/* tides frames: what an ordinary camera in the event camera's place would record. */
#include "session.h"

int cmd_frames(const cli_command *command, int argc, char **argv) {
    cli_common common;
    cli_list sets = {.count = 0};
    const char *run = NULL, *folder = NULL;
    const cli_option options[] = {
        {"--output", 'o', "DIR", "folder of numbered pictures and their times", NULL, &folder, NULL},
        {"--set", 0, "KEY=VALUE", "override a key of the run file; may be repeated", NULL, NULL, &sets},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &run);
    if (code != CLI_GO) return code;
    if (!folder) return cli_usage(command, "the output is missing: -o DIR");

    tides_error error = {TIDES_OK, ""};
    tides_session *session = NULL;
    tides_session_taken taken = {0};
    cli_progress progress = {.quiet = common.quiet};
    if (cli_session_open(run, &sets, &common, &session, &error) != TIDES_OK) return cli_fail(&error);
    cli_catch_interrupt();
    const tides_status status = tides_session_frames(session, folder, cli_progress_step, &progress, &taken, &error);
    cli_progress_end(&progress);
    tides_session_close(session);
    if (status != TIDES_OK) return cli_fail(&error);
    cJSON *facts = cJSON_CreateObject();
    cJSON_AddStringToObject(facts, "folder", folder);
    cJSON_AddNumberToObject(facts, "frames", (double)taken.count);
    cJSON_AddNumberToObject(facts, "renders", taken.renders);
    cJSON_AddNumberToObject(facts, "error", taken.error);
    cJSON_AddNumberToObject(facts, "unsettled_pixels", (double)taken.unsettled);
    return cli_report_facts(facts, &common);
}
