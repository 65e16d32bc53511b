/* tides view -o OUT.html: writes the library's page of an event file, and prints what the page leaves out. */
#include "view_page.h"

#include <math.h>

static int take_options(const cli_command *command, const cli_stretch *s, const char *most, tides_page_options *options) {
    double number = 0;
    tides_page_options_defaults(options);
    options->reading = &s->how;
    if (s->start_text) options->start_ns = s->start_ns;
    if (s->stop_text) options->stop_ns = s->stop_ns;
    options->window_ns = s->window_ns;
    if (!most) return CLI_GO;
    const int code = cli_number(command, "--max-events", most, &number);
    if (code != CLI_GO) return code;
    if (number < 1 || number > 1e12 || number != floor(number))
        return cli_usage(command, "--max-events %s: should be a whole number from 1 on", most);
    options->most = (uint64_t)number;
    return CLI_GO;
}

static int report(const char *out, const tides_page_report *r, const cli_common *common) {
    char events[24], seconds[CLI_SECONDS];
    if (r->ended && !common->quiet)
        fprintf(stderr,
                "tides: %s: ends at %s s with %s events, since there are more: --max-events N shows more, --start and --stop "
                "another stretch\n",
                out, cli_seconds(r->stop_ns, seconds), cli_count((double)r->events, events));
    if (!common->json) {
        if (!common->quiet)
            printf("%s: %s events of %d x %d px%s: open it in a browser\n", out, cli_count((double)r->events, events), r->width,
                   r->height, r->truth ? ", with depth, flow and instances" : "");
        return CLI_OK;
    }
    cJSON *facts = cJSON_CreateObject();
    cJSON_AddStringToObject(facts, "file", out);
    cJSON_AddStringToObject(facts, "kind", "page");
    cJSON_AddNumberToObject(facts, "width", r->width);
    cJSON_AddNumberToObject(facts, "height", r->height);
    cJSON_AddNumberToObject(facts, "events", (double)r->events);
    cli_add_ns(facts, "start_ns", r->start_ns);
    cli_add_ns(facts, "stop_ns", r->stop_ns);
    cJSON_AddBoolToObject(facts, "truth", r->truth);
    cJSON_AddBoolToObject(facts, "ended", r->ended);
    return cli_print_facts(facts, 1);
}

int view_page(const cli_command *command, const cli_stretch *stretch, const char *most, const char *out,
              const cli_common *common) {
    tides_page_options options;
    tides_page_report made;
    tides_error error = {TIDES_OK, ""};
    const int code = take_options(command, stretch, most, &options);
    if (code != CLI_GO) return code;
    cli_progress progress = {.quiet = common->quiet};
    const tides_status status =
        tides_page_write_file(stretch->file, out, &options, cli_progress_step, &progress, &made, &error);
    cli_progress_end(&progress);
    return status == TIDES_OK ? report(out, &made, common) : cli_fail(&error);
}
