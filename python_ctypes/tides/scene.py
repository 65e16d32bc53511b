"""Scenes: sets of Gaussians, at rest, moving as rigid objects, or moving by themselves."""

from __future__ import annotations

import os
from ctypes import POINTER, byref, c_double, c_float, c_int32
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _api
from ._call import array, call, doubles, encoded, path, pointer, text
from ._handle import Handle
from ._library import lib
from ._values import Facts, choice, constants, plain
from ._warn import warn
from .files import check_apart
from .motion import Motion, give_means, means
from .trajectory import Trajectory, _given


_TRAINED = constants("TIDES_TRAINED_")


def _trained(number: int) -> str:
    return next(word for word, one in _TRAINED.items() if one == number)


_TRANSFER = {word: one for word, one in constants("TIDES_TRANSFER_").items() if one >= 0}


def _transfer(number: int) -> str:
    return text(lib.tides_transfer_name(number))


def scene_formats() -> list[Facts]:
    """The formats of scene files: endings (separated by blanks), summary, writes, losses (TIDES_LOSES_*)."""
    made, one = [], _api.tides_scene_format()
    while lib.tides_scene_format_at(len(made), byref(one)):
        made.append(plain(one))
    return made


@dataclass
class Gaussians:
    """Raw parameters, as trained, float32: mean (n x 3) [scene units], log_scale (n x 3) ln [scene units], quaternion (n x 4)
    wxyz, opacity_logit (n), sh (n x k x 3) with k = (degree + 1)^2, in INRIA's order and sign. float64 means stay float64
    if they are so far from 0 that float32 would lose digits that matter. trained: "unknown", "plain", "antialiased",
    "mixed". transfer, from composited colours to light: "linear", "srgb" or "gamma" with its exponent."""

    mean: np.ndarray
    log_scale: np.ndarray
    quaternion: np.ndarray
    opacity_logit: np.ndarray
    sh: np.ndarray
    trained: str = "unknown"
    transfer: str = "linear"
    gamma: float = 0.0

    def __post_init__(self) -> None:
        n = len(np.asarray(self.mean))
        choice("trained", self.trained, _TRAINED)
        choice("transfer", self.transfer, _TRANSFER)
        self.mean = means(self.mean, (n, 3))
        self.log_scale = array(self.log_scale, np.float32, (n, 3), "log_scale")
        self.quaternion = array(self.quaternion, np.float32, (n, 4), "quaternion")
        self.opacity_logit = array(self.opacity_logit, np.float32, (n,), "opacity_logit")
        self.sh = array(self.sh, np.float32, (n, None, 3), "sh")
        if self.sh.shape[1] not in (1, 4, 9, 16, 25):
            raise ValueError(f"sh: {self.sh.shape[1]} coefficients, where 1, 4, 9, 16 or 25 are needed")

    def __len__(self) -> int:
        return len(self.mean)

    @property
    def sh_degree(self) -> int:
        """Degree of the spherical harmonics, 0 to 4."""
        return round(self.sh.shape[1] ** 0.5) - 1

    @classmethod
    def from_colours(
        cls, mean: Any, scale: Any, rgb: Any, opacity: Any = 0.99, quaternion: Any = (1, 0, 0, 0)
    ) -> "Gaussians":
        """Gaussians of plain colours: mean (n x 3), scale [scene units] (n x 3, or one number), rgb (n x 3) linear, opacity in
        (0, 1) (n, or one number), quaternion (n x 4, or one)."""
        n = len(np.asarray(mean))
        if np.asarray(rgb).dtype.kind in "iu" and np.max(rgb, initial=0) > 1:
            raise ValueError(f"rgb: {np.asarray(rgb).dtype}, where linear light from 0 to 1 is needed; of sRGB's bytes: (rgb / 255) ** 2.2")
        opacity = np.broadcast_to(np.asarray(opacity, np.float64), (n,))
        band0 = 0.5 / np.sqrt(np.pi)  # constant of band 0: 3DGS has colour = band0 sh_0 + 1/2
        return cls(
            mean,
            np.log(np.broadcast_to(scale, (n, 3))),
            np.broadcast_to(quaternion, (n, 4)),
            np.log(opacity / (1 - opacity)),
            ((np.broadcast_to(rgb, (n, 3)) - 0.5) / band0)[:, None, :],
        )

    def _struct(self) -> _api.tides_gaussians:
        """The C struct; it points into this object's arrays."""
        arrays = (self.log_scale, self.quaternion, self.opacity_logit, self.sh)
        made = _api.tides_gaussians(len(self), self.sh_degree, _TRAINED[self.trained], None, *(pointer(one, c_float) for one in arrays))
        made.transfer, made.gamma = _TRANSFER[self.transfer], self.gamma
        give_means(made, self.mean)
        return made

    @classmethod
    def _copy(cls, struct: _api.tides_gaussians) -> "Gaussians":
        n, k = struct.count, (struct.sh_degree + 1) ** 2
        shapes = {"mean": (n, 3), "log_scale": (n, 3), "quaternion": (n, 4), "opacity_logit": (n,), "sh": (n, k, 3)}
        arrays = {name: np.ctypeslib.as_array(getattr(struct, name), shape).copy() for name, shape in shapes.items()}
        origin = np.array(struct.origin)
        if origin.any():
            arrays["mean"] = origin + arrays["mean"]
        return cls(**arrays, trained=_trained(struct.trained), transfer=_transfer(struct.transfer), gamma=struct.gamma)


