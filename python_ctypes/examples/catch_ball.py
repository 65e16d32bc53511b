"""A ball is thrown in MuJoCo, and a camera on a motorised head follows it by nothing but its own events.

python catch_ball.py [OUT.png]

MuJoCo moves ball and head, TIDES makes of each of its steps the events that the camera on the head would send, and the head's
motors turn by them. The picture shows how far the ball was from the image's middle, and the motors' speed.
"""

import json
import sys
import tempfile
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

import tides
import tides.mujoco

MODEL = """
<mujoco>
  <option timestep="0.002" gravity="0 0 -9.81"/>
  <worldbody>
    <body name="ball" pos="-1.6 4 1.2"><freejoint/><geom type="sphere" size="0.12" mass="0.1"/></body>
    <body name="pan" pos="0 0 1.5">
      <joint name="pan" axis="0 0 1" armature="0.01"/><geom type="box" size="0.04 0.04 0.04" mass="0.3"/>
      <body name="tilt">
        <joint name="tilt" axis="1 0 0" armature="0.01"/><geom type="box" size="0.03 0.05 0.03" mass="0.2"/>
        <camera name="eye" pos="0 0.05 0" xyaxes="1 0 0 0 0 1" fovy="40" resolution="96 72"/>
      </body>
    </body>
  </worldbody>
  <actuator><velocity joint="pan" kv="0.6"/><velocity joint="tilt" kv="0.6"/></actuator>
</mujoco>
"""
THROW = (2.6, 0.0, 4.2)  # [m/s]
RADIUS, SECONDS, FEWEST = 0.12, 0.85, 5  # of the ball [m], of the flight [s], and events that say where it is
ALPHA, BETA, PULL = 0.2, 0.01, 12.0  # of the filter on direction and its rate; and how fast the head goes there [1/s]
AIM = (0.28, 0.02)  # where the head looks when the ball is thrown: pan, tilt [rad], some way beside it


def make_run(folder: Path, model: Any, data: Any) -> Path:
    """A speckled ball in the dark, seen by the model's camera; a unit is a metre."""
    random = np.random.default_rng(3)
    points = random.normal(size=(200, 3))
    points *= RADIUS / np.linalg.norm(points, axis=1, keepdims=True)
    scene = tides.Scene()
    scene.add(tides.Gaussians.from_colours(points, 0.03, random.uniform(0.1, 1, (200, 3))), name="ball")
    scene.save(folder / "ball.h5")
    tides.mujoco.write_camera(folder / "eye.json", tides.mujoco.Poses(model, data, 1.0), "eye")
    run = {
        "scene": {"file": "ball.h5", "background": [0.2, 0.2, 0.2], "metres_per_unit": 1},
        "camera": {"file": "eye.json"},
        "stepping": {"step_s": model.opt.timestep, "tolerance": 0.1},
        "sensor": {"threshold_on": 0.15, "threshold_off": 0.15},
    }
    (folder / "run.json").write_text(json.dumps(run))
    return folder / "run.json"


def catch(device: Any = None) -> np.ndarray:
    """Throws the ball. A row for each step: time, where the ball is from the image's middle (2) [px], the motors' speeds (2)
    [rad/s], how many events."""
    model = mujoco.MjModel.from_xml_string(MODEL)
    data, rows = mujoco.MjData(model), []
    data.qvel[:3], data.qpos[7:9] = THROW, AIM
    lens = tides.mujoco.intrinsics(model, "eye")
    middle, dt = np.array([lens.cx, lens.cy]), model.opt.timestep
    guess, rate = data.qpos[7:9].copy(), np.zeros(2)  # of the ball: pan and tilt; it knows of no motion
    with tempfile.TemporaryDirectory() as folder:
        run = make_run(Path(folder), model, data)
        with tides.mujoco.Loop(run, model, data, camera="eye", bodies={"ball": "ball"}, device=device) as loop:
            while data.time < SECONDS:
                data.ctrl[:] = rate + PULL * (guess - data.qpos[7:9])
                mujoco.mj_step(model, data)
                events = loop.step()
                guess = guess + dt * rate
                if len(events) >= FEWEST:
                    seen = np.array([np.median(events["x"]), np.median(events["y"])]) + 0.5 - middle
                    wrong = data.qpos[7:9] - seen / lens.fx - guess  # right and down are less pan and less tilt
                    guess, rate = guess + ALPHA * wrong, rate + BETA / dt * wrong
                rows.append((data.time, *(where_is_ball(loop, lens) - middle), *data.qvel[6:8], len(events)))
    return np.array(rows)


def where_is_ball(loop: Any, lens: Any) -> np.ndarray:
    """The pixel of the ball's centre, for the picture alone: the head doesn't know it."""
    eye, quaternion = loop.poses.camera("eye")[:2]
    ball = loop.poses.body("ball")[0]
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, quaternion)
    x, y, z = matrix.reshape(3, 3).T @ (ball - eye)
    return np.array([lens.fx * x / z + lens.cx, lens.fy * y / z + lens.cy])


def main(output: str = "catch_ball.png") -> None:
    from track_ball import panel  # beside this file

    rows = catch()
    off = np.linalg.norm(rows[:, 1:3], axis=1)
    late = off[len(off) // 2 :]
    print(f"{int(rows[:, 5].sum())} events; the ball was {off[0]:.3g} px from the middle, {off.max():.3g} px at most, and "
          f"{np.median(late):.2g} px in the median of the second half")
    panels = [
        panel("ball from the image's middle [px]", rows[:, 0], [("across", rows[:, 1]), ("down", rows[:, 2])]),
        panel("the head's speed [rad/s]", rows[:, 0], [("pan", rows[:, 3]), ("tilt", rows[:, 4])]),
        panel("events in a step", rows[:, 0], [("", rows[:, 5])]),
    ]
    tides.image.write_png(output, np.ascontiguousarray(np.concatenate(panels)))
    print(output)


if __name__ == "__main__":
    main(*sys.argv[1:2])
