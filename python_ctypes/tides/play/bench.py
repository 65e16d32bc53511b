"""Measures pictures per second of a scene in the window, and their processor time, without a browser:
python -m tides.play SCENE --bench 30."""

from __future__ import annotations

import time
from typing import Any, Callable

import numpy as np

from .flight import Controls
from .server import packed
from .world import World

WARM = 3  # pictures that don't count: in them kernels are built and the run's first image is rendered
WAYS = {
    "circling": Controls(),
    "ahead": Controls(move=(0, 0, 1), orbit=False),
    "sideways": Controls(move=(1, 0, 0), orbit=False),
    "turning": Controls(turn=(1, 0, 0), orbit=False),
}


def bench(make: Callable[[], World], pictures: int) -> None:
    """Prints a row for each way to fly, of `pictures` pictures from a world's beginning, packed as for a page. Core time is that
    of all threads of this process."""
    print(f"{'':10} {'pictures/s':>10} {'median ms':>10} {'p95 ms':>8} {'core ms':>8} {'events':>8}")
    for name, controls in WAYS.items():
        world = make()
        try:
            walls, core, events = _fly(world, controls, pictures)
        finally:
            world.close()
        median, most = np.quantile(walls, (0.5, 0.95))
        print(f"{name:10} {1e3 / np.mean(walls):10.1f} {median:10.1f} {most:8.1f} {core:8.1f} {events:8.0f}", flush=True)


def _fly(world: World, controls: Controls, pictures: int) -> tuple[np.ndarray, float, float]:
    """The time of each picture [ms], and per picture the core time [ms] and the number of events."""
    facts: dict[str, Any] = {}
    walls, events, core = np.empty(pictures), 0, 0.0
    for k in range(-WARM, pictures):
        if k == 0:
            core = time.process_time()
        begun = time.monotonic()
        fired = world.step(controls)
        packed(facts, world.picture(), fired, world.live.time, world.speed / world.rate)
        if k >= 0:
            walls[k], events = 1e3 * (time.monotonic() - begun), events + len(fired)
    return walls, 1e3 * (time.process_time() - core) / pictures, events / pictures
