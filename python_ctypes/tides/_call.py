"""Calls into the library: errors become exceptions, exceptions in callbacks survive C, and numpy arrays become pointers."""

from __future__ import annotations

import ctypes
import json
import os
import re
import signal
import threading
from typing import Any, Callable

import numpy as np

from . import _api, errors
from ._library import lib

_local = threading.local()

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGALRM, signal.SIGUSR1)  # users' handlers of these may raise


class _Signals:
    """Keeps Python's handlers of signals from raising in a callback of C.

    The interpreter runs a handler at its next check for signals. While C works, this check is at the first instruction of a
    callback, before any `try` in it. An exception there would be printed and lost. So it is caught here, and raised when C has
    returned.
    """

    def __enter__(self) -> None:
        self.replaced: list[tuple[int, Any]] = []
        if threading.current_thread() is threading.main_thread():  # handlers run in this thread only
            for number in _SIGNALS:
                handler = signal.getsignal(number)
                if callable(handler) and not isinstance(getattr(handler, "__self__", None), _Signals):
                    self.replaced.append((number, handler))
                    signal.signal(number, self._handle)

    def _handle(self, number: int, frame: Any) -> None:
        try:
            dict(self.replaced)[number](number, frame)
        except BaseException as raised:
            _local.raised = raised

    def __exit__(self, *_: Any) -> None:
        for number, handler in self.replaced:
            signal.signal(number, handler)


def _refused(name: str, arguments: tuple[Any, ...], why: ctypes.ArgumentError) -> TypeError:
    """Replaces ctypes' "argument 3: wrong type" by the argument's name and what it takes."""
    from ._values import _expected

    number = re.match(r"argument (\d+)", str(why))
    place = int(number[1]) - 1 if number else len(arguments)
    _, kinds, names = _api.FUNCTIONS[name]
    if place >= len(arguments):
        return TypeError(f"{name}: {why}")
    return TypeError(f"{names.split()[place]}: {arguments[place]!r}, where {_expected(kinds[place])} is needed ({name})")


def call(name: str, *arguments: Any) -> None:
    """Calls a function that returns a tides_status and takes a tides_error last. An exception of a callback or a signal's
    handler (Ctrl-C) is raised first."""
    error = _api.tides_error()
    outer, _local.raised = getattr(_local, "raised", None), None
    try:
        with _Signals():
            status = getattr(lib, name)(*arguments, error)
        raised = _local.raised
    except ctypes.ArgumentError as why:
        raise _refused(name, arguments, why) from None
    finally:
        _local.raised = outer
    if raised is not None:
        raise raised
    if status != _api.TIDES_OK:
        raise errors.make(status, text(lib.tides_status_name(status)), text(error.text))


def pending() -> bool:
    """Whether an exception waits until C returns: work that can stop should stop."""
    return getattr(_local, "raised", None) is not None


def kept(function: Callable[..., int], stop: int) -> Callable[..., int]:
    """A callback that never raises into C: an exception is kept for `call`, and C gets `stop`. The callback still does its
    work if only a signal's exception waits: otherwise events on their way to a sink would be lost."""

    def guarded(*arguments: Any) -> int:
        try:
            return function(*arguments)
        except BaseException as raised:
            _local.raised = raised
            return stop

    return guarded


def text(value: bytes | None) -> str:
    return value.decode("utf-8", "replace") if value else ""


def _whole(value: bytes) -> bytes:
    """Refuses a text with NUL, at which C would end it."""
    if b"\0" in value:
        raise ValueError(f"{text(value)!r}: holds a NUL, which no name and no text of a run does")
    return value


def path(value: str | os.PathLike[str]) -> bytes:
    return _whole(os.fsencode(value))


def encoded(value: str | None) -> bytes | None:
    return None if value is None else _whole(value.encode())


def _as_plain(value: Any) -> Any:
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise TypeError(f"{value!r}: a run file holds numbers, texts, lists and dicts of them")


def as_json(value: Any) -> str:
    """A value for a run file's key as JSON. Also numpy's numbers and arrays, and paths."""
    return json.dumps(value, default=_as_plain)


def array(value: Any, dtype: Any, shape: tuple[int | None, ...], name: str) -> np.ndarray:
    """`value` as a C-contiguous array, without a copy if it is one already. ValueError if it has another shape (None: any
    length)."""
    made = np.ascontiguousarray(value, dtype)
    if made.ndim != len(shape) or any(want is not None and want != got for want, got in zip(shape, made.shape)):
        wanted = " x ".join("n" if n is None else str(n) for n in shape)
        raise ValueError(f"{name}: shape {made.shape}, where ({wanted}) is needed")
    return made


def pointer(values: np.ndarray, kind: Any) -> Any:
    """A typed pointer to an array's first element. It keeps the array alive."""
    return values.ctypes.data_as(ctypes.POINTER(kind))


def doubles(values: Any, count: int, name: str) -> Any:
    """A C array of `count` doubles."""
    return (ctypes.c_double * count)(*array(values, np.float64, (count,), name))


def instance(value: Any, kind: Any, name: str) -> Any:
    """`value`, where it is a `kind`; TypeError naming both."""
    if isinstance(value, kind):
        return value
    article = "an" if kind.__name__[0] in "AEIOU" else "a"
    raise TypeError(f"{name}: {value!r}, where {article} {kind.__name__} is needed")


def given(value: Any, kind: Any, name: str) -> Any:
    """`value`, if it is a `kind`; None: a `kind` with its defaults. TypeError naming both."""
    return kind() if value is None else instance(value, kind, name)


def nearest(name: str, names: Any) -> str:
    """ ", did you mean ...?" where one of `names` is near."""
    import difflib

    found = difflib.get_close_matches(name, list(names), 1)
    return f"; did you mean {found[0]!r}?" if found else ""
