"""A run with all its inputs open, and running it: into arrays, functions, files."""

from __future__ import annotations

import ctypes
import os
from ctypes import POINTER, byref, c_char_p
from typing import Any, Callable

import numpy as np

from . import _api
from ._call import as_json, call, encoded, instance, kept, path, text
from ._handle import Handle
from ._library import lib
from ._progress import Progress, Reporter
from ._values import Facts, Value, _fields, plain
from ._warn import warn
from .baselines import BaselineParams, Frames, FramesOptions
from .device import Device, opened
from .exposure import Exposure
from .filters import Filters
from .measure import session_exact
from .readout import Readout
from .render import ImageParams, Renderer
from .scene import Scene
from .simulate import Sensor, Simulation, Stepping, _Collector, packet, recording, warn_of_nothing
from ._warn import warn
from .trajectory import Camera, Imu, Intrinsics, PathOptions, Trajectory

_VALUES: dict[Any, Any] = {
    _api.tides_intrinsics: Intrinsics,
    _api.tides_image_params: ImageParams,
    _api.tides_sensor: Sensor,
    _api.tides_stepping: Stepping,
    _api.tides_readout: Readout,
    _api.tides_filters: Filters,
    _api.tides_baseline_params: BaselineParams,
    _api.tides_frames_options: FramesOptions,
    _api.tides_path_options: PathOptions,
    _api.tides_exposure: Exposure,
    _api.tides_imu: Imu,
}


def overrides(settings: dict[str, Any] | None) -> tuple[Any, int]:
    """{key: value} as C's list of "key=value" texts, and their number."""
    if settings is not None:
        instance(settings, dict, "settings of the run file")
    texts = [
        encoded(f"{key}={value if isinstance(value, str) else as_json(value)}")
        for key, value in (settings or {}).items()
    ]
    return (c_char_p * max(1, len(texts)))(*texts), len(texts)


def values_of(struct: Any, owner: Any) -> Facts:
    """A tides_run_values as Facts; `owner` holds the memory that its pointers point to."""

    def value(one: Any) -> Any:
        kind = _VALUES.get(type(one))
        return kind._from(one, owner) if kind else plain(one)

    return Facts({name: value(getattr(struct, name)) for name, _ in _fields(struct)})


def dataset_layouts() -> list[Facts]:
    """The layouts of Session.dataset: name, summary, metric (True: scene.metres_per_unit must be known)."""
    made, layout = [], _api.tides_dataset_layout()
    while lib.tides_dataset_layout_at(len(made), byref(layout)):
        facts = plain(layout)
        made.append(Facts(facts, metric=bool(facts["metric"])))
    return made


