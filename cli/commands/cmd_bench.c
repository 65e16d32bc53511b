/* tides bench: the cost of accuracy, the value of the method's parts and the cost of the sensor's, adversarial scenes, and
 * determinism. The speed of the library's own stages is measured by tests/bench/own. */
#include "bench_calibrate.h"
#include "bench_determinism.h"
#include "bench_main.h"
#include "bench_stability.h"
#include "bench_worlds.h"

static const bench_entry benchmarks[] = {
    {"accuracy", "Run time against the error of event times: methods and settings, each against its image's exact events.",
     bench_accuracy, 0, bench_scene_names, 0},
    {"ablation", "What each part of the method is worth, and what masking and a readout change.", bench_ablation, 0,
     bench_scene_names, 0},
    {"blocks", "What each block of the sensor and of the readout costs, alone.", bench_blocks, 0, bench_scene_names, 0},
    {"calibrate", "Sensors drawn by chance, simulated, and measured again from their events.", bench_calibrate, 0,
     bench_calibrate_names, BENCH_CALIBRATE_SENSORS},
    {"determinism", "The same runs made in different ways, and one SHA-256 for each run.", bench_determinism, 1,
     determinism_names, 0},
    {"live", "How long a run takes for each pose that it is told as it goes.", bench_live, 0, bench_world_names, 0},
    {"sensors", "What a run takes with each sensor, against the ideal one.", bench_sensors, 0, bench_world_names, 0},
    {"stability", "Worlds made to break the simulator, and whether they do.", bench_stability, 1, stability_names, 0},
};

int cmd_bench(const cli_command *command, int argc, char **argv) {
    static const bench_list all = {benchmarks, sizeof benchmarks / sizeof *benchmarks};
    return bench_main(command, &all, argc, argv);
}
