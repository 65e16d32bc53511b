"""A training set: recordings of walls under a camera that slides at a random speed, labelled with the speed.

    python training_set.py [FOLDER [COUNT]]

`Recordings` is what PyTorch's DataLoader takes (a map-style dataset), and its events are what tonic's transforms take (fields
x, y, t [us], p 0 or 1): pass `transform=tonic.transforms.ToVoxelGrid(...)`. Without tonic it gives tides' own voxel grids.
"""

import json
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import worlds

import tides

WIDTH, HEIGHT, STOP, BINS = 96, 72, 0.04, 5


def simulate(folder: Any, index: int) -> Any:
    """One recording: events as HDF5, the label as JSON. Everything follows from `index`."""
    random = np.random.default_rng(index)
    speed = float(random.uniform(-2, 2))
    scene = worlds.wall(1000, seed=index)
    camera = tides.Camera(worlds.sideways(speed, STOP), tides.Intrinsics.from_fov(WIDTH, HEIGHT, 0.8))
    with tides.Simulation(scene, camera) as simulation:
        stats = simulation.write(folder / f"{index:05d}.h5")
    (folder / f"{index:05d}.json").write_text(json.dumps({"speed": speed, "events": stats.events}))


class Recordings:
    """Recordings of a folder: dataset[k] is (events or what `transform` makes of them, speed)."""

    def __init__(self, folder: Any, transform: Any = None) -> None:
        self.files = sorted(Path(folder).glob("*.h5"))
        self.transform = transform or voxels

    def __len__(self) -> int:
        return len(self.files)

    def __getitem__(self, index: int) -> Any:
        events = tides.to_tonic(tides.read_events(self.files[index]))
        label = json.loads(self.files[index].with_suffix(".json").read_text())
        return self.transform(events), np.float32(label["speed"])


def voxels(events: Any) -> Any:
    """A voxel grid (bins x height x width) of float32 from tonic's events."""
    records = tides.make_events(events["t"] * 1000, events["x"], events["y"], events["p"])
    return tides.voxel_grid(records, WIDTH, HEIGHT, bins=BINS).astype(np.float32)


def main(name: str = "training_set", count: str = "6") -> None:
    folder = Path(name)
    folder.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(2) as pool:  # threads are enough: C runs without the GIL, each simulation on its own device
        list(pool.map(lambda index: simulate(folder, index), range(int(count))))

    dataset = Recordings(folder)
    try:
        from torch.utils.data import DataLoader

        batches = DataLoader(dataset, batch_size=2, shuffle=True)
    except ImportError:
        print("PyTorch isn't installed: batches by hand")
        pairs = ([dataset[k] for k in range(first, min(first + 2, len(dataset)))] for first in range(0, len(dataset), 2))
        batches = ((np.stack([grid for grid, _ in pair]), np.array([speed for _, speed in pair])) for pair in pairs)
    for grids, speeds in batches:
        print("batch", tuple(grids.shape), "speeds", [round(float(speed), 2) for speed in speeds])


if __name__ == "__main__":
    main(*sys.argv[1:3])
