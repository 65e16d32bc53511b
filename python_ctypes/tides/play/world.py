"""The live run behind the page: opened again when a slider changes the run, stepped once for each picture, and recorded on
request."""

from __future__ import annotations

import hashlib
import json
import math
import os
import shlex
import tempfile
import time
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from ..events import EVENT, EventReader, EventWriter
from ..image import picture_rgb
from ..live import Live, _angular, _quaternion
from ..presets import preset, preset_names
from ..render import Renderer
from ..run import Run, parameters
from ..session import Session
from ..trajectory import Camera, Pose, Trajectory
from .flight import Controls, Flight

ORBIT_S = 12.0  # [s] of a turn about the scene
SLOWEST = 0.01  # slowest speed of time
TOLERANCE = 0.3  # [thresholds]; a large one is enough, since events are looked up on the image
FLIGHT = 0.12  # speed without Shift, in distances to the scene's middle per second: some 2 px per picture
RESPONSE_S = 0.12  # of the camera to keys, in real time
LONGEST_S = 1e5  # of a flight if nothing in the scene ends before

#: Rows of a preset on the page: key of the run file, name, unit, and the factor to that unit.
ROWS = [
    ("sensor.threshold_on", "threshold ON", "", 1),
    ("sensor.threshold_off", "threshold OFF", "", 1),
    ("sensor.threshold_sigma", "from pixel to pixel", "", 1),
    ("frontend.photoreceptor_cutoff_hz", "low-pass", "Hz", 1),
    ("frontend.highpass_hz", "high-pass", "Hz", 1),
    ("sensor.refractory_s", "dead time", "us", 1e6),
    ("sensor.leak_rate_hz", "leak", "Hz", 1),
    ("frontend.shot_noise_hz", "shot noise", "Hz", 1),
    ("frontend.hot_pixel_fraction", "hot pixels", "%", 100),
    ("image.log_eps", "black level", "", 1),
]


def event_hash(file: str | os.PathLike[str]) -> str:
    """SHA-256 of a file's events: t [ns] as 8 bytes, x and y as 2, p as 1, little-endian, event by event."""
    made = hashlib.sha256()
    row = np.dtype([("t", "<i8"), ("x", "<u2"), ("y", "<u2"), ("p", "i1")])
    with EventReader(file) as reader:
        for packet in reader:
            rows = np.empty(len(packet), row)
            for name in row.names:
                rows[name] = packet[name]
            made.update(rows.tobytes())
    return made.hexdigest()


def _run_file(path: Path) -> dict[str, Any]:
    try:
        text = json.loads(path.read_text())
    except ValueError as error:
        raise ValueError(f"{path}: is no run file: {error}") from None
    if not isinstance(text, dict):
        raise ValueError(f"{path}: is no run file: it isn't an object, {{..}}")
    return text


def run_text(source: str | os.PathLike[str], size: tuple[int, int] | None = None) -> tuple[dict[str, Any], str]:
    """The run file for a source and the folder that its paths are relative to: a run file unchanged, or a scene, seen from an
    orbit."""
    if os.fspath(source).endswith(".json"):
        text, folder = _run_file(Path(source)), os.path.dirname(os.path.abspath(source))
    else:
        text, folder = {"scene": {"file": os.path.abspath(source)}, "camera": {"orbit_s": ORBIT_S}}, os.getcwd()
        size = size or (240, 180)
    if size:
        text.setdefault("camera", {}).update(width=size[0], height=size[1])
    times = text.setdefault("time", {})
    times.setdefault("stop", times.setdefault("start", 0.0) + 1e-3)  # any: a run file needs a stop; a flight lasts as long as the scene
    for key, value in (("tolerance", TOLERANCE), ("unit", "block")):  # blocks take a third less time than tiles where steps are long
        text.setdefault("stepping", {}).setdefault(key, value)
    return text, folder


