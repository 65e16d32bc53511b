"""Camera frames: their exposure, and the conversion of light to values."""

from __future__ import annotations

from ctypes import byref, c_double, c_uint16
from typing import Any

import numpy as np

from . import _api
from ._call import array, call, pointer
from ._library import lib
from ._values import Value


class Exposure(Value, _api.tides_exposure):
    """An exposure: shutter ("global", "rolling"), frames_per_second [Hz], exposure_s, row_time_s [s], tolerance of mean light,
    colour (1: r, g, b; 0: Y), bits (8, 16), transfer ("linear", "srgb"), gamma, gain, full_well_e, read_noise_e [e-], seed."""

    _defaults, _groups = "tides_exposure_defaults", ("exposure.",)
    _words = {"shutter": "TIDES_SHUTTER_", "transfer": "TIDES_TRANSFER_"}

    @property
    def planes(self) -> int:
        """Planes of light and values: 1 (Y) or 3 (r, g, b)."""
        return lib.tides_exposure_planes(self)

    def row(self, height: int, time: float, row: int) -> tuple[float, float]:
        """Start and stop [s] of the exposure of a row, for a frame at `time` [s]."""
        start, stop = c_double(), c_double()
        lib.tides_exposure_row(self, height, time, row, byref(start), byref(stop))
        return start.value, stop.value

    def span(self, height: int, time: float) -> tuple[float, float]:
        """Start of the first and stop of the last exposure [s] of all rows of a frame at `time` [s]."""
        start, stop = c_double(), c_double()
        lib.tides_exposure_span(self, height, time, byref(start), byref(stop))
        return start.value, stop.value

    def times(self, height: int, start: float, stop: float) -> np.ndarray:
        """Middles of exposures (n) [s] of all frames whose rows lie within [start, stop]."""
        count = lib.tides_exposure_count(self, height, start, stop)
        return np.array([lib.tides_exposure_time(self, height, start, index) for index in range(count)])

    def values(self, light: Any, index: int = 0) -> np.ndarray:
        """Linear light (height x width, or 3 x height x width) as uint16 values (height x width, or x 3): gain, noise of frame
        `index`, clipping, transfer, rounding."""
        three = self.planes == 3
        given = array(light, np.float64, (3, None, None) if three else (None, None), "light")
        height, width = given.shape[-2:]
        made = np.zeros((height, width, 3) if three else (height, width), np.uint16)
        call("tides_exposure_values", self, width, height, index, pointer(given, c_double), pointer(made, c_uint16))
        return made
