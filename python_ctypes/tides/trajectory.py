"""Paths of cameras and objects: poses over time with exact rates; and cameras, a path with a lens."""

from __future__ import annotations

import math
import os
from ctypes import POINTER, byref, c_double, c_float
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _api
from ._call import array, call, doubles, given, instance, path, pointer, text
from ._handle import Handle
from ._library import lib
from ._values import Value, _fields, filled
from ._warn import warn
from .files import check_apart

_SAMPLE = np.dtype(_api.tides_pose_sample)
_SHOWN: Any = [name for name, _ in _fields(_api.tides_pose_sample)]
_UP = (0.0, 1.0, 0.0)


#: Measurements of an IMU (Trajectory.imu): time [s], angular_rate [rad/s], specific_force [m/s^2], and the biases in them.
IMU_SAMPLE = np.dtype(
    [("time", "f8")]
    + [(name, "f8", 3) for name in ("angular_rate", "specific_force", "gyroscope_bias", "accelerometer_bias")]
)


class Imu(Value, _api.tides_imu):
    """An IMU with a path's axes: rate_hz, gravity [m/s^2], down (3), metres_per_unit; gyroscope_noise [rad/s/sqrt(Hz)],
    accelerometer_noise [m/s^2/sqrt(Hz)], gyroscope_walk, accelerometer_walk, gyroscope_bias (3), accelerometer_bias (3), seed."""

    _defaults, _groups = "tides_imu_defaults", ("imu.",)


@dataclass(frozen=True)
class Pose:
    """Pose and rate at one time: p_world = rotation p_body + position. rotation (3 x 3), position (3) [scene units], rotation_dot
    (3 x 3) [1/s], position_dot (3) [scene units/s]."""

    rotation: np.ndarray
    position: np.ndarray
    rotation_dot: np.ndarray
    position_dot: np.ndarray


