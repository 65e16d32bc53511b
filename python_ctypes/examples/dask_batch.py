"""A batch on a Dask cluster: a wall under a camera that slides past it, for every pair of threshold and dead time.

python dask_batch.py [FOLDER [SCHEDULER]]

FOLDER must be under the same path on every worker. Without a scheduler's address ("tcp://head:8786") the cluster is this
machine: a worker per core. `tides batch FOLDER/grid.json -o FOLDER/results` does the same without Dask.
"""

import json
import sys
from pathlib import Path

import worlds
from distributed import Client, LocalCluster

import tides.distributed

STOP = 0.04


def write_manifest(folder: Path) -> Path:
    """Scene, camera path, run file, and the manifest that names them."""
    folder.mkdir(parents=True, exist_ok=True)
    worlds.wall(1000).save(folder / "wall.h5")
    tides.Camera(worlds.sideways(1.0, STOP), tides.Intrinsics.from_fov(96, 72, 0.8)).save(folder / "path.json")
    run = {"scene": {"file": "wall.h5"}, "camera": {"file": "path.json"}, "time": {"stop": STOP}}
    (folder / "run.json").write_text(json.dumps(run))
    grid = {"sensor.threshold_on": [0.1, 0.2, 0.4], "sensor.refractory_s": [0, 0.005]}
    (folder / "grid.json").write_text(json.dumps({"base": "run.json", "grid": grid}))
    return folder / "grid.json"


def main(name: str = "dask_batch", scheduler: "str | None" = None) -> None:
    folder = Path(name).resolve()
    manifest = write_manifest(folder)
    with Client(scheduler or LocalCluster(threads_per_worker=1)) as client:
        summary = tides.distributed.map(manifest, client, folder / "results", progress=True)
    for row in summary.runs:
        print(row.name, row.state, row.get("events", row.get("error")))


if __name__ == "__main__":
    main(*sys.argv[1:3])
