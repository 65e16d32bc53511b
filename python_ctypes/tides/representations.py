"""Events as dense float64 arrays (planes x height x width), the way that networks take them."""

from __future__ import annotations

from ctypes import c_double
from typing import Any

import numpy as np

from . import _api
from ._call import call, pointer
from ._library import lib
from ._values import Value, choice, constants
from .events import _records, as_events

_STYLES = constants("TIDES_VOXEL_")


class VoxelOptions(Value, _api.tides_voxel_options):
    """bins, normalise ("none", "population", "sample"), start_ns, stop_ns; VoxelOptions.of("dsec") has a style's."""

    _words = {"normalise": "TIDES_NORMALISE_"}

    @classmethod
    def of(cls, style: str | int) -> "VoxelOptions":
        made = cls()
        lib.tides_voxel_options_defaults(made, choice("style", style, _STYLES))
        return made


def voxel_grid(events: Any, width: int, height: int, style: str | int = "e2vid", **options: Any) -> np.ndarray:
    """A voxel grid (bins x height x width): each event's polarity is shared between the bins around its time. `style`: "e2vid",
    "dsec" or "timelens" (give start_ns, stop_ns); `options` are the fields of VoxelOptions."""
    events, chosen = as_events(events), VoxelOptions.of(style).set(**options)
    grid = np.empty((chosen.bins, height, width))
    call("tides_voxel_grid", _records(events), len(events), width, height, chosen, pointer(grid, c_double))
    return grid


def event_frame(events: Any, width: int, height: int) -> np.ndarray:
    """Numbers of OFF and of ON events (2 x height x width)."""
    events, frame = as_events(events), np.empty((2, height, width))
    call("tides_event_frame", _records(events), len(events), width, height, pointer(frame, c_double))
    return frame


def time_surface(events: Any, width: int, height: int, time_ns: int, decay_s: float) -> np.ndarray:
    """exp(-(time - t) / decay_s) of the latest OFF and ON event at or before `time_ns` (2 x height x width); 0 without one."""
    events, surface = as_events(events), np.empty((2, height, width))
    call("tides_time_surface", _records(events), len(events), width, height, time_ns, decay_s, pointer(surface, c_double))
    return surface
