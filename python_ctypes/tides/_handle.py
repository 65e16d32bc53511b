"""The base of wrapped objects: closing, owners that must outlive them, and a lock."""

from __future__ import annotations

import threading
import weakref
from typing import Any

from ._library import lib


def _release(destroy: str, pointer: Any, owners: tuple[Any, ...]) -> None:
    """Frees an object once: at close, when no reference is left, or at exit. `owners` live until then."""
    if destroy:
        getattr(lib, destroy)(pointer)


class Handle:
    """An object of the library. `close()`, or a with statement, frees it at once; garbage collection does too.

    Thread rule: an object may be used from several threads. Calls that change it wait for each other, and so do calls on
    objects of one Device. For parallel work open a Device for each thread, which is the default. The GIL is released while
    C works.
    """

    _destroy: str

    def __init__(self, pointer: Any, *owners: "Handle", lock: Any = None):
        self._lock = lock or threading.RLock()
        self._users: weakref.WeakSet[Handle] = weakref.WeakSet()
        self._loans: list[weakref.ref[Handle]] = []
        self._lender: Handle | None = None
        self._held = pointer
        self._finalizer = weakref.finalize(self, _release, self._destroy, pointer, owners)
        for owner in owners:
            owner._users.add(self)

    @classmethod
    def _lent(cls, pointer: Any, owner: "Handle") -> Any:
        """An object that `owner` owns in C: it closes with its owner."""
        made = cls._of(pointer) if hasattr(cls, "_of") else cls.__new__(cls)
        if hasattr(made, "_finalizer"):
            made._give_away()
        made._destroy = ""
        Handle.__init__(made, pointer, lock=owner._lock)
        made._lender = owner  # not as an owner: the lender owns this object
        owner._loans.append(weakref.ref(made))
        return made

    @property
    def closed(self) -> bool:
        """Whether this object, or the one that lent it, was closed."""
        return not self._finalizer.alive or (self._lender is not None and self._lender.closed)

    @property
    def _pointer(self) -> Any:
        if self.closed:
            raise ValueError(f"this {type(self).__name__} is closed")
        return self._held

    def _unused(self, what: str) -> None:
        """ValueError if an open object still uses this one."""
        user = next((one for one in self._users if not one.closed), None)
        if user is not None:
            raise ValueError(
                f"this {type(self).__name__} can't be {what}: a {type(user).__name__} uses it; close that first"
            )
        for loan in (reference() for reference in self._loans):
            if loan is not None:
                loan._unused(what)

    def close(self) -> None:
        """Frees the object now. ValueError if another object needs it. Closing twice is fine."""
        with self._lock:
            self._unused("closed")
            self._finalizer()

    def _give_away(self) -> None:
        """Marks the object as taken over by the library."""
        self._finalizer.detach()

    def __reduce__(self) -> Any:
        """Only objects that know their file or values can be pickled; others are memory of this process."""
        raise TypeError(
            f"a {type(self).__name__} can't be pickled: it is open in this process alone. Pickle what it is made of (Run, "
            "Scene, Camera, Trajectory and parameters can be) and make it anew where it is needed"
        )

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()
