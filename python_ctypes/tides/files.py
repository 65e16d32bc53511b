"""Files as every writer of TIDES leaves them: whole or not at all, links followed, devices written into."""

from __future__ import annotations

import os
import weakref
from ctypes import c_char_p, create_string_buffer
from typing import Any, Sequence

from ._call import call, path

_LONGEST = 4096 + len(".part")  # PATH_MAX of Linux


def write_bytes(file: str | os.PathLike[str], data: bytes) -> None:
    """Writes a file beside `file`, then renames it; it is on the disk when this returns."""
    call("tides_file_write", path(file), data, len(data))


def check_writable(file: str | os.PathLike[str], streams: bool = True) -> None:
    """Raises if `file` can't be written, before long work. `streams`: it is written from beginning to end."""
    call("tides_file_check", path(file), int(streams))


def _paths(files: Sequence[str | os.PathLike[str]]) -> Any:
    return (c_char_p * max(1, len(files)))(*[path(file) for file in files])


def check_apart(inputs: Sequence[str | os.PathLike[str]], outputs: Sequence[str | os.PathLike[str]]) -> None:
    """Raises ValueError, naming both, if an output is an input or another output, also by other names and links."""
    call("tides_files_apart", _paths(inputs), len(inputs), _paths(outputs), len(outputs))


_readers: "weakref.WeakSet[Any]" = weakref.WeakSet()  # objects with a `file` that they are reading


def reads(reader: Any, file: str | os.PathLike[str]) -> None:
    """Notes that an open handle reads `file`: until it is closed no writer here replaces the file."""
    reader.file = os.path.abspath(file)
    _readers.add(reader)


def check_unread(file: str | os.PathLike[str]) -> None:
    """Raises ValueError if an open handle reads `file`, also by other names and links."""
    check_apart([one.file for one in list(_readers) if not one.closed], [file])


def check_named(file: str | os.PathLike[str], ending: str) -> None:
    """Raises ValueError if a file of the kind `ending` (".json") would be named like another kind ("a.h5")."""
    call("tides_file_named", path(file), ending.encode())


def check_kind(file: str | os.PathLike[str]) -> None:
    """Raises BadFile if `file` is of a kind that nothing here reads (a video, a mesh, an archive). The message says which, and
    what to use for it."""
    call("tides_file_foreign", path(file))


def part_name(file: str | os.PathLike[str]) -> str:
    """The name under which `file` is written."""
    part = create_string_buffer(_LONGEST)
    call("tides_file_part", path(file), part, _LONGEST)
    return os.fsdecode(part.value)
