"""Float images to and from OpenEXR, PNG pictures, and animations of them."""

from __future__ import annotations

import os
from ctypes import POINTER, byref, c_char_p, c_double, c_float, c_int32, c_uint8, c_uint16
from typing import Any, Mapping

import numpy as np

from . import _api
from ._call import array, call, encoded, path, pointer, text
from ._handle import Handle
from ._library import lib
from ._values import choice, constants
from .events import _records, as_events

_COMPRESSIONS = constants("TIDES_EXR_")


def write_exr(
    file: str | os.PathLike[str],
    channels: Mapping[str, Any],
    compression: str | int = "zip",
    attributes: Mapping[str, str] | None = None,
) -> None:
    """Writes planes (height x width) by name as 32-bit floats. `compression`: "none", "zips", "zip"."""
    if not channels:
        raise ValueError("channels: at least one plane is needed")
    shape = np.shape(next(iter(channels.values())))
    planes = {name: array(plane, np.float32, (shape[0], shape[1]), name) for name, plane in channels.items()}
    rows = (_api.tides_channel * len(planes))(
        *(_api.tides_channel(encoded(name), pointer(one, c_float)) for name, one in planes.items())
    )
    pairs = [encoded(word) for pair in (attributes or {}).items() for word in pair]
    facts = (c_char_p * (len(pairs) + 1))(*pairs, None)
    number = choice("compression", compression, _COMPRESSIONS)
    call("tides_exr_write", path(file), shape[1], shape[0], rows, len(planes), number, facts)


def _planes(function: str, file: str | os.PathLike[str]) -> dict[str, np.ndarray]:
    made = POINTER(_api.tides_exr)()
    call(function, path(file), byref(made))
    try:
        width, height, count = c_int32(), c_int32(), c_int32()
        lib.tides_exr_size(made, byref(width), byref(height), byref(count))
        shape = (height.value, width.value)
        return {
            text(lib.tides_exr_name(made, index)): np.ctypeslib.as_array(lib.tides_exr_pixels(made, index), shape).copy()
            for index in range(count.value)
        }
    finally:
        lib.tides_exr_destroy(made)


def read_exr(file: str | os.PathLike[str]) -> dict[str, np.ndarray]:
    """The channels of an EXR file by name, float32 (height x width)."""
    return _planes("tides_exr_read", file)


def read_truth(file: str | os.PathLike[str]) -> dict[str, np.ndarray]:
    """Ground truth of a file as float32 planes (height x width), NaN where unknown: the channels of an .exr; "displacement_u"
    and "displacement_v" of DSEC's .png and BlinkFlow's .npy; of a 16-bit grey .png "disparity" [px]
    in a folder disparity/, else "depth" [m]; "instance" of an 8-bit grey one. A .npy (height, width) is "depth" if float, else
    "instance"."""
    return _planes("tides_truth_read", file)


def write_png(file: str | os.PathLike[str], rgb: Any) -> None:
    """Writes uint8 (height x width x 3)."""
    rgb = _rgb(rgb)
    call("tides_png_write", path(file), rgb.shape[1], rgb.shape[0], pointer(rgb, c_uint8))


def write_png_values(file: str | os.PathLike[str], values: Any, bits: int = 8) -> None:
    """Writes whole numbers (height x width, or x 3) of 8 or 16 bits, without conversion."""
    given = np.asarray(values)
    if given.dtype.kind not in "ui" or (given.size and (given.min() < 0 or given.max() >= 1 << bits)):
        raise ValueError(f"values: whole numbers from 0 to {(1 << bits) - 1} are needed")
    planes = given.shape[2] if given.ndim == 3 else 1
    given = array(given, np.uint16, (None, None, planes) if given.ndim == 3 else (None, None), "values")
    made = pointer(given, c_uint16)
    call("tides_png_write_values", path(file), given.shape[1], given.shape[0], planes, bits, made)


def _rgb(rgb: Any) -> np.ndarray:
    if np.asarray(rgb).dtype != np.uint8:
        raise ValueError(f"rgb: {np.asarray(rgb).dtype}, where uint8 is needed")
    return array(rgb, np.uint8, (None, None, 3), "rgb")


def _picture(name: str, planes: list[Any], *rest: Any) -> np.ndarray:
    first = array(planes[0], np.float64, (None, None), "values")
    made = [array(plane, np.float64, first.shape, "values") for plane in planes]
    rgb = np.empty((*first.shape, 3), np.uint8)
    sizes = (first.shape[1], first.shape[0])
    getattr(lib, name)(*(pointer(one, c_double) for one in made), *sizes, *rest, pointer(rgb, c_uint8))
    return rgb


