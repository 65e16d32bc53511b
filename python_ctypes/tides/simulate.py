"""From a scene and a camera to a sorted stream of events."""

from __future__ import annotations

import math
import os
import threading
from ctypes import POINTER, byref, c_double, c_uint32, memmove, sizeof
from typing import Any, Callable, Iterator

import numpy as np

from . import _api
from ._call import call, encoded, given, instance, kept, path, pointer
from ._handle import Handle
from ._library import lib
from ._progress import Progress, Reporter
from ._values import Facts, Value, plain
from ._warn import warn
from .device import Device, opened
from .events import EVENT
from .filters import Filters
from .readout import Readout
from .render import ImageParams
from .scene import Scene
from .trajectory import Camera

_RECORD = sizeof(_api.tides_event)


class Sensor(Value, _api.tides_sensor):
    """The sensor: thresholds, and noise and dynamics, which are off by default. `preset` ("davis346", or a .json file like
    share/presets') sets the fields that aren't given; Readout(preset=...) has its readout."""

    _defaults = "tides_sensor_defaults"
    _words = {
        "initial": "TIDES_INITIAL_",
        "refractory_law": "TIDES_REFRACTORY_",
        "psf_domain": "TIDES_PSF_",
        "photoreceptor_law": "TIDES_PHOTORECEPTOR_",
        "bandwidth": "TIDES_BANDWIDTH_",
    }
    _groups, _preset = ("sensor.", "frontend."), "sensor"


class Stepping(Value, _api.tides_stepping):
    """Step control: mode ("fixed", "risk", "error"), model ("hermite", "quadratic", "linear", "secant"), step_s,
    min_step_s, tolerance [thresholds; 0: 0.1 where events are looked up, else 0.01], time_tolerance_s, local,
    solve ("off", "double", "auto"), unit ("tile", "block", "auto"), memory_mb, risk.w_b ..."""

    _defaults, _groups = "tides_stepping_defaults", ("stepping.",)
    _words = {
        "mode": "TIDES_STEPPING_",
        "model": "TIDES_MODEL_",
        "slope": "TIDES_SLOPE_",
        "solve": "TIDES_SOLVE_",
        "unit": "TIDES_UNIT_",
    }


class Recording(Value, _api.tides_recording):
    """Options for writing events: resume, format, checkpoint_s [s], keep_checkpoint."""

    _defaults = "tides_recording_defaults"


def recording(format: str | None, resume: bool, checkpoint_s: float | None, keep_checkpoint: bool) -> Recording:
    how = Recording(format=format, resume=int(resume), keep_checkpoint=int(keep_checkpoint))
    return how if checkpoint_s is None else how.set(checkpoint_s=checkpoint_s)


def packet(events: Any, count: int) -> np.ndarray:
    """A sink's packet as EVENT (count): a view of C's memory, valid during the call only."""
    return np.ctypeslib.as_array(events, (count,)).view(EVENT) if count else np.empty(0, EVENT)


class _Collector:
    """A growing array of events: packets are copied into it once."""

    def __init__(self) -> None:
        self.events, self.count = np.empty(4096, EVENT), 0

    def take(self, _user: Any, events: Any, count: int) -> int:
        if self.count + count > len(self.events):
            grown = np.empty(max(2 * len(self.events), self.count + count), EVENT)
            grown[: self.count] = self.events[: self.count]
            self.events = grown
        if count:
            memmove(self.events.ctypes.data + self.count * _RECORD, events, count * _RECORD)
        self.count += count
        return 0

    def result(self) -> np.ndarray:
        return self.events[: self.count]


def warn_of_nothing(who: str = "") -> None:
    """Warns that nothing was in view: a run whose camera looks away succeeds, without events."""
    warn(f"nothing of the scene was in view{who}, at any time: look at the camera's path")


