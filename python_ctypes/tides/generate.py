"""Made worlds: a scene with a camera that fits, for tests and first steps."""

from __future__ import annotations

from ctypes import POINTER, byref, c_size_t, cast
from dataclasses import dataclass
from typing import Any

from . import _api
from ._call import call, encoded
from ._library import lib
from ._values import Facts, Value, plain
from .scene import Scene
from .trajectory import Camera, Intrinsics, Trajectory


class GenerateOptions(Value, _api.tides_generate_options):
    """count, gaussians, duration_s [s], speed, seed, width, height [px]; 0 is a kind's own default."""

    _defaults = "tides_generate_options_defaults"


@dataclass(frozen=True)
class World:
    """A made world: scene, camera; background, linear (r, g, b), for ImageParams; duration_s [s] of motions and path, from
    0."""

    scene: Scene
    camera: Camera
    background: tuple[float, float, float]
    duration_s: float


def generators() -> list[Facts]:
    """The kinds of made worlds: name, sentence, counted, count, count_most, gaussians, duration_s."""
    count = c_size_t()
    rows = lib.tides_generators(byref(count))
    return [plain(row) for row in rows[: count.value]]


def generate(kind: str, **options: Any) -> World:
    """Makes a world of `kind`; `options` are the fields of GenerateOptions. Equal options give equal worlds."""
    made = _api.tides_world()
    call("tides_generate", encoded(kind), GenerateOptions(**options), made)
    try:
        scene = Scene._of(cast(made.scene, POINTER(_api.tides_scene)))  # a cast, since a field's pointer changes with the field
        made.scene = None
        path = Trajectory._of(cast(made.camera, POINTER(_api.tides_trajectory)))
        made.camera = None
        camera = Camera(path, Intrinsics._from(made.intrinsics))
        return World(scene, camera, tuple(made.background), made.duration_s)
    finally:
        lib.tides_world_release(byref(made))
