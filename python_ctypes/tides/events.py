"""Events as numpy arrays, and event files of every format.

Times are int64 nanoseconds, pixels uint16 with (0, 0) top left, polarities +1 and -1. Arrays of `tides.EVENT` are the
library's own records: 16 bytes, given to C and received without copies.
"""

from __future__ import annotations

import ctypes
import os
from ctypes import POINTER, byref, c_int64, c_size_t, cast, sizeof
from typing import Any, Iterator

import numpy as np

from . import _api
from ._call import call, encoded, path, pointer
from ._handle import Handle
from ._library import lib
from ._progress import Progress, Reporter
from ._values import Facts, Value, _fields, constants, plain
from .files import check_unread, part_name, reads

_NAMES = {"polarity": "p"}  # C's name: the name in numpy arrays, as in tonic
_FIELDS = {**dict(_fields(_api.tides_event)), "frontend": "<f2"}  # float16, whose bits C has

#: The record: fields t [ns] int64, x, y [px] uint16, p (+1, -1) int8, cause (CAUSES) uint8, frontend (what the front end had
#: added to log-luminance) float16 [log units]; 16 bytes.
EVENT = np.dtype(
    {
        "names": [_NAMES.get(name, name) for name in _FIELDS],
        "formats": list(_FIELDS.values()),
        "offsets": [getattr(_api.tides_event, name).offset for name in _FIELDS],
        "itemsize": sizeof(_api.tides_event),
    }
)

#: Causes of events: {"signal": 0, "leak": 1, ...}.
CAUSES = constants("TIDES_CAUSE_")

#: Columns of labels in a file: {"cause": 1, ...}.
LABELS = constants("TIDES_LABEL_")

#: The records of tonic's datasets and transforms: t [us], p 0 or 1.
TONIC = np.dtype([("x", "<i2"), ("y", "<i2"), ("t", "<i8"), ("p", "i1")])


def make_events(t: Any, x: Any, y: Any, p: Any) -> np.ndarray:
    """An array of EVENT (n) from columns: t [ns], x, y [px], p (1 is ON; 0 or -1, or False, is OFF). ValueError where a value
    doesn't fit."""
    columns = [np.asarray(one) for one in (t, x, y, p)]
    if any(one.shape != columns[0].shape or one.ndim != 1 for one in columns):
        raise ValueError(f"t, x, y, p: shapes {[one.shape for one in columns]}, where four times (n) is needed")
    if columns[0].dtype.kind not in "iu":
        raise ValueError(f"t: {columns[0].dtype}, where whole nanoseconds are needed")
    if len(columns[0]) and int(columns[0].max()) > np.iinfo(np.int64).max:
        raise ValueError("t: beyond the nanoseconds of 64 bits")
    if not np.isin(columns[3], (-1, 0, 1)).all():
        raise ValueError("p: values other than 1, 0 and -1")
    for name, column in (("x", columns[1]), ("y", columns[2])):
        if len(column) and not (column.min() >= 0 and column.max() < 65536):
            raise ValueError(f"{name}: values outside 0 to 65535")
    events = np.zeros(len(columns[0]), EVENT)
    events["t"], events["x"], events["y"] = columns[:3]
    events["p"] = np.where(columns[3] > 0, 1, -1)
    return events


def as_events(events: Any) -> np.ndarray:
    """`events` itself, if it is a contiguous array of EVENT (n); else a copy of its fields t [ns], x, y, p."""
    array = np.asarray(events)
    if array.dtype == EVENT and array.ndim == 1:
        return np.ascontiguousarray(array)
    if array.dtype.names is None or not {"t", "x", "y", "p"} <= set(array.dtype.names):
        raise ValueError(f"events: {array.dtype}, where an array with fields t [ns], x, y, p is needed (tides.make_events)")
    return make_events(array["t"], array["x"], array["y"], array["p"])


def to_tonic(events: Any) -> np.ndarray:
    """A copy as TONIC (n): t floored to microseconds, p 1 for ON and 0 for OFF."""
    events = as_events(events)
    made = np.empty(len(events), TONIC)
    made["x"], made["y"] = events["x"], events["y"]
    made["t"], made["p"] = events["t"] // 1000, events["p"] > 0
    return made


def _records(events: np.ndarray) -> Any:
    """A pointer for C; None for no events."""
    return cast(events.ctypes.data, POINTER(_api.tides_event)) if len(events) else None


def _texts(fields: dict[str, Any]) -> dict[str, Any]:
    """Keyword arguments in the form that C takes."""
    return {name: encoded(value) if isinstance(value, str) else value for name, value in fields.items()}


def _in_order(events: np.ndarray) -> np.ndarray:
    """The events sorted by (t, y, x, p), as in files; without a copy if they are."""
    place = events["y"].astype(np.int64) << 32 | events["x"].astype(np.int64) << 8 | (events["p"] > 0)
    step = np.diff(events["t"])
    if np.all((step > 0) | ((step == 0) & (np.diff(place) >= 0))):
        return events
    return events[np.lexsort((place, events["t"]))]


