/* `tides`: finds the command and runs it. Exit codes: 0 ok, 1 failed, 2 usage; errors are one line on stderr. */
#include "cli.h"

#include <hdf5.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const cli_command commands[] = {
    {"demo", "[-o DIR]", "Make a dynamic scene, simulate it, and leave everything in a directory.",
     "Writes the scene, camera path, run file, events.h5, preview.png, frame.exr and stats.json.", 0, cmd_demo, 0},
    {"init", "[RECORDING] [-o RUN.json]", "Write a run file to begin with: keys, their defaults, and what they do.",
     "The comments (// to the end of a line) are TIDES's own: JSON has none.\n"
     "RECORDING: a folder with events and frames as datasets come (ECD, EDS, DSEC, HS-ERGB, BS-ERGB).",
     -1, cmd_init, 1},
    {"devices", "", "List OpenCL devices and show which one is used.", NULL, 0, cmd_devices, 0},
    {"presets", "", "List the sensors that sensor.preset names, side by side.",
     "guesses: so many of a preset's values have no source; tides info PRESET says of each where it comes from.", 0,
     cmd_presets, 1},
    {"info", "FILE", "Show what a scene, path, event or EXR file or folder holds.",
     "The kind of file is found from its content.\n"
     "Folders: trained models, camera paths, sequences of events (DSEC, EDS, HS-ERGB, BS-ERGB).",
     1, cmd_info, 1},
    {"scene", "KIND -o SCENE.h5 [--run RUN.json]", "Make a scene to try things on: fan, pendulum, balls, crowd ...",
     "The same options give the same scene. With --run, tides simulate RUN.json works at once.", 1, cmd_scene, 1},
    {"camera", "orbit|dolly|handheld|look-at -o PATH.json [--scene SCENE]", "Write a camera path for a scene.",
     "orbit: round what it looks at; dolly: on a line; handheld: shaken as by a hand; look-at: at rest. With a scene, what it\n"
     "looks at, from how far and what is up are found; each can be said. The path goes to camera.file of a run file.",
     1, cmd_camera, 1},
    {"render", "RUN.json --time T -o OUT.exr", "Render one frame with its exact time derivative.",
     "In place of a run file, a scene (.ply, .spz, a model's folder ...) is looked at from an orbit that is found.\n"
     "Channels: Y, L, L_dot, A, A_dot, coverage, contributors; with --rgb R, G, B and with --depth Z, and their _dot.\n"
     "The keys for --set are listed by tides simulate --help-all.",
     1, cmd_render, 0},
    {"frames", "RUN.json -o DIR", "Render exposed frames: blurred, by a global or rolling shutter, with noise.",
     "exposure.* of the run file says how. DIR gets frame_000000.png .., timestamps.txt (the middle of each exposure) and\n"
     "exposure_timestamps.txt (when it began and ended), all in seconds. The keys for --set are listed by tides simulate "
     "--help.",
     1, cmd_frames, 0},
    {"imu", "RUN.json -o OUT.csv", "Write what an IMU on the camera measures, with noise and biases.",
     "imu.* of the run file says how; scene.metres_per_unit and imu.down must be known. .csv has EuRoC's columns, .txt ECD's,\n"
     "each with the true biases in OUT_bias beside; .npz and .h5 have all of it. Keys are listed by tides simulate --help-all.",
     1, cmd_imu, 0},
    {"tracks", "RUN.json -o OUT.npz", "Follow points on surfaces through the run, with their visibility.",
     "tracks.* of the run file says how many, and how often. .npz has arrays, .csv a line for each time and track.\n"
     "The keys for --set are listed by tides simulate --help-all.",
     1, cmd_tracks, 0},
    {"simulate", "RUN.json -o EVENTS.h5", "Simulate events with continuous-time timestamps.",
     "In place of a run file, a scene (.ply, .spz, a model's folder ...) is seen from an orbit that is found, for 0.1 s, and "
     "a\n"
     "video (.y4m; -: from a pipe) to its end; --set scene.file=SCENE and --set frames.file=VIDEO alone name them, too.\n"
     "Events go to HDF5 in the DSEC layout, with nanosecond times in events/t_ns, or by the ending to another format\n"
     "(tides convert --help lists them), most in microseconds. Ctrl-C leaves what was simulated in EVENTS.h5.part.",
     -1, cmd_simulate, 0},
    {"dataset", "RUN.json -o DIR --layout ecd|dsec|mvsec|evimo|blinkflow|tum|ros2|kubric",
     "Make a dataset's folder: events, pictures, depth, flow, poses of every camera.",
     "Cameras are those of rig.cameras, each simulated once; rates are dataset.picture_hz, truth_hz and pose_hz.\n"
     "Flow in files is displacement to the next ground truth [px]. DIR is there whole or not at all; DIR/contact.png\n"
     "shows what is in it. The keys for --set are listed by tides simulate --help-all.",
     1, cmd_dataset, 0},
    {"batch", "MANIFEST.json -o DIR", "Simulate many runs, several at a time; what is finished is skipped.",
     "MANIFEST.json: {\"base\": \"run.json\", \"set\": {KEY: VALUE}, \"grid\": {KEY: [VALUES], ...},\n"
     "\"runs\": [{\"name\": NAME, \"file\": \"run.json\", \"set\": {KEY: VALUE}}, ...]}; grid and runs may stand alone,\n"
     "keys as for --set. \"draw\": {\"count\": N, \"seed\": \"S\", \"set\": {KEY: [LOWEST, HIGHEST] or [VALUES]}} draws runs "
     "at random,\n"
     "each with a seed of its own where none is written; {\"of\": KEY, \"times\": [LOWEST, HIGHEST]} goes with another key.\n"
     "\"command\": \"frames\", \"render\", \"imu\", \"tracks\" or \"compare\", with \"options\": [\"--time\", \"0.1\"], there "
     "or in a\n"
     "run, makes that in place of events.\n"
     "DIR/NAME holds each run's events.h5 (dataset/ where dataset.layout is set), stats.json, log.txt, and result.json\n"
     "or failure.json;\n"
     "DIR/summary.json and .csv all results. The same command again goes on after an interruption and does again\n"
     "only what changed.",
     1, cmd_batch, 0},
    {"convert", "IN OUT", "Convert a scene or an event file to another format.",
     "IN's format is found from its content; OUT's ending says what is written: lists of both are below.\n"
     "Labels of events (sensor.labels) aren't kept.\n"
     "IN may be a folder: of a trained model, or of event files (DSEC, EDS, HS-ERGB, BS-ERGB).",
     2, cmd_convert, 1},
    {"cut", "IN OUT --start S --stop S", "Cut a stretch of time or a window out of an event file.",
     "Labels of events (sensor.labels) aren't kept.", 2, cmd_cut, 1},
    {"view", "EVENTS -o OUT.png [--kind frame|surface|xyt|rate|isi|truth]",
     "Draw events as a picture or an animation; or ground truth.",
     "frame: red ON, blue OFF, brighter where more, violet where both; surface: how long ago each pixel's latest event\n"
     "was; xyt: events in space and time (as .svg too: shapes instead of pixels); rate: events a second over time;\n"
     "isi: intervals between the events of each pixel; truth: flow as a colour wheel, depths, instances of an .exr of\n"
     "tides render, of DSEC's and TUM's .png, of .npy (BlinkFlow's; height, width).\n"
     "tides view EVENTS -o - | ffmpeg -i - -pix_fmt yuv420p OUT.mp4 makes a video.",
     1, cmd_view, 1},
    {"export", "EVENTS -o OUT.npy [--as voxel|frame|surface]", "Write events as arrays for networks, one for each window.",
     "The array has float32 (windows x planes x height x width). .npz and .h5 also hold start_ns, stop_ns and events for each "
     "window.\n"
     "voxel: signed events shared between bins of time, as E2VID, DSEC (E-RAFT) or TimeLens build them; frame: numbers of OFF "
     "and\n"
     "of ON events; surface: exp(-age / decay) of the latest OFF and ON event at the window's end. "
     "include/tides/representations.h\n"
     "defines them.",
     1, cmd_export, 1},
    {"metrics", "REFERENCE SIMULATED [--only LIST]", "Compare a simulated event stream with a reference.",
     "Values are undefined (-, in JSON null) where they would divide by nothing. include/tides/metrics.h defines each one.\n"
     "The kernel distance takes long, and match wants an exact reference: both only where asked for.",
     2, cmd_metrics, 1},
    {"calibrate", "RECORDING RUN.json [-o PRESET.json] [--page DIR]",
     "Measure a sensor from a recording and the light that it saw, as a preset.",
     "RUN.json says what light there was: a scene and a path, or frames (frames.file), on the recording's clock. From one "
     "event\n"
     "of a pixel to its next the low-passed ln(Y + log_eps) moves by a threshold: black level, pole, refractory period and "
     "the\n"
     "clocks' offset are those by which these changes agree best. Pixels at rest say leak and noise. Errors are by halves of "
     "time\n"
     "and image and by pixels drawn by chance; what the recording can't tell isn't written. Bursts of frames' readout are "
     "cut.\n"
     "Where recording and light don't belong together nothing is written, and the exit code is 1.",
     2, cmd_calibrate, 0},
    {"compare", "RUN.json [-o DIR] [--methods LIST]",
     "Run every method on one scene or frame sequence and compare their events.",
     "Each method against the exact stream of the run: events matched one by one (median and 95th percentile of |dt|,\n"
     "mismatch), Same-ts, IG-NLL, log ISI, Fano error, Chamfer and Victor-Purpura distances; compare.json, compare.csv,\n"
     "compare.png (how far each is off, and part of a row of pixels where every event hangs on the nearest exact one),\n"
     "and index.html with all of it. Unless --as-configured is given every method is an ideal pixel with the run's\n"
     "thresholds: no noise, spread, latency, low-pass or refractory period. With it, thresholds are the run's where the run\n"
     "file has none for the method. Exact are a scene's events with steps halved until little moves, and between frames\n"
     "those of straight lines in log luminance. A method that fails takes no other with it.\n"
     "The keys for --set are listed by tides simulate --help-all.",
     1, cmd_compare, 0},
    {"bench",
     "accuracy|ablation|blocks|calibrate|determinism|live|sensors|stability|all [-o DIR] [--quick] [--scene NAME] [--row NAME]",
     "Measure run time against the error of event times, and try to break it.",
     "accuracy: methods and settings against each image's exact events; accuracy.json, .csv and two plots.\n"
     "ablation: what each part of the method is worth, what masking and the readout change; ablation.json, .csv and a plot.\n"
     "determinism: runs made in ways that mustn't matter, one hash for each; determinism.json and .csv. Where ways differ the\n"
     "exit code is 1.\n"
     "stability: worlds made to break it, on the device and both references, with a verdict on each row; stability.json, .csv\n"
     "and a plot. Where a row fails the exit code is 1.\n"
     "calibrate: sensors drawn by chance, simulated on the demo's scene or a run file's (--scene RUN.json) and measured "
     "again;\n"
     "calibrate.json and .csv.\n"
     "blocks: what each block of sensor and readout costs; blocks.json, .csv and a plot.\n"
     "sensors: run time with each preset and block, over the ideal sensor's; sensors.json and .csv.\n"
     "live: latency of a run that is told a pose every millisecond, at 346x260; live.json, .csv and a plot.\n"
     "all: each of them. index.html is a page of all results in the folder.\n"
     "Scenes: fan, handheld, occluder, nearly_static, vibration, flicker; trained and playbot where $TIDES_SHARED/data has "
     "them, at image.transfer linear, and trained_srgb, playbot_srgb. Of live: random, surfaces, demo; guitar "
     "and playbot.",
     1, cmd_bench, 0},
};

