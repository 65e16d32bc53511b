"""Small scenes for the examples: what a trained splat file would be otherwise (tides.Scene("room.ply"))."""

import numpy as np

import tides


def wall(n: int = 3000, width: float = 6.0, height: float = 4.5, seed: int = 1) -> tides.Scene:
    """A wall of coloured spots in the plane z = 0, in front of a grey one."""
    random = np.random.default_rng(seed)
    spots = np.column_stack(
        [random.uniform(-width / 2, width / 2, n), random.uniform(-height / 2, height / 2, n), np.zeros(n)]
    )
    columns, rows = np.meshgrid(np.linspace(-width / 2, width / 2, 40), np.linspace(-height / 2, height / 2, 30))
    plane = np.column_stack([columns.ravel(), rows.ravel(), np.full(columns.size, 0.01)])
    scene = tides.Scene()
    thin = [width / 60, width / 60, 0.002]
    scene.add(tides.Gaussians.from_colours(plane, thin, np.full((len(plane), 3), 0.4)), name="wall")
    sizes = np.column_stack([random.uniform(0.03, 0.07, (n, 2)), np.full(n, 0.002)])
    scene.add(tides.Gaussians.from_colours(spots, sizes, random.uniform(0.05, 1, (n, 3)), opacity=0.8), name="spots")
    return scene


def spinner(scene: tides.Scene, turns_per_s: float, stop: float, n: int = 120, seed: int = 2) -> None:
    """Adds a disc of spots that turns in front of the wall."""
    random = np.random.default_rng(seed)
    radius, angle = 0.6 * np.sqrt(random.uniform(0, 1, n)), random.uniform(0, 2 * np.pi, n)
    spots = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(n)])
    times = np.linspace(0, stop, max(2, int(16 * turns_per_s * stop) + 1))
    half = np.pi * turns_per_s * times
    quaternions = np.column_stack([np.cos(half), 0 * half, 0 * half, np.sin(half)])
    rates = np.tile([0, 0, 2 * np.pi * turns_per_s], (len(times), 1))
    path = tides.Trajectory(times, np.tile([0, 0, -1.0], (len(times), 1)), quaternions, 0 * rates, rates)
    scene.add(tides.Gaussians.from_colours(spots, 0.05, random.uniform(0, 1, (n, 3))), path, name="spinner")


def sideways(velocity: float, stop: float, distance: float = 3.0) -> tides.Trajectory:
    """A camera that looks at the wall and slides along x at `velocity` [scene units/s]."""
    x = 0.5 * velocity * stop
    return tides.Trajectory([0, stop], [[-x, 0, -distance], [x, 0, -distance]], [[1, 0, 0, 0]] * 2)