# -- files ----------------------------------------------------------------------------------------------------------------
def event_formats() -> list[Facts]:
    """The formats: name, summary, endings, reads, writes (bool), tick_ns (times are rounded down to it on writing)."""
    formats: list[Facts] = []
    one = _api.tides_event_format()
    while lib.tides_event_format_at(len(formats), byref(one)):
        facts = plain(one)
        formats.append(Facts(plain(one), reads=bool(one.reads), writes=bool(one.writes)))
    return formats


def events_summary(file: str | os.PathLike[str], **reading: Any) -> Facts:
    """Reads a whole event file, as `reading` (fields of Reading) says. Returns count, count_on, disorder, first_ns, last_ns,
    width, height, right, bottom, layout, version, labels (sum of its LABELS)."""
    summary = _api.tides_event_summary()
    if not reading:
        call("tides_events_summary", path(file), summary)
        return plain(summary)
    with EventReader(file, **reading) as reader:
        call("tides_event_reader_summary", reader._pointer, summary)
    return plain(summary)


class Reading(Value, _api.tides_event_reading):
    """How an event file is read: format; columns of text and tables ("t,x,y,p", - for others); unit of times ("s", "ms", "us",
    "ns"); stream, where a file holds several; drop_invalid; rebase to the recording's zero, and offset_ns added then."""

    _defaults = "tides_event_reading_defaults"


def check_stretch(
    first_ns: int, end_ns: int, start_ns: int, stop_ns: int, file: str | None = None, rebased: bool = False
) -> None:
    """BadArgument if [start_ns, stop_ns) can't belong to a recording from first_ns to end_ns: it lies outside, or begins long
    before."""
    call("tides_event_stretch_check", encoded(file), first_ns, end_ns, start_ns, stop_ns, rebased)


class EventReader(Handle):
    """An event file of any format, read in packets: `for packet in EventReader(file)` gives arrays of EVENT (at most `packet`
    events each), in the file's order, t in nanoseconds of the file's clock. `reading` are the fields of Reading. `facts`:
    format, version, width, height, count (None if only reading tells), labels (sum of LABELS; `read_labelled` reads them),
    read_as (columns and unit, and how they were found), zero_ns and dropped, so far."""

    _destroy = "tides_event_reader_close"

    def __init__(self, file: str | os.PathLike[str], format: str | None = None, packet: int = 65536, **reading: Any):
        made = POINTER(_api.tides_event_reader)()
        if reading:
            how = Reading(format=encoded(format), **_texts(reading))
            call("tides_event_reader_open_as", path(file), how, byref(made))
        else:
            call("tides_event_reader_open", path(file), encoded(format), byref(made))
        super().__init__(made)
        reads(self, file)
        self.packet = packet

    @property
    def facts(self) -> Facts:
        """Facts of the file, and of reading so far."""
        facts = _api.tides_event_facts()
        lib.tides_event_reader_facts(self._pointer, byref(facts))
        told = plain(facts)
        if not told.pop("counted"):
            told["count"] = None
        return told

    def read(self, capacity: int) -> np.ndarray:
        """The next EVENT (n), at most `capacity`; 0 at the end."""
        events, got = np.empty(capacity, EVENT), c_size_t()
        with self._lock:
            call("tides_event_reader_read", self._pointer, _records(events), capacity, byref(got))
        return events[: got.value]

    def __iter__(self) -> Iterator[np.ndarray]:
        while len(packet := self.read(self.packet)):
            yield packet


