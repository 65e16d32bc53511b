"""TIDES: event cameras in continuous time from Gaussian-splatting scenes.

    import tides
    events = tides.Run("room.json").simulate()          # a numpy array with fields t [ns], x, y [px], p (+1, -1)

Times are seconds (float) in calls and integer nanoseconds in events; `_dot` is d/dt; quaternions are wxyz; camera axes are
OpenCV's (x right, y down, z forward); images are (height x width), row 0 on top. Failures are exceptions (`tides.errors`) with
one line that says what, where, and how to fix it. C code runs without the GIL; see `Simulation` for threads and Ctrl-C.
"""

import importlib
from typing import Any

from . import _api as api
from . import errors, files, image, metrics
from ._call import nearest
from ._describe import describe
from ._handle import Handle
from ._library import PATH as library_path
from ._library import VERSION as __version__
from ._library import lib
from ._values import Value
from .baselines import Baseline, BaselineParams, Frames, FramesOptions, esim_next_time, ldati
from .calibrate import Calibration, calibrate
from .device import Device, devices
from .errors import TidesError
from .events import (
    CAUSES,
    EVENT,
    LABELS,
    TONIC,
    Conversion,
    EventReader,
    EventWriter,
    Reading,
    as_events,
    can_resume,
    check_stretch,
    convert_events,
    event_formats,
    events_summary,
    make_events,
    read_events,
    read_labelled,
    to_tonic,
    write_events,
)
from .exposure import Exposure
from .filters import Filter, Filters, filter
from .generate import GenerateOptions, World, generate, generators
from .live import CAMERA_AXES, Live, LiveOptions, camera_quaternion
from .measure import ExactOptions, exact_stream, ideal_settings, image_is_continuous
from .motion import Motion
from .names import nearest_name
from .page import PageOptions, Shown, read_truth, show, write_page
from .presets import preset, preset_names
from .readout import Arbiter, Readout
from .render import CHANNELS, EVENT_TRUTH, MATERIAL_POINT, TRACK, TRUTHS, ImageParams, Renderer, colour_filter
from .representations import ArrayWriter, VoxelOptions, event_frame, time_surface, voxel_grid
from .run import Fingerprints, Run, fingerprint_text, parameters, run_template, stat_values, statistics
from .scene import Gaussians, Scene, SceneObject, scene_formats
from .session import Session, dataset_layouts
from .simulate import Recording, Sensor, Simulation, Stepping
from .trajectory import IMU_SAMPLE, Camera, Imu, Intrinsics, Lens, PathOptions, Pose, Trajectory, lens_names

for value in Value.__subclasses__():  # ctypes makes none while their classes are being made
    describe(value)
del value, describe, Value

__all__ = [
    "__version__",
    "api",
    "Arbiter",
    "ArrayWriter",
    "as_events",
    "Baseline",
    "BaselineParams",
    "calibrate",
    "Calibration",
    "Camera",
    "CAMERA_AXES",
    "camera_quaternion",
    "can_resume",
    "CAUSES",
    "CHANNELS",
    "check_stretch",
    "colour_filter",
    "Conversion",
    "convert_events",
    "dataset_layouts",
    "Device",
    "devices",
    "errors",
    "esim_next_time",
    "EVENT",
    "event_formats",
    "event_frame",
    "EVENT_TRUTH",
    "EventReader",
    "events_summary",
    "EventWriter",
    "exact_stream",
    "ExactOptions",
    "Exposure",
    "files",
    "Filter",
    "filter",
    "Filters",
    "fingerprint_text",
    "Fingerprints",
    "Frames",
    "FramesOptions",
    "Gaussians",
    "generate",
    "GenerateOptions",
    "generators",
    "Handle",
    "ideal_settings",
    "image",
    "image_is_continuous",
    "ImageParams",
    "Imu",
    "IMU_SAMPLE",
    "Intrinsics",
    "LABELS",
    "ldati",
    "lens_names",
    "Lens",
    "lib",
    "library_path",
    "Live",
    "LiveOptions",
    "make_events",
    "MATERIAL_POINT",
    "metrics",
    "Motion",
    "nearest_name",
    "PageOptions",
    "parameters",
    "PathOptions",
    "Pose",
    "preset",
    "preset_names",
    "read_events",
    "read_labelled",
    "read_truth",
    "Reading",
    "Readout",
    "Recording",
    "Renderer",
    "Run",
    "run_template",
    "Scene",
    "scene_formats",
    "SceneObject",
    "Sensor",
    "Session",
    "show",
    "Shown",
    "Simulation",
    "stat_values",
    "statistics",
    "Stepping",
    "TidesError",
    "time_surface",
    "to_tonic",
    "TONIC",
    "TRACK",
    "Trajectory",
    "TRUTHS",
    "voxel_grid",
    "VoxelOptions",
    "World",
    "write_events",
    "write_page",
]


def __getattr__(name: str) -> Any:
    """Imports modules that have dependencies of their own, when they are asked for."""
    if name in ("bag", "distributed", "mujoco", "play", "ros2", "rosbag", "usd"):
        return importlib.import_module(f"{__name__}.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}{nearest(name, __all__)}")
