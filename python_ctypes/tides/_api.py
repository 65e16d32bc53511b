"""The C interface, made by generate.py from include/tides/*.h: `make python` where one changed. Do not edit."""

# fmt: off
# flake8: noqa
from __future__ import annotations

from ctypes import CFUNCTYPE, POINTER as P, Structure
from ctypes import c_char, c_char_p, c_double, c_float, c_int, c_int8, c_int16, c_int32, c_int64
from ctypes import c_size_t, c_uint8, c_uint16, c_uint32, c_uint64, c_void_p
from typing import Any

TIDES_VERSION_MAJOR = 0
TIDES_VERSION_MINOR = 1
TIDES_VERSION_PATCH = 0
TIDES_NUMERICS = 19
TIDES_CHECKPOINT_S = 30
TIDES_OK = 0
TIDES_BAD_ARGUMENT = 1
TIDES_NO_MEMORY = 2
TIDES_FILE_NOT_FOUND = 3
TIDES_BAD_FILE = 4
TIDES_WRITE_FAILED = 5
TIDES_BAD_CONFIG = 6
TIDES_UNSUPPORTED = 7
TIDES_NO_DEVICE = 8
TIDES_DEVICE_FAILED = 9
TIDES_CANCELLED = 10
TIDES_OUT_OF_RANGE = 11
TIDES_TRANSFER_FILE = -1
TIDES_TRANSFER_LINEAR = 0
TIDES_TRANSFER_SRGB = 1
TIDES_TRANSFER_GAMMA = 2
TIDES_TIME_AUTO = 0
TIDES_TIME_S = 1
TIDES_TIME_MS = 2
TIDES_TIME_US = 3
TIDES_TIME_NS = 4
TIDES_TIME_INDEX = 5
TIDES_LABEL_CAUSE = 1
TIDES_LABEL_FIRED = 2
TIDES_LABEL_FRONTEND = 4
TIDES_ZERO_EVENT = 0
TIDES_ZERO_START = 1
TIDES_ZERO_FRAME = 2
TIDES_READOUT_TILES = 0
TIDES_READOUT_ROWS = 1
TIDES_READOUT_BOTTLENECK = 2
TIDES_READOUT_REQUESTED = 3
TIDES_READOUT_SCANNED = 4
TIDES_STAMP_EVENT = 0
TIDES_STAMP_ROW = 1
TIDES_JITTER_GAUSSIAN = 0
TIDES_JITTER_DELAY = 1
TIDES_AFK_OFF = 0
TIDES_AFK_BAND_STOP = 1
TIDES_AFK_BAND_PASS = 2
TIDES_TRAIL_OFF = 0
TIDES_TRAIL_TRAIL = 1
TIDES_TRAIL_STC_CUT = 2
TIDES_TRAIL_STC_KEEP = 3
TIDES_ERC_CHANCE = 0
TIDES_ERC_FIRST = 1
TIDES_STAGE_BACKGROUND = 0
TIDES_STAGE_ACTIVITY = 1
TIDES_STAGE_AFK = 2
TIDES_STAGE_TRAIL = 3
TIDES_STAGE_ERC = 4
TIDES_STAGES = 5
TIDES_LENS_NONE = 0
TIDES_LENS_RADTAN = 1
TIDES_LENS_EQUIDISTANT = 2
TIDES_PATH_NOTES = 1024
TIDES_VARIED_WIDTH = 1
TIDES_VARIED_HEIGHT = 2
TIDES_VARIED_FX = 4
TIDES_VARIED_FY = 8
TIDES_VARIED_CX = 16
TIDES_VARIED_CY = 32
TIDES_DEVICE_CPU = 1
TIDES_DEVICE_GPU = 2
TIDES_DEVICE_OTHER = 3
TIDES_DEVICE_REFERENCE = 4
TIDES_DECODER_NONE = 0
TIDES_DECODER_SIGMOID = 1
TIDES_DECODER_CLAMP = 2
TIDES_DECODER_PLAIN = 3
TIDES_SH_DEGREE_MAX = 4
TIDES_TRAINED_UNKNOWN = 0
TIDES_TRAINED_PLAIN = 1
TIDES_TRAINED_ANTIALIASED = 2
TIDES_TRAINED_MIXED = 3
TIDES_INVALID_ERROR = 0
TIDES_INVALID_DROP = 1
TIDES_LOSES_HARMONICS = 1
TIDES_LOSES_TRAINED = 2
TIDES_LOSES_UP = 4
TIDES_LOSES_TRANSFER = 8
TIDES_LOSES_EXPONENT = 16
TIDES_REFRACTORY_HOLD = 0
TIDES_REFRACTORY_DROP_KEEP = 1
TIDES_REFRACTORY_DROP_CONSUME = 2
TIDES_PSF_LOG = 0
TIDES_PSF_LINEAR = 1
TIDES_BANDWIDTH_FIRST_ORDER = 0
TIDES_BANDWIDTH_CIRCUIT = 1
TIDES_PHOTORECEPTOR_CONSTANT = 0
TIDES_PHOTORECEPTOR_INTENSITY = 1
TIDES_INITIAL_REST = 0
TIDES_INITIAL_RANDOM = 1
TIDES_INITIAL_STEADY = 2
TIDES_NOISE_CONSTANT = 0
TIDES_NOISE_PHOTOCURRENT = 1
TIDES_CAUSE_SIGNAL = 0
TIDES_CAUSE_LEAK = 1
TIDES_CAUSE_SHOT = 2
TIDES_CAUSE_HOT = 3
TIDES_CAUSES = 4
TIDES_RULES_SMOOTH = 0
TIDES_RULES_INRIA = 1
TIDES_RULES_GSPLAT = 2
TIDES_FILTER_OFF = 0
TIDES_FILTER_RGGB = 1
TIDES_FILTER_GRBG = 2
TIDES_FILTER_GBRG = 3
TIDES_FILTER_BGGR = 4
TIDES_ANTIALIAS_FALSE = 0
TIDES_ANTIALIAS_TRUE = 1
TIDES_ANTIALIAS_FILE = 2
TIDES_Y = 0
TIDES_L = 1
TIDES_L_DOT = 2
TIDES_ALPHA = 3
TIDES_ALPHA_DOT = 4
TIDES_COVERAGE = 5
TIDES_CONTRIBUTORS = 6
TIDES_R = 7
TIDES_G = 8
TIDES_B = 9
TIDES_R_DOT = 10
TIDES_G_DOT = 11
TIDES_B_DOT = 12
TIDES_Z = 13
TIDES_Z_DOT = 14
TIDES_CHANNELS = 15
TIDES_MODEL_LINEAR = 0
TIDES_MODEL_QUADRATIC = 1
TIDES_MODEL_HERMITE = 2
TIDES_MODEL_SECANT = 3
TIDES_STEPPING_FIXED = 0
TIDES_STEPPING_RISK = 1
TIDES_STEPPING_ERROR = 2
TIDES_SLOPE_EXACT = 0
TIDES_SLOPE_DIFFERENCE = 1
TIDES_SOLVE_OFF = 0
TIDES_SOLVE_DOUBLE = 1
TIDES_SOLVE_AUTO = 2
TIDES_UNSOLVED_NOT = 0
TIDES_UNSOLVED_ASKED = 1
TIDES_UNSOLVED_FIXED = 2
TIDES_UNSOLVED_MODEL = 3
TIDES_UNSOLVED_SENSOR = 4
TIDES_UNSOLVED_IMAGE = 5
TIDES_UNIT_TILE = 0
TIDES_UNIT_BLOCK = 1
TIDES_UNIT_AUTO = 2
TIDES_STAT_COUNT = 0
TIDES_STAT_REAL = 1
TIDES_STAT_WHOLE = 2
TIDES_JOIN_DERIVED = 0
TIDES_JOIN_SUM = 1
TIDES_JOIN_LARGEST = 2
TIDES_METHOD_TIDES = 0
TIDES_METHOD_ESIM = 1
TIDES_METHOD_V2E = 2
TIDES_METHOD_IEBCS = 3
TIDES_METHOD_VOLTMETER = 4
TIDES_METHOD_LDATI = 5
TIDES_ESIM_NONE = 0
TIDES_ESIM_BRIGHTNESS = 1
TIDES_ESIM_MOTION = 2
TIDES_ARBITER_NONE = 0
TIDES_ARBITER_BOTTLENECK = 1
TIDES_ARBITER_ROW = 2
TIDES_ARBITER_SYNCHRONOUS = 3
TIDES_LDATI_PLANES = 10
TIDES_SHUTTER_GLOBAL = 0
TIDES_SHUTTER_ROLLING = 1
TIDES_PARAM_NUMBER = 0
TIDES_PARAM_INTEGER = 1
TIDES_PARAM_BOOLEAN = 2
TIDES_PARAM_STRING = 3
TIDES_PARAM_CHOICE = 4
TIDES_PARAM_VECTOR3 = 5
TIDES_PARAM_OBJECTS = 6
TIDES_PARAM_VECTOR2 = 7
TIDES_TRACKS_RANDOM = 0
TIDES_TRACKS_GRID = 1
TIDES_TRACKS_INSTANCE = 2
TIDES_PRESET_NAME = 32
TIDES_RIG_BOTH = 0
TIDES_RIG_EVENT = 1
TIDES_RIG_FRAME = 2
TIDES_RIG_NAME = 32
TIDES_SILENCE = 256
TIDES_EXR_NONE = 0
TIDES_EXR_ZIPS = 2
TIDES_EXR_ZIP = 3
TIDES_TRUTH_FLOW_U = 0
TIDES_TRUTH_FLOW_V = 1
TIDES_TRUTH_DEPTH = 2
TIDES_TRUTH_DEPTH_MEDIAN = 3
TIDES_TRUTH_ALPHA = 4
TIDES_TRUTH_INSTANCE = 5
TIDES_TRUTH_NORMAL_X = 6
TIDES_TRUTH_NORMAL_Y = 7
TIDES_TRUTH_NORMAL_Z = 8
TIDES_TRUTHS = 9
TIDES_METRIC_COUNTS = 1
TIDES_METRIC_ISI = 2
TIDES_METRIC_SAME_TIME = 4
TIDES_METRIC_FANO = 8
TIDES_METRIC_CHAMFER = 16
TIDES_METRIC_VICTOR_PURPURA = 32
TIDES_METRIC_VAN_ROSSUM = 64
TIDES_METRIC_TIME_DIFFERENCE = 128
TIDES_METRIC_KERNEL = 256
TIDES_METRIC_MATCH = 512
TIDES_METRICS_DEFAULT = 255
TIDES_METRICS_ALL = 1023
TIDES_PAIRS_ANY = 0
TIDES_PAIRS_SAME = 1
TIDES_PAIRS_SPLIT = 2
TIDES_PAIRS = 3
TIDES_FANO_BINS = 3
TIDES_OF_BOTH = 0
TIDES_OF_STREAM = 1
TIDES_REPEATS_ONCE = 0
TIDES_REPEATS_PAIRS = 1
TIDES_REPEATS_BINS = 2
TIDES_BETTER_NEITHER = 0
TIDES_BETTER_LOWER = 1
TIDES_BETTER_HIGHER = 2
TIDES_BETTER_ONE = 3
TIDES_BETTER_ZERO = 4
TIDES_NORMALISE_NONE = 0
TIDES_NORMALISE_POPULATION = 1
TIDES_NORMALISE_SAMPLE = 2
TIDES_VOXEL_E2VID = 0
TIDES_VOXEL_DSEC = 1
TIDES_VOXEL_TIMELENS = 2
TIDES_LIVE_CAMERA = -1
TIDES_IDEAL_THRESHOLDS = 1
TIDES_IDEAL_PIXEL = 2
TIDES_IDEAL_SENSOR = 4
TIDES_CALIBRATED_ON = 0
TIDES_CALIBRATED_OFF = 1
TIDES_CALIBRATED_SIGMA = 2
TIDES_CALIBRATED_EPS = 3
TIDES_CALIBRATED_POLE = 4
TIDES_CALIBRATED_REFRACTORY = 5
TIDES_CALIBRATED_LEAK = 6
TIDES_CALIBRATED_SHOT = 7
TIDES_CALIBRATED_OFFSET = 8
TIDES_CALIBRATED_VALUES = 9
TIDES_CALIBRATED_UNKNOWN = 0
TIDES_CALIBRATED_MEASURED = 1
TIDES_CALIBRATED_UNCERTAIN = 2
TIDES_CALIBRATED_BOUND = 3
TIDES_CALIBRATED_GIVEN = 4
TIDES_CALIBRATION_SCAN = 25
TIDES_CALIBRATION_HOT = 256

# Opaque objects: only pointers to them exist here.


class tides_frames(Structure):
    pass


class tides_event_writer(Structure):
    pass


class tides_event_reader(Structure):
    pass


class tides_arbiter(Structure):
    pass


class tides_filter(Structure):
    pass


class tides_trajectory(Structure):
    pass


class tides_device(Structure):
    pass


class tides_motion(Structure):
    pass


class tides_scene(Structure):
    pass


class tides_renderer(Structure):
    pass


class tides_simulator(Structure):
    pass


class tides_baseline(Structure):
    pass


class tides_run(Structure):
    pass


class tides_session(Structure):
    pass


class tides_exr(Structure):
    pass


class tides_animation(Structure):
    pass


class tides_array_writer(Structure):
    pass


class tides_fingerprints(Structure):
    pass


class tides_live(Structure):
    pass


class tides_error(Structure):
    """tides_status status; /* TIDES_OK, or what went wrong */
    char text[1020]; /* one line: what, where, and how to put it right */
    """

    status: int
    text: Any

    _fields_ = [
        ("status", c_int32),
        ("text", c_char * 1020),
    ]


tides_progress = CFUNCTYPE(c_int, c_void_p, c_double, c_char_p)


class tides_frames_options(Structure):
    """uint32_t size;
    int32_t transfer; /* TIDES_TRANSFER_LINEAR or _SRGB */
    int32_t unit; /* TIDES_TIME_* of timestamp files and of arrays with times; AUTO: as its header says, else
    microseconds in image_timestamps.txt (DSEC), else the unit in which frames come 1 to 1000
    times a second, or count from 1970 */
    int32_t rebase; /* 1: the first frame's time becomes 0 */
    const char *timestamps; /* text file with a time per line, after names or an index, with or without header; or NULL */
    double frames_per_second; /* [Hz]: frame k is at k / rate; 0: not given */
    double luminance[3]; /* weights of r, g, b */
    int32_t planes; /* 1: luminance; more: arrays with this many values per pixel, used unchanged (voxel grids) */
    double offset_s; /* [s] added to all times, after `rebase` */
    double full_scale; /* the stored value that means light 1; 0: the type's largest value, or found from the values */
    """

    size: int
    transfer: int
    unit: int
    rebase: int
    timestamps: bytes | None
    frames_per_second: float
    luminance: Any
    planes: int
    offset_s: float
    full_scale: float

    _fields_ = [
        ("size", c_uint32),
        ("transfer", c_int32),
        ("unit", c_int32),
        ("rebase", c_int32),
        ("timestamps", c_char_p),
        ("frames_per_second", c_double),
        ("luminance", c_double * 3),
        ("planes", c_int32),
        ("offset_s", c_double),
        ("full_scale", c_double),
    ]


class tides_event(Structure):
    """int64_t t; /* [ns] on the run's clock, which is that of the scene and the path */
    uint16_t x, y; /* [px] */
    int8_t polarity; /* +1 or -1 */
    uint8_t cause; /* TIDES_CAUSE_*: the signal, or which noise */
    uint16_t frontend; /* tides_event_frontend as IEEE 754 binary16, to one part in 2048 */
    """

    t: int
    x: int
    y: int
    polarity: int
    cause: int
    frontend: int

    _fields_ = [
        ("t", c_int64),
        ("x", c_uint16),
        ("y", c_uint16),
        ("polarity", c_int8),
        ("cause", c_uint8),
        ("frontend", c_uint16),
    ]


class tides_event_file(Structure):
    """int32_t width, height; /* [px] */
    const char *run; /* run file as JSON text, or NULL */
    const char *seed; /* or NULL */
    int32_t labels; /* 1: with all labels; TIDES_UNSUPPORTED but in HDF5. 0: HDF5 has causes, if some aren't the signal's */
    /* [ns] The recording's stretch; both 0: unknown. If known, a stretch that the format can't hold is TIDES_UNSUPPORTED at
    * once; else the first event that doesn't fit is. HDF5 counts its 32-bit microseconds from t_offset: 0 if the stretch ends
    * before 4294.967 s, else its start. An unknown stretch is taken to last half an hour from the first event. */
    int64_t start_ns, stop_ns; /* as above */
    """

    width: int
    height: int
    run: bytes | None
    seed: bytes | None
    labels: int
    start_ns: int
    stop_ns: int

    _fields_ = [
        ("width", c_int32),
        ("height", c_int32),
        ("run", c_char_p),
        ("seed", c_char_p),
        ("labels", c_int32),
        ("start_ns", c_int64),
        ("stop_ns", c_int64),
    ]


class tides_event_format(Structure):
    """const char *name, *summary, *endings; /* static storage */
    int32_t reads, writes; /* 1 where the library can */
    int64_t tick_ns; /* times are floored to it on writing */
    """

    name: bytes | None
    summary: bytes | None
    endings: bytes | None
    reads: int
    writes: int
    tick_ns: int

    _fields_ = [
        ("name", c_char_p),
        ("summary", c_char_p),
        ("endings", c_char_p),
        ("reads", c_int32),
        ("writes", c_int32),
        ("tick_ns", c_int64),
    ]


class tides_event_facts(Structure):
    """char format[32]; /* "evt3" ...; of HDF5 its layout: "tides", "dsec", "eds", "mvsec", "v2e", "timostoff", "m3ed", "rvt";
    of a folder that of its files */
    char version[32]; /* of TIDES that wrote it, or "" */
    int32_t width, height; /* [px]; 0 where the file doesn't say */
    int32_t counted; /* 1: count is known without reading the file */
    uint64_t count; /* events; where `counted` */
    int32_t labels; /* TIDES_LABEL_* that the file has, for tides_events_labels */
    int32_t zero; /* TIDES_ZERO_* */
    int64_t start_ns, stop_ns; /* the recording's stretch; both 0: the file doesn't say. Our HDF5 does once it is complete */
    int64_t zero_ns; /* the recording's zero on the file's clock; with TIDES_ZERO_EVENT 0 until an event was read */
    uint64_t dropped; /* events that were left out so far (drop_invalid) */
    char read_as[160]; /* how columns and unit were decided where the format leaves them open, else "" */
    """

    format: Any
    version: Any
    width: int
    height: int
    counted: int
    count: int
    labels: int
    zero: int
    start_ns: int
    stop_ns: int
    zero_ns: int
    dropped: int
    read_as: Any

    _fields_ = [
        ("format", c_char * 32),
        ("version", c_char * 32),
        ("width", c_int32),
        ("height", c_int32),
        ("counted", c_int32),
        ("count", c_uint64),
        ("labels", c_int32),
        ("zero", c_int32),
        ("start_ns", c_int64),
        ("stop_ns", c_int64),
        ("zero_ns", c_int64),
        ("dropped", c_uint64),
        ("read_as", c_char * 160),
    ]


class tides_event_reading(Structure):
    """uint32_t size; /* sizeof this struct */
    /* 1: invalid events (outside the sensor, a wrong polarity, NaN) are left out and counted in the facts; 0: they fail */
    int32_t drop_invalid;
    const char *format; /* a name; NULL: by content */
    const char *columns; /* of text and tables: "t,x,y,p", "-,x,y,p,t" ("-" isn't read); NULL: as their header says, else the
    * only order that their values allow */
    const char *unit; /* of the times: "s", "ms", "us", "ns"; NULL: as format or header say, else found from the values */
    const char *stream; /* name of one of the file's streams, which errors list; NULL: the only one */
    int64_t offset_ns; /* added to all times, after `rebase` */
    int32_t rebase; /* 1: times count from the recording's zero (tides_event_facts.zero_ns) */
    int32_t reserved;
    """

    size: int
    drop_invalid: int
    format: bytes | None
    columns: bytes | None
    unit: bytes | None
    stream: bytes | None
    offset_ns: int
    rebase: int
    reserved: int

    _fields_ = [
        ("size", c_uint32),
        ("drop_invalid", c_int32),
        ("format", c_char_p),
        ("columns", c_char_p),
        ("unit", c_char_p),
        ("stream", c_char_p),
        ("offset_ns", c_int64),
        ("rebase", c_int32),
        ("reserved", c_int32),
    ]


class tides_event_summary(Structure):
    """uint64_t count, count_on; /* events, and those that are ON */
    uint64_t disorder; /* events that are earlier than the one before in the file */
    int64_t first_ns, last_ns; /* the earliest and the latest; 0 without events */
    int32_t width, height; /* 0 where the file doesn't say */
    int32_t right, bottom; /* the largest x + 1 and y + 1 [px] */
    char layout[32]; /* as tides_event_facts.format */
    char version[32]; /* of the writer, or "" */
    int32_t labels; /* as tides_event_facts.labels */
    """

    count: int
    count_on: int
    disorder: int
    first_ns: int
    last_ns: int
    width: int
    height: int
    right: int
    bottom: int
    layout: Any
    version: Any
    labels: int

    _fields_ = [
        ("count", c_uint64),
        ("count_on", c_uint64),
        ("disorder", c_uint64),
        ("first_ns", c_int64),
        ("last_ns", c_int64),
        ("width", c_int32),
        ("height", c_int32),
        ("right", c_int32),
        ("bottom", c_int32),
        ("layout", c_char * 32),
        ("version", c_char * 32),
        ("labels", c_int32),
    ]


class tides_readout(Structure):
    """uint32_t size;
    int32_t enabled; /* 1: a run uses it; an arbiter itself ignores this */
    int32_t kind; /* TIDES_READOUT_* */
    int32_t tile_px; /* side of a tile [px], >= 1 */
    int32_t k0; /* events per tick at rest, >= 1 */
    int32_t queue_capacity; /* events that wait in one queue, >= 1 */
    double tick_s; /* [s]: whole nanoseconds; 0: infinite rate */
    double beta_k; /* in [0, 1] */
    double p0, eta; /* in [0, 1] */
    double sigma0_s, gamma_sigma_s; /* [s] >= 0 */
    int32_t jitter_law; /* TIDES_JITTER_* */
    int32_t stamp; /* TIDES_STAMP_*, of REQUESTED */
    double row_s; /* [s] >= 0, whole nanoseconds */
    double event_s; /* [s] 0 to 1e-3, whole picoseconds */
    double frame_s; /* [s] whole nanoseconds, at least 1 */
    """

    size: int
    enabled: int
    kind: int
    tile_px: int
    k0: int
    queue_capacity: int
    tick_s: float
    beta_k: float
    p0: float
    eta: float
    sigma0_s: float
    gamma_sigma_s: float
    jitter_law: int
    stamp: int
    row_s: float
    event_s: float
    frame_s: float

    _fields_ = [
        ("size", c_uint32),
        ("enabled", c_int32),
        ("kind", c_int32),
        ("tile_px", c_int32),
        ("k0", c_int32),
        ("queue_capacity", c_int32),
        ("tick_s", c_double),
        ("beta_k", c_double),
        ("p0", c_double),
        ("eta", c_double),
        ("sigma0_s", c_double),
        ("gamma_sigma_s", c_double),
        ("jitter_law", c_int32),
        ("stamp", c_int32),
        ("row_s", c_double),
        ("event_s", c_double),
        ("frame_s", c_double),
    ]


class tides_readout_stats(Structure):
    """uint64_t in, out; /* events given to it; events that left */
    uint64_t dropped; /* by chance */
    uint64_t overflowed; /* lost because their queue was full */
    uint64_t waiting; /* in queues, or held until the order is certain */
    uint64_t delayed; /* left later than they fired, jitter aside */
    uint64_t ticks; /* ticks in which something was served, or rows or frames that were read; idle ticks are skipped */
    double worst_delay_s; /* from firing to leaving, jitter aside [s] */
    """

    out: int
    dropped: int
    overflowed: int
    waiting: int
    delayed: int
    ticks: int
    worst_delay_s: float

    _fields_ = [
        ("in", c_uint64),
        ("out", c_uint64),
        ("dropped", c_uint64),
        ("overflowed", c_uint64),
        ("waiting", c_uint64),
        ("delayed", c_uint64),
        ("ticks", c_uint64),
        ("worst_delay_s", c_double),
    ]


tides_readout_sink = CFUNCTYPE(c_int, c_void_p, P(tides_event), P(c_int64), c_size_t)


