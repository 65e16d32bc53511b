"""Calls into the library: errors become exceptions, exceptions in callbacks survive C, and numpy arrays become pointers."""

from __future__ import annotations

import ctypes
import os
import threading
from typing import Any, Callable

import numpy as np

from . import _api, errors
from ._library import lib

_local = threading.local()

NO_PROGRESS = _api.tides_progress()


def call(name: str, *arguments: Any) -> None:
    """Calls a function that returns a tides_status and takes a tides_error last. What a callback raised meanwhile comes first:
    Ctrl-C is such a thing."""
    error = _api.tides_error()
    outer, _local.raised = getattr(_local, "raised", None), None
    try:
        status = getattr(lib, name)(*arguments, error)
        raised = _local.raised
    finally:
        _local.raised = outer
    if raised is not None:
        raise raised
    if status != _api.TIDES_OK:
        raise errors.make(status, text(lib.tides_status_name(status)), text(error.text))


def kept(function: Callable[..., int], stop: int) -> Callable[..., int]:
    """A callback that never raises into C: the exception is kept for `call`, and `stop` is what C is told."""

    def guarded(*arguments: Any) -> int:
        try:
            return function(*arguments)
        except BaseException as raised:  # KeyboardInterrupt too
            _local.raised = raised
            return stop

    return guarded


def text(value: bytes | None) -> str:
    return value.decode("utf-8", "replace") if value else ""


def path(value: str | os.PathLike[str]) -> bytes:
    return os.fsencode(value)


def encoded(value: str | None) -> bytes | None:
    return None if value is None else value.encode()


def array(value: Any, dtype: Any, shape: tuple[int | None, ...], name: str) -> np.ndarray:
    """`value` as a C-contiguous array, itself where it is one already; ValueError where the shape (None: any) is another."""
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


def nearest(name: str, names: Any) -> str:
    """", did you mean ...?" where one of `names` is near."""
    import difflib

    found = difflib.get_close_matches(name, list(names), 1)
    return f"; did you mean {found[0]!r}?" if found else ""
