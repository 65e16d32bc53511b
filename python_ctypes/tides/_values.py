"""The C structs as Python objects with defaults, checked names, and words for enums. Results become dicts."""

from __future__ import annotations

import ctypes
import operator
from typing import Any

from . import _api, presets
from ._call import nearest, text
from ._library import lib

_HIDDEN = ("size", "reserved")
_REALS = (ctypes.c_double, ctypes.c_float)
_WHOLE = tuple(getattr(ctypes, f"c_{sign}int{bits}") for sign in ("", "u") for bits in (8, 16, 32, 64))


class Facts(dict):
    """A dict whose keys are attributes too: `stats["events"]` and `stats.events`."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"no {name!r}{nearest(name, self)}") from None


def _fields(struct: Any) -> list[tuple[str, Any]]:
    """Names and types of a struct's fields, without those that only C needs."""
    return [(name, kind) for name, kind in struct._fields_ if name not in _HIDDEN]


def plain(value: Any) -> Any:
    """A struct as Facts, an array as a list, bytes as text, a null pointer as None; numbers unchanged."""
    if isinstance(value, ctypes.Structure):
        return Facts({name: plain(getattr(value, name)) for name, _ in _fields(value)})
    if isinstance(value, ctypes.Array):
        return [plain(one) for one in value]
    if isinstance(value, ctypes._Pointer) and not value:
        return None
    return text(value) if isinstance(value, bytes) else value


def constants(prefix: str) -> dict[str, int]:
    """The constants of an enum by their words: constants("TIDES_MODEL_") gives {"linear": 0, ...}."""
    names = (name for name in vars(_api) if name.startswith(prefix))
    return {name[len(prefix) :].lower(): getattr(_api, name) for name in names}


def choice(name: str, value: str | int, words: dict[str, int]) -> int:
    """The number of a word. ValueError lists the words."""
    if isinstance(value, str):
        if value not in words:
            raise ValueError(f"{name}: {value!r} is none of {', '.join(words)}{nearest(value, words)}")
        return words[value]
    if value not in words.values():
        raise ValueError(f"{name}: {value} is none of {', '.join(f'{word} ({number})' for word, number in words.items())}")
    return int(value)


def _word_property(name: str, field: Any, words: dict[str, int]) -> property:
    back = {number: word for word, number in words.items()}
    return property(
        lambda self: back.get(field.__get__(self), field.__get__(self)),
        lambda self, value: field.__set__(self, choice(name, value, words)),
    )


def _list_property(field: Any) -> property:
    return property(lambda self: tuple(field.__get__(self)), lambda self, value: field.__set__(self, tuple(value)))


def _expected(kind: Any) -> str:
    """A phrase for what a field of this type takes."""
    if kind in _REALS:
        return "a number"
    if kind is ctypes.c_char_p:
        return "a text or None"
    if issubclass(kind, ctypes._Pointer):
        return f"a {kind._type_.__name__}"
    if issubclass(kind, ctypes.Array):
        return f"{kind._length_} times {_expected(kind._type_)}"
    if issubclass(kind, ctypes.Structure):
        return f"a {kind.__name__}, or its fields one by one"
    lower, upper = _bounds(kind)
    return f"a whole number from {lower} to {upper}"


