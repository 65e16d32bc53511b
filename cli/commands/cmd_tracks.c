/* tides tracks: writes points on surfaces, followed through the motion. */
#include "take.h"

static void report(cJSON *facts, const tides_session_taken *taken) {
    cJSON_AddNumberToObject(facts, "tracks", (double)taken->tracks);
}

int cmd_tracks(const cli_command *command, int argc, char **argv) {
    const cli_take what = {"OUT.npz", "tracks, as arrays, as .csv, or as Kubric's annotations .npy",
                           "times",   tides_session_tracks,
                           report,    0};
    return cli_take_run(command, argc, argv, &what);
}
