/* Options for reading an event file, and messages about how it was read. */
#include "reading.h"

#include <stdio.h>

int cli_reading_parse(const cli_command *command, const cli_reading *given, tides_event_reading *reading) {
    tides_event_reading_defaults(reading);
    reading->format = given->format;
    reading->columns = given->columns;
    reading->unit = given->unit;
    reading->stream = given->stream;
    reading->drop_invalid = given->drop_invalid;
    reading->rebase = given->rebase;
    return given->offset ? cli_time(command, "--offset", given->offset, &reading->offset_ns) : CLI_GO;
}

const char *cli_zero_name(int32_t zero) {
    return zero == TIDES_ZERO_FRAME   ? "its first frame"
           : zero == TIDES_ZERO_START ? "the recording's start"
                                      : "its first event";
}

void cli_reading_tell(const cli_common *common, const char *file, const tides_event_facts *facts, int32_t rebase) {
    char zero[CLI_SECONDS];
    if (common->quiet) return;
    if (facts->read_as[0]) fprintf(stderr, "tides: %s: %s\n", file, facts->read_as);
    if (rebase)
        fprintf(stderr, "tides: %s: time 0 is %s s of its clock, %s\n", file, cli_seconds(facts->zero_ns, zero),
                cli_zero_name(facts->zero));
    if (facts->dropped)
        fprintf(stderr, "tides: %s: %llu invalid events were left out\n", file, (unsigned long long)facts->dropped);
}
