"""Images and their exact time derivatives."""

from __future__ import annotations

from contextlib import contextmanager
from ctypes import POINTER, byref, c_double, c_int64, c_size_t
from typing import Any, Iterable, Iterator

import numpy as np

from . import _api
from ._call import array, call, given, instance, nearest, pointer, text
from ._handle import Handle
from ._library import lib
from ._progress import Progress, Reporter
from ._values import Facts, Value, choice, constants, plain
from .device import Device, opened
from .events import as_events
from .exposure import Exposure
from .scene import Scene
from .trajectory import Camera, Trajectory

#: Planes that a frame may have: "Y", "L", "L_dot" [1/s], "A", "A_dot" [1/s], "coverage", "contributors", "R", "G", "B" ...
CHANNELS = tuple(text(lib.tides_channel_name(index)) for index in range(_api.TIDES_CHANNELS))

#: Planes of ground truth: "flow_u", "flow_v" [px/s], "depth", "depth_median", "alpha", "instance", "normal_x" ...
TRUTHS = tuple(text(lib.tides_truth_name(index)) for index in range(_api.TIDES_TRUTHS))

#: Material points (Renderer.pick): the scene's object (-1: none), its Gaussian, and standard deviations along its axes.
MATERIAL_POINT = np.dtype([("object", "i4"), ("reserved", "i4"), ("gaussian", "i8"), ("xi", "f8", 3)])
#: Places of material points in the image (Renderer.follow): u, v [px], depth [scene units], and whether it is visible.
TRACK = np.dtype([("u", "f8"), ("v", "f8"), ("depth", "f8"), ("visible", "i4"), ("reserved", "i4")])

#: Ground truth at an event's pixel when it fired (Renderer.event_truth).
EVENT_TRUTH = np.dtype(
    [(name, "f8") for name in ("flow_u", "flow_v", "depth", "alpha")] + [("instance", "i4"), ("reserved", "i4")]
)


class ImageParams(Value, _api.tides_image_params):
    """Image formation: rules ("smooth", "inria", "gsplat"), antialias ("file", as the scene's files say; True, False), sh_degree, dilation [px^2], luminance (3), log_eps (the
    black level, a share of full scale), background (3), light, colour_filter ("off", "rggb", "grbg", "gbrg", "bggr"), transfer ("file", "linear", "srgb", "gamma"), gamma."""

    _defaults, _groups = "tides_image_params_defaults", ("image.", "scene.", "sensor.")
    _words = {"rules": "TIDES_RULES_", "antialias": "TIDES_ANTIALIAS_", "colour_filter": "TIDES_FILTER_", "transfer": "TIDES_TRANSFER_"}


