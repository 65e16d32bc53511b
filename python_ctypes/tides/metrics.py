"""Metrics: compares a stream of events with a reference."""

from __future__ import annotations

from ctypes import byref, c_int64, c_size_t, c_uint16
from typing import Any, Iterable

import numpy as np

from . import _api
from ._call import call, pointer
from ._library import lib
from ._progress import Progress, Reporter
from ._values import Facts, Value, choice, constants, plain
from .events import _records, as_events

_BETTER = {number: word for word, number in constants("TIDES_BETTER_").items()}


def table() -> list[Facts]:
    """All values: name, family (of `tides metrics --only`), unit, sentence, better ("lower", "higher", "one", "zero",
    "neither"), of_stream (True: a value of each stream)."""
    count = c_size_t()
    rows = [plain(row) for row in lib.tides_metrics_table(byref(count))[: count.value]]
    names = ("name", "family", "unit", "sentence")
    return [
        Facts({key: row[key] for key in names}, better=_BETTER[row.better], of_stream=row.of == _api.TIDES_OF_STREAM)
        for row in rows
    ]


#: Families of values: "isi", "same_time", "fano", "chamfer", "kernel", "match" ...
FAMILIES = constants("TIDES_METRIC_")


class MetricsOptions(Value, _api.tides_metrics_options):
    """Options of a comparison: width, height, roi [px], start_ns, stop_ns, tick_ns, match_limit_s ..."""

    _defaults = "tides_metrics_options_defaults"


def compare(
    reference: Any, simulated: Any, wanted: Iterable[str] | None = None, progress: Progress = None, **options: Any
) -> Facts:
    """Compares two streams (EVENT, each in order of time). `wanted` names FAMILIES (None: all except the slow and the exact
    ones); `options` are the fields of MetricsOptions. Returns the fields of tides_metrics; values that weren't computed are
    NaN."""
    reference, simulated = as_events(reference), as_events(simulated)
    chosen = MetricsOptions(**options)
    if wanted is not None:
        chosen.wanted = sum({choice("wanted", one, FAMILIES) for one in wanted})
    metrics = _api.tides_metrics()
    streams = (_records(reference), len(reference), _records(simulated), len(simulated))
    with Reporter(progress) as step:
        call("tides_metrics_compare", *streams, chosen, step, None, metrics)
    return plain(metrics)


def match(reference: Any, simulated: Any, limit_s: float = 1e-3) -> Facts:
    """Matches events one by one with an exact reference: matched, missing, spurious, mismatch_percent, dt_median_us ... Events
    farther apart than `limit_s` [s] don't match."""
    reference, simulated = as_events(reference), as_events(simulated)
    made = _api.tides_match()
    call("tides_match_events", _records(reference), len(reference), _records(simulated), len(simulated), limit_s, made)
    return plain(made)


class Blemishes(Facts):
    """Events of a recording that its light didn't cause. bursts (n x 2): [start, stop) [ns] of bursts by the readout of
    frames. hot (n x 2): x, y of hot pixels. burst_events, hot_events: their numbers of events."""

    def __init__(self, events: Any, width: int, height: int):
        """Finds the blemishes of a recording (EVENT, in order of time) of width x height px."""
        events, made = as_events(events), _api.tides_blemishes()
        call("tides_blemishes_find", _records(events), len(events), width, height, made)
        try:
            counted = {"burst_events": made.burst_events, "hot_events": made.hot_events}
            super().__init__(bursts=_pairs(made.burst, made.bursts), hot=_pairs(made.hot, made.hots), **counted)
        finally:
            lib.tides_blemishes_free(byref(made))

    def leave_out(self, events: Any) -> np.ndarray:
        """A copy of a stream, in order of time, without events in these bursts and pixels: both streams of a comparison need
        it."""
        kept, made = as_events(events).copy(), _api.tides_blemishes()
        bursts, hot = np.ascontiguousarray(self["bursts"], np.int64), np.ascontiguousarray(self["hot"], np.uint16)
        made.burst, made.bursts = pointer(bursts, c_int64), len(bursts)
        made.hot, made.hots = pointer(hot, c_uint16), len(hot)
        return kept[: lib.tides_blemishes_leave_out(byref(made), _records(kept), len(kept))]


def _pairs(data: Any, count: int) -> np.ndarray:
    return np.ctypeslib.as_array(data, (2 * count,)).copy().reshape(count, 2) if count else np.empty((0, 2), np.int64)
