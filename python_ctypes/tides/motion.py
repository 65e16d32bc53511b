"""Motions of Gaussians by themselves: models of dynamic splatting methods, and functions of the user's."""

from __future__ import annotations

from ctypes import POINTER, byref, c_double, c_float
from types import SimpleNamespace
from typing import Any, Callable

import numpy as np

from . import _api
from ._call import array, call, kept, pointer, text
from ._handle import Handle
from ._library import lib
from ._values import choice, constants

#: Fills theta's arrays at `time`: function(time, side, index, theta). index (n) are the Gaussians; theta.mean (n x 3),
#: log_scale (n x 3), quaternion (n x 4), opacity_logit (n), sh (n x k x 3) or None, and the rates mean_dot ... per unit of time
#: are arrays to write into; they come with the Gaussians' own parameters and rates of 0.
MotionFunction = Callable[[float, int, np.ndarray, SimpleNamespace], Any]

_ROWS = {"mean": (3,), "log_scale": (3,), "quaternion": (4,), "opacity_logit": ()}
_DECODERS = constants("TIDES_DECODER_")


def _floats(struct: Any, **arrays: tuple[Any, tuple[int | None, ...]]) -> list[np.ndarray]:
    """Puts arrays (value, shape) into a struct's float pointers. The caller must keep the returned arrays until the call is
    over."""
    made = []
    for name, (value, shape) in arrays.items():
        if value is not None:
            made.append(array(value, np.float32, shape, name))
            setattr(struct, name, pointer(made[-1], c_float))
    return made


def means(value: Any, shape: tuple[int | None, ...]) -> np.ndarray:
    """Means as float32. Float64 means stay float64 if they are so far from 0 that rounding would lose more than a millionth of
    the middle half's width."""
    if getattr(value, "dtype", None) == np.float64:
        wide = array(value, np.float64, shape, "mean")
        rows = wide.reshape(-1, 3)
        if len(rows) and np.isfinite(rows).all():
            low, high = np.quantile(rows, (0.25, 0.75), axis=0)
            with np.errstate(over="ignore"):
                lost = np.abs(rows - rows.astype(np.float32)).max()
            if lost > 1e-6 * (high - low).max():
                return wide
    return array(value, np.float32, shape, "mean")


def give_means(struct: Any, mean: np.ndarray) -> None:
    """Puts means into a struct's `mean` or `mean_double`; the caller must keep them until the call is over."""
    if mean.dtype == np.float64:
        struct.mean_double = pointer(mean, c_double)
    else:
        struct.mean = pointer(mean, c_float)


