"""What every wrapped object has in common: an end, owners that outlive it, and a lock."""

from __future__ import annotations

import threading
import weakref
from typing import Any

from ._library import lib


def _release(destroy: str, pointer: Any, owners: tuple[Any, ...]) -> None:
    """Runs once: at close, when nobody refers to the object any more, or at exit. `owners` live until then."""
    getattr(lib, destroy)(pointer)


class Handle:
    """An object of the library. `close()`, or a with statement, frees it at once; garbage collection does too.

    Thread rule: an object may be used from several threads; calls that change it wait for each other, and so do those on
    objects of one Device. For work in parallel, open a Device for each thread (which is what happens where none is given).
    The GIL is released while C works.
    """

    _destroy: str

    def __init__(self, pointer: Any, *owners: "Handle", lock: Any = None):
        self._lock = lock or threading.RLock()
        self._users: weakref.WeakSet[Handle] = weakref.WeakSet()
        self._held = pointer
        self._finalizer = weakref.finalize(self, _release, self._destroy, pointer, owners)
        for owner in owners:
            owner._users.add(self)

    @property
    def closed(self) -> bool:
        return not self._finalizer.alive

    @property
    def _pointer(self) -> Any:
        if self.closed:
            raise ValueError(f"this {type(self).__name__} is closed")
        return self._held

    def _unused(self, what: str) -> None:
        """ValueError where an open object still looks at this one."""
        user = next((one for one in self._users if not one.closed), None)
        if user is not None:
            raise ValueError(
                f"this {type(self).__name__} can't be {what}: a {type(user).__name__} uses it; close that first"
            )

    def close(self) -> None:
        """Frees the object now. ValueError while another one needs it; closing twice is fine."""
        with self._lock:
            self._unused("closed")
            self._finalizer()

    def _give_away(self) -> None:
        """The library has taken the object over."""
        self._finalizer.detach()

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()
