/* The list of tests/golden/test_runs.c: what is run. Settings are a run file's ("key=value", without spaces), on top of those
 * of `common`; "device" and "part" names are the test's own. */
#ifndef TESTS_GOLDEN_RUNS_LIST_H
#define TESTS_GOLDEN_RUNS_LIST_H

/* How a run is run besides its settings. */
enum {
    RUN_CPU = 1,        /* on the cpu device as well, to the same events */
    RUN_RESUME = 2,     /* as well saved in the middle, and gone on with by another simulator, to the same events */
    RUN_DIFFERENCE = 4, /* slopes from differences (TIDES_SLOPE_DIFFERENCE), which no run file has */
    RUN_SEQUENCE = 8    /* the method sees the frames of run_frames, not the world's renders */
};

typedef struct run_entry {
    const char *name; /* of its line in runs.txt; what is before the / is the part that it belongs to */
    const char *world, *device, *settings;
    int flags;
} run_entry;

/* Device of most runs: the float twin of the kernels, which `cpu` must equal to the bit. */
#define F32 "reference-f32"
#define F64 "reference"

static const char common[] = "time.start=0.42 time.stop=0.455 scene.background=[0.1,0.1,0.1] seed=5 "
                             "sensor.threshold_on=0.06 sensor.threshold_off=0.08 stepping.step_s=0.01 "
                             "stepping.min_step_s=0.00002 frames_per_second=400";

/* Where the model says when events are; "" is the default, error control with events looked up. */
#define FIXED "stepping.mode=fixed "
#define RISK "stepping.mode=risk stepping.solve=off "
#define ERROR "stepping.mode=error stepping.solve=off "
/* A sensor with noise, as a preset has it; in numbers of its own, so that presets may be mended. */
#define TEST_DVS                                                                                            \
    "sensor.threshold_sigma=0.021 sensor.refractory_s=0.001 sensor.leak_rate_hz=0.1 sensor.leak_sigma=0.1 " \
    "frontend.shot_noise_hz=1 frontend.photoreceptor_cutoff_hz=3000 "

/* Every block of the sensor but the circuit, which takes the low-pass's place, at once. */
#define ALL                                                                                                               \
    "sensor.threshold_sigma=0.01 sensor.refractory_s=0.001 sensor.leak_rate_hz=5 sensor.leak_sigma=0.2 sensor.b_min=0.1 " \
    "sensor.dead_pixel_fraction=0.02 frontend.psf_sigma_px=0.7 frontend.photoreceptor_cutoff_hz=200 "                     \
    "frontend.center_surround=[2,0.004] frontend.shot_noise_hz=20 frontend.noise_rms=0.02 frontend.noise_cutoff_hz=300 "  \
    "frontend.hot_pixel_fraction=0.01 sensor.labels=true "

#define FILTERS                                                     \
    "filters.background_s=0.002 filters.activity_high_start=60000 " \
    "filters.afk=band_stop filters.afk_start=2 filters.afk_stop=1 filters.trail=trail filters.erc_events=3 "

#define READOUT                                                                                                             \
    "readout.enabled=true readout.tile_px=8 readout.tick_s=0.00005 readout.k0=2 readout.queue_capacity=64 readout.p0=0.01 " \
    "readout.sigma0_s=0.000002 "

