"""The readout: a bus with a limited rate of events."""

from __future__ import annotations

from ctypes import POINTER, byref, c_double, c_int32
from typing import Any

import numpy as np

from . import _api
from ._call import array, call, kept, pointer
from ._handle import Handle
from ._library import lib
from ._values import Facts, Value, plain
from .events import EVENT, _records, as_events


class Readout(Value, _api.tides_readout):
    """The readout. `preset` ("gen4", or a .json file like share/presets') sets the fields that aren't given. kind ("tiles",
    "rows", "bottleneck", "requested", "scanned"), tile_px, k0 [events per tick], tick_s, beta_k, p0, eta, sigma0_s,
    gamma_sigma_s, queue_capacity, jitter_law ("gaussian", "delay"); row_s, event_s, stamp ("event", "row"), frame_s."""

    _defaults = "tides_readout_defaults"
    _words = {"kind": "TIDES_READOUT_", "jitter_law": "TIDES_JITTER_", "stamp": "TIDES_STAMP_"}
    _groups, _preset = ("readout.",), "readout"


class Arbiter(Handle):
    """A readout of width x height px. `push` takes sorted events and returns events that have left; `finish` returns the rest.
    No event leaves before `start` [ns]; None: jitter may move events to any time."""

    _destroy = "tides_arbiter_destroy"

    def __init__(self, readout: Readout, width: int, height: int, seed: int = 0, start: int | None = None):
        made = POINTER(_api.tides_arbiter)()
        call("tides_arbiter_create", readout, width, height, seed, byref(made))
        super().__init__(made)
        if start is not None:
            lib.tides_arbiter_start(made, start)

    def _collect(self, name: str, *arguments: Any) -> tuple[np.ndarray, np.ndarray]:
        packets, times = [np.empty(0, EVENT)], [np.empty(0, np.int64)]

        def take(_user: Any, events: Any, fired: Any, count: int) -> int:
            if count:
                packets.append(np.ctypeslib.as_array(events, (count,)).view(EVENT).copy())
                times.append(np.ctypeslib.as_array(fired, (count,)).copy())
            return 0

        with self._lock:
            call(name, self._pointer, *arguments, _api.tides_readout_sink(kept(take, 1)), None)
        return np.concatenate(packets), np.concatenate(times)

    def push(self, events: Any) -> tuple[np.ndarray, np.ndarray]:
        """Takes EVENT (n), none before any pushed earlier. Returns the events that left, and when [ns] each fired."""
        events = as_events(events)
        return self._collect("tides_arbiter_push", _records(events), len(events))

    def finish(self) -> tuple[np.ndarray, np.ndarray]:
        """Returns all events that still waited, EVENT (n), and when [ns] each fired."""
        return self._collect("tides_arbiter_finish")

    @property
    def tiles(self) -> tuple[int, int]:
        """Number of tiles down and across."""
        across, down = c_int32(), c_int32()
        lib.tides_arbiter_tiles(self._pointer, byref(across), byref(down))
        return down.value, across.value

    def set_activity(self, psi: Any) -> None:
        """Sets the activity psi of every tile (down x across), in [0, 1], for events pushed from now on."""
        psi = array(psi, np.float64, self.tiles, "psi")
        with self._lock:
            call("tides_arbiter_activity", self._pointer, pointer(psi, c_double))

    @property
    def stats(self) -> Facts:
        """Numbers of events in, out, dropped, overflowed, waiting, delayed; ticks, worst_delay_s."""
        stats = _api.tides_readout_stats()
        lib.tides_arbiter_stats(self._pointer, byref(stats))
        return plain(stats)
