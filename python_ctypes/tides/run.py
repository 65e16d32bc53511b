"""Run files: a JSON text that describes a simulation."""

from __future__ import annotations

import ctypes
import json
import os
from ctypes import POINTER, byref, c_char_p, c_size_t
from typing import Any, Sequence

import numpy as np

from . import _api
from ._call import as_json, call, encoded, path, text
from ._handle import Handle
from ._library import lib
from ._progress import Progress
from ._values import Facts, constants, plain
from .baselines import Frames
from .device import Device
from .files import _paths
from .measure import ideal_settings
from .render import Renderer
from .scene import Scene
from .session import Session, overrides, values_of
from .simulate import Simulation
from .trajectory import Camera, Intrinsics, Trajectory

_STATS = {number: word for word, number in constants("TIDES_STAT_").items()}
_KINDS = ("both", "event", "frame")
_TYPES = {number: word for word, number in constants("TIDES_PARAM_").items()}


def parameters() -> list[Facts]:
    """The table of a run file's keys: key, type ("number" ...), unit, lower, upper, fallback (the default as JSON text; "" for
    required keys), choices (list), sentence, common (True: most runs set it), path (True: it names files, relative to the
    run file)."""
    count = c_size_t()
    rows = lib.tides_params(byref(count))
    made = []
    for row in rows[: count.value]:
        facts = plain(row)
        choices = facts["choices"].split("|") if facts["choices"] else []
        names_files = bool(lib.tides_param_is_path(row.key))
        made.append(Facts(facts, type=_TYPES[row.type], choices=choices, common=bool(row.common), path=names_files))
    return made


def statistics() -> list[Facts]:
    """The table of statistics, which `tides simulate --stats` writes: name, unit, type ("count", "real", "whole"), offset in
    api.tides_stats."""
    count = c_size_t()
    rows = lib.tides_stats_table(byref(count))
    return [Facts(plain(row), type=_STATS[row.type]) for row in rows[: count.value]]


def stat_values(stats: _api.tides_stats) -> Facts:
    """The rows of the table by name ("events", "time_s.sort", "settings.unit"), of an api.tides_stats."""
    count = c_size_t()
    rows = lib.tides_stats_table(byref(count))
    return Facts({text(row.name): lib.tides_stat_value(byref(stats), byref(row)) for row in rows[: count.value]})


def run_template(scene_file: str, camera_file: str) -> str:
    """A run file with every key at its default, as JSON text."""
    made = c_char_p()
    call("tides_run_template", encoded(scene_file), encoded(camera_file), byref(made))
    try:
        return text(made.value)
    finally:
        lib.tides_free(ctypes.cast(made, ctypes.c_void_p))


