/* Benchmarks of the library itself, for `make bench`; a user's scene needs none of them. They measure the stages of frames
 * beside the limit (limit/), the growth of cost, and the value of the measures that make the image continuous.
 *   usage: own_bench image|scaling|throughput|all [-o DIR] [--quick] [--scene NAME] [--row NAME] */
#include "bench_image.h"
#include "bench_main.h"
#include "bench_scaling.h"
#include "bench_throughput.h"
#include "bench_worlds.h"

#include <hdf5.h>
#include <signal.h>

static const bench_entry benchmarks[] = {
    {"image", "What each measure that makes the image continuous in time is worth, and what it costs.", bench_image, 0,
     bench_scene_names, 0},
    {"scaling", "How cost grows with Gaussians, pixels, events, layers, what moves, speed and threads.", bench_scaling, 1,
     scaling_names, 0},
    {"throughput", "What each stage takes, beside the same image in plain C made for the machine: the limit.", bench_throughput,
     0, bench_world_names, 0},
};

int main(int argc, char **argv) {
    static const bench_list all = {benchmarks, sizeof benchmarks / sizeof *benchmarks};
    static const cli_command command = {.name = "own",
                                        .arguments = "image|scaling|throughput|all [-o DIR] [--quick]",
                                        .summary = "Measure the library itself.",
                                        .positionals = 1};
    signal(SIGPIPE, SIG_IGN);
    H5dont_atexit();
    return bench_main(&command, &all, argc, argv);
}
