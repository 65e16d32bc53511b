/* The sensor between log-luminance and events, in continuous time and physical units (DESIGN 3.3, 3.4; paper, "Comparator and
 * sensor model"). Every block is off by default and costs nothing then.
 *
 *   L -> PSF -> photoreceptor (low-pass, or the circuit), high-pass -> centre-surround -> + noise -> S -> comparator -> events
 *
 * A pixel fires ON where S - S_ref reaches C+ and OFF where it reaches -C-. Random numbers depend on the seed and on the pixel
 * alone, never on steps, tiles, devices or where a run is cut. */
#ifndef TIDES_SENSOR_H
#define TIDES_SENSOR_H

#include "tides/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Behaviour of a pixel for refractory_s after an event.
 *   HOLD          it is held in reset, and its reference is the signal at the end: what the circuit does
 *   DROP_KEEP     crossings are dropped, and the reference stays: what is left fires at the end (v2e)
 *   DROP_CONSUME  crossings are dropped, and the reference moves with them: that contrast is lost (ESIM) */
enum { TIDES_REFRACTORY_HOLD = 0, TIDES_REFRACTORY_DROP_KEEP = 1, TIDES_REFRACTORY_DROP_CONSUME = 2 };

/* The optics' blur: of the logarithm and its rate, as in the paper, or of luminance before the logarithm, as in real optics. */
enum { TIDES_PSF_LOG = 0, TIDES_PSF_LINEAR = 1 };

/* FIRST_ORDER: one pole at photoreceptor_cutoff_hz. CIRCUIT: the pixel's chain of a second-order photoreceptor, whose poles
 * are proportional to the photocurrent, a source follower and a difference amplifier. The cutoff and photoreceptor_law aren't
 * read then. */
enum { TIDES_BANDWIDTH_FIRST_ORDER = 0, TIDES_BANDWIDTH_CIRCUIT = 1 };

/* CONSTANT: the pole doesn't depend on light. INTENSITY: as in v2e, it is cutoff (DN + 20) / 275, DN = 255 Y. */
enum { TIDES_PHOTORECEPTOR_CONSTANT = 0, TIDES_PHOTORECEPTOR_INTENSITY = 1 };

/* Where a pixel's reference is when a run begins.
 *   REST    at the signal: all pixels were reset then, and their leak starts in phase
 *   RANDOM  anywhere that keeps the signal between the levels, uniform: it has seen other things before
 *   STEADY  where leak, noise, hot pixels and refractory period leave it after a long time at rest, so that events at rest
 *           come at the same rate from the first moment on; without any of these that is REST. Additive noise has been there
 *           for ten seconds, where it makes few events for minutes (lib/sensor/td_steady.h) */
enum { TIDES_INITIAL_REST = 0, TIDES_INITIAL_RANDOM = 1, TIDES_INITIAL_STEADY = 2 };

/* Additive noise: an Ornstein-Uhlenbeck process per pixel.
 *   CONSTANT      of noise_rms and noise_cutoff_hz
 *   PHOTOCURRENT  of the pixel's own light: white noise of 4 q I, I = circuit.photocurrent_a Y + circuit.dark_current_a, behind
 *                 the photoreceptor's pole, whose correlation time it has (noise_cutoff_hz isn't read); noise_rms is what
 *                 is there in any light. Wants photoreceptor_cutoff_hz, of either law; not with the circuit or a high-pass
 *                 (lib/sensor/noise/td_noise_light.h has the equations) */
enum { TIDES_NOISE_CONSTANT = 0, TIDES_NOISE_PHOTOCURRENT = 1 };

/* Constants of TIDES_BANDWIDTH_CIRCUIT; the defaults are a DVS128's at 100 lux, as the nominal
 * configuration of wengflow's simulator ("improved ESIM") has them. The currents are also those of TIDES_NOISE_PHOTOCURRENT,
 * leak_hz_per_a and photoreceptor_half_a. */
typedef struct tides_circuit {
    double photocurrent_a;     /* at Y = 1 [A] */
    double dark_current_a;     /* [A], > 0 */
    double gain, kappa;        /* amplifier gain A, back-gate coefficient; A kappa <= 1e4 */
    double thermal_v;          /* V_T [V] */
    double photodiode_f;       /* C_p [F] */
    double miller_f;           /* C_mil [F] */
    double output_s;           /* tau_out [s] */
    double source_follower_hz; /* 0: left out */
    double difference_hz;      /* 0: left out */
} tides_circuit;

/* Causes of events, for tides_event.cause. */
enum { TIDES_CAUSE_SIGNAL = 0, TIDES_CAUSE_LEAK = 1, TIDES_CAUSE_SHOT = 2, TIDES_CAUSE_HOT = 3, TIDES_CAUSES = 4 };

