"""Finds the known name that a misspelt one stands for."""

from __future__ import annotations

from ctypes import c_char_p
from typing import Iterable

from ._library import lib


def nearest_name(name: str, names: Iterable[str]) -> str | None:
    """The one of `names` that a misspelt or abbreviated `name` probably means; None if none is near.

    The library's errors suggest it: `nearest_name("treshold_on", ["threshold_on", "seed"])` is "threshold_on".
    """
    texts = [one.encode() for one in names]
    near = lib.tides_nearest_name(name.encode(), (c_char_p * (len(texts) + 1))(*texts, None))
    return None if near is None else near.decode()
