"""Events as dense float64 arrays (planes x height x width), the input of networks."""

from __future__ import annotations

import os
from ctypes import POINTER, byref, c_char_p, c_double
from typing import Any

import numpy as np

from . import _api
from ._call import array, call, encoded, path, pointer
from ._handle import Handle
from ._library import lib
from ._values import Value, choice, constants
from .events import _records, as_events
from .files import check_unread

_STYLES = constants("TIDES_VOXEL_")


class VoxelOptions(Value, _api.tides_voxel_options):
    """Options of a voxel grid: bins, normalise ("none", "population", "sample"), start_ns, stop_ns; VoxelOptions.of("dsec")
    has a style's."""

    _words = {"normalise": "TIDES_NORMALISE_"}

    @classmethod
    def of(cls, style: str | int) -> "VoxelOptions":
        """The options of a style: "e2vid", "dsec" or "timelens"."""
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


class ArrayWriter(Handle):
    """A file of arrays of one shape (planes x height x width), stored as float32: .npy, .npz, .h5 (windows x planes x height x
    width), or .exr (one window). In a with statement the file is finished at the end, and removed after an exception.
    """

    _destroy = "tides_array_writer_abandon"

    def __init__(
        self, file: str | os.PathLike[str], shape: tuple[int, int, int], name: str = "array", plane_names: Any = None
    ):
        """`name` is the dataset's, `plane_names` are those of an EXR file's channels. A file that an open EventReader reads is
        refused."""
        check_unread(file)
        made = POINTER(_api.tides_array_writer)()
        names = None if plane_names is None else [encoded(one) for one in plane_names]
        if names is not None and len(names) != shape[0]:
            raise ValueError(f"plane_names: {len(names)}, where {shape[0]} are needed")
        held = None if names is None else (c_char_p * len(names))(*names)
        call("tides_array_writer_open", path(file), _api.tides_array_shape(encoded(name), *shape, held), byref(made))
        super().__init__(made)
        self._shape = tuple(shape)

    def append(self, values: Any, start_ns: int, stop_ns: int, events: int) -> None:
        """Adds the array of a window from `start_ns` to `stop_ns`, made of `events` events."""
        values = array(values, np.float64, self._shape, "values")
        with self._lock:
            call("tides_array_writer_append", self._pointer, pointer(values, c_double), start_ns, stop_ns, events)

    def finish(self) -> None:
        """Completes the file, and closes the writer."""
        with self._lock:
            held = self._pointer
            self._give_away()
            call("tides_array_writer_finish", held)

    def __exit__(self, kind: Any, *_: Any) -> None:
        if kind is None and not self.closed:
            self.finish()
        else:
            self.close()
