/* Converts event files, for `tides convert` and `tides cut`, and prints the result. */
#include "event_job.h"

#include <stdio.h>
#include <string.h>

int cli_conversion_reading(const cli_command *command, const cli_reading *given, tides_event_conversion *what) {
    tides_event_reading how;
    const int code = cli_reading_parse(command, given, &how);
    what->from = how.format;
    what->columns = how.columns;
    what->unit = how.unit;
    what->stream = how.stream;
    what->drop_invalid = how.drop_invalid;
    what->rebase = how.rebase;
    what->offset_ns = how.offset_ns;
    return code;
}

static void tell_reading(const char *in, const tides_event_conversion_report *r, const tides_event_conversion *what,
                         const cli_common *common) {
    tides_event_facts facts = {.zero = r->zero, .zero_ns = r->zero_ns, .dropped = r->dropped};
    memcpy(facts.read_as, r->read_as, sizeof facts.read_as);
    cli_reading_tell(common, in, &facts, what->rebase);
}

static const char *const stages[TIDES_STAGES] = {"filtered_background", "filtered_activity", "filtered_afk", "filtered_trail",
                                                 "filtered_erc"};

static cJSON *report_json(const char *out, const tides_event_conversion_report *r) {
    cJSON *facts = cJSON_CreateObject();
    cJSON_AddStringToObject(facts, "file", out);
    cJSON_AddStringToObject(facts, "from", r->from);
    cJSON_AddStringToObject(facts, "to", r->to);
    cJSON_AddNumberToObject(facts, "width", r->width);
    cJSON_AddNumberToObject(facts, "height", r->height);
    cJSON_AddNumberToObject(facts, "events_read", (double)r->read);
    cJSON_AddNumberToObject(facts, "events", (double)r->written);
    cJSON_AddNumberToObject(facts, "disorder", (double)r->disorder);
    cJSON_AddNumberToObject(facts, "collapsed", (double)r->collapsed);
    cJSON_AddNumberToObject(facts, "first_ns", (double)r->first_ns);
    cJSON_AddNumberToObject(facts, "last_ns", (double)r->last_ns);
    cJSON_AddBoolToObject(facts, "labels_dropped", r->labels != 0);
    cJSON_AddNumberToObject(facts, "invalid_dropped", (double)r->dropped);
    for (int i = 0; i < TIDES_STAGES; i++)
        if (r->filtered[i]) cJSON_AddNumberToObject(facts, stages[i], (double)r->filtered[i]);
    if (r->read_as[0]) cJSON_AddStringToObject(facts, "read_as", r->read_as);
    return facts;
}

void cli_tell_collapsed(uint64_t collapsed) {
    if (collapsed)
        fprintf(stderr,
                "tides: %llu events share their pixel and their microsecond with an earlier one: .h5 keeps nanoseconds\n",
                (unsigned long long)collapsed);
}

int cli_event_convert(const char *in, const char *out, const tides_event_conversion *what, const cli_common *common) {
    tides_error error = {TIDES_OK, ""};
    tides_event_conversion_report report;
    cli_progress progress = {.quiet = common->quiet};
    cli_catch_interrupt();
    tides_status status = tides_events_convert(in, out, what, cli_progress_step, &progress, &report, &error);
    cli_progress_end(&progress);
    if (status != TIDES_OK) return cli_fail(&error);
    tell_reading(in, &report, what, common);
    if (common->json) return cli_print_facts(report_json(out, &report), 1);
    if (common->quiet) return CLI_OK;
    printf("%s: %llu of %llu events, %s to %s, %d x %d px\n", out, (unsigned long long)report.written,
           (unsigned long long)report.read, report.from, report.to, report.width, report.height);
    if (report.disorder) printf("%llu events were out of order, and were put in order\n", (unsigned long long)report.disorder);
    for (int i = 0; i < TIDES_STAGES; i++)
        if (report.filtered[i]) printf("%-20s %llu events\n", stages[i], (unsigned long long)report.filtered[i]);
    cli_tell_collapsed(report.collapsed);
    if (report.labels) fprintf(stderr, "tides: the labels of %s aren't kept\n", in);
    return CLI_OK;
}

int cli_size(const cli_command *command, const char *option, const char *text, int32_t *size) {
    double number;
    int code = cli_number(command, option, text, &number);
    if (code != CLI_GO) return code;
    if (!(number >= 1 && number <= 65536) || number != (double)(int32_t)number)
        return cli_usage(command, "%s %s: not a number of pixels", option, text);
    *size = (int32_t)number;
    return CLI_GO;
}

void cli_help_formats(void) {
    tides_event_format format;
    printf("\nformats of event files (--from, --to):\n");
    for (size_t i = 0; tides_event_format_at(i, &format); i++)
        printf("  %-11s %s%s%s%s\n", format.name, format.summary, format.writes ? "" : "; read only",
               format.endings[0] ? ": " : "", format.endings);
}

void cli_help_scenes(void) {
    tides_scene_format format;
    printf("\nformats of scenes:\n");
    for (size_t i = 0; tides_scene_format_at(i, &format); i++)
        printf("  %-14s %s%s\n", format.endings, format.summary, format.writes ? "" : "; read only");
    printf("  %-14s %s\n", "a folder", "of a trained model; read only");
}