def _absolute(text: dict[str, Any], folder: str) -> dict[str, Any]:
    """The run file with absolute paths, so that it may lie anywhere."""
    text = json.loads(json.dumps(text))
    for row in parameters():
        group, _, name = row.key.rpartition(".")
        here = text.get(group, {}) if group else text
        is_name = row.key == "sensor.preset" and not str(here.get(name)).endswith(".json")
        if row.path and isinstance(here.get(name), str) and not is_name:
            here[name] = os.path.abspath(os.path.join(folder, here[name]))
    for one in text.get("scene", {}).get("objects", []):
        one.update({key: os.path.abspath(os.path.join(folder, one[key])) for key in ("file", "trajectory") if one.get(key)})
    return text


def _circle_of(pose: Pose) -> tuple[np.ndarray, np.ndarray, float]:
    """Centre, upward axis and rate [rad/s] of the circle that a camera follows."""
    turning, upright = _angular(pose), -pose.rotation[:, 1]
    rate = float(np.linalg.norm(turning))
    return pose.position + np.cross(turning, pose.position_dot) / rate**2, math.copysign(1, turning @ upright) * turning, rate


class World:
    """A scene with a camera that is flown. `picture` advances by one picture; `change` sets the sliders' values; `record`
    begins a recording and `keep` ends it. `rate` [1/s] of pictures; `out`: folder of recordings."""

    def __init__(
        self,
        source: str | os.PathLike[str],
        set: dict[str, Any] | None = None,
        size: tuple[int, int] | None = None,
        preset_name: str | None = None,
        rate: float = 15.0,
        out: str | os.PathLike[str] = ".",
        device: Any = None,
    ):
        text, folder = run_text(source, size)
        sensor = text.setdefault("sensor", {})
        sensor["preset"] = preset_name or sensor.get("preset") or ("davis240" if "threshold_on" not in sensor else "ideal")
        self.rate, self.out, self.speed, self.factor = rate, Path(out), 1.0, 1.0
        self.name = Path(source).name
        self._folder = tempfile.TemporaryDirectory(prefix="tides-play-")
        self._text = self._start(text, folder, set)
        self._session = Session(Run(text=self._text), None, device)
        self.intrinsics = self._session.intrinsics
        # With its own device, pictures are drawn during steps: calls on objects of one device wait for each other.
        scene, camera = self._session.scene, self._session.camera
        assert scene is not None and camera is not None  # a run of frames has none, and was refused
        self._renderer = Renderer(scene, camera, self._session.values.image, self._spec(device))
        self._painter = ThreadPoolExecutor(1)
        self.preset = self._text["sensor"]["preset"]
        if self._end - self._begin < 1 / rate:
            raise ValueError(
                f"{self.name}: its motion lasts {self._end - self._begin:g} s from the run's start on, and a picture {1 / rate:.3g} s: "
                f"more pictures a second show it (--rate {math.ceil(2 / max(self._end - self._begin, 1e-6))})"
            )
        self._live: Live | None = None
        self._recording: Recording | None = None
        self.flight = self._pilot()
        self._open(self._begin)
        self._drawn = self._draw(self._begin, self.flight.pose())

    def _spec(self, device: Any) -> Any:
        return self._text["device"] if device is None and self._text["device"] != "auto" else device

    def _start(self, text: dict[str, Any], folder: str, set: dict[str, Any] | None) -> dict[str, Any]:
        """The run file with `set`, and an open camera path that begins at the run's first pose."""
        for key, value in (set or {}).items():
            group, _, name = key.rpartition(".")
            (text.setdefault(group, {}) if group else text)[name] = value
        with Run(text=text, directory=folder) as run:
            scene, camera = run.open()
            self._begin, text["device"] = run.values.start, run.values.device
            self._end = min(self._begin + LONGEST_S, scene.range[1])
            self._orbits = json.loads(run.values.json)["camera"]["orbit_s"] is not None
            self._first = camera.trajectory.at(self._begin)
            still = Trajectory.static(self._first.position, _quaternion(self._first.rotation))
            Camera(still, camera.intrinsics).save(os.path.join(self._folder.name, "start.json"))
            scene.close()
        made = _absolute(text, folder)
        made["camera"] = {"file": os.path.join(self._folder.name, "start.json"), "lux": made.get("camera", {}).get("lux")}
        made["time"] = {"start": self._begin, "stop": self._end}
        return made

    def _pilot(self) -> Flight:
        """A flight that circles on the run's own orbit; without one, upright about a point ahead, at the median depth."""
        depth, first = self._renderer.truth(self._begin, ["depth"])["depth"], self._first
        seen = depth[np.isfinite(depth)]
        distance = float(np.median(seen)) if len(seen) else 1.0
        centre, up, rate = first.position + distance * first.rotation[:, 2], -first.rotation[:, 1], 2 * math.pi / ORBIT_S
        if self._orbits:
            centre, up, rate = _circle_of(first)
        reach = float(np.linalg.norm(first.position - centre)) or distance
        return Flight(first, centre, up, FLIGHT * reach, rate)

    # -- the run ----------------------------------------------------------------------------------------------------
    @property
    def presets(self) -> list[str]:
        """Names for `change`: the library's presets, and the run's own preset file."""
        own = self._text["sensor"]["preset"]
        return preset_names() + ([] if own in preset_names() else [own])

    def _settings(self, start: float) -> dict[str, Any]:
        """The sliders' values as keys of the run file."""
        made: dict[str, Any] = {"time.start": start, "time.stop": self._end, "stepping.step_s": self.speed / self.rate}
        if self.preset != self._text["sensor"]["preset"]:
            made["sensor.preset"] = self.preset  # it overrides the run file's own values
        if self.factor != 1:
            nominal = self._session.vary(made).values.sensor
            made["sensor.threshold_on"] = self.factor * nominal.threshold_on
            made["sensor.threshold_off"] = self.factor * nominal.threshold_off
        return made

    def _open(self, start: float, keep: bool = False) -> None:
        """Opens a new live run from `start` on, with the sliders' values."""
        session = self._session.vary(self._settings(start))
        live = Live(session, keep=keep)
        live.tell(self.flight.pose(), start)
        if self._live:
            self._live.close()
        self._live, self._varied = live, session

    @property
    def live(self) -> Live:
        assert self._live is not None
        return self._live

    def change(self, threshold: float | None = None, preset: str | None = None, speed: float | None = None) -> None:
        """`threshold`: factor of the preset's thresholds; `speed` of time, SLOWEST to 1. Each begins a new run at the present
        pose, and is refused during a recording."""
        if self._recording:
            raise ValueError("a recording has one preset, threshold and speed of time: stop it first")
        before = self.factor, self.preset, self.speed
        if threshold is not None:
            self.factor = _within(threshold, 0.1, 10, "threshold")
        if preset is not None:
            if preset not in self.presets:
                raise ValueError(f"preset: {preset!r} is none of {', '.join(self.presets)}")
            self.preset = preset
        if speed is not None:
            self.speed = _within(speed, SLOWEST, 1, "speed")
        if (self.factor, self.preset, self.speed) != before:
            self._open(self.live.time)

    @property
    def at_end(self) -> bool:
        """Whether the scene's own motion ends before the next picture."""
        return self.live.time + self.speed / self.rate > self._end

    def step(self, controls: Controls) -> np.ndarray:
        """Flies for the time of one picture, and returns its events. Where the scene's motion ends, it begins again; while
        recording, there are no more events instead. The picture is drawn meanwhile, since its pose is known first."""
        dt = self.speed / self.rate
        if self.at_end and self._recording:
            return np.empty(0, EVENT)
        if self.at_end:
            self._open(self._begin)
        pose = self.flight.step(controls, dt, RESPONSE_S * self.speed)
        self._drawn = self._draw(self.live.time + dt, pose)
        events = self.live.step(pose, dt)
        if self._recording:
            self._recording.append(events)
        return events

    def _draw(self, time: float, pose: tuple[Any, ...]) -> Future[np.ndarray]:
        def draw() -> np.ndarray:
            frame = self._renderer.frame(time, "RGB", Trajectory.static(pose[0], pose[1]))
            return picture_rgb(frame["R"], frame["G"], frame["B"])

        return self._painter.submit(draw)

    def picture(self) -> np.ndarray:
        """What the camera sees where the last step ended, uint8 (height x width x 3)."""
        return self._drawn.result()

    def says(self) -> dict[str, Any]:
        """Facts of the preset: its sentence, and rows of (name, value, unit, source)."""
        told, text = _told(self.preset), json.loads(self._varied.values.json)
        rows = []
        for key, what, unit, factor in ROWS:
            group, name = key.split(".")
            value, source = text[group][name], told.get(group, {}).get(name)
            kind = source.get("kind", "") if isinstance(source, dict) else ""
            rows.append((what, f"{factor * value:.3g}" if value else "off", unit if value else "", kind if value else ""))
        readout = text["readout"]
        rows.append(("readout", readout["kind"] if readout["enabled"] else "off", "", ""))
        about = told.get("about", "")
        return {"preset": self.preset, "about": about, "rows": rows, "threshold": self.factor, "speed": self.speed}

    # -- recording --------------------------------------------------------------------------------------------------
    @property
    def recording(self) -> bool:
        return self._recording is not None

    def record(self) -> None:
        """Begins a recording, a new run from the present pose on."""
        if self._recording:
            raise ValueError("it is recorded already")
        self._open(self.live.time, keep=True)
        self._recording = Recording(self)

    def keep(self) -> dict[str, Any]:
        """Ends the recording. Returns its folder, the number of events, their hash, and commands that make them again."""
        if not self._recording:
            raise ValueError("nothing is recorded")
        recording, self._recording = self._recording, None
        made = recording.finish()
        self._open(self.live.time)
        return made

    def close(self) -> dict[str, Any] | None:
        """Ends the run, and a recording as `keep` does."""
        recording, self._recording = self._recording, None
        try:
            return recording.finish() if recording else None
        finally:
            self._end_run()

    def _end_run(self) -> None:
        if self._live:
            self._live.close()
            self._live = None
        self._painter.shutdown()
        self._folder.cleanup()


