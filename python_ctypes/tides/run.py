"""Run files: one JSON text that says what to simulate."""

from __future__ import annotations

import ctypes
import json
import os
from ctypes import POINTER, byref, c_char_p, c_size_t
from typing import Any

import numpy as np

from . import _api, errors
from ._call import call, encoded, path, text
from ._handle import Handle
from ._library import lib
from ._progress import Progress
from ._values import Facts, _fields, constants, plain
from .baselines import Baseline, BaselineParams, Frames, FramesOptions
from .device import Device
from .readout import Readout
from .render import ImageParams, Renderer
from .scene import Scene
from .simulate import Sensor, Simulation, Stepping
from .trajectory import Camera, Intrinsics, Trajectory

_TYPES = {number: word for word, number in constants("TIDES_PARAM_").items()}
_VALUES: dict[Any, Any] = {
    _api.tides_intrinsics: Intrinsics,
    _api.tides_image_params: ImageParams,
    _api.tides_sensor: Sensor,
    _api.tides_stepping: Stepping,
    _api.tides_readout: Readout,
    _api.tides_baseline_params: BaselineParams,
    _api.tides_frames_options: FramesOptions,
}
_NOT_ON_FRAMES = (("readout", "enabled", "the arbiter needs"), ("sensor", "labels", "labels need"))


def parameters() -> list[Facts]:
    """The table of a run file's keys: key, type ("number" ...), unit, lower, upper, fallback (the default as JSON text; ""
    where the key is required), choices (list), sentence, available (False: only the default is taken)."""
    count = c_size_t()
    rows = lib.tides_params(byref(count))
    made = []
    for row in rows[: count.value]:
        facts = plain(row)
        choices = facts["choices"].split("|") if facts["choices"] else []
        made.append(Facts(facts, type=_TYPES[row.type], choices=choices, available=bool(row.available)))
    return made


def run_template(scene_file: str, camera_file: str) -> str:
    """A run file with every key at its default, as JSON text."""
    made = c_char_p()
    call("tides_run_template", encoded(scene_file), encoded(camera_file), byref(made))
    try:
        return text(made.value)
    finally:
        lib.tides_free(ctypes.cast(made, ctypes.c_void_p))


def _override(key: str, value: Any) -> bytes:
    return f"{key}={value if isinstance(value, str) else json.dumps(value)}".encode()


def _value(value: Any, run: Any) -> Any:
    kind = _VALUES.get(type(value))
    return kind._from(value, run) if kind else plain(value)


class Run(Handle):
    """A run file, read and checked: Run("room.json", {"sensor.threshold_on": 0.3}); or from JSON text or a dict:
    Run(text={...}, directory="."), paths being relative to the file or the directory. BadConfig names the key.

    Fields of `values` are attributes: run.start, run.stop, run.sensor, run.stepping, run.image, run.intrinsics, run.device
    ..."""

    _destroy = "tides_run_destroy"

    def __init__(
        self,
        file: str | os.PathLike[str] | None = None,
        set: dict[str, Any] | None = None,
        *,
        text: str | dict[str, Any] | None = None,
        directory: str | os.PathLike[str] = ".",
    ):
        if (file is None) == (text is None):
            raise ValueError("file, text: give one of them")
        made = POINTER(_api.tides_run)()
        texts = [_override(key, value) for key, value in (set or {}).items()]
        overrides = (c_char_p * max(1, len(texts)))(*texts)
        if file is not None:
            call("tides_run_load", path(file), overrides, len(texts), byref(made))
        else:
            words = text if isinstance(text, str) else json.dumps(text)
            call("tides_run_parse", words.encode(), path(directory), overrides, len(texts), byref(made))
        super().__init__(made)
        values = _api.tides_run_values()
        lib.tides_run_get(made, byref(values))
        self.values = Facts({name: _value(getattr(values, name), self) for name, _ in _fields(values)})

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "values":
            raise AttributeError(name)
        return getattr(self.values, name)

    def gives(self, key: str) -> bool:
        """Whether the file or an override says `key`; else it has its default or the preset's value."""
        return bool(lib.tides_run_gives(self._pointer, key.encode()))

    def open(self) -> tuple[Scene, Camera]:
        """Opens what the run names."""
        scene, trajectory = POINTER(_api.tides_scene)(), POINTER(_api.tides_trajectory)()
        intrinsics = Intrinsics()
        call("tides_run_open", self._pointer, byref(scene), byref(trajectory), intrinsics)
        return Scene._of(scene), Camera(Trajectory._of(trajectory), intrinsics)

    def open_frames(self) -> Frames:
        """Opens the frames that the run names. BadConfig where it names none."""
        made = POINTER(_api.tides_frames)()
        call("tides_run_open_frames", self._pointer, byref(made))
        return Frames._of(made)

    def _device(self, device: Device | str | int | None) -> Device | str | int | None:
        """The argument wins over the run file, which wins over TIDES_DEVICE; "auto" leaves it open."""
        return device if device is not None or self.values.device == "auto" else self.values.device

    def simulation(self, device: Device | str | int | None = None, progress: Progress = None) -> Simulation:
        """The run as a Simulation. Unsupported where it works on frames: `simulate` does that."""
        v = self.values
        if self._uses_frames():
            message = f"method {v.method} on frames isn't a Simulation: use simulate(), or Baseline"
            raise errors.make(_api.TIDES_UNSUPPORTED, "TIDES_UNSUPPORTED", message)
        scene, camera = self.open()
        parts = (v.sensor, v.stepping, v.image, v.readout, self._device(device))
        return Simulation(scene, camera, v.start, v.stop, *parts, run=v.json, seed=v.seed, progress=progress)

    def renderer(self, device: Device | str | int | None = None, progress: Progress = None) -> Renderer:
        """The run's scene, camera and image rules as a Renderer."""
        return Renderer(*self.open(), self.values.image, self._device(device), progress)

    def _uses_frames(self) -> bool:
        """A baseline on a scene's renders, or any method on a sequence of frames."""
        return bool(self.values.frames_file) or self.values.baseline.method != "tides"

    def simulate(self, device: Device | str | int | None = None, progress: Progress = None) -> np.ndarray:
        """All events of the run, as EVENT (n), by whatever method it names."""
        if not self._uses_frames():
            with self.simulation(device, progress) as simulation:
                return simulation.run(progress=progress)
        v = self.values
        for part, key, needs in _NOT_ON_FRAMES:
            if getattr(getattr(v, part), key):
                message = f'{part}.{key} is true: {needs} a scene and method "tides"; set it to false'
                raise errors.make(_api.TIDES_UNSUPPORTED, "TIDES_UNSUPPORTED", message)
        source = self.open_frames() if v.frames_file else self.renderer(device, progress)
        lens = source if isinstance(source, Frames) else source.camera.intrinsics
        with Baseline(v.baseline, lens.width, lens.height) as baseline:
            return baseline.run(source, v.start, v.stop, v.frames_per_second, progress)