class EventWriter(Handle):
    """An event file, in the format of its name's ending or the named one (`event_formats()`). In a with statement the file is
    finished at the end, and left as FILE.part where an exception ends it. `run` is a run file's JSON, kept in HDF5 files.
    """

    _destroy = "tides_event_writer_abandon"

    def __init__(
        self,
        file: str | os.PathLike[str],
        width: int,
        height: int,
        format: str | None = None,
        run: str | None = None,
        seed: str | None = None,
        resume: int | None = None,
        labels: bool = False,
        start_ns: int = 0,
        stop_ns: int = 0,
    ):
        """`start_ns`, `stop_ns`: the recording's interval, if known. Times that the format can't hold are refused at once, and
        HDF5 counts from its start if it lies beyond 4294 s or before 0. `resume`: go on with FILE.part after so many events
        (HDF5 only). `labels`: the file gets columns of each event's cause, the time when it fired and what the front end
        added (HDF5 only)."""
        check_unread(file)
        made = POINTER(_api.tides_event_writer)()
        facts = _api.tides_event_file(width, height, encoded(run), encoded(seed), labels, start_ns, stop_ns)
        if resume is not None:
            call("tides_event_writer_resume", path(file), facts, resume, byref(made))
        else:
            call("tides_event_writer_open", path(file), encoded(format), facts, byref(made))
        super().__init__(made)
        self._stop_ns = 0

    def append(self, events: Any, fired: Any = None) -> None:
        """Adds events (n), sorted by (t, y, x, p), none before the last one, all inside the image. `fired` (n): with labels,
        when each fired [ns]; None: at its t."""
        events = as_events(events)
        times = None if fired is None else np.ascontiguousarray(fired, np.int64)
        if times is not None and times.shape != events.shape:
            raise ValueError(f"fired: shape {times.shape}, where one time per event {events.shape} is needed")
        self._append(_records(events), len(events), None if times is None else pointer(times, c_int64))
        if len(events):
            self._stop_ns = max(self._stop_ns, int(events["t"][-1]) + 1)

    def _append(self, records: Any, count: int, fired: Any = None) -> None:
        with self._lock:
            call("tides_event_writer_append", self._pointer, records, fired, count)

    def flush(self) -> None:
        """Makes the events so far survive the death of the process. HDF5 only."""
        with self._lock:
            call("tides_event_writer_flush", self._pointer)

    @property
    def count(self) -> int:
        """Number of events so far."""
        return lib.tides_event_writer_count(self._pointer)

    @property
    def collapsed(self) -> int:
        """Number of events that share their pixel and the format's tick with an earlier one."""
        return lib.tides_event_writer_collapsed(self._pointer)

    def finish(self, stop_ns: int | None = None) -> None:
        """Completes the file, and closes the writer. `stop_ns` is the recording's end; None: after the last event."""
        with self._lock:
            pointer = self._pointer
            self._give_away()
            call("tides_event_writer_finish", pointer, self._stop_ns if stop_ns is None else stop_ns)

    def __exit__(self, kind: Any, *_: Any) -> None:
        if kind is None and not self.closed:
            self.finish()
        else:
            self.close()


def can_resume(file: str | os.PathLike[str]) -> bool:
    """Whether files with this ending can be resumed after an interruption."""
    return bool(lib.tides_event_writer_can_resume(path(file)))


def read_events(
    file: str | os.PathLike[str], first: int = 0, count: int | None = None, **reading: Any
) -> np.ndarray:
    """Events [first, first + count) of a file of any format, as EVENT (n), in the file's order, with cause and frontend if the
    file has them. With `reading`, the fields of Reading, without these."""
    if not reading:
        return read_labelled(file, first, count)[0]
    with EventReader(file, **reading) as reader:
        events = np.concatenate([np.empty(0, EVENT), *reader])
    return events[first : None if count is None else first + count]


def read_labelled(
    file: str | os.PathLike[str], first: int = 0, count: int | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """`read_events`, and the time when each event fired [ns] (n), before the readout; t if the file doesn't tell."""
    with EventReader(file) as reader:
        facts = reader.facts
    if count is None:
        known = events_summary(file)["count"] if facts["count"] is None else facts["count"]
        count = max(0, known - first)
    events, got = np.empty(count, EVENT), c_size_t()
    call("tides_events_read", path(file), first, count, _records(events), byref(got))
    events = events[: got.value]
    fired = events["t"].copy()
    if facts["format"] == "tides" and len(events):
        times = pointer(fired, c_int64)
        call("tides_events_labels", path(file), first, len(events), _records(events), times)
    return events, fired


def write_events(
    file: str | os.PathLike[str],
    events: Any,
    width: int,
    height: int,
    format: str | None = None,
    stop_ns: int | None = None,
) -> int:
    """Writes EVENT (n) to a file of any writable format, in order of (t, y, x, p). Returns how many events share pixel and
    tick with another. A write that fails leaves no FILE.part."""
    events, part = _in_order(as_events(events)), part_name(file)
    writer = EventWriter(file, width, height, format)  # from here on this call owns the .part
    try:
        with writer:
            writer.append(events)
            collapsed = writer.collapsed
            writer.finish(stop_ns)
    except BaseException:
        if part != os.fsdecode(file) and os.path.lexists(part):
            os.unlink(part)
        raise
    return collapsed


class Conversion(Value, _api.tides_event_conversion):
    """The part of a file that is kept: start_ns, stop_ns; the window x, y, cut_width, cut_height; width, height of the sensor.
    And how it is read, as in Reading: rebase, offset_ns, drop_invalid, columns, unit, stream."""

    _defaults = "tides_event_conversion_defaults"


def convert_events(
    file: str | os.PathLike[str],
    out: str | os.PathLike[str],
    source_format: str | None = None,
    format: str | None = None,
    progress: Progress = None,
    filters: Any = None,
    **kept: Any,
) -> Facts:
    """Converts and cuts an event file, streamed, through `filters` (Filters) if given. `kept` are the fields of Conversion.
    Returns read, written, disorder, collapsed, first_ns, last_ns, width, height, from, to."""
    conversion = Conversion(**{"from": encoded(source_format), "to": encoded(format), **_texts(kept)})
    if filters is not None:
        conversion.filters = ctypes.cast(ctypes.pointer(filters), POINTER(_api.tides_filters))
    report = _api.tides_event_conversion_report()
    with Reporter(progress) as step:
        call("tides_events_convert", path(file), path(out), conversion, step, None, report)
    return plain(report)
