/* The parameter table: every key of the run file, once. The JSON reader, --set, --help, the run written into event files and
 * the template are all made from it.
 *
 * A row with available = 0 is part of the contract (DESIGN 6) whose feature this version doesn't have: such a key may be
 * written with its default, so that run files don't change when the feature comes. */
#include "td_run.h"

#include <string.h>

#define NUMBER(key, unit, lower, upper, fallback, sentence) \
    { key, TIDES_PARAM_NUMBER, unit, lower, upper, fallback, NULL, sentence, 1 }
#define INTEGER(key, unit, lower, upper, fallback, sentence) \
    { key, TIDES_PARAM_INTEGER, unit, lower, upper, fallback, NULL, sentence, 1 }
#define BOOLEAN(key, fallback, sentence) \
    { key, TIDES_PARAM_BOOLEAN, "", 0, 0, fallback, NULL, sentence, 1 }
#define STRING(key, fallback, sentence) \
    { key, TIDES_PARAM_STRING, "", 0, 0, fallback, NULL, sentence, 1 }
#define CHOICE(key, choices, fallback, sentence) \
    { key, TIDES_PARAM_CHOICE, "", 0, 0, fallback, choices, sentence, 1 }
#define VECTOR3(key, unit, lower, upper, fallback, sentence) \
    { key, TIDES_PARAM_VECTOR3, unit, lower, upper, fallback, NULL, sentence, 1 }
#define OBJECTS(key, fallback, sentence) \
    { key, TIDES_PARAM_OBJECTS, "", 0, 0, fallback, NULL, sentence, 1 }
#define LATER_CHOICE(key, choices, fallback, sentence) \
    { key, TIDES_PARAM_CHOICE, "", 0, 0, fallback, choices, sentence, 0 }
#define VECTOR2(key, unit, lower, upper, fallback, sentence) \
    { key, TIDES_PARAM_VECTOR2, unit, lower, upper, fallback, NULL, sentence, 1 }

/* Events carry 64-bit nanoseconds: 9.2e9 s is the last second that fits (clocks that count from 1970 do). */
#define LAST_SECOND 9.2e9

