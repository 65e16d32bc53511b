"""Runs whose camera and objects get their poses during the run: robots, agents, closed loops."""

from __future__ import annotations

import math
from ctypes import POINTER, byref, c_int32, c_size_t, cast
from typing import Any, Iterable

import numpy as np

from . import _api
from ._call import call, pointer, text
from ._handle import Handle
from ._library import lib
from ._progress import Progress, Reporter
from ._values import Facts, Value, plain
from .device import Device
from .events import EVENT
from .session import Session
from .simulate import packet
from .trajectory import _SAMPLE, Pose, Trajectory

_CAMERA = _api.TIDES_LIVE_CAMERA
_NOT_GIVEN = c_size_t(-1).value


class LiveOptions(Value, _api.tides_live_options):
    """Options of a live run: camera (1: its poses are given), stop [s], most_speed [scene units/s], most_turn_rate [rad/s],
    keep."""

    _defaults = "tides_live_options_defaults"


class Live(Handle):
    """A run that doesn't know its future. It begins where the run's camera is at time.start; each step tells where the camera is
    next, and gives what fired on the way there:

        with tides.Live("room.json", {"stepping.step_s": 1e-3}) as live:
            while live.time < 10:
                events = live.step(my_robot.pose(), 1e-3)

    A pose is (position, quaternion), with (.., velocity, angular_velocity) behind where they are known; a 4 x 4 matrix, body to
    world; or a Pose. Between poses the path is the cubic with their rates (those that aren't given are taken from the poses
    before). To the bit these are the events of a Simulation whose camera is `path()`: make that with keep=True.

    Events come by whole steps of the run, stepping.step_s: make that `dt`, or a part of it. `objects` (names or numbers) get poses,
    too; with camera=False they alone do. A pose faster than `max_speed` [scene units/s] or `max_turn_rate`
    [rad/s] is refused as a jump."""

    _destroy = "tides_live_close"

    def __init__(
        self,
        run: Any,
        set: dict[str, Any] | None = None,
        *,
        camera: bool = True,
        objects: Iterable[str | int] = (),
        stop: float | None = None,
        max_speed: float = 0.0,
        max_turn_rate: float = 0.0,
        keep: bool = False,
        device: Device | str | int | None = None,
        progress: Progress = None,
    ):
        """`run`: a run file, a Run, or a Session, which several live runs may share. `stop` [s]: the run's end, with the last
        step (None: no end)."""
        if isinstance(run, Session):
            session = run.vary(set) if set else run
        else:
            session = Session(run, set, device)
        if session.sees_frames:
            raise ValueError(f"method {session.values.method!r} on frames can't run live: set method to 'tides', and a scene")
        self.session, self._objects = session, {}
        for one in [objects] if isinstance(objects, (str, int)) else objects:
            self._objects[one] = self._number(one)
        numbers = (c_int32 * max(1, len(self._objects)))(*self._objects.values())
        options = LiveOptions(
            camera=int(camera),
            object_count=len(self._objects),
            stop=math.nan if stop is None else stop,
            most_speed=max_speed,
            most_turn_rate=max_turn_rate,
            keep=int(keep),
        )
        options.objects = cast(numbers, POINTER(c_int32))
        made = POINTER(_api.tides_live)()
        with session._lock, Reporter(progress) as step:
            call("tides_live_open", session._pointer, options, step, None, byref(made))
        super().__init__(made, session, lock=session._lock)
        self._camera = bool(camera)
        self._at = session.values.start, 0.0, 0.0
        self._waiting = np.empty(0, EVENT)  # events of a call that a signal's exception interrupted

    def _number(self, one: str | int) -> int:
        names = []
        for index in range(len(self.session.scene)):
            facts = _api.tides_object()
            call("tides_scene_object", self.session.scene._pointer, index, facts)
            names.append(text(facts.name))
        if isinstance(one, str):
            if names.count(one) != 1:
                raise ValueError(f"objects: {names.count(one)} of the scene's are called {one!r}; it has {', '.join(map(repr, names))}")
            return names.index(one)
        return int(one)

    # -- steps ------------------------------------------------------------------------------------------------------
    def step(self, pose: Any = None, dt: float | None = None, objects: dict[str | int, Any] | None = None) -> np.ndarray:
        """Sets where the camera (`pose`) and `objects` ({name: pose}) are `dt` seconds later, advances to there, and returns
        the events since the last step, as EVENT (n). A camera or an object whose path is known further ahead may be left
        out. BadArgument, OutOfRange: NaN, a step of no time or back, half a turn, a jump, an object that isn't live. Then
        nothing changes, and the step may be repeated. If a call raises otherwise, Ctrl-C included, its events come with the
        next successful one, such as `run(live.reached)`."""
        if dt is None:
            raise TypeError("step: dt, the time [s] to the pose, must be given: live.step(pose, 1e-3)")
        if not (dt > 0 and math.isfinite(dt)):
            raise ValueError(f"dt: {dt}, where a time above 0 s is needed: a run goes forward")
        start, elapsed, rest = self._at
        elapsed, rest = _sum(elapsed, rest, dt)
        time = start + (elapsed + rest)
        told = ([] if pose is None else [(self._camera_told(), _sample(pose, time))]) + [
            (self._told(name), _sample(one, time)) for name, one in (objects or {}).items()
        ]
        numbers = (c_int32 * max(1, len(told)))(*(number for number, _ in told))
        samples = np.concatenate([sample for _, sample in told]) if told else np.zeros(1, _SAMPLE)
        arguments = (numbers, pointer(samples, _api.tides_pose_sample), len(told), time)
        return self._events("tides_live_step", arguments, (start, elapsed, rest))

    def tell(self, pose: Any, time: float, object: str | int | None = None) -> None:
        """Sets where the camera, or an object, is at `time` [s], which may be far ahead. The first pose is that of the run's
        start."""
        number, sample = self._camera_told() if object is None else self._told(object), _sample(pose, time)
        with self._lock:
            call("tides_live_tell", self._pointer, number, pointer(sample, _api.tides_pose_sample), 1)

    def run(self, until: float) -> np.ndarray:
        """Advances to `until` [s]. Returns the events since the last call, as EVENT (n), sorted by (t, y, x, p)."""
        return self._events("tides_live_run", (until,), (float(until), 0.0, 0.0))

    def finish(self) -> np.ndarray:
        """Ends the run at `reached`. Returns the events that a readout still held, as EVENT (n). All events together equal
        those of a run whose time.stop is `reached`."""
        return self._events("tides_live_finish", (), (self.reached, 0.0, 0.0))

    def _events(self, function: str, arguments: tuple[Any, ...], at: tuple[float, float, float]) -> np.ndarray:
        """Events that wait from an interrupted call, and those of `function`, which advances to `at`."""
        events, count = POINTER(_api.tides_event)(), c_size_t(_NOT_GIVEN)
        with self._lock:
            try:
                call(function, self._pointer, *arguments, byref(events), byref(count))
            finally:
                if count.value != _NOT_GIVEN:
                    self._at, self._waiting = at, np.concatenate([self._waiting, packet(events, count.value)])
            given, self._waiting = self._waiting, np.empty(0, EVENT)
            return given

    def _camera_told(self) -> int:
        if not self._camera:
            raise ValueError("the camera follows the run's path here: leave its pose out, or make it Live(..., camera=True)")
        return _CAMERA

    def _told(self, name: str | int) -> int:
        if name not in self._objects:
            raise ValueError(f"object {name!r} gets no poses in this run: make it Live(..., objects=[{name!r}])")
        return self._objects[name]

    # -- state ------------------------------------------------------------------------------------------------------
    @property
    def time(self) -> float:
        """The time of the last pose that it was advanced to [s]."""
        start, elapsed, rest = self._at
        return start + (elapsed + rest)

    @property
    def reached(self) -> float:
        """The end of the last whole step [s]. Events up to there were returned, or come with the next call."""
        with self._lock:
            return lib.tides_live_reached(self._pointer)

    @property
    def stats(self) -> Facts:
        """Statistics so far, with the fields of `tides simulate --stats`."""
        stats = _api.tides_stats()
        with self._lock:
            lib.tides_simulator_stats(lib.tides_live_simulator(self._pointer), byref(stats))
        return plain(stats)

    def path(self, object: str | int | None = None) -> Trajectory:
        """A copy of the camera's open path, or an object's, as far as it is kept; with keep=True all of it."""
        number = _CAMERA if object is None else self._told(object)
        with self._lock:
            path = lib.tides_live_path(self._pointer, number)
            if not path:
                raise ValueError("the camera follows the run's path here: session.camera has it")
            return Trajectory._copy(path)


