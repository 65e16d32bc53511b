"""Measures a sensor from a recording and the light that it saw, as values and as a preset."""

from __future__ import annotations

import math
import os
from ctypes import POINTER, byref, c_char_p, c_void_p, cast, pointer
from typing import TYPE_CHECKING, Any, Mapping

import numpy as np

from . import _api
from ._call import call, nearest, path, text
from ._library import lib
from ._progress import Progress, Reporter
from ._values import Facts, constants, plain
from .events import Reading

if TYPE_CHECKING:
    from .session import Session

_POLE = "pole_s"
_STATES = ("unknown", "measured", "uncertain", "bound", "given")


def _rows() -> list[Facts]:
    row, rows = _api.tides_calibrated_row(), []
    while lib.tides_calibrated_at(len(rows), byref(row)):
        rows.append(plain(row))
    return rows


class Calibration(Facts):
    """The result of a calibration. `measured` has a dict for each of threshold_on, threshold_off, threshold_sigma, log_eps,
    pole_s, refractory_s, leak_rate_hz, shot_noise_hz and offset_s: value, error, early, late, left, right, raw, and state
    ("measured", "uncertain", "bound", "unknown", "given"). Others are notes (a list), transitions, deviation, agreement,
    initial ("rest", "random", "steady" or None), starts (4, 2), map (height, width), hot (n, 2), rate_s, rate, rate_simulated,
    pole_scan, eps_scan; include/tides/calibrate.h defines them. `preset` is None if recording and light don't match (`refused`), else the text of a preset file."""

    preset: str | None

    def write(self, file: str | os.PathLike[str]) -> None:
        """Writes the preset, for sensor.preset. ValueError if there is none."""
        if self["preset"] is None:
            raise ValueError("no preset: " + "; ".join(self["notes"]))
        data = self["preset"].encode()
        call("tides_file_write", path(file), data, len(data))


def _array(data: Any, *shape: int) -> np.ndarray:
    return np.ctypeslib.as_array(data, shape).copy() if data and math.prod(shape) else np.empty(shape)


def _result(found: Any, about: str | None) -> Calibration:
    states = {number: word for word, number in constants("TIDES_CALIBRATED_").items() if word in _STATES}
    made = Calibration({name: value for name, value in plain(found).items() if name not in ("values", "map", "rate", "rate_s", "rate_simulated")})
    made["measured"] = Facts({row.name: plain(found.values[i]) for i, row in enumerate(_rows())})
    for value in made["measured"].values():
        value["state"] = states[value["state"]]
    made["initial"] = {one: word for word, one in (("rest", 0), ("random", 1), ("steady", 2))}.get(found.initial)
    made["starts"] = np.array(made["starts"])
    made["law"] = "intensity" if found.law == _api.TIDES_PHOTORECEPTOR_INTENSITY else "constant"
    made["refused"] = bool(found.refused)
    made["notes"] = (text(found.notes) or "").splitlines()
    made["hot"] = np.array(made["hot"][: min(found.hot_count, len(made["hot"]))], np.int32).reshape(-1, 2)
    made["map"] = _array(found.map, found.map_height, found.map_width)
    for name in ("rate_s", "rate", "rate_simulated"):
        made[name] = _array(getattr(found, name), found.rate_count)
    for name in ("pole_scan", "eps_scan"):
        made[name] = np.array(made[name])
    made["preset"] = None if made["refused"] else _preset(found, about)
    return made


def _preset(found: Any, about: str | None) -> str:
    made = c_char_p()
    call("tides_calibration_preset", found, None if about is None else about.encode(), byref(made))
    try:
        return text(made.value) or ""
    finally:
        lib.tides_free(cast(made, c_void_p))


def _give(options: Any, fix: Mapping[str, float]) -> None:
    rows = _rows()
    for name, value in fix.items():
        found = [i for i, row in enumerate(rows) if name in (row.name, row.key)]
        if not found:
            raise ValueError(f"fix: {name!r} is nothing that is measured{nearest(name, [row.name for row in rows])}")
        row = rows[found[0]]
        pole = row.name == _POLE and name == row.key
        options.given[found[0]] = (1 / (2 * math.pi * value) if value > 0 else 0.0) if pole else value


def calibrate(
    recording: str | os.PathLike[str],
    session: "Session",
    start: float | None = None,
    stop: float | None = None,
    roi: tuple[int, int, int, int] | None = None,
    fix: Mapping[str, float] | None = None,
    static: str | os.PathLike[str] | None = None,
    seed: int = 0,
    about: str | None = None,
    progress: Progress = None,
    **reading: Any,
) -> Calibration:
    """Measures the sensor of a recording, by the light of a session's scene and path, or of its frames; both must have one
    clock. start, stop: [s] of the recording (default: the busiest second). roi: x, y, width, height [px]. fix: known values
    ({"log_eps": 0.05}). static: a recording of a still scene, from which noise and leak are measured. `reading` are the
    fields of Reading."""
    options, found = _api.tides_calibrate_options(), _api.tides_calibration()
    lib.tides_calibrate_options_defaults(byref(options))
    if start is not None:
        options.start_ns = round(start * 1e9)
    if stop is not None:
        options.stop_ns = round(stop * 1e9)
    if roi is not None:
        options.x, options.y, options.width, options.height = roi
    options.still = None if static is None else path(static)
    options.seed = seed
    how = Reading(**reading)
    options.reading = cast(pointer(how), POINTER(_api.tides_event_reading))
    _give(options, fix or {})
    with session._lock, Reporter(progress) as step:
        call("tides_calibrate", path(recording), session._pointer, byref(options), step, None, byref(found))
    try:
        return _result(found, about)
    finally:
        lib.tides_calibration_free(byref(found))