class Recording:
    """path.json, run.json and events.h5 in a new folder."""

    def __init__(self, world: World):
        self._world, self._live, self.start = world, world.live, world.live.time
        self.folder = _new_folder(world.out)
        lens, values = world.intrinsics, self._live.session.values
        self.run = json.loads(values.json)  # every key with its value, so that neither preset nor default matters
        self._writer = EventWriter(self.folder / "events.h5", lens.width, lens.height, run=values.json, seed=values.seed)

    def append(self, events: np.ndarray) -> None:
        self._writer.append(events)

    def finish(self) -> dict[str, Any]:
        live, folder = self._live, self.folder
        self.append(live.finish())
        Camera(live.path(), self._world.intrinsics).save(folder / "path.json")
        self.run["camera"]["file"] = "path.json"
        self.run["time"]["stop"] = live.reached
        (folder / "run.json").write_text(json.dumps(self.run, indent=2) + "\n")
        count = self._writer.count
        self._writer.finish(round(1e9 * live.reached))
        again = shlex.quote(str(folder / "again.h5"))
        lines = [f"tides simulate {shlex.quote(str(folder / 'run.json'))} -o {again}", f"python -m tides.play --hash {again}"]
        seconds = live.reached - self.start
        return {"folder": str(folder), "events": count, "seconds": seconds, "hash": event_hash(folder / "events.h5"), "lines": lines}


def _new_folder(out: Path) -> Path:
    name = time.strftime("tides-play-%Y%m%d-%H%M%S")
    for number in range(1000):
        folder = out / (name if number == 0 else f"{name}-{number}")
        try:
            folder.mkdir(parents=True)
            return folder.absolute()
        except FileExistsError:
            continue
    raise FileExistsError(f"{out / name}: a thousand recordings in one second")


def _told(name: str) -> dict[str, Any]:
    """The content of a preset file, by name or path."""
    return dict(json.loads(Path(name).read_text())) if name.endswith(".json") else preset(name)


def _within(value: Any, low: float, high: float, name: str) -> float:
    if not (isinstance(value, (int, float)) and low <= value <= high):
        raise ValueError(f"{name}: {value!r} isn't from {low:g} to {high:g}")
    return float(value)