def _sum(whole: float, rest: float, more: float) -> tuple[float, float]:
    """whole + rest + more as a sum and its rounding error, so that a thousand steps of 0.001 end at 1."""
    made = whole + more
    lost = (whole - (made - (made - whole))) + (more - (made - whole))
    return made, rest + lost


def _sample(pose: Any, time: float) -> np.ndarray:
    """A pose as a tides_pose_sample (1)."""
    sample = np.zeros(1, _SAMPLE)
    sample["time"] = time
    if isinstance(pose, Pose):
        parts: Any = (pose.position, _quaternion(pose.rotation), pose.position_dot, _angular(pose))
    elif isinstance(pose, np.ndarray) and pose.shape == (4, 4):
        parts = (pose[:3, 3], _quaternion(pose[:3, :3]))
    else:
        parts = pose
    try:
        values = [np.asarray(part, np.float64) for part in parts]
    except (TypeError, ValueError):
        values = []
    if len(values) not in (2, 4) or any(one.shape != (4 if k == 1 else 3,) for k, one in enumerate(values)):
        raise ValueError(
            "a pose is (position (3), quaternion (4, wxyz)), with (.., velocity (3), angular velocity (3)) behind, a 4 x 4 matrix, "
            f"or a Pose; this is {pose!r}"
        )
    if not all(np.isfinite(one).all() for one in values):
        raise ValueError(f"a pose has finite numbers; this is {pose!r}")
    for name, value in zip(("position", "quaternion", "velocity", "angular_velocity"), values):
        sample[name] = value
    sample["has_rates"] = int(len(values) == 4)
    return sample


