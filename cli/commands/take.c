/* The common part of `tides frames`, `tides imu` and `tides tracks`: each reads a run file, writes one output, and prints how
 * much it wrote. */
#include "take.h"

static int take(const cli_take *what, tides_session *session, const char *output, const cli_common *common) {
    tides_error error = {TIDES_OK, ""};
    tides_session_taken taken = {0};
    cli_progress progress = {.quiet = common->quiet};
    cli_catch_interrupt();
    const tides_status status = what->take(session, output, cli_progress_step, &progress, &taken, &error);
    cli_progress_end(&progress);
    if (status != TIDES_OK) return cli_fail(&error);
    if (what->renders && taken.pairs == 0) cli_tell_unseen(common, "");
    cJSON *facts = cJSON_CreateObject();
    cJSON_AddStringToObject(facts, "output", output);
    cJSON_AddNumberToObject(facts, what->count, (double)taken.count);
    if (what->report) what->report(facts, &taken);
    return cli_report_facts(facts, common);
}

int cli_take_run(const cli_command *command, int argc, char **argv, const cli_take *what) {
    cli_common common;
    cli_list sets = {.count = 0};
    const char *run = NULL, *output = NULL;
    const cli_option options[] = {
        {"--output", 'o', what->output, what->help, NULL, &output, NULL},
        {"--set", 0, "KEY=VALUE", "override a key of the run file; may be repeated", NULL, NULL, &sets},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &run);
    if (code != CLI_GO) return code;
    if (!output) return cli_usage(command, "the output is missing: -o %s", what->output);
    tides_error error = {TIDES_OK, ""};
    tides_session *session = NULL;
    const cli_output written = {output, NULL};
    if (cli_session_open(run, &sets, &common, &written, 1, &session, &error) != TIDES_OK) return cli_fail(&error);
    code = take(what, session, output, &common);
    tides_session_close(session);
    return code;
}
