"""Progress of long work, and its end on Ctrl-C. C calls back now and then, and Python's signals are handled there."""

from __future__ import annotations

import sys
import threading
from typing import Any, Callable, Union

from . import _api
from ._call import kept, pending, text

#: None: silent. True: a bar of tqdm if that is installed, else a line on stderr per tenth. A function: called with the
#: fraction done and the stage's name; it stops the work by returning something true (Cancelled) or by raising.
Progress = Union[None, bool, Callable[[float, str], Any]]


class _Lines:
    """Progress without tqdm."""

    def __init__(self) -> None:
        self.last = ("", -1)

    def __call__(self, fraction: float, stage: str) -> None:
        now = (stage, int(10 * fraction))
        if now != self.last:
            print(f"tides: {stage} {10 * now[1]} %", file=sys.stderr)
            self.last = now

    def close(self) -> None:
        pass


class _Bar:
    def __init__(self, tqdm: Any):
        self.bar = tqdm(total=1.0, bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining}")

    def __call__(self, fraction: float, stage: str) -> None:
        self.bar.set_description(stage, refresh=False)
        self.bar.update(fraction - self.bar.n)

    def close(self) -> None:
        self.bar.close()


def shower() -> Any:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return _Lines()
    return _Bar(tqdm)


class Reporter:
    """A tides_progress for one piece of work: `with Reporter(progress) as callback`. `cancel` (an Event) stops it from another
    thread."""

    def __init__(self, progress: Progress, cancel: threading.Event | None = None):
        self._progress, self._cancel = progress, cancel
        self._shown: Any = None

    def _step(self, _user: Any, fraction: float, stage: bytes) -> int:
        if pending():
            return 1
        if self._shown is not None:
            self._shown(fraction, text(stage))
        stop = self._progress(fraction, text(stage)) if callable(self._progress) else False
        return 1 if stop or (self._cancel is not None and self._cancel.is_set()) else 0

    def __enter__(self) -> Any:
        self._shown = shower() if self._progress is True else None
        return _api.tides_progress(kept(self._step, 1))

    def __exit__(self, *_: Any) -> None:
        if self._shown is not None:
            self._shown.close()
