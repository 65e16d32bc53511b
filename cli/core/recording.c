/* Reading a stretch of a recording. */
#include "recording.h"

/* [ns] Differences of times must fit in 64 bits: 63 years. */
static const int64_t time_limit = INT64_C(2000000000000000000);

static int take_time(const cli_command *command, const char *option, const char *text, int64_t *ns) {
    if (!text) return CLI_GO;
    const int code = cli_time(command, option, text, ns);
    if (code != CLI_GO || (*ns <= time_limit && *ns >= -time_limit)) return code;
    return cli_usage(command, "%s %s: is beyond 63 years", option, text);
}

/* Parses a time above 0. */
static int take_length(const cli_command *command, const char *option, const char *text, int64_t *ns) {
    const int code = take_time(command, option, text, ns);
    if (code != CLI_GO || !text || *ns > 0) return code;
    return cli_usage(command, "%s %s: should be above 0", option, text);
}

int cli_stretch_parse(const cli_command *command, cli_stretch *s) {
    int code = cli_reading_parse(command, &s->reading, &s->how);
    if (code == CLI_GO) code = take_time(command, "--start", s->start_text, &s->start_ns);
    if (code == CLI_GO) code = take_time(command, "--stop", s->stop_text, &s->stop_ns);
    if (code == CLI_GO) code = take_length(command, "--window", s->window_text, &s->window_ns);
    if (code == CLI_GO) code = take_length(command, "--step", s->step_text, &s->step_ns);
    if (code != CLI_GO) return code;
    if (s->start_text && s->stop_text && s->start_ns >= s->stop_ns)
        return cli_usage(command, "--start %s isn't before --stop %s", s->start_text, s->stop_text);
    if (s->step_ns == 0) s->step_ns = s->window_ns;
    return CLI_GO;
}

/* Sets a start and stop that weren't given: to the recording's interval where the file has one, else to that of its events. */
static void fill_in(cli_stretch *s, const cli_window *recording) {
    const tides_event *events = recording->events;
    const size_t count = recording->count;
    const int64_t last = count ? events[count - 1].t + 1 : INT64_MIN;
    const int32_t known = s->of_run && recording->run_start_ns < recording->run_stop_ns;
    if (!s->start_text) s->start_ns = known ? recording->run_start_ns : count ? events[0].t : s->stop_text ? s->stop_ns : 0;
    if (!s->stop_text)
        s->stop_ns = known && last < recording->run_stop_ns ? recording->run_stop_ns : count ? last : s->start_ns;
    if (s->start_ns > s->stop_ns) s->start_ns = s->stop_ns; /* the given start is after all events */
}

/* Refuses too many windows: times of another clock would give 10^10 of them, all empty. */
static tides_status check_windows(const cli_stretch *s, tides_error *error) {
    const uint64_t length = (uint64_t)s->stop_ns - (uint64_t)s->start_ns, step = (uint64_t)s->step_ns;
    if (step == 0 || !s->windows_most || length / step <= s->windows_most) return TIDES_OK;
    return cli_error(error, TIDES_BAD_ARGUMENT,
                     "%s: from %.15g to %.15g s there would be %.3g windows: give --start and --stop nearer together, or a "
                     "longer --window",
                     s->file, 1e-9 * (double)s->start_ns, 1e-9 * (double)s->stop_ns, (double)length / (double)step);
}

tides_status cli_stretch_read(cli_stretch *s, cli_window *recording, tides_error *error) {
    *recording = (cli_window){.first_ns = INT64_MIN, .stop_ns = INT64_MAX, .how = &s->how};
    if (s->start_text) recording->first_ns = s->start_ns - s->before_ns;
    if (s->stop_text) recording->stop_ns = s->stop_ns;
    tides_status status = cli_window_read(s->file, recording, error);
    if (status == TIDES_OK) status = cli_window_ordered(s->file, recording, error);
    if (status == TIDES_OK)
        status = cli_window_check(s->file, recording, s->start_text ? s->start_ns : INT64_MIN,
                                  s->stop_text ? s->stop_ns : INT64_MAX, error);
    if (status != TIDES_OK) return status;
    const tides_event *events = recording->events;
    const size_t count = recording->count;
    if (count && (events[0].t < -time_limit || events[count - 1].t > time_limit))
        return cli_error(error, TIDES_BAD_FILE, "%s: its times go beyond 63 years: --rebase counts from the recording's zero",
                         s->file);
    fill_in(s, recording);
    return check_windows(s, error);
}
