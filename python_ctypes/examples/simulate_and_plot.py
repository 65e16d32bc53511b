"""Simulate a disc that spins before a wall, and plot image, L_dot and events side by side.

python simulate_and_plot.py [OUT.png]
"""

import sys
from typing import Any

import numpy as np
import worlds

import tides

WIDTH, HEIGHT, STOP = 240, 180, 0.05
TITLE = 18  # height of the strip above a panel [px]


def titled(title: str, panel: Any) -> Any:
    """The panel below a white strip with its title."""
    strip = np.full((TITLE, WIDTH, 3), 255, np.uint8)
    tides.image.picture_text(strip, 4, 4, title)
    return np.concatenate([strip, panel])


def main(output: str = "simulate_and_plot.png") -> None:
    scene = worlds.wall()
    worlds.spinner(scene, turns_per_s=4, stop=STOP)
    lens = tides.Intrinsics.from_fov(WIDTH, HEIGHT, 1.0)
    camera = tides.Camera(worlds.sideways(0.5, STOP), lens)

    simulation = tides.Simulation(scene, camera, sensor=tides.Sensor(threshold_on=0.15, threshold_off=0.15))
    events = simulation.run(progress=True)
    print(f"{len(events)} events, {100 * np.mean(events['p'] > 0):.0f} % ON, {simulation.stats.run_time_s:.2f} s")

    middle = STOP / 2
    frame = tides.Renderer(scene, camera).frame(middle, ["Y", "L_dot"])
    window = events[np.abs(events["t"] - 1e9 * middle) < 5e6]  # 10 ms
    panels = {
        "luminance": tides.image.picture_grey(frame["Y"]),
        "L_dot": tides.image.picture_signed(frame["L_dot"]),
        f"{len(window)} events of 10 ms": tides.image.picture_events(window, WIDTH, HEIGHT, frame["Y"]),
    }
    row = [titled(title, panel) for title, panel in panels.items()]
    tides.image.write_png(output, np.ascontiguousarray(np.concatenate(row, axis=1)))
    print(output)


if __name__ == "__main__":
    main(*sys.argv[1:2])
