/* Reading a stretch of a recording. */
#include "recording.h"

/* Differences of times have to fit 64 bits: 63 years, as for metrics. */
static const int64_t time_limit = INT64_C(2000000000000000000);

static int take_time(const cli_command *command, const char *option, const char *text, int64_t *ns) {
    if (!text) return CLI_GO;
    const int code = cli_time(command, option, text, ns);
    if (code != CLI_GO || (*ns <= time_limit && *ns >= -time_limit)) return code;
    return cli_usage(command, "%s %s: is beyond 63 years", option, text);
}

/* A length of time above 0. */
static int take_length(const cli_command *command, const char *option, const char *text, int64_t *ns) {
    const int code = take_time(command, option, text, ns);
    if (code != CLI_GO || !text || *ns > 0) return code;
    return cli_usage(command, "%s %s: should be above 0", option, text);
}

int cli_stretch_parse(const cli_command *command, cli_stretch *s) {
    int code = take_time(command, "--start", s->start_text, &s->start_ns);
    if (code == CLI_GO) code = take_time(command, "--stop", s->stop_text, &s->stop_ns);
    if (code == CLI_GO) code = take_length(command, "--window", s->window_text, &s->window_ns);
    if (code == CLI_GO) code = take_length(command, "--step", s->step_text, &s->step_ns);
    if (code != CLI_GO) return code;
    if (s->start_text && s->stop_text && s->start_ns >= s->stop_ns)
        return cli_usage(command, "--start %s isn't before --stop %s", s->start_text, s->stop_text);
    if (s->step_ns == 0) s->step_ns = s->window_ns;
    return CLI_GO;
}

tides_status cli_stretch_read(cli_stretch *s, cli_window *recording, tides_error *error) {
    *recording = (cli_window){.first_ns = INT64_MIN, .stop_ns = INT64_MAX, .format = s->format};
    if (s->start_text) recording->first_ns = s->start_ns - s->before_ns;
    if (s->stop_text) recording->stop_ns = s->stop_ns;
    tides_status status = cli_window_read(s->file, recording, error);
    if (status == TIDES_OK) status = cli_window_ordered(s->file, recording, error);
    if (status != TIDES_OK) return status;
    const tides_event *events = recording->events;
    const size_t count = recording->count;
    if (count && (events[0].t < -time_limit || events[count - 1].t > time_limit))
        return cli_error(error, TIDES_BAD_FILE,
                         "%s: its times go beyond 63 years: tides convert --rebase counts from the first event", s->file);
    const int64_t last = count ? events[count - 1].t + 1 : INT64_MIN;
    const int32_t known = s->of_run && recording->run_start_ns < recording->run_stop_ns;
    if (!s->start_text) s->start_ns = known ? recording->run_start_ns : count ? events[0].t : s->stop_text ? s->stop_ns : 0;
    if (!s->stop_text)
        s->stop_ns = known && last < recording->run_stop_ns ? recording->run_stop_ns : count ? last : s->start_ns;
    if (s->start_ns > s->stop_ns) s->start_ns = s->stop_ns; /* all events lie before a start that was given */
    return TIDES_OK;
}
