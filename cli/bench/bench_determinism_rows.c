/* The rows of `tides bench determinism`: its runs, and the ways in which each run is made. All ways of a run must give the same
 * events. */
#include "bench_determinism.h"

#include <signal.h>
#include <string.h>

#define MODEL "stepping.solve=off"
#define DOUBLE "stepping.solve=double", "stepping.tolerance=0.1"
#define TOGETHER DOUBLE, "stepping.unit=block"
#define COMPARATOR                                                                                                \
    "sensor.threshold_sigma=0.02", "sensor.refractory_s=0.001", "sensor.leak_rate_hz=5", "sensor.leak_sigma=0.2", \
        "sensor.dead_pixel_fraction=0.01", "frontend.shot_noise_hz=20", "frontend.hot_pixel_fraction=0.01"
#define FRONT_END                                                                                   \
    "frontend.psf_sigma_px=0.7", "frontend.photoreceptor_cutoff_hz=200", "frontend.noise_rms=0.02", \
        "frontend.noise_cutoff_hz=300"

/* Name, sentence, keys. The last number is 1 for a method that differences frames: its runs can't be cut. */
const determinism_run determinism_runs[] =
    {{"fixed", "equal steps", {"stepping.mode=fixed"}, 0},
     {"default", "steps under error control, events looked up", {NULL}, 0},
     {"error", "steps under error control, events of the cubic", {MODEL}, 0},
     {"risk", "steps by the paper's risk", {"stepping.mode=risk", MODEL}, 0},
     {"blocks", "steps of 4x4 blocks", {"stepping.unit=block", MODEL}, 0},
     {"solved", "events looked up, whole tiles", {DOUBLE, "stepping.unit=tile"}, 0},
     {"sensor", "most blocks of the sensor at once", {COMPARATOR, FRONT_END}, 0},
     {"comparator_solved", "those of the comparator, events looked up", {COMPARATOR, TOGETHER}, 0},
     {"surround", "centre-surround", {"frontend.center_surround=[2,0.004]"}, 0},
     {"readout",
      "an arbiter that queues, drops and jitters",
      {"readout.enabled=true", "readout.tile_px=8", "readout.tick_s=0.00005", "readout.k0=2", "readout.queue_capacity=64",
       "readout.p0=0.01", "readout.sigma0_s=0.000002"},
      0},
     {"inria", "an image that jumps", {"image.rules=inria", "stepping.mode=fixed"}, 0},
     {"esim",
      "straight lines between frames",
      {"method=esim", "frames_per_second=4000", "esim.contrast_threshold_pos=0.2", "esim.contrast_threshold_neg=0.2"},
      1},
     {.name = NULL}};

/* reference-f32, the kernels' arithmetic in scalar C, is among the ways because it must equal the device to the bit.
 * The device "reference" computes in double and gives other events, so it isn't among them.
 *
 * THREADS, HOST and METHOD make a way's environment variables with their values. A way with .pocl is for PoCL alone, .units are
 * the compute units that the device must then report, and .own_kernels asks for an empty kernel cache. */
#define THREADS(count) \
    .variable = {"POCL_MAX_PTHREAD_COUNT", "POCL_CPU_MAX_CU_COUNT"}, .value = {#count, #count}, .units = count, .pocl = 1
#define HOST(count) .variable = {"TIDES_THREADS"}, .value = {#count}
#define METHOD(name) .variable = {"POCL_WORK_GROUP_METHOD"}, .value = {name}, .pocl = 1, .own_kernels = 1

const determinism_way determinism_ways[] =
    {{.name = "whole", .sentence = "in one go", .quick = 1},
     {.name = "again", .sentence = "the same once more"},
     {.name = "one thread", .sentence = "PoCL with one thread", THREADS(1), .quick = 1},
     {.name = "three threads", .sentence = "PoCL with three threads", THREADS(3)},
     {.name = "1 of the host", .sentence = "the host's work on one thread", HOST(1), .quick = 1},
     {.name = "2 of the host", .sentence = "the host's work on two threads", HOST(2), .quick = 1},
     {.name = "3 of the host", .sentence = "the host's work on three threads", HOST(3)},
     {.name = "7 of the host", .sentence = "the host's work on seven threads", HOST(7)},
     {.name = "PoCL basic",
      .sentence = "PoCL's driver without threads",
      .variable = {"POCL_DEVICES"},
      .value = {"basic"},
      .pocl = 1},
     {.name = "PoCL loops", .sentence = "work-groups as PoCL's loops", METHOD("loops")},
     {.name = "PoCL loopvec", .sentence = "work-groups as PoCL's vectorised loops", METHOD("loopvec")},
     {.name = "C in float", .sentence = "scalar C", .device = "reference-f32", .quick = 1},
     {.name = "little memory", .sentence = "launches of a hundredth of the size", .sets = {"stepping.memory_mb=1"}, .quick = 1},
     {.name = "pieces", .sentence = "asked for in pieces, to times drawn at random", .how = DETERMINISM_PIECES},
     {.name = "saved", .sentence = "saved and restored at times drawn at random", .how = DETERMINISM_SAVED, .quick = 1},
     {.name = "file", .sentence = "through an event file", .how = DETERMINISM_FILE},
     {.name = "killed", .sentence = "simulate, killed at random and resumed", .how = DETERMINISM_KILLED, .quick = 1},
     {.name = "interrupted",
      .sentence = "the same with Ctrl-C, which writes a last checkpoint",
      .how = DETERMINISM_KILLED,
      .signal = SIGINT},
     {.name = "killed in C", .sentence = "the same in scalar C", .how = DETERMINISM_KILLED, .device = "reference-f32"},
     {.name = NULL}};

const determinism_run *determinism_find(const char *name) {
    for (const determinism_run *r = determinism_runs; r->name; r++)
        if (strcmp(r->name, name) == 0) return r;
    return NULL;
}

size_t determinism_count(void) { return sizeof determinism_runs / sizeof determinism_runs[0] - 1; }

const char *const *determinism_names(void) {
    static const char *names[sizeof determinism_runs / sizeof determinism_runs[0]]; /* the last stays NULL */
    for (size_t i = 0; i < determinism_count(); i++) names[i] = determinism_runs[i].name;
    return names;
}

/* Keys that make the world of `tides demo` smaller and shorter. A run still has 15 macro steps (8 with --quick), so that it can
 * be cut between them. */
static const char *const full_world[] = {"camera.width=96", "camera.height=72",      "camera.fx=84",
                                         "camera.fy=84",    "camera.cx=48",          "camera.cy=36",
                                         "time.stop=0.06",  "stepping.step_s=0.004", NULL};
static const char *const quick_world[] = {"camera.width=40", "camera.height=32",      "camera.fx=35",
                                          "camera.fy=35",    "camera.cx=20",          "camera.cy=16",
                                          "time.stop=0.03",  "stepping.step_s=0.004", NULL};

void determinism_take(const bench *b, const determinism_run *run, cli_list *sets) {
    for (const char *const *set = b->quick ? quick_world : full_world; *set; set++) sets->items[sets->count++] = *set;
    for (size_t i = 0; i < DETERMINISM_TEXTS && run->sets[i]; i++) sets->items[sets->count++] = run->sets[i];
}