class Trajectory(Handle):
    """A rigid motion over time. Positions (n x 3) follow a C2 cubic spline through `times` (n) [s], rotations (quaternions,
    n x 4, wxyz, body to world) a smooth curve; with velocities (n x 3) [scene units/s] and angular velocities (n x 3)
    [rad/s, world axes] the curves go through those too. A camera's body axes are OpenCV's: x right, y down, z forward.
    Pickled are its samples."""

    _destroy = "tides_trajectory_destroy"
    _mount: tuple[Any, ...] = ()  # the path on which this one is mounted, and the mounting

    def __init__(
        self,
        times: Any,
        positions: Any,
        quaternions: Any,
        velocities: Any = None,
        angular_velocities: Any = None,
    ):
        self._create(_given(times, positions, quaternions, velocities, angular_velocities))

    def _create(self, samples: np.ndarray, how: str = "tides_trajectory_create") -> None:
        made = POINTER(_api.tides_trajectory)()
        first = pointer(samples, _api.tides_pose_sample)
        call(how, first, len(samples), byref(made))
        Handle.__init__(self, made)

    def __repr__(self) -> str:
        if self.closed:
            return "Trajectory, closed"
        start, stop = self.range
        return f"Trajectory of {len(self)} poses, {start:g} to {stop:g} s"

    @classmethod
    def _of(cls, pointer: Any) -> "Trajectory":
        made = cls.__new__(cls)
        Handle.__init__(made, pointer)
        return made

    @classmethod
    def _copy(cls, pointer: Any) -> "Trajectory":
        """A copy of a path that something else owns."""
        return cls._created(_samples(pointer), bool(lib.tides_trajectory_is_open(pointer)))

    @classmethod
    def _created(cls, samples: np.ndarray, is_open: bool = False) -> "Trajectory":
        made = cls.__new__(cls)
        made._create(samples, "tides_trajectory_create_open" if is_open else "tides_trajectory_create")
        return made

    @classmethod
    def _generate(cls, name: str, *arguments: Any) -> "Trajectory":
        made = POINTER(_api.tides_trajectory)()
        call(f"tides_trajectory_create_{name}", *arguments, byref(made))
        return cls._of(made)

    @classmethod
    def open(
        cls, times: Any, positions: Any, quaternions: Any, velocities: Any = None, angular_velocities: Any = None
    ) -> "Trajectory":
        """A path that is extended during a run, by `append`. Between samples it is the cubic with their rates; rates that
        aren't given come from samples before. So appending changes no earlier part. `Live` makes its own."""
        return cls._created(_given(times, positions, quaternions, velocities, angular_velocities), True)

    def append(
        self, times: Any, positions: Any, quaternions: Any, velocities: Any = None, angular_velocities: Any = None
    ) -> None:
        """Adds later samples to an open path."""
        samples = _given(times, positions, quaternions, velocities, angular_velocities)
        first = pointer(samples, _api.tides_pose_sample)
        with self._lock:
            call("tides_trajectory_append", self._pointer, first, len(samples))

    def forget(self, time: float) -> None:
        """Lets an open path drop samples that it doesn't need from `time` [s] on."""
        with self._lock:
            lib.tides_trajectory_forget(self._pointer, time)

    @property
    def is_open(self) -> bool:
        """Whether it is an open path, which can be extended."""
        return bool(lib.tides_trajectory_is_open(self._pointer))

    @classmethod
    def static(cls, position: Any, quaternion: Any = (1, 0, 0, 0)) -> "Trajectory":
        """A pose that never changes."""
        place = (doubles(position, 3, "position"), doubles(quaternion, 4, "quaternion"))
        return cls._generate("static", *place)

    @classmethod
    def orbit(
        cls,
        target: Any = (0, 0, 0),
        radius: float = 1.0,
        angular_speed: float = 1.0,
        start: float = 0.0,
        stop: float = 1.0,
        height: float = 0.0,
        start_angle: float = 0.0,
        up: Any = _UP,
    ) -> "Trajectory":
        """A camera on a circle about `target` in the plane normal to `up`, looking at it. [scene units], [rad], [rad/s],
        [s]."""
        places = {"target": doubles(target, 3, "target"), "up": doubles(up, 3, "up"), "height": height}
        turn = {"radius": radius, "start_angle": start_angle, "angular_speed": angular_speed, "start": start, "stop": stop}
        return cls._generate("orbit", filled(_api.tides_orbit, **places, **turn))

    @classmethod
    def dolly(
        cls, start_at: Any, stop_at: Any, target: Any, start: float = 0.0, stop: float = 1.0, up: Any = _UP
    ) -> "Trajectory":
        """A camera on the line from `start_at` to `stop_at` [scene units], looking at `target`, from `start` to `stop` [s]."""
        line = {"from": doubles(start_at, 3, "start_at"), "to": doubles(stop_at, 3, "stop_at")}
        places = {"target": doubles(target, 3, "target"), "up": doubles(up, 3, "up")}
        return cls._generate("dolly", filled(_api.tides_dolly, **line, **places, start=start, stop=stop))

    @classmethod
    def handheld(
        cls,
        position: Any,
        target: Any,
        position_amplitude: float = 0.01,
        rotation_amplitude: float = 0.01,
        frequency: float = 1.0,
        seed: int = 0,
        start: float = 0.0,
        stop: float = 1.0,
        up: Any = _UP,
    ) -> "Trajectory":
        """A camera held by hand: amplitudes are rms per axis [scene units], [rad]; `frequency` [Hz] of the slowest sine."""
        named = {"position": position, "target": target, "up": up}
        places = {name: doubles(one, 3, name) for name, one in named.items()}
        shake = {"position_amplitude": position_amplitude, "rotation_amplitude": rotation_amplitude, "frequency": frequency}
        return cls._generate("handheld", filled(_api.tides_handheld, **places, **shake, seed=seed, start=start, stop=stop))

    @classmethod
    def load(cls, file: str | os.PathLike[str], **options: Any) -> "Trajectory":
        """The path in a file of any known format; `options` are those of Camera.load."""
        return Camera.load(file, **options).trajectory

    def mounted(self, position: Any, quaternion: Any = (1, 0, 0, 0)) -> "Trajectory":
        """The path of something mounted on this body: p_body = R(quaternion) p_mounted + position [scene units]."""
        place = (doubles(position, 3, "position"), doubles(quaternion, 4, "quaternion"))
        made = self._generate("mounted", self._pointer, *place)
        made._mount = (self, tuple(place[0]), tuple(place[1]))
        return made

    def __reduce__(self) -> Any:
        if self._mount:
            return Trajectory.mounted, self._mount
        samples = _samples(self._pointer)
        copy = Trajectory._created(samples, self.is_open)
        if not np.array_equal(_samples(copy._pointer), samples):  # copying normalises quaternions again
            raise TypeError(
                "this Trajectory can't be pickled: its samples don't say it to the bit. Pickle the Run or the rig's path "
                "that it came from"
            )
        return Trajectory._created, (samples, self.is_open)

    def at(self, time: float) -> Pose:
        """Pose and rates at `time` [s]. OutOfRange outside `range`."""
        pose = _api.tides_pose()
        call("tides_trajectory_at", self._pointer, time, pose)
        rotation, rotation_dot = (np.array(one).reshape(3, 3) for one in (pose.rotation, pose.rotation_dot))
        return Pose(rotation, np.array(pose.position), rotation_dot, np.array(pose.position_dot))

    def acceleration(self, time: float) -> np.ndarray:
        """Acceleration (3) of the body's origin at `time` [scene units/s^2], in world axes. Unsupported for a path that is
        only C1."""
        made = (c_double * 3)()
        call("tides_trajectory_acceleration", self._pointer, time, made)
        return np.array(made)

    def imu(self, imu: Imu, start: float, stop: float) -> np.ndarray:
        """Measurements of an IMU on the body from `start` to `stop` [s] (IMU_SAMPLE)."""
        samples = np.zeros(lib.tides_imu_count(imu, start, stop), IMU_SAMPLE)
        made = pointer(samples, _api.tides_imu_sample)
        call("tides_trajectory_imu", self._pointer, imu, start, len(samples), made)
        return samples

    @property
    def range(self) -> tuple[float, float]:
        """First and last time [s]; -inf and inf for a pose that never changes."""
        start, stop = c_double(), c_double()
        lib.tides_trajectory_range(self._pointer, byref(start), byref(stop))
        return start.value, stop.value

    @property
    def is_static(self) -> bool:
        """Whether the pose never changes."""
        return bool(lib.tides_trajectory_is_static(self._pointer))

    def __len__(self) -> int:
        return lib.tides_trajectory_count(self._pointer)

    @property
    def samples(self) -> np.ndarray:
        """A copy of the samples (n): fields time, position, quaternion, velocity, angular_velocity, has_rates."""
        return _samples(self._pointer)[_SHOWN]