/* Fill with tides_sensor_defaults: thresholds 0.2, 64 events per step, all else off. */
typedef struct tides_sensor {
    uint32_t size;
    /* Limit per pixel and step, >= 1. Error control cuts steps that may have more events. If it can't, or isn't on, further
     * events are counted and fire at the step's end. */
    int32_t max_events_per_step; /* as above */
    double threshold_on;         /* C+ [log units], > 0 */
    double threshold_off;        /* C- [log units], > 0 */

    double threshold_sigma;  /* standard deviation of C+ and of C- from pixel to pixel, independent, drawn once [log units] */
    double threshold_min;    /* no pixel's threshold is below this [log units], > 0 */
    double refractory_s;     /* [s] */
    int32_t refractory_law;  /* TIDES_REFRACTORY_* */
    int32_t psf_domain;      /* TIDES_PSF_* */
    double leak_rate_hz;     /* ON events per second that the reference's drift makes in a pixel at rest [Hz] */
    double leak_sigma;       /* decades of log-normal spread of that rate from pixel to pixel */
    double leak_hz_per_a;    /* additional leak per photocurrent of circuit.* at Y = 0.5 [Hz / A] */
    double temperature_c;    /* 25: leak_rate_hz is there; it doubles every 8, as silicon's leakage does [degrees C] */
    double threshold_parity; /* odd columns' thresholds are higher by this part, even ones' lower, in (-1, 1) [1] */
    double b_min;            /* pixels with less coverage than this stay silent, in [0, 1] */
    double shot_noise_hz;    /* noise events, both polarities, of a pixel at Y = 0; 0.264 of it at Y = 1, linear between [Hz] */
    double hot_pixel_fraction, hot_pixel_rate_hz; /* of all pixels [1]; their ON events a second [Hz] */
    double dead_pixel_fraction;                   /* of all pixels: those that never fire [1] */

    double psf_sigma_px;            /* [px] */
    double photoreceptor_cutoff_hz; /* -3 dB [Hz]; 0: off */
    /* the cutoff is multiplied by I / (I + this), where I is the photocurrent of circuit.* at Y = 0.5, as the photodiode
     * limits it in weak light; 0: not multiplied [A] */
    double photoreceptor_half_a;
    int32_t photoreceptor_law; /* TIDES_PHOTORECEPTOR_* */
    int32_t bandwidth;         /* TIDES_BANDWIDTH_* */
    tides_circuit circuit;     /* of TIDES_BANDWIDTH_CIRCUIT */
    double surround_lambda_px; /* space constant of the surround's diffuser [px]; 0: off */
    double surround_tau_s;     /* its time constant [s] */
    double noise_rms;          /* additive Ornstein-Uhlenbeck noise [log units] */
    double noise_cutoff_hz;    /* its corner frequency [Hz]: correlation time 1 / (2 pi cutoff) */
    double noise_sigma;        /* decades of log-normal spread of its size from pixel to pixel */
    int32_t noise_law;         /* TIDES_NOISE_* */
    double highpass_hz;        /* -3 dB of a high-pass behind the low-pass (Prophesee's bias_hpf) [Hz]; 0: off */
    uint64_t seed;             /* of all that is random here */
    int32_t labels;            /* 1: events get tides_event_frontend */
    int32_t initial;           /* TIDES_INITIAL_* */
    /* A file with values of single pixels, which replace drawn ones (nullable; the caller's). It has arrays of the image's
     * height by width, in an .npz, a structured .npy, or HDF5. Their names are threshold_on, threshold_off [log units], leak
     * [Hz], noise [Hz, as shot_noise_hz], hot [Hz], dead [0 or 1], noise_size [of additive noise, 1: as noise_rms or noise_law
     * say]. Any may be missing, and NaN means unknown. It is read when pixels are made. */
    const char *maps;
    /* The readout of frames on the same chip (DAVIS): each read of a row adds `kick` to the signal of its pixels, after all
     * filters, and decays. Frame k = 0, 1, ..., at kick_first_s + k / kick_rate_hz or as kick_times lists, reads row y
     * kick_reads_s (reset, signal) + y kick_row_s later. Reads before the run don't count. Not with a pole that depends on
     * light, nor the circuit. A step is at most 16 recoveries long. */
    double kick;            /* [log units], of either sign; 0: off */
    double kick_recovery_s; /* its time constant [s] */
    double kick_rate_hz;    /* frames per second [Hz] */
    double kick_first_s;    /* the first frame [s], on the run's clock */
    double kick_row_s;      /* from row to row [s] */
    double kick_reads_s[2]; /* reads of reset and of signal after a frame's time [s]; equal: one read */
    /* A text file of frames' times, in place of kick_rate_hz and kick_first_s (nullable; the caller's): each line begins with
     * one [s, on the run's clock, ascending]. Lines may be empty, or begin with # or %. It is read when pixels are made. */
    const char *kick_times;
} tides_sensor;
TIDES_API void tides_sensor_defaults(tides_sensor *sensor);

#ifdef __cplusplus
}
#endif
#endif