def _bounds(kind: Any) -> tuple[int, int]:
    bits = 8 * ctypes.sizeof(kind)
    return (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if kind(-1).value < 0 else (0, 2**bits - 1)


def _checked(name: str, value: Any, kind: Any) -> None:
    """Checks a value before ctypes takes it. ctypes would wrap whole numbers that don't fit, extend short arrays, and take a
    number for a text's address."""
    if kind is ctypes.c_char_p:
        if not isinstance(value, (str, bytes, type(None))):
            raise TypeError
        return
    if issubclass(kind, ctypes.Array):
        fits = len(tuple(value)) == kind._length_
    elif kind in _WHOLE and not isinstance(value, str):
        lower, upper = _bounds(kind)
        fits = lower <= operator.index(value) <= upper
    else:
        return
    if not fits:
        raise ValueError(f"{name}: {value!r}, where {_expected(kind)} is needed")


def _set_field(self: Any, name: str, value: Any) -> None:
    """Sets a field of a struct. A wrong value is refused with the field's name and what it takes."""
    kinds = dict(_fields(self))
    if name not in kinds:
        raise AttributeError(f"{type(self).__name__} has no {name!r}{nearest(name, kinds)}")
    place = f"{type(self).__name__}.{name}"
    try:
        if name not in getattr(self, "_words", ()):
            _checked(place, value, kinds[name])
        ctypes.Structure.__setattr__(self, name, value)
    except TypeError:
        raise TypeError(f"{place}: {value!r}, where {_expected(kinds[name])} is needed") from None


def filled(struct: Any, **fields: Any) -> Any:
    """A struct with these fields, checked by their names."""
    made = struct()
    for name, value in fields.items():
        _set_field(made, name, value)
    return made


def _guard(struct: Any) -> None:
    """Makes structs inside of values check their fields too."""
    for _, kind in struct._fields_:
        if issubclass(kind, ctypes.Structure):
            kind.__setattr__ = _set_field
            _guard(kind)


def _text_property(field: Any) -> property:
    return property(
        lambda self: None if field.__get__(self) is None else text(field.__get__(self)),
        lambda self, value: field.__set__(self, value.encode() if isinstance(value, str) else value),
    )


class Value:
    """A struct of the library as a plain value: keyword arguments set fields, the rest have the library's defaults; unknown
    names are refused; enums take and give their words ("hermite"); arrays are tuples. `==`, `copy()`, `to_dict()`."""

    _defaults: str | None = None  # the C function that fills the struct
    _words: dict[str, str] = {}  # field: prefix of its enum's constants
    _groups: tuple[str, ...] = ()  # groups of run file keys whose sentences describe the fields
    _preset: str | None = None  # group of the run file that presets fill it from; `preset` is then an argument

    def __init_subclass__(cls, **more: Any):
        super().__init_subclass__(**more)
        _guard(cls)
        for name, kind in _fields(cls):
            if name in cls._words:
                setattr(cls, name, _word_property(name, getattr(cls, name), constants(cls._words[name])))
            elif kind is ctypes.c_char_p:
                setattr(cls, name, _text_property(getattr(cls, name)))
            elif issubclass(kind, ctypes.Array):
                setattr(cls, name, _list_property(getattr(cls, name)))

    def __init__(self, *unnamed: Any, **fields: Any):
        super().__init__()
        if unnamed:  # positional arguments would depend on the order of a struct's fields
            raise TypeError(f"{type(self).__name__}: {unnamed[0]!r} has no name: its fields are given as name=value")
        preset = fields.pop("preset", None) if self._preset else None
        if preset is not None:
            presets.fill(self, self._preset, preset)
        elif self._defaults:
            getattr(lib, self._defaults)(self)
        self.set(**fields)

    def set(self, **fields: Any) -> Any:
        """Sets fields by name; returns itself."""
        known = [name for name, _ in _fields(self)]
        for name, value in fields.items():
            if name not in known:
                raise TypeError(f"{type(self).__name__} has no {name!r}{nearest(name, known)}")
            setattr(self, name, value)
        return self

    def __setattr__(self, name: str, value: Any) -> None:
        _set_field(self, name, value)

    @classmethod
    def _from(cls, struct: Any, owner: Any = None) -> Any:
        """A copy of a struct of the same layout. `owner` holds the memory that its pointers point to."""
        made: Any = cls.__new__(cls)
        ctypes.memmove(ctypes.addressof(made), ctypes.addressof(struct), ctypes.sizeof(made))
        ctypes.Structure.__setattr__(made, "_owners", (struct, owner))
        return made

    def copy(self, **fields: Any) -> Any:
        """The same value with some fields changed."""
        return self._from(self).set(**fields)

    def to_dict(self) -> Facts:
        """The fields as a dict, enums as words."""
        return Facts({name: plain(getattr(self, name)) for name, _ in _fields(self)})

    def __reduce__(self) -> Any:
        """Pickles the fields, since ctypes can't pickle texts."""
        return _filled, (type(self), {name: getattr(self, name) for name, _ in _fields(self)})

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Value) and type(self) is type(other) and self.to_dict() == other.to_dict()

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in self.to_dict().items())})"


def _filled(kind: Any, fields: dict[str, Any]) -> Any:
    """Unpickles a value."""
    return kind(**fields)
