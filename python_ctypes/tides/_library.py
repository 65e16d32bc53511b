"""Finds and loads libtides.so, and gives each of its functions the types that the headers declare."""

from __future__ import annotations

import ctypes
import os
from pathlib import Path
from types import SimpleNamespace
from typing import Iterator

from . import _api, _drivers

VERSION = f"{_api.TIDES_VERSION_MAJOR}.{_api.TIDES_VERSION_MINOR}.{_api.TIDES_VERSION_PATCH}"


def _candidates() -> Iterator[str]:
    """Places of the library, best first: this package, TIDES_LIBRARY, the source tree's build/, the system's."""
    here = Path(__file__).resolve().parent
    inside = here / f"libtides.so.{_api.TIDES_VERSION_MAJOR}"
    if inside.exists():
        yield str(inside)
    named = os.environ.get("TIDES_LIBRARY")
    if named:
        yield named
        return  # a named library is the only choice
    build = here.parents[1] / "build" / "libtides.so"
    if build.exists():
        yield str(build)
    yield f"libtides.so.{_api.TIDES_VERSION_MAJOR}"


def _check_version(library: ctypes.CDLL, path: str) -> None:
    library.tides_version.restype = ctypes.c_char_p
    found = library.tides_version().decode()
    if found != VERSION:
        raise OSError(f"{path} is version {found}, and this package is for {VERSION}")


def _load() -> tuple[ctypes.CDLL, str]:
    tried = []
    for path in _candidates():
        try:
            library = ctypes.CDLL(path)  # releases the GIL during calls
            _check_version(library, path)
            return library, path
        except (OSError, AttributeError) as error:
            tried.append(str(error))
    raise ImportError("libtides.so can't be loaded; name it in TIDES_LIBRARY, or run make. Tried: " + "; ".join(tried))


def _bind(library: ctypes.CDLL, path: str) -> SimpleNamespace:
    functions = SimpleNamespace()
    for name, (result, arguments, _) in _api.FUNCTIONS.items():
        try:
            function = getattr(library, name)
        except AttributeError:
            raise ImportError(f"{path} has no {name}: it is older than this package; run make") from None
        function.restype, function.argtypes = result, arguments
        setattr(functions, name, function)
    return functions


def _check_sizes(functions: SimpleNamespace, path: str) -> None:
    """Structs that have a `size` must have the size that this package expects. Otherwise library and package are of different
    versions."""
    for name, (_, arguments, _names) in _api.FUNCTIONS.items():
        struct = getattr(arguments[0], "_type_", None) if name.endswith("_defaults") else None
        if struct is None or struct._fields_[0][0] != "size":
            continue
        room = ctypes.create_string_buffer(ctypes.sizeof(struct) + 4096)  # a larger struct must not write past the end
        filled = ctypes.cast(room, ctypes.POINTER(struct))
        getattr(functions, name)(filled, *([0] * (len(arguments) - 1)))
        if filled.contents.size != ctypes.sizeof(struct):
            raise ImportError(f"{path}: {struct.__name__} has another size than in this package: run make and make python")


_drivers.offer()
_cdll, PATH = _load()
#: Every public function by its C name, such as lib.tides_version().
lib = _bind(_cdll, PATH)
_check_sizes(lib, PATH)