class tides_filters(Structure):
    """uint32_t size;
    int32_t background_support; /* 1 to 8 */
    double background_s; /* [s] >= 0; 0: off */
    double activity_low_start, activity_low_stop; /* [events/s] bound below; start 0: none; stop 0: equal to start, */
    double activity_high_start, activity_high_stop; /* else low_stop >= low_start and high_stop <= high_start */
    double activity_period_s; /* [s] whole nanoseconds, at least 1 */
    double afk_low_hz, afk_high_hz; /* [Hz] 0 < low <= high */
    int32_t afk; /* TIDES_AFK_* */
    int32_t afk_cell_px; /* side of a cell [px] >= 1 */
    int32_t afk_start, afk_stop; /* 0 <= stop < start <= 7 */
    double trail_s; /* [s] >= 0 */
    int32_t trail; /* TIDES_TRAIL_* */
    int32_t erc_events; /* >= 0; 0: off */
    double erc_period_s; /* [s] whole nanoseconds, at least 1 */
    int32_t erc_law; /* TIDES_ERC_* */
    int32_t reserved;
    """

    size: int
    background_support: int
    background_s: float
    activity_low_start: float
    activity_low_stop: float
    activity_high_start: float
    activity_high_stop: float
    activity_period_s: float
    afk_low_hz: float
    afk_high_hz: float
    afk: int
    afk_cell_px: int
    afk_start: int
    afk_stop: int
    trail_s: float
    trail: int
    erc_events: int
    erc_period_s: float
    erc_law: int
    reserved: int

    _fields_ = [
        ("size", c_uint32),
        ("background_support", c_int32),
        ("background_s", c_double),
        ("activity_low_start", c_double),
        ("activity_low_stop", c_double),
        ("activity_high_start", c_double),
        ("activity_high_stop", c_double),
        ("activity_period_s", c_double),
        ("afk_low_hz", c_double),
        ("afk_high_hz", c_double),
        ("afk", c_int32),
        ("afk_cell_px", c_int32),
        ("afk_start", c_int32),
        ("afk_stop", c_int32),
        ("trail_s", c_double),
        ("trail", c_int32),
        ("erc_events", c_int32),
        ("erc_period_s", c_double),
        ("erc_law", c_int32),
        ("reserved", c_int32),
    ]


class tides_filter_stats(Structure):
    """uint64_t in, out; /* events given, and passed */
    uint64_t dropped[TIDES_STAGES]; /* by TIDES_STAGE_* */
    """

    out: int
    dropped: Any

    _fields_ = [
        ("in", c_uint64),
        ("out", c_uint64),
        ("dropped", c_uint64 * 5),
    ]


class tides_pose_sample(Structure):
    """double time; /* [s] */
    double position[3]; /* body origin in the world [scene units] */
    double quaternion[4]; /* body to world, wxyz; normalised here */
    double velocity[3]; /* d(position)/dt [scene units/s] */
    double angular_velocity[3]; /* in world axes [rad/s] */
    int32_t has_rates; /* 1: velocity and angular_velocity are given */
    int32_t reserved;
    """

    time: float
    position: Any
    quaternion: Any
    velocity: Any
    angular_velocity: Any
    has_rates: int
    reserved: int

    _fields_ = [
        ("time", c_double),
        ("position", c_double * 3),
        ("quaternion", c_double * 4),
        ("velocity", c_double * 3),
        ("angular_velocity", c_double * 3),
        ("has_rates", c_int32),
        ("reserved", c_int32),
    ]


class tides_pose(Structure):
    """double rotation[9]; /* body to world */
    double rotation_dot[9]; /* [1/s] */
    double position[3]; /* [scene units] */
    double position_dot[3]; /* [scene units/s] */
    """

    rotation: Any
    rotation_dot: Any
    position: Any
    position_dot: Any

    _fields_ = [
        ("rotation", c_double * 9),
        ("rotation_dot", c_double * 9),
        ("position", c_double * 3),
        ("position_dot", c_double * 3),
    ]


class tides_orbit(Structure):
    """double target[3], up[3]; /* world axes [scene units]; `up` of any length */
    double radius, height; /* [scene units] */
    double start_angle; /* [rad] */
    double angular_speed; /* [rad/s] */
    double start, stop; /* [s] */
    """

    target: Any
    up: Any
    radius: float
    height: float
    start_angle: float
    angular_speed: float
    start: float
    stop: float

    _fields_ = [
        ("target", c_double * 3),
        ("up", c_double * 3),
        ("radius", c_double),
        ("height", c_double),
        ("start_angle", c_double),
        ("angular_speed", c_double),
        ("start", c_double),
        ("stop", c_double),
    ]


class tides_dolly(Structure):
    """double from[3], to[3], target[3], up[3]; /* world axes [scene units]; `up` of any length */
    double start, stop; /* [s] */
    """

    to: Any
    target: Any
    up: Any
    start: float
    stop: float

    _fields_ = [
        ("from", c_double * 3),
        ("to", c_double * 3),
        ("target", c_double * 3),
        ("up", c_double * 3),
        ("start", c_double),
        ("stop", c_double),
    ]


class tides_handheld(Structure):
    """double position[3], target[3], up[3]; /* world axes [scene units]; `up` of any length */
    double position_amplitude; /* [scene units], rms per axis */
    double rotation_amplitude; /* [rad], rms per axis */
    double frequency; /* [Hz], of the slowest sine; the fastest is 5 times that */
    uint64_t seed; /* of the phases */
    double start, stop; /* [s] */
    """

    position: Any
    target: Any
    up: Any
    position_amplitude: float
    rotation_amplitude: float
    frequency: float
    seed: int
    start: float
    stop: float

    _fields_ = [
        ("position", c_double * 3),
        ("target", c_double * 3),
        ("up", c_double * 3),
        ("position_amplitude", c_double),
        ("rotation_amplitude", c_double),
        ("frequency", c_double),
        ("seed", c_uint64),
        ("start", c_double),
        ("stop", c_double),
    ]


class tides_lens(Structure):
    """int32_t model; /* TIDES_LENS_* */
    int32_t reserved;
    double k1, k2, k3, k4, p1, p2; /* [1] 0 where the model has no such term */
    """

    model: int
    reserved: int
    k1: float
    k2: float
    k3: float
    k4: float
    p1: float
    p2: float

    _fields_ = [
        ("model", c_int32),
        ("reserved", c_int32),
        ("k1", c_double),
        ("k2", c_double),
        ("k3", c_double),
        ("k4", c_double),
        ("p1", c_double),
        ("p2", c_double),
    ]