class Simulation(Handle):
    """A simulation of [start, stop] s; None: the camera's path from its beginning to its end. Take the events with one of
        run()             all (the rest) as an array
        for packet in s   arrays, one for each `step_s`
        write(file)       a file of any format
    once: after the last event each of these raises ValueError, instead of giving no events. Ctrl-C ends a call within a step; what
    was simulated stays, and the next call continues from there."""

    _destroy = "tides_simulator_destroy"
    _spent = False  # True: all events were taken

    def __init__(
        self,
        scene: Scene,
        camera: Camera,
        start: float | None = None,
        stop: float | None = None,
        sensor: Sensor | None = None,
        stepping: Stepping | None = None,
        image: ImageParams | None = None,
        readout: Readout | None = None,
        filters: Filters | None = None,
        device: Device | str | int | None = None,
        run: str | None = None,
        seed: str | None = None,
        progress: Progress = None,
    ):
        """An enabled `readout` stands between pixels and events, and `filters` behind it. `run` (a run file's JSON) and `seed`
        (None: the sensor's) are written into files; `run` is compared when a run is resumed."""
        self.scene, self.camera = instance(scene, Scene, "Simulation: scene"), instance(camera, Camera, "Simulation: camera")
        self.sensor, self.stepping = given(sensor, Sensor, "Simulation: sensor"), given(stepping, Stepping, "Simulation: stepping")
        self.image = given(image, ImageParams, "Simulation: image")
        if readout is not None:
            instance(readout, Readout, "Simulation: readout")
        if filters is not None:
            instance(filters, Filters, "Simulation: filters")
        first, last = camera.trajectory.range
        self.start, self.stop = first if start is None else float(start), last if stop is None else float(stop)
        if not (math.isfinite(self.start) and math.isfinite(self.stop)):
            raise ValueError("start and stop must be given: the camera stands still, its path has no beginning and no end")
        self.device = opened(device)
        self._run, self._seed, self._stopping = run, seed or str(self.sensor.seed), threading.Event()
        made = POINTER(_api.tides_simulator)()
        world = (scene._pointer, camera.trajectory._pointer, camera.intrinsics)
        how = (self.image, self.sensor, self.stepping, self.start, self.stop)
        with self.device._lock, Reporter(progress) as step:
            call("tides_simulator_create", self.device._pointer, *world, *how, step, None, byref(made))
        super().__init__(made, self.device, scene, camera.trajectory, lock=self.device._lock)
        if readout is not None:
            call("tides_simulator_readout", self._pointer, readout)
        if filters is not None:
            call("tides_simulator_filters", self._pointer, filters)

    @classmethod
    def _of(cls, made: Any, session: Any) -> "Simulation":
        """A simulator that a Session made."""
        simulation, v = cls.__new__(cls), session.values
        simulation.start, simulation.stop = v.start, v.stop
        simulation.scene, simulation.camera, simulation.device = session.scene, session.camera, session.device
        simulation.sensor, simulation.stepping, simulation.image = v.sensor, v.stepping, v.image
        simulation._run, simulation._seed, simulation._stopping = v.json, v.seed, threading.Event()
        Handle.__init__(simulation, made, session, lock=session._lock)
        return simulation

    # -- running ----------------------------------------------------------------------------------------------------
    def _goes_on(self) -> None:
        if self._spent:
            raise ValueError(
                f"this Simulation is at its end ({self.stop:g} s) and has given all its events: make a new one to run again "
                "(Run.simulate and Session.simulate begin at the start each time)"
            )

    def _advance(self, until: float | None, sink: Callable[..., int], progress: Progress) -> None:
        """Advances to `until`, or to the end (None), after which no event is left."""
        self._goes_on()
        self._step_to(self.stop if until is None else until, sink, progress)
        self._spent = until is None
        if self._spent and not self.stats.render.pairs_evaluated:
            warn_of_nothing()

    def _step_to(self, until: float, sink: Callable[..., int], progress: Progress) -> None:
        with self._lock, Reporter(progress, self._stopping) as step:
            taken = _api.tides_event_sink(kept(sink, 1))
            try:
                call("tides_simulator_run", self._pointer, until, taken, None, step, None)
            finally:
                self._stopping.clear()

    def run(self, until: float | None = None, progress: Progress = None) -> np.ndarray:
        """Events from the present time to `until` [s] (None: stop), as EVENT (n), sorted by (t, y, x, p). If it is
        interrupted, the exception's `events` are those so far."""
        collector = _Collector()
        try:
            self._advance(until, collector.take, progress)
        except BaseException as raised:
            raised.events = collector.result()  # type: ignore[attr-defined]
            raise
        return collector.result()

    def packets(self, duration_s: float | None = None) -> Iterator[np.ndarray]:
        """Arrays of events, one for each `duration_s` [s] (None: the step); they may be empty. They end at steps of the grid,
        so that together they equal `run`."""
        duration_s = self.stepping.step_s if duration_s is None else duration_s
        if not duration_s > 0:
            raise ValueError(f"duration_s: {duration_s}, where a time above 0 is needed")
        self._goes_on()
        count = max(1, math.ceil((self.stop - self.start) / duration_s - 1e-9))
        first = int(round(self.stats.simulated_s / duration_s, 9))
        for index in range(first, count):
            yield self.run(None if index + 1 == count else self.start + (index + 1) * duration_s)

    __iter__ = packets

    def feed(
        self, sink: Callable[..., Any], until: float | None = None, fired: bool = False, progress: Progress = None
    ) -> None:
        """Gives `sink` each packet as a view of C's memory, valid during the call only; with `fired` also the times when
        events fired [ns] (n), which a readout delays. `sink` stops the simulation by returning something true (Cancelled)
        or by raising."""

        def take(_user: Any, events: Any, count: int) -> int:
            view = packet(events, count)
            return 1 if sink(*((view, self._fired(view)) if fired else (view,))) else 0

        self._advance(until, take, progress)

    def _fired(self, events: np.ndarray) -> np.ndarray:
        times = lib.tides_simulator_fired(self._pointer)
        return np.ctypeslib.as_array(times, (len(events),)) if times and len(events) else events["t"]

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
        """Simulates into an event file and returns the statistics. If it is interrupted, FILE.part has the events so far, and is
        readable. For HDF5 the state is saved as FILE.checkpoint every `checkpoint_s` [s] (None: 30; 0: never) and at Ctrl-C. A
        new Simulation's write(file, resume=True) continues from there, as does `tides simulate --resume`. With
        `keep_checkpoint` FILE.checkpoint stays beside the finished file: a Simulation with a later stop then extends that, to the
        bit. With sensor.labels an HDF5 file has each event's cause, when it fired and what the front end added
        (`read_labelled`)."""
        self._goes_on()
        lens, stretch = self.camera.intrinsics, (_nanoseconds(self.start), _nanoseconds(self.stop))
        texts = encoded(self._run), encoded(self._seed)
        facts = _api.tides_event_file(lens.width, lens.height, *texts, bool(self.sensor.labels), *stretch)
        how = recording(format, resume, checkpoint_s, keep_checkpoint)
        with self._lock, Reporter(progress, self._stopping) as step:
            try:
                call("tides_simulator_write", self._pointer, self.stop, path(file), facts, how, step, None, None)
            finally:
                self._stopping.clear()
        self._spent, stats = True, self.stats
        if not stats.render.pairs_evaluated:
            warn_of_nothing()
        return stats

    def cancel(self) -> None:
        """Stops the call under way in another thread, or else the next one: that call raises Cancelled."""
        self._stopping.set()

    # -- state ------------------------------------------------------------------------------------------------------
    @property
    def stats(self) -> Facts:
        """Statistics so far, with the fields of `tides simulate --stats`."""
        stats = _api.tides_stats()
        with self._lock:
            lib.tides_simulator_stats(self._pointer, byref(stats))
        return plain(stats)

    @property
    def state(self) -> Facts:
        """The state of every pixel: signal and reference [log units], count_on, count_off; arrays (height x width), copied.
        Before the first run signal and reference are NaN."""
        shape = (self.camera.intrinsics.height, self.camera.intrinsics.width)
        planes = [np.empty(shape, kind) for kind in (np.float64, np.float64, np.uint32, np.uint32)]
        kinds = (c_double, c_double, c_uint32, c_uint32)
        with self._lock:
            lib.tides_simulator_state(self._pointer, *(pointer(plane, kind) for plane, kind in zip(planes, kinds)))
        return Facts(zip(("signal", "reference", "count_on", "count_off"), planes))

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes the state of the run to an HDF5 file, for `restore`."""
        with self._lock:
            call("tides_simulator_save", self._pointer, encoded(self._run), path(file))

    def restore(self, file: str | os.PathLike[str]) -> None:
        """Puts this simulation, which hasn't run yet, into a saved state. BadConfig if that was of another run."""
        with self._lock:
            call("tides_simulator_restore", self._pointer, encoded(self._run), path(file))


def _nanoseconds(seconds: float) -> int:
    """Rounds to nanoseconds, as the simulator rounds its start: 1e9 times a time of 1e9 s would be off by 128 ns."""
    whole = math.floor(seconds)
    return whole * 10**9 + math.floor((seconds - whole) * 1e9 + 0.5)