def colour_filter(name: str, height: int, width: int) -> np.ndarray:
    """Colours that pixels see through sensor.colour_filter `name` ("rggb", ...): (height x width) uint8, 0 red, 1 green, 2
    blue. That of an event is colour_filter(...)[y, x]."""
    number = choice("colour filter", name, constants("TIDES_FILTER_"))
    cell = [[lib.tides_colour_filter_channel(number, x, y) for x in (0, 1)] for y in (0, 1)]
    if cell[0][0] < 0:
        raise ValueError("colour filter: 'off' lets all light through")
    return np.tile(np.array(cell, "u1"), (height // 2 + 1, width // 2 + 1))[:height, :width]


class Renderer(Handle):
    """Renders `scene` through `camera`. Closing it frees its memory on the device. The first use builds kernels (seconds)."""

    _destroy = "tides_renderer_destroy"

    def __init__(
        self,
        scene: Scene,
        camera: Camera,
        image: ImageParams | None = None,
        device: Device | str | int | None = None,
        progress: Progress = None,
    ):
        self.scene, self.camera = instance(scene, Scene, "Renderer: scene"), instance(camera, Camera, "Renderer: camera")
        rules = given(image, ImageParams, "Renderer: image")
        self.device = opened(device)
        made = POINTER(_api.tides_renderer)()
        arguments = (scene._pointer, camera.intrinsics, rules)
        with self.device._lock, Reporter(progress) as step:
            call("tides_renderer_create", self.device._pointer, *arguments, step, None, byref(made))
        super().__init__(made, self.device, scene, lock=self.device._lock)

    @classmethod
    def _of(cls, made: Any, session: Any) -> "Renderer":
        renderer = cls.__new__(cls)
        renderer.scene, renderer.camera, renderer.device = session.scene, session.camera, session.device
        Handle.__init__(renderer, made, session, lock=session._lock)
        return renderer

    def set_psf(self, sigma_px: float, domain: str | int = "log") -> None:
        """Blurs L and L_dot of later frames by a Gaussian of `sigma_px` [px] (0: no blur), "log" or "linear": after the
        logarithm or before it."""
        with self._lock:
            call("tides_renderer_set_psf", self._pointer, sigma_px, choice("domain", domain, constants("TIDES_PSF_")))

    @contextmanager
    def _telling(self, progress: Progress) -> Iterator[None]:
        """Renders within this context report to `progress`, and stop on Ctrl-C, before each launch on the device."""
        with self._lock, Reporter(progress) as step:
            call("tides_renderer_set_progress", self._pointer, step, None)
            try:
                yield
            finally:
                call("tides_renderer_set_progress", self._pointer, _api.tides_progress(), None)

    def frame(
        self,
        time: float,
        channels: Iterable[str] = ("L", "L_dot"),
        trajectory: Trajectory | None = None,
        progress: Progress = None,
    ) -> dict[str, np.ndarray]:
        """One frame at `time` [s]: float64 planes (height x width), row 0 on top, by the names in CHANNELS. Colour and depth
        take additional time. `trajectory` replaces the camera's path."""
        frame = _api.tides_frame()
        planes = self._planes("channels", channels, CHANNELS, frame)
        path = self._path(trajectory)
        with self._telling(progress):
            call("tides_renderer_frame", self._pointer, path._pointer, time, frame)
        return planes

    def expose(
        self,
        time: float,
        exposure: Exposure | None = None,
        trajectory: Trajectory | None = None,
        progress: Progress = None,
    ) -> tuple[np.ndarray, Facts]:
        """Mean linear light of an exposed frame at `time` [s], the middle of its exposure: float64 (height x width), or (3 x
        height x width) with exposure.colour. Also error, renders, unsettled."""
        how, lens = exposure or Exposure(), self.camera.intrinsics
        light = np.empty(((3,) if how.planes == 3 else ()) + (lens.height, lens.width))
        done, path = _api.tides_exposed(), self._path(trajectory)
        with self._telling(progress):
            call(
                "tides_renderer_expose", self._pointer, path._pointer, time, how, pointer(light, c_double), byref(done)
            )
        return light, plain(done)

    def truth(
        self,
        time: float,
        planes: Iterable[str] = TRUTHS,
        trajectory: Trajectory | None = None,
        progress: Progress = None,
    ) -> dict[str, np.ndarray]:
        """Ground truth of the frame at `time` [s]: float64 planes (height x width), row 0 on top, by the names in TRUTHS:
        optical flow [px/s], depth of what is seen [scene units], its instance and normal. No PSF blurs it."""
        truth = _api.tides_truth()
        made = self._planes("planes", planes, TRUTHS, truth)
        path = self._path(trajectory)
        with self._telling(progress):
            call("tides_renderer_truth", self._pointer, path._pointer, time, truth)
        return made

    def displacement(self, start: float, stop: float, trajectory: Trajectory | None = None) -> dict[str, np.ndarray]:
        """The displacement from `start` to `stop`, earlier or later [s], of what each pixel shows at `start`: "u" and "v"
        [px], NaN where no point is seen, and "visible", True if the point is seen at `stop` too. truth() has optical flow,
        a velocity."""
        lens = self.camera.intrinsics
        planes = [np.empty((lens.height, lens.width)) for _ in range(3)]
        path = self._path(trajectory)
        addresses = [pointer(plane, c_double) for plane in planes]
        with self._telling(None):
            call("tides_renderer_displacement", self._pointer, path._pointer, start, stop, *addresses)
        return {"u": planes[0], "v": planes[1], "visible": planes[2] > 0}

    def pick(self, time: float, places: Any, trajectory: Trajectory | None = None) -> np.ndarray:
        """The points (MATERIAL_POINT) that are seen at `places` (count x 2) [px] at `time` [s]; the first pixel's centre is
        (0.5, 0.5)."""
        xy = array(places, np.float64, (None, 2), "places")
        points = np.zeros(len(xy), MATERIAL_POINT)
        path = self._path(trajectory)
        made = pointer(points, _api.tides_material_point)
        with self._lock:
            call("tides_renderer_pick", self._pointer, path._pointer, time, pointer(xy, c_double), len(xy), made)
        return points

    def choose(
        self, time: float, count: int, seed: int = 0, number: int = 0, trajectory: Trajectory | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Up to `count` places (n x 2) [px] where something is seen at `time` [s], drawn at random by seed and number, and
        their points."""
        xy, points, chosen = np.zeros((count, 2)), np.zeros(count, MATERIAL_POINT), c_size_t()
        path = self._path(trajectory)
        made = pointer(points, _api.tides_material_point)
        with self._lock:
            call(
                "tides_renderer_choose", self._pointer, path._pointer, time, seed, number, count, pointer(xy, c_double),
                made, byref(chosen),
            )
        return xy[: chosen.value], points[: chosen.value]

    def follow(self, time: float, points: Any, trajectory: Trajectory | None = None) -> np.ndarray:
        """The places of points in the image at `time` [s] (TRACK)."""
        points = array(points, MATERIAL_POINT, (None,), "points")
        tracks = np.zeros(len(points), TRACK)
        path = self._path(trajectory)
        made = pointer(tracks, _api.tides_track)
        with self._lock:
            call(
                "tides_renderer_follow", self._pointer, path._pointer, time, pointer(points, _api.tides_material_point),
                len(points), made,
            )
        return tracks

    def event_truth(self, events: Any, fired: Any = None, trajectory: Trajectory | None = None) -> np.ndarray:
        """Ground truth at each event's pixel when it fired (`fired` [ns]; None: at its t): an array with the fields flow_u,
        flow_v [px/s], depth [scene units], alpha, instance."""
        events = as_events(events)
        times = None if fired is None else array(fired, np.int64, (len(events),), "fired")
        truth = np.zeros(len(events), EVENT_TRUTH)
        path = self._path(trajectory)
        clock = None if times is None else pointer(times, c_int64)
        made = pointer(truth, _api.tides_event_truth)
        with self._lock:
            call(
                "tides_renderer_event_truth", self._pointer, path._pointer, pointer(events, _api.tides_event), clock,
                len(events), made,
            )
        return truth

    def _path(self, trajectory: Trajectory | None) -> Trajectory:
        return self.camera.trajectory if trajectory is None else instance(trajectory, Trajectory, "trajectory")

    def _planes(self, argument: str, names: Iterable[str], known: tuple[str, ...], struct: Any) -> dict[str, np.ndarray]:
        """Makes empty planes for the names, and puts their addresses into the struct."""
        lens, planes = self.camera.intrinsics, {}
        for name in names:
            if name not in known:
                raise ValueError(f"{argument}: {name!r} is none of {', '.join(known)}{nearest(name, known)}")
            planes[name] = np.empty((lens.height, lens.width))
            struct.plane[known.index(name)] = pointer(planes[name], c_double)
        return planes

    @property
    def stats(self) -> Facts:
        """Statistics so far: tile_jobs, pairs_evaluated, time_composite_s ..."""
        stats = _api.tides_render_stats()
        with self._lock:
            lib.tides_renderer_stats(self._pointer, byref(stats))
        return plain(stats)
