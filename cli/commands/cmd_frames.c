/* tides frames: writes the frames that an ordinary camera in the event camera's place would record. */
#include "take.h"

static void report(cJSON *facts, const tides_session_taken *taken) {
    cJSON_AddNumberToObject(facts, "renders", taken->renders);
    cJSON_AddNumberToObject(facts, "error", taken->error);
    cJSON_AddNumberToObject(facts, "unsettled_pixels", (double)taken->unsettled);
}

int cmd_frames(const cli_command *command, int argc, char **argv) {
    const cli_take what = {"DIR", "folder of numbered pictures and their times", "frames", tides_session_frames, report, 1};
    return cli_take_run(command, argc, argv, &what);
}
