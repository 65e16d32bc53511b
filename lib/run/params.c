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
#define VECTOR2(key, unit, lower, upper, fallback, sentence) \
    { key, TIDES_PARAM_VECTOR2, unit, lower, upper, fallback, NULL, sentence, 1 }

/* Events carry 64-bit nanoseconds: 9.2e9 s is the last second that fits (clocks that count from 1970 do). */
#define LAST_SECOND 9.2e9

static const tides_param table[] = {
    STRING("scene.file", "null",
           "splats (.ply, .h5, .spz, .splat, .ksplat, .sog); may be left out where scene.objects are given"),
    VECTOR3("scene.background", "", 0, 1e6, "[0,0,0]", "linear colour behind everything"),
    NUMBER("scene.duration_s", "s", 1e-9, LAST_SECOND, "null", "seconds that motions last; null takes the scene's own"),
    BOOLEAN("scene.interpolate_motion", "false",
            "within a step, interpolate what networks and callbacks move where that stays within tolerance"),
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

    NUMBER("time.start", "s", -LAST_SECOND, LAST_SECOND, "0.0",
           "where the run begins; pixels rest at the signal of this moment"),
    NUMBER("time.stop", "s", -LAST_SECOND, LAST_SECOND, "1.0", "where the run ends"),

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
    BOOLEAN("sensor.labels", "false", "HDF5: beside each event its cause, when it fired, and what the front end added"),

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
    NUMBER("frontend.shot_noise_hz", "Hz", 0, 1e6, "0.0",
           "rate of noise events of a pixel in the dark, both polarities; 0.264 of it in full light"),
    NUMBER("frontend.noise_rms", "log units", 0, 100, "0.0",
           "additive noise, an Ornstein-Uhlenbeck process per pixel; 0 is off"),
    NUMBER("frontend.noise_cutoff_hz", "Hz", 1e-3, 1e7, "1000.0", "its corner frequency"),
    NUMBER("frontend.hot_pixel_fraction", "", 0, 1, "0.0", "part of the pixels that fire without cause"),
    NUMBER("frontend.hot_pixel_rate_hz", "Hz", 0, 1e6, "100.0", "rate of a hot pixel's ON events"),

    CHOICE("stepping.mode", "fixed|risk|error|error_risk", "\"error\"", "fixed: every step_s; else cut where asked for"),
    CHOICE("stepping.model", "hermite|quadratic|linear|secant", "\"hermite\"", "how L is modelled between two renders"),
    NUMBER("stepping.step_s", "s", 1e-9, 1e3, "0.01", "time between two renders; unless fixed, the longest"),
    NUMBER("stepping.min_step_s", "s", 1e-9, 1e3, "1e-06", "steps no longer than this aren't cut"),
    NUMBER("stepping.tolerance", "thresholds", 1e-9, 1e3, "0.01", "error control: estimated error of L that cuts a step"),
    NUMBER("stepping.time_tolerance_s", "s", 0, 1e3, "0.0", "error control: estimated error of event times; 0 doesn't ask"),
    BOOLEAN("stepping.local", "true", "each 16x16 tile has its own steps, and none where nothing moves"),
    NUMBER("stepping.budget", "full frames", 0, 1e12, "0.0", "renders that cuts may cost in the run; 0 sets no bound"),
    NUMBER("stepping.memory_mb", "MB", 1, 1e9, "256.0", "memory for the renders of a macro step; changes no event"),
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
    CHOICE("readout.jitter_law", "gaussian|delay", "\"gaussian\"", "delay: never early, and 1.32 sigma late on average"),
    INTEGER("readout.queue_capacity", "", 1, 1e9, "65536", "events that a queue holds"),

    STRING("frames.file", "null", "frames in place of a scene: a folder of .png or .exr, or .npy, .npz, .h5, .hdf5"),
    STRING("frames.timestamps", "null",
           "text file with a time per frame; null: the rate, else the file's own or timestamps.txt"),
    CHOICE("frames.timestamps_unit", "auto|s|ms|us|ns", "\"auto\"", "of those times; auto: us in image_timestamps.txt, else s"),
    NUMBER("frames.frames_per_second", "Hz", 1e-6, 1e9, "null", "frame k is at k / rate; null where frames have times"),
    CHOICE("frames.transfer", "linear|srgb", "\"linear\"", "srgb: values are decoded to linear light first"),
    BOOLEAN("frames.rebase", "false", "put the first frame at time 0"),

    CHOICE("method", "tides|esim|v2e|iebcs|dvs-voltmeter|ldati", "\"tides\"", "simulator, or the baseline to compare with"),
    NUMBER("frames_per_second", "Hz", 1e-6, 1e9, "1000.0", "baselines: renders per second that they see of a scene"),

    NUMBER("esim.contrast_threshold_pos", "log units", 1e-4, 100, "1.0", "ESIM's default; its shipped configurations have 0.5"),
    NUMBER("esim.contrast_threshold_neg", "log units", 1e-4, 100, "1.0", "ESIM's default; its shipped configurations have 0.5"),
    NUMBER("esim.contrast_threshold_sigma_pos", "log units", 0, 100, "0.021", "drawn per pixel and frame, as ESIM does"),
    NUMBER("esim.contrast_threshold_sigma_neg", "log units", 0, 100, "0.021", "drawn per pixel and frame, as ESIM does"),
    NUMBER("esim.refractory_period_ns", "ns", 0, 1e12, "0.0", "events in it are dropped, and their contrast is consumed"),
    NUMBER("esim.log_eps", "", 1e-9, 1e6, "0.001", "ESIM's L = ln(Y + log_eps)"),
    BOOLEAN("esim.use_log_image", "true", "false: thresholds are on luminance itself"),
    CHOICE("esim.simulation_adaptive_sampling_method", "none|brightness|motion", "\"brightness\"",
           "renders by the largest |L_dot| or the fastest motion in the image; none: at frames_per_second"),
    NUMBER("esim.simulation_adaptive_sampling_lambda", "", 1e-6, 1e6, "0.5",
           "largest change of L, or motion in px, between two renders"),
    NUMBER("esim.simulation_minimum_framerate", "Hz", 1e-6, 1e9, "30.0", "renders are no further apart than its inverse"),

    NUMBER("v2e.pos_thres", "log units", 1e-4, 100, "0.2", "ON threshold (v2e's command line, like all its defaults here)"),
    NUMBER("v2e.neg_thres", "log units", 1e-4, 100, "0.2", "OFF threshold"),
    NUMBER("v2e.sigma_thres", "log units", 0, 100, "0.03", "spread of thresholds from pixel to pixel"),
    NUMBER("v2e.cutoff_hz", "Hz", 0, 1e9, "300.0", "photoreceptor at full intensity; Euler steps, cut at 1 as in v2e; 0: off"),
    NUMBER("v2e.leak_rate_hz", "Hz", 0, 1e6, "0.01", "ON events of a pixel at rest"),
    NUMBER("v2e.leak_jitter_fraction", "", 0, 100, "0.1", "spread of the leak from frame to frame"),
    NUMBER("v2e.noise_rate_cov_decades", "decades", 0, 10, "0.1", "log-normal spread of leaks from pixel to pixel"),
    NUMBER("v2e.shot_noise_rate_hz", "Hz", 0, 1e6, "0.001",
           "R of v2e's law of noise events, at the frames' times: 0.945 R in the dark, R / 4 in full light"),
    BOOLEAN("v2e.photoreceptor_noise", "false", "noise before the comparator in place of shot noise events"),
    NUMBER("v2e.refractory_period", "s", 0, 1e3, "0.0005", "events in it are put off to later frames"),
    NUMBER("v2e.cs_lambda_pixels", "px", 0, 1e3, "0.0", "space constant of the surround; 0: none"),
    NUMBER("v2e.cs_tau_p_ms", "ms", 0, 1e6, "0.0",
           "time constant of the surround; v2e takes 1e-6 for 0, here it must be given"),
    BOOLEAN("v2e.hdr", "false", "frames hold logarithms already"),
    BOOLEAN("v2e.float32_timestamps", "false", "round sub-times to float32 seconds, as v2e does"),

    NUMBER("voltmeter.k1", "", 0, 1e6, "5.265", "DVS-Voltmeter's k1 to k6, of its DVS346; here: contrast gain"),
    NUMBER("voltmeter.k2", "DN", 1e-6, 1e6, "20.0", "dark level"),
    NUMBER("voltmeter.k3", "", 0, 1e3, "0.0001", "noise that goes with the root of light"),
    NUMBER("voltmeter.k4", "1/us", -1, 1, "1e-07", "drift in the dark"),
    NUMBER("voltmeter.k5", "1/us/DN", -1, 1, "5e-09", "drift that goes with light"),
    NUMBER("voltmeter.k6", "", 0, 1, "1e-05", "noise in the dark"),

    NUMBER("iebcs.th_pos", "log units", 1e-4, 100, "0.4", "ON threshold (IEBCS's example, like all its defaults here)"),
    NUMBER("iebcs.th_neg", "log units", 1e-4, 100, "0.4", "OFF threshold"),
    NUMBER("iebcs.th_noise", "log units", 0, 100, "0.01", "spread of thresholds, drawn anew after each event"),
    NUMBER("iebcs.lat", "us", 0, 1e6, "100.0", "latency"),
    NUMBER("iebcs.jit", "us", 0, 1e6, "10.0", "spread of the latency"),
    NUMBER("iebcs.ref", "us", 0, 1e9, "100.0", "refractory period; the reference is taken at its end"),
    NUMBER("iebcs.tau", "us", 1e-6, 1e9, "40.0", "time constant of the pixel at 1 klux"),
    NUMBER("iebcs.bgnp", "Hz", 0, 1e5, "0.1", "periodic ON noise events of each pixel"),
    NUMBER("iebcs.bgnn", "Hz", 0, 1e5, "0.01", "periodic OFF noise events of each pixel"),
    STRING("iebcs.noise_pos", "null", ".npy of measured ON noise histograms (rows, columns, 72) in place of bgnp"),
    STRING("iebcs.noise_neg", "null", "the same for OFF in place of bgnn"),
    NUMBER("iebcs.scale", "lux", 1e-6, 1e9, "10000.0", "light at Y = 1"),
    CHOICE("iebcs.arbiter", "none|bottleneck|row|synchronous", "\"none\"",
           "readout; two are mended (their events add up here)"),
    NUMBER("iebcs.arbiter_us", "us", 1e-3, 1e6, "0.1", "its time per event, per event of a row, or per row"),

    NUMBER("ldati.fps", "Hz", 1e-6, 1e9, "30.0",
           "voxel grids of frames.file a second (V2CE's default): each lasts 1 / fps; ON first, 10 planes"),

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