class Motion(Handle):
    """A motion of `count` Gaussians in its own time. `Scene.add(gaussians, motion=...)` takes it over."""

    _destroy = "tides_motion_destroy"

    def __init__(self, pointer: Any, callback: Any = None):
        super().__init__(pointer)
        self._callback = callback

    @classmethod
    def _make(cls, kind: str, struct: Any, callback: Any = None) -> "Motion":
        made = POINTER(_api.tides_motion)()
        call(f"tides_motion_create_{kind}", struct, byref(made))
        return cls(made, callback)

    @classmethod
    def polynomial(
        cls,
        opacity_centre: Any,
        opacity_log_width: Any,
        mean_coefficient: Any,
        quaternion_dot: Any,
        start: float = 0.0,
        stop: float = 1.0,
        plain_colour: bool = False,
        decoder: str | int = "none",
        feature: Any = None,
        feature_dot: Any = None,
        decoder_first: Any = None,
        decoder_second: Any = None,
    ) -> "Motion":
        """SpacetimeGaussians: with dt = tau - opacity_centre (n), mean + c_1 dt + c_2 dt^2 + c_3 dt^3 (mean_coefficient, n
        x 9), quaternion + quaternion_dot (n x 4) dt, opacity times exp(-(dt / e^opacity_log_width)^2). The full model:
        decoder "sigmoid", "clamp" or "plain", feature (n x 6), feature_dot (n x 3), decoder_first (6 x 12), decoder_second
        (3 x 6)."""
        n = len(np.asarray(opacity_centre))
        number = choice("decoder", decoder, _DECODERS)
        struct = _api.tides_polynomial_motion(count=n, start=start, stop=stop, plain_colour=plain_colour, decoder=number)
        arrays = _floats(
            struct,
            opacity_centre=(opacity_centre, (n,)),
            opacity_log_width=(opacity_log_width, (n,)),
            mean_coefficient=(mean_coefficient, (n, 9)),
            quaternion_dot=(quaternion_dot, (n, 4)),
            feature=(feature, (n, 6)),
            feature_dot=(feature_dot, (n, 3)),
            decoder_first=(decoder_first, (6, 12)),
            decoder_second=(decoder_second, (3, 6)),
        )
        made = cls._make("polynomial", struct)
        del arrays  # C has copied them
        return made

    @classmethod
    def rotor(
        cls,
        centre: Any,
        log_scale_time: Any,
        quaternion_right: Any = None,
        sh_harmonic: Any = None,
        start: float = 0.0,
        stop: float = 1.0,
        period: float = 0.0,
        time_prefilter: float = 0.0,
        sh_degree: int = 0,
    ) -> "Motion":
        """4-D Gaussians sliced in time (Fudan's 4d-gaussian-splatting): centre (n) and log_scale_time (n) in tau,
        quaternion_right (n x 4), sh_harmonic (n x harmonics x k x 3) with k = (sh_degree + 1)^2."""
        n, k = len(np.asarray(centre)), (sh_degree + 1) ** 2
        harmonics = 0 if sh_harmonic is None else np.asarray(sh_harmonic).shape[1]
        struct = _api.tides_rotor_motion(n, start, stop, period, time_prefilter, harmonics=harmonics, sh_degree=sh_degree)
        arrays = _floats(
            struct,
            centre=(centre, (n,)),
            log_scale_time=(log_scale_time, (n,)),
            quaternion_right=(quaternion_right, (n, 4)),
            sh_harmonic=(sh_harmonic, (n, harmonics, k, 3)),
        )
        made = cls._make("rotor", struct)
        del arrays
        return made

    @classmethod
    def keyframes(
        cls,
        time: Any,
        mean: Any,
        quaternion: Any,
        log_scale: Any = None,
        opacity_logit: Any = None,
        sh: Any = None,
        catmull_rom: bool = False,
        plain_colour: bool = False,
    ) -> "Motion":
        """Raw parameters at the increasing times `time` (f, any unit), joined by a C2 cubic spline: mean (f x n x 3),
        quaternion (f x n x 4), and if they change log_scale (f x n x 3), opacity_logit (f x n), sh (f x n x k x 3)."""
        time = array(time, np.float64, (None,), "time")
        f, n = len(time), np.asarray(mean).shape[1]
        k = 1 if sh is None else np.asarray(sh).shape[2]
        struct = _api.tides_keyframes_motion(f, n, pointer(time, c_double), sh_degree=round(k**0.5) - 1)
        struct.catmull_rom, struct.plain_colour = catmull_rom, plain_colour
        mean = means(mean, (f, n, 3))
        give_means(struct, mean)
        arrays = _floats(
            struct,
            quaternion=(quaternion, (f, n, 4)),
            log_scale=(log_scale, (f, n, 3)),
            opacity_logit=(opacity_logit, (f, n)),
            sh=(sh, (f, n, k, 3)),
        )
        made = cls._make("keyframes", struct)
        del arrays, mean, time
        return made

    @classmethod
    def callback(
        cls,
        function: MotionFunction,
        count: int,
        start: float = 0.0,
        stop: float = 1.0,
        sh_degree: int | None = None,
        time_scale: float = 0.0,
    ) -> "Motion":
        """Any motion of `count` Gaussians: see MotionFunction. `sh_degree`: it also moves spherical harmonics of that degree.
        `time_scale`: in this time of the motion's clock, values and rates at start, middle and end must show all that
        happens; it is about the shortest period. 0: one macro step of the run. An exception of the function ends the call
        under way, and is raised from it. The function is called in the thread that renders or simulates."""
        coefficients = None if sh_degree is None else (sh_degree + 1) ** 2
        stop_value = _api.TIDES_CANCELLED

        def fill(_user: Any, time: float, side: int, index: Any, count: int, theta: Any, _error: Any) -> int:
            function(time, side, np.ctypeslib.as_array(index, (count,)), _views(theta.contents, count, coefficients))
            return _api.TIDES_OK

        called = _api.tides_motion_function(kept(fill, stop_value))
        struct = _api.tides_callback_motion(count, start, stop, called, None, coefficients is not None, 0, time_scale)
        return cls._make("callback", struct, called)

    @property
    def model(self) -> str:
        """The kind of model: "polynomial", "rotor", "keyframes", "callback"."""
        return text(lib.tides_motion_model(self._pointer))

    @property
    def range(self) -> tuple[float, float]:
        """First and last time of the motion's own clock."""
        start, stop = c_double(), c_double()
        lib.tides_motion_range(self._pointer, byref(start), byref(stop))
        return start.value, stop.value

    @property
    def knots(self) -> int:
        """Number of times at which rates may jump."""
        return lib.tides_motion_knots(self._pointer)

    def moving(self, gaussians: Any) -> int:
        """How many of the `gaussians` (its canonical ones) move."""
        return lib.tides_motion_moving(self._pointer, gaussians._struct())


def _views(theta: Any, count: int, coefficients: int | None) -> SimpleNamespace:
    """C's memory as writable arrays, valid during the call."""
    shapes = {name: (count, *row) for name, row in _ROWS.items()}
    views = SimpleNamespace(sh=None, sh_dot=None)
    if coefficients is not None and theta.sh:
        shapes["sh"] = (count, coefficients, 3)
    for name, shape in shapes.items():
        setattr(views, name, np.ctypeslib.as_array(getattr(theta, name), shape))
        setattr(views, f"{name}_dot", np.ctypeslib.as_array(getattr(theta, f"{name}_dot"), shape))
    return views
