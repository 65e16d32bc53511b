"""Events as an interactive page: one HTML file, in a notebook or in any browser."""

from __future__ import annotations

import atexit
import html
import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from . import _api
from ._call import array, call, path, pointer
from ._progress import Progress, Reporter
from ._values import Facts, Value, plain
from .events import _records, as_events, events_summary
from .render import EVENT_TRUTH


class PageOptions(Value, _api.tides_page_options):
    """Options of a page: width, height [px] (0: of the file or the events); start_ns, stop_ns; window_ns, the initial window
    of time; most, greatest number of events; title; format of the event file."""

    _defaults = "tides_page_options_defaults"


def read_truth(file: str | os.PathLike[str], first: int = 0, count: int | None = None) -> np.ndarray:
    """The ground truth of events [first, first + count) of a recording that was simulated with sensor.truth: EVENT_TRUTH (n)."""
    count = max(0, events_summary(file)["count"] - first) if count is None else count
    truth = np.zeros(count, EVENT_TRUTH)
    call("tides_events_truth", path(file), first, count, pointer(truth, _api.tides_event_truth))
    return truth


def write_page(
    file: str | os.PathLike[str], events: Any, truth: Any = None, progress: Progress = None, **options: Any
) -> Facts:
    """Writes the page of an event file (its path) or of events (n) in order of time, with their EVENT_TRUTH (n) or None.
    `options` are the fields of PageOptions. Returns events, start_ns, stop_ns, width, height, truth, ended (1: there were
    more events than `most`)."""
    chosen, report = PageOptions(**options), _api.tides_page_report()
    if isinstance(events, (str, os.PathLike)):
        with Reporter(progress) as step:
            call("tides_page_write_file", path(events), path(file), chosen, step, None, report)
        return plain(report)
    events = as_events(events)
    rows = None if truth is None else array(truth, EVENT_TRUTH, (len(events),), "truth")
    seen = None if rows is None else pointer(rows, _api.tides_event_truth)
    call("tides_page_write", path(file), _records(events), seen, len(events), chosen, report)
    return plain(report)


class Shown:
    """A page that was written. A notebook shows it; otherwise open `path` in a browser. `facts` are those of write_page."""

    def __init__(self, file: Path, facts: Facts, height: int):
        self.path, self.facts, self._height = file, facts, height

    def __repr__(self) -> str:
        return f"{self.facts.events} events, to be opened in a browser: {self.path.resolve().as_uri()}"

    def _repr_html_(self) -> str:
        page = html.escape(self.path.read_text())
        return f'<iframe srcdoc="{page}" style="width:100%;height:{self._height}px;border:0" allowfullscreen></iframe>'


def show(
    events: Any, file: str | os.PathLike[str] | None = None, truth: Any = None, height: int = 640, **options: Any
) -> Shown:
    """Shows events (n), or an event file's path, as an interactive page. The page is `file`, or a temporary file that is
    removed when Python ends. `height` [px] is for notebooks. `options` are those of write_page, with `most` 2 million by
    default, which a notebook can keep."""
    if file is None:
        handle, file = tempfile.mkstemp(".html", "tides-")
        os.close(handle)
        atexit.register(Path(file).unlink, missing_ok=True)
    return Shown(Path(file), write_page(file, events, truth, **{"most": 2_000_000, **options}), height)
