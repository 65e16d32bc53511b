"""Frame sequences, and the simulators used for comparison: ESIM, v2e, DVS-Voltmeter, IEBCS, LDATI."""

from __future__ import annotations

import math
import os
from ctypes import POINTER, byref, c_double, c_int32
from typing import Any

import numpy as np

from . import _api
from ._call import array, call, kept, path, pointer, text
from ._handle import Handle
from ._library import lib
from ._progress import Progress, Reporter
from ._values import Facts, Value, plain
from .render import Renderer
from .simulate import _Collector


# Floats beyond this can't have full scale 1. lib/frames/frame_range.c has the same limit.
_BRIGHT = 16


class FramesOptions(Value, _api.tides_frames_options):
    """transfer ("linear", "srgb"), unit ("auto", "s", "ms", "us", "ns"), rebase, timestamps (a file), frames_per_second [Hz],
    luminance (3), planes (1; 20: voxel grids of LDATI), full_scale (the stored value that is light 1; 0: by type and values)."""

    _defaults, _groups = "tides_frames_options_defaults", ("frames.",)
    _words = {"transfer": "TIDES_TRANSFER_", "unit": "TIDES_TIME_"}


class Frames(Handle):
    """A sequence of luminance images: Frames(path) of a folder or file; Frames.of(Y, times) of arrays. frames[k] is (height x
    width) float64, or of voxel grids (planes=20) (planes x height x width); frames.times (n) [s]."""

    _destroy = "tides_frames_close"

    def __init__(self, file: str | os.PathLike[str], **options: Any):
        """`options` are the fields of FramesOptions."""
        made = POINTER(_api.tides_frames)()
        call("tides_frames_open", path(file), FramesOptions(**options), byref(made))
        self._take(made)

    def _take(self, made: Any, *arrays: np.ndarray) -> None:
        super().__init__(made)
        self._arrays = arrays  # memory that C reads
        width, height = c_int32(), c_int32()
        lib.tides_frames_size(made, byref(width), byref(height))
        self.width, self.height, self.planes = width.value, height.value, lib.tides_frames_planes(made)

    @property
    def note(self) -> str:
        """A note on the stored value that was taken for full scale, if it was guessed from the values; else ""."""
        return text(lib.tides_frames_note(self._pointer))

    @classmethod
    def _of(cls, made: Any) -> "Frames":
        frames = cls.__new__(cls)
        frames._take(made)
        return frames

    @classmethod
    def of(cls, luminance: Any, times: Any, full_scale: float | None = None) -> "Frames":
        """Luminance (n x height x width) at `times` (n) [s], without a copy if it is contiguous float64 and full scale is 1.
        Integers above 1 and floats above 16 need `full_scale`, the value of light 1."""
        given = np.asarray(luminance)
        if full_scale is not None:
            luminance = given / float(full_scale)
        elif given.dtype.kind in "iuf" and given.size and np.nanmax(given) > (_BRIGHT if given.dtype.kind == "f" else 1):
            raise ValueError(f"luminance: {given.dtype} up to {np.nanmax(given)}: give full_scale, the value that is light 1")
        luminance = array(luminance, np.float64, (None, None, None), "luminance")
        times = array(times, np.float64, (len(luminance),), "times")
        made = POINTER(_api.tides_frames)()
        planes, seconds = pointer(luminance, c_double), pointer(times, c_double)
        call("tides_frames_from_memory", planes, seconds, len(times), luminance.shape[2], luminance.shape[1], byref(made))
        frames = cls.__new__(cls)
        frames._take(made, luminance, times)
        return frames

    def __len__(self) -> int:
        return lib.tides_frames_count(self._pointer)

    @property
    def times(self) -> np.ndarray:
        """Times (n) of the frames [s]."""
        return np.array([lib.tides_frames_time(self._pointer, index) for index in range(len(self))])

    def __getitem__(self, index: int) -> np.ndarray:
        if not 0 <= index < len(self):
            raise IndexError(f"frame {index} of {len(self)}")
        shape = (self.height, self.width)
        plane = np.empty(shape if self.planes == 1 else (self.planes, *shape))
        with self._lock:
            call("tides_frames_read", self._pointer, index, pointer(plane, c_double))
        return plane


class BaselineParams(Value, _api.tides_baseline_params):
    """method ("tides", "esim", "v2e", "iebcs", "voltmeter", "ldati"), seed, and each method's own parameters:
    params.esim.log_eps ..."""

    _defaults, _groups = "tides_baseline_params_defaults", ("",)
    _words = {"method": "TIDES_METHOD_"}


class Baseline(Handle):
    """A simulator that works on frames of width x height px. `push` frames, or `run` a sequence or a renderer."""

    _destroy = "tides_baseline_destroy"

    def __init__(self, params: BaselineParams, width: int, height: int):
        made = POINTER(_api.tides_baseline)()
        call("tides_baseline_create", params, width, height, byref(made))
        super().__init__(made)
        planes = (2, _api.TIDES_LDATI_PLANES) if params.method == "ldati" else ()
        self._shape, self.stats = (*planes, height, width), Facts()  # statistics of the last `run`

    def push(self, time: float, luminance: Any) -> np.ndarray:
        """Adds the next frame (height x width; for LDATI 2 x 10 of them) at `time` [s]. Returns the events that no later frame
        can precede, EVENT (n)."""
        plane = array(luminance, np.float64, self._shape, "luminance")
        with self._lock:
            return _collected("tides_baseline_push", self._pointer, time, pointer(plane, c_double))

    def finish(self) -> np.ndarray:
        """Returns the remaining events, EVENT (n)."""
        with self._lock:
            return _collected("tides_baseline_finish", self._pointer)

    def run(
        self,
        frames: Frames | Renderer,
        start: float = -math.inf,
        stop: float = math.inf,
        frames_per_second: float = 0.0,
        progress: Progress = None,
    ) -> np.ndarray:
        """All events, EVENT (n), of a sequence, or of a renderer at `frames_per_second` [Hz], in [start, stop] s. `stats` has
        statistics."""
        supply, stats, collector = _api.tides_frame_supply(), _api.tides_stats(), _Collector()
        supply.frames_per_second, supply.start, supply.stop = frames_per_second, start, stop
        if isinstance(frames, Renderer):
            supply.renderer, supply.camera = frames._pointer, frames.camera.trajectory._pointer
        else:
            supply.frames = frames._pointer
        with self._lock, frames._lock, Reporter(progress) as step:
            taken = _api.tides_event_sink(kept(collector.take, 1))
            call("tides_baseline_run", self._pointer, supply, taken, None, step, None, stats)
        self.stats = plain(stats)
        return collector.result()


def _collected(name: str, *arguments: Any) -> np.ndarray:
    collector = _Collector()
    call(name, *arguments, _api.tides_event_sink(kept(collector.take, 1)), None)
    return collector.result()


def esim_next_time(params: BaselineParams, time: float, fastest: float) -> float:
    """The time at which ESIM's adaptive sampling renders next after `time` [s]: from the largest |L_dot| [1/s], or by motion
    from the fastest flow [px/s]."""
    return lib.tides_esim_next_time(byref(params.esim), time, fastest)


def ldati(voxels: Any, start: float, stop: float, seed: int = 0, frame: int = 0) -> np.ndarray:
    """V2CE's second stage: events of the voxels (2 x 10 x height x width), ON first, in the interval [start, stop) s."""
    voxels = array(voxels, np.float64, (2, 10, None, None), "voxels")
    height, width = voxels.shape[2:]
    return _collected("tides_ldati", pointer(voxels, c_double), width, height, start, stop, seed, frame)