static const tides_param table[] = {
    STRING("scene.file", "null",
           "splats (.ply, .h5, .spz, .splat, .ksplat, .sog); may be left out where scene.objects are given"),
    VECTOR3("scene.background", "", 0, 1e6, "[0,0,0]", "linear colour behind everything"),
    NUMBER("scene.duration_s", "s", 1e-9, LAST_SECOND, "null", "seconds that motions last; null takes the scene's own"),
    OBJECTS("scene.objects", "[]", "more splat files, each {file, trajectory, scale}; a trajectory moves it as a rigid body"),

    STRING("camera.file", NULL, "camera path: TIDES JSON, COLMAP, nerfstudio, INRIA, LLFF, nerfies, TUM, EuRoC, ESIM, KITTI"),
    INTEGER("camera.width", "px", 1, 16384, "null", "image width; null takes the path file's"),
    INTEGER("camera.height", "px", 1, 16384, "null", "image height; null takes the path file's"),
    NUMBER("camera.fx", "px", 1e-3, 1e9, "null", "focal length along x; null takes the path file's"),
    NUMBER("camera.fy", "px", 1e-3, 1e9, "null", "focal length along y; null takes the path file's, else fx"),
    NUMBER("camera.cx", "px", -1e6, 1e6, "null", "principal point; null takes the path file's, else the image centre"),
    NUMBER("camera.cy", "px", -1e6, 1e6, "null", "principal point; null takes the path file's, else the image centre"),
    NUMBER("camera.duration_s", "s", 1e-9, LAST_SECOND, "1.0", "length of paths whose file has no times, or times in [0, 1]"),
    NUMBER("camera.start_s", "s", -LAST_SECOND, LAST_SECOND, "0.0", "subtracted from every time of the path file"),
    BOOLEAN("camera.raw_positions", "false", "nerfies: leave out scene.json's scale and center (as 4DGaussians does)"),
    BOOLEAN("camera.rebase", "false", "put the path's first sample at time 0 (camera.start_s is then ignored)"),

    NUMBER("time.start", "s", 0, LAST_SECOND, "0.0", "where the run begins; pixels rest at the signal of this moment"),
    NUMBER("time.stop", "s", 0, LAST_SECOND, "1.0", "where the run ends"),

    CHOICE("image.rules", "smooth|inria|gsplat", "\"smooth\"", "whose cutoffs form the image; smooth has no jumps in time"),
    BOOLEAN("image.antialias", "false", "compensate opacity for the dilation (scenes trained with mip-splatting's filter)"),
    INTEGER("image.sh_degree", "", 0, 4, "4", "spherical-harmonics bands above this degree are ignored"),
    NUMBER("image.dilation", "px^2", 0, 100, "0.3", "added to the diagonal of every splat's 2-D covariance"),
    VECTOR3("image.luminance", "", 0, 100, "[0.2126,0.7152,0.0722]", "weights of r, g, b in luminance Y"),
    NUMBER("image.log_eps", "", 1e-9, 1e6, "0.001", "L = ln(Y + log_eps)"),

    NUMBER("sensor.threshold_on", "log units", 1e-4, 100, "0.2", "C+: rise of L that fires an ON event"),
    NUMBER("sensor.threshold_off", "log units", 1e-4, 100, "0.2", "C-: fall of L that fires an OFF event"),
    STRING("sensor.preset", "null", "values for keys that aren't given: a sensor's name, or a JSON file like share/presets'"),
    NUMBER("sensor.threshold_sigma", "log units", 0, 100, "0.0", "spread of the thresholds from pixel to pixel"),
    NUMBER("sensor.threshold_min", "log units", 1e-6, 100, "0.01", "no pixel's threshold is drawn below this"),
    NUMBER("sensor.refractory_s", "s", 0, 10, "0.0", "time after an event in which a pixel can't fire"),
    CHOICE("sensor.refractory_law", "hold|drop_keep|drop_consume", "\"hold\"", "what a pixel does meanwhile"),
    NUMBER("sensor.leak_rate_hz", "Hz", 0, 1e6, "0.0", "rate of ON events from the reference's leak"),
    NUMBER("sensor.leak_sigma", "decades", 0, 10, "0.0", "log-normal spread of the leak from pixel to pixel"),
    NUMBER("sensor.b_min", "", 0, 1, "0.0", "pixels with less coverage than this stay silent"),
    NUMBER("sensor.dead_pixel_fraction", "", 0, 1, "0.0", "part of the pixels that never fire"),
    INTEGER("sensor.max_events_per_step", "", 1, 65535, "64",
            "events per pixel and step placed in time; the rest fire at its end"),

    NUMBER("frontend.psf_sigma_px", "px", 0, 100, "0.0", "Gaussian blur of the optics; 0 is off"),
    CHOICE("frontend.psf_domain", "log|linear", "\"log\"", "blur of L, as in the paper, or of Y before the logarithm"),
    NUMBER("frontend.photoreceptor_cutoff_hz", "Hz", 0, 1e9, "0.0", "low-pass of the photoreceptor; 0 is off"),
    CHOICE("frontend.photoreceptor_law", "constant|intensity", "\"constant\"",
           "whether that pole goes with luminance, as v2e's does"),
    CHOICE("frontend.bandwidth", "first_order|circuit", "\"first_order\"", "one pole, or the pixel's circuit"),
    NUMBER("frontend.circuit.photocurrent_a", "A", 0, 1, "2e-12", "circuit: photocurrent at Y = 1"),
    NUMBER("frontend.circuit.dark_current_a", "A", 0, 1, "4e-15", "circuit: dark current"),
    NUMBER("frontend.circuit.gain", "", 0, 1e4, "140.0", "circuit: amplifier gain"),
    NUMBER("frontend.circuit.kappa", "", 0, 1, "0.7", "circuit: back-gate coefficient"),
    NUMBER("frontend.circuit.thermal_v", "V", 0, 1, "0.025", "circuit: thermal voltage"),
    NUMBER("frontend.circuit.photodiode_f", "F", 0, 1, "3.5e-14", "circuit: photodiode capacitance"),
    NUMBER("frontend.circuit.miller_f", "F", 0, 1, "6e-16", "circuit: Miller capacitance"),
    NUMBER("frontend.circuit.output_s", "s", 0, 1, "0.001815", "circuit: time constant of the amplifier's output"),
    NUMBER("frontend.circuit.source_follower_hz", "Hz", 0, 1e9, "3122.0", "circuit: source follower; 0 leaves it out"),
    NUMBER("frontend.circuit.difference_hz", "Hz", 0, 1e9, "16000.0", "circuit: difference amplifier; 0 leaves it out"),
    VECTOR2("frontend.center_surround", "px, s", 0, 1e3, "null", "surround's space constant and time constant; null is off"),
    NUMBER("frontend.shot_noise_hz", "Hz", 0, 1e6, "0.0", "rate of noise events of a pixel in the dark, both polarities"),
    NUMBER("frontend.noise_rms", "log units", 0, 100, "0.0",
           "additive noise, an Ornstein-Uhlenbeck process per pixel; 0 is off"),
    NUMBER("frontend.noise_cutoff_hz", "Hz", 1e-3, 1e7, "1000.0", "its corner frequency"),
    NUMBER("frontend.hot_pixel_fraction", "", 0, 1, "0.0", "part of the pixels that fire without cause"),
    NUMBER("frontend.hot_pixel_rate_hz", "Hz", 0, 1e6, "100.0", "rate of a hot pixel's ON events"),

    CHOICE("stepping.mode", "fixed|risk|error|error_risk", "\"error\"", "fixed: every step_s; else halved where asked for"),
    CHOICE("stepping.model", "hermite|quadratic|linear|secant", "\"hermite\"", "how L is modelled between two renders"),
    NUMBER("stepping.step_s", "s", 1e-9, 1e3, "0.01", "time between two renders; unless fixed, the longest"),
    NUMBER("stepping.min_step_s", "s", 1e-9, 1e3, "1e-06", "steps no longer than this aren't halved"),
    NUMBER("stepping.tolerance", "thresholds", 1e-9, 1e3, "0.01", "error control: estimated error of L that halves a step"),
    NUMBER("stepping.time_tolerance_s", "s", 0, 1e3, "0.0", "error control: estimated error of event times; 0 doesn't ask"),
    BOOLEAN("stepping.local", "true", "each 16x16 tile has its own steps, and none where nothing moves"),
    NUMBER("stepping.budget", "full frames", 0, 1e12, "0.0", "renders that halving may cost in the run; 0 sets no bound"),
    NUMBER("stepping.risk.w_b", "", 0, 1, "0.3", "weight of coverage in the risk score"),
    NUMBER("stepping.risk.w_c", "", 0, 1, "0.3", "weight of contributors in the risk score"),
    NUMBER("stepping.risk.w_alpha", "", 0, 1, "0.4", "weight of |alpha_dot| in the risk score"),

    BOOLEAN("readout.enabled", "false", "send events through the readout arbiter"),
    CHOICE("readout.kind", "tiles|rows|bottleneck", "\"tiles\"", "a queue per tile, per row of pixels, or one for all"),
    INTEGER("readout.tile_px", "px", 1, 4096, "16", "side of an arbiter's tile"),
    NUMBER("readout.tick_s", "s", 0, 1, "1e-06", "time that the scanner stays at a queue; 0 is an infinite rate"),
    INTEGER("readout.k0", "", 1, 1e6, "32", "events released per tick at rest"),
    NUMBER("readout.beta_k", "", 0, 1, "0.5", "how activity lowers the release"),
    NUMBER("readout.p0", "", 0, 1, "0.0", "drop probability at rest"),
    NUMBER("readout.eta", "", 0, 1, "0.2", "how activity raises the drop probability"),
    NUMBER("readout.sigma0_s", "s", 0, 1, "0.0", "timestamp jitter at rest"),
    NUMBER("readout.gamma_sigma_s", "s", 0, 1, "1e-05", "how activity raises the jitter"),
    INTEGER("readout.queue_capacity", "", 1, 1e9, "65536", "events that a queue holds"),

    LATER_CHOICE("method", "tides|esim|v2e|iebcs|dvs-voltmeter", "\"tides\"", "simulator, or the baseline to compare with"),
    STRING("device", "\"auto\"",
           "reference, cpu, gpu, an index or a part of a device's name; auto: TIDES_DEVICE, else the best"),
    STRING("seed", "\"0\"", "64-bit number, in quotes, that all randomness comes from"),
};

const tides_param *tides_params(size_t *count) {
    if (count) *count = sizeof table / sizeof table[0];
    return table;
}

const tides_param *td_param_find(const char *key) {
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
        if (strcmp(table[i].key, key) == 0) return &table[i];
    return NULL;
}

int32_t td_param_is_group(const char *key) {
    size_t length = strlen(key);
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
        if (strncmp(table[i].key, key, length) == 0 && table[i].key[length] == '.') return 1;
    return 0;
}
