"""A camera on a pan-tilt head that follows a ball by nothing but its own events: a closed loop, live.

python track_ball.py [OUT.png [SECONDS]]

Each step tells the simulator where the head and the ball are STEP_S later, takes the events in between, and steers by them. The
picture shows where the ball was and where the camera looked, and how far the ball was from the image's middle.
"""

import json
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

import tides

WIDTH, HEIGHT, VIEW, STEP_S = 96, 72, 0.5, 5e-3  # [px], [rad] across, [s]
DISTANCE, RADIUS = 5.0, 0.3  # of the ball [scene units]
FEWEST = 5  # events that say where the ball is
ALPHA, BETA, PULL = 0.2, 0.02, 8.0  # of the filter, on direction and on rate; and how fast the head turns to it [1/s]
NOTHING = (1.0, 0.0, 0.0, 0.0)


def ball_at(t: Any) -> Any:
    """Where the ball is: pan and tilt [rad], seen from the head."""
    return np.array([0.7 * np.sin(0.9 * t) + 0.2 * np.sin(2.9 * t), 0.3 * np.sin(1.3 * t)])


def direction(angles: Any) -> Any:
    """Forward, in a world whose axes are those of a camera at rest: x right, y down, z forward."""
    pan, tilt = angles
    return np.array([np.sin(pan) * np.cos(tilt), np.sin(tilt), np.cos(pan) * np.cos(tilt)])


def head_pose(angles: Any) -> Any:
    """The head's pose, camera to world: turned by pan about y, then by tilt about its own x."""
    (cp, ct), (sp, st) = np.cos(angles / 2), np.sin(angles / 2)
    return (0, 0, 0), (cp * ct, -cp * st, sp * ct, sp * st)


def make_run(folder: Any) -> Any:
    """A run file of a speckled ball before a dark wall."""
    random = np.random.default_rng(3)
    points = random.normal(size=(300, 3))
    points *= RADIUS / np.linalg.norm(points, axis=1, keepdims=True)
    scene = tides.Scene()
    scene.add(tides.Gaussians.from_colours(points, 0.05, random.uniform(0.1, 1, (300, 3))), name="ball")
    scene.save(folder / "ball.h5")
    tides.Camera(tides.Trajectory.static((0, 0, 0)), tides.Intrinsics.from_fov(WIDTH, HEIGHT, VIEW)).save(folder / "head.json")
    run = {
        "scene": {"file": "ball.h5", "background": [0.2, 0.2, 0.2]},
        "camera": {"file": "head.json"},
        "stepping": {"step_s": STEP_S, "unit": "block", "tolerance": 0.05},
        "sensor": {"preset": "davis346"},
    }
    (folder / "run.json").write_text(json.dumps(run))
    return folder / "run.json"


def track(seconds: float = 10.0, device: Any = None) -> Any:
    """Follows the ball. A row for each step: time, the ball's direction, the head's, how many events."""
    focal, middle = 0.5 * WIDTH / np.tan(0.5 * VIEW), np.array([WIDTH, HEIGHT]) / 2
    head = guess = ball_at(0) + 0.05  # it begins 0.05 rad off, and knows of no motion
    rate, rows = np.zeros(2), []
    with tempfile.TemporaryDirectory() as folder, tides.Live(make_run(Path(folder)), objects=["ball"], device=device) as live:
        live.tell(head_pose(head), 0)
        live.tell((DISTANCE * direction(ball_at(0)), NOTHING), 0, "ball")
        while live.time < seconds - STEP_S / 2:
            before, head = head, head + STEP_S * (rate + PULL * (guess - head))
            ball = ball_at(live.time + STEP_S)
            events = live.step(head_pose(head), STEP_S, objects={"ball": (DISTANCE * direction(ball), NOTHING)})
            guess = guess + STEP_S * rate
            if len(events) >= FEWEST:  # fewer: it goes on as it did
                where = np.array([np.median(events["x"]), np.median(events["y"])]) + 0.5  # pixel centres
                wrong = (before + head) / 2 + (where - middle) / focal - guess
                guess, rate = guess + ALPHA * wrong, rate + BETA / STEP_S * wrong
            rows.append((live.time, *ball, *head, len(events)))
    return np.array(rows)


# -- the picture ---------------------------------------------------------------------------------------------------------

SIZE, LEFT, GAP = (900, 200), 60, 34  # of a panel, the margin, and between panels [px]
INKS = [(0, 114, 178), (213, 94, 0)]  # blue and vermilion, which everybody tells apart


def panel(title: str, t: Any, curves: Any) -> Any:
    """One panel: curves [(label, values)] over t."""
    width, height = SIZE
    picture = np.full((height + GAP + 20, width + LEFT + 20, 3), 255, np.uint8)
    low, high = min(c.min() for _, c in curves), max(c.max() for _, c in curves)
    low, high = (low - 0.05 * (high - low), high + 0.05 * (high - low)) if high > low else (low - 1, high + 1)
    picture[[GAP, GAP + height], LEFT : LEFT + width + 1] = 160
    picture[GAP : GAP + height + 1, [LEFT, LEFT + width]] = 160
    for share in (0, 0.5, 1):
        row = int(GAP + height * (1 - share))
        picture[row, LEFT : LEFT + width : 4] = 200
        tides.image.picture_text(picture, 4, row - 6, f"{low + share * (high - low):8.3g}")
        tides.image.picture_text(picture, int(LEFT + share * (width - 40)), GAP + height + 4, f"{share * t[-1]:.3g} s")
    tides.image.picture_text(picture, LEFT, 8, title)
    for number, ((label, values), ink) in enumerate(zip(curves, INKS)):
        fine = np.linspace(0, t[-1], 8 * width)
        x = LEFT + fine / t[-1] * width
        y = GAP + height * (high - np.interp(fine, t, values)) / (high - low)
        for thick in (0, 1):
            picture[np.round(y).astype(int) + thick, np.round(x).astype(int)] = ink
        tides.image.picture_text(picture, LEFT + 420 + 200 * number, 8, label, colour=ink)
    return picture


def main(output: str = "track_ball.png", seconds: str = "10") -> None:
    rows = track(float(seconds))
    t, ball, head, count = rows[:, 0], rows[:, 1:3], rows[:, 3:5], rows[:, 5]
    off = np.linalg.norm(ball - head, axis=1) * 0.5 * WIDTH / np.tan(0.5 * VIEW)
    print(f"{len(t)} steps, {int(count.sum())} events; the ball was {np.median(off):.2g} px from the middle in the median, "
          f"{off.max():.2g} px at most")
    panels = [
        panel("pan [rad]", t, [("ball", ball[:, 0]), ("camera", head[:, 0])]),
        panel("tilt [rad]", t, [("ball", ball[:, 1]), ("camera", head[:, 1])]),
        panel("ball from the image's middle [px]", t, [("", off)]),
        panel("events in a step", t, [("", count)]),
    ]
    tides.image.write_png(output, np.ascontiguousarray(np.concatenate(panels)))
    print(output)


if __name__ == "__main__":
    main(*sys.argv[1:3])
