/* tides imu: writes the measurements of an IMU on the camera, and its true motion. */
#include "take.h"

static tides_status imu(tides_session *session, const char *path, tides_progress progress, void *user,
                        tides_session_taken *taken, tides_error *error) {
    (void)progress; /* not used: a minute of measurements takes milliseconds */
    (void)user;
    return tides_session_imu(session, path, taken, error);
}

static void report(cJSON *facts, const tides_session_taken *taken) {
    cJSON_AddStringToObject(facts, "place", taken->at_imu ? "the calibration's IMU" : "the camera");
}

int cmd_imu(const cli_command *command, int argc, char **argv) {
    const cli_take what = {"OUT.csv", "measurements, and their biases in OUT_bias.csv", "samples", imu, report, 0};
    return cli_take_run(command, argc, argv, &what);
}
