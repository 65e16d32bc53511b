"""Filters that cameras apply to their events, for recordings and for simulations."""

from __future__ import annotations

from ctypes import POINTER, byref, c_size_t
from typing import Any

import numpy as np

from . import _api
from ._call import call
from ._handle import Handle
from ._library import lib
from ._values import Facts, Value, plain
from .events import _records, as_events

_STAGES = ("background", "activity", "afk", "trail", "erc")


class Filters(Value, _api.tides_filters):
    """The filters, all off by default: background_s, background_support; activity_low_start, _low_stop, _high_start,
    _high_stop [events/s], activity_period_s; afk ("off", "band_stop", "band_pass"), afk_low_hz, afk_high_hz, afk_cell_px,
    afk_start, afk_stop; trail ("off", "trail", "stc_cut", "stc_keep"), trail_s; erc_events, erc_period_s, erc_law
    ("chance", "first"). `preset` sets the fields that aren't given."""

    _defaults = "tides_filters_defaults"
    _words = {"afk": "TIDES_AFK_", "trail": "TIDES_TRAIL_", "erc_law": "TIDES_ERC_"}
    _groups, _preset = ("filters.",), "filters"

    @property
    def any(self) -> bool:
        """Whether any filter is on."""
        return bool(lib.tides_filters_any(byref(self)))


class Filter(Handle):
    """Filters of a sensor of width x height px, with their state between calls."""

    _destroy = "tides_filter_destroy"

    def __init__(self, filters: Filters, width: int, height: int, seed: int = 0):
        made = POINTER(_api.tides_filter)()
        call("tides_filter_create", filters, width, height, seed, byref(made))
        super().__init__(made)

    def __call__(self, events: Any) -> np.ndarray:
        """The events that pass, EVENT (n). Input is in order of time, and not before earlier input."""
        events, kept = as_events(events).copy(), c_size_t()
        with self._lock:
            call("tides_filter_apply", self._pointer, _records(events), None, len(events), byref(kept))
        return events[: kept.value]

    @property
    def stats(self) -> Facts:
        """Numbers of events in and out, and dropped by each filter."""
        stats = _api.tides_filter_stats()
        lib.tides_filter_stats_get(self._pointer, byref(stats))
        facts = plain(stats)
        facts["dropped"] = Facts(zip(_STAGES, facts["dropped"]))
        return facts


def filter(events: Any, filters: Filters | None = None, size: tuple[int, int] | None = None, **fields: Any) -> np.ndarray:
    """The events that pass, EVENT (n), in order of time: tides.filter(events, trail="stc_cut", trail_s=0.01). `fields` are
    those of Filters. `size` is the sensor's width and height [px]; default: as large as events need."""
    events = as_events(events)
    if filters is None:
        filters = Filters(**fields)
    elif fields:
        filters = filters.copy().set(**fields)
    if size is None:
        size = (int(events["x"].max()) + 1, int(events["y"].max()) + 1) if len(events) else (1, 1)
    return Filter(filters, *size)(events)
