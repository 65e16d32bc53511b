"""Names that people write: which one was meant (`tides/base.h`)."""

from __future__ import annotations

from ctypes import c_char_p
from typing import Iterable

from ._library import lib


def nearest_name(name: str, names: Iterable[str]) -> str | None:
    """The one of `names` that a misspelt or abbreviated `name` was probably meant to be; None where none is near.

    It is what the library's own errors suggest: `nearest_name("treshold_on", ["threshold_on", "seed"])` is "threshold_on".
    """
    texts = [one.encode() for one in names]
    near = lib.tides_nearest_name(name.encode(), (c_char_p * (len(texts) + 1))(*texts, None))
    return None if near is None else near.decode()