class tides_intrinsics(Structure):
    """int32_t width, height; /* [px] */
    double fx, fy, cx, cy; /* [px] */
    tides_lens lens; /* zeros: a pinhole */
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    lens: tides_lens

    _fields_ = [
        ("width", c_int32),
        ("height", c_int32),
        ("fx", c_double),
        ("fy", c_double),
        ("cx", c_double),
        ("cy", c_double),
        ("lens", tides_lens),
    ]


class tides_path_options(Structure):
    """uint32_t size; /* sizeof this struct, set by the defaults function */
    int32_t time_unit; /* TIDES_TIME_* of a file's times; AUTO: as its header says, else the format's usual unit if plausible */
    double duration; /* [s] files without times (cameras.json, COLMAP, LLFF ...): poses are spread evenly over
    [0, duration], in the order of pictures' names, with digits as numbers, where the file has
    them, else of the file; files with trainer's times in [0, 1]
    (D-NeRF, nerfies): times are multiplied by it */
    double start; /* [s] subtracted from every time, after scaling */
    int32_t rebase; /* 1: the first sample is at 0, and `start` is ignored */
    int32_t raw_positions; /* nerfies: 1 leaves positions as the camera files have them (as 4DGaussians trains) instead of
    applying scene.json (as Nerfies, HyperNeRF and Deformable-3D-Gaussians do) */
    const char *views; /* which poses to keep, as Python slices with commas between: "7", "0:100:10", "3,5,-1"; NULL:
    all. Counted from 0 in the path's order: of times, of images' names, else of the file. The
    poses kept of a file without times are spread over `duration` */
    int32_t body; /* EuRoC: 1 leaves the body's poses as they are instead of putting its camera there (T_BS of sensor.yaml) */
    int32_t reserved;
    const char *frame; /* transforms.json and COLMAP: nerfstudio's dataparser_transforms.json, which puts cameras where
    ns-export puts splats; NULL: the one beside the file; "none": as the file has them */
    """

    size: int
    time_unit: int
    duration: float
    start: float
    rebase: int
    raw_positions: int
    views: bytes | None
    body: int
    reserved: int
    frame: bytes | None

    _fields_ = [
        ("size", c_uint32),
        ("time_unit", c_int32),
        ("duration", c_double),
        ("start", c_double),
        ("rebase", c_int32),
        ("raw_positions", c_int32),
        ("views", c_char_p),
        ("body", c_int32),
        ("reserved", c_int32),
        ("frame", c_char_p),
    ]


class tides_path(Structure):
    """tides_trajectory *trajectory; /* owned by the caller after success */
    tides_intrinsics intrinsics; /* fields that the file lacks, or that differ from frame to frame, are 0 */
    double field_of_view_x; /* [rad] if the file gives one (Blender and D-NeRF give it without a width), else 0 */
    char format[32]; /* "tides", "transforms", "camera_path", "cameras", "tum", "esim", "euroc", "kitti", "colmap", "llff",
    "nerfies" */
    int32_t distorted; /* 1: the file's lens is no tides_lens, or differs from frame to frame. Runs then want camera.lens.
    Focal lengths are the file's. Those of COLMAP's FOV are multiplied by the lens's magnification
    at its axis */
    int32_t untimed; /* 1: the file has several poses without times; they are spread over options.duration */
    int32_t varied; /* TIDES_VARIED_* of intrinsics that are 0 because they differ from frame to frame */
    int32_t framed; /* 1: dataparser_transforms.json was applied */
    int32_t reserved;
    int32_t has_imu; /* 1: the folder of the file says where an IMU is (EuRoC) */
    double T_C_I[16]; /* if has_imu: p_camera = T_C_I p_imu, row-major */
    /* surprising facts about the path, a line each, such as poses that leap, or a unit that was guessed; else "" */
    char notes[TIDES_PATH_NOTES];
    """

    trajectory: Any
    intrinsics: tides_intrinsics
    field_of_view_x: float
    format: Any
    distorted: int
    untimed: int
    varied: int
    framed: int
    reserved: int
    has_imu: int
    T_C_I: Any
    notes: Any

    _fields_ = [
        ("trajectory", P(tides_trajectory)),
        ("intrinsics", tides_intrinsics),
        ("field_of_view_x", c_double),
        ("format", c_char * 32),
        ("distorted", c_int32),
        ("untimed", c_int32),
        ("varied", c_int32),
        ("framed", c_int32),
        ("reserved", c_int32),
        ("has_imu", c_int32),
        ("T_C_I", c_double * 16),
        ("notes", c_char * 1024),
    ]


class tides_device_info(Structure):
    """int32_t kind; /* TIDES_DEVICE_CPU, _GPU, _OTHER, _REFERENCE */
    int32_t index; /* index that a `spec` may name; -1: the reference */
    char name[128]; /* CL_DEVICE_NAME */
    char platform[128]; /* CL_PLATFORM_NAME */
    char driver[128]; /* CL_DEVICE_VERSION and CL_DRIVER_VERSION */
    int32_t compute_units; /* CL_DEVICE_MAX_COMPUTE_UNITS */
    int32_t lanes; /* pixels per work-item that kernels are built for */
    /* 0: fma() is slow, so products and sums are rounded separately, and events differ by some 20 ns from those of other
    * devices, which are all bit-identical; else 1 */
    int32_t fused;
    int32_t vector_bits; /* width of the registers that numbers of kernels are in; the reference: of wide loops. 0: unknown */
    uint64_t memory_bytes; /* CL_DEVICE_GLOBAL_MEM_SIZE */
    """

    kind: int
    index: int
    name: Any
    platform: Any
    driver: Any
    compute_units: int
    lanes: int
    fused: int
    vector_bits: int
    memory_bytes: int

    _fields_ = [
        ("kind", c_int32),
        ("index", c_int32),
        ("name", c_char * 128),
        ("platform", c_char * 128),
        ("driver", c_char * 128),
        ("compute_units", c_int32),
        ("lanes", c_int32),
        ("fused", c_int32),
        ("vector_bits", c_int32),
        ("memory_bytes", c_uint64),
    ]


class tides_polynomial_motion(Structure):
    """int64_t count; /* N */
    double start, stop; /* [tau] */
    const float *opacity_centre; /* [tau] (N) */
    const float *opacity_log_width; /* ln [tau], within +-80 (N) */
    const float *mean_coefficient; /* c_1, c_2, c_3: xyz each [scene units / tau^k] (N x 9) */
    const float *quaternion_dot; /* wxyz [1 / tau] (N x 4) */
    int32_t plain_colour; /* 1: colours are as given, not cut at 0 (the lite model) */
    int32_t decoder; /* TIDES_DECODER_...; other than NONE: the full model, with */
    const float *feature; /* albedo 3, then 3 more (N x 6) */
    const float *feature_dot; /* of the last 3 of nine: dt times these [1 / tau] (N x 3) */
    const float *decoder_first; /* W_1, row-major (6 x 12) */
    const float *decoder_second; /* W_2 (3 x 6) */
    """

    count: int
    start: float
    stop: float
    opacity_centre: Any
    opacity_log_width: Any
    mean_coefficient: Any
    quaternion_dot: Any
    plain_colour: int
    decoder: int
    feature: Any
    feature_dot: Any
    decoder_first: Any
    decoder_second: Any

    _fields_ = [
        ("count", c_int64),
        ("start", c_double),
        ("stop", c_double),
        ("opacity_centre", P(c_float)),
        ("opacity_log_width", P(c_float)),
        ("mean_coefficient", P(c_float)),
        ("quaternion_dot", P(c_float)),
        ("plain_colour", c_int32),
        ("decoder", c_int32),
        ("feature", P(c_float)),
        ("feature_dot", P(c_float)),
        ("decoder_first", P(c_float)),
        ("decoder_second", P(c_float)),
    ]


class tides_rotor_motion(Structure):
    """int64_t count; /* N */
    double start, stop; /* [tau] */
    double period; /* [tau]; 0: stop - start */
    double time_prefilter; /* [tau^2]; 0 or less: none */
    const float *centre; /* [tau] (N) */
    const float *log_scale_time; /* ln [tau] (N) */
    const float *quaternion_right; /* NULL: none (N x 4) */
    const float *sh_harmonic; /* sh_1, sh_2 .. (N x harmonics x K x 3) */
    int32_t harmonics; /* 0..4; their sh_degree_t */
    int32_t sh_degree; /* of K = (sh_degree + 1)^2: the Gaussians' own */
    """

    count: int
    start: float
    stop: float
    period: float
    time_prefilter: float
    centre: Any
    log_scale_time: Any
    quaternion_right: Any
    sh_harmonic: Any
    harmonics: int
    sh_degree: int

    _fields_ = [
        ("count", c_int64),
        ("start", c_double),
        ("stop", c_double),
        ("period", c_double),
        ("time_prefilter", c_double),
        ("centre", P(c_float)),
        ("log_scale_time", P(c_float)),
        ("quaternion_right", P(c_float)),
        ("sh_harmonic", P(c_float)),
        ("harmonics", c_int32),
        ("sh_degree", c_int32),
    ]


class tides_keyframes_motion(Structure):
    """int64_t frames, count; /* T >= 2, N */
    const double *time; /* any unit, strictly rising (T) */
    const float *mean; /* [scene units] (T x N x 3) */
    const float *quaternion; /* wxyz, raw (T x N x 4) */
    const float *log_scale; /* ln [scene units]; or NULL (T x N x 3) */
    const float *opacity_logit; /* or NULL (T x N) */
    const float *sh; /* or NULL (T x N x K x 3) */
    int32_t sh_degree; /* of K = (sh_degree + 1)^2: the Gaussians' own */
    int32_t catmull_rom; /* 1: Catmull and Rom's C1 cubics instead */
    int32_t plain_colour; /* 1: colours aren't cut at 0 */
    int32_t reserved;
    const double *mean_double; /* NULL, or the means in double, in place of `mean` (T x N x 3) */
    """

    frames: int
    count: int
    time: Any
    mean: Any
    quaternion: Any
    log_scale: Any
    opacity_logit: Any
    sh: Any
    sh_degree: int
    catmull_rom: int
    plain_colour: int
    reserved: int
    mean_double: Any

    _fields_ = [
        ("frames", c_int64),
        ("count", c_int64),
        ("time", P(c_double)),
        ("mean", P(c_float)),
        ("quaternion", P(c_float)),
        ("log_scale", P(c_float)),
        ("opacity_logit", P(c_float)),
        ("sh", P(c_float)),
        ("sh_degree", c_int32),
        ("catmull_rom", c_int32),
        ("plain_colour", c_int32),
        ("reserved", c_int32),
        ("mean_double", P(c_double)),
    ]


class tides_theta(Structure):
    """double *mean, *mean_dot; /* (count x 3) */
    double *log_scale, *log_scale_dot; /* (count x 3) */
    double *quaternion, *quaternion_dot; /* (count x 4) */
    double *opacity_logit, *opacity_logit_dot; /* (count) */
    double *sh, *sh_dot; /* (count x K x 3); NULL unless the motion moves them */
    """

    mean: Any
    mean_dot: Any
    log_scale: Any
    log_scale_dot: Any
    quaternion: Any
    quaternion_dot: Any
    opacity_logit: Any
    opacity_logit_dot: Any
    sh: Any
    sh_dot: Any

    _fields_ = [
        ("mean", P(c_double)),
        ("mean_dot", P(c_double)),
        ("log_scale", P(c_double)),
        ("log_scale_dot", P(c_double)),
        ("quaternion", P(c_double)),
        ("quaternion_dot", P(c_double)),
        ("opacity_logit", P(c_double)),
        ("opacity_logit_dot", P(c_double)),
        ("sh", P(c_double)),
        ("sh_dot", P(c_double)),
    ]


tides_motion_function = CFUNCTYPE(c_int32, c_void_p, c_double, c_int32, P(c_int32), c_int64, P(tides_theta), P(tides_error))


class tides_callback_motion(Structure):
    """int64_t count; /* N */
    double start, stop; /* its own clock, any unit */
    tides_motion_function function; /* fills values and rates */
    void *user; /* its first argument */
    int32_t moves_sh; /* 1: it also fills sh and sh_dot */
    int32_t reserved;
    /* about the shortest period: how long motion may go on unseen between values and rates at the start, the middle and the
    * end. 0: one macro step of the run (step_s), at least */
    double time_scale;
    """

    count: int
    start: float
    stop: float
    function: Any
    user: int
    moves_sh: int
    reserved: int
    time_scale: float

    _fields_ = [
        ("count", c_int64),
        ("start", c_double),
        ("stop", c_double),
        ("function", tides_motion_function),
        ("user", c_void_p),
        ("moves_sh", c_int32),
        ("reserved", c_int32),
        ("time_scale", c_double),
    ]


class tides_gaussians(Structure):
    """int64_t count; /* N */
    int32_t sh_degree; /* 0..4 */
    int32_t trained; /* TIDES_TRAINED_* */
    const float *mean; /* [scene units] (N x 3) */
    const float *log_scale; /* ln [scene units] (N x 3) */
    const float *quaternion; /* wxyz, raw (N x 4) */
    const float *opacity_logit; /* (N) */
    const float *sh; /* coefficient, then r g b (N x K x 3) */
    double origin[3]; /* [scene units] what means are relative to: a Gaussian is at origin + mean */
    const double *mean_double; /* [scene units] NULL, or the means in double, in place of `mean` (N x 3) */
    int32_t transfer; /* TIDES_TRANSFER_LINEAR (0), _SRGB or _GAMMA: how composited colours code light */
    int32_t reserved;
    double gamma; /* with GAMMA: light = colour^gamma, 1 to 5 */
    """

    count: int
    sh_degree: int
    trained: int
    mean: Any
    log_scale: Any
    quaternion: Any
    opacity_logit: Any
    sh: Any
    origin: Any
    mean_double: Any
    transfer: int
    reserved: int
    gamma: float

    _fields_ = [
        ("count", c_int64),
        ("sh_degree", c_int32),
        ("trained", c_int32),
        ("mean", P(c_float)),
        ("log_scale", P(c_float)),
        ("quaternion", P(c_float)),
        ("opacity_logit", P(c_float)),
        ("sh", P(c_float)),
        ("origin", c_double * 3),
        ("mean_double", P(c_double)),
        ("transfer", c_int32),
        ("reserved", c_int32),
        ("gamma", c_double),
    ]


class tides_scene_options(Structure):
    """uint32_t size;
    /* The part to read of a file that has several: a glTF's scene or an .h5's object by name or number, a streamed SOG's level
    * of detail (0: the finest), a trained model's iteration. NULL: the glTF's default scene, all objects, the finest level,
    * the newest iteration; tides_scene_notes lists the other parts. Where a file has no parts, or not this one:
    * TIDES_BAD_ARGUMENT. */
    const char *part;
    int32_t invalid; /* TIDES_INVALID_* */
    int32_t reserved;
    """

    size: int
    part: bytes | None
    invalid: int
    reserved: int

    _fields_ = [
        ("size", c_uint32),
        ("part", c_char_p),
        ("invalid", c_int32),
        ("reserved", c_int32),
    ]


class tides_scene_format(Structure):
    """const char *endings; /* or names of files in a folder, separated by blanks; static */
    const char *summary; /* a few words; static */
    int32_t writes; /* 1: the library writes it */
    int32_t losses; /* TIDES_LOSES_*: what a file of this format can't hold */
    """

    endings: bytes | None
    summary: bytes | None
    writes: int
    losses: int

    _fields_ = [
        ("endings", c_char_p),
        ("summary", c_char_p),
        ("writes", c_int32),
        ("losses", c_int32),
    ]


class tides_object(Structure):
    """tides_gaussians gaussians; /* views of its arrays */
    const tides_trajectory *trajectory; /* NULL: at rest */
    double scale; /* of the object in the world [1] */
    const char *name; /* or "" */
    const char *source; /* file it came from, or "" */
    const tides_motion *motion; /* NULL: the Gaussians don't move by themselves */
    double duration_s; /* [s] how long the motion lasts; 0 without one */
    """

    gaussians: tides_gaussians
    trajectory: Any
    scale: float
    name: bytes | None
    source: bytes | None
    motion: Any
    duration_s: float

    _fields_ = [
        ("gaussians", tides_gaussians),
        ("trajectory", P(tides_trajectory)),
        ("scale", c_double),
        ("name", c_char_p),
        ("source", c_char_p),
        ("motion", P(tides_motion)),
        ("duration_s", c_double),
    ]


class tides_circuit(Structure):
    """double photocurrent_a; /* at Y = 1 [A] */
    double dark_current_a; /* [A], > 0 */
    double gain, kappa; /* amplifier gain A, back-gate coefficient; A kappa <= 1e4 */
    double thermal_v; /* V_T [V] */
    double photodiode_f; /* C_p [F] */
    double miller_f; /* C_mil [F] */
    double output_s; /* tau_out [s] */
    double source_follower_hz; /* 0: left out */
    double difference_hz; /* 0: left out */
    """

    photocurrent_a: float
    dark_current_a: float
    gain: float
    kappa: float
    thermal_v: float
    photodiode_f: float
    miller_f: float
    output_s: float
    source_follower_hz: float
    difference_hz: float

    _fields_ = [
        ("photocurrent_a", c_double),
        ("dark_current_a", c_double),
        ("gain", c_double),
        ("kappa", c_double),
        ("thermal_v", c_double),
        ("photodiode_f", c_double),
        ("miller_f", c_double),
        ("output_s", c_double),
        ("source_follower_hz", c_double),
        ("difference_hz", c_double),
    ]


class tides_sensor(Structure):
    """uint32_t size;
    /* Limit per pixel and step, >= 1. Error control cuts steps that may have more events. If it can't, or isn't on, further
    * events are counted and fire at the step's end. */
    int32_t max_events_per_step; /* as above */
    double threshold_on; /* C+ [log units], > 0 */
    double threshold_off; /* C- [log units], > 0 */
    double threshold_sigma; /* standard deviation of C+ and of C- from pixel to pixel, independent, drawn once [log units] */
    double threshold_min; /* no pixel's threshold is below this [log units], > 0 */
    double refractory_s; /* [s] */
    int32_t refractory_law; /* TIDES_REFRACTORY_* */
    int32_t psf_domain; /* TIDES_PSF_* */
    double leak_rate_hz; /* ON events per second that the reference's drift makes in a pixel at rest [Hz] */
    double leak_sigma; /* decades of log-normal spread of that rate from pixel to pixel */
    double leak_hz_per_a; /* additional leak per photocurrent of circuit.* at Y = 0.5 [Hz / A] */
    double temperature_c; /* 25: leak_rate_hz is there; it doubles every 8, as silicon's leakage does [degrees C] */
    double threshold_parity; /* odd columns' thresholds are higher by this part, even ones' lower, in (-1, 1) [1] */
    double b_min; /* pixels with less coverage than this stay silent, in [0, 1] */
    double shot_noise_hz; /* noise events, both polarities, of a pixel at Y = 0; 0.264 of it at Y = 1, linear between [Hz] */
    double hot_pixel_fraction, hot_pixel_rate_hz; /* of all pixels [1]; their ON events a second [Hz] */
    double dead_pixel_fraction; /* of all pixels: those that never fire [1] */
    double psf_sigma_px; /* [px] */
    double photoreceptor_cutoff_hz; /* -3 dB [Hz]; 0: off */
    /* the cutoff is multiplied by I / (I + this), where I is the photocurrent of circuit.* at Y = 0.5, as the photodiode
    * limits it in weak light; 0: not multiplied [A] */
    double photoreceptor_half_a;
    int32_t photoreceptor_law; /* TIDES_PHOTORECEPTOR_* */
    int32_t bandwidth; /* TIDES_BANDWIDTH_* */
    tides_circuit circuit; /* of TIDES_BANDWIDTH_CIRCUIT */
    double surround_lambda_px; /* space constant of the surround's diffuser [px]; 0: off */
    double surround_tau_s; /* its time constant [s] */
    double noise_rms; /* additive Ornstein-Uhlenbeck noise [log units] */
    double noise_cutoff_hz; /* its corner frequency [Hz]: correlation time 1 / (2 pi cutoff) */
    double noise_sigma; /* decades of log-normal spread of its size from pixel to pixel */
    int32_t noise_law; /* TIDES_NOISE_* */
    double highpass_hz; /* -3 dB of a high-pass behind the low-pass (Prophesee's bias_hpf) [Hz]; 0: off */
    uint64_t seed; /* of all that is random here */
    int32_t labels; /* 1: events get tides_event_frontend */
    int32_t initial; /* TIDES_INITIAL_* */
    /* A file with values of single pixels, which replace drawn ones (nullable; the caller's). It has arrays of the image's
    * height by width, in an .npz, a structured .npy, or HDF5. Their names are threshold_on, threshold_off [log units], leak
    * [Hz], noise [Hz, as shot_noise_hz], hot [Hz], dead [0 or 1], noise_size [of additive noise, 1: as noise_rms or noise_law
    * say]. Any may be missing, and NaN means unknown. It is read when pixels are made. */
    const char *maps;
    /* The readout of frames on the same chip (DAVIS): each read of a row adds `kick` to the signal of its pixels, after all
    * filters, and decays. Frame k = 0, 1, ..., at kick_first_s + k / kick_rate_hz or as kick_times lists, reads row y
    * kick_reads_s (reset, signal) + y kick_row_s later. Reads before the run don't count. Not with a pole that depends on
    * light, nor the circuit. A step is at most 16 recoveries long. */
    double kick; /* [log units], of either sign; 0: off */
    double kick_recovery_s; /* its time constant [s] */
    double kick_rate_hz; /* frames per second [Hz] */
    double kick_first_s; /* the first frame [s], on the run's clock */
    double kick_row_s; /* from row to row [s] */
    double kick_reads_s[2]; /* reads of reset and of signal after a frame's time [s]; equal: one read */
    /* A text file of frames' times, in place of kick_rate_hz and kick_first_s (nullable; the caller's): each line begins with
    * one [s, on the run's clock, ascending]. Lines may be empty, or begin with # or %. It is read when pixels are made. */
    const char *kick_times;
    """

    size: int
    max_events_per_step: int
    threshold_on: float
    threshold_off: float
    threshold_sigma: float
    threshold_min: float
    refractory_s: float
    refractory_law: int
    psf_domain: int
    leak_rate_hz: float
    leak_sigma: float
    leak_hz_per_a: float
    temperature_c: float
    threshold_parity: float
    b_min: float
    shot_noise_hz: float
    hot_pixel_fraction: float
    hot_pixel_rate_hz: float
    dead_pixel_fraction: float
    psf_sigma_px: float
    photoreceptor_cutoff_hz: float
    photoreceptor_half_a: float
    photoreceptor_law: int
    bandwidth: int
    circuit: tides_circuit
    surround_lambda_px: float
    surround_tau_s: float
    noise_rms: float
    noise_cutoff_hz: float
    noise_sigma: float
    noise_law: int
    highpass_hz: float
    seed: int
    labels: int
    initial: int
    maps: bytes | None
    kick: float
    kick_recovery_s: float
    kick_rate_hz: float
    kick_first_s: float
    kick_row_s: float
    kick_reads_s: Any
    kick_times: bytes | None

    _fields_ = [
        ("size", c_uint32),
        ("max_events_per_step", c_int32),
        ("threshold_on", c_double),
        ("threshold_off", c_double),
        ("threshold_sigma", c_double),
        ("threshold_min", c_double),
        ("refractory_s", c_double),
        ("refractory_law", c_int32),
        ("psf_domain", c_int32),
        ("leak_rate_hz", c_double),
        ("leak_sigma", c_double),
        ("leak_hz_per_a", c_double),
        ("temperature_c", c_double),
        ("threshold_parity", c_double),
        ("b_min", c_double),
        ("shot_noise_hz", c_double),
        ("hot_pixel_fraction", c_double),
        ("hot_pixel_rate_hz", c_double),
        ("dead_pixel_fraction", c_double),
        ("psf_sigma_px", c_double),
        ("photoreceptor_cutoff_hz", c_double),
        ("photoreceptor_half_a", c_double),
        ("photoreceptor_law", c_int32),
        ("bandwidth", c_int32),
        ("circuit", tides_circuit),
        ("surround_lambda_px", c_double),
        ("surround_tau_s", c_double),
        ("noise_rms", c_double),
        ("noise_cutoff_hz", c_double),
        ("noise_sigma", c_double),
        ("noise_law", c_int32),
        ("highpass_hz", c_double),
        ("seed", c_uint64),
        ("labels", c_int32),
        ("initial", c_int32),
        ("maps", c_char_p),
        ("kick", c_double),
        ("kick_recovery_s", c_double),
        ("kick_rate_hz", c_double),
        ("kick_first_s", c_double),
        ("kick_row_s", c_double),
        ("kick_reads_s", c_double * 2),
        ("kick_times", c_char_p),
    ]


class tides_smoothing(Structure):
    """/* Splat alpha rises from 0 to its full value between these (C2), 0 < begin <= end < 1. If they are equal, alpha jumps
    * there. */
    double taper_begin, taper_end;
    /* compositing stops when the rest of a pixel's list may change L by at most this; 0: stops at a transmittance of 1e-4,
    * before the splat that would go below */
    double stop_change;
    double near_fade; /* depth from which splats have full opacity [near planes], >= 1; 1: they appear at once */
    /* relative depth behind a splat over which its share of the light falls to 1/e, so that order changes gradually, < 1; 0:
    * a strict order */
    double soft_depth;
    int32_t ellipses; /* 1: extents are the ellipse out to the taper's begin; 0: squares of 3 sigma, on whole tiles */
    int32_t reserved;
    """

    taper_begin: float
    taper_end: float
    stop_change: float
    near_fade: float
    soft_depth: float
    ellipses: int
    reserved: int

    _fields_ = [
        ("taper_begin", c_double),
        ("taper_end", c_double),
        ("stop_change", c_double),
        ("near_fade", c_double),
        ("soft_depth", c_double),
        ("ellipses", c_int32),
        ("reserved", c_int32),
    ]


class tides_image_params(Structure):
    """uint32_t size; /* sizeof this struct */
    int32_t rules; /* TIDES_RULES_* */
    int32_t antialias; /* TIDES_ANTIALIAS_*; TRUE: opacity times sqrt(det before / det after dilation) */
    int32_t sh_degree; /* bands above this are ignored, 0..4 */
    double dilation; /* added to the diagonal of the 2D covariance [px^2] */
    double luminance[3]; /* Y = luminance . (r, g, b) */
    /* the black level: dark light and the photocurrent's offset, as a share of full scale (Y = 1); L = ln(Y + log_eps), 1e-9
    * to 1e6 */
    double log_eps;
    double background[3]; /* r g b, >= 0: light, whatever `transfer` is */
    tides_smoothing smoothing; /* soft order and tapers */
    /* TIDES_FILTER_*. With a filter, a pixel's luminance is one channel, and so is L; `luminance` must then be the default.
    * Takes three times as long */
    int32_t colour_filter;
    int32_t transfer; /* TIDES_TRANSFER_*: how composited colours code light; FILE: as the scene's objects say */
    double gamma; /* with GAMMA: light = colour^gamma, 1 to 5 */
    """

    size: int
    rules: int
    antialias: int
    sh_degree: int
    dilation: float
    luminance: Any
    log_eps: float
    background: Any
    smoothing: tides_smoothing
    colour_filter: int
    transfer: int
    gamma: float

    _fields_ = [
        ("size", c_uint32),
        ("rules", c_int32),
        ("antialias", c_int32),
        ("sh_degree", c_int32),
        ("dilation", c_double),
        ("luminance", c_double * 3),
        ("log_eps", c_double),
        ("background", c_double * 3),
        ("smoothing", tides_smoothing),
        ("colour_filter", c_int32),
        ("transfer", c_int32),
        ("gamma", c_double),
    ]


class tides_frame(Structure):
    """double *plane[TIDES_CHANNELS]; /* by TIDES_Y, TIDES_L ... */
    """

    plane: Any

    _fields_ = [
        ("plane", P(c_double) * 15),
    ]


class tides_render_stats(Structure):
    """uint64_t tile_jobs; /* (tile, time) pairs composited, whole or in part */
    uint64_t blocks; /* (4x4 block, time) pairs composited */
    uint64_t tile_jobs_skipped; /* tiles without a candidate: background by formula */
    uint64_t gaussians_total; /* Gaussians in the scene */
    uint64_t gaussians_dropped; /* Gaussians of its files that were left out because they can't be rendered */
    uint64_t gaussians_projected; /* (Gaussian, tile job) projections, */
    uint64_t gaussians_shared; /* of these, computed once for all tiles of the time, */
    uint64_t gaussians_culled; /* and those that touch none of the job's blocks at that time */
    uint64_t gaussians_still; /* Gaussians at rest before a resting camera, skipped when lists were made */
    uint64_t gaussians_moved; /* (Gaussian, time) rows computed of Gaussians that move by themselves */
    uint64_t gaussians_interpolated; /* rows that were interpolated instead (stepping.interpolate_motion) */
    uint64_t sweeps; /* sweeps over Gaussians, which make tiles' candidate lists */
    uint64_t pairs_evaluated; /* (splat, pixel) pairs composited, in blocks of 16 */
    uint64_t lists_kept; /* tile jobs whose splats were already in depth order */
    /* Wall time by stage [s]. */
    double time_build_s, time_motion_s, time_sweep_s, time_project_s, time_sort_s, time_composite_s, time_transfer_s;
    int32_t tiles; /* tiles in a full frame */
    int32_t reserved;
    uint64_t pixels_nonfinite; /* (pixel, time) pairs that are infinite or NaN; the call that met them failed */
    """

    tile_jobs: int
    blocks: int
    tile_jobs_skipped: int
    gaussians_total: int
    gaussians_dropped: int
    gaussians_projected: int
    gaussians_shared: int
    gaussians_culled: int
    gaussians_still: int
    gaussians_moved: int
    gaussians_interpolated: int
    sweeps: int
    pairs_evaluated: int
    lists_kept: int
    time_build_s: float
    time_motion_s: float
    time_sweep_s: float
    time_project_s: float
    time_sort_s: float
    time_composite_s: float
    time_transfer_s: float
    tiles: int
    reserved: int
    pixels_nonfinite: int

    _fields_ = [
        ("tile_jobs", c_uint64),
        ("blocks", c_uint64),
        ("tile_jobs_skipped", c_uint64),
        ("gaussians_total", c_uint64),
        ("gaussians_dropped", c_uint64),
        ("gaussians_projected", c_uint64),
        ("gaussians_shared", c_uint64),
        ("gaussians_culled", c_uint64),
        ("gaussians_still", c_uint64),
        ("gaussians_moved", c_uint64),
        ("gaussians_interpolated", c_uint64),
        ("sweeps", c_uint64),
        ("pairs_evaluated", c_uint64),
        ("lists_kept", c_uint64),
        ("time_build_s", c_double),
        ("time_motion_s", c_double),
        ("time_sweep_s", c_double),
        ("time_project_s", c_double),
        ("time_sort_s", c_double),
        ("time_composite_s", c_double),
        ("time_transfer_s", c_double),
        ("tiles", c_int32),
        ("reserved", c_int32),
        ("pixels_nonfinite", c_uint64),
    ]


class tides_risk(Structure):
    """double w_b, w_c, w_alpha; /* [1] >= 0 */
    """

    w_b: float
    w_c: float
    w_alpha: float

    _fields_ = [
        ("w_b", c_double),
        ("w_c", c_double),
        ("w_alpha", c_double),
    ]


class tides_stepping(Structure):
    """uint32_t size;
    int32_t mode; /* TIDES_STEPPING_* */
    int32_t model; /* TIDES_MODEL_* */
    int32_t local; /* 1: each `unit` has steps of its own where they are chosen, and none where nothing moves;
    0: whole frames, the same steps for all */
    double step_s; /* [s] > 0: the step, or the longest; the last is shortened to end at `stop` */
    double min_step_s; /* [s] > 0: steps that are no longer than this aren't cut */
    double tolerance; /* ERROR: estimated error of S, in units of the smaller threshold. 0: 0.1 if events are
    * looked up, else 0.01 */
    double time_tolerance_s; /* ERROR: estimated error of event times [s]; 0: not asked for */
    tides_risk risk; /* RISK */
    int32_t slope; /* TIDES_SLOPE_* */
    int32_t interpolate_motion; /* 1: between the start, middle and end of a macro step expensive motion models (networks,
    callbacks) are interpolated, Gaussian by Gaussian where that is estimated to stay within
    both tolerances (0.01 where `tolerance` is 0: looking up sees the same motion). FIXED: has
    no effect, each step is worked out */
    double memory_mb; /* [1e6 bytes] >= 1: memory for the samples of a macro step and their launches; it decides how many
    * tiles are taken at a time. If tiles share their steps, it is at least a few samples of each moving
    * tile. Look-ups have room of their own, at most 512. Changes the order of the work, no event */
    int32_t solve; /* TIDES_SOLVE_* */
    int32_t unit; /* TIDES_UNIT_* */
    """

    size: int
    mode: int
    model: int
    local: int
    step_s: float
    min_step_s: float
    tolerance: float
    time_tolerance_s: float
    risk: tides_risk
    slope: int
    interpolate_motion: int
    memory_mb: float
    solve: int
    unit: int

    _fields_ = [
        ("size", c_uint32),
        ("mode", c_int32),
        ("model", c_int32),
        ("local", c_int32),
        ("step_s", c_double),
        ("min_step_s", c_double),
        ("tolerance", c_double),
        ("time_tolerance_s", c_double),
        ("risk", tides_risk),
        ("slope", c_int32),
        ("interpolate_motion", c_int32),
        ("memory_mb", c_double),
        ("solve", c_int32),
        ("unit", c_int32),
    ]


class tides_stats(Structure):
    """tides_render_stats render; /* of its renderer */
    uint64_t events, events_on, events_off; /* that pixels fired */
    uint64_t events_truncated; /* crossings beyond max_events_per_step in a step, moved to the step's end */
    uint64_t events_caught_up; /* crossings that the local model missed or put out of range, fired at the step's end */
    uint64_t events_by_cause[TIDES_CAUSES]; /* of `events`, by TIDES_CAUSE_* */
    uint64_t events_written; /* given to the sink, behind readout and filters */
    uint64_t events_dropped; /* by the readout: by chance, or because a queue was full */
    uint64_t events_overflowed; /* of events_dropped: because a queue was full */
    uint64_t events_delayed; /* left the readout later than they fired */
    uint64_t events_suppressed; /* by sensor.b_min: crossings put off to where their pixel became visible, noise events lost */
    uint64_t events_refractory; /* crossings consumed and noise events lost in refractory periods */
    uint64_t steps; /* (tile or block, step) pairs that went to the comparator */
    uint64_t steps_rejected; /* such pairs that were cut in two: too coarse, or to be probed */
    uint64_t steps_at_minimum; /* accepted above the tolerance because they were as short as min_step_s */
    double worst_delay_s; /* in the readout, jitter aside [s] */
    double worst_error; /* largest estimate among accepted steps [thresholds]; 0 under fixed steps, which have no estimates */
    /* Estimated timing error that so many percent of the events stay below [s]; 0 under fixed steps. An event's error is the
    * error that probes found there, and rounding, by the signal's slope and curvature where it fired. Under RISK, if
    * nothing was cut, it comes from the ends of steps, which may show no error. */
    double error_p50_s, error_p95_s, error_p99_s; /* as above [s] */
    double worst_residual; /* max over pixels at the end of (S - S_ref) / threshold; below 1 by construction */
    uint64_t tile_steps_still; /* (tile, step) pairs in which nothing moved: neither rendered nor compared */
    double renders_full_frame_equivalent; /* 4x4 blocks composited, over those of all tiles */
    double simulated_s, run_time_s, real_time_factor; /* simulated / run time */
    double time_compare_s, time_sink_s, time_other_s; /* wall time of the comparator, the sink, the rest [s] */
    uint64_t peak_memory_bytes; /* of the process */
    /* The part of `steps` that rests on a probe: a render inside the longer step that they are cut from, compared with its
    * model in value and rate. Under error control these are all steps, except macro steps that min_step_s leaves whole. */
    uint64_t steps_probed;
    /* Steps accepted above the tolerance because the deviation at the probe is no more than rounding of S in single
    * precision: shorter steps would show as much. */
    uint64_t steps_at_rounding;
    /* Events that the signal's estimated error may undo, and places where it may make events: the signal turns, or the run
    * ends, so near a level that the error decides whether it is reached. Where events are looked up, a turn counts as two,
    * because the pixel's next event depends on it. A tile counts too, once a macro step, where more pairs of splats may swap
    * in depth than are searched. Not counted under FIXED. */
    uint64_t events_uncertain;
    double worst_deviation; /* largest deviation at a probe on which a step rests [thresholds] */
    uint64_t events_solved; /* of `events`, those whose times were looked up in the image (stepping.solve) */
    uint64_t points_looked_up; /* pixels at single times that were looked up for them */
    double time_look_up_s; /* time of waiting for look-ups [s] */
    uint64_t solve; /* TIDES_SOLVE_* of the run: OFF or DOUBLE */
    uint64_t unsolved; /* TIDES_UNSOLVED_*: why `solve` is OFF */
    uint64_t unit; /* TIDES_UNIT_* of the run: TILE or BLOCK */
    double tolerance; /* the run's [thresholds] */
    uint64_t events_filtered[TIDES_STAGES]; /* dropped behind the readout, by TIDES_STAGE_* */
    /* Processor time of the calling thread while no other worked beside it on the host, and no launch on a device [s]: time
    * that more threads don't shorten. Waiting for a device takes none, unless its driver spins. */
    double time_alone_s;
    """

    render: tides_render_stats
    events: int
    events_on: int
    events_off: int
    events_truncated: int
    events_caught_up: int
    events_by_cause: Any
    events_written: int
    events_dropped: int
    events_overflowed: int
    events_delayed: int
    events_suppressed: int
    events_refractory: int
    steps: int
    steps_rejected: int
    steps_at_minimum: int
    worst_delay_s: float
    worst_error: float
    error_p50_s: float
    error_p95_s: float
    error_p99_s: float
    worst_residual: float
    tile_steps_still: int
    renders_full_frame_equivalent: float
    simulated_s: float
    run_time_s: float
    real_time_factor: float
    time_compare_s: float
    time_sink_s: float
    time_other_s: float
    peak_memory_bytes: int
    steps_probed: int
    steps_at_rounding: int
    events_uncertain: int
    worst_deviation: float
    events_solved: int
    points_looked_up: int
    time_look_up_s: float
    solve: int
    unsolved: int
    unit: int
    tolerance: float
    events_filtered: Any
    time_alone_s: float

    _fields_ = [
        ("render", tides_render_stats),
        ("events", c_uint64),
        ("events_on", c_uint64),
        ("events_off", c_uint64),
        ("events_truncated", c_uint64),
        ("events_caught_up", c_uint64),
        ("events_by_cause", c_uint64 * 4),
        ("events_written", c_uint64),
        ("events_dropped", c_uint64),
        ("events_overflowed", c_uint64),
        ("events_delayed", c_uint64),
        ("events_suppressed", c_uint64),
        ("events_refractory", c_uint64),
        ("steps", c_uint64),
        ("steps_rejected", c_uint64),
        ("steps_at_minimum", c_uint64),
        ("worst_delay_s", c_double),
        ("worst_error", c_double),
        ("error_p50_s", c_double),
        ("error_p95_s", c_double),
        ("error_p99_s", c_double),
        ("worst_residual", c_double),
        ("tile_steps_still", c_uint64),
        ("renders_full_frame_equivalent", c_double),
        ("simulated_s", c_double),
        ("run_time_s", c_double),
        ("real_time_factor", c_double),
        ("time_compare_s", c_double),
        ("time_sink_s", c_double),
        ("time_other_s", c_double),
        ("peak_memory_bytes", c_uint64),
        ("steps_probed", c_uint64),
        ("steps_at_rounding", c_uint64),
        ("events_uncertain", c_uint64),
        ("worst_deviation", c_double),
        ("events_solved", c_uint64),
        ("points_looked_up", c_uint64),
        ("time_look_up_s", c_double),
        ("solve", c_uint64),
        ("unsolved", c_uint64),
        ("unit", c_uint64),
        ("tolerance", c_double),
        ("events_filtered", c_uint64 * 5),
        ("time_alone_s", c_double),
    ]


class tides_stat(Structure):
    """const char *name; /* "events_on" */
    const char *unit; /* "s", or "" */
    int32_t type; /* TIDES_STAT_* */
    int32_t joined; /* TIDES_JOIN_* */
    size_t offset; /* in tides_stats */
    """

    name: bytes | None
    unit: bytes | None
    type: int
    joined: int
    offset: int

    _fields_ = [
        ("name", c_char_p),
        ("unit", c_char_p),
        ("type", c_int32),
        ("joined", c_int32),
        ("offset", c_size_t),
    ]


tides_event_sink = CFUNCTYPE(c_int, c_void_p, P(tides_event), c_size_t)


class tides_esim(Structure):
    """double contrast_threshold_pos, contrast_threshold_neg; /* [log units] 1.0 */
    double contrast_threshold_sigma_pos, contrast_threshold_sigma_neg; /* [log units] 0.021, drawn anew per frame and pixel */
    double refractory_period_ns; /* [ns] 0: crossings within it are dropped, and the reference moves with them */
    double log_eps; /* 0.001 */
    int32_t use_log_image; /* 1; 0: thresholds are on Y itself */
    int32_t adaptive_sampling; /* TIDES_ESIM_*: how the times of renders are chosen */
    double adaptive_sampling_lambda; /* 0.5: change of L [1], or motion [px], between two renders */
    double minimum_framerate; /* [Hz] 30: renders are at least so frequent */
    """

    contrast_threshold_pos: float
    contrast_threshold_neg: float
    contrast_threshold_sigma_pos: float
    contrast_threshold_sigma_neg: float
    refractory_period_ns: float
    log_eps: float
    use_log_image: int
    adaptive_sampling: int
    adaptive_sampling_lambda: float
    minimum_framerate: float

    _fields_ = [
        ("contrast_threshold_pos", c_double),
        ("contrast_threshold_neg", c_double),
        ("contrast_threshold_sigma_pos", c_double),
        ("contrast_threshold_sigma_neg", c_double),
        ("refractory_period_ns", c_double),
        ("log_eps", c_double),
        ("use_log_image", c_int32),
        ("adaptive_sampling", c_int32),
        ("adaptive_sampling_lambda", c_double),
        ("minimum_framerate", c_double),
    ]


class tides_v2e(Structure):
    """double pos_thres, neg_thres, sigma_thres; /* [log units] 0.2, 0.2, 0.03 once per pixel */
    double cutoff_hz; /* [Hz] 300; 0: off */
    double leak_rate_hz; /* [Hz] 0.01 */
    double leak_jitter_fraction; /* 0.1: random part of the leak, per frame */
    double noise_rate_cov_decades; /* 0.1: log-normal spread of leak rates */
    double shot_noise_rate_hz; /* [Hz] 0.001 */
    double refractory_period; /* [s] 0.0005 */
    double cs_lambda_pixels, cs_tau_p_ms; /* [px], [ms] 0: no surround */
    double added_dn; /* [DN] 0: of the frames that v2e is given, which has no black level itself */
    int32_t photoreceptor_noise; /* 0; 1: noise before the comparator instead of shot noise */
    int32_t hdr; /* 0; 1: frames are logarithms already */
    int32_t float32_timestamps; /* 0; 1: sub-times rounded to float32 seconds, as v2e does */
    """

    pos_thres: float
    neg_thres: float
    sigma_thres: float
    cutoff_hz: float
    leak_rate_hz: float
    leak_jitter_fraction: float
    noise_rate_cov_decades: float
    shot_noise_rate_hz: float
    refractory_period: float
    cs_lambda_pixels: float
    cs_tau_p_ms: float
    added_dn: float
    photoreceptor_noise: int
    hdr: int
    float32_timestamps: int

    _fields_ = [
        ("pos_thres", c_double),
        ("neg_thres", c_double),
        ("sigma_thres", c_double),
        ("cutoff_hz", c_double),
        ("leak_rate_hz", c_double),
        ("leak_jitter_fraction", c_double),
        ("noise_rate_cov_decades", c_double),
        ("shot_noise_rate_hz", c_double),
        ("refractory_period", c_double),
        ("cs_lambda_pixels", c_double),
        ("cs_tau_p_ms", c_double),
        ("added_dn", c_double),
        ("photoreceptor_noise", c_int32),
        ("hdr", c_int32),
        ("float32_timestamps", c_int32),
    ]


class tides_voltmeter(Structure):
    """double k1, k2, k3, k4, k5, k6; /* 5.265, 20, 1e-4, 1e-7, 5e-9, 1e-5 */
    """

    k1: float
    k2: float
    k3: float
    k4: float
    k5: float
    k6: float

    _fields_ = [
        ("k1", c_double),
        ("k2", c_double),
        ("k3", c_double),
        ("k4", c_double),
        ("k5", c_double),
        ("k6", c_double),
    ]


class tides_iebcs(Structure):
    """double th_pos, th_neg, th_noise; /* [log units] 0.4, 0.4, 0.01, drawn anew after each event */
    double lat, jit, ref; /* [us] 100, 10, 100: latency, its spread, refractory period */
    double tau; /* [us] 40: time constant at 1 klux */
    double bgnp, bgnn; /* [Hz] 0.1, 0.01: periodic noise events of each polarity */
    double scale; /* 1e4: lux-like units of Y = 1 */
    const char *noise_pos; /* .npy of measured noise histograms (rows, columns, 72) per polarity, or NULL */
    const char *noise_neg; /* the same for OFF events */
    double arbiter_us; /* [us] 0.1: time per event, per event of a row, or per clock */
    int32_t arbiter; /* TIDES_ARBITER_* */
    """

    th_pos: float
    th_neg: float
    th_noise: float
    lat: float
    jit: float
    ref: float
    tau: float
    bgnp: float
    bgnn: float
    scale: float
    noise_pos: bytes | None
    noise_neg: bytes | None
    arbiter_us: float
    arbiter: int

    _fields_ = [
        ("th_pos", c_double),
        ("th_neg", c_double),
        ("th_noise", c_double),
        ("lat", c_double),
        ("jit", c_double),
        ("ref", c_double),
        ("tau", c_double),
        ("bgnp", c_double),
        ("bgnn", c_double),
        ("scale", c_double),
        ("noise_pos", c_char_p),
        ("noise_neg", c_char_p),
        ("arbiter_us", c_double),
        ("arbiter", c_int32),
    ]


class tides_ldati_params(Structure):
    """double fps; /* [Hz] 30 */
    """

    fps: float

    _fields_ = [
        ("fps", c_double),
    ]


class tides_baseline_params(Structure):
    """uint32_t size;
    int32_t method; /* TIDES_METHOD_* */
    uint64_t seed; /* of the method's random numbers */
    tides_sensor sensor; /* of TIDES_METHOD_TIDES */
    double log_eps; /* of TIDES_METHOD_TIDES: L = ln(Y + log_eps) */
    tides_esim esim; /* of TIDES_METHOD_ESIM */
    tides_v2e v2e; /* of TIDES_METHOD_V2E */
    tides_voltmeter voltmeter; /* of TIDES_METHOD_VOLTMETER */
    tides_iebcs iebcs; /* of TIDES_METHOD_IEBCS */
    tides_ldati_params ldati; /* of TIDES_METHOD_LDATI */
    """

    size: int
    method: int
    seed: int
    sensor: tides_sensor
    log_eps: float
    esim: tides_esim
    v2e: tides_v2e
    voltmeter: tides_voltmeter
    iebcs: tides_iebcs
    ldati: tides_ldati_params

    _fields_ = [
        ("size", c_uint32),
        ("method", c_int32),
        ("seed", c_uint64),
        ("sensor", tides_sensor),
        ("log_eps", c_double),
        ("esim", tides_esim),
        ("v2e", tides_v2e),
        ("voltmeter", tides_voltmeter),
        ("iebcs", tides_iebcs),
        ("ldati", tides_ldati_params),
    ]


class tides_frame_supply(Structure):
    """tides_frames *frames; /* a sequence, of which frames (LDATI: intervals) within [start, stop] are used; or NULL */
    tides_renderer *renderer; /* if `frames` is NULL: a renderer */
    const tides_trajectory *camera; /* the renderer's camera */
    /* the renderer's renders per second [Hz]: the first at `start`, the last at `stop`; ESIM's adaptive sampling doesn't
    * read it */
    double frames_per_second;
    double start, stop; /* [s] */
    """

    frames: Any
    renderer: Any
    camera: Any
    frames_per_second: float
    start: float
    stop: float

    _fields_ = [
        ("frames", P(tides_frames)),
        ("renderer", P(tides_renderer)),
        ("camera", P(tides_trajectory)),
        ("frames_per_second", c_double),
        ("start", c_double),
        ("stop", c_double),
    ]


class tides_exposure(Structure):
    """uint32_t size; /* sizeof this struct */
    int32_t shutter; /* TIDES_SHUTTER_* */
    double frames_per_second; /* [Hz] */
    double exposure_s; /* [s] during which each row gathers light; 0: an instant */
    double row_time_s; /* [s] ROLLING: from a row to the one below; negative: the bottom row is first */
    double tolerance; /* bound of the estimated error of mean light, in every pixel [1] */
    int32_t colour; /* 1: r, g and b; 0: Y */
    int32_t bits; /* of a value: 8 or 16 */
    int32_t transfer; /* TIDES_TRANSFER_*: how light becomes a value */
    int32_t reserved;
    double gamma; /* with TIDES_TRANSFER_LINEAR: values go as light^(1 / gamma), 1 being full scale */
    double gain; /* values are at full scale where light times gain is 1 */
    double full_well_e; /* electrons at full scale, for shot noise; 0: none */
    double read_noise_e; /* [electrons] rms, added to each value; needs full_well_e */
    uint64_t seed; /* of noise */
    """

    size: int
    shutter: int
    frames_per_second: float
    exposure_s: float
    row_time_s: float
    tolerance: float
    colour: int
    bits: int
    transfer: int
    reserved: int
    gamma: float
    gain: float
    full_well_e: float
    read_noise_e: float
    seed: int

    _fields_ = [
        ("size", c_uint32),
        ("shutter", c_int32),
        ("frames_per_second", c_double),
        ("exposure_s", c_double),
        ("row_time_s", c_double),
        ("tolerance", c_double),
        ("colour", c_int32),
        ("bits", c_int32),
        ("transfer", c_int32),
        ("reserved", c_int32),
        ("gamma", c_double),
        ("gain", c_double),
        ("full_well_e", c_double),
        ("read_noise_e", c_double),
        ("seed", c_uint64),
    ]


class tides_exposed(Structure):
    """double error; /* largest estimated error of a pixel's mean light [1]; may exceed the tolerance if pixels are unsettled */
    double renders; /* full frames' worth of tiles rendered */
    /* pixels above the tolerance even after cuts to 1/4096 of the exposure, or of a short change; or that may change faster
    * than 1/262144 of it */
    uint64_t unsettled;
    """

    error: float
    renders: float
    unsettled: int

    _fields_ = [
        ("error", c_double),
        ("renders", c_double),
        ("unsettled", c_uint64),
    ]


class tides_imu(Structure):
    """uint32_t size; /* sizeof this struct */
    int32_t reserved;
    double rate_hz; /* samples a second [Hz], > 0 */
    double gravity; /* [m/s^2]; 0: none */
    double down[3]; /* direction of gravity in world axes, of any length; needed unless gravity is 0 */
    double metres_per_unit; /* length of a scene unit [m]; needed */
    double gyroscope_noise; /* white noise's density [rad/s/sqrt(Hz)] */
    double accelerometer_noise; /* [m/s^2/sqrt(Hz)] */
    double gyroscope_walk; /* density of the bias's random walk [rad/s^2/sqrt(Hz)] */
    double accelerometer_walk; /* [m/s^3/sqrt(Hz)] */
    double gyroscope_bias[3]; /* at the first sample [rad/s] */
    double accelerometer_bias[3]; /* [m/s^2] */
    uint64_t seed; /* of noise and random walks */
    """

    size: int
    reserved: int
    rate_hz: float
    gravity: float
    down: Any
    metres_per_unit: float
    gyroscope_noise: float
    accelerometer_noise: float
    gyroscope_walk: float
    accelerometer_walk: float
    gyroscope_bias: Any
    accelerometer_bias: Any
    seed: int

    _fields_ = [
        ("size", c_uint32),
        ("reserved", c_int32),
        ("rate_hz", c_double),
        ("gravity", c_double),
        ("down", c_double * 3),
        ("metres_per_unit", c_double),
        ("gyroscope_noise", c_double),
        ("accelerometer_noise", c_double),
        ("gyroscope_walk", c_double),
        ("accelerometer_walk", c_double),
        ("gyroscope_bias", c_double * 3),
        ("accelerometer_bias", c_double * 3),
        ("seed", c_uint64),
    ]


class tides_imu_sample(Structure):
    """double time; /* [s] */
    double angular_rate[3]; /* of the body against the world [rad/s] */
    double specific_force[3]; /* R^T (a - g) [m/s^2] */
    double gyroscope_bias[3]; /* [rad/s] */
    double accelerometer_bias[3]; /* [m/s^2] */
    """

    time: float
    angular_rate: Any
    specific_force: Any
    gyroscope_bias: Any
    accelerometer_bias: Any

    _fields_ = [
        ("time", c_double),
        ("angular_rate", c_double * 3),
        ("specific_force", c_double * 3),
        ("gyroscope_bias", c_double * 3),
        ("accelerometer_bias", c_double * 3),
    ]


class tides_param(Structure):
    """const char *key; /* "sensor.threshold_on" */
    int32_t type; /* TIDES_PARAM_* */
    const char *unit; /* "log units", or "" */
    double lower, upper; /* inclusive bounds of numbers; 0 and 0 for the rest */
    const char *fallback; /* default as JSON text; NULL: required */
    const char *choices; /* "smooth|inria|gsplat", or NULL */
    const char *sentence; /* what it does */
    int32_t common; /* 1: one of the few keys that most runs set, which --help lists and `tides init` writes */
    """

    key: bytes | None
    type: int
    unit: bytes | None
    lower: float
    upper: float
    fallback: bytes | None
    choices: bytes | None
    sentence: bytes | None
    common: int

    _fields_ = [
        ("key", c_char_p),
        ("type", c_int32),
        ("unit", c_char_p),
        ("lower", c_double),
        ("upper", c_double),
        ("fallback", c_char_p),
        ("choices", c_char_p),
        ("sentence", c_char_p),
        ("common", c_int32),
    ]


class tides_run_values(Structure):
    """tides_intrinsics intrinsics; /* zeros if neither the run nor its path file gives them */
    tides_image_params image; /* image.*, scene.background */
    tides_sensor sensor; /* sensor.* */
    tides_stepping stepping; /* stepping.* */
    tides_readout readout; /* readout.* */
    tides_filters filters; /* filters.* */
    double start, stop; /* time.* [s] */
    const char *scene_file, *camera_file, *device, *seed, *method; /* as in the file; "" or NULL if absent */
    tides_baseline_params baseline; /* its method is `method` */
    tides_frames_options frames; /* frames.* */
    const char *frames_file; /* NULL: the run has a scene */
    double frames_per_second; /* of a baseline's renders [Hz] */
    tides_path_options path; /* of camera.file */
    tides_scene_options scene_options; /* of scene.file, and `invalid` of all files */
    double scene_duration_s; /* duration of the scene's motions; 0: the scene's own */
    double metres_per_unit; /* of the scene [m]; 0: unknown */
    const char *dataset_layout; /* layouts of tides_dataset_write; NULL: none given */
    double dataset_picture_hz, dataset_truth_hz, dataset_pose_hz; /* of tides_dataset_write [Hz] */
    int32_t event_truth; /* 1: event files get ground truth (tides_session_truth) */
    int32_t truth_metres; /* 1: its depths are in metres */
    const char *truth_columns; /* "flow,depth,alpha,instance", or some of these */
    int32_t track_choice; /* TIDES_TRACKS_*: how tracked points are chosen */
    int32_t track_count; /* points to follow (tides_session_tracks) */
    double track_rate_hz; /* of tracks [Hz] */
    tides_exposure exposure; /* of frames (tides_session_frames) */
    tides_imu imu; /* metres_per_unit is above instead */
    const char *json; /* the run with every default filled in, as written into event files */
    """

    intrinsics: tides_intrinsics
    image: tides_image_params
    sensor: tides_sensor
    stepping: tides_stepping
    readout: tides_readout
    filters: tides_filters
    start: float
    stop: float
    scene_file: bytes | None
    camera_file: bytes | None
    device: bytes | None
    seed: bytes | None
    method: bytes | None
    baseline: tides_baseline_params
    frames: tides_frames_options
    frames_file: bytes | None
    frames_per_second: float
    path: tides_path_options
    scene_options: tides_scene_options
    scene_duration_s: float
    metres_per_unit: float
    dataset_layout: bytes | None
    dataset_picture_hz: float
    dataset_truth_hz: float
    dataset_pose_hz: float
    event_truth: int
    truth_metres: int
    truth_columns: bytes | None
    track_choice: int
    track_count: int
    track_rate_hz: float
    exposure: tides_exposure
    imu: tides_imu
    json: bytes | None

    _fields_ = [
        ("intrinsics", tides_intrinsics),
        ("image", tides_image_params),
        ("sensor", tides_sensor),
        ("stepping", tides_stepping),
        ("readout", tides_readout),
        ("filters", tides_filters),
        ("start", c_double),
        ("stop", c_double),
        ("scene_file", c_char_p),
        ("camera_file", c_char_p),
        ("device", c_char_p),
        ("seed", c_char_p),
        ("method", c_char_p),
        ("baseline", tides_baseline_params),
        ("frames", tides_frames_options),
        ("frames_file", c_char_p),
        ("frames_per_second", c_double),
        ("path", tides_path_options),
        ("scene_options", tides_scene_options),
        ("scene_duration_s", c_double),
        ("metres_per_unit", c_double),
        ("dataset_layout", c_char_p),
        ("dataset_picture_hz", c_double),
        ("dataset_truth_hz", c_double),
        ("dataset_pose_hz", c_double),
        ("event_truth", c_int32),
        ("truth_metres", c_int32),
        ("truth_columns", c_char_p),
        ("track_choice", c_int32),
        ("track_count", c_int32),
        ("track_rate_hz", c_double),
        ("exposure", tides_exposure),
        ("imu", tides_imu),
        ("json", c_char_p),
    ]


class tides_rig_camera(Structure):
    """char name[TIDES_RIG_NAME]; /* of letters, digits, _ and - */
    int32_t kind; /* TIDES_RIG_BOTH, _EVENT or _FRAME */
    int32_t reserved;
    double T_B_C[16]; /* row-major: p_body = T_B_C p_camera [scene units] */
    """

    name: Any
    kind: int
    reserved: int
    T_B_C: Any

    _fields_ = [
        ("name", c_char * 32),
        ("kind", c_int32),
        ("reserved", c_int32),
        ("T_B_C", c_double * 16),
    ]


class tides_session_facts(Structure):
    """tides_run_values values; /* of its run */
    tides_intrinsics intrinsics; /* of its images; on frames width and height alone */
    const tides_run *run; /* its run */
    const tides_scene *scene; /* NULL on frames; the camera and the device, too */
    const tides_trajectory *camera; /* its path, on the rig where there is one */
    tides_frames *frames; /* NULL on a scene */
    tides_device *device; /* that it runs on */
    tides_device_info info; /* of the device; its name says so on frames */
    int32_t sees_frames; /* 1: the method sees frames, of a sequence or rendered; 0: TIDES on a scene */
    int32_t reserved;
    """

    values: tides_run_values
    intrinsics: tides_intrinsics
    run: Any
    scene: Any
    camera: Any
    frames: Any
    device: Any
    info: tides_device_info
    sees_frames: int
    reserved: int

    _fields_ = [
        ("values", tides_run_values),
        ("intrinsics", tides_intrinsics),
        ("run", P(tides_run)),
        ("scene", P(tides_scene)),
        ("camera", P(tides_trajectory)),
        ("frames", P(tides_frames)),
        ("device", P(tides_device)),
        ("info", tides_device_info),
        ("sees_frames", c_int32),
        ("reserved", c_int32),
    ]


class tides_session_taken(Structure):
    """uint64_t count; /* frames, samples, or times of tracks */
    uint64_t tracks; /* points followed */
    double error; /* frames: the largest estimated error of mean light in a pixel [1] */
    double renders; /* frames: renders, in full frames */
    uint64_t unsettled; /* frames: pixels whose error stayed above the tolerance */
    uint64_t pairs; /* frames: (splat, pixel) pairs that were composited; 0: nothing of the scene was in view */
    int32_t at_imu; /* measurements: 1: a calibration gives the IMU's place; 0: it is the camera's, with its axes */
    int32_t reserved;
    """

    count: int
    tracks: int
    error: float
    renders: float
    unsettled: int
    pairs: int
    at_imu: int
    reserved: int

    _fields_ = [
        ("count", c_uint64),
        ("tracks", c_uint64),
        ("error", c_double),
        ("renders", c_double),
        ("unsettled", c_uint64),
        ("pairs", c_uint64),
        ("at_imu", c_int32),
        ("reserved", c_int32),
    ]


class tides_recording(Structure):
    """uint32_t size;
    int32_t resume; /* 1: continue from PATH.checkpoint, with the PATH.part beside it */
    const char *format; /* of tides_event_format_at; NULL: that of the path's ending */
    double checkpoint_s; /* [s] of wall time between checkpoints; 0: none, also none where the run is stopped */
    int32_t keep_checkpoint; /* 1: PATH.checkpoint stays beside the finished PATH; `resume` with a later stop extends it */
    int32_t reserved;
    """

    size: int
    resume: int
    format: bytes | None
    checkpoint_s: float
    keep_checkpoint: int
    reserved: int

    _fields_ = [
        ("size", c_uint32),
        ("resume", c_int32),
        ("format", c_char_p),
        ("checkpoint_s", c_double),
        ("keep_checkpoint", c_int32),
        ("reserved", c_int32),
    ]


class tides_recorded(Structure):
    """uint64_t events; /* in the file so far */
    uint64_t collapsed; /* tides_event_writer_collapsed */
    double resumed_s; /* [s] since the run's start at which it was resumed; 0: not resumed */
    int32_t began; /* 1: the file is open; PATH.part holds its events should the run be stopped */
    int32_t complete; /* 1: PATH is there */
    int32_t saved; /* 1: the last checkpoint was written, so that `resume` can continue from it */
    tides_error unsaved; /* the first failure to write a checkpoint; the run goes on */
    """

    events: int
    collapsed: int
    resumed_s: float
    began: int
    complete: int
    saved: int
    unsaved: tides_error

    _fields_ = [
        ("events", c_uint64),
        ("collapsed", c_uint64),
        ("resumed_s", c_double),
        ("began", c_int32),
        ("complete", c_int32),
        ("saved", c_int32),
        ("unsaved", tides_error),
    ]


class tides_dataset_layout(Structure):
    """const char *name, *summary; /* static storage */
    int32_t metric; /* 1: lengths are in metres */
    int32_t reserved;
    """

    name: bytes | None
    summary: bytes | None
    metric: int
    reserved: int

    _fields_ = [
        ("name", c_char_p),
        ("summary", c_char_p),
        ("metric", c_int32),
        ("reserved", c_int32),
    ]


class tides_dataset_report(Structure):
    """uint64_t events; /* of all cameras */
    int32_t cameras; /* of the rig; 1 without one */
    int32_t pictures, truths, poses; /* of each camera: frames, frames of ground truth, poses */
    int32_t unseeing; /* event cameras that never had the scene in view */
    int32_t reserved;
    """

    events: int
    cameras: int
    pictures: int
    truths: int
    poses: int
    unseeing: int
    reserved: int

    _fields_ = [
        ("events", c_uint64),
        ("cameras", c_int32),
        ("pictures", c_int32),
        ("truths", c_int32),
        ("poses", c_int32),
        ("unseeing", c_int32),
        ("reserved", c_int32),
    ]


class tides_generator(Structure):
    """const char *name; /* "fan" */
    const char *sentence; /* what is to be seen */
    const char *counted; /* what options.count counts: "balls"; NULL: nothing */
    int32_t count; /* default count; 0 if `counted` is NULL */
    int32_t count_most; /* largest options.count */
    int64_t gaussians; /* default number for each moving object (the plane, the fan's blades); 0: can't be chosen */
    double duration_s; /* default duration of motions and path [s] */
    """

    name: bytes | None
    sentence: bytes | None
    counted: bytes | None
    count: int
    count_most: int
    gaussians: int
    duration_s: float

    _fields_ = [
        ("name", c_char_p),
        ("sentence", c_char_p),
        ("counted", c_char_p),
        ("count", c_int32),
        ("count_most", c_int32),
        ("gaussians", c_int64),
        ("duration_s", c_double),
    ]


class tides_generate_options(Structure):
    """uint32_t size; /* sizeof this struct, set by the defaults function */
    int32_t count; /* number of what the kind counts; 0: its default */
    int64_t gaussians; /* about the number for each moving object (its grids are rounded); 0: the kind's default */
    double duration_s; /* duration of motions and camera path, from second 0 [s], up to 600; 0: the kind's default */
    double speed; /* objects (of the plane: the camera) are this many times as fast, in (0, 1000] */
    uint64_t seed; /* of colours, places, phases and the camera's shake */
    int32_t width, height; /* of the image [px]; the field of view is always 60 degrees across */
    """

    size: int
    count: int
    gaussians: int
    duration_s: float
    speed: float
    seed: int
    width: int
    height: int

    _fields_ = [
        ("size", c_uint32),
        ("count", c_int32),
        ("gaussians", c_int64),
        ("duration_s", c_double),
        ("speed", c_double),
        ("seed", c_uint64),
        ("width", c_int32),
        ("height", c_int32),
    ]


class tides_world(Structure):
    """tides_scene *scene; /* with its objects' motions */
    tides_trajectory *camera; /* the path of a camera that sees the scene */
    tides_intrinsics intrinsics; /* of that camera */
    double background[3]; /* for scene.background: linear r g b */
    double duration_s; /* of motions and path [s] */
    """

    scene: Any
    camera: Any
    intrinsics: tides_intrinsics
    background: Any
    duration_s: float

    _fields_ = [
        ("scene", P(tides_scene)),
        ("camera", P(tides_trajectory)),
        ("intrinsics", tides_intrinsics),
        ("background", c_double * 3),
        ("duration_s", c_double),
    ]


class tides_channel(Structure):
    """const char *name; /* e.g. "L_dot"; EXR sorts them by name */
    const float *pixels; /* (height x width), row 0 on top */
    """

    name: bytes | None
    pixels: Any

    _fields_ = [
        ("name", c_char_p),
        ("pixels", P(c_float)),
    ]


class tides_truth(Structure):
    """double *plane[TIDES_TRUTHS]; /* by TIDES_TRUTH_* */
    """

    plane: Any

    _fields_ = [
        ("plane", P(c_double) * 9),
    ]


class tides_material_point(Structure):
    """int32_t object; /* number of the object in the scene; -1: no point */
    int32_t reserved;
    int64_t gaussian; /* within the object */
    double xi[3]; /* in standard deviations [1] */
    """

    object: int
    reserved: int
    gaussian: int
    xi: Any

    _fields_ = [
        ("object", c_int32),
        ("reserved", c_int32),
        ("gaussian", c_int64),
        ("xi", c_double * 3),
    ]


class tides_track(Structure):
    """double u, v; /* [px], (0.5, 0.5) is the first pixel's centre; NaN behind the near plane, or without a point */
    double depth; /* camera z [scene units]; NaN without a point */
    int32_t visible; /* 1: in the image, and not behind what is seen there (the splat of the median depth) */
    int32_t reserved;
    """

    u: float
    v: float
    depth: float
    visible: int
    reserved: int

    _fields_ = [
        ("u", c_double),
        ("v", c_double),
        ("depth", c_double),
        ("visible", c_int32),
        ("reserved", c_int32),
    ]


class tides_event_truth(Structure):
    """double flow_u, flow_v; /* [px/s] */
    double depth, alpha; /* [scene units], [1] */
    int32_t instance, reserved; /* the scene's object; -1 where nothing is seen */
    """

    flow_u: float
    flow_v: float
    depth: float
    alpha: float
    instance: int
    reserved: int

    _fields_ = [
        ("flow_u", c_double),
        ("flow_v", c_double),
        ("depth", c_double),
        ("alpha", c_double),
        ("instance", c_int32),
        ("reserved", c_int32),
    ]


class tides_event_conversion(Structure):
    """const char *from, *to; /* names of formats; NULL: by content, by ending */
    int32_t width, height; /* of the sensor [px]; 0: what the file says, else what its events reach */
    int64_t start_ns, stop_ns; /* events with start <= t < stop are kept */
    int32_t x, y, cut_width, cut_height; /* and those in this window, which becomes the sensor; cut_width 0: all */
    int32_t rebase; /* 1: times count from the recording's zero; start_ns and stop_ns are then relative to it */
    int32_t drop_invalid; /* 1: invalid events are left out and counted; `width` and `height` then bound the sensor too */
    const char *columns, *unit, *stream; /* options of reading (tides_event_reading), or NULL */
    int64_t offset_ns; /* added to all times, after `rebase`; start_ns and stop_ns apply after it */
    const tides_filters *filters; /* filters that the kept events go through; NULL: none */
    """

    to: bytes | None
    width: int
    height: int
    start_ns: int
    stop_ns: int
    x: int
    y: int
    cut_width: int
    cut_height: int
    rebase: int
    drop_invalid: int
    columns: bytes | None
    unit: bytes | None
    stream: bytes | None
    offset_ns: int
    filters: Any

    _fields_ = [
        ("from", c_char_p),
        ("to", c_char_p),
        ("width", c_int32),
        ("height", c_int32),
        ("start_ns", c_int64),
        ("stop_ns", c_int64),
        ("x", c_int32),
        ("y", c_int32),
        ("cut_width", c_int32),
        ("cut_height", c_int32),
        ("rebase", c_int32),
        ("drop_invalid", c_int32),
        ("columns", c_char_p),
        ("unit", c_char_p),
        ("stream", c_char_p),
        ("offset_ns", c_int64),
        ("filters", P(tides_filters)),
    ]


class tides_event_conversion_report(Structure):
    """uint64_t read, written; /* events */
    uint64_t disorder; /* events that were earlier than the one before in the file; they were sorted */
    uint64_t collapsed; /* events that share their pixel and the format's tick with an earlier one */
    int64_t first_ns, last_ns; /* of the written events; 0 if there are none */
    int32_t width, height; /* [px] of the sensor as written */
    char from[32], to[32]; /* names of formats */
    int32_t labels; /* TIDES_LABEL_* that the file had; they aren't kept */
    int32_t zero; /* with `rebase`: TIDES_ZERO_* */
    int64_t zero_ns; /* with `rebase`: what became time 0, on the file's clock */
    uint64_t dropped; /* invalid events that were left out */
    char read_as[160]; /* how columns and units were decided if the format leaves them open, else "" */
    uint64_t filtered[TIDES_STAGES]; /* dropped by `filters`, by TIDES_STAGE_* */
    """

    read: int
    written: int
    disorder: int
    collapsed: int
    first_ns: int
    last_ns: int
    width: int
    height: int
    to: Any
    labels: int
    zero: int
    zero_ns: int
    dropped: int
    read_as: Any
    filtered: Any

    _fields_ = [
        ("read", c_uint64),
        ("written", c_uint64),
        ("disorder", c_uint64),
        ("collapsed", c_uint64),
        ("first_ns", c_int64),
        ("last_ns", c_int64),
        ("width", c_int32),
        ("height", c_int32),
        ("from", c_char * 32),
        ("to", c_char * 32),
        ("labels", c_int32),
        ("zero", c_int32),
        ("zero_ns", c_int64),
        ("dropped", c_uint64),
        ("read_as", c_char * 160),
        ("filtered", c_uint64 * 5),
    ]


class tides_match(Structure):
    """uint64_t reference, simulated; /* events in the streams */
    uint64_t matched; /* pairs */
    uint64_t missing, spurious; /* events of the reference, and of the simulated stream, without a counterpart */
    double mismatch_percent; /* 100 (missing + spurious) / reference; 0 if both are empty, infinite if only the reference is */
    double dt_median_us, dt_p95_us, dt_p99_us, dt_max_us; /* of |simulated - reference| over the pairs [us] */
    double dt_mean_us; /* mean of simulated - reference, with its sign: the bias [us] */
    """

    reference: int
    simulated: int
    matched: int
    missing: int
    spurious: int
    mismatch_percent: float
    dt_median_us: float
    dt_p95_us: float
    dt_p99_us: float
    dt_max_us: float
    dt_mean_us: float

    _fields_ = [
        ("reference", c_uint64),
        ("simulated", c_uint64),
        ("matched", c_uint64),
        ("missing", c_uint64),
        ("spurious", c_uint64),
        ("mismatch_percent", c_double),
        ("dt_median_us", c_double),
        ("dt_p95_us", c_double),
        ("dt_p99_us", c_double),
        ("dt_max_us", c_double),
        ("dt_mean_us", c_double),
    ]


class tides_metrics_options(Structure):
    """uint32_t size; /* sizeof this struct */
    uint32_t wanted; /* TIDES_METRIC_* */
    int32_t width, height; /* sensor [px]; 0, 0: as large as the events need */
    int32_t roi[4]; /* x, y, width, height [px]: only events in it, coordinates from its corner; width 0: all */
    /* only events in [start, stop); equal: from the first event of both to the last, in whole ticks; TIDES_BAD_ARGUMENT if
    * the streams then share no time */
    int64_t start_ns, stop_ns;
    int64_t tick_ns; /* times are floored to this clock (except for the match); 0: unchanged */
    double isi_floor_s; /* shorter intervals count as this, > 0 */
    double clock_s; /* ISI spike: period of a known clock; 0: find the spikes */
    double fano_bin_s[TIDES_FANO_BINS]; /* lengths of the bins that are counted in [s], > 0 */
    int32_t fano_tile_px; /* edge of the tiles of Fano error and Same-ts, > 0 */
    int32_t fano_events_min; /* tiles with fewer events than this, in either stream, are left out */
    double fano_epsilon; /* added to both Fano factors before the logarithm, > 0 */
    double speed_px_per_s; /* Chamfer: v; 0: from the reference */
    double window_s; /* Chamfer: length of the windows whose events are compared */
    double cell_px; /* Chamfer: edge of a cell, which keeps one point */
    double victor_purpura_per_s; /* cost of shifting an event by a second; adding or removing one costs 1 */
    double van_rossum_s; /* time constant of the filter */
    double difference_limit_s; /* time difference: upper limit, also used for missing events */
    double kernel_px, kernel_s; /* standard deviations of the Gaussian kernel */
    double match_limit_s; /* greatest distance of matched events */
    """

    size: int
    wanted: int
    width: int
    height: int
    roi: Any
    start_ns: int
    stop_ns: int
    tick_ns: int
    isi_floor_s: float
    clock_s: float
    fano_bin_s: Any
    fano_tile_px: int
    fano_events_min: int
    fano_epsilon: float
    speed_px_per_s: float
    window_s: float
    cell_px: float
    victor_purpura_per_s: float
    van_rossum_s: float
    difference_limit_s: float
    kernel_px: float
    kernel_s: float
    match_limit_s: float

    _fields_ = [
        ("size", c_uint32),
        ("wanted", c_uint32),
        ("width", c_int32),
        ("height", c_int32),
        ("roi", c_int32 * 4),
        ("start_ns", c_int64),
        ("stop_ns", c_int64),
        ("tick_ns", c_int64),
        ("isi_floor_s", c_double),
        ("clock_s", c_double),
        ("fano_bin_s", c_double * 3),
        ("fano_tile_px", c_int32),
        ("fano_events_min", c_int32),
        ("fano_epsilon", c_double),
        ("speed_px_per_s", c_double),
        ("window_s", c_double),
        ("cell_px", c_double),
        ("victor_purpura_per_s", c_double),
        ("van_rossum_s", c_double),
        ("difference_limit_s", c_double),
        ("kernel_px", c_double),
        ("kernel_s", c_double),
        ("match_limit_s", c_double),
    ]


class tides_interval_fit(Structure):
    """uint64_t count, floored; /* intervals; intervals shorter than the floor */
    double mean_s, shape_s; /* NaN without intervals */
    """

    count: int
    floored: int
    mean_s: float
    shape_s: float

    _fields_ = [
        ("count", c_uint64),
        ("floored", c_uint64),
        ("mean_s", c_double),
        ("shape_s", c_double),
    ]


class tides_stream_metrics(Structure):
    """uint64_t events; /* in the interval and region */
    double on_fraction; /* ON events / events */
    tides_interval_fit intervals[TIDES_PAIRS]; /* by the polarities of the pair */
    double isi_spike; /* fraction of all intervals that are at most 1 us, or at the quanta of a clock */
    double same_time; /* fraction of events that share their tick with another event of the sensor */
    double same_time_tile; /* fraction of events that share their tick with another event of their tile */
    double fano[TIDES_FANO_BINS]; /* mean Fano factor of the compared tiles: variance of the counts (over n - 1 bins) / mean */
    double van_rossum_norm; /* squared van Rossum distance from no events at all, summed like van_rossum */
    """

    events: int
    on_fraction: float
    intervals: Any
    isi_spike: float
    same_time: float
    same_time_tile: float
    fano: Any
    van_rossum_norm: float

    _fields_ = [
        ("events", c_uint64),
        ("on_fraction", c_double),
        ("intervals", tides_interval_fit * 3),
        ("isi_spike", c_double),
        ("same_time", c_double),
        ("same_time_tile", c_double),
        ("fano", c_double * 3),
        ("van_rossum_norm", c_double),
    ]


class tides_metrics(Structure):
    """uint32_t computed; /* TIDES_METRIC_*; the fields of other families are NaN or 0 */
    int32_t width, height; /* [px] of the sensor, or of the region of interest */
    int64_t start_ns, stop_ns; /* the interval */
    tides_stream_metrics reference, simulated; /* of each stream by itself */
    double count_ratio; /* events of the simulated stream / of the reference */
    double count_ratio_on, count_ratio_off; /* the same for each polarity */
    double rate_error[TIDES_FANO_BINS]; /* sum over bins of time, each as long as the Fano factor's, of the whole sensor's
    |simulated - reference| events, over the reference's events: 0 equal rates */
    double region_error; /* the same sum over tiles of fano_tile_px, over the reference's events */
    double count_correlation; /* Pearson's correlation of events per pixel; NaN if either count is the same everywhere */
    /* Negative log-likelihood of the reference's intervals [nats per interval, tau in seconds] under the fit to the simulated
    * ones, and under their own fit; excess is the difference: the Kullback-Leibler divergence of the fits, free of units, not
    * negative. NaN under 2 simulated intervals or 1 of the reference. Blind to batching shorter than the intervals. */
    double ig_nll[TIDES_PAIRS], ig_nll_self[TIDES_PAIRS], ig_nll_excess[TIDES_PAIRS]; /* as above */
    double isi_w1; /* Wasserstein-1 distance of log10 of all intervals [decades] */
    double isi_w1_after[2]; /* the same for intervals whose first event is OFF, ON */
    double fano_error[TIDES_FANO_BINS]; /* mean |ln((F_simulated + epsilon) / (F_reference + epsilon))| over the tiles */
    uint64_t fano_tiles[TIDES_FANO_BINS]; /* tiles compared */
    double fano_coverage[TIDES_FANO_BINS]; /* compared tiles / tiles of the reference with enough events */
    /* Events as points (x, y, v t), each polarity and window by itself, one point per cell (the mean of its events);
    * distances to the nearest point of the other stream, at most chamfer_limit_px; C = (mean + mean) / 2, averaged over the
    * terms with their numbers of points. A term with one stream empty counts as the limit. */
    double speed_px_per_s; /* v: given, or 1 / median time since the latest earlier event, within 50 ms, of the 4-neighbours and
    the polarity: one at the same time doesn't count */
    double chamfer_px; /* C [px] */
    double chamfer_fraction; /* of the diagonal */
    double chamfer_limit_px; /* min(v window, diagonal) */
    double chamfer_to_simulated_px, chamfer_to_reference_px; /* means of all points of the reference, of the simulated stream */
    uint64_t chamfer_terms, chamfer_one_sided; /* terms: windows of a polarity; those in which one stream is empty */
    /* Spike-train distances between the trains of each pixel and polarity, summed. */
    double victor_purpura; /* least cost of turning one train into the other */
    double victor_purpura_fraction; /* of the cost of removing and adding everything: 0 identical, 1 nothing near */
    double van_rossum; /* squared: sum of w_i w_j exp(-|t_i - t_j| / tau), w = 1 and -1 */
    double van_rossum_fraction; /* of the two norms' sum: 0 identical, 1 nothing near */
    double time_difference_us; /* mean over the reference's events (V2CE, stage 2), at most difference_limit_s */
    uint64_t time_difference_over; /* events above the limit, or without any counterpart */
    double kernel_distance; /* squared distance of the streams under the Gaussian kernel, polarity as sign */
    tides_match match; /* pairs of events */
    double matched_share; /* 2 pairs / events of both streams: 1 if every event has its counterpart within the limit */
    """

    computed: int
    width: int
    height: int
    start_ns: int
    stop_ns: int
    reference: tides_stream_metrics
    simulated: tides_stream_metrics
    count_ratio: float
    count_ratio_on: float
    count_ratio_off: float
    rate_error: Any
    region_error: float
    count_correlation: float
    ig_nll: Any
    ig_nll_self: Any
    ig_nll_excess: Any
    isi_w1: float
    isi_w1_after: Any
    fano_error: Any
    fano_tiles: Any
    fano_coverage: Any
    speed_px_per_s: float
    chamfer_px: float
    chamfer_fraction: float
    chamfer_limit_px: float
    chamfer_to_simulated_px: float
    chamfer_to_reference_px: float
    chamfer_terms: int
    chamfer_one_sided: int
    victor_purpura: float
    victor_purpura_fraction: float
    van_rossum: float
    van_rossum_fraction: float
    time_difference_us: float
    time_difference_over: int
    kernel_distance: float
    match: tides_match
    matched_share: float

    _fields_ = [
        ("computed", c_uint32),
        ("width", c_int32),
        ("height", c_int32),
        ("start_ns", c_int64),
        ("stop_ns", c_int64),
        ("reference", tides_stream_metrics),
        ("simulated", tides_stream_metrics),
        ("count_ratio", c_double),
        ("count_ratio_on", c_double),
        ("count_ratio_off", c_double),
        ("rate_error", c_double * 3),
        ("region_error", c_double),
        ("count_correlation", c_double),
        ("ig_nll", c_double * 3),
        ("ig_nll_self", c_double * 3),
        ("ig_nll_excess", c_double * 3),
        ("isi_w1", c_double),
        ("isi_w1_after", c_double * 2),
        ("fano_error", c_double * 3),
        ("fano_tiles", c_uint64 * 3),
        ("fano_coverage", c_double * 3),
        ("speed_px_per_s", c_double),
        ("chamfer_px", c_double),
        ("chamfer_fraction", c_double),
        ("chamfer_limit_px", c_double),
        ("chamfer_to_simulated_px", c_double),
        ("chamfer_to_reference_px", c_double),
        ("chamfer_terms", c_uint64),
        ("chamfer_one_sided", c_uint64),
        ("victor_purpura", c_double),
        ("victor_purpura_fraction", c_double),
        ("van_rossum", c_double),
        ("van_rossum_fraction", c_double),
        ("time_difference_us", c_double),
        ("time_difference_over", c_uint64),
        ("kernel_distance", c_double),
        ("match", tides_match),
        ("matched_share", c_double),
    ]


class tides_metric(Structure):
    """const char *name; /* as in the tool's JSON: "chamfer_px" */
    const char *family; /* as in --only: "chamfer" */
    uint32_t wanted; /* TIDES_METRIC_* of its family */
    const char *unit, *sentence; /* "px", or "" */
    int32_t better; /* TIDES_BETTER_* */
    int32_t of, repeats; /* TIDES_OF_*; TIDES_REPEATS_* */
    int32_t is_real; /* 1: double; 0: uint64_t */
    size_t offset, stride; /* of its field; between repeated fields [bytes] */
    """

    name: bytes | None
    family: bytes | None
    wanted: int
    unit: bytes | None
    sentence: bytes | None
    better: int
    of: int
    repeats: int
    is_real: int
    offset: int
    stride: int

    _fields_ = [
        ("name", c_char_p),
        ("family", c_char_p),
        ("wanted", c_uint32),
        ("unit", c_char_p),
        ("sentence", c_char_p),
        ("better", c_int32),
        ("of", c_int32),
        ("repeats", c_int32),
        ("is_real", c_int32),
        ("offset", c_size_t),
        ("stride", c_size_t),
    ]


class tides_blemishes(Structure):
    """int64_t *burst; /* (bursts x 2): [start, stop) in ns, ascending, apart */
    uint16_t *hot; /* (hots x 2): x, y, row by row */
    size_t bursts, hots; /* numbers of bursts and of hot pixels */
    uint64_t burst_events, hot_events; /* of the recording: in bursts; of hot pixels outside bursts */
    """

    burst: Any
    hot: Any
    bursts: int
    hots: int
    burst_events: int
    hot_events: int

    _fields_ = [
        ("burst", P(c_int64)),
        ("hot", P(c_uint16)),
        ("bursts", c_size_t),
        ("hots", c_size_t),
        ("burst_events", c_uint64),
        ("hot_events", c_uint64),
    ]


class tides_voxel_options(Structure):
    """uint32_t size; /* sizeof this struct */
    int32_t bins; /* 1 to 4096 */
    int32_t normalise; /* TIDES_NORMALISE_* */
    /* Times of the first and last bin, events outside are left out; equal: of the first and last event. */
    int64_t start_ns, stop_ns;
    """

    size: int
    bins: int
    normalise: int
    start_ns: int
    stop_ns: int

    _fields_ = [
        ("size", c_uint32),
        ("bins", c_int32),
        ("normalise", c_int32),
        ("start_ns", c_int64),
        ("stop_ns", c_int64),
    ]


class tides_array_shape(Structure):
    """const char *name; /* of the dataset */
    int32_t planes, height, width; /* of one array */
    const char *const *plane_names; /* (planes), or NULL */
    """

    name: bytes | None
    planes: int
    height: int
    width: int
    plane_names: Any

    _fields_ = [
        ("name", c_char_p),
        ("planes", c_int32),
        ("height", c_int32),
        ("width", c_int32),
        ("plane_names", P(c_char_p)),
    ]


class tides_page_options(Structure):
    """uint32_t size; /* sizeof this struct */
    int32_t width, height; /* of the sensor [px]; 0: what the file says, else what the events reach */
    int64_t start_ns, stop_ns; /* events with start <= t < stop are shown */
    int64_t window_ns; /* first length of the window of time; 0: a fiftieth of the shown stretch */
    uint64_t most; /* at most this many events are shown; the page and the report say so if there are more */
    const char *title; /* NULL: the name of the file that is read */
    const char *format; /* of the file that is read; NULL: by content */
    const struct tides_event_reading *reading; /* options of reading; NULL: as `format` says */
    """

    size: int
    width: int
    height: int
    start_ns: int
    stop_ns: int
    window_ns: int
    most: int
    title: bytes | None
    format: bytes | None
    reading: Any

    _fields_ = [
        ("size", c_uint32),
        ("width", c_int32),
        ("height", c_int32),
        ("start_ns", c_int64),
        ("stop_ns", c_int64),
        ("window_ns", c_int64),
        ("most", c_uint64),
        ("title", c_char_p),
        ("format", c_char_p),
        ("reading", P(tides_event_reading)),
    ]


class tides_page_report(Structure):
    """uint64_t events; /* in the page */
    int64_t start_ns, stop_ns; /* the stretch that the page shows */
    int32_t width, height; /* of the sensor [px] */
    int32_t truth; /* 1: with ground truth */
    int32_t ended; /* 1: there were too many events; those from stop_ns on aren't shown */
    """

    events: int
    start_ns: int
    stop_ns: int
    width: int
    height: int
    truth: int
    ended: int

    _fields_ = [
        ("events", c_uint64),
        ("start_ns", c_int64),
        ("stop_ns", c_int64),
        ("width", c_int32),
        ("height", c_int32),
        ("truth", c_int32),
        ("ended", c_int32),
    ]


class tides_run_input(Structure):
    """const char *key; /* key of the run file: "scene.objects" */
    const char *path; /* resolved against the folder of the run file */
    int32_t folder; /* 1: a folder, with everything in it */
    int32_t reserved;
    """

    key: bytes | None
    path: bytes | None
    folder: int
    reserved: int

    _fields_ = [
        ("key", c_char_p),
        ("path", c_char_p),
        ("folder", c_int32),
        ("reserved", c_int32),
    ]


class tides_fingerprint(Structure):
    """uint64_t hash; /* FNV-1a, 64 bits */
    uint64_t files; /* number of files */
    uint64_t bytes; /* total size */
    uint64_t largest; /* of the largest one [bytes] */
    """

    hash: int
    files: int
    bytes: int
    largest: int

    _fields_ = [
        ("hash", c_uint64),
        ("files", c_uint64),
        ("bytes", c_uint64),
        ("largest", c_uint64),
    ]


class tides_live_options(Structure):
    """uint32_t size;
    int32_t camera; /* 1: the caller gives its poses; 0: it follows the run's path */
    const int32_t *objects; /* (object_count) numbers of the scene's objects that get poses from the caller; */
    size_t object_count; /* the others follow their paths. NULL if it is 0 */
    double stop; /* [s] the run's end, where the last step ends; NaN: as far as there are poses */
    double most_speed; /* [scene units/s] a pose that needs a higher speed is refused as a jump; 0: none */
    double most_turn_rate; /* [rad/s] the same for turns; 0: any turn below 179 degrees */
    int32_t keep; /* 1: all poses are kept, for tides_live_path; 0: they are forgotten once they aren't needed */
    int32_t reserved;
    """

    size: int
    camera: int
    objects: Any
    object_count: int
    stop: float
    most_speed: float
    most_turn_rate: float
    keep: int
    reserved: int

    _fields_ = [
        ("size", c_uint32),
        ("camera", c_int32),
        ("objects", P(c_int32)),
        ("object_count", c_size_t),
        ("stop", c_double),
        ("most_speed", c_double),
        ("most_turn_rate", c_double),
        ("keep", c_int32),
        ("reserved", c_int32),
    ]


class tides_exact_options(Structure):
    """uint32_t size;
    int32_t in_double; /* 1: in double precision, whatever the device: slow */
    double first_step_s; /* continuous images: longest step of the first level [s]; 0: an eighth of 10 ms or of the run */
    double last_tolerance; /* continuous images: least tolerance of a level [thresholds]; 0: as low as the precision allows */
    /* images with jumps: steps per second of the first level; the least and the most of the last level [Hz]; 0: from
    * long_renders, twice that, 512 kHz */
    double first_rate, least_rate, last_rate;
    double long_renders; /* the last level is the first with so many full renders (but at least least_rate); 500 */
    """

    size: int
    in_double: int
    first_step_s: float
    last_tolerance: float
    first_rate: float
    least_rate: float
    last_rate: float
    long_renders: float

    _fields_ = [
        ("size", c_uint32),
        ("in_double", c_int32),
        ("first_step_s", c_double),
        ("last_tolerance", c_double),
        ("first_rate", c_double),
        ("least_rate", c_double),
        ("last_rate", c_double),
        ("long_renders", c_double),
    ]


class tides_exact(Structure):
    """tides_event *events; /* (count), in order; the caller frees them with tides_free */
    size_t count; /* number of events */
    double steps_per_s; /* steps per second of the last level; 0: straight lines between frames, solved in closed form */
    double tolerance; /* of the last level [thresholds]; 0: equal steps */
    tides_match moved; /* how the last level differs from the one before, with steps twice as long */
    double worst_residual; /* worst_residual of tides_stats */
    double renders; /* of the last level, in full frames */
    """

    events: Any
    count: int
    steps_per_s: float
    tolerance: float
    moved: tides_match
    worst_residual: float
    renders: float

    _fields_ = [
        ("events", P(tides_event)),
        ("count", c_size_t),
        ("steps_per_s", c_double),
        ("tolerance", c_double),
        ("moved", tides_match),
        ("worst_residual", c_double),
        ("renders", c_double),
    ]


class tides_calibrated(Structure):
    """double value; /* NaN where unknown */
    double error; /* one sigma: of random halves of the pixels, or of what halves differ by, whichever is more */
    double early, late; /* of the halves of the time, */
    double left, right; /* and of the image */
    double raw; /* before what a simulation says is taken off */
    int32_t state; /* TIDES_CALIBRATED_UNKNOWN ... */
    int32_t reserved;
    """

    value: float
    error: float
    early: float
    late: float
    left: float
    right: float
    raw: float
    state: int
    reserved: int

    _fields_ = [
        ("value", c_double),
        ("error", c_double),
        ("early", c_double),
        ("late", c_double),
        ("left", c_double),
        ("right", c_double),
        ("raw", c_double),
        ("state", c_int32),
        ("reserved", c_int32),
    ]


class tides_calibrated_row(Structure):
    """const char *name, *key, *unit; /* static storage */
    """

    name: bytes | None
    key: bytes | None
    unit: bytes | None

    _fields_ = [
        ("name", c_char_p),
        ("key", c_char_p),
        ("unit", c_char_p),
    ]


class tides_calibrate_options(Structure):
    """uint32_t size;
    int32_t reserved;
    int64_t start_ns, stop_ns; /* the stretch [start, stop); INT64_MIN, INT64_MAX: of what recording and light have in common
    the busiest second */
    int32_t x, y, width, height; /* pixels that count; width 0: all */
    double given[TIDES_CALIBRATED_VALUES]; /* values that are known; NaN: to be measured. A threshold can't be given */
    const char *still; /* a recording of a still scene or behind a cap, for noise and leak; or NULL */
    const struct tides_event_reading *reading; /* how the recordings are read; NULL: by content */
    uint64_t seed; /* of the halves and the simulations */
    """

    size: int
    reserved: int
    start_ns: int
    stop_ns: int
    x: int
    y: int
    width: int
    height: int
    given: Any
    still: bytes | None
    reading: Any
    seed: int

    _fields_ = [
        ("size", c_uint32),
        ("reserved", c_int32),
        ("start_ns", c_int64),
        ("stop_ns", c_int64),
        ("x", c_int32),
        ("y", c_int32),
        ("width", c_int32),
        ("height", c_int32),
        ("given", c_double * 9),
        ("still", c_char_p),
        ("reading", P(tides_event_reading)),
        ("seed", c_uint64),
    ]


class tides_calibration(Structure):
    """tides_calibrated values[TIDES_CALIBRATED_VALUES]; /* by TIDES_CALIBRATED_* */
    int32_t law; /* TIDES_PHOTORECEPTOR_*: whether the pole goes with light */
    int32_t refused; /* 1: recording and light don't belong together, or tell nothing: no preset can be written */
    double transitions[4]; /* medians of changes [thresholds]: ON after ON, ON after OFF, OFF after OFF, OFF after ON */
    uint64_t transition_pairs[4]; /* pairs of events in each of these medians */
    double deviation; /* mean relative deviation of changes from their medians */
    double agreement; /* share of changes that have the sign of their event */
    double correlation; /* between black level and threshold_on, over random halves of the pixels */
    double starts[4][2]; /* shares of pixels that began below, above their reference: recording; simulations that begin
    at TIDES_INITIAL_REST, RANDOM, STEADY */
    double dead_share; /* of the pixels whose light moved by three thresholds and more: those without an event */
    int64_t start_ns, stop_ns; /* the stretch */
    uint64_t events, burst_events, pairs; /* in the stretch; in bursts of frames' readout; pairs that were used */
    uint64_t pixels, still_pixels; /* whose light was sampled; that rested */
    int32_t bursts, samples; /* of frames' readout; times at which light was sampled */
    int32_t initial, reserved; /* TIDES_INITIAL_*: where references begin; -1: the recording doesn't tell */
    int32_t hot_count; /* pixels that fire far more often than their light says, */
    int32_t map_width, map_height, rate_count; /* sizes of the arrays below */
    uint16_t hot[TIDES_CALIBRATION_HOT][2]; /* x, y of the first of them */
    double pole_scan[TIDES_CALIBRATION_SCAN][2]; /* deviation over pole [s], the rest as found */
    double eps_scan[TIDES_CALIBRATION_SCAN][2]; /* and over black level */
    double *map; /* (map_height x map_width): mean change of tiles of 4x4 px, 1: the median;
    NaN: too few events */
    double *rate_s, *rate, *rate_simulated; /* (rate_count): [s], [1/s] of the pixels whose light was sampled */
    char *notes; /* what is to be said of it, lines; "" where nothing */
    """

    values: Any
    law: int
    refused: int
    transitions: Any
    transition_pairs: Any
    deviation: float
    agreement: float
    correlation: float
    starts: Any
    dead_share: float
    start_ns: int
    stop_ns: int
    events: int
    burst_events: int
    pairs: int
    pixels: int
    still_pixels: int
    bursts: int
    samples: int
    initial: int
    reserved: int
    hot_count: int
    map_width: int
    map_height: int
    rate_count: int
    hot: Any
    pole_scan: Any
    eps_scan: Any
    map: Any
    rate_s: Any
    rate: Any
    rate_simulated: Any
    notes: bytes | None

    _fields_ = [
        ("values", tides_calibrated * 9),
        ("law", c_int32),
        ("refused", c_int32),
        ("transitions", c_double * 4),
        ("transition_pairs", c_uint64 * 4),
        ("deviation", c_double),
        ("agreement", c_double),
        ("correlation", c_double),
        ("starts", c_double * 2 * 4),
        ("dead_share", c_double),
        ("start_ns", c_int64),
        ("stop_ns", c_int64),
        ("events", c_uint64),
        ("burst_events", c_uint64),
        ("pairs", c_uint64),
        ("pixels", c_uint64),
        ("still_pixels", c_uint64),
        ("bursts", c_int32),
        ("samples", c_int32),
        ("initial", c_int32),
        ("reserved", c_int32),
        ("hot_count", c_int32),
        ("map_width", c_int32),
        ("map_height", c_int32),
        ("rate_count", c_int32),
        ("hot", c_uint16 * 2 * 256),
        ("pole_scan", c_double * 2 * 25),
        ("eps_scan", c_double * 2 * 25),
        ("map", P(c_double)),
        ("rate_s", P(c_double)),
        ("rate", P(c_double)),
        ("rate_simulated", P(c_double)),
        ("notes", c_char_p),
    ]


# name: (type of the result, types of the arguments, their names)
FUNCTIONS: dict[str, tuple[Any, list[Any], str]] = {
    # void tides_animation_abandon(tides_animation *animation)
    "tides_animation_abandon": (None, [P(tides_animation)], "animation"),
    # tides_status tides_animation_append(tides_animation *animation, const uint8_t *rgb, tides_error *error)
    "tides_animation_append": (c_int32, [P(tides_animation), P(c_uint8), P(tides_error)], "animation rgb error"),
    # tides_status tides_animation_finish(tides_animation *animation, tides_error *error)
    "tides_animation_finish": (c_int32, [P(tides_animation), P(tides_error)], "animation error"),
    # tides_status tides_animation_open(const char *path, int32_t width, int32_t height, double pictures_per_second,
    # tides_animation **animation, tides_error *error)
    "tides_animation_open": (c_int32, [
        c_char_p, c_int32, c_int32, c_double, P(P(tides_animation)), P(tides_error)
    ], "path width height pictures_per_second animation error"),
    # tides_status tides_animation_stream(int32_t descriptor, int32_t width, int32_t height, double pictures_per_second,
    # tides_animation **animation, tides_error *error)
    "tides_animation_stream": (c_int32, [
        c_int32, c_int32, c_int32, c_double, P(P(tides_animation)), P(tides_error)
    ], "descriptor width height pictures_per_second animation error"),
    # tides_status tides_arbiter_activity(tides_arbiter *arbiter, const double *psi, tides_error *error)
    "tides_arbiter_activity": (c_int32, [P(tides_arbiter), P(c_double), P(tides_error)], "arbiter psi error"),
    # tides_status tides_arbiter_create(const tides_readout *readout, int32_t width, int32_t height, uint64_t seed,
    # tides_arbiter **arbiter, tides_error *error)
    "tides_arbiter_create": (c_int32, [
        P(tides_readout), c_int32, c_int32, c_uint64, P(P(tides_arbiter)), P(tides_error)
    ], "readout width height seed arbiter error"),
    # void tides_arbiter_destroy(tides_arbiter *arbiter)
    "tides_arbiter_destroy": (None, [P(tides_arbiter)], "arbiter"),
    # tides_status tides_arbiter_finish(tides_arbiter *arbiter, tides_readout_sink sink, void *user, tides_error *error)
    "tides_arbiter_finish": (c_int32, [
        P(tides_arbiter), tides_readout_sink, c_void_p, P(tides_error)
    ], "arbiter sink user error"),
    # tides_status tides_arbiter_push(tides_arbiter *arbiter, const tides_event *events, size_t count,
    # tides_readout_sink sink, void *user, tides_error *error)
    "tides_arbiter_push": (c_int32, [
        P(tides_arbiter), P(tides_event), c_size_t, tides_readout_sink, c_void_p, P(tides_error)
    ], "arbiter events count sink user error"),
    # void tides_arbiter_start(tides_arbiter *arbiter, int64_t start_ns)
    "tides_arbiter_start": (None, [P(tides_arbiter), c_int64], "arbiter start_ns"),
    # void tides_arbiter_stats(const tides_arbiter *arbiter, tides_readout_stats *stats)
    "tides_arbiter_stats": (None, [P(tides_arbiter), P(tides_readout_stats)], "arbiter stats"),
    # void tides_arbiter_tiles(const tides_arbiter *arbiter, int32_t *across, int32_t *down)
    "tides_arbiter_tiles": (None, [P(tides_arbiter), P(c_int32), P(c_int32)], "arbiter across down"),
    # void tides_array_writer_abandon(tides_array_writer *writer)
    "tides_array_writer_abandon": (None, [P(tides_array_writer)], "writer"),
    # tides_status tides_array_writer_append(tides_array_writer *writer, const double *array, int64_t start_ns, int64_t
    # stop_ns, uint64_t events, tides_error *error)
    "tides_array_writer_append": (c_int32, [
        P(tides_array_writer), P(c_double), c_int64, c_int64, c_uint64, P(tides_error)
    ], "writer array start_ns stop_ns events error"),
    # tides_status tides_array_writer_finish(tides_array_writer *writer, tides_error *error)
    "tides_array_writer_finish": (c_int32, [P(tides_array_writer), P(tides_error)], "writer error"),
    # tides_status tides_array_writer_open(const char *path, const tides_array_shape *shape, tides_array_writer
    # **writer, tides_error *error)
    "tides_array_writer_open": (c_int32, [
        c_char_p, P(tides_array_shape), P(P(tides_array_writer)), P(tides_error)
    ], "path shape writer error"),
    # tides_status tides_baseline_create(const tides_baseline_params *params, int32_t width, int32_t height,
    # tides_baseline **baseline, tides_error *error)
    "tides_baseline_create": (c_int32, [
        P(tides_baseline_params), c_int32, c_int32, P(P(tides_baseline)), P(tides_error)
    ], "params width height baseline error"),
    # void tides_baseline_destroy(tides_baseline *baseline)
    "tides_baseline_destroy": (None, [P(tides_baseline)], "baseline"),
    # tides_status tides_baseline_finish(tides_baseline *baseline, tides_event_sink sink, void *user, tides_error
    # *error)
    "tides_baseline_finish": (c_int32, [
        P(tides_baseline), tides_event_sink, c_void_p, P(tides_error)
    ], "baseline sink user error"),
    # void tides_baseline_params_defaults(tides_baseline_params *params)
    "tides_baseline_params_defaults": (None, [P(tides_baseline_params)], "params"),
    # tides_status tides_baseline_push(tides_baseline *baseline, double time, const double *Y, tides_event_sink sink,
    # void *user, tides_error *error)
    "tides_baseline_push": (c_int32, [
        P(tides_baseline), c_double, P(c_double), tides_event_sink, c_void_p, P(tides_error)
    ], "baseline time Y sink user error"),
    # tides_status tides_baseline_run(tides_baseline *baseline, const tides_frame_supply *supply, tides_event_sink sink,
    # void *sink_user, tides_progress progress, void *user, tides_stats *stats, tides_error *error)
    "tides_baseline_run": (c_int32, [
        P(tides_baseline), P(tides_frame_supply), tides_event_sink, c_void_p, tides_progress, c_void_p,
        P(tides_stats), P(tides_error)
    ], "baseline supply sink sink_user progress user stats error"),
    # tides_status tides_blemishes_find(const tides_event *events, size_t count, int32_t width, int32_t height,
    # tides_blemishes *found, tides_error *error)
    "tides_blemishes_find": (c_int32, [
        P(tides_event), c_size_t, c_int32, c_int32, P(tides_blemishes), P(tides_error)
    ], "events count width height found error"),
    # void tides_blemishes_free(tides_blemishes *blemishes)
    "tides_blemishes_free": (None, [P(tides_blemishes)], "blemishes"),
    # size_t tides_blemishes_leave_out(const tides_blemishes *blemishes, tides_event *events, size_t count)
    "tides_blemishes_leave_out": (c_size_t, [P(tides_blemishes), P(tides_event), c_size_t], "blemishes events count"),
    # tides_status tides_calibrate(const char *recording, tides_session *session, const tides_calibrate_options
    # *options, tides_progress progress, void *user, tides_calibration *found, tides_error *error)
    "tides_calibrate": (c_int32, [
        c_char_p, P(tides_session), P(tides_calibrate_options), tides_progress, c_void_p, P(tides_calibration),
        P(tides_error)
    ], "recording session options progress user found error"),
    # void tides_calibrate_options_defaults(tides_calibrate_options *options)
    "tides_calibrate_options_defaults": (None, [P(tides_calibrate_options)], "options"),
    # int32_t tides_calibrated_at(int32_t index, tides_calibrated_row *row)
    "tides_calibrated_at": (c_int32, [c_int32, P(tides_calibrated_row)], "index row"),
    # void tides_calibration_free(tides_calibration *found)
    "tides_calibration_free": (None, [P(tides_calibration)], "found"),
    # tides_status tides_calibration_preset(const tides_calibration *found, const char *about, char **text, tides_error
    # *error)
    "tides_calibration_preset": (c_int32, [
        P(tides_calibration), c_char_p, P(c_char_p), P(tides_error)
    ], "found about text error"),
    # const char *tides_channel_name(int32_t channel)
    "tides_channel_name": (c_char_p, [c_int32], "channel"),
    # int32_t tides_colour_filter_channel(int32_t filter, int32_t x, int32_t y)
    "tides_colour_filter_channel": (c_int32, [c_int32, c_int32, c_int32], "filter x y"),
    # int32_t tides_dataset_layout_at(size_t index, tides_dataset_layout *layout)
    "tides_dataset_layout_at": (c_int32, [c_size_t, P(tides_dataset_layout)], "index layout"),
    # tides_status tides_dataset_write(tides_session *session, const char *folder, const char *layouts, tides_progress
    # progress, void *user, tides_dataset_report *report, tides_error *error)
    "tides_dataset_write": (c_int32, [
        P(tides_session), c_char_p, c_char_p, tides_progress, c_void_p, P(tides_dataset_report), P(tides_error)
    ], "session folder layouts progress user report error"),
    # void tides_device_close(tides_device *device)
    "tides_device_close": (None, [P(tides_device)], "device"),
    # void tides_device_describe(const tides_device *device, tides_device_info *info)
    "tides_device_describe": (None, [P(tides_device), P(tides_device_info)], "device info"),
    # tides_status tides_device_list(tides_device_info *rows, int32_t capacity, int32_t *count, tides_error *error)
    "tides_device_list": (c_int32, [
        P(tides_device_info), c_int32, P(c_int32), P(tides_error)
    ], "rows capacity count error"),
    # tides_status tides_device_open(const char *spec, tides_device **device, tides_error *error)
    "tides_device_open": (c_int32, [c_char_p, P(P(tides_device)), P(tides_error)], "spec device error"),
    # tides_status tides_device_set_threads(tides_device *device, int32_t threads, tides_error *error)
    "tides_device_set_threads": (c_int32, [P(tides_device), c_int32, P(tides_error)], "device threads error"),
    # int32_t tides_device_threads(const tides_device *device)
    "tides_device_threads": (c_int32, [P(tides_device)], "device"),
    # double tides_esim_next_time(const tides_esim *esim, double time, double fastest)
    "tides_esim_next_time": (c_double, [P(tides_esim), c_double, c_double], "esim time fastest"),
    # void tides_event_conversion_defaults(tides_event_conversion *conversion)
    "tides_event_conversion_defaults": (None, [P(tides_event_conversion)], "conversion"),
    # int32_t tides_event_format_at(size_t index, tides_event_format *format)
    "tides_event_format_at": (c_int32, [c_size_t, P(tides_event_format)], "index format"),
    # tides_status tides_event_frame(const tides_event *events, size_t count, int32_t width, int32_t height, double
    # *frame, tides_error *error)
    "tides_event_frame": (c_int32, [
        P(tides_event), c_size_t, c_int32, c_int32, P(c_double), P(tides_error)
    ], "events count width height frame error"),
    # double tides_event_frontend(const tides_event *event)
    "tides_event_frontend": (c_double, [P(tides_event)], "event"),
    # void tides_event_reader_close(tides_event_reader *reader)
    "tides_event_reader_close": (None, [P(tides_event_reader)], "reader"),
    # void tides_event_reader_facts(const tides_event_reader *reader, tides_event_facts *facts)
    "tides_event_reader_facts": (None, [P(tides_event_reader), P(tides_event_facts)], "reader facts"),
    # tides_status tides_event_reader_open(const char *path, const char *format, tides_event_reader **reader,
    # tides_error *error)
    "tides_event_reader_open": (c_int32, [
        c_char_p, c_char_p, P(P(tides_event_reader)), P(tides_error)
    ], "path format reader error"),
    # tides_status tides_event_reader_open_as(const char *path, const tides_event_reading *reading, tides_event_reader
    # **reader, tides_error *error)
    "tides_event_reader_open_as": (c_int32, [
        c_char_p, P(tides_event_reading), P(P(tides_event_reader)), P(tides_error)
    ], "path reading reader error"),
    # tides_status tides_event_reader_read(tides_event_reader *reader, tides_event *events, size_t capacity, size_t
    # *got, tides_error *error)
    "tides_event_reader_read": (c_int32, [
        P(tides_event_reader), P(tides_event), c_size_t, P(c_size_t), P(tides_error)
    ], "reader events capacity got error"),
    # tides_status tides_event_reader_summary(tides_event_reader *reader, tides_event_summary *summary, tides_error
    # *error)
    "tides_event_reader_summary": (c_int32, [
        P(tides_event_reader), P(tides_event_summary), P(tides_error)
    ], "reader summary error"),
    # void tides_event_reading_defaults(tides_event_reading *reading)
    "tides_event_reading_defaults": (None, [P(tides_event_reading)], "reading"),
    # tides_status tides_event_stretch_check(const char *file, int64_t first_ns, int64_t end_ns, int64_t start_ns,
    # int64_t stop_ns, int32_t rebased, tides_error *error)
    "tides_event_stretch_check": (c_int32, [
        c_char_p, c_int64, c_int64, c_int64, c_int64, c_int32, P(tides_error)
    ], "file first_ns end_ns start_ns stop_ns rebased error"),
    # void tides_event_writer_abandon(tides_event_writer *writer)
    "tides_event_writer_abandon": (None, [P(tides_event_writer)], "writer"),
    # tides_status tides_event_writer_append(tides_event_writer *writer, const tides_event *events, const int64_t
    # *fired, size_t count, tides_error *error)
    "tides_event_writer_append": (c_int32, [
        P(tides_event_writer), P(tides_event), P(c_int64), c_size_t, P(tides_error)
    ], "writer events fired count error"),
    # int32_t tides_event_writer_can_resume(const char *path)
    "tides_event_writer_can_resume": (c_int32, [c_char_p], "path"),
    # uint64_t tides_event_writer_collapsed(const tides_event_writer *writer)
    "tides_event_writer_collapsed": (c_uint64, [P(tides_event_writer)], "writer"),
    # uint64_t tides_event_writer_count(const tides_event_writer *writer)
    "tides_event_writer_count": (c_uint64, [P(tides_event_writer)], "writer"),
    # tides_status tides_event_writer_finish(tides_event_writer *writer, int64_t stop_ns, tides_error *error)
    "tides_event_writer_finish": (c_int32, [P(tides_event_writer), c_int64, P(tides_error)], "writer stop_ns error"),
    # tides_status tides_event_writer_flush(tides_event_writer *writer, tides_error *error)
    "tides_event_writer_flush": (c_int32, [P(tides_event_writer), P(tides_error)], "writer error"),
    # tides_status tides_event_writer_open(const char *path, const char *format, const tides_event_file *file,
    # tides_event_writer **writer, tides_error *error)
    "tides_event_writer_open": (c_int32, [
        c_char_p, c_char_p, P(tides_event_file), P(P(tides_event_writer)), P(tides_error)
    ], "path format file writer error"),
    # tides_status tides_event_writer_resume(const char *path, const tides_event_file *file, uint64_t count,
    # tides_event_writer **writer, tides_error *error)
    "tides_event_writer_resume": (c_int32, [
        c_char_p, P(tides_event_file), c_uint64, P(P(tides_event_writer)), P(tides_error)
    ], "path file count writer error"),
    # tides_status tides_events_convert(const char *in, const char *out, const tides_event_conversion *conversion,
    # tides_progress progress, void *user, tides_event_conversion_report *report, tides_error *error)
    "tides_events_convert": (c_int32, [
        c_char_p, c_char_p, P(tides_event_conversion), tides_progress, c_void_p, P(tides_event_conversion_report),
        P(tides_error)
    ], "in out conversion progress user report error"),
    # tides_status tides_events_labels(const char *path, uint64_t first, size_t count, tides_event *events, int64_t
    # *fired, tides_error *error)
    "tides_events_labels": (c_int32, [
        c_char_p, c_uint64, c_size_t, P(tides_event), P(c_int64), P(tides_error)
    ], "path first count events fired error"),
    # tides_status tides_events_read(const char *path, uint64_t first, size_t count, tides_event *events, size_t *got,
    # tides_error *error)
    "tides_events_read": (c_int32, [
        c_char_p, c_uint64, c_size_t, P(tides_event), P(c_size_t), P(tides_error)
    ], "path first count events got error"),
    # tides_status tides_events_summary(const char *path, tides_event_summary *summary, tides_error *error)
    "tides_events_summary": (c_int32, [c_char_p, P(tides_event_summary), P(tides_error)], "path summary error"),
    # tides_status tides_events_truth(const char *path, uint64_t first, size_t count, tides_event_truth *truth,
    # tides_error *error)
    "tides_events_truth": (c_int32, [
        c_char_p, c_uint64, c_size_t, P(tides_event_truth), P(tides_error)
    ], "path first count truth error"),
    # void tides_exact_options_defaults(tides_exact_options *options)
    "tides_exact_options_defaults": (None, [P(tides_exact_options)], "options"),
    # tides_status tides_exact_stream(tides_device *device, const tides_scene *scene, const tides_trajectory *camera,
    # const tides_intrinsics *intrinsics, const tides_image_params *image, const tides_sensor *sensor, double start,
    # double stop, const tides_exact_options *options, tides_progress progress, void *user, tides_exact *exact,
    # tides_error *error)
    "tides_exact_stream": (c_int32, [
        P(tides_device), P(tides_scene), P(tides_trajectory), P(tides_intrinsics), P(tides_image_params),
        P(tides_sensor), c_double, c_double, P(tides_exact_options), tides_progress, c_void_p, P(tides_exact),
        P(tides_error)
    ], "device scene camera intrinsics image sensor start stop options progress user exact error"),
    # size_t tides_exposure_count(const tides_exposure *exposure, int32_t height, double start, double stop)
    "tides_exposure_count": (c_size_t, [P(tides_exposure), c_int32, c_double, c_double], "exposure height start stop"),
    # void tides_exposure_defaults(tides_exposure *exposure)
    "tides_exposure_defaults": (None, [P(tides_exposure)], "exposure"),
    # int32_t tides_exposure_planes(const tides_exposure *exposure)
    "tides_exposure_planes": (c_int32, [P(tides_exposure)], "exposure"),
    # void tides_exposure_row(const tides_exposure *exposure, int32_t height, double time, int32_t row, double *start,
    # double *stop)
    "tides_exposure_row": (None, [
        P(tides_exposure), c_int32, c_double, c_int32, P(c_double), P(c_double)
    ], "exposure height time row start stop"),
    # void tides_exposure_span(const tides_exposure *exposure, int32_t height, double time, double *start, double *stop)
    "tides_exposure_span": (None, [
        P(tides_exposure), c_int32, c_double, P(c_double), P(c_double)
    ], "exposure height time start stop"),
    # double tides_exposure_time(const tides_exposure *exposure, int32_t height, double start, size_t index)
    "tides_exposure_time": (c_double, [P(tides_exposure), c_int32, c_double, c_size_t], "exposure height start index"),
    # tides_status tides_exposure_values(const tides_exposure *exposure, int32_t width, int32_t height, size_t index,
    # const double *light, uint16_t *values, tides_error *error)
    "tides_exposure_values": (c_int32, [
        P(tides_exposure), c_int32, c_int32, c_size_t, P(c_double), P(c_uint16), P(tides_error)
    ], "exposure width height index light values error"),
    # void tides_exr_destroy(tides_exr *exr)
    "tides_exr_destroy": (None, [P(tides_exr)], "exr"),
    # const char *tides_exr_name(const tides_exr *exr, int32_t channel)
    "tides_exr_name": (c_char_p, [P(tides_exr), c_int32], "exr channel"),
    # const float *tides_exr_pixels(const tides_exr *exr, int32_t channel)
    "tides_exr_pixels": (P(c_float), [P(tides_exr), c_int32], "exr channel"),
    # tides_status tides_exr_read(const char *path, tides_exr **exr, tides_error *error)
    "tides_exr_read": (c_int32, [c_char_p, P(P(tides_exr)), P(tides_error)], "path exr error"),
    # void tides_exr_size(const tides_exr *exr, int32_t *width, int32_t *height, int32_t *channels)
    "tides_exr_size": (None, [P(tides_exr), P(c_int32), P(c_int32), P(c_int32)], "exr width height channels"),
    # tides_status tides_exr_write(const char *path, int32_t width, int32_t height, const tides_channel *channels,
    # int32_t count, int32_t compression, const char *const *attributes, tides_error *error)
    "tides_exr_write": (c_int32, [
        c_char_p, c_int32, c_int32, P(tides_channel), c_int32, c_int32, P(c_char_p), P(tides_error)
    ], "path width height channels count compression attributes error"),
    # tides_status tides_file_check(const char *path, int32_t streams, tides_error *error)
    "tides_file_check": (c_int32, [c_char_p, c_int32, P(tides_error)], "path streams error"),
    # tides_status tides_file_foreign(const char *path, tides_error *error)
    "tides_file_foreign": (c_int32, [c_char_p, P(tides_error)], "path error"),
    # tides_status tides_file_named(const char *path, const char *ending, tides_error *error)
    "tides_file_named": (c_int32, [c_char_p, c_char_p, P(tides_error)], "path ending error"),
    # tides_status tides_file_part(const char *path, char *part, size_t size, tides_error *error)
    "tides_file_part": (c_int32, [c_char_p, c_char_p, c_size_t, P(tides_error)], "path part size error"),
    # tides_status tides_file_write(const char *path, const void *bytes, size_t size, tides_error *error)
    "tides_file_write": (c_int32, [c_char_p, c_void_p, c_size_t, P(tides_error)], "path bytes size error"),
    # tides_status tides_files_apart(const char *const *inputs, size_t input_count, const char *const *outputs, size_t
    # output_count, tides_error *error)
    "tides_files_apart": (c_int32, [
        P(c_char_p), c_size_t, P(c_char_p), c_size_t, P(tides_error)
    ], "inputs input_count outputs output_count error"),
    # tides_status tides_filter_apply(tides_filter *filter, tides_event *events, int64_t *fired, size_t count, size_t
    # *kept, tides_error *error)
    "tides_filter_apply": (c_int32, [
        P(tides_filter), P(tides_event), P(c_int64), c_size_t, P(c_size_t), P(tides_error)
    ], "filter events fired count kept error"),
    # tides_status tides_filter_create(const tides_filters *filters, int32_t width, int32_t height, uint64_t seed,
    # tides_filter **filter, tides_error *error)
    "tides_filter_create": (c_int32, [
        P(tides_filters), c_int32, c_int32, c_uint64, P(P(tides_filter)), P(tides_error)
    ], "filters width height seed filter error"),
    # void tides_filter_destroy(tides_filter *filter)
    "tides_filter_destroy": (None, [P(tides_filter)], "filter"),
    # void tides_filter_stats_get(const tides_filter *filter, tides_filter_stats *stats)
    "tides_filter_stats_get": (None, [P(tides_filter), P(tides_filter_stats)], "filter stats"),
    # int32_t tides_filters_any(const tides_filters *filters)
    "tides_filters_any": (c_int32, [P(tides_filters)], "filters"),
    # void tides_filters_defaults(tides_filters *filters)
    "tides_filters_defaults": (None, [P(tides_filters)], "filters"),
    # uint64_t tides_fingerprint_text(const char *const *texts, size_t count)
    "tides_fingerprint_text": (c_uint64, [P(c_char_p), c_size_t], "texts count"),
    # tides_status tides_fingerprints_create(const char *except, tides_fingerprints **fingerprints, tides_error *error)
    "tides_fingerprints_create": (c_int32, [
        c_char_p, P(P(tides_fingerprints)), P(tides_error)
    ], "except fingerprints error"),
    # void tides_fingerprints_destroy(tides_fingerprints *fingerprints)
    "tides_fingerprints_destroy": (None, [P(tides_fingerprints)], "fingerprints"),
    # tides_status tides_fingerprints_file(tides_fingerprints *fingerprints, const char *path, tides_fingerprint
    # *fingerprint, tides_error *error)
    "tides_fingerprints_file": (c_int32, [
        P(tides_fingerprints), c_char_p, P(tides_fingerprint), P(tides_error)
    ], "fingerprints path fingerprint error"),
    # tides_status tides_fingerprints_run(tides_fingerprints *fingerprints, const tides_run *run, const char *with,
    # tides_fingerprint *fingerprint, tides_error *error)
    "tides_fingerprints_run": (c_int32, [
        P(tides_fingerprints), P(tides_run), c_char_p, P(tides_fingerprint), P(tides_error)
    ], "fingerprints run with fingerprint error"),
    # void tides_frames_close(tides_frames *frames)
    "tides_frames_close": (None, [P(tides_frames)], "frames"),
    # size_t tides_frames_count(const tides_frames *frames)
    "tides_frames_count": (c_size_t, [P(tides_frames)], "frames"),
    # tides_status tides_frames_from_memory(const double *Y, const double *times, size_t count, int32_t width, int32_t
    # height, tides_frames **frames, tides_error *error)
    "tides_frames_from_memory": (c_int32, [
        P(c_double), P(c_double), c_size_t, c_int32, c_int32, P(P(tides_frames)), P(tides_error)
    ], "Y times count width height frames error"),
    # const char *tides_frames_note(const tides_frames *frames)
    "tides_frames_note": (c_char_p, [P(tides_frames)], "frames"),
    # tides_status tides_frames_open(const char *path, const tides_frames_options *options, tides_frames **frames,
    # tides_error *error)
    "tides_frames_open": (c_int32, [
        c_char_p, P(tides_frames_options), P(P(tides_frames)), P(tides_error)
    ], "path options frames error"),
    # void tides_frames_options_defaults(tides_frames_options *options)
    "tides_frames_options_defaults": (None, [P(tides_frames_options)], "options"),
    # int32_t tides_frames_planes(const tides_frames *frames)
    "tides_frames_planes": (c_int32, [P(tides_frames)], "frames"),
    # tides_status tides_frames_read(tides_frames *frames, size_t index, double *Y, tides_error *error)
    "tides_frames_read": (c_int32, [P(tides_frames), c_size_t, P(c_double), P(tides_error)], "frames index Y error"),
    # void tides_frames_size(const tides_frames *frames, int32_t *width, int32_t *height)
    "tides_frames_size": (None, [P(tides_frames), P(c_int32), P(c_int32)], "frames width height"),
    # double tides_frames_time(const tides_frames *frames, size_t index)
    "tides_frames_time": (c_double, [P(tides_frames), c_size_t], "frames index"),
    # void tides_free(void *memory)
    "tides_free": (None, [c_void_p], "memory"),
    # tides_status tides_generate(const char *kind, const tides_generate_options *options, tides_world *world,
    # tides_error *error)
    "tides_generate": (c_int32, [
        c_char_p, P(tides_generate_options), P(tides_world), P(tides_error)
    ], "kind options world error"),
    # void tides_generate_options_defaults(tides_generate_options *options)
    "tides_generate_options_defaults": (None, [P(tides_generate_options)], "options"),
    # const tides_generator *tides_generators(size_t *count)
    "tides_generators": (P(tides_generator), [P(c_size_t)], "count"),
    # tides_status tides_ideal_settings(const tides_run *run, const char *method, int32_t what, const char ***texts,
    # size_t *count, tides_error *error)
    "tides_ideal_settings": (c_int32, [
        P(tides_run), c_char_p, c_int32, P(P(c_char_p)), P(c_size_t), P(tides_error)
    ], "run method what texts count error"),
    # int32_t tides_image_is_continuous(const tides_image_params *image)
    "tides_image_is_continuous": (c_int32, [P(tides_image_params)], "image"),
    # void tides_image_params_defaults(tides_image_params *params)
    "tides_image_params_defaults": (None, [P(tides_image_params)], "params"),
    # size_t tides_imu_count(const tides_imu *imu, double start, double stop)
    "tides_imu_count": (c_size_t, [P(tides_imu), c_double, c_double], "imu start stop"),
    # void tides_imu_defaults(tides_imu *imu)
    "tides_imu_defaults": (None, [P(tides_imu)], "imu"),
    # tides_status tides_ldati(const double *voxels, int32_t width, int32_t height, double start, double stop, uint64_t
    # seed, uint64_t frame, tides_event_sink sink, void *user, tides_error *error)
    "tides_ldati": (c_int32, [
        P(c_double), c_int32, c_int32, c_double, c_double, c_uint64, c_uint64, tides_event_sink, c_void_p,
        P(tides_error)
    ], "voxels width height start stop seed frame sink user error"),
    # const char *tides_lens_name(int32_t model)
    "tides_lens_name": (c_char_p, [c_int32], "model"),
    # void tides_live_close(tides_live *live)
    "tides_live_close": (None, [P(tides_live)], "live"),
    # tides_status tides_live_finish(tides_live *live, const tides_event **events, size_t *count, tides_error *error)
    "tides_live_finish": (c_int32, [
        P(tides_live), P(P(tides_event)), P(c_size_t), P(tides_error)
    ], "live events count error"),
    # tides_status tides_live_open(tides_session *session, const tides_live_options *options, tides_progress progress,
    # void *user, tides_live **live, tides_error *error)
    "tides_live_open": (c_int32, [
        P(tides_session), P(tides_live_options), tides_progress, c_void_p, P(P(tides_live)), P(tides_error)
    ], "session options progress user live error"),
    # void tides_live_options_defaults(tides_live_options *options)
    "tides_live_options_defaults": (None, [P(tides_live_options)], "options"),
    # const tides_trajectory *tides_live_path(const tides_live *live, int32_t object)
    "tides_live_path": (P(tides_trajectory), [P(tides_live), c_int32], "live object"),
    # double tides_live_reached(const tides_live *live)
    "tides_live_reached": (c_double, [P(tides_live)], "live"),
    # tides_status tides_live_run(tides_live *live, double until, const tides_event **events, size_t *count, tides_error
    # *error)
    "tides_live_run": (c_int32, [
        P(tides_live), c_double, P(P(tides_event)), P(c_size_t), P(tides_error)
    ], "live until events count error"),
    # tides_simulator *tides_live_simulator(const tides_live *live)
    "tides_live_simulator": (P(tides_simulator), [P(tides_live)], "live"),
    # tides_status tides_live_step(tides_live *live, const int32_t *objects, const tides_pose_sample *samples, size_t
    # poses, double until, const tides_event **events, size_t *count, tides_error *error)
    "tides_live_step": (c_int32, [
        P(tides_live), P(c_int32), P(tides_pose_sample), c_size_t, c_double, P(P(tides_event)), P(c_size_t),
        P(tides_error)
    ], "live objects samples poses until events count error"),
    # tides_status tides_live_tell(tides_live *live, int32_t object, const tides_pose_sample *samples, size_t count,
    # tides_error *error)
    "tides_live_tell": (c_int32, [
        P(tides_live), c_int32, P(tides_pose_sample), c_size_t, P(tides_error)
    ], "live object samples count error"),
    # tides_status tides_match_events(const tides_event *reference, size_t reference_count, const tides_event
    # *simulated, size_t simulated_count, double limit_s, tides_match *match, tides_error *error)
    "tides_match_events": (c_int32, [
        P(tides_event), c_size_t, P(tides_event), c_size_t, c_double, P(tides_match), P(tides_error)
    ], "reference reference_count simulated simulated_count limit_s match error"),
    # tides_status tides_metrics_compare(const tides_event *reference, size_t reference_count, const tides_event
    # *simulated, size_t simulated_count, const tides_metrics_options *options, tides_progress progress, void *user,
    # tides_metrics *metrics, tides_error *error)
    "tides_metrics_compare": (c_int32, [
        P(tides_event), c_size_t, P(tides_event), c_size_t, P(tides_metrics_options), tides_progress, c_void_p,
        P(tides_metrics), P(tides_error)
    ], "reference reference_count simulated simulated_count options progress user metrics error"),
    # void tides_metrics_options_defaults(tides_metrics_options *options)
    "tides_metrics_options_defaults": (None, [P(tides_metrics_options)], "options"),
    # const tides_metric *tides_metrics_table(size_t *count)
    "tides_metrics_table": (P(tides_metric), [P(c_size_t)], "count"),
    # tides_status tides_motion_create_callback(const tides_callback_motion *callback, tides_motion **motion,
    # tides_error *error)
    "tides_motion_create_callback": (c_int32, [
        P(tides_callback_motion), P(P(tides_motion)), P(tides_error)
    ], "callback motion error"),
    # tides_status tides_motion_create_keyframes(const tides_keyframes_motion *arrays, tides_motion **motion,
    # tides_error *error)
    "tides_motion_create_keyframes": (c_int32, [
        P(tides_keyframes_motion), P(P(tides_motion)), P(tides_error)
    ], "arrays motion error"),
    # tides_status tides_motion_create_polynomial(const tides_polynomial_motion *arrays, tides_motion **motion,
    # tides_error *error)
    "tides_motion_create_polynomial": (c_int32, [
        P(tides_polynomial_motion), P(P(tides_motion)), P(tides_error)
    ], "arrays motion error"),
    # tides_status tides_motion_create_rotor(const tides_rotor_motion *arrays, tides_motion **motion, tides_error
    # *error)
    "tides_motion_create_rotor": (c_int32, [
        P(tides_rotor_motion), P(P(tides_motion)), P(tides_error)
    ], "arrays motion error"),
    # void tides_motion_destroy(tides_motion *motion)
    "tides_motion_destroy": (None, [P(tides_motion)], "motion"),
    # uint64_t tides_motion_knots(const tides_motion *motion)
    "tides_motion_knots": (c_uint64, [P(tides_motion)], "motion"),
    # const char *tides_motion_model(const tides_motion *motion)
    "tides_motion_model": (c_char_p, [P(tides_motion)], "motion"),
    # int64_t tides_motion_moving(const tides_motion *motion, const tides_gaussians *gaussians)
    "tides_motion_moving": (c_int64, [P(tides_motion), P(tides_gaussians)], "motion gaussians"),
    # void tides_motion_range(const tides_motion *motion, double *start, double *stop)
    "tides_motion_range": (None, [P(tides_motion), P(c_double), P(c_double)], "motion start stop"),
    # const char *tides_nearest_name(const char *name, const char *const *names)
    "tides_nearest_name": (c_char_p, [c_char_p, P(c_char_p)], "name names"),
    # void tides_page_options_defaults(tides_page_options *options)
    "tides_page_options_defaults": (None, [P(tides_page_options)], "options"),
    # tides_status tides_page_write(const char *path, const tides_event *events, const tides_event_truth *truth, size_t
    # count, const tides_page_options *options, tides_page_report *report, tides_error *error)
    "tides_page_write": (c_int32, [
        c_char_p, P(tides_event), P(tides_event_truth), c_size_t, P(tides_page_options), P(tides_page_report),
        P(tides_error)
    ], "path events truth count options report error"),
    # tides_status tides_page_write_file(const char *events, const char *path, const tides_page_options *options,
    # tides_progress progress, void *user, tides_page_report *report, tides_error *error)
    "tides_page_write_file": (c_int32, [
        c_char_p, c_char_p, P(tides_page_options), tides_progress, c_void_p, P(tides_page_report), P(tides_error)
    ], "events path options progress user report error"),
    # int32_t tides_param_is_path(const char *key)
    "tides_param_is_path": (c_int32, [c_char_p], "key"),
    # const tides_param *tides_params(size_t *count)
    "tides_params": (P(tides_param), [P(c_size_t)], "count"),
    # tides_status tides_path_load(const char *file, const tides_path_options *options, tides_path *path, tides_error
    # *error)
    "tides_path_load": (c_int32, [
        c_char_p, P(tides_path_options), P(tides_path), P(tides_error)
    ], "file options path error"),
    # void tides_path_options_defaults(tides_path_options *options)
    "tides_path_options_defaults": (None, [P(tides_path_options)], "options"),
    # tides_status tides_path_save(const char *file, const tides_trajectory *trajectory, const tides_intrinsics
    # *intrinsics, tides_error *error)
    "tides_path_save": (c_int32, [
        c_char_p, P(tides_trajectory), P(tides_intrinsics), P(tides_error)
    ], "file trajectory intrinsics error"),
    # void tides_picture_depth(const double *depth, int32_t width, int32_t height, double near, double far, uint8_t
    # *rgb)
    "tides_picture_depth": (None, [
        P(c_double), c_int32, c_int32, c_double, c_double, P(c_uint8)
    ], "depth width height near far rgb"),
    # void tides_picture_depth_key(uint8_t *rgb, int32_t width, int32_t height)
    "tides_picture_depth_key": (None, [P(c_uint8), c_int32, c_int32], "rgb width height"),
    # void tides_picture_events(const tides_event *events, size_t count, const double *base, int32_t width, int32_t
    # height, uint8_t *rgb)
    "tides_picture_events": (None, [
        P(tides_event), c_size_t, P(c_double), c_int32, c_int32, P(c_uint8)
    ], "events count base width height rgb"),
    # void tides_picture_flow(const double *u, const double *v, int32_t width, int32_t height, double limit, uint8_t
    # *rgb)
    "tides_picture_flow": (None, [
        P(c_double), P(c_double), c_int32, c_int32, c_double, P(c_uint8)
    ], "u v width height limit rgb"),
    # void tides_picture_flow_key(uint8_t *rgb, int32_t width, int32_t height)
    "tides_picture_flow_key": (None, [P(c_uint8), c_int32, c_int32], "rgb width height"),
    # void tides_picture_grey(const double *values, int32_t width, int32_t height, double white, uint8_t *rgb)
    "tides_picture_grey": (None, [
        P(c_double), c_int32, c_int32, c_double, P(c_uint8)
    ], "values width height white rgb"),
    # void tides_picture_labels(const double *labels, int32_t width, int32_t height, uint8_t *rgb)
    "tides_picture_labels": (None, [P(c_double), c_int32, c_int32, P(c_uint8)], "labels width height rgb"),
    # void tides_picture_rgb(const double *r, const double *g, const double *b, int32_t width, int32_t height, uint8_t
    # *rgb)
    "tides_picture_rgb": (None, [
        P(c_double), P(c_double), P(c_double), c_int32, c_int32, P(c_uint8)
    ], "r g b width height rgb"),
    # void tides_picture_signed(const double *values, int32_t width, int32_t height, double limit, uint8_t *rgb)
    "tides_picture_signed": (None, [
        P(c_double), c_int32, c_int32, c_double, P(c_uint8)
    ], "values width height limit rgb"),
    # void tides_picture_text(uint8_t *rgb, int32_t width, int32_t height, int32_t x, int32_t y, int32_t scale, const
    # uint8_t colour[3], const char *text)
    "tides_picture_text": (None, [
        P(c_uint8), c_int32, c_int32, c_int32, c_int32, c_int32, P(c_uint8), c_char_p
    ], "rgb width height x y scale colour text"),
    # tides_status tides_png_write(const char *path, int32_t width, int32_t height, const uint8_t *rgb, tides_error
    # *error)
    "tides_png_write": (c_int32, [
        c_char_p, c_int32, c_int32, P(c_uint8), P(tides_error)
    ], "path width height rgb error"),
    # tides_status tides_png_write_values(const char *path, int32_t width, int32_t height, int32_t planes, int32_t bits,
    # const uint16_t *values, tides_error *error)
    "tides_png_write_values": (c_int32, [
        c_char_p, c_int32, c_int32, c_int32, c_int32, P(c_uint16), P(tides_error)
    ], "path width height planes bits values error"),
    # int32_t tides_preset_at(size_t index, char name[TIDES_PRESET_NAME])
    "tides_preset_at": (c_int32, [c_size_t, c_char_p], "index name"),
    # tides_status tides_preset_read(const char *name, char **text, tides_error *error)
    "tides_preset_read": (c_int32, [c_char_p, P(c_char_p), P(tides_error)], "name text error"),
    # void tides_readout_defaults(tides_readout *readout)
    "tides_readout_defaults": (None, [P(tides_readout)], "readout"),
    # void tides_recording_defaults(tides_recording *recording)
    "tides_recording_defaults": (None, [P(tides_recording)], "recording"),
    # tides_status tides_rectify_map(const tides_intrinsics *raw, const tides_intrinsics *rectified, const double
    # rotation[9], float *map, tides_error *error)
    "tides_rectify_map": (c_int32, [
        P(tides_intrinsics), P(tides_intrinsics), P(c_double), P(c_float), P(tides_error)
    ], "raw rectified rotation map error"),
    # tides_status tides_rectify_save(const char *file, const tides_intrinsics *raw, const tides_intrinsics *rectified,
    # const double rotation[9], tides_error *error)
    "tides_rectify_save": (c_int32, [
        c_char_p, P(tides_intrinsics), P(tides_intrinsics), P(c_double), P(tides_error)
    ], "file raw rectified rotation error"),
    # tides_status tides_renderer_choose(tides_renderer *renderer, const tides_trajectory *camera, double time, uint64_t
    # seed, uint32_t number, size_t count, double *xy, tides_material_point *points, size_t *chosen, tides_error *error)
    "tides_renderer_choose": (c_int32, [
        P(tides_renderer), P(tides_trajectory), c_double, c_uint64, c_uint32, c_size_t, P(c_double),
        P(tides_material_point), P(c_size_t), P(tides_error)
    ], "renderer camera time seed number count xy points chosen error"),
    # tides_status tides_renderer_create(tides_device *device, const tides_scene *scene, const tides_intrinsics
    # *intrinsics, const tides_image_params *params, tides_progress progress, void *user, tides_renderer **renderer,
    # tides_error *error)
    "tides_renderer_create": (c_int32, [
        P(tides_device), P(tides_scene), P(tides_intrinsics), P(tides_image_params), tides_progress, c_void_p,
        P(P(tides_renderer)), P(tides_error)
    ], "device scene intrinsics params progress user renderer error"),
    # void tides_renderer_destroy(tides_renderer *renderer)
    "tides_renderer_destroy": (None, [P(tides_renderer)], "renderer"),
    # tides_status tides_renderer_displacement(tides_renderer *renderer, const tides_trajectory *camera, double from,
    # double to, double *u, double *v, double *visible, tides_error *error)
    "tides_renderer_displacement": (c_int32, [
        P(tides_renderer), P(tides_trajectory), c_double, c_double, P(c_double), P(c_double), P(c_double),
        P(tides_error)
    ], "renderer camera from to u v visible error"),
    # tides_status tides_renderer_event_truth(tides_renderer *renderer, const tides_trajectory *camera, const
    # tides_event *events, const int64_t *fired, size_t count, tides_event_truth *truth, tides_error *error)
    "tides_renderer_event_truth": (c_int32, [
        P(tides_renderer), P(tides_trajectory), P(tides_event), P(c_int64), c_size_t, P(tides_event_truth),
        P(tides_error)
    ], "renderer camera events fired count truth error"),
    # tides_status tides_renderer_expose(tides_renderer *renderer, const tides_trajectory *camera, double time, const
    # tides_exposure *exposure, double *light, tides_exposed *done, tides_error *error)
    "tides_renderer_expose": (c_int32, [
        P(tides_renderer), P(tides_trajectory), c_double, P(tides_exposure), P(c_double), P(tides_exposed),
        P(tides_error)
    ], "renderer camera time exposure light done error"),
    # tides_status tides_renderer_follow(tides_renderer *renderer, const tides_trajectory *camera, double time, const
    # tides_material_point *points, size_t count, tides_track *tracks, tides_error *error)
    "tides_renderer_follow": (c_int32, [
        P(tides_renderer), P(tides_trajectory), c_double, P(tides_material_point), c_size_t, P(tides_track),
        P(tides_error)
    ], "renderer camera time points count tracks error"),
    # tides_status tides_renderer_frame(tides_renderer *renderer, const tides_trajectory *camera, double time, const
    # tides_frame *frame, tides_error *error)
    "tides_renderer_frame": (c_int32, [
        P(tides_renderer), P(tides_trajectory), c_double, P(tides_frame), P(tides_error)
    ], "renderer camera time frame error"),
    # tides_status tides_renderer_pick(tides_renderer *renderer, const tides_trajectory *camera, double time, const
    # double *xy, size_t count, tides_material_point *points, tides_error *error)
    "tides_renderer_pick": (c_int32, [
        P(tides_renderer), P(tides_trajectory), c_double, P(c_double), c_size_t, P(tides_material_point),
        P(tides_error)
    ], "renderer camera time xy count points error"),
    # tides_status tides_renderer_set_progress(tides_renderer *renderer, tides_progress progress, void *user,
    # tides_error *error)
    "tides_renderer_set_progress": (c_int32, [
        P(tides_renderer), tides_progress, c_void_p, P(tides_error)
    ], "renderer progress user error"),
    # tides_status tides_renderer_set_psf(tides_renderer *renderer, double sigma_px, int32_t domain, tides_error *error)
    "tides_renderer_set_psf": (c_int32, [
        P(tides_renderer), c_double, c_int32, P(tides_error)
    ], "renderer sigma_px domain error"),
    # void tides_renderer_stats(const tides_renderer *renderer, tides_render_stats *stats)
    "tides_renderer_stats": (None, [P(tides_renderer), P(tides_render_stats)], "renderer stats"),
    # tides_status tides_renderer_truth(tides_renderer *renderer, const tides_trajectory *camera, double time, const
    # tides_truth *truth, tides_error *error)
    "tides_renderer_truth": (c_int32, [
        P(tides_renderer), P(tides_trajectory), c_double, P(tides_truth), P(tides_error)
    ], "renderer camera time truth error"),
    # tides_status tides_run_apart(const tides_run *run, const char *const *outputs, size_t count, tides_error *error)
    "tides_run_apart": (c_int32, [P(tides_run), P(c_char_p), c_size_t, P(tides_error)], "run outputs count error"),
    # void tides_run_destroy(tides_run *run)
    "tides_run_destroy": (None, [P(tides_run)], "run"),
    # void tides_run_get(const tides_run *run, tides_run_values *values)
    "tides_run_get": (None, [P(tides_run), P(tides_run_values)], "run values"),
    # int32_t tides_run_gives(const tides_run *run, const char *key)
    "tides_run_gives": (c_int32, [P(tides_run), c_char_p], "run key"),
    # tides_status tides_run_inputs(const tides_run *run, tides_run_input **inputs, size_t *count, tides_error *error)
    "tides_run_inputs": (c_int32, [
        P(tides_run), P(P(tides_run_input)), P(c_size_t), P(tides_error)
    ], "run inputs count error"),
    # tides_status tides_run_load(const char *file, const char *const *overrides, size_t count, tides_run **run,
    # tides_error *error)
    "tides_run_load": (c_int32, [
        c_char_p, P(c_char_p), c_size_t, P(P(tides_run)), P(tides_error)
    ], "file overrides count run error"),
    # const char *tides_run_notes(const tides_run *run)
    "tides_run_notes": (c_char_p, [P(tides_run)], "run"),
    # tides_status tides_run_open(const tides_run *run, tides_scene **scene, tides_trajectory **camera, tides_intrinsics
    # *intrinsics, tides_error *error)
    "tides_run_open": (c_int32, [
        P(tides_run), P(P(tides_scene)), P(P(tides_trajectory)), P(tides_intrinsics), P(tides_error)
    ], "run scene camera intrinsics error"),
    # tides_status tides_run_open_frames(const tides_run *run, tides_frames **frames, tides_error *error)
    "tides_run_open_frames": (c_int32, [P(tides_run), P(P(tides_frames)), P(tides_error)], "run frames error"),
    # tides_status tides_run_parse(const char *text, const char *directory, const char *const *overrides, size_t count,
    # tides_run **run, tides_error *error)
    "tides_run_parse": (c_int32, [
        c_char_p, c_char_p, P(c_char_p), c_size_t, P(P(tides_run)), P(tides_error)
    ], "text directory overrides count run error"),
    # int32_t tides_run_rig_camera(const tides_run *run, size_t index, tides_rig_camera *camera)
    "tides_run_rig_camera": (c_int32, [P(tides_run), c_size_t, P(tides_rig_camera)], "run index camera"),
    # tides_status tides_run_template(const char *scene_file, const char *camera_file, char **text, tides_error *error)
    "tides_run_template": (c_int32, [
        c_char_p, c_char_p, P(c_char_p), P(tides_error)
    ], "scene_file camera_file text error"),
    # tides_status tides_run_vary(const tides_run *base, const char *const *overrides, size_t count, tides_run **run,
    # tides_error *error)
    "tides_run_vary": (c_int32, [
        P(tides_run), P(c_char_p), c_size_t, P(P(tides_run)), P(tides_error)
    ], "base overrides count run error"),
    # tides_status tides_scene_add(tides_scene *scene, const tides_gaussians *gaussians, const tides_trajectory
    # *trajectory, double scale, const char *name, int32_t *index, tides_error *error)
    "tides_scene_add": (c_int32, [
        P(tides_scene), P(tides_gaussians), P(tides_trajectory), c_double, c_char_p, P(c_int32), P(tides_error)
    ], "scene gaussians trajectory scale name index error"),
    # tides_status tides_scene_add_file(tides_scene *scene, const char *file, const tides_trajectory *trajectory, double
    # scale, tides_error *error)
    "tides_scene_add_file": (c_int32, [
        P(tides_scene), c_char_p, P(tides_trajectory), c_double, P(tides_error)
    ], "scene file trajectory scale error"),
    # tides_status tides_scene_add_moving(tides_scene *scene, const tides_gaussians *gaussians, tides_motion *motion,
    # double duration_s, const tides_trajectory *trajectory, double scale, const char *name, int32_t *index, tides_error
    # *error)
    "tides_scene_add_moving": (c_int32, [
        P(tides_scene), P(tides_gaussians), P(tides_motion), c_double, P(tides_trajectory), c_double, c_char_p,
        P(c_int32), P(tides_error)
    ], "scene gaussians motion duration_s trajectory scale name index error"),
    # tides_status tides_scene_append(tides_scene *scene, int32_t index, const tides_pose_sample *samples, size_t count,
    # tides_error *error)
    "tides_scene_append": (c_int32, [
        P(tides_scene), c_int32, P(tides_pose_sample), c_size_t, P(tides_error)
    ], "scene index samples count error"),
    # void tides_scene_bounds(const tides_scene *scene, double lower[3], double upper[3])
    "tides_scene_bounds": (None, [P(tides_scene), P(c_double), P(c_double)], "scene lower upper"),
    # tides_status tides_scene_bounds_at(const tides_scene *scene, double time, double lower[3], double upper[3],
    # tides_error *error)
    "tides_scene_bounds_at": (c_int32, [
        P(tides_scene), c_double, P(c_double), P(c_double), P(tides_error)
    ], "scene time lower upper error"),
    # int64_t tides_scene_count(const tides_scene *scene)
    "tides_scene_count": (c_int64, [P(tides_scene)], "scene"),
    # tides_status tides_scene_create(tides_scene **scene, tides_error *error)
    "tides_scene_create": (c_int32, [P(P(tides_scene)), P(tides_error)], "scene error"),
    # void tides_scene_destroy(tides_scene *scene)
    "tides_scene_destroy": (None, [P(tides_scene)], "scene"),
    # int64_t tides_scene_dropped(const tides_scene *scene)
    "tides_scene_dropped": (c_int64, [P(tides_scene)], "scene"),
    # int32_t tides_scene_format_at(size_t index, tides_scene_format *format)
    "tides_scene_format_at": (c_int32, [c_size_t, P(tides_scene_format)], "index format"),
    # tides_status tides_scene_gaussians_at(const tides_scene *scene, int32_t index, double time, const tides_theta
    # *theta, tides_error *error)
    "tides_scene_gaussians_at": (c_int32, [
        P(tides_scene), c_int32, c_double, P(tides_theta), P(tides_error)
    ], "scene index time theta error"),
    # int32_t tides_scene_is_file(const char *file)
    "tides_scene_is_file": (c_int32, [c_char_p], "file"),
    # int32_t tides_scene_losses(const tides_scene *scene, const char *file)
    "tides_scene_losses": (c_int32, [P(tides_scene), c_char_p], "scene file"),
    # const char *tides_scene_notes(const tides_scene *scene)
    "tides_scene_notes": (c_char_p, [P(tides_scene)], "scene"),
    # tides_status tides_scene_object(const tides_scene *scene, int32_t index, tides_object *object, tides_error *error)
    "tides_scene_object": (c_int32, [
        P(tides_scene), c_int32, P(tides_object), P(tides_error)
    ], "scene index object error"),
    # int32_t tides_scene_objects(const tides_scene *scene)
    "tides_scene_objects": (c_int32, [P(tides_scene)], "scene"),
    # void tides_scene_options_defaults(tides_scene_options *options)
    "tides_scene_options_defaults": (None, [P(tides_scene_options)], "options"),
    # tides_status tides_scene_orbit(const tides_scene *scene, const double up[3], double field_of_view, tides_orbit
    # *orbit, tides_error *error)
    "tides_scene_orbit": (c_int32, [
        P(tides_scene), P(c_double), c_double, P(tides_orbit), P(tides_error)
    ], "scene up field_of_view orbit error"),
    # void tides_scene_range(const tides_scene *scene, double *start, double *stop)
    "tides_scene_range": (None, [P(tides_scene), P(c_double), P(c_double)], "scene start stop"),
    # tides_status tides_scene_read(tides_scene *scene, const char *file, const tides_scene_options *options, const
    # tides_trajectory *trajectory, double scale, tides_error *error)
    "tides_scene_read": (c_int32, [
        P(tides_scene), c_char_p, P(tides_scene_options), P(tides_trajectory), c_double, P(tides_error)
    ], "scene file options trajectory scale error"),
    # tides_status tides_scene_save(const tides_scene *scene, const char *file, tides_error *error)
    "tides_scene_save": (c_int32, [P(tides_scene), c_char_p, P(tides_error)], "scene file error"),
    # int32_t tides_scene_set_duration(tides_scene *scene, double duration_s)
    "tides_scene_set_duration": (c_int32, [P(tides_scene), c_double], "scene duration_s"),
    # tides_status tides_scene_set_up(tides_scene *scene, const double up[3], tides_error *error)
    "tides_scene_set_up": (c_int32, [P(tides_scene), P(c_double), P(tides_error)], "scene up error"),
    # int32_t tides_scene_sh_degree(const tides_scene *scene)
    "tides_scene_sh_degree": (c_int32, [P(tides_scene)], "scene"),
    # int32_t tides_scene_trained(const tides_scene *scene)
    "tides_scene_trained": (c_int32, [P(tides_scene)], "scene"),
    # tides_status tides_scene_transfer(const tides_scene *scene, int32_t *transfer, double *gamma, tides_error *error)
    "tides_scene_transfer": (c_int32, [
        P(tides_scene), P(c_int32), P(c_double), P(tides_error)
    ], "scene transfer gamma error"),
    # int32_t tides_scene_up(const tides_scene *scene, double up[3])
    "tides_scene_up": (c_int32, [P(tides_scene), P(c_double)], "scene up"),
    # void tides_sensor_defaults(tides_sensor *sensor)
    "tides_sensor_defaults": (None, [P(tides_sensor)], "sensor"),
    # void tides_session_close(tides_session *session)
    "tides_session_close": (None, [P(tides_session)], "session"),
    # tides_status tides_session_exact(tides_session *session, const tides_exact_options *options, tides_progress
    # progress, void *user, tides_exact *exact, tides_error *error)
    "tides_session_exact": (c_int32, [
        P(tides_session), P(tides_exact_options), tides_progress, c_void_p, P(tides_exact), P(tides_error)
    ], "session options progress user exact error"),
    # tides_status tides_session_frames(tides_session *session, const char *path, tides_progress progress, void *user,
    # tides_session_taken *done, tides_error *error)
    "tides_session_frames": (c_int32, [
        P(tides_session), c_char_p, tides_progress, c_void_p, P(tides_session_taken), P(tides_error)
    ], "session path progress user done error"),
    # void tides_session_get(const tides_session *session, tides_session_facts *facts)
    "tides_session_get": (None, [P(tides_session), P(tides_session_facts)], "session facts"),
    # tides_status tides_session_imu(tides_session *session, const char *path, tides_session_taken *done, tides_error
    # *error)
    "tides_session_imu": (c_int32, [
        P(tides_session), c_char_p, P(tides_session_taken), P(tides_error)
    ], "session path done error"),
    # tides_status tides_session_load(const char *file, const char *const *overrides, size_t count, const char *device,
    # tides_session **session, tides_error *error)
    "tides_session_load": (c_int32, [
        c_char_p, P(c_char_p), c_size_t, c_char_p, P(P(tides_session)), P(tides_error)
    ], "file overrides count device session error"),
    # tides_status tides_session_maps(tides_session *session, const char *path, tides_error *error)
    "tides_session_maps": (c_int32, [P(tides_session), c_char_p, P(tides_error)], "session path error"),
    # const char *tides_session_notes(const tides_session *session)
    "tides_session_notes": (c_char_p, [P(tides_session)], "session"),
    # tides_status tides_session_open(const tides_run *run, tides_device *device, tides_session **session, tides_error
    # *error)
    "tides_session_open": (c_int32, [
        P(tides_run), P(tides_device), P(P(tides_session)), P(tides_error)
    ], "run device session error"),
    # tides_status tides_session_renderer(tides_session *session, tides_progress progress, void *user, tides_renderer
    # **renderer, tides_error *error)
    "tides_session_renderer": (c_int32, [
        P(tides_session), tides_progress, c_void_p, P(P(tides_renderer)), P(tides_error)
    ], "session progress user renderer error"),
    # tides_status tides_session_run(tides_session *session, tides_event_sink sink, void *sink_user, tides_progress
    # progress, void *user, tides_stats *stats, tides_error *error)
    "tides_session_run": (c_int32, [
        P(tides_session), tides_event_sink, c_void_p, tides_progress, c_void_p, P(tides_stats), P(tides_error)
    ], "session sink sink_user progress user stats error"),
    # tides_status tides_session_silence(tides_session *session, const tides_stats *stats, char text[TIDES_SILENCE],
    # tides_error *error)
    "tides_session_silence": (c_int32, [
        P(tides_session), P(tides_stats), c_char_p, P(tides_error)
    ], "session stats text error"),
    # tides_status tides_session_simulator(tides_session *session, tides_progress progress, void *user, tides_simulator
    # **simulator, tides_error *error)
    "tides_session_simulator": (c_int32, [
        P(tides_session), tides_progress, c_void_p, P(P(tides_simulator)), P(tides_error)
    ], "session progress user simulator error"),
    # tides_status tides_session_tracks(tides_session *session, const char *path, tides_progress progress, void *user,
    # tides_session_taken *done, tides_error *error)
    "tides_session_tracks": (c_int32, [
        P(tides_session), c_char_p, tides_progress, c_void_p, P(tides_session_taken), P(tides_error)
    ], "session path progress user done error"),
    # tides_status tides_session_truth(tides_session *session, const char *path, tides_progress progress, void *user,
    # tides_error *error)
    "tides_session_truth": (c_int32, [
        P(tides_session), c_char_p, tides_progress, c_void_p, P(tides_error)
    ], "session path progress user error"),
    # tides_status tides_session_vary(const tides_session *base, const char *const *overrides, size_t count,
    # tides_session **session, tides_error *error)
    "tides_session_vary": (c_int32, [
        P(tides_session), P(c_char_p), c_size_t, P(P(tides_session)), P(tides_error)
    ], "base overrides count session error"),
    # tides_status tides_session_write(tides_session *session, const char *path, const tides_recording *how,
    # tides_progress progress, void *user, tides_recorded *done, tides_stats *stats, tides_error *error)
    "tides_session_write": (c_int32, [
        P(tides_session), c_char_p, P(tides_recording), tides_progress, c_void_p, P(tides_recorded), P(tides_stats),
        P(tides_error)
    ], "session path how progress user done stats error"),
    # tides_status tides_simulator_create( tides_device *device, const tides_scene *scene, const tides_trajectory
    # *camera, const tides_intrinsics *intrinsics, const tides_image_params *image, const tides_sensor *sensor, const
    # tides_stepping *stepping, double start, double stop, tides_progress progress, void *user, tides_simulator
    # **simulator, tides_error *error)
    "tides_simulator_create": (c_int32, [
        P(tides_device), P(tides_scene), P(tides_trajectory), P(tides_intrinsics), P(tides_image_params),
        P(tides_sensor), P(tides_stepping), c_double, c_double, tides_progress, c_void_p, P(P(tides_simulator)),
        P(tides_error)
    ], "device scene camera intrinsics image sensor stepping start stop progress user simulator error"),
    # void tides_simulator_destroy(tides_simulator *simulator)
    "tides_simulator_destroy": (None, [P(tides_simulator)], "simulator"),
    # tides_status tides_simulator_filters(tides_simulator *simulator, const tides_filters *filters, tides_error *error)
    "tides_simulator_filters": (c_int32, [
        P(tides_simulator), P(tides_filters), P(tides_error)
    ], "simulator filters error"),
    # const int64_t *tides_simulator_fired(const tides_simulator *simulator)
    "tides_simulator_fired": (P(c_int64), [P(tides_simulator)], "simulator"),
    # tides_status tides_simulator_readout(tides_simulator *simulator, const tides_readout *readout, tides_error *error)
    "tides_simulator_readout": (c_int32, [
        P(tides_simulator), P(tides_readout), P(tides_error)
    ], "simulator readout error"),
    # tides_status tides_simulator_restore(tides_simulator *simulator, const char *run, const char *path, tides_error
    # *error)
    "tides_simulator_restore": (c_int32, [
        P(tides_simulator), c_char_p, c_char_p, P(tides_error)
    ], "simulator run path error"),
    # tides_status tides_simulator_run(tides_simulator *simulator, double until, tides_event_sink sink, void *sink_user,
    # tides_progress progress, void *user, tides_error *error)
    "tides_simulator_run": (c_int32, [
        P(tides_simulator), c_double, tides_event_sink, c_void_p, tides_progress, c_void_p, P(tides_error)
    ], "simulator until sink sink_user progress user error"),
    # tides_status tides_simulator_save(const tides_simulator *simulator, const char *run, const char *path, tides_error
    # *error)
    "tides_simulator_save": (c_int32, [
        P(tides_simulator), c_char_p, c_char_p, P(tides_error)
    ], "simulator run path error"),
    # void tides_simulator_state(const tides_simulator *simulator, double *signal, double *reference, uint32_t
    # *count_on, uint32_t *count_off)
    "tides_simulator_state": (None, [
        P(tides_simulator), P(c_double), P(c_double), P(c_uint32), P(c_uint32)
    ], "simulator signal reference count_on count_off"),
    # void tides_simulator_stats(const tides_simulator *simulator, tides_stats *stats)
    "tides_simulator_stats": (None, [P(tides_simulator), P(tides_stats)], "simulator stats"),
    # tides_status tides_simulator_write(tides_simulator *simulator, double stop, const char *path, const
    # tides_event_file *facts, const tides_recording *how, tides_progress progress, void *user, tides_recorded *done,
    # tides_error *error)
    "tides_simulator_write": (c_int32, [
        P(tides_simulator), c_double, c_char_p, P(tides_event_file), P(tides_recording), tides_progress, c_void_p,
        P(tides_recorded), P(tides_error)
    ], "simulator stop path facts how progress user done error"),
    # double tides_stat_value(const tides_stats *stats, const tides_stat *row)
    "tides_stat_value": (c_double, [P(tides_stats), P(tides_stat)], "stats row"),
    # const tides_stat *tides_stats_table(size_t *count)
    "tides_stats_table": (P(tides_stat), [P(c_size_t)], "count"),
    # const char *tides_status_name(tides_status status)
    "tides_status_name": (c_char_p, [c_int32], "status"),
    # const char *tides_status_text(tides_status status)
    "tides_status_text": (c_char_p, [c_int32], "status"),
    # void tides_stepping_defaults(tides_stepping *stepping)
    "tides_stepping_defaults": (None, [P(tides_stepping)], "stepping"),
    # tides_status tides_time_surface(const tides_event *events, size_t count, int32_t width, int32_t height, int64_t
    # time_ns, double decay_s, double *surface, tides_error *error)
    "tides_time_surface": (c_int32, [
        P(tides_event), c_size_t, c_int32, c_int32, c_int64, c_double, P(c_double), P(tides_error)
    ], "events count width height time_ns decay_s surface error"),
    # tides_status tides_trajectory_acceleration(const tides_trajectory *trajectory, double time, double
    # acceleration[3], tides_error *error)
    "tides_trajectory_acceleration": (c_int32, [
        P(tides_trajectory), c_double, P(c_double), P(tides_error)
    ], "trajectory time acceleration error"),
    # tides_status tides_trajectory_append(tides_trajectory *trajectory, const tides_pose_sample *samples, size_t count,
    # tides_error *error)
    "tides_trajectory_append": (c_int32, [
        P(tides_trajectory), P(tides_pose_sample), c_size_t, P(tides_error)
    ], "trajectory samples count error"),
    # tides_status tides_trajectory_at(const tides_trajectory *trajectory, double time, tides_pose *pose, tides_error
    # *error)
    "tides_trajectory_at": (c_int32, [
        P(tides_trajectory), c_double, P(tides_pose), P(tides_error)
    ], "trajectory time pose error"),
    # size_t tides_trajectory_count(const tides_trajectory *trajectory)
    "tides_trajectory_count": (c_size_t, [P(tides_trajectory)], "trajectory"),
    # tides_status tides_trajectory_create(const tides_pose_sample *samples, size_t count, tides_trajectory
    # **trajectory, tides_error *error)
    "tides_trajectory_create": (c_int32, [
        P(tides_pose_sample), c_size_t, P(P(tides_trajectory)), P(tides_error)
    ], "samples count trajectory error"),
    # tides_status tides_trajectory_create_dolly(const tides_dolly *dolly, tides_trajectory **trajectory, tides_error
    # *error)
    "tides_trajectory_create_dolly": (c_int32, [
        P(tides_dolly), P(P(tides_trajectory)), P(tides_error)
    ], "dolly trajectory error"),
    # tides_status tides_trajectory_create_handheld(const tides_handheld *handheld, tides_trajectory **trajectory,
    # tides_error *error)
    "tides_trajectory_create_handheld": (c_int32, [
        P(tides_handheld), P(P(tides_trajectory)), P(tides_error)
    ], "handheld trajectory error"),
    # tides_status tides_trajectory_create_mounted(const tides_trajectory *body, const double position[3], const double
    # quaternion[4], tides_trajectory **trajectory, tides_error *error)
    "tides_trajectory_create_mounted": (c_int32, [
        P(tides_trajectory), P(c_double), P(c_double), P(P(tides_trajectory)), P(tides_error)
    ], "body position quaternion trajectory error"),
    # tides_status tides_trajectory_create_open(const tides_pose_sample *samples, size_t count, tides_trajectory
    # **trajectory, tides_error *error)
    "tides_trajectory_create_open": (c_int32, [
        P(tides_pose_sample), c_size_t, P(P(tides_trajectory)), P(tides_error)
    ], "samples count trajectory error"),
    # tides_status tides_trajectory_create_orbit(const tides_orbit *orbit, tides_trajectory **trajectory, tides_error
    # *error)
    "tides_trajectory_create_orbit": (c_int32, [
        P(tides_orbit), P(P(tides_trajectory)), P(tides_error)
    ], "orbit trajectory error"),
    # tides_status tides_trajectory_create_static(const double position[3], const double quaternion[4], tides_trajectory
    # **trajectory, tides_error *error)
    "tides_trajectory_create_static": (c_int32, [
        P(c_double), P(c_double), P(P(tides_trajectory)), P(tides_error)
    ], "position quaternion trajectory error"),
    # void tides_trajectory_destroy(tides_trajectory *trajectory)
    "tides_trajectory_destroy": (None, [P(tides_trajectory)], "trajectory"),
    # void tides_trajectory_forget(tides_trajectory *trajectory, double time)
    "tides_trajectory_forget": (None, [P(tides_trajectory), c_double], "trajectory time"),
    # tides_status tides_trajectory_imu(const tides_trajectory *trajectory, const tides_imu *imu, double start, size_t
    # count, tides_imu_sample *samples, tides_error *error)
    "tides_trajectory_imu": (c_int32, [
        P(tides_trajectory), P(tides_imu), c_double, c_size_t, P(tides_imu_sample), P(tides_error)
    ], "trajectory imu start count samples error"),
    # int32_t tides_trajectory_is_open(const tides_trajectory *trajectory)
    "tides_trajectory_is_open": (c_int32, [P(tides_trajectory)], "trajectory"),
    # int32_t tides_trajectory_is_static(const tides_trajectory *trajectory)
    "tides_trajectory_is_static": (c_int32, [P(tides_trajectory)], "trajectory"),
    # void tides_trajectory_range(const tides_trajectory *trajectory, double *start, double *stop)
    "tides_trajectory_range": (None, [P(tides_trajectory), P(c_double), P(c_double)], "trajectory start stop"),
    # tides_status tides_trajectory_sample(const tides_trajectory *trajectory, size_t index, tides_pose_sample *sample,
    # tides_error *error)
    "tides_trajectory_sample": (c_int32, [
        P(tides_trajectory), c_size_t, P(tides_pose_sample), P(tides_error)
    ], "trajectory index sample error"),
    # const char *tides_transfer_name(int32_t transfer)
    "tides_transfer_name": (c_char_p, [c_int32], "transfer"),
    # const char *tides_truth_name(int32_t truth)
    "tides_truth_name": (c_char_p, [c_int32], "truth"),
    # tides_status tides_truth_read(const char *path, tides_exr **planes, tides_error *error)
    "tides_truth_read": (c_int32, [c_char_p, P(P(tides_exr)), P(tides_error)], "path planes error"),
    # const char *tides_version(void)
    "tides_version": (c_char_p, [], ""),
    # tides_status tides_voxel_grid(const tides_event *events, size_t count, int32_t width, int32_t height, const
    # tides_voxel_options *options, double *grid, tides_error *error)
    "tides_voxel_grid": (c_int32, [
        P(tides_event), c_size_t, c_int32, c_int32, P(tides_voxel_options), P(c_double), P(tides_error)
    ], "events count width height options grid error"),
    # void tides_voxel_options_defaults(tides_voxel_options *options, int32_t style)
    "tides_voxel_options_defaults": (None, [P(tides_voxel_options), c_int32], "options style"),
    # void tides_world_release(tides_world *world)
    "tides_world_release": (None, [P(tides_world)], "world"),
}

STRUCTS = (
    tides_error, tides_frames_options, tides_event, tides_event_file, tides_event_format, tides_event_facts,
    tides_event_reading, tides_event_summary, tides_readout, tides_readout_stats, tides_filters, tides_filter_stats,
    tides_pose_sample, tides_pose, tides_orbit, tides_dolly, tides_handheld, tides_lens, tides_intrinsics,
    tides_path_options, tides_path, tides_device_info, tides_polynomial_motion, tides_rotor_motion,
    tides_keyframes_motion, tides_theta, tides_callback_motion, tides_gaussians, tides_scene_options,
    tides_scene_format, tides_object, tides_circuit, tides_sensor, tides_smoothing, tides_image_params, tides_frame,
    tides_render_stats, tides_risk, tides_stepping, tides_stats, tides_stat, tides_esim, tides_v2e, tides_voltmeter,
    tides_iebcs, tides_ldati_params, tides_baseline_params, tides_frame_supply, tides_exposure, tides_exposed,
    tides_imu, tides_imu_sample, tides_param, tides_run_values, tides_rig_camera, tides_session_facts,
    tides_session_taken, tides_recording, tides_recorded, tides_dataset_layout, tides_dataset_report, tides_generator,
    tides_generate_options, tides_world, tides_channel, tides_truth, tides_material_point, tides_track,
    tides_event_truth, tides_event_conversion, tides_event_conversion_report, tides_match, tides_metrics_options,
    tides_interval_fit, tides_stream_metrics, tides_metrics, tides_metric, tides_blemishes, tides_voxel_options,
    tides_array_shape, tides_page_options, tides_page_report, tides_run_input, tides_fingerprint, tides_live_options,
    tides_exact_options, tides_exact, tides_calibrated, tides_calibrated_row, tides_calibrate_options,
    tides_calibration,
)