enum { COMMANDS = sizeof commands / sizeof commands[0] };

/* Prints the commands that most users need first. */
static void print_start(void) {
    printf("    tides demo -o demo                      a moving scene, its events and pictures of both\n"
           "    tides simulate scene.ply -o events.h5   events of a splat file, seen from an orbit that is found\n"
           "    tides view events.h5 -o events.png      what they look like; -o events.html: a page to turn and play\n");
}

static void print_help(void) {
    printf("usage: tides COMMAND ...\n\nEvent cameras in continuous time, from dynamic Gaussian-splatting scenes.\n\nto begin "
           "with:\n");
    print_start();
    printf("\ncommands:\n");
    for (size_t i = 0; i < COMMANDS; i++) printf("  %-10s %s\n", commands[i].name, commands[i].summary);
    printf("\ntides COMMAND --help explains a command; tides --version prints the version.\n");
}

static int unknown_command(const char *name) {
    const char *names[COMMANDS + 1] = {NULL};
    for (size_t i = 0; i < COMMANDS; i++) names[i] = commands[i].name;
    const char *nearest = tides_nearest_name(name, names);
    if (nearest) return cli_usage(NULL, "unknown command %s; did you mean %s?", name, nearest);
    return cli_usage(NULL, "unknown command %s", name);
}