class Session(Handle):
    """A run file with all its inputs open: Session("room.json", {"method": "esim"}). It may run any number of times, each from
    the start. A `device` overrides the run file's, which overrides TIDES_DEVICE. Fields: values (as a Run's), intrinsics,
    scene and camera, or frames, device (None on frames), sees_frames."""

    _destroy = "tides_session_close"

    def __init__(
        self,
        run: Any,
        set: dict[str, Any] | None = None,
        device: Device | str | int | None = None,
    ):
        """`run`: a Run, with `set` as overrides, or a run file's path."""
        made = POINTER(_api.tides_session)()
        if not hasattr(run, "_pointer") and not isinstance(device, Device):
            spec = encoded(None if device is None else str(device))
            call("tides_session_load", path(run), *overrides(set), spec, byref(made))
            return self._take(made)
        if not hasattr(run, "_pointer"):
            from .run import Run  # imports this module itself

            run = Run(run)
        run = run.vary(set) if set else run
        if device is None and run.values.device != "auto":
            device = run.values.device
        # On a scene Python opens the device, so that other objects may share it; a run on frames needs none.
        own = None if run.values.frames_file else opened(device)
        call("tides_session_open", run._pointer, own._pointer if own else None, byref(made))
        self._take(made, run, *([own] if own else []), device=own)

    def _take(self, made: Any, *owners: Any, device: Device | None = None) -> None:
        super().__init__(made, *owners, lock=device._lock if device else None)
        facts = _api.tides_session_facts()
        lib.tides_session_get(made, byref(facts))
        self.values, self.sees_frames = values_of(facts.values, self), bool(facts.sees_frames)
        self.intrinsics = Intrinsics._from(facts.intrinsics)
        self.scene = self.camera = self.frames = None
        #: Notes on what was opened; each line is also a warning.
        self.notes = text(lib.tides_session_notes(made)).splitlines()
        for line in self.notes:
            warn(line)
        self.device = device if device or not facts.device else Device._lent(facts.device, self)
        if facts.frames:
            self.frames = Frames._lent(facts.frames, self)
        else:
            self.scene = Scene._lent(facts.scene, self)
            for note in self.scene.notes:
                warn(note)
            self.camera = Camera(Trajectory._lent(facts.camera, self), self.intrinsics)

    def vary(self, set: dict[str, Any]) -> "Session":
        """Another session with the same inputs: other methods, sensors, steps. BadConfig if a key needs other inputs."""
        made = POINTER(_api.tides_session)()
        call("tides_session_vary", self._pointer, *overrides(set), byref(made))
        session = Session.__new__(Session)
        session._take(made, self, device=self.device)
        return session

    def run(self, sink: Callable[..., Any], progress: Progress = None) -> Facts:
        """Does the whole run, by the run's method. `sink` gets each packet as a view of C's memory, valid during the call
        only; it stops the run by returning something true (Cancelled) or by raising. Returns the statistics."""

        def take(_user: Any, events: Any, count: int) -> int:
            return 1 if sink(packet(events, count)) else 0

        return self._run(take, progress)

    def _run(self, take: Callable[..., int], progress: Progress) -> Facts:
        stats = _api.tides_stats()
        with self._lock, Reporter(progress) as step:
            call("tides_session_run", self._pointer, _api.tides_event_sink(kept(take, 1)), None, step, None, byref(stats))
        return self._done(stats)

    def _done(self, stats: Any) -> Facts:
        why = ctypes.create_string_buffer(_api.TIDES_SILENCE)
        if not stats.events_written:
            call("tides_session_silence", self._pointer, byref(stats), why)
        if why.value:
            warn(text(why.value))
        return plain(stats)

    def simulate(self, progress: Progress = None) -> np.ndarray:
        """All events of the run, as EVENT (n)."""
        collector = _Collector()
        self._run(collector.take, progress)
        return collector.result()

    def write(
        self,
        file: str | os.PathLike[str],
        format: str | None = None,
        resume: bool = False,
        checkpoint_s: float | None = None,
        progress: Progress = None,
        *,
        keep_checkpoint: bool = False,
    ) -> Facts:
        """Writes all events of the run to a file, like `tides simulate`; returns the statistics. See Simulation.write."""
        stats = _api.tides_stats()
        how = recording(format, resume, checkpoint_s, keep_checkpoint)
        with self._lock, Reporter(progress) as step:
            call("tides_session_write", self._pointer, path(file), how, step, None, None, byref(stats))
        return self._done(stats)

    def dataset(
        self, folder: str | os.PathLike[str], layouts: str | list[str] | None = None, progress: Progress = None
    ) -> Facts:
        """Writes every camera of the run's rig as a dataset to `folder`, in one layout ("dsec") or several (a folder for
        each); default: those of dataset.layout. tides.dataset_layouts() lists them. Returns the numbers of events, cameras,
        pictures, truths and poses."""
        given = layouts or self.values.dataset_layout
        if not given:
            raise ValueError("layouts: none is given, nor dataset.layout in the run file")
        names = given if isinstance(given, str) else ",".join(given)
        report = _api.tides_dataset_report()
        with self._lock, Reporter(progress) as step:
            call("tides_dataset_write", self._pointer, path(folder), encoded(names), step, None, byref(report))
        if report.unseeing:
            warn_of_nothing(f" of {report.unseeing} of {report.cameras} cameras")
        return plain(report)

    def write_maps(self, file: str | os.PathLike[str]) -> None:
        """Writes the sensor's values of each pixel as an HDF5 file for sensor.maps of another run: both then share a
        sensor."""
        with self._lock:
            call("tides_session_maps", self._pointer, path(file))

    def add_truth(self, file: str | os.PathLike[str], progress: Progress = None) -> None:
        """Adds ground truth to a finished HDF5 recording of this run: columns flow_u, flow_v [px/s], depth [scene units],
        alpha and instance beside its events, each at the time when its event fired. With sensor.truth `write` does it."""
        with self._lock, Reporter(progress) as step:
            call("tides_session_truth", self._pointer, path(file), step, None)

    def write_frames(self, folder: str | os.PathLike[str], progress: Progress = None) -> Facts:
        """Writes frames, as exposure.* says, to a folder: numbered PNGs, timestamps.txt, exposure_timestamps.txt. Returns
        count (of frames), error, renders, unsettled, pairs."""
        taken = _api.tides_session_taken()
        with self._lock, Reporter(progress) as step:
            call("tides_session_frames", self._pointer, path(folder), step, None, byref(taken))
        if not taken.pairs:
            warn_of_nothing()
        return plain(taken)

    def write_imu(self, file: str | os.PathLike[str]) -> Facts:
        """Writes the measurements of an IMU on the camera, as imu.* says: .csv, .txt, .npz or .h5. Returns count and
        at_imu."""
        taken = _api.tides_session_taken()
        with self._lock:
            call("tides_session_imu", self._pointer, path(file), byref(taken))
        return plain(taken)

    def write_tracks(self, file: str | os.PathLike[str], progress: Progress = None) -> Facts:
        """Writes points, as tracks.* says, followed through the run: .npz, .csv, or Kubric's annotations as .npy. Returns
        count (of times) and tracks."""
        taken = _api.tides_session_taken()
        with self._lock, Reporter(progress) as step:
            call("tides_session_tracks", self._pointer, path(file), step, None, byref(taken))
        return plain(taken)

    def exact(self, progress: Progress = None, **options: Any) -> Facts:
        """The exact stream of ideal pixels with the run's thresholds, and its accuracy: see measure.exact_stream."""
        return session_exact(self, progress, **options)

    def simulation(self, progress: Progress = None) -> Simulation:
        """A Simulation at the run's start. Unsupported for methods that difference frames: use `simulate`."""
        made = POINTER(_api.tides_simulator)()
        with self._lock, Reporter(progress) as step:
            call("tides_session_simulator", self._pointer, step, None, byref(made))
        return Simulation._of(made, self)

    def renderer(self, progress: Progress = None) -> Renderer:
        """A Renderer of the scene by the run's image rules. It doesn't have the optics' blur (frontend.psf_sigma_px): see
        Renderer.set_psf. Unsupported on frames."""
        made = POINTER(_api.tides_renderer)()
        with self._lock, Reporter(progress) as step:
            call("tides_session_renderer", self._pointer, step, None, byref(made))
        return Renderer._of(made, self)