def _quaternion(rotation: np.ndarray) -> np.ndarray:
    """Quaternion wxyz of a rotation matrix: the eigenvector of the largest eigenvalue of Bar-Itzhack's matrix (2000)."""
    r = np.asarray(rotation, np.float64)
    if not np.allclose(r @ r.T, np.eye(3), atol=1e-6) or np.linalg.det(r) < 0:
        raise ValueError("a pose's matrix must begin with a rotation: orthonormal, of determinant 1")
    k = np.empty((4, 4))
    k[0] = np.trace(r), r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
    k[:, 0] = k[0]
    k[1:, 1:] = r + r.T - np.trace(r) * np.eye(3)
    q = np.linalg.eigh(k)[1][:, -1]
    return q if q[0] >= 0 else -q


#: Rotations wxyz from camera axes of other systems to TIDES', OpenCV's (x right, y down, z forward).
CAMERA_AXES = {
    "opencv": (1.0, 0.0, 0.0, 0.0),
    "opengl": (0.0, 1.0, 0.0, 0.0),  # x right, y up, looks along -z: MuJoCo, USD and so Isaac, Genesis, Blender
    "robot": (0.5, -0.5, 0.5, -0.5),  # x forward, y left, z up: Gazebo's sensors, ROS' bodies
}


def camera_quaternion(quaternion: Any, axes: str) -> np.ndarray:
    """The quaternion (wxyz, camera to world) for TIDES of a camera with the axes `axes`, a key of CAMERA_AXES. Position,
    velocity and angular velocity are in world axes, and don't change."""
    if axes not in CAMERA_AXES:
        raise ValueError(f"axes: {axes!r} is none of {', '.join(CAMERA_AXES)}")
    a, b = np.asarray(quaternion, np.float64), np.array(CAMERA_AXES[axes])
    if a.shape != (4,):
        raise ValueError(f"quaternion: {quaternion!r}, where four numbers (wxyz) are needed")
    return np.array([a[0] * b[0] - a[1:] @ b[1:], *(a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:]))])


def _angular(pose: Pose) -> np.ndarray:
    """Angular velocity, in world axes, of a pose and its rate: the vector of the cross product R_dot R^T."""
    turning = pose.rotation_dot @ pose.rotation.T
    return np.array([turning[2, 1] - turning[1, 2], turning[0, 2] - turning[2, 0], turning[1, 0] - turning[0, 1]]) / 2