static int run(int argc, char **argv) {
    const char *name = argc > 1 ? argv[1] : NULL;
    if (!name) print_start();
    if (!name) return cli_usage(NULL, "a command is missing");
    if (strcmp(name, "--version") == 0) {
        printf("tides %s\n", tides_version());
        return CLI_OK;
    }
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || (strcmp(name, "help") == 0 && argc == 2)) {
        print_help();
        return CLI_OK;
    }
    if (strcmp(name, "help") == 0 && strncmp(argv[2], "--", 2) == 0)
        return argc > 4 ? cli_usage(NULL, "help %s takes one page", argv[2])
                        : cli_help_pages(commands, COMMANDS, argv[2], argv[3]);
    if (strcmp(name, "help") == 0) { /* tides help render = tides render --help */
        char flag[] = "--help";
        char *again[] = {argv[0], argv[2], flag, NULL};
        return argv[2][0] == '-' || strcmp(argv[2], "help") == 0 ? cli_usage(NULL, "help takes a command's name")
                                                                 : run(3, again);
    }
    for (size_t i = 0; i < COMMANDS; i++)
        if (strcmp(commands[i].name, name) == 0) return commands[i].run(&commands[i], argc - 1, argv + 1);
    return name[0] == '-' ? cli_usage(NULL, "unknown option %s", name) : unknown_command(name);
}

/* If a reader closes the pipe early (tides ... | head), ends the process by SIGPIPE, as other programs do, without an error
 * message. */
static void end_with_the_pipe(void) {
    struct pollfd out = {.fd = STDOUT_FILENO, .events = POLLOUT};
    if (poll(&out, 1, 0) != 1 || !(out.revents & POLLERR)) return;
    signal(SIGPIPE, SIG_DFL);
    raise(SIGPIPE);
}

/* Removes HDF5 1.10's handler for the process's end: with a damaged file or without memory it prints to stderr, or crashes. It
 * isn't needed, because all files are closed. */
static void set_up(void) {
    signal(SIGPIPE, SIG_IGN); /* writes fail with an error instead */
    H5dont_atexit();
}

int main(int argc, char **argv) {
    set_up();
    int code = run(argc, argv);
    if (code == CLI_DESCRIBED) code = CLI_OK;
    /* A full disk behind stdout is an error. */
    if (fflush(stdout) != 0 || ferror(stdout)) {
        end_with_the_pipe();
        fputs("tides: standard output can't be written\n", stderr);
        if (code == CLI_OK) code = CLI_FAILED;
    }
    return code;
}
