"""Files as every writer of TIDES leaves them: whole or not at all, links followed, devices written into (`tides/base.h`)."""

from __future__ import annotations

import os
from ctypes import create_string_buffer

from ._call import call, path

_LONGEST = 4096 + len(".part")  # PATH_MAX of Linux


def write_bytes(file: str | os.PathLike[str], data: bytes) -> None:
    """Writes all bytes of a file beside it, then in its place, on the disk when this returns."""
    call("tides_file_write", path(file), data, len(data))


def check_writable(file: str | os.PathLike[str], streams: bool = True) -> None:
    """Raises where `file` can't be written, before long work. `streams`: whether it is written from beginning to end."""
    call("tides_file_check", path(file), int(streams))


def check_kind(file: str | os.PathLike[str]) -> None:
    """Raises BadFile where `file` is of a kind that nothing here reads (a video, a mesh, an archive): what, and what gets
    further with it."""
    call("tides_file_foreign", path(file))


def part_name(file: str | os.PathLike[str]) -> str:
    """The name under which `file` is written."""
    part = create_string_buffer(_LONGEST)
    call("tides_file_part", path(file), part, _LONGEST)
    return os.fsdecode(part.value)
