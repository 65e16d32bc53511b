/* tides cut: writes the events of a stretch of time and a window of an event file. */
#include "event_job.h"

#include <stdio.h>
#include <stdlib.h>

/* Parses "x,y,w,h". */
static int take_window(const cli_command *command, const char *text, tides_event_conversion *what) {
    long numbers[4];
    const char *at = text;
    for (int i = 0; i < 4; i++) {
        char *end = NULL;
        numbers[i] = strtol(at, &end, 10);
        if (end == at || *end != (i < 3 ? ',' : '\0') || numbers[i] < (i < 2 ? 0 : 1) || numbers[i] > 65536)
            return cli_usage(command, "--roi %s: give x,y,width,height in pixels", text);
        at = end + 1;
    }
    what->x = (int32_t)numbers[0];
    what->y = (int32_t)numbers[1];
    what->cut_width = (int32_t)numbers[2];
    what->cut_height = (int32_t)numbers[3];
    return CLI_GO;
}

int cmd_cut(const cli_command *command, int argc, char **argv) {
    cli_common common;
    cli_reading reading = {.format = NULL};
    tides_event_conversion what;
    tides_event_conversion_defaults(&what);
    const char *files[2] = {NULL, NULL}, *start = NULL, *stop = NULL, *window = NULL;
    const cli_option options[] = {
        {"--start", 0, "SECONDS", "keep events from here on (the file's first)", NULL, &start, NULL},
        {"--stop", 0, "SECONDS", "keep events before this time (the file's last)", NULL, &stop, NULL},
        {"--roi", 0, "X,Y,W,H", "keep this window, which becomes the sensor", NULL, &window, NULL},
        CLI_READING_CLOCK(reading),
        CLI_READING_FILE(reading),
        {"--to", 0, "FORMAT", "write as this (by ending)", NULL, &what.to, NULL},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, files);
    if (code == CLI_OK) cli_help_formats();
    if (code == CLI_GO) code = cli_conversion_reading(command, &reading, &what);
    if (code == CLI_GO && start) code = cli_time(command, "--start", start, &what.start_ns);
    if (code == CLI_GO && stop) code = cli_time(command, "--stop", stop, &what.stop_ns);
    if (code == CLI_GO && window) code = take_window(command, window, &what);
    if (code != CLI_GO) return code;
    if (!start && !stop && !window) return cli_usage(command, "nothing to cut: give --start, --stop or --roi");
    if (what.start_ns >= what.stop_ns) return cli_usage(command, "--start %s isn't before --stop %s", start, stop);
    return cli_event_convert(files[0], files[1], &what, &common);
}
