"""Optical flow from L and its exact rate: L_dot = -(L_x u + L_y v), solved by least squares in blocks (Lucas and Kanade).

    python optical_flow.py [OUT.png]

The camera slides along a wall, so that the true flow is known: u = -fx velocity / distance everywhere. No second image is
needed: L_dot is the exact derivative at that very time.
"""

import sys
from typing import Any

import numpy as np
import worlds

import tides

WIDTH, HEIGHT, BLOCK = 160, 120, 20  # [px]
VELOCITY, DISTANCE = 1.5, 3.0  # [scene units/s], [scene units]


def flow_of_blocks(log_luminance: Any, log_luminance_dot: Any) -> Any:
    """(rows x columns x 2) flow [px/s] of each block, NaN where its texture doesn't fix it."""
    d_dy, d_dx = np.gradient(log_luminance)  # [1/px]
    flow = np.full((HEIGHT // BLOCK, WIDTH // BLOCK, 2), np.nan)
    for row, column in np.ndindex(flow.shape[:2]):
        block = np.s_[row * BLOCK : (row + 1) * BLOCK, column * BLOCK : (column + 1) * BLOCK]
        slopes = np.column_stack([d_dx[block].ravel(), d_dy[block].ravel()])
        if np.linalg.eigvalsh(slopes.T @ slopes)[0] > 1e-2:
            flow[row, column] = np.linalg.lstsq(slopes, -log_luminance_dot[block].ravel(), rcond=None)[0]
    return flow


def main(output: str = "optical_flow.png") -> float:
    scene = worlds.wall(1500)
    lens = tides.Intrinsics.from_fov(WIDTH, HEIGHT, 0.9)
    camera = tides.Camera(worlds.sideways(VELOCITY, 0.1, DISTANCE), lens)
    frame = tides.Renderer(scene, camera).frame(0.05, ["L", "L_dot"])
    flow = flow_of_blocks(frame["L"], frame["L_dot"])
    true = np.array([-lens.fx * VELOCITY / DISTANCE, 0])
    error = np.linalg.norm(flow - true, axis=-1) / np.linalg.norm(true)
    print(
        f"true flow ({true[0]:.2f}, {true[1]:.2f}) px/s; median of the blocks' {np.nanmedian(flow, axis=(0, 1)).round(2)}"
    )
    print(f"median error of a block: {100 * np.nanmedian(error):.1f} %")
    tides.image.write_png(output, tides.image.picture_signed(frame["L_dot"]))
    print(output)
    return float(np.nanmedian(error))


if __name__ == "__main__":
    main(*sys.argv[1:2])
