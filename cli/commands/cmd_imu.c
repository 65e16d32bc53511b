/* tides imu: what an IMU on the camera would measure. */
#include "take.h"

static tides_status imu(tides_session *session, const char *path, tides_progress progress, void *user,
                        tides_session_taken *taken, tides_error *error) {
    (void)progress; /* a minute of measurements takes milliseconds */
    (void)user;
    return tides_session_imu(session, path, taken, error);
}

int cmd_imu(const cli_command *command, int argc, char **argv) {
    const cli_take what = {"OUT.csv", "measurements, and their biases in OUT_bias.csv", "samples", imu, NULL, 0};
    return cli_take_run(command, argc, argv, &what);
}
