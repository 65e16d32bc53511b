/* The result of tides calibrate as JSON, as text, and as a page with pictures. */
#ifndef CLI_CALIBRATE_REPORT_H
#define CLI_CALIBRATE_REPORT_H

#include "canvas.h"
#include "cli.h"

typedef struct calibrate_report {
    const tides_calibration *found;
    const char *recording, *run;
    const char *preset; /* its text; NULL: refused */
    const char *directory;
    canvas_style style;
} calibrate_report;

cJSON *calibrate_json(const calibrate_report *report);
void calibrate_print(const calibrate_report *report);
/* Writes DIR/calibrate.png. calibrate_page: DIR/index.html. */
tides_status calibrate_figure(const calibrate_report *report, tides_error *error);
tides_status calibrate_page(const calibrate_report *report, tides_error *error);

/* The name of a value's state: "measured", "uncertain", "at most", "unknown", "given". */
const char *calibrate_state(int32_t state);
enum { CALIBRATE_TRANSITIONS = 4 };
const char *calibrate_transition(int32_t index); /* "ON after ON" ... */

#endif