def _given(times: Any, positions: Any, quaternions: Any, velocities: Any, angular_velocities: Any) -> np.ndarray:
    """Samples for C, from arrays."""
    times = array(times, np.float64, (None,), "times")
    samples = np.zeros(len(times), _SAMPLE)
    samples["time"] = times
    samples["position"] = array(positions, np.float64, (len(times), 3), "positions")
    samples["quaternion"] = array(quaternions, np.float64, (len(times), 4), "quaternions")
    if (velocities is None) != (angular_velocities is None):
        raise ValueError("velocities and angular_velocities: give both or none")
    if velocities is not None:
        samples["velocity"] = array(velocities, np.float64, (len(times), 3), "velocities")
        samples["angular_velocity"] = array(angular_velocities, np.float64, (len(times), 3), "angular_velocities")
        samples["has_rates"] = 1
    return samples


def _samples(trajectory: Any) -> np.ndarray:
    count = lib.tides_trajectory_count(trajectory)
    samples = np.zeros(count, _SAMPLE)
    for index in range(count):
        one = pointer(samples[index : index + 1], _api.tides_pose_sample)
        call("tides_trajectory_sample", trajectory, index, one)
    return samples


def lens_names() -> list[str]:
    """Names of lens models, for Lens and camera.lens: "none", "radtan" ..."""
    names: list[str] = []
    while (name := lib.tides_lens_name(len(names))) is not None:
        names.append(text(name))
    return names


class Lens(Value, _api.tides_lens):
    """Lens distortion: model ("none", "radtan", "equidistant") and its coefficients k1, k2, k3, k4, p1, p2."""

    _words = {"model": "TIDES_LENS_"}