class Run(Handle):
    """A run file, read and checked: Run("room.json", {"sensor.threshold_on": 0.3}); or from JSON text or a dict:
    Run(text={...}, directory="."), paths being relative to the file or the directory. BadConfig names the key.

    Fields of `values` are attributes: run.start, run.stop, run.sensor, run.stepping, run.image, run.intrinsics, run.device
    ... Pickled are the file's name, or the text, and the overrides: a worker process reads them again."""

    _destroy = "tides_run_destroy"
    _variations: tuple[dict[str, Any], ...] = ()  # arguments of `vary` since then

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
        made, settings = POINTER(_api.tides_run)(), overrides(set)
        name = None if file is None else os.path.abspath(file)
        self._given = (name, dict(set or {}), text, os.path.abspath(directory))
        if file is not None:
            call("tides_run_load", path(file), *settings, byref(made))
        else:
            words = text if isinstance(text, str) else as_json(text)
            call("tides_run_parse", encoded(words), path(directory), *settings, byref(made))
        self._take(made)

    def _take(self, made: Any) -> None:
        super().__init__(made)
        values = _api.tides_run_values()
        lib.tides_run_get(made, byref(values))
        self.values = values_of(values, self)

    def vary(self, set: dict[str, Any]) -> "Run":
        """The same run with more overrides."""
        made = POINTER(_api.tides_run)()
        call("tides_run_vary", self._pointer, *overrides(set), byref(made))
        run = Run.__new__(Run)
        run._given, run._variations = self._given, (*self._variations, dict(set))
        run._take(made)
        return run

    def __repr__(self) -> str:
        name, changes = self._given[0] or "text=...", {**self._given[1]}
        for one in self._variations:
            changes.update(one)
        return f"Run({name!r}{f', {changes!r}' if changes else ''}): {self.start:g} to {self.stop:g} s"

    def __reduce__(self) -> Any:
        return _read_again, (*self._given, self._variations)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "values":
            raise AttributeError(name)
        return getattr(self.values, name)

    @property
    def notes(self) -> list[str]:
        """Notes on the run file, such as values that a preset didn't set."""
        return text(lib.tides_run_notes(self._pointer)).splitlines()

    def gives(self, key: str) -> bool:
        """Whether the file or an override sets `key`; else it has its default or the preset's value."""
        return bool(lib.tides_run_gives(self._pointer, key.encode()))

    @property
    def rig(self) -> list[Facts]:
        """Cameras of the run's rig: name, kind ("both", "event", "frame"), T_B_C (4 x 4, p_body = T_B_C p_camera). A run
        simulates one of them: run.vary({"rig.camera": name})."""
        made, camera = [], _api.tides_rig_camera()
        while lib.tides_run_rig_camera(self._pointer, len(made), byref(camera)):
            name = text(bytes(camera.name).split(b"\0")[0])
            made.append(Facts(name=name, kind=_KINDS[camera.kind], T_B_C=np.array(camera.T_B_C).reshape(4, 4)))
        return made

    def open(self) -> tuple[Scene, Camera]:
        """Opens the scene and the camera that the run names."""
        scene, trajectory = POINTER(_api.tides_scene)(), POINTER(_api.tides_trajectory)()
        intrinsics = Intrinsics()
        call("tides_run_open", self._pointer, byref(scene), byref(trajectory), intrinsics)
        return Scene._of(scene), Camera(Trajectory._of(trajectory), intrinsics)

    def open_frames(self) -> Frames:
        """Opens the frames that the run names. BadConfig where it names none."""
        made = POINTER(_api.tides_frames)()
        call("tides_run_open_frames", self._pointer, byref(made))
        return Frames._of(made)

    def inputs(self) -> list[Facts]:
        """The files that the run reads: key, path, folder (True: with all files in it)."""
        rows, count = POINTER(_api.tides_run_input)(), c_size_t()
        call("tides_run_inputs", self._pointer, byref(rows), byref(count))
        try:
            return [Facts(plain(row), folder=bool(row.folder)) for row in rows[: count.value]]
        finally:
            lib.tides_free(ctypes.cast(rows, ctypes.c_void_p))

    def check_apart(self, outputs: Sequence[str | os.PathLike[str]]) -> None:
        """Raises ValueError where one of the outputs is another, or a file that the run reads."""
        call("tides_run_apart", self._pointer, _paths(outputs), len(outputs))

    def fingerprint(self, extra: str | None = None, prints: "Fingerprints | None" = None) -> Facts:
        """A hash of the run with every default filled in, of all its inputs, and of `extra`; and the inputs' sizes: files,
        bytes, largest [bytes]. If it is unchanged, results are current. `prints` remembers files that several runs
        share."""
        made = _api.tides_fingerprint()
        prints = prints or Fingerprints()
        with prints._lock:
            call("tides_fingerprints_run", prints._pointer, self._pointer, encoded(extra), byref(made))
        return plain(made)

    def ideal(self, method: str | None = None, pixel: bool = True) -> "Run":
        """The run with `method` (None: its own) and ideal pixels of its thresholds: methods then differ by how they see the
        image and where they put events in time. pixel=False: only the thresholds, if the method has none."""
        return self.vary(ideal_settings(self, method or self.values.method, pixel))

    def session(self, device: Device | str | int | None = None) -> Session:
        """The run as a Session, with all its inputs open. `device` overrides the run file's, which overrides TIDES_DEVICE."""
        return Session(self, device=device)

    def simulation(self, device: Device | str | int | None = None, progress: Progress = None) -> Simulation:
        """The run as a Simulation. Unsupported for methods that difference frames: use `simulate`."""
        return self.session(device).simulation(progress)

    def renderer(self, device: Device | str | int | None = None, progress: Progress = None) -> Renderer:
        """The run's scene, camera and image rules as a Renderer. The optics' blur (frontend.psf_sigma_px) is left out: add it
        with Renderer.set_psf."""
        return self.session(device).renderer(progress)

    def simulate(self, device: Device | str | int | None = None, progress: Progress = None) -> np.ndarray:
        """All events of the run, as EVENT (n), by the method that it names."""
        with self.session(device) as session:
            return session.simulate(progress)


def _read_again(file: Any, set: dict[str, Any], text: Any, directory: str, variations: tuple[dict[str, Any], ...]) -> Run:
    """Unpickles a run."""
    run = Run(file, set, text=text, directory=directory)
    for one in variations:
        run = run.vary(one)
    return run


def fingerprint_text(*texts: str) -> int:
    """A 64-bit hash of texts in sequence, equal in every version: for names made of settings."""
    bytes_of = [one.encode() for one in texts]
    return lib.tides_fingerprint_text((c_char_p * max(1, len(bytes_of)))(*bytes_of), len(bytes_of))


class Fingerprints(Handle):
    """Computes fingerprints, of each path once: of files by content, of folders by names, sizes and times of the files in
    them. The folder `but`, that of results, is left out."""

    _destroy = "tides_fingerprints_destroy"

    def __init__(self, but: str | os.PathLike[str] | None = None):
        made = POINTER(_api.tides_fingerprints)()
        call("tides_fingerprints_create", None if but is None else path(but), byref(made))
        super().__init__(made)

    def of(self, file: str | os.PathLike[str]) -> Facts:
        """hash, files, bytes, largest of a file or folder."""
        made = _api.tides_fingerprint()
        with self._lock:
            call("tides_fingerprints_file", self._pointer, path(file), byref(made))
        return plain(made)