def picture_grey(values: Any, white: float = 1.0) -> np.ndarray:
    """Linear values (height x width) as sRGB grey, uint8 (height x width x 3); `white` is shown as white."""
    return _picture("tides_picture_grey", [values], white)


def picture_rgb(r: Any, g: Any, b: Any) -> np.ndarray:
    """Linear planes (height x width) as sRGB, uint8 (height x width x 3)."""
    return _picture("tides_picture_rgb", [r, g, b])


def picture_signed(values: Any, limit: float = 0.0) -> np.ndarray:
    """Values in [-limit, limit] as blue, white, red; limit 0: the 99.5th percentile of the magnitudes."""
    return _picture("tides_picture_signed", [values], limit)


def _with_key(name: str, rgb: np.ndarray) -> np.ndarray:
    getattr(lib, name)(pointer(rgb, c_uint8), rgb.shape[1], rgb.shape[0])
    return rgb


def picture_flow(u: Any, v: Any, limit: float = 0.0, key: bool = False) -> np.ndarray:
    """Flow as a colour wheel, uint8 (height x width x 3): right red, down yellow-green, left cyan, up violet, white at rest;
    full colour at `limit` (0: the fastest). `key`: draws the wheel into the lower right corner, if both sides have at least
    64 px."""
    made = _picture("tides_picture_flow", [u, v], limit)
    return _with_key("tides_picture_flow_key", made) if key else made


def picture_depth(depth: Any, near: float = 0.0, far: float = 0.0, key: bool = False) -> np.ndarray:
    """Depths from `near`, light, to `far`, dark (0, 0: the nearest and farthest of all); 0 is black. uint8 (height x width x
    3). `key`: draws the ramp into the lower right corner, if both sides have at least 64 px."""
    made = _picture("tides_picture_depth", [depth], near, far)
    return _with_key("tides_picture_depth_key", made) if key else made


def picture_labels(labels: Any) -> np.ndarray:
    """Whole numbers in distinct colours; negative ones are black."""
    return _picture("tides_picture_labels", [labels])


def picture_events(events: Any, width: int, height: int, base: Any = None) -> np.ndarray:
    """Events in red (ON) and blue (OFF) over `base` (height x width, linear; None: grey), uint8 (height x width x 3)."""
    events, rgb = as_events(events), np.empty((height, width, 3), np.uint8)
    if len(events) and (events["x"].max() >= width or events["y"].max() >= height):
        raise ValueError(f"events: some lie outside {width} x {height} px")
    below = None if base is None else array(base, np.float64, (height, width), "base")
    plane = None if below is None else pointer(below, c_double)
    lib.tides_picture_events(_records(events), len(events), plane, width, height, pointer(rgb, c_uint8))
    return rgb


def picture_text(rgb: np.ndarray, x: int, y: int, words: str, scale: int = 1, colour: Any = (0, 0, 0)) -> None:
    """Draws ASCII text into a contiguous picture (uint8, height x width x 3), with its top left corner at (x, y)."""
    if _rgb(rgb) is not rgb:
        raise ValueError("rgb: a C-contiguous array is needed, it is drawn into")
    ink = (c_uint8 * 3)(*colour)
    lib.tides_picture_text(pointer(rgb, c_uint8), rgb.shape[1], rgb.shape[0], x, y, scale, ink, encoded(words))


class Animation(Handle):
    """Pictures of one size in sequence: .png or .apng (animated PNG), .y4m (video), frame%04d.png (one file each). In a with
    statement the file is finished at the end, and removed after an exception."""

    _destroy = "tides_animation_abandon"

    def __init__(self, file: str | os.PathLike[str] | int, width: int, height: int, pictures_per_second: float = 25.0):
        """`file`: a path, or an open file descriptor (a pipe), to which the video is written while pictures are appended."""
        made = POINTER(_api.tides_animation)()
        if isinstance(file, int):
            call("tides_animation_stream", file, width, height, pictures_per_second, byref(made))
        else:
            call("tides_animation_open", path(file), width, height, pictures_per_second, byref(made))
        super().__init__(made)
        self._shape = (height, width, 3)

    def append(self, rgb: Any) -> None:
        """Adds the next picture, uint8 (height x width x 3)."""
        picture = array(_rgb(rgb), np.uint8, self._shape, "rgb")
        with self._lock:
            call("tides_animation_append", self._pointer, pointer(picture, c_uint8))

    def finish(self) -> None:
        """Completes the file, and closes the animation."""
        with self._lock:
            held = self._pointer
            self._give_away()
            call("tides_animation_finish", held)

    def __exit__(self, kind: Any, *_: Any) -> None:
        if kind is None and not self.closed:
            self.finish()
        else:
            self.close()
