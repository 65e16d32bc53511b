"""Sensor presets without a run file: the values that `sensor.preset` sets there."""

from __future__ import annotations

import json
import os
from ctypes import POINTER, byref, c_char_p, c_void_p, cast, create_string_buffer, memmove, sizeof
from typing import Any

from . import _api
from ._call import call, encoded, text
from ._library import lib


def preset_names() -> list[str]:
    """The library's presets: "davis346", "imx636" ...; names for `Sensor(preset=...)` and sensor.preset."""
    names, name = [], create_string_buffer(_api.TIDES_PRESET_NAME)
    while lib.tides_preset_at(len(names), name):
        names.append(name.value.decode())
    return names


def preset(name: str) -> dict[str, Any]:
    """A preset's content by its name, the library's or one of ~/.config/tides/presets: about, and the groups sensor, frontend,
    readout, whose values may be {"value": value, "source": text}. errors.NotFound if there is none."""
    made = c_char_p()
    call("tides_preset_read", encoded(name), byref(made))
    try:
        return dict(json.loads(text(made.value)))
    finally:
        lib.tides_free(cast(made, c_void_p))


def fill(value: Any, group: str, preset: str | os.PathLike[str]) -> None:
    """Sets a struct to a run file's `group` with a preset: a name of share/presets, or the path of a .json file. BadConfig
    lists those that exist. The library applies presets only to run files, so one is read here; its scene and camera are
    never opened."""
    name = os.path.abspath(preset) if os.fspath(preset).endswith(".json") else os.fspath(preset)
    words = {"scene": {"file": "-"}, "camera": {"file": "-"}, "time": {"start": 0, "stop": 1}, "sensor": {"preset": name}}
    run, values = POINTER(_api.tides_run)(), _api.tides_run_values()
    call("tides_run_parse", json.dumps(words).encode(), b".", None, 0, byref(run))
    try:
        lib.tides_run_get(run, byref(values))
        memmove(byref(value), byref(getattr(values, group)), sizeof(value))
    finally:
        lib.tides_run_destroy(run)
