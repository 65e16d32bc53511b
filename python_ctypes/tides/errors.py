"""Exceptions by kind. Each is a TidesError, and a builtin exception where one fits: `except ValueError` works."""

from __future__ import annotations

from . import _api


class TidesError(Exception):
    """A call failed. The text is one line: the fault, its place, and how to mend it."""

    status: int = -1  #: TIDES_* of base.h
    name: str = "TIDES_UNKNOWN_STATUS"  #: "TIDES_BAD_FILE"


class BadArgument(TidesError, ValueError):
    """An argument is out of range or inconsistent."""


class NoMemory(TidesError, MemoryError):
    """Out of memory."""


class FileMissing(TidesError, FileNotFoundError):
    """A file can't be opened."""


class BadFile(TidesError, OSError):
    """A file's content isn't valid for its kind."""


class WriteFailed(TidesError, OSError):
    """A file can't be written."""


class BadConfig(TidesError, ValueError):
    """A run file or setting is wrong."""


class Unsupported(TidesError, NotImplementedError):
    """This version can't do that."""


class NoDevice(TidesError, RuntimeError):
    """No OpenCL device matches."""


class DeviceFailed(TidesError, RuntimeError):
    """An OpenCL call or kernel build failed."""


class Cancelled(TidesError):
    """Stopped on request."""


class OutOfRange(TidesError, ValueError):
    """A time lies outside what the data covers."""


BY_STATUS: dict[int, type[TidesError]] = {
    _api.TIDES_BAD_ARGUMENT: BadArgument,
    _api.TIDES_NO_MEMORY: NoMemory,
    _api.TIDES_FILE_NOT_FOUND: FileMissing,
    _api.TIDES_BAD_FILE: BadFile,
    _api.TIDES_WRITE_FAILED: WriteFailed,
    _api.TIDES_BAD_CONFIG: BadConfig,
    _api.TIDES_UNSUPPORTED: Unsupported,
    _api.TIDES_NO_DEVICE: NoDevice,
    _api.TIDES_DEVICE_FAILED: DeviceFailed,
    _api.TIDES_CANCELLED: Cancelled,
    _api.TIDES_OUT_OF_RANGE: OutOfRange,
}


def make(status: int, name: str, text: str) -> TidesError:
    """Makes the exception for a status of the library."""
    made = BY_STATUS.get(status, TidesError)(text)
    made.status, made.name = status, name
    return made
