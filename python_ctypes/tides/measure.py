"""Standards for measuring methods: exact streams, and settings that make a method's pixels ideal."""

from __future__ import annotations

from ctypes import POINTER, byref, c_char_p, c_size_t, cast, c_void_p
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _api
from ._call import call, text
from ._library import lib
from ._progress import Progress, Reporter
from ._values import Facts, Value, plain
from .device import Device, opened
from .events import EVENT
from .render import ImageParams
from .scene import Scene
from .simulate import Sensor
from .trajectory import Camera

if TYPE_CHECKING:
    from .run import Run
    from .session import Session


class ExactOptions(Value, _api.tides_exact_options):
    """Limits of an exact stream's refinement: in_double, first_step_s, last_tolerance, first_rate, least_rate, last_rate,
    long_renders; 0: chosen for the run."""

    _defaults = "tides_exact_options_defaults"


def _result(made: Any) -> Facts:
    facts = plain(made)
    count = made.count
    view = np.ctypeslib.as_array(cast(made.events, POINTER(_api.tides_event)), (count,)) if count else None
    facts["events"] = np.empty(0, EVENT) if view is None else view.view(EVENT).copy()
    lib.tides_free(cast(made.events, c_void_p))
    return facts


def exact_stream(
    scene: Scene,
    camera: Camera,
    start: float,
    stop: float,
    sensor: Sensor | None = None,
    image: ImageParams | None = None,
    device: Device | str | int | None = None,
    progress: Progress = None,
    **options: Any,
) -> Facts:
    """The exact events of a scene: steps are halved until that moves no event by more than a nanosecond, or until `options`
    (fields of ExactOptions) end it. Returns events, steps_per_s, tolerance, moved (by the last halving), worst_residual,
    renders."""
    made, device = _api.tides_exact(), opened(device)
    world = (scene._pointer, camera.trajectory._pointer, camera.intrinsics, image or ImageParams(), sensor or Sensor())
    with device._lock, Reporter(progress) as step:
        how = ExactOptions(**options)
        call("tides_exact_stream", device._pointer, *world, start, stop, how, step, None, byref(made))
    return _result(made)


def session_exact(session: "Session", progress: Progress = None, **options: Any) -> Facts:
    """The exact events of a session, with ideal pixels of its thresholds; on frames, of straight lines between them. Returns
    the same facts as exact_stream."""
    made = _api.tides_exact()
    with session._lock, Reporter(progress) as step:
        call("tides_session_exact", session._pointer, ExactOptions(**options), step, None, byref(made))
    return _result(made)


def image_is_continuous(image: ImageParams) -> bool:
    """Whether the image is continuous in time under these rules."""
    return bool(lib.tides_image_is_continuous(image))


def ideal_settings(run: "Run", method: str, pixel: bool = True, sensor: bool = False) -> dict[str, str]:
    """Overrides ({key: value}) that make `method` replace the run's own, with ideal pixels of the run's thresholds.
    pixel=False: only the thresholds, if the run gives none for the method. With sensor=True (and pixel=False): the run's
    sensor in the method's own parameters, except keys that the run gives."""
    texts, count = POINTER(c_char_p)(), c_size_t()
    what = _api.TIDES_IDEAL_PIXEL if pixel else _api.TIDES_IDEAL_SENSOR if sensor else _api.TIDES_IDEAL_THRESHOLDS
    call("tides_ideal_settings", run._pointer, method.encode(), what, byref(texts), byref(count))
    try:
        return dict(text(one).split("=", 1) for one in texts[: count.value])
    finally:
        lib.tides_free(cast(texts, c_void_p))
