/* tides calibrate: measures a sensor from a recording and the light that it saw. */
#include "calibrate_report.h"
#include "event_job.h"
#include "session.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct arguments {
    const char *files[2];
    const char *preset, *directory, *start, *stop, *roi, *still, *theme, *pictures;
    cli_list sets, fixed;
    cli_reading reading;
    tides_event_reading how;
    canvas_style style;
} arguments;

/* -- the command line ------------------------------------------------------------------------------------------------------ */

/* Parses "image.log_eps=0.05", or the name that reports use. A cutoff is converted to a time constant. */
static int parse_fixed(const cli_command *command, const char *text, tides_calibrate_options *options) {
    const char *sign = strchr(text, '=');
    tides_calibrated_row row;
    double value;
    if (!sign) return cli_usage(command, "--fix %s: should be KEY=VALUE", text);
    const int code = cli_number(command, "--fix", sign + 1, &value);
    if (code != CLI_GO) return code;
    for (int32_t i = 0; tides_calibrated_at(i, &row); i++) {
        const size_t length = (size_t)(sign - text);
        const int32_t by_key = strlen(row.key) == length && strncmp(row.key, text, length) == 0;
        if (!by_key && (strlen(row.name) != length || strncmp(row.name, text, length) != 0)) continue;
        options->given[i] = by_key && i == TIDES_CALIBRATED_POLE ? (value > 0 ? 1 / (6.283185307179586 * value) : 0) : value;
        return CLI_GO;
    }
    return cli_usage(command, "--fix %s: is no value that is measured; --json names them", text);
}

static int parse_roi(const cli_command *command, const char *text, tides_calibrate_options *o) {
    int32_t *const numbers[] = {&o->x, &o->y, &o->width, &o->height};
    const char *at = text;
    for (int32_t i = 0; i < 4; i++) {
        char *end = NULL;
        const long value = strtol(at, &end, 10);
        if (end == at || *end != (i < 3 ? ',' : '\0') || value < (i < 2 ? 0 : 1) || value > 65536)
            return cli_usage(command, "--roi %s: should be x,y,width,height in pixels", text);
        *numbers[i] = (int32_t)value;
        at = end + 1;
    }
    return CLI_GO;
}

static int parse(const cli_command *command, arguments *a, tides_calibrate_options *options) {
    int code = cli_reading_parse(command, &a->reading, &a->how);
    if (code == CLI_GO && a->start) code = cli_time(command, "--start", a->start, &options->start_ns);
    if (code == CLI_GO && a->stop) code = cli_time(command, "--stop", a->stop, &options->stop_ns);
    if (code == CLI_GO && a->roi) code = parse_roi(command, a->roi, options);
    for (size_t i = 0; i < a->fixed.count && code == CLI_GO; i++) code = parse_fixed(command, a->fixed.items[i], options);
    if (code == CLI_GO) code = canvas_parse_theme(command, a->theme, &a->style);
    if (code == CLI_GO) code = canvas_parse_pictures(command, a->pictures, &a->style);
    options->reading = &a->how;
    options->still = a->still;
    return code;
}

/* -- the work -------------------------------------------------------------------------------------------------------------- */

static tides_status check_outputs(const arguments *a, tides_error *error) {
    static const char *const names[] = {"calibrate.png", "calibrate.svg", "calibrate.pdf", "index.html", NULL};
    const cli_output preset = {a->preset, ".json"};
    tides_status status = cli_check_outputs(a->files[0], &preset, 1, error);
    if (status == TIDES_OK) status = cli_check_outputs(a->still, &preset, 1, error);
    if (status == TIDES_OK) status = cli_check_run(a->files[1], &a->sets, &preset, 1, error);
    if (status == TIDES_OK && a->directory)
        status = cli_check_folder(a->files[1], &a->sets, a->files[0], a->directory, names, error);
    return status;
}