@dataclass(frozen=True)
class SceneObject:
    """One object of a scene, copied: name; source, its file, or ""; gaussians; trajectory (None: at rest) and scale; motion,
    the model by which its Gaussians move (None: at rest); motion_range of the motion's own clock, and its duration_s [s];
    moving, the number of Gaussians that move by themselves; knots, the number of times at which their rates may jump."""

    name: str
    source: str
    gaussians: Gaussians
    trajectory: Trajectory | None
    scale: float
    motion: str | None
    motion_range: tuple[float, float] | None
    duration_s: float
    moving: int
    knots: int


class Scene(Handle):
    """What is looked at. Scene() is empty, Scene(file) holds what a file does (.ply, .spz, .ksplat, .splat, .splatv, .lcc, .lcc2, .sog, .glb, .h5,
    a trainer's folder). `len(scene)` is the number of objects. A scene doesn't change while a Renderer or Simulation uses it.

    Pickling stores the names of its files, which are read again, and objects that were added as values: a worker process
    gets a scene of its own. A `Motion` can't be pickled."""

    _destroy = "tides_scene_destroy"

    def __init__(
        self,
        file: str | os.PathLike[str] | None = None,
        trajectory: Trajectory | None = None,
        scale: float = 1.0,
        part: str | int | None = None,
        invalid: str = "error",
    ):
        made = POINTER(_api.tides_scene)()
        call("tides_scene_create", byref(made))
        super().__init__(made)
        self._callbacks: list[Any] = []  # functions of its motions, which must live as long as C uses the scene
        self._files: list[str] = []  # files that it was read from
        self._steps: list[tuple[str, tuple[Any, ...]]] | None = []  # calls that made it, for pickle; None: a session made it
        if file is not None:
            self.add_file(file, trajectory, scale, part, invalid)

    @classmethod
    def _of(cls, pointer: Any) -> "Scene":
        made = cls.__new__(cls)
        Handle.__init__(made, pointer)
        made._callbacks, made._files, made._steps = [], [], None
        return made

    def __reduce__(self) -> Any:
        self._pointer  # raises if the scene is closed
        steps = self._steps
        if steps is None:  # opened by a run: only objects at rest have values
            steps = [("add", (index, None)) for index in range(len(self))] + [("__setattr__", ("up", self.up))]
        return _remade, ([(name, self._values(*what) if name == "add" else what) for name, what in steps],)

    def _values(self, index: int, trajectory: Trajectory | None) -> tuple[Any, ...]:
        """The arguments of `add` for an object."""
        one = self[index]
        if one.motion:
            raise TypeError(
                f"this Scene can't be pickled: object {index} ({one.name!r}) moves by {one.motion}, which this scene has no "
                "file for. Pickle the Run that opens it, or save it as .h5 and open Scene(file)"
            )
        return one.gaussians, trajectory or one.trajectory, one.scale, one.name or None

    def _note(self, step: str, *what: Any) -> None:
        if self._steps is not None:
            self._steps.append((step, what))

    @staticmethod
    def is_file(file: str | os.PathLike[str]) -> bool:
        """Whether `add_file` would read a file as a scene."""
        return bool(lib.tides_scene_is_file(path(file)))

    def add(
        self,
        gaussians: Gaussians,
        trajectory: Trajectory | None = None,
        scale: float = 1.0,
        name: str | None = None,
        motion: Motion | None = None,
        duration_s: float = 0.0,
    ) -> int:
        """Adds a copy of `gaussians` as one object, and returns its number. p_world = scale R(t) p + position(t). A `motion`
        of these Gaussians is taken over; it lasts `duration_s` [s] (0: the length of its own clock)."""
        self._unused("changed")
        index = c_int32()
        rest = (trajectory._pointer if trajectory else None, scale, encoded(name), byref(index))
        with self._lock:
            if motion is None:
                call("tides_scene_add", self._pointer, gaussians._struct(), *rest)
            else:
                call("tides_scene_add_moving", self._pointer, gaussians._struct(), motion._pointer, duration_s, *rest)
                self._callbacks.append(motion._callback)
                motion._give_away()
        self._note("add", index.value, trajectory)
        return index.value

    def add_file(
        self,
        file: str | os.PathLike[str],
        trajectory: Trajectory | None = None,
        scale: float = 1.0,
        part: str | int | None = None,
        invalid: str = "error",
    ) -> None:
        """Adds a file's content, or a `part` of it: a glTF's scene, an .h5's object, a trained model's iteration, a streamed
        SOG's level. `invalid` Gaussians (NaN, infinite) are an "error", or "drop": they are left out and counted by
        `dropped`."""
        self._unused("changed")
        how = _api.tides_scene_options()
        lib.tides_scene_options_defaults(how)
        how.invalid = choice("invalid", invalid, constants("TIDES_INVALID_"))
        how.part = None if part is None else str(part).encode()
        with self._lock:
            before = self.notes
            call("tides_scene_read", self._pointer, path(file), how, trajectory._pointer if trajectory else None, scale)
        for note in self.notes[len(before) :]:
            warn(note)
        self._files.append(os.path.abspath(file))
        self._note("add_file", os.path.abspath(file), trajectory, scale, part, invalid)

    def append(
        self, index: int, times: Any, positions: Any, quaternions: Any, velocities: Any = None, angular_velocities: Any = None
    ) -> None:
        """Adds the next pose of object `index`, which has an open path (Trajectory.open). Simulations that use the scene see
        it at once."""
        samples = _given(times, positions, quaternions, velocities, angular_velocities)
        first = pointer(samples, _api.tides_pose_sample)
        with self._lock:
            call("tides_scene_append", self._pointer, index, first, len(samples))
        self._steps = None

    def set_duration(self, duration_s: float) -> int:
        """Makes the motions of all objects last `duration_s` [s]; returns their number."""
        self._unused("changed")
        if not duration_s > 0:
            raise ValueError(f"duration_s: {duration_s}, where a time above 0 is needed")
        self._note("set_duration", duration_s)
        return lib.tides_scene_set_duration(self._pointer, duration_s)

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes .h5 (everything), or one object at rest as .ply, .spz, .splat or .glb, with warnings for properties that the
        format lacks. A file that the scene was read from is refused."""
        check_apart(self._files, [file])
        call("tides_scene_save", self._pointer, path(file))
        lost = lib.tides_scene_losses(self._pointer, path(file))
        words = [word for word, bit in constants("TIDES_LOSES_").items() if lost & bit]
        if words:
            warn(f"{os.fspath(file)}: has no place for the scene's {', '.join(words)}")

    def __len__(self) -> int:
        return lib.tides_scene_objects(self._pointer)

    def __getitem__(self, index: int) -> SceneObject:
        if not 0 <= index < len(self):
            raise IndexError(f"object {index} of {len(self)}")
        one = _api.tides_object()
        call("tides_scene_object", self._pointer, index, one)
        return SceneObject(
            name=text(one.name),
            source=text(one.source),
            gaussians=Gaussians._copy(one.gaussians),
            trajectory=Trajectory._copy(one.trajectory) if one.trajectory else None,
            scale=one.scale,
            motion=text(lib.tides_motion_model(one.motion)) if one.motion else None,
            motion_range=_motion_range(one.motion) if one.motion else None,
            duration_s=one.duration_s,
            moving=lib.tides_motion_moving(one.motion, byref(one.gaussians)) if one.motion else 0,
            knots=lib.tides_motion_knots(one.motion) if one.motion else 0,
        )

    def gaussians_at(self, index: int, time: float) -> Gaussians:
        """Object `index`'s Gaussians at `time` [s], moved by its motion, in its own coordinates: before trajectory and
        scale."""
        one = _api.tides_object()
        call("tides_scene_object", self._pointer, index, one)
        n, k = one.gaussians.count, (one.gaussians.sh_degree + 1) ** 2
        shapes = {"mean": (n, 3), "log_scale": (n, 3), "quaternion": (n, 4), "opacity_logit": (n,), "sh": (n, k, 3)}
        arrays = {name: np.empty(shape) for name, shape in shapes.items()}
        theta = _api.tides_theta(**{name: pointer(one, c_double) for name, one in arrays.items()})
        call("tides_scene_gaussians_at", self._pointer, index, time, theta)
        how = (_trained(one.gaussians.trained), _transfer(one.gaussians.transfer), one.gaussians.gamma)
        return Gaussians(**arrays, trained=how[0], transfer=how[1], gamma=how[2])

    @property
    def count(self) -> int:
        """Number of Gaussians in all objects."""
        return lib.tides_scene_count(self._pointer)

    @property
    def sh_degree(self) -> int:
        """The largest degree of all objects."""
        return lib.tides_scene_sh_degree(self._pointer)

    @property
    def trained(self) -> str:
        """How the objects were trained that tell it, which decides how they are drawn: "unknown", "plain", "antialiased"
        (mip-splatting's compensated opacities), "mixed". ImageParams(antialias="file") uses it."""
        return _trained(lib.tides_scene_trained(self._pointer))

    @property
    def transfer(self) -> str:
        """The transfer from composited colours to light, of all objects: "linear", "srgb", or "gamma" with the objects'
        exponent. ImageParams(transfer="file") uses it. BadConfig if objects differ."""
        transfer, gamma = c_int32(), c_double()
        call("tides_scene_transfer", self._pointer, byref(transfer), byref(gamma))
        return _transfer(transfer.value)

    @property
    def dropped(self) -> int:
        """Number of Gaussians that were left out of its files (add_file's `invalid`)."""
        return lib.tides_scene_dropped(self._pointer)

    @property
    def notes(self) -> list[str]:
        """Notes on the scene's files, such as content that was left out."""
        return text(lib.tides_scene_notes(self._pointer)).splitlines()

    @property
    def range(self) -> tuple[float, float]:
        """The times that all objects cover [s]; -inf and inf where all are at rest."""
        start, stop = c_double(), c_double()
        lib.tides_scene_range(self._pointer, byref(start), byref(stop))
        return start.value, stop.value

    def orbit(self, up: Any = None, field_of_view: float = 0.8) -> Trajectory:
        """A camera path for a scene without one: around a thing, as large as fits into `field_of_view` [rad]; or inside a
        place, at a distance within which half of it lies. One turn takes 12 s, from 0 to 12 s. Default of `up` (3): the
        scene's, or a guess: -y, or z if the scene lies flat across it."""
        found = _api.tides_orbit()
        call("tides_scene_orbit", self._pointer, None if up is None else doubles(up, 3, "up"), field_of_view, byref(found))
        return Trajectory.orbit(**{name: list(v) if hasattr(v := getattr(found, name), "__len__") else v for name, _ in found._fields_})

    @property
    def up(self) -> tuple[float, float, float] | None:
        """The direction up (3), from the scene's first file or as set; None if unknown. `orbit` uses it, and .h5 and .ply
        store it."""
        found = (c_double * 3)()
        return tuple(found) if lib.tides_scene_up(self._pointer, found) else None

    @up.setter
    def up(self, up: Any) -> None:
        with self._lock:
            call("tides_scene_set_up", self._pointer, None if up is None else doubles(up, 3, "up"))
        self._note("__setattr__", "up", up)

    def bounds_at(self, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner (3) of the box around the means at `time` [s]."""
        lower, upper = (c_double * 3)(), (c_double * 3)()
        call("tides_scene_bounds_at", self._pointer, time, lower, upper)
        return np.array(lower), np.array(upper)

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner (3) [scene units] of the box around the means, with objects at their start."""
        lower, upper = (c_double * 3)(), (c_double * 3)()
        lib.tides_scene_bounds(self._pointer, lower, upper)
        return np.array(lower), np.array(upper)

    def __repr__(self) -> str:
        return "Scene(closed)" if self.closed else f"Scene({len(self)} objects, {self.count} Gaussians)"


def _remade(steps: list[tuple[str, tuple[Any, ...]]]) -> Scene:
    """Unpickles a scene, by the calls that made it."""
    scene = Scene()
    for name, what in steps:
        getattr(scene, name)(*what)
    return scene


def _motion_range(motion: Any) -> tuple[float, float]:
    start, stop = c_double(), c_double()
    lib.tides_motion_range(motion, byref(start), byref(stop))
    return start.value, stop.value
