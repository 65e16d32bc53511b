"""Sweep a parameter: how the number of events and their timing depend on the tolerance of the step control,
where the model between renders says when they are (solve="off").

python sweep.py [OUT.csv]
"""

import csv
import sys
from typing import Any

import worlds

import tides

STOP = 0.04
TOLERANCES = (0.3, 0.1, 0.03, 0.01)


def main(output: str = "sweep.csv") -> None:
    scene = worlds.wall(800)
    worlds.spinner(scene, turns_per_s=10, stop=STOP)
    camera = tides.Camera(worlds.sideways(0.5, STOP), tides.Intrinsics.from_fov(80, 60, 0.8))
    device = tides.Device()  # one for all: kernels are built once

    def simulate(**stepping: Any) -> Any:
        with tides.Simulation(scene, camera, stepping=tides.Stepping(solve="off", **stepping), device=device) as simulation:
            return simulation.run(), simulation.stats

    exact, _ = simulate(mode="fixed", step_s=STOP / 256)
    rows = []
    for tolerance in TOLERANCES:
        events, stats = simulate(tolerance=tolerance)
        report = tides.metrics.match(exact, events)
        rows.append(
            {
                "tolerance": tolerance,
                "events": len(events),
                "renders": round(stats.renders_full_frame_equivalent, 1),
                "dt_median_us": round(report.dt_median_us, 4),
                "dt_p95_us": round(report.dt_p95_us, 4),
                "mismatch_percent": round(report.mismatch_percent, 3),
            }
        )
        print(*(f"{name} {value}" for name, value in rows[-1].items()), sep="  ")
    with open(output, "w", newline="") as file:
        table = csv.DictWriter(file, rows[0])
        table.writeheader()
        table.writerows(rows)
    print(output)


if __name__ == "__main__":
    main(*sys.argv[1:2])