class Intrinsics(Value, _api.tides_intrinsics):
    """A camera: width, height [px]; fx, fy, cx, cy [px]; lens (a Lens; default: a pinhole). u = fx x/z + cx; the centre of
    pixel (0, 0) is at (0.5, 0.5)."""

    lens: Any = property(
        lambda self: Lens._from(_api.tides_intrinsics.lens.__get__(self)),
        lambda self, lens: _api.tides_intrinsics.lens.__set__(self, lens),
        doc="How lines bend: a Lens; all zeros is a pinhole.",
    )

    def rectify_map(self, rectified: "Intrinsics | None" = None, rotation: Any = None) -> np.ndarray:
        """The place of each pixel in the image of the pinhole `rectified` (default: this camera without its lens), turned by
        the 3x3 `rotation`: (height, width, 2) of float32. Pixel centres are whole numbers, as in OpenCV and DSEC."""
        made = np.empty((self.height, self.width, 2), np.float32)
        turned = None if rotation is None else (c_double * 9)(*np.ravel(rotation))
        call("tides_rectify_map", self, rectified or self.copy(lens=Lens()), turned, made.ctypes.data_as(POINTER(c_float)))
        return made

    def save_rectify_map(self, file: str | os.PathLike[str], rectified: "Intrinsics | None" = None, rotation: Any = None) -> None:
        """Writes rectify_map as a .npy file."""
        turned = None if rotation is None else (c_double * 9)(*np.ravel(rotation))
        call("tides_rectify_save", path(file), self, rectified or self.copy(lens=Lens()), turned)

    @classmethod
    def from_fov(cls, width: int, height: int, fov_x: float) -> "Intrinsics":
        """A centred lens with square pixels that sees `fov_x` [rad] across, above 0 and below pi."""
        if not 0 < fov_x < math.pi:
            hint = f": radians are needed; {fov_x:g} degrees are math.radians({fov_x:g})" if math.pi <= fov_x < 180 else ""
            raise ValueError(f"fov_x: {fov_x:g} isn't between 0 and pi{hint}")
        f = 0.5 * width / math.tan(0.5 * fov_x)
        return cls(width=width, height=height, fx=f, fy=f, cx=0.5 * width, cy=0.5 * height)


class PathOptions(Value, _api.tides_path_options):
    """How a path file is read: duration [s] of files without times, time_unit of those with times ("auto", "s",
    "ms", "us", "ns", "index"), start [s], rebase, raw_positions, views ("0:100:10": which poses to keep)."""

    _defaults = "tides_path_options_defaults"
    _words = {"time_unit": "TIDES_TIME_"}


class Camera:
    """A path and a lens: Camera(trajectory, intrinsics), or with the lens' numbers: Camera(trajectory, width=346, ...)."""

    def __init__(self, trajectory: Trajectory, intrinsics: Intrinsics | None = None, **lens: Any):
        self.trajectory = instance(trajectory, Trajectory, "Camera: trajectory")
        self.intrinsics = given(intrinsics, Intrinsics, "Camera: intrinsics").copy(**lens)
        self.format, self.distorted, self.field_of_view_x = "", False, 0.0  # facts of the file, if it came from one
        self._files: list[str] = []  # files that it was read from
        self.notes: list[str] = []  # notes on that file; also warnings when it is read

    @classmethod
    def load(cls, file: str | os.PathLike[str], lens: dict[str, Any] | None = None, **options: Any) -> "Camera":
        """Reads a path file of any known format. `lens` replaces the file's intrinsics; `options` are the fields of
        PathOptions."""
        made = _api.tides_path()
        call("tides_path_load", path(file), PathOptions(**options), made)
        camera = cls(Trajectory._of(made.trajectory), Intrinsics._from(made.intrinsics), **(lens or {}))
        camera.format, camera.distorted = text(made.format), bool(made.distorted)
        camera.field_of_view_x = made.field_of_view_x
        camera._files.append(os.path.abspath(file))
        camera.notes = text(made.notes).splitlines()
        if made.untimed and "duration" not in options:
            lasts = f"{len(camera.trajectory)} poses are spread evenly over 1 s; duration says how long they last"
            camera.notes.append(f"has no times: its {lasts}")
        for line in camera.notes:
            warn(f"{os.fspath(file)}: {line}")
        return camera

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes the path and the lens as TIDES' JSON. The file that it was read from is refused."""
        check_apart(self._files, [file])
        call("tides_path_save", path(file), self.trajectory._pointer, self.intrinsics)

    def __repr__(self) -> str:
        return f"Camera({len(self.trajectory)} samples, {self.intrinsics!r})"