static const run_entry runs[] = {
    {"stepping/fixed linear", "rigid", F32, FIXED "stepping.model=linear", 0},
    {"stepping/fixed quadratic", "rigid", F32, FIXED "stepping.model=quadratic", 0},
    {"stepping/fixed hermite", "rigid", F32, FIXED, RUN_CPU | RUN_RESUME},
    {"stepping/fixed secant", "rigid", F32, FIXED "stepping.model=secant", 0},
    {"stepping/fixed whole frames", "rigid", F32, FIXED "stepping.local=false", 0},
    {"stepping/fixed double", "rigid", F64, FIXED, RUN_RESUME},
    {"stepping/difference linear", "rigid", F32, FIXED "stepping.model=linear", RUN_DIFFERENCE},
    {"stepping/difference quadratic", "rigid", F32, FIXED "stepping.model=quadratic", RUN_DIFFERENCE},
    {"stepping/difference hermite", "rigid", F32, FIXED, RUN_DIFFERENCE | RUN_RESUME},
    {"stepping/risk linear", "rigid", F32, RISK "stepping.model=linear", 0},
    {"stepping/risk quadratic", "rigid", F32, RISK "stepping.model=quadratic", 0},
    {"stepping/risk hermite", "rigid", F32, RISK, RUN_RESUME},
    {"stepping/risk secant", "rigid", F32, RISK "stepping.model=secant", 0},
    {"stepping/risk weights", "rigid", F32, RISK "stepping.risk.w_b=1 stepping.risk.w_c=0 stepping.risk.w_alpha=0.1", 0},
    {"stepping/error hermite", "rigid", F32, ERROR, RUN_CPU | RUN_RESUME},
    {"stepping/error whole frames", "rigid", F32, ERROR "stepping.local=false", 0},
    {"stepping/error double", "rigid", F64, ERROR, RUN_RESUME},
    {"stepping/error long steps", "rigid", F32, ERROR "stepping.step_s=0.02 stepping.memory_mb=1", 0},
    {"stepping/error of time", "rigid", F32, ERROR "stepping.time_tolerance_s=0.00001", 0},
    {"stepping/error tight", "rigid", F64, ERROR "stepping.tolerance=0.001", 0},
    {"stepping/error blocks", "rigid", F32, ERROR "stepping.unit=block", RUN_CPU | RUN_RESUME},
    {"stepping/default", "rigid", F32, "", RUN_CPU | RUN_RESUME},
    {"stepping/default double", "rigid", F64, "", RUN_RESUME},
    {"stepping/default risk", "rigid", F32, "stepping.mode=risk", RUN_RESUME},
    {"stepping/default tiles", "rigid", F32, "stepping.unit=tile stepping.tolerance=0.01", 0},
    {"stepping/default whole frames", "rigid", F32, "stepping.local=false", 0},
    {"stepping/few per step", "rigid", F32, FIXED "stepping.step_s=0.02 sensor.max_events_per_step=1", 0},

    {"image/inria", "rigid", F32, "image.rules=inria", RUN_CPU},
    {"image/gsplat", "rigid", F32, "image.rules=gsplat", 0},
    {"image/gsplat antialias", "rigid", F32, "image.rules=gsplat image.antialias=true", 0},
    {"image/smooth antialias", "rigid", F32, "image.antialias=true image.dilation=0.1", 0},
    {"image/srgb", "rigid", F32, "image.transfer=srgb", RUN_CPU | RUN_RESUME},
    {"image/srgb inria", "rigid", F32, "image.transfer=srgb image.rules=inria", 0},
    {"image/gamma not looked up", "rigid", F32, ERROR "image.transfer=gamma image.gamma=2.2", 0},
    {"image/srgb double", "rigid", F64, "image.transfer=srgb", 0},
    {"image/sh 0", "rigid", F32, "image.sh_degree=0 image.log_eps=0.01", 0},
    {"image/red", "rigid", F32, "image.luminance=[1,0,0]", 0},
    {"image/double inria", "rigid", F64, "image.rules=inria", 0},
    {"image/double gsplat", "rigid", F64, "image.rules=gsplat", 0},

    {"motion/moving fixed", "moving", F32, FIXED, RUN_RESUME},
    {"motion/moving", "moving", F32, ERROR, RUN_CPU | RUN_RESUME},
    {"motion/moving double", "moving", F64, ERROR, 0},
    {"motion/moving interpolated", "moving", F32, ERROR "scene.interpolate_motion=true", 0},
    {"motion/polynomial decoder", "motion0", F32, ERROR, RUN_CPU},
    {"motion/polynomial", "motion1", F32, ERROR, 0},
    {"motion/rotor tilting", "motion2", F32, ERROR, 0},
    {"motion/rotor standing", "motion3", F32, ERROR, 0},
    {"motion/keyframes", "motion4", F32, ERROR, 0},
    {"motion/keyframes catmull_rom", "motion5", F32, ERROR, 0},
    {"motion/polynomial gsplat", "motion1", F32, FIXED "image.rules=gsplat", 0},
    {"motion/rotor inria", "motion2", F32, FIXED "image.rules=inria", 0},
    {"motion/hexplane", "hexplane", F32, ERROR, RUN_CPU},
    {"motion/hexplane interpolated", "hexplane", F32, ERROR "scene.interpolate_motion=true stepping.tolerance=0.05", 0},
    {"motion/network", "network", F32, ERROR, RUN_RESUME},
    {"motion/network screw", "screw", F32, ERROR, 0},
    {"motion/network of times", "timenet", F32, ERROR, 0},
    {"motion/network fixed double", "network", F64, FIXED, 0},
    {"motion/callback", "callback", F32, ERROR, 0},
    {"motion/callback fixed", "callback", F32, FIXED, 0},

    {"motion/default", "moving", F32, "", RUN_CPU | RUN_RESUME},
    {"motion/default double", "moving", F64, "", 0},
    {"motion/default interpolated", "hexplane", F32, "scene.interpolate_motion=true", 0},
    {"motion/default hexplane", "hexplane", F32, "", RUN_CPU},
    {"motion/default keyframes", "motion4", F32, "", 0},
    {"motion/default network", "network", F32, "", RUN_RESUME},
    {"motion/default callback", "callback", F32, "", 0},

    {"generated/fan", "fan", F32, FIXED, 0},
    {"generated/pendulum", "pendulum", F32, "", 0},
    {"generated/balls", "balls", F32, FIXED, 0},
    {"generated/plane", "plane", F32, "", 0},
    {"generated/crowd", "crowd", F32, FIXED, 0},
    {"generated/disc", "disc", F32, FIXED, 0},
    {"generated/room", "room", F32, "", 0},

    {"sensor/colour filter", "rigid", F32, FIXED "sensor.colour_filter=rggb frontend.psf_sigma_px=0.7", RUN_CPU | RUN_RESUME},
    {"sensor/colour filter solved", "rigid", F32, "sensor.colour_filter=gbrg stepping.solve=double", RUN_RESUME},
    {"sensor/threshold_sigma", "rigid", F32, "sensor.threshold_sigma=0.02 sensor.threshold_min=0.05", RUN_RESUME},
    {"sensor/refractory hold", "rigid", F32, "sensor.refractory_s=0.006", RUN_RESUME},
    {"sensor/refractory keep", "rigid", F32, "sensor.refractory_s=0.006 sensor.refractory_law=drop_keep", RUN_RESUME},
    {"sensor/refractory consume", "rigid", F32, "sensor.refractory_s=0.006 sensor.refractory_law=drop_consume", RUN_RESUME},
    {"sensor/leak", "rigid", F32, "sensor.leak_rate_hz=20 sensor.leak_sigma=0.3", RUN_RESUME},
    {"sensor/b_min", "rigid", F32, "sensor.b_min=0.5", RUN_RESUME},
    {"sensor/model hold", "rigid", F32, ERROR "sensor.refractory_s=0.006", 0},
    {"sensor/model keep", "rigid", F32, ERROR "sensor.refractory_s=0.006 sensor.refractory_law=drop_keep", 0},
    {"sensor/model consume", "rigid", F32, ERROR "sensor.refractory_s=0.006 sensor.refractory_law=drop_consume", 0},
    {"sensor/model leak", "rigid", F32, ERROR "sensor.leak_rate_hz=20 sensor.leak_sigma=0.3", 0},
    {"sensor/model b_min", "rigid", F32, ERROR "sensor.b_min=0.5", 0},
    {"sensor/model shot noise", "rigid", F32, ERROR "frontend.shot_noise_hz=50", 0},
    {"sensor/dead", "rigid", F32, "sensor.dead_pixel_fraction=0.2", 0},
    {"sensor/psf log", "rigid", F32, "frontend.psf_sigma_px=1", RUN_RESUME},
    {"sensor/psf linear", "rigid", F32, "frontend.psf_sigma_px=1 frontend.psf_domain=linear", RUN_CPU},
    {"sensor/photoreceptor", "rigid", F32, "frontend.photoreceptor_cutoff_hz=100", RUN_RESUME},
    {"sensor/photoreceptor intensity", "rigid", F32,
     "frontend.photoreceptor_cutoff_hz=300 frontend.photoreceptor_law=intensity", RUN_RESUME},
    {"sensor/circuit", "rigid", F32, "frontend.bandwidth=circuit frontend.circuit.photocurrent_a=2e-11", RUN_RESUME},
    {"sensor/circuit alone", "rigid", F32,
     "frontend.bandwidth=circuit frontend.circuit.source_follower_hz=0 frontend.circuit.difference_hz=0", 0},
    {"sensor/surround", "rigid", F32, "frontend.center_surround=[3,0.002]", RUN_RESUME},
    {"sensor/shot noise", "rigid", F32, "frontend.shot_noise_hz=50", RUN_RESUME},
    {"sensor/noise", "rigid", F32, "frontend.noise_rms=0.03 frontend.noise_cutoff_hz=500", RUN_RESUME},
    {"sensor/hot pixels", "rigid", F32, "frontend.hot_pixel_fraction=0.1 frontend.hot_pixel_rate_hz=300", RUN_RESUME},
    {"sensor/labels", "rigid", F32, "sensor.labels=true frontend.photoreceptor_cutoff_hz=100", 0},
    {"sensor/all", "rigid", F32, ALL, RUN_CPU | RUN_RESUME},
    {"sensor/all fixed", "rigid", F32, FIXED ALL, RUN_RESUME},
    {"sensor/all risk", "rigid", F32, RISK ALL, 0},
    {"sensor/all linear", "rigid", F32, FIXED "stepping.model=linear " ALL, 0},
    {"sensor/all whole frames", "rigid", F32, ERROR "stepping.local=false " ALL, 0},
    {"sensor/all double", "rigid", F64, ALL, 0},
    {"sensor/all keep", "rigid", F32, ALL "sensor.refractory_law=drop_keep", 0},
    {"sensor/all consume", "rigid", F32, ALL "sensor.refractory_law=drop_consume", 0},
    {"sensor/all circuit", "rigid", F32, ALL "frontend.bandwidth=circuit frontend.center_surround=null", RUN_RESUME},
    {"sensor/all moving", "moving", F32, ALL, RUN_RESUME},
    {"sensor/initial random", "rigid", F32, "sensor.initial=random", RUN_CPU | RUN_RESUME},
    {"sensor/initial steady", "rigid", F32,
     "sensor.initial=steady sensor.leak_rate_hz=20 sensor.leak_sigma=0.3 frontend.shot_noise_hz=20 sensor.refractory_s=0.006",
     RUN_CPU | RUN_RESUME},
    {"sensor/initial noisy", "rigid", F32,
     "sensor.initial=steady sensor.leak_rate_hz=1 sensor.refractory_s=1e-4 frontend.noise_rms=0.05 "
     "frontend.noise_cutoff_hz=100 "
     "frontend.noise_sigma=0.1 frontend.shot_noise_hz=1",
     RUN_CPU | RUN_RESUME},
    {"sensor/initial filtered", "rigid", F32,
     "sensor.initial=steady sensor.leak_rate_hz=20 frontend.photoreceptor_cutoff_hz=100", RUN_RESUME},
    {"sensor/highpass", "rigid", F32, "frontend.highpass_hz=20", RUN_RESUME},
    {"sensor/highpass behind", "rigid", F32,
     "frontend.highpass_hz=20 frontend.photoreceptor_cutoff_hz=100 sensor.leak_rate_hz=20", RUN_CPU | RUN_RESUME},
    {"sensor/preset", "rigid", F32, TEST_DVS "sensor.threshold_on=0.1 sensor.threshold_off=0.1", 0},

    {"readout/tiles", "rigid", F32, READOUT, RUN_RESUME},
    {"readout/tiles fixed", "rigid", F32, FIXED READOUT, RUN_CPU},
    {"readout/model tiles", "rigid", F32, ERROR READOUT, 0},
    {"readout/rows", "rigid", F32, READOUT "readout.kind=rows", RUN_RESUME},
    {"readout/bottleneck", "rigid", F32, READOUT "readout.kind=bottleneck", RUN_RESUME},
    {"sensor/kick", "rigid", F32, "sensor.kick=0.04 sensor.kick_rate_hz=60 sensor.kick_first_s=0.425 sensor.kick_row_s=1e-5",
     RUN_RESUME},
    {"sensor/kick fixed", "rigid", F32,
     FIXED ALL "sensor.kick=-0.05 sensor.kick_rate_hz=60 sensor.kick_first_s=0.425 sensor.kick_reads_s=[0,0]",
     RUN_CPU | RUN_RESUME},
    {"readout/requested", "rigid", F32, READOUT "readout.kind=requested readout.row_s=2e-6 readout.event_s=5e-7", RUN_RESUME},
    {"readout/requested fixed", "rigid", F32, FIXED READOUT "readout.kind=requested readout.row_s=2e-5 readout.stamp=row",
     RUN_CPU | RUN_RESUME},
    {"readout/scanned", "rigid", F32, READOUT "readout.kind=scanned readout.event_s=1e-5", RUN_RESUME},
    {"readout/delay", "rigid", F32, READOUT "readout.jitter_law=delay", 0},
    {"readout/all", "moving", F32, READOUT ALL, RUN_RESUME},
    {"readout/filters", "rigid", F32, FILTERS, RUN_RESUME},
    {"readout/filters fixed", "rigid", F32, FIXED FILTERS READOUT, RUN_RESUME},

    {"method/esim", "rigid", F32, "method=esim esim.contrast_threshold_pos=0.1 esim.contrast_threshold_neg=0.1", RUN_CPU},
    {"method/esim motion", "moving", F32,
     "method=esim esim.contrast_threshold_pos=0.1 esim.simulation_adaptive_sampling_method=motion", 0},
    {"method/esim fixed", "rigid", F32,
     "method=esim esim.contrast_threshold_pos=0.1 esim.simulation_adaptive_sampling_method=none "
     "esim.contrast_threshold_neg=0.1 esim.refractory_period_ns=1000000",
     0},
    {"method/v2e", "rigid", F32, "method=v2e", 0},
    {"method/dvs-voltmeter", "rigid", F32, "method=dvs-voltmeter", 0},
    {"method/iebcs", "rigid", F32, "method=iebcs iebcs.th_pos=0.1 iebcs.th_neg=0.1", 0},

    {"frames/tides", NULL, F32, "method=tides", RUN_SEQUENCE},
    {"frames/tides sensor", NULL, F32,
     "method=tides sensor.threshold_sigma=0.01 sensor.refractory_s=0.001 sensor.leak_rate_hz=5 frontend.shot_noise_hz=20 "
     "frontend.noise_rms=0.02 frontend.photoreceptor_cutoff_hz=200 frontend.hot_pixel_fraction=0.02",
     RUN_SEQUENCE},
    {"frames/esim", NULL, F32, "method=esim esim.contrast_threshold_pos=0.2 esim.contrast_threshold_neg=0.3", RUN_SEQUENCE},
    {"frames/esim linear", NULL, F32, "method=esim esim.use_log_image=false esim.contrast_threshold_pos=0.1", RUN_SEQUENCE},
    {"frames/v2e", NULL, F32, "method=v2e", RUN_SEQUENCE},
    {"frames/v2e noise", NULL, F32,
     "method=v2e v2e.photoreceptor_noise=true v2e.shot_noise_rate_hz=5 v2e.leak_rate_hz=1 v2e.float32_timestamps=true",
     RUN_SEQUENCE},
    {"frames/v2e shot", NULL, F32, "method=v2e v2e.shot_noise_rate_hz=20 v2e.refractory_period=0 v2e.cutoff_hz=0",
     RUN_SEQUENCE},
    {"frames/v2e surround", NULL, F32, "method=v2e v2e.cs_lambda_pixels=2 v2e.cs_tau_p_ms=3", RUN_SEQUENCE},
    {"frames/dvs-voltmeter", NULL, F32, "method=dvs-voltmeter", RUN_SEQUENCE},
    {"frames/iebcs", NULL, F32, "method=iebcs", RUN_SEQUENCE},
    {"frames/iebcs bottleneck", NULL, F32, "method=iebcs iebcs.arbiter=bottleneck iebcs.bgnp=50", RUN_SEQUENCE},
    {"frames/iebcs row", NULL, F32, "method=iebcs iebcs.arbiter=row iebcs.jit=40", RUN_SEQUENCE},
    {"frames/iebcs synchronous", NULL, F32, "method=iebcs iebcs.arbiter=synchronous iebcs.arbiter_us=5", RUN_SEQUENCE},
    {"frames/ldati", NULL, F32, "method=ldati", RUN_SEQUENCE},
};

enum { RUNS = sizeof runs / sizeof *runs };

#endif
