"""Describes the fields of values, for help() and for completion: default, meaning, unit and range. A key of the run file is
described by the parameter table, and another field by its comment in the header."""

from __future__ import annotations

import ctypes
import functools
import inspect
import keyword
import re
from typing import Any

from ._call import text
from ._library import lib
from ._values import constants, plain

_PIECE = re.compile(r"/\*(?P<comment>.*?)\*/|(?P<fields>[^;/]+);", re.S)


def comments(struct: Any) -> dict[str, str]:
    """The header's comments on the fields of a struct: on a field's line, or on the lines before it."""
    body, found, before, last, end = struct.__doc__ or "", {}, "", [], 0
    for piece in _PIECE.finditer(body):
        if piece["fields"]:
            last = re.findall(r"(\w+)\s*(?:\[[^\]]*\]\s*)*(?:,|$)", piece["fields"].strip())
            found.update({name: before for name in last})
            before, end = "", piece.end()
            continue
        said = re.sub(r"\s*\n\s*(\*\s)?\s*", " ", piece["comment"]).strip()
        said = re.sub(r"(TIDES_\w+_)\*", lambda prefix: f"one of {', '.join(constants(prefix[1]))}", said)
        if last and "\n" not in body[end : piece.start()]:
            found.update({name: f"{found[name]} {said}".strip() for name in last})
        else:
            before = said
    return found


@functools.lru_cache(None)
def _rows() -> dict[str, Any]:
    count = ctypes.c_size_t()
    rows = lib.tides_params(ctypes.byref(count))
    return {text(row.key): row for row in rows[: count.value]}


def _of_row(row: Any) -> str:
    unit = f" [{text(row.unit)}]" if row.unit else ""
    limits = f", {row.lower:g} to {row.upper:g}" if row.lower < row.upper else ""
    choices = f", one of {text(row.choices).replace('|', ', ')}" if row.choices else ""
    return f"{text(row.sentence)}{unit}{limits}{choices}"


def _shown(value: Any) -> str:
    return repr(tuple(value) if isinstance(value, ctypes.Array) else plain(value))


def lines(value: Any, struct: Any, groups: tuple[str, ...], before: str = "") -> list[str]:
    """A line for each field of a value that has its defaults. Fields of structs in it are named name.field."""
    said, made = comments(struct), []
    for name, kind in struct._fields_:
        if name in ("size", "reserved"):
            continue
        path, held = before + name, getattr(value, name)
        if isinstance(held, ctypes.Structure):
            inner = next(one for one in type(held).__mro__ if one.__name__ == kind.__name__)
            made += lines(held, inner, groups, f"{path}.")
            continue
        row = next((_rows()[key] for key in (group + path for group in groups) if key in _rows()), None)
        what = _of_row(row) if row else said.get(name, "")
        made.append(f"{path} = {_shown(held)}{': ' if what else ''}{what}")
        if not before and isinstance(vars(type(value)).get(name), property):
            vars(type(value))[name].__doc__ = what
    return made


class _Shown:
    """A default that a signature shows as a word."""

    def __init__(self, words: str):
        self.words = words

    def __repr__(self) -> str:
        return self.words


def _default(held: Any) -> Any:
    if not isinstance(held, ctypes.Structure):
        return held
    return _Shown(f"{type(held).__name__}({', '.join(f'{name}={value!r}' for name, value in plain(held).items())})")


def describe(cls: Any) -> None:
    """Adds a line for each field to the docstring of a class of values, and a signature with names and defaults."""
    struct = next(one for one in cls.__mro__ if one.__name__.startswith("tides_"))
    value = cls()
    told = lines(value, struct, cls._groups)
    head = [(cls.__doc__ or "").rstrip(), "", "Fields and their defaults:"]
    cls.__doc__ = "\n    ".join(head + [f"    {one}" for one in told])
    names = [name for name, _ in struct._fields_ if name not in ("size", "reserved") and not keyword.iskeyword(name)]
    fields = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=_default(getattr(value, name))) for name in names]
    if cls._preset:
        fields.insert(0, inspect.Parameter("preset", inspect.Parameter.KEYWORD_ONLY, default=None))
    cls.__signature__ = inspect.Signature(fields)