static tides_status measure(const arguments *a, const tides_calibrate_options *options, const cli_common *common,
                            tides_calibration *found, tides_error *error) {
    tides_session *session = NULL;
    cli_progress progress = {.quiet = common->quiet};
    tides_status status = check_outputs(a, error);
    if (status == TIDES_OK && a->directory) status = cli_make_directory(a->directory, error);
    if (status == TIDES_OK) status = cli_session_open(a->files[1], &a->sets, common, NULL, 0, &session, error);
    if (status == TIDES_OK) status = tides_calibrate(a->files[0], session, options, cli_progress_step, &progress, found, error);
    cli_progress_end(&progress);
    tides_session_close(session);
    return status;
}

/* Makes the preset, whose description is like "measured from events.h5, 0.0038 to 0.1742 s". */
static tides_status make_preset(const arguments *a, const tides_calibration *found, char **text, tides_error *error) {
    const char *slash = strrchr(a->files[0], '/');
    char about[400], start[CLI_SECONDS], stop[CLI_SECONDS];
    snprintf(about, sizeof about, "measured from %.300s, %s to %s s, by tides calibrate", slash ? slash + 1 : a->files[0],
             cli_seconds(found->start_ns, start), cli_seconds(found->stop_ns, stop));
    return tides_calibration_preset(found, about, text, error);
}

static int report(const arguments *a, const cli_common *common, const tides_calibration *found) {
    tides_error error = {TIDES_OK, ""};
    char *preset = NULL;
    tides_status status = found->refused ? TIDES_OK : make_preset(a, found, &preset, &error);
    if (status == TIDES_OK && preset && a->preset) status = cli_write_text(a->preset, preset, &error);
    const calibrate_report r = {found, a->files[0], a->files[1], preset, a->directory, a->style};
    if (status == TIDES_OK && a->directory) status = calibrate_figure(&r, &error);
    if (status == TIDES_OK && a->directory) status = calibrate_page(&r, &error);
    if (status == TIDES_OK && common->json)
        cli_print_facts(calibrate_json(&r), 1);
    else if (status == TIDES_OK && !common->quiet)
        calibrate_print(&r);
    tides_free(preset);
    if (status != TIDES_OK) return cli_fail(&error);
    cli_tell_lines(common, found->notes);
    return found->refused ? cli_failed("no preset was written: this recording doesn't tell the sensor by this light") : CLI_OK;
}

int cmd_calibrate(const cli_command *command, int argc, char **argv) {
    cli_common common;
    arguments a;
    memset(&a, 0, sizeof a);
    const cli_option options[] = {
        {"--output", 'o', "PRESET.json", "the sensor as a preset, for sensor.preset", NULL, &a.preset, NULL},
        {"--page", 0, "DIR", "a page with pictures: DIR/index.html, DIR/calibrate.png", NULL, &a.directory, NULL},
        {"--start", 0, "S", "use events from here on (the busiest second)", NULL, &a.start, NULL},
        {"--stop", 0, "S", "use events before this time", NULL, &a.stop, NULL},
        {"--roi", 0, "X,Y,W,H", "use events of this region", NULL, &a.roi, NULL},
        {"--fix", 0, "KEY=VALUE", "a value that is known (image.log_eps, refractory_s ...); may be repeated", NULL, NULL,
         &a.fixed},
        {"--static", 0, "EVENTS", "a recording of a still scene or behind a cap: noise and leak are of it", NULL, &a.still,
         NULL},
        CLI_READING_FILE(a.reading),
        CLI_READING_CLOCK(a.reading),
        {"--theme", 0, "THEME", CANVAS_THEME_HELP, NULL, &a.theme, NULL},
        {"--pictures", 0, "FORMAT", CANVAS_PICTURES_HELP, NULL, &a.pictures, NULL},
        {"--set", 0, "KEY=VALUE", "override a key of the run file; may be repeated", NULL, NULL, &a.sets},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    tides_calibrate_options how;
    tides_calibration found;
    tides_error error = {TIDES_OK, ""};
    tides_calibrate_options_defaults(&how);
    int code = cli_parse(command, options, argc, argv, &common, a.files);
    if (code != CLI_GO) return code;
    if ((code = parse(command, &a, &how)) != CLI_GO) return code;
    cli_catch_interrupt();
    if (measure(&a, &how, &common, &found, &error) != TIDES_OK) return cli_fail(&error);
    code = report(&a, &common, &found);
    tides_calibration_free(&found);
    return code;
}
